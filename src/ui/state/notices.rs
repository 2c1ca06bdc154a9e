//! The place of the chip with the notices.

use eframe::egui::Rect;

/// The place of the chip: the row with the heading of a panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NoticePlace {
    /// The row.
    pub(crate) row: Rect,
    /// Where its heading ends.
    pub(crate) heading_end: f32,
}
