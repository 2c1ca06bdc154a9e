//! The state of the strip of numbers below the stage.

use segue_session::LabId;
use segue_session::metrics::MetricId;

/// The state of the strip of numbers below the stage.
#[derive(Clone, Debug, Default)]
pub(crate) struct StripState {
    /// Whether all numbers are shown.
    pub(crate) is_open: bool,
    /// The lab, the number of panes shown, and the width of each, for which the rest holds.
    pub(crate) of: (Option<LabId>, usize, f32),
    /// The numbers that the panes had last.
    pub(crate) listed: Vec<MetricId>,
    /// The height of the strip.
    pub(crate) height: f32,
    /// The height that the reasons of panes without a result took.
    pub(crate) problems: f32,
}
