//! The Match lab: the hand that drives, what is set, why a frame was chosen, and all clips in a
//! strip.

mod hand;
mod rows;
mod strip;
mod tags;
mod why;

pub(crate) use hand::{DriveHand, Pad};
pub(crate) use hand::{steer, stick_on_stage_ui};
pub(crate) use rows::{compare_hysteresis, drive_ui};
pub(crate) use strip::drive_panel_ui;

use segue_session::LabId;
use segue_session::Session;
use segue_session::{DriveMoment, Driven};
use std::sync::Arc;

/// Whether the lab is open.
pub(crate) fn is_open(session: &Session) -> bool {
    session.params().lab() == LabId::Match
}

/// What the first pane shows now, where it was driven.
fn shown(session: &Session) -> Option<(&Arc<Driven>, &DriveMoment)> {
    let driven = session.main_outcome()?.driven()?;
    Some((driven, driven.at(session.now_secs())?))
}
