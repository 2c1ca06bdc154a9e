//! Lessons: short guided pages. Each has a state of the document, a text, two or three things to
//! try, and a question with its answer.
//!
//! A lesson is a Markdown file in the format of `docs/lessons.md`. It is parsed to [`Page`]s, which
//! know nothing of a screen. The bundled lessons are fetched when they are opened, in the chosen
//! language; a teacher's own are fetched from their address.

mod address;
mod blocks;
mod html;
mod inline;
mod page;
mod parse;
mod prose;
mod sources;
mod state;

pub use address::host_of;
pub use page::{Block, Page, Span, Target, Try};
pub use parse::{LessonError, MAX_BYTES, parse};
pub use sources::{CONTENTS, LESSONS, Source, file_name, source_of};
pub use state::{Lesson, LessonPage};
pub(super) use state::{LessonState, NewParams, would_set_up};

#[cfg(test)]
mod dialect_tests;
#[cfg(test)]
mod state_tests;
#[cfg(test)]
mod tests;
