//! The texts of the Speed and In place labs.

use crate::ui::language::Word;
use segue_motion::gait::GaitFacts;
use segue_text::{Message, msg};

/// What the In place lab does.
pub(crate) const IN_PLACE_ABOUT: Word =
    Word::new("Removes the root motion of a clip, or rebuilds it from the planted feet.");
/// What the Speed lab does.
pub(crate) const SPEED_ABOUT: Word = Word::new(
    "Blends two gaits, such as a walk and a run, to any speed between them. Drag the speed while it plays.",
);
/// Opens the speeds of A and B and the one between.
pub(crate) const THREE_SPEEDS: Word = Word::new("A, midway, B");
/// A chip over a pane whose speed lies beyond both clips.
pub(crate) const BEYOND: Word = Word::new("extrapolated");

/// How fast both clips go, and where.
pub(crate) fn gaits([a, b]: [f64; 2], [[from_a, to_a], [from_b, to_b]]: [[f64; 2]; 2]) -> Message {
    msg!(
        "Speed of one cycle: A {a:.2} m/s from {from_a:.2} to {to_a:.2} s, B {b:.2} m/s from {from_b:.2} to {to_b:.2} s. The mean over a whole clip, as in View, may differ.",
        a,
        from_a,
        to_a,
        b,
        from_b,
        to_b
    )
}

/// That the speed asked for lies beyond both clips; `None` where it does not.
pub(crate) fn beyond_gaits(facts: &GaitFacts, [a, b]: [f64; 2]) -> Option<Message> {
    let (low, high) = (a.min(b), a.max(b));
    if facts.limited {
        Some(msg!(
            "Too far outside the speeds of both clips ({low:.2} to {high:.2} m/s): limited to {mps:.2} m/s.",
            low,
            high,
            mps = facts.speed_mps
        ))
    } else if facts.extrapolated {
        Some(msg!(
            "Outside the speeds of both clips ({low:.2} to {high:.2} m/s), so that poses are extrapolated: joints may bend unnaturally.",
            low,
            high
        ))
    } else {
        None
    }
}

/// A mark on the timeline.
pub(crate) const CYCLE_BEGINS: Word = Word::new("Start of a cycle");
