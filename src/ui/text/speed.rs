//! The texts of the Speed and In place labs.

use crate::ui::language::Word;
use segue_motion::gait::GaitFacts;
use segue_text::{Message, msg};

/// The line about the In place lab.
pub(crate) const IN_PLACE_ABOUT: Word =
    Word::new("Removes the root motion of a clip, or rebuilds it.");
/// The help text of the In place lab.
pub(crate) const IN_PLACE_DETAILS: Word =
    Word::new("It is rebuilt from the planted feet, which stay where they are on the ground.");
/// The line about the Speed lab.
pub(crate) const SPEED_ABOUT: Word = Word::new("Blends two gaits to any speed between them.");
/// The help text of the Speed lab.
pub(crate) const SPEED_DETAILS: Word =
    Word::new("For example a walk and a run. Drag the speed while it plays.");
/// The button that compares the speeds of A and B and the one between them.
pub(crate) const THREE_SPEEDS: Word = Word::new("A, midway, B");
/// The chip over a pane whose speed lies beyond both clips.
pub(crate) const BEYOND: Word = Word::new("extrapolated");

/// Returns the speed of one cycle of each clip.
pub(crate) fn gait_speeds([a, b]: [f64; 2]) -> Message {
    msg!("A: {a:.2} m/s · B: {b:.2} m/s", a, b)
}

/// Returns the speed and the place of the cycle of each clip.
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

/// Warns that the requested speed lies beyond both clips; `None` where it does not.
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

/// The mark on the timeline where a cycle begins.
pub(crate) const CYCLE_BEGINS: Word = Word::new("Start of a cycle");
