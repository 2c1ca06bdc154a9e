//! Texts about clips of other bodies.

use crate::ui::language::Word;
use segue_text::{Message, msg};

/// The list of what retargeting could not keep.
pub(crate) const RETARGET_ERRORS: Word = Word::new("Errors of retargeting");
/// The list of what retargeting to the chosen figure could not keep.
pub(crate) const CHARACTER_ERRORS: Word = Word::new("Errors on the figure");
/// What the numbers of the list are.
pub(crate) const ABOUT_RETARGET_ERRORS: Word = Word::new(
    "How far feet and hands are from where the clip has them, at the body's scale, how far planted feet slide in a stance, and how deep feet sink in; beside it, the same with the directions of the bones alone.",
);
/// A limb in the list.
pub(crate) const LEFT_FOOT: Word = Word::new("Left foot");
/// A limb in the list.
pub(crate) const RIGHT_FOOT: Word = Word::new("Right foot");
/// A limb in the list.
pub(crate) const LEFT_HAND: Word = Word::new("Left hand");
/// A limb in the list.
pub(crate) const RIGHT_HAND: Word = Word::new("Right hand");
/// Said in place of the weight of feet.
pub(crate) const NO_COMMON_LEGS: Word = Word::new(
    "Feet get the directions of the bones alone: one of the bodies has no leg of thigh, shin and foot.",
);
/// Said in place of the weight of hands.
pub(crate) const NO_COMMON_ARMS: Word = Word::new(
    "Hands get the directions of the bones alone: one of the bodies has no arm of upper arm, forearm and hand.",
);

/// Says how far a limb is from its place.
pub(crate) fn limb_off(limb: Word, result: Message, directions: Message) -> Message {
    msg!(
        "{limb} off by {result}; by directions {directions}.",
        limb = Message::from(limb),
        result,
        directions
    )
}

/// Says how far planted feet slide.
pub(crate) fn feet_slide(result: Message, directions: Message, source: Message) -> Message {
    msg!(
        "Slide per stance {result}; by directions {directions}; in the clip {source}.",
        result,
        directions,
        source
    )
}

/// Says how deep feet sink into the ground.
pub(crate) fn feet_sink_in(result_cm: f64, directions_cm: f64) -> Message {
    msg!(
        "Feet sink in by {result:.1} cm; by directions {directions:.1} cm.",
        result = result_cm,
        directions = directions_cm
    )
}

/// Says in how many frames joints are bent too far.
pub(crate) fn beyond_limits(result: usize, directions: usize) -> Message {
    msg!(
        "Frames with a knee or elbow beyond its limits: {result}; by directions {directions}.",
        result,
        directions
    )
}
