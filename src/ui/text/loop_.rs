//! The texts of the Loop lab.

use crate::ui::language::Word;
use segue_session::choices::LoopMethod;
use segue_text::{Message, msg};

/// The line about the Loop lab.
pub(crate) const LOOP_ABOUT: Word = Word::new("Makes a seamless loop from a part of A.");
/// The help text of the Loop lab.
pub(crate) const LOOP_DETAILS: Word =
    Word::new("The difference between the ends of that part is spread over it.");
/// The help of the half-life in this lab.
pub(crate) const LOOP_HALF_LIFE: Word =
    Word::new("How far into the cycle the correction reaches from its ends.");
/// The button that compares methods on the same cycle.
pub(crate) const LOOP_SHOOT_OUT: Word = Word::new("Compare methods");
/// The comparison that [`LOOP_SHOOT_OUT`] opens.
pub(crate) const LOOP_SHOOT_OUT_QUERY: &str = "loop_method:exact,both,end";

/// Returns the description of a method that closes a loop.
pub(crate) fn loop_method(method: LoopMethod) -> Word {
    Word::new(match method {
        LoopMethod::Both => {
            "Independent springs from both ends: what has not decayed at the other end remains as a seam."
        }
        LoopMethod::Crossed => {
            "As both ends, but the shares of the velocity difference are swapped. With a ratio of 0.5 they are the same."
        }
        LoopMethod::Start => "A spring at the start takes the whole difference.",
        LoopMethod::End => "A spring at the end takes the whole difference.",
        LoopMethod::Linear => {
            "Spread evenly over the cycle: poses match at the ends, velocities do not."
        }
        LoopMethod::Cubic => {
            "A cubic over the whole cycle: pose and velocity match at the ends, and every pose changes a little."
        }
        LoopMethod::Exact => {
            "Springs from both ends, solved so that pose and velocity match exactly."
        }
    })
}

/// Says that the ends of a cycle were found, and how far apart they are.
pub(crate) fn ends_found(distance_cm: f64) -> Message {
    msg!("Found automatically: the best-matching ends, {cm:.1} cm apart.", cm = distance_cm)
}

/// Warns that the ends of a cycle that was found hardly fit.
pub(crate) fn poor_ends(distance_cm: f64) -> Message {
    msg!(
        "The best-matching ends are {cm:.1} cm apart: this clip hardly repeats itself. Choose a steadier clip, or set the ends by hand.",
        cm = distance_cm
    )
}
