//! The View lab: a clip, its details, and its place.

use crate::ui::clip_panel::clip_panel_ui;
use crate::ui::kit::{self, Button};
use crate::ui::labs::lab_ui::{Compares, LabUi, Shown, Title};
use crate::ui::out::Out;
use crate::ui::rows::{Detail, KeepOffer, clip_choice_ui, foot_rows_ui, param_row_ui, slot_row_ui};
use crate::ui::state::UiState;
use crate::ui::text;
use eframe::egui::Ui;
use segue_session::{Command, Compare, Key, LabId, Session, Slot, Value};
use segue_text::msg;

/// The lab's part of the page.
pub(super) const LAB: LabUi = LabUi {
    panel_ui: view_ui,
    about: [text::VIEW_ABOUT, text::VIEW_DETAILS],
    kept,
    compares: Compares::Own(|session, out| {
        compare_clips(session.params().text(Key::A), session.params().text(Key::B), out);
    }),
    title,
    hint: |_| None,
    take_line: None,
};

fn title(shown: &Shown<'_>) -> Title {
    Title { strong: shown.name(Key::A), ..Title::default() }
}

/// Opens two unchanged clips side by side: a reference, and the one to compare with it.
pub(crate) fn compare_clips(reference: &str, other: &str, out: &mut Out) {
    let values = [reference, other].map(|id| Value::Text(id.to_owned())).to_vec();
    let compare = Compare { key: Key::A, values };
    out.commands.push(Command::Set(vec![
        (Key::Lab, LabId::View.into()),
        (Key::Compare, Value::Compare(Some(compare))),
    ]));
    out.commands.push(Command::Settle);
}

pub(super) fn view_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    compared_clips_ui(session, out, ui);
    foot_rows_ui(session, out, ui);
    for key in [Key::RootMotion, Key::PlaceX, Key::PlaceZ, Key::PlaceHeading] {
        param_row_ui(key, &Detail::default(), session, out, ui);
    }
    if let Some(entry) = session.slot(Slot::A) {
        ui.push_id(&entry.id, |ui| clip_panel_ui(entry, None, session, state, out, ui));
    }
}

/// Returns the clip with the changes of this lab; a clip without any is in the library already.
fn kept(session: &Session, pane: usize) -> KeepOffer {
    let unchanged = session.slot(Slot::A).filter(|_| !session.view_is_changed());
    match unchanged {
        Some(entry) if session.panes().len() < 2 => KeepOffer {
            saved: entry.id.clone(),
            keep_refused: text::KEPT_ALREADY,
            ..KeepOffer::result(pane)
        },
        _ => KeepOffer::result(pane),
    }
}

/// Draws the choice of the clip, or of the compared ones.
fn compared_clips_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    let compare = session.compare().filter(|compare| compare.key == Key::A);
    let label = if let Some(compare) = compare {
        for (pane, value) in compare.values.iter().enumerate() {
            let label = msg!("Clip {number}", number = pane + 1);
            if let Some(id) =
                clip_choice_ui(&label, compare.key.param().format(value).as_str(), session, ui)
            {
                let mut compare = compare.clone();
                compare.values[pane] = Value::Text(id);
                out.compare(Some(compare));
            }
        }
        text::COMPARE_OFF
    } else {
        slot_row_ui(Slot::A, session, out, ui);
        text::COMPARE_CLIPS
    };
    if kit::button_ui(Button::new(label).hint(text::COMPARE_CLIPS_HELP), ui).clicked() {
        LAB.compares.toggle(session, out);
    }
}
