//! The texts of the library, of what is dragged out of it, and of the notices over it.

use crate::ui::language::Word;
use segue_session::{AddedClips, Entry, Slot};
use segue_text::{Message, msg};

pub(crate) const OPEN_FILES: Word = Word::new("Open files…");
pub(crate) const SAMPLES: Word = Word::new("Samples");
pub(crate) const CORPUS: Word = Word::new("Corpus…");
pub(crate) const SEARCH_CLIPS: Word = Word::new("Search clips");
pub(crate) const SORT: Word = Word::new("Sort");
pub(crate) const ORDER_ADDED: Word = Word::new("Order added");
pub(crate) const ORDER_NAME: Word = Word::new("Name");
pub(crate) const ORDER_LENGTH: Word = Word::new("Length");
pub(crate) const ORDER_SPEED: Word = Word::new("Speed");
pub(crate) const NO_SUCH_CLIP: Word = Word::new("No clip has this name.");
pub(crate) const BUILT_IN: Word = Word::new("Built-in clips");
pub(crate) const SWAP_CLIPS: Word = Word::new("Swap A and B");
pub(crate) const SELECT: Word = Word::new("Select");
pub(crate) const USE_THESE: Word = Word::new("Use these");
pub(crate) const CLEAR_SELECTION: Word = Word::new("Clear the selection");
pub(crate) const USE_AS_CHARACTER: Word = Word::new("Use as character");

/// Returns the name of the letter that puts a clip into a slot, and is pressed while the clip is
/// there.
pub(crate) fn held_as(clip: Message, slot: Slot) -> Message {
    msg!("{clip} as {slot}", clip, slot = slot.label())
}

/// Returns what happens when a clip is dropped on a slot.
pub(crate) fn use_as(clip: Message, slot: Slot) -> Message {
    msg!("Use {clip} as {slot}", clip, slot = slot.label())
}

/// Returns what happens when a clip is dropped on a list of clips.
pub(crate) fn add_to_list(clip: Message) -> Message {
    msg!("Add {clip}", clip)
}

/// Returns what happens when a clip is dropped on a pane of compared clips.
pub(crate) fn compare_here(clip: Message) -> Message {
    msg!("Show {clip} here", clip)
}

/// Returns the line below the name of a clip: `3.9 s · 468 frames`.
pub(crate) fn facts(entry: &Entry) -> Message {
    match entry.facts.as_ref().filter(|_| entry.is_known()) {
        Some(facts) => msg!(
            "{secs:.1} s · {frames, plural, one {# frame} other {# frames}}",
            secs = facts.duration_secs(),
            frames = facts.frames
        ),
        None => super::status(entry).into(),
    }
}

/// Returns the size of a clip's skeleton; empty while it is not known.
pub(crate) fn joints_of(entry: &Entry) -> Message {
    entry.facts.as_ref().map_or_else(Message::default, |facts| {
        msg!("{joints, plural, one {# joint} other {# joints}}", joints = facts.joints)
    })
}

/// Returns the number of selected clips.
pub(crate) fn selected(count: usize) -> Message {
    msg!("{count} selected", count)
}

/// Returns the name of a group of files that were opened together.
pub(crate) fn opened_files(count: usize) -> Message {
    msg!("{count, plural, one {# file} other {# files}}", count)
}

/// Returns the summary of clips that were just added, and of files that were not read.
pub(crate) fn added(added: AddedClips, failed: usize) -> Message {
    let clips =
        msg!("{clips, plural, one {# clip added} other {# clips added}}", clips = added.clips);
    let mut parts = vec![clips];
    if added.with_notes > 0 {
        parts.push(msg!("{notes} with notes", notes = added.with_notes));
    }
    if failed > 0 {
        parts.push(errors(failed));
    }
    Message::joined(parts, " · ")
}

/// Returns the number of notices of failures.
pub(crate) fn errors(count: usize) -> Message {
    msg!("{count, plural, one {# error} other {# errors}}", count)
}

/// Returns the number of notices that wait to be read.
pub(crate) fn notes(count: usize) -> Message {
    msg!("{count, plural, one {# note} other {# notes}}", count)
}
