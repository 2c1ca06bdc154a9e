//! Texts about clips of other bodies.

use crate::ui::language::Word;
use segue_text::{Message, msg};

/// The table of what retargeting could not keep.
pub(crate) const RETARGET_ERRORS: Word = Word::new("Errors of retargeting");
/// What the numbers of the table are.
pub(crate) const ABOUT_RETARGET_ERRORS: Word = Word::new(
    "In centimetres: how far feet and hands are from where the clip has them, at the body's scale; how far planted feet slide in a stance; how deep feet sink in. Beside them, the same with the directions of the bones alone.",
);
/// The head of the first column.
pub(crate) const ERROR_OF: Word = Word::new("cm");
/// The head of the column of the directions alone.
pub(crate) const BY_DIRECTIONS: Word = Word::new("Directions");
/// The head of the column of the result.
pub(crate) const BY_RESULT: Word = Word::new("Result");
/// The row of the left foot.
pub(crate) const LEFT_FOOT: Word = Word::new("Left foot off");
/// The row of the right foot.
pub(crate) const RIGHT_FOOT: Word = Word::new("Right foot off");
/// The row of the left hand.
pub(crate) const LEFT_HAND: Word = Word::new("Left hand off");
/// The row of the right hand.
pub(crate) const RIGHT_HAND: Word = Word::new("Right hand off");
/// The row of the depth below the ground.
pub(crate) const DEPTH: Word = Word::new("Deepest in the ground");
/// The row of the frames in which joints are bent too far.
pub(crate) const BEYOND_LIMITS: Word = Word::new("Frames with a knee or elbow beyond its limits");
/// Said in place of the weight of feet.
pub(crate) const NO_COMMON_LEGS: Word = Word::new(
    "Feet get the directions of the bones alone: one of the bodies has no leg of thigh, shin and foot.",
);
/// Said in place of the weight of hands.
pub(crate) const NO_COMMON_ARMS: Word = Word::new(
    "Hands get the directions of the bones alone: one of the bodies has no arm of upper arm, forearm and hand.",
);

/// Returns the name of the row of sliding feet, with the slide in the clip itself.
pub(crate) fn slid_in_clip(slid: Message) -> Message {
    msg!("Slide per stance; in the clip {slid}", slid)
}
