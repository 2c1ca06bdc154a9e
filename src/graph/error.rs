use crate::blend::BlendError;
use crate::clip::ClipError;
use crate::registration::RegistrationError;

/// Why there is no graph, and what would do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GraphError {
    /// No clips.
    #[error("a motion graph needs a clip: choose at least one")]
    NoClips,
    /// A clip cannot follow another.
    #[error(transparent)]
    Blend(#[from] BlendError),
    /// The clips cannot be compared.
    #[error(transparent)]
    Registration(#[from] RegistrationError),
    /// What was stitched is no clip.
    #[error(transparent)]
    Clip(#[from] ClipError),
    /// A number outside its range.
    #[error("{what} of {value} cannot be used: give a number from {least} to {most}")]
    Setting {
        /// Which number.
        what: &'static str,
        /// The number given.
        value: f64,
        /// The least that can be used.
        least: f64,
        /// The most that can be used.
        most: f64,
    },
    /// The segment holds nothing but blends.
    #[error(
        "a blend window of {window} frames leaves nothing of a segment of {segment}: {}raise the segment to {}",
        if *segment > 1 { format!("lower the window to {} or ", segment - 1) } else { String::new() },
        window + 1
    )]
    SegmentTooShort {
        /// Frames of a segment.
        segment: usize,
        /// Frames of the blend window.
        window: usize,
    },
    /// No clip is as long as a segment.
    #[error(
        "a segment of {segment} frames is longer than the longest clip ({longest} frames): lower it to {longest}, or add a longer clip"
    )]
    SegmentTooLong {
        /// Frames of a segment.
        segment: usize,
        /// Frames of the longest clip.
        longest: usize,
    },
    /// No clip has room for a window, with a frame before and one behind it.
    #[error(
        "a blend window of {window} frames does not fit into the longest clip ({longest} frames) with a frame to either side: lower it to {}, or add a longer clip",
        longest.saturating_sub(2).max(1)
    )]
    WindowTooLong {
        /// Frames of the blend window.
        window: usize,
        /// Frames of the longest clip.
        longest: usize,
    },
    /// The distances are those of another window.
    #[error("these are distances of windows of {found} frames, the graph asks for {expected}: sum them again")]
    OtherWindow {
        /// The distances' window.
        found: usize,
        /// The graph's window.
        expected: usize,
    },
    /// No transition is good enough.
    #[error(
        "no two windows are closer than {threshold_cm} cm: raise the threshold above {nearest_cm:.2} cm, where the best transition lies"
    )]
    NoTransition {
        /// The threshold, centimetres.
        threshold_cm: f64,
        /// The distance of the best transition there could be, centimetres.
        nearest_cm: f64,
    },
    /// There is nowhere to go.
    #[error(
        "there are no two windows far enough from each other to go between: use shorter segments, a shorter minimum jump, or more clips"
    )]
    NowhereToGo,
    /// The transitions lead to an end, each of them.
    #[error(
        "every way through the graph of {transitions} transitions comes to an end: raise the threshold above {threshold_cm} cm, or add clips"
    )]
    NoCycle {
        /// Transitions in the graph.
        transitions: usize,
        /// The threshold, centimetres.
        threshold_cm: f64,
    },
}
