//! The texts of the lessons.

use crate::ui::language::Word;
use segue_text::{Message, msg};

/// The button that opens the list of lessons.
pub(crate) const LESSONS: Word = Word::new("Lessons");
/// Its hint.
pub(crate) const LESSONS_HELP: Word =
    Word::new("Short guided pages: what to look at, what to try, a question");
/// Of the page, where it shares its place with the parameters.
pub(crate) const LESSON: Word = Word::new("Lesson");
/// See [`LESSON`].
pub(crate) const PARAMETERS: Word = Word::new("Parameters");
/// What the two are, for a screen reader.
pub(crate) const LESSON_OR_PARAMETERS: Word = Word::new("Lesson or parameters");
/// Back to the list.
pub(crate) const ALL_LESSONS: Word = Word::new("All lessons");
/// Closes the panel.
pub(crate) const CLOSE_LESSONS: Word = Word::new("Close the lessons");
/// To the page before.
pub(crate) const PREVIOUS_PAGE: Word = Word::new("Previous page");
/// To the page behind.
pub(crate) const NEXT_PAGE: Word = Word::new("Next page");
/// Likewise, below the text.
pub(crate) const NEXT: Word = Word::new("Next");
/// Over what there is to try.
pub(crate) const TRY: Word = Word::new("Try");
/// Over the question.
pub(crate) const QUESTION: Word = Word::new("Question");
/// Shows what was hidden.
pub(crate) const SHOW_ANSWER: Word = Word::new("Show answer");
/// And hides it.
pub(crate) const HIDE_ANSWER: Word = Word::new("Hide answer");
/// Ends the wait for a text.
pub(crate) const STOP_LOADING: Word = Word::new("Stop loading");
/// While a text is under way.
pub(crate) const LESSON_WAITING: Word = Word::new("The lesson is loading…");
/// After it did not come.
pub(crate) const TRY_AGAIN: Word = Word::new("Try again");

/// The place of a page.
pub(crate) fn page_of(number: usize, of: usize) -> Message {
    msg!("{number} of {of}", number, of)
}
