//! The Match lab: the input that drives the character, the parameters, why a frame was chosen, and
//! all clips in a strip.

mod hand;
mod present;
mod rows;
mod strip;
mod tags;
mod why;

pub(crate) use hand::{candidate, steer, stick_on_stage_ui};
pub(crate) use rows::{compare_hysteresis, drive_ui};
pub(crate) use strip::drive_panel_ui;

use crate::ui::labs::lab_ui::{Compares, LabUi, Shown, Title};
use crate::ui::text;
use segue_session::Key;

/// The lab's part of the page.
pub(super) const LAB: LabUi = LabUi {
    panel_ui: drive_ui,
    about: [text::MATCH_ABOUT, text::MATCH_DETAILS],
    kept: rows::kept,
    compares: Compares::Own(compare_hysteresis),
    title,
    hint: |session| session.is_driven().then_some(text::MATCH_HINT),
    take_line: None,
};

fn title(shown: &Shown<'_>) -> Title {
    let is_live = shown.session.is_driven();
    Title {
        strong: if is_live { text::LIVE.into() } else { shown.spoken(Key::Scenario) },
        secondary: shown.spoken(Key::Hysteresis),
        ..Title::default()
    }
}
