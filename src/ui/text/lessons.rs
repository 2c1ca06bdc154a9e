//! The texts of the lessons.

use crate::ui::language::Word;
use segue_text::{Message, msg};

/// The button that opens the list of lessons.
pub(crate) const LESSONS: Word = Word::new("Lessons");
/// The hint of the button that opens the list of lessons.
pub(crate) const LESSONS_HELP: Word =
    Word::new("Short guided pages: what to look at, what to try, a question");
/// The tab of the lesson, where it shares its place with the parameters.
pub(crate) const LESSON: Word = Word::new("Lesson");
/// The tab of the parameters, where they share their place with the lesson.
pub(crate) const PARAMETERS: Word = Word::new("Parameters");
/// The accessible name of the tabs of lesson and parameters.
pub(crate) const LESSON_OR_PARAMETERS: Word = Word::new("Lesson or parameters");
/// The button that goes back to the list of lessons.
pub(crate) const ALL_LESSONS: Word = Word::new("All lessons");
/// The button that closes the panel of lessons.
pub(crate) const CLOSE_LESSONS: Word = Word::new("Close the lessons");
/// The button that goes back by a page.
pub(crate) const PREVIOUS_PAGE: Word = Word::new("Previous page");
/// The button above the text that goes on by a page.
pub(crate) const NEXT_PAGE: Word = Word::new("Next page");
/// The button below the text that goes on by a page.
pub(crate) const NEXT: Word = Word::new("Next");
/// The heading of the experiments of a page.
pub(crate) const TRY: Word = Word::new("Try");
/// The heading of the question of a page.
pub(crate) const QUESTION: Word = Word::new("Question");
/// The button that shows the answer.
pub(crate) const SHOW_ANSWER: Word = Word::new("Show answer");
/// The button that hides the answer.
pub(crate) const HIDE_ANSWER: Word = Word::new("Hide answer");
/// The button that stops loading a lesson.
pub(crate) const STOP_LOADING: Word = Word::new("Stop loading");
/// The note while a lesson is loading.
pub(crate) const LESSON_WAITING: Word = Word::new("The lesson is loading…");
/// The button that loads a lesson again after it has failed.
pub(crate) const TRY_AGAIN: Word = Word::new("Try again");

/// Returns the number of a page among those of its lesson.
pub(crate) fn page_of(number: usize, of: usize) -> Message {
    msg!("{number} of {of}", number, of)
}
