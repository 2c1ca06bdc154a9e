//! Errors of motion graphs.

use super::GraphOptions;
use crate::blend::BlendError;
use crate::clip::ClipError;
use crate::registration::RegistrationError;
use segue_text::{Message, msg};

/// Error building a graph or a walk.
#[derive(Clone, Debug, PartialEq, thiserror::Error, segue_text::ToMessage)]
pub enum GraphError {
    /// There are no clips.
    #[error("a motion graph needs a clip: choose at least one")]
    NoClips,
    /// A clip cannot follow another.
    #[error(transparent)]
    Blend(#[from] BlendError),
    /// The clips cannot be compared.
    #[error(transparent)]
    Registration(#[from] RegistrationError),
    /// A stitched piece is not a valid clip.
    #[error(transparent)]
    Clip(#[from] ClipError),
    /// A number out of range.
    #[error("{what} of {value} cannot be used: give a number from {least} to {most}")]
    Setting {
        /// Name of the number.
        what: &'static str,
        /// The number given.
        value: f64,
        /// The least value.
        least: f64,
        /// The greatest value.
        most: f64,
    },
    /// The segment is not longer than the blend window.
    #[error(
        "a blend window of {window} frames leaves nothing of a segment of {segment}: {or_lower}raise the segment to {longer}",
        or_lower = or_lower_window(*segment),
        longer = window + 1
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
    /// No clip is long enough for a window with a frame before and one after it.
    #[error(
        "a blend window of {window} frames does not fit into the longest clip ({longest} frames) with a frame to either side: {or_lower}add a longer clip",
        or_lower = or_lower_it(*longest)
    )]
    WindowTooLong {
        /// Frames of the blend window.
        window: usize,
        /// Frames of the longest clip.
        longest: usize,
    },
    /// The distances have another window.
    #[error(
        "these are distances of windows of {found} frames, the graph asks for {expected}: compute them again"
    )]
    OtherWindow {
        /// The distances' window.
        found: usize,
        /// The graph's window.
        expected: usize,
    },
    /// No transition is below the threshold.
    #[error(
        "no two windows are closer than {threshold_cm} cm: raise the threshold to {enough_cm:.1} cm, the best transition lies at {nearest_cm:.2} cm",
        enough_cm = above(*nearest_cm)
    )]
    NoTransition {
        /// The threshold, centimetres.
        threshold_cm: f64,
        /// The distance of the best possible transition, centimetres.
        nearest_cm: f64,
    },
    /// No transition is below the greatest sensible threshold.
    #[error(
        "the closest two windows are {nearest_cm:.2} cm apart, too far for a transition: {or_lower}add clips that move alike",
        or_lower = or_lower_blend_window(*window)
    )]
    TooFar {
        /// Frames of the blend window.
        window: usize,
        /// The distance of the best possible transition, centimetres.
        nearest_cm: f64,
    },
    /// There is one clip, and every jump in it is too short.
    #[error(
        "with a blend window of {window} frames, a jump in the only clip that is long enough spans at most {most_secs:.2} s, less than the minimum of {min_jump_secs} s: lower the jump to {most_secs:.2} s, {lower_window}or add a clip",
        most_secs = floored(*farthest_secs),
        lower_window = lower_window
            .map_or_else(Message::default, |window| msg!("the window to {window}, ", window))
    )]
    JumpsTooShort {
        /// Frames of the blend window.
        window: usize,
        /// A window with which a jump is possible; `None` if there is none.
        lower_window: Option<usize>,
        /// The shortest jump, seconds.
        min_jump_secs: f64,
        /// The longest possible jump, seconds.
        farthest_secs: f64,
    },
    /// Transitions are possible, and none of them is a local minimum.
    #[error(
        "no distance between windows of {window} frames has a local minimum at a possible transition: cut the clips into segments, or add clips"
    )]
    NoMinimum {
        /// Frames of the blend window.
        window: usize,
    },
    /// All transitions lead to an end.
    #[error(
        "every way through the graph of {transitions} transitions comes to an end: {or_raise}more clips may lead back",
        or_raise = or_raise_threshold(*threshold_cm)
    )]
    NoCycle {
        /// Transitions in the graph.
        transitions: usize,
        /// The threshold, centimetres.
        threshold_cm: f64,
    },
}

fn or_lower_window(segment: usize) -> Message {
    if segment > 1 {
        msg!("lower the window to {frames} or ", frames = segment - 1)
    } else {
        Message::default()
    }
}

fn or_lower_it(longest: usize) -> Message {
    if longest > 2 {
        msg!("lower it to {frames}, or ", frames = longest - 2)
    } else {
        Message::default()
    }
}

fn or_lower_blend_window(window: usize) -> Message {
    if window > 1 {
        msg!("lower the blend window of {window} frames, or ", window)
    } else {
        Message::default()
    }
}

fn or_raise_threshold(threshold_cm: f64) -> Message {
    if threshold_cm < GraphOptions::MAX_THRESHOLD_CM {
        msg!("a threshold above {threshold_cm} cm, or ", threshold_cm)
    } else {
        Message::default()
    }
}

/// Rounds up to a tenth of a centimetre, the step of a threshold.
pub(super) fn above(nearest_cm: f64) -> f64 {
    (nearest_cm * 10.0 - 1e-6).ceil() / 10.0
}

/// Rounds down to hundredths of a second, the step of a jump.
fn floored(secs: f64) -> f64 {
    (secs * 100.0 + 1e-6).floor() / 100.0
}
