//! A window takes no pictures of itself: desktops have programs for it.

use crate::platform::{Inbox, Incoming};
use eframe::egui::Rect;
use segue_text::Message;
use std::convert::Infallible;

/// Whether pictures of the stage can be saved.
pub(crate) fn can_take_pictures() -> bool {
    false
}

/// Nobody asks for it here.
pub(crate) fn save_picture(_file_name: &str, _stage: Rect, _inbox: &Inbox) {}

/// A text does without one.
pub(crate) fn take_picture(_stage: Rect, inbox: &Inbox) {
    inbox.push(Incoming::Picture(None));
}

/// Whether films can be made.
pub(crate) fn can_film() -> bool {
    false
}

/// There is none.
#[derive(Debug)]
pub(crate) struct Film(Infallible);

impl Film {
    /// Says why there is none.
    pub(crate) fn begin() -> Result<Self, Message> {
        Err("a window cannot record itself".into())
    }

    /// How long it is, seconds.
    pub(crate) fn secs(&self) -> f64 {
        match self.0 {}
    }

    /// Hands it to the user.
    pub(crate) fn save(self, _stem: &str, _inbox: &Inbox) {
        match self.0 {}
    }
}
