//! What the interface remembers that is nobody else's business.

use eframe::egui::Rect;

/// How much room there is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Layout {
    /// Everything side by side.
    Desk,
    /// The library is a drawer.
    Tablet,
    /// One column: stage, timeline, parameters.
    Phone,
}

impl Layout {
    /// The layout for a window of that width, points; `scale` is the theme's.
    pub(crate) fn of(width: f32, scale: f32) -> Self {
        if width < 640.0 * scale {
            Self::Phone
        } else if width < 960.0 * scale * scale {
            // Larger type also makes every panel wider, so that it takes its toll twice.
            Self::Tablet
        } else {
            Self::Desk
        }
    }
}

/// A name that is being typed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Renaming {
    /// The clip's id.
    pub(crate) id: String,
    /// The name so far.
    pub(crate) name: String,
}

/// The state of the interface.
#[derive(Clone, Debug)]
#[expect(clippy::struct_excessive_bools, reason = "each is a thing of its own that is open or not")]
pub(crate) struct UiState {
    /// The drawer with the library is open, where it is one.
    pub(crate) library_open: bool,
    /// The list of bundled takes is open.
    pub(crate) samples_open: bool,
    /// The list of shortcuts is open.
    pub(crate) help_open: bool,
    /// The pane that a phone shows.
    pub(crate) shown_pane: usize,
    /// The clip whose name is being typed.
    pub(crate) renaming: Option<Renaming>,
    /// The clip whose details are open.
    pub(crate) details: Option<String>,
    /// The line that says what to look at; gone once somebody touched something.
    pub(crate) hint: bool,
    /// Where the stage was drawn, points.
    pub(crate) stage: Rect,
    /// Files on their way, with how much of each is there, 0 to 1, where that is known.
    pub(crate) fetching: Vec<(String, Option<f64>)>,
}

impl Default for UiState {
    fn default() -> Self {
        Self {
            library_open: false,
            samples_open: false,
            help_open: false,
            shown_pane: 0,
            renaming: None,
            details: None,
            hint: true,
            stage: Rect::NOTHING,
            fetching: Vec::new(),
        }
    }
}
