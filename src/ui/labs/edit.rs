//! The Edit lab: a clip, and what is done to it as a whole.

use crate::ui::kit::{self, Button, Icon, MenuItem};
use crate::ui::labs::lab_ui::{Compares, LabUi, Shown, Title};
use crate::ui::out::Out;
use crate::ui::rows::{
    Detail, KeepOffer, clip_choice_ui, clip_sets_ui, foot_rows_ui, param_row_ui, retarget_rows_ui,
    slot_row_ui,
};
use crate::ui::state::UiState;
use crate::ui::text;
use crate::ui::theme::space;
use eframe::egui::Ui;
use segue_session::{
    ClipEdit, Command, Compare, Key, LabId, List, Remedy, Session, Slot, edits_of,
};
use segue_text::Message;

/// The lab's part of the page.
pub(super) const LAB: LabUi = LabUi {
    panel_ui: edit_ui,
    about: [text::EDIT_ABOUT, text::EDIT_DETAILS],
    kept: |_, pane| KeepOffer::result(pane),
    compares: Compares::Own(compare_sides),
    title,
    hint: |_| None,
    take_line: None,
};

fn title(shown: &Shown<'_>) -> Title {
    let edits = edits_of(shown.params);
    let secondary =
        if edits.is_empty() { text::UNEDITED.into() } else { Message::joined(edits, ", ") };
    Title { strong: shown.name(Key::A), secondary, ..Title::default() }
}

/// Returns the parameters of the ends of the part that stays, while this lab is open.
pub(super) fn part_keys(session: &Session) -> Option<[Key; 2]> {
    let is_open = session.params().lab() == LabId::Edit;
    is_open.then_some([Key::EditFrom, Key::EditTo])
}

/// Draws the rows of the lab, in the order in which the edits are applied.
fn edit_ui(session: &Session, _: &mut UiState, out: &mut Out, ui: &mut Ui) {
    clip_sets_ui(session, out, ui);
    slot_row_ui(Slot::A, session, out, ui);
    body_ui(session, out, ui);
    for group in [
        &[Key::EditFrom, Key::EditTo, Key::AsLoop, Key::Reverse, Key::Mirror][..],
        &[Key::Resample, Key::Scale][..],
        &[Key::Turn, Key::MoveX, Key::MoveZ][..],
    ] {
        ui.add_space(space::S);
        for key in group {
            param_row_ui(*key, &Detail::default(), session, out, ui);
        }
    }
    ui.add_space(space::S);
    foot_rows_ui(session, out, ui);
}

/// Draws the choice of the body, and what retargeting did.
fn body_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    let chosen = session.params().clip_ids(Key::EditBody).first().map_or("", String::as_str);
    // Without another body it is that of A.
    let shown = if chosen.is_empty() { session.params().text(Key::A) } else { chosen };
    if let Some(id) = clip_choice_ui(text::BODY_OF, shown, session, ui) {
        out.set_once(Key::EditBody, List::ClipIds(vec![id]).into());
    }
    if !chosen.is_empty() && kit::button_ui(Button::new(text::OWN_BODY).outlined(), ui).clicked() {
        out.set_once(Key::EditBody, List::ClipIds(Vec::new()).into());
    }
    let outcome = session.main_outcome();
    if let Some(retargeted) = outcome.and_then(|outcome| outcome.retargeted.as_ref()) {
        let errors: Vec<_> = retargeted.errors.iter().map(|errors| (None, errors)).collect();
        retarget_rows_ui(&errors, session, out, ui);
    }
}

/// Opens the clip beside its mirror image, or goes back to one pane.
fn compare_sides(session: &Session, out: &mut Out) {
    let on = session.compare().is_some_and(|compare| compare.key == Key::Mirror);
    let query = if on { "" } else { "mirror:off,on" };
    out.compare(Compare::parse(query).ok());
}

/// Draws the items of a clip's menu that edit it: in this lab, or at once, as a new clip.
pub(crate) fn edit_items_ui(id: &str, out: &mut Out, ui: &mut Ui) {
    let item =
        MenuItem { text: text::EDIT_CLIP.into(), icon: Some(Icon::Sliders), ..MenuItem::default() };
    if kit::menu_item_ui(item, ui).clicked() {
        out.commands.extend(Remedy::EditClip { id: id.to_owned() }.commands());
    }
    for (words, edit) in [
        (text::ADD_MIRRORED, ClipEdit::Mirror),
        (text::ADD_REVERSED, ClipEdit::Reverse),
        (text::ADD_AS_LOOP, ClipEdit::Loop),
    ] {
        let item = MenuItem { text: words.into(), ..MenuItem::default() };
        if kit::menu_item_ui(item, ui).clicked() {
            out.commands.push(Command::Edit(id.to_owned(), edit, None));
        }
    }
}
