//! The state of a swipe from one pane to the next.

use eframe::egui::Pos2;

/// A finger on the stage of several panes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Swipe {
    /// The place where it began, points.
    pub(crate) from: Pos2,
    /// The time at which it began, seconds of egui's clock.
    pub(crate) began: f64,
    /// Whether the finger has turned the page (`true`) or turns the camera (`false`); `None` until
    /// this is known.
    pub(crate) turns_page: Option<bool>,
}
