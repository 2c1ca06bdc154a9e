//! The present state of the Match lab.

use segue_session::{DriveHistory, DriveMoment, LabId, Session};
use std::sync::Arc;

/// Returns whether the lab is open.
pub(super) fn is_open(session: &Session) -> bool {
    session.params().lab() == LabId::Match
}

/// Returns the driven character of the first pane, and its present moment.
pub(super) fn shown(session: &Session) -> Option<(&Arc<DriveHistory>, &DriveMoment)> {
    let driven = session.main_outcome()?.driven()?;
    Some((driven, driven.at(session.now_secs())?))
}
