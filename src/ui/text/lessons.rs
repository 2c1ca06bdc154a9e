//! The texts of the lessons.

use segue_text::{Message, msg};

/// The button that opens the list of lessons.
pub(crate) const LESSONS: &str = "Lessons";
/// Its hint.
pub(crate) const LESSONS_HELP: &str =
    "Short guided pages: what to look at, what to try, a question";
/// Of the page, where it shares its place with the parameters.
pub(crate) const LESSON: &str = "Lesson";
/// See [`LESSON`].
pub(crate) const PARAMETERS: &str = "Parameters";
/// What the two are, for a screen reader.
pub(crate) const LESSON_OR_PARAMETERS: &str = "Lesson or parameters";
/// Back to the list.
pub(crate) const ALL_LESSONS: &str = "All lessons";
/// Closes the panel.
pub(crate) const CLOSE_LESSONS: &str = "Close the lessons";
/// To the page before.
pub(crate) const PREVIOUS_PAGE: &str = "Previous page";
/// To the page behind.
pub(crate) const NEXT_PAGE: &str = "Next page";
/// Likewise, below the text.
pub(crate) const NEXT: &str = "Next";
/// Over what there is to try.
pub(crate) const TRY: &str = "Try";
/// Over the question.
pub(crate) const QUESTION: &str = "Question";
/// Shows what was hidden.
pub(crate) const SHOW_ANSWER: &str = "Show answer";
/// And hides it.
pub(crate) const HIDE_ANSWER: &str = "Hide answer";
/// Ends the wait for a text.
pub(crate) const STOP_LOADING: &str = "Stop loading";
/// While a text is under way.
pub(crate) const LESSON_WAITING: &str = "The lesson is loading…";
/// After it did not come.
pub(crate) const TRY_AGAIN: &str = "Try again";

/// The place of a page.
pub(crate) fn page_of(number: usize, of: usize) -> Message {
    msg!("{number} of {of}", number, of)
}
