//! The In place lab: a clip, and the treatment of its root motion.

use crate::ui::labs::lab_ui::{Compares, LabUi, Shown, Title};
use crate::ui::out::Out;
use crate::ui::rows::{Detail, KeepOffer, clip_sets_ui, foot_rows_ui, param_row_ui, slot_row_ui};
use crate::ui::state::UiState;
use crate::ui::text;
use crate::ui::theme::space;
use eframe::egui::Ui;
use segue_session::{Compare, Key, Session, Slot};

/// The lab's part of the page.
pub(super) const LAB: LabUi = LabUi {
    panel_ui: in_place_ui,
    about: [text::IN_PLACE_ABOUT, text::IN_PLACE_DETAILS],
    kept: |_, pane| KeepOffer::result(pane),
    compares: Compares::Own(compare_ways),
    title,
    hint: |_| None,
    take_line: None,
};

fn title(shown: &Shown<'_>) -> Title {
    Title { strong: shown.name(Key::A), secondary: shown.spoken(Key::RootWay), ..Title::default() }
}

/// Draws the rows of the lab.
fn in_place_ui(session: &Session, _: &mut UiState, out: &mut Out, ui: &mut Ui) {
    clip_sets_ui(session, out, ui);
    slot_row_ui(Slot::A, session, out, ui);
    ui.add_space(space::S);
    param_row_ui(Key::RootWay, &Detail::default(), session, out, ui);
    param_row_ui(Key::RootWayTurn, &Detail::default(), session, out, ui);
    ui.add_space(space::S);
    foot_rows_ui(session, out, ui);
}

/// Opens both ways side by side, or goes back to one pane.
fn compare_ways(session: &Session, out: &mut Out) {
    let on = session.compare().is_some_and(|compare| compare.key == Key::RootWay);
    let query = if on { "" } else { "root_way:take_out,put_back" };
    out.compare(Compare::parse(query).ok());
}
