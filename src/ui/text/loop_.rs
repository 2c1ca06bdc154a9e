//! The texts of the Loop lab.

use segue_session::choices::LoopMethod;
use segue_text::{Message, msg};

/// What the Loop lab does.
pub(crate) const LOOP_ABOUT: &str =
    "Makes a seamless cycle of a part of A: the difference between its ends is spread over it.";
/// What the half-life does to a loop.
pub(crate) const LOOP_HALF_LIFE: &str =
    "How far into the cycle the correction reaches from its ends.";
/// Several methods on the same cycle.
pub(crate) const LOOP_SHOOT_OUT: &str = "Exact against classic";
/// What the button opens.
pub(crate) const LOOP_SHOOT_OUT_QUERY: &str = "loop_method:exact,both,end";

/// What a way to close a loop does.
pub(crate) fn loop_method(method: LoopMethod) -> &'static str {
    match method {
        LoopMethod::Both => {
            "Springs from both ends, as they are: what has not died away at the other end stays as a seam."
        }
        LoopMethod::Crossed => {
            "As with both ends, but the beginning takes the other share of the velocity's difference. With a ratio of 0.5 it is the same."
        }
        LoopMethod::Start => "A spring at the beginning alone takes all of the difference.",
        LoopMethod::End => "A spring at the end alone takes all of the difference.",
        LoopMethod::Linear => {
            "Evenly over the whole cycle: the pose closes, its velocity does not."
        }
        LoopMethod::Cubic => {
            "A cubic over the whole cycle: pose and velocity close, and every pose bends a little."
        }
        LoopMethod::Exact => {
            "Springs from both ends, solved so that pose and velocity close exactly."
        }
    }
}

/// How the ends of a cycle were found.
pub(crate) fn ends_found(distance_cm: f64) -> Message {
    msg!("Found automatically: the ends that fit best, {cm:.1} cm apart.", cm = distance_cm)
}

/// That the ends of a cycle that was found hardly fit.
pub(crate) fn poor_ends(distance_cm: f64) -> Message {
    msg!(
        "The best ends that were found are {cm:.1} cm apart: this clip hardly repeats itself. Choose a steadier clip, or set the ends by hand.",
        cm = distance_cm
    )
}
