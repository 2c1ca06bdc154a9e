//! Pictures and films of a window: none, because desktops have programs for them.

use crate::platform::{Inbox, Incoming};
use eframe::egui::{Context, Rect};
use segue_text::Message;
use std::convert::Infallible;

/// Returns whether pictures of the stage can be saved.
pub(crate) fn can_take_pictures() -> bool {
    false
}

/// Does nothing, because [`can_take_pictures`] is false.
pub(crate) fn save_picture(
    _file_name: &str,
    _stage: Rect,
    _is_complete: fn(&Context) -> bool,
    _inbox: &Inbox,
) {
}

/// Answers that there is no picture; a report is then made without one.
pub(crate) fn take_picture(_stage: Rect, _is_complete: fn(&Context) -> bool, inbox: &Inbox) {
    inbox.push(Incoming::Picture(None));
}

/// Returns whether films can be made.
pub(crate) fn can_film() -> bool {
    false
}

/// A film, of which there is none.
#[derive(Debug)]
pub(crate) struct Film(Infallible);

impl Film {
    /// Returns the reason why a window has no films.
    pub(crate) fn begin() -> Result<Self, Message> {
        Err("a window cannot record itself".into())
    }

    /// Returns its duration, seconds.
    pub(crate) fn secs(&self) -> f64 {
        match self.0 {}
    }

    /// Saves it for the user.
    pub(crate) fn save(self, _stem: &str, _inbox: &Inbox) {
        match self.0 {}
    }
}
