//! Texts about clips of other bodies.

use crate::ui::language::Word;
use segue_text::{Message, msg};

/// The title of the list of retargeting errors.
pub(crate) const RETARGET_ERRORS: Word = Word::new("Retargeting errors");
/// The title of the list of what retargeting to the chosen figure could not keep.
pub(crate) const CHARACTER_ERRORS: Word = Word::new("Errors on the figure");
/// The help of the list: the meaning of its numbers.
pub(crate) const ABOUT_RETARGET_ERRORS: Word = Word::new(
    "How far feet and hands are from their positions in the clip, at the body's scale, how far planted feet slide in a stance, and how deep feet penetrate the ground. Rotations only: the same without moving feet and hands into place.",
);
/// A limb in the list.
pub(crate) const LEFT_FOOT: Word = Word::new("Left foot");
/// A limb in the list.
pub(crate) const RIGHT_FOOT: Word = Word::new("Right foot");
/// A limb in the list.
pub(crate) const LEFT_HAND: Word = Word::new("Left hand");
/// A limb in the list.
pub(crate) const RIGHT_HAND: Word = Word::new("Right hand");
/// The note in place of the weight of feet.
pub(crate) const NO_COMMON_LEGS: Word = Word::new(
    "Feet are retargeted by rotations only: one of the bodies has no leg with thigh, shin and foot.",
);
/// The note in place of the weight of hands.
pub(crate) const NO_COMMON_ARMS: Word = Word::new(
    "Hands are retargeted by rotations only: one of the bodies has no arm with upper arm, forearm and hand.",
);
/// The note on bodies that stand on two and on four legs.
pub(crate) const OTHER_PLAN: Word = Word::new(
    "One of the bodies stands on two legs, the other on four: only the directions of bones are retargeted, and the postures differ.",
);

/// Returns the position error of a limb.
pub(crate) fn limb_error(limb: Word, result: Message, directions: Message) -> Message {
    msg!(
        "{limb} error {result}; rotations only {directions}.",
        limb = Message::from(limb),
        result,
        directions
    )
}

/// Returns how far planted feet slide.
pub(crate) fn feet_slide(result: Message, directions: Message, source: Message) -> Message {
    msg!(
        "Slide per stance {result}; rotations only {directions}; in the clip {source}.",
        result,
        directions,
        source
    )
}

/// Returns how deep feet penetrate the ground.
pub(crate) fn penetration(result_cm: f64, directions_cm: f64) -> Message {
    msg!(
        "Penetration {result:.1} cm; rotations only {directions:.1} cm.",
        result = result_cm,
        directions = directions_cm
    )
}

/// Returns in how many frames joints are bent too far.
pub(crate) fn beyond_limits(result: usize, directions: usize) -> Message {
    msg!(
        "Frames with a knee or elbow beyond its limits: {result}; rotations only {directions}.",
        result,
        directions
    )
}
