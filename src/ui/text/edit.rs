//! The texts of the Edit lab, and of edits elsewhere.

use crate::ui::language::Word;

/// The description of the Edit lab.
pub(crate) const EDIT_ABOUT: Word = Word::new(
    "Trims, loops, reverses, mirrors, resamples, scales, turns and moves a clip, or puts it on another body.",
);
/// The help text of the Edit lab.
pub(crate) const EDIT_DETAILS: Word = Word::new(
    "Edits are applied from top to bottom, and foot contacts follow. The ends of the part can be dragged on the bar above the timeline.",
);
/// The secondary title of a clip without edits.
pub(crate) const UNEDITED: Word = Word::new("unchanged");
/// The choice of the clip whose body A gets.
pub(crate) const BODY_OF: Word = Word::new("Body of");
/// The button that gives A its own body again.
pub(crate) const OWN_BODY: Word = Word::new("Back to its own body");
/// The label of the bar of A with the part that is used.
pub(crate) const PART_OF_A: Word = Word::new("Part of A");
/// The menu item that opens the Edit lab with a clip.
pub(crate) const EDIT_CLIP: Word = Word::new("Edit…");
/// The menu item that adds the mirror image of a clip.
pub(crate) const ADD_MIRRORED: Word = Word::new("Mirror");
/// The menu item that adds a clip backwards.
pub(crate) const ADD_REVERSED: Word = Word::new("Reverse");
/// The menu item that adds a clip as a loop.
pub(crate) const ADD_AS_LOOP: Word = Word::new("Treat as loop");
