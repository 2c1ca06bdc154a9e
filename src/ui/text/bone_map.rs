//! The texts of the editor of body parts.

use crate::ui::language::Word;
use segue_text::{Message, msg};

pub(crate) const BODY_PARTS_HELP: Word = Word::new(
    "The bone of each body part, found by name or by shape. Press a part, then its bone; or drag a bone onto a part.",
);
pub(crate) const ON_FOUR_LEGS: Word =
    Word::new("This body stands on four legs: its forelegs take the places of arms.");
pub(crate) const BONE_MAP: Word = Word::new("Body parts and their bones");
pub(crate) const LEFT_SIDE: Word = Word::new("left side");
pub(crate) const RIGHT_SIDE: Word = Word::new("right side");
pub(crate) const BONES: Word = Word::new("Bones");
pub(crate) const FIND_BONE: Word = Word::new("Find a bone");
pub(crate) const NO_BONE: Word = Word::new("No bone");
pub(crate) const NO_BONE_FOUND: Word = Word::new("No bone has this in its name.");
pub(crate) const BOTH_SIDES: Word = Word::new("Both sides");
pub(crate) const BOTH_SIDES_HELP: Word = Word::new(
    "A choice on one side is made on the other side, too, where a bone is the counterpart. Off: one side at a time.",
);
pub(crate) const RESET_BONES: Word = Word::new("Reset");
pub(crate) const RESET_BONES_HINT: Word =
    Word::new("Take back all choices by hand, in every clip of this rig");
pub(crate) const SAVE_BONES: Word = Word::new("Save as JSON");
pub(crate) const SAVE_BONES_HINT: Word = Word::new(
    "Save the body parts as a file. Dropped on the page, it applies to clips of any rig with these bones.",
);
pub(crate) const FOUND_BY_HAND: Word = Word::new("chosen by hand");
pub(crate) const FOUND_BY_FILE: Word = Word::new("stated by the file");
pub(crate) const FOUND_BY_NAME: Word = Word::new("found by name");
pub(crate) const FOUND_BY_SHAPE: Word = Word::new("found by shape");

/// The number of parts by the way in which their bones were found.
pub(crate) fn parts_of_source(count: usize, source: Word) -> Message {
    msg!("{count} {source}", count, source)
}

/// The heading of the list from which a part gets its bone.
pub(crate) fn bone_of(part: Word) -> Message {
    msg!("Bone of: {part}", part)
}

/// The parts that labs need and that have no bone.
pub(crate) fn missing_parts(parts: Vec<Message>) -> Message {
    msg!("Without a bone: {parts}. Feet need them.", parts)
}

/// The number of clips that a choice applies to.
pub(crate) fn clips_of_rig(clips: usize) -> Message {
    msg!(
        "{clips, plural, one {Choices apply to this clip and to clips of its rig that are opened later.} other {Choices apply to the # clips of this rig, and to those that are opened later.}}",
        clips
    )
}

/// The number of bones that a long list leaves out.
pub(crate) fn more_bones(count: usize) -> Message {
    msg!(
        "{count, plural, one {# more bone: search for it.} other {# more bones: search for them.}}",
        count
    )
}

/// The content of a slot, for screen readers.
pub(crate) fn slot(part: Word, bone: Message, source: Word) -> Message {
    msg!("{part}: {bone}, {source}", part, bone, source)
}

/// The content of a slot without a bone, for screen readers.
pub(crate) fn empty_slot(part: Word) -> Message {
    msg!("{part}: no bone", part)
}
