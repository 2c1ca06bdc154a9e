//! The texts of the panel in which many files are converted.

use crate::ui::language::Word;
use segue_text::{Message, msg};

pub(crate) const CONVERT_FILES: Word = Word::new("Convert many files…");
pub(crate) const CONVERT_CLIPS: Word = Word::new("Convert…");
pub(crate) const CONVERT_TITLE: Word = Word::new("Convert many files");
pub(crate) const CONVERT_HELP: Word = Word::new(
    "Drop files, a folder or a zip here. Each is read and saved in one format; they do not join the library. The results come back as one zip with a table.",
);
pub(crate) const CHOOSE_FILES: Word = Word::new("Choose files…");
pub(crate) const CONVERT: Word = Word::new("Convert");
pub(crate) const CLEAR_FILES: Word = Word::new("Clear");
pub(crate) const CONVERT_BODY: Word = Word::new("Skeleton");
pub(crate) const BODY_OWN: Word = Word::new("as it is");
pub(crate) const BODY_OF_A: Word = Word::new("that of A");
pub(crate) const CONVERT_FILE: Word = Word::new("Files");
pub(crate) const FILE_FOR_EACH: Word = Word::new("one for each clip");
pub(crate) const ONE_FILE: Word = Word::new("one for all");
pub(crate) const ONE_FILE_HELP: Word = Word::new(
    "Each clip becomes an animation on one skeleton: that of A or of the character if chosen, otherwise that of the first clip. Clips of other skeletons are put on it.",
);
pub(crate) const SAVE_TOGETHER: Word = Word::new("Save together…");
pub(crate) const CONVERTING: Word = Word::new("Converting");

/// Returns how many files wait to be converted.
pub(crate) fn files_waiting(count: usize) -> Message {
    msg!("{count, plural, one {# file or clip} other {# files and clips}}", count)
}

/// Returns how many files of all are done.
pub(crate) fn files_done(done: usize, all: usize) -> Message {
    msg!("{done} of {all}", done, all)
}

/// Returns what came of a conversion.
pub(crate) fn conversion_result(good: usize, odd: usize, failed: usize) -> Message {
    msg!("{good} saved, {odd} of them with warnings; {failed} failed", good, odd, failed)
}

/// Returns the number of lines of the table that are not shown.
pub(crate) fn lines_left_out(count: usize) -> Message {
    msg!("{count} more in the table of the zip, conversion.csv", count)
}
