//! Lessons: short guided pages. Each is a state of the document, a text, two or three things to
//! try, and a question with its answer.
//!
//! A lesson is a Markdown file; `docs/lessons.md` says how one is written. What it holds becomes a
//! [`Page`], which knows nothing of a screen. The lessons that come with Segue are fetched when
//! they are opened, in the language that is set; a teacher's own are fetched from their address.

mod address;
mod blocks;
mod html;
mod inline;
mod page;
mod parse;
mod prose;
mod shelf;
mod state;

pub use address::host_of;
pub use page::{Block, Page, Span, Target, Try};
pub use parse::{LessonError, MOST_BYTES, parse};
pub use shelf::{CONTENTS, LESSONS, Source, file_name, source_of};
pub use state::{Lesson, LessonPage};
pub(super) use state::{LessonState, NewParams, would_set_up};

#[cfg(test)]
mod dialect_tests;
#[cfg(test)]
mod state_tests;
#[cfg(test)]
mod tests;
