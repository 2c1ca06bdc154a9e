//! The bundled lessons, and the sources of lessons' texts.

use crate::outside::short;
use segue_text::{Message, msg};

/// The bundled lessons, in order.
pub const LESSONS: [&str; 15] = [
    "alignment",
    "slerp",
    "blend_window",
    "half_life",
    "loops",
    "time_warp",
    "distance_matrix",
    "segment_size",
    "edge_weights",
    "atan",
    "first_frame",
    "path_editing",
    "motion_matching",
    "foot_skate",
    "clean",
];

/// The name of the table of contents, in place of a lesson.
pub const CONTENTS: &str = "contents";

/// The source of a lesson's text.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Source {
    /// A bundled file, as in `en/01-alignment.md`.
    BuiltIn(String),
    /// An address on the web.
    Web(String),
}

/// Returns the file of a bundled lesson, as in `01-alignment.md`; the table of contents for
/// [`CONTENTS`].
#[must_use]
pub fn file_name(lesson: &str) -> Option<String> {
    if lesson == CONTENTS {
        return Some("index.md".to_owned());
    }
    let at = LESSONS.iter().position(|name| *name == lesson)?;
    Some(format!("{:02}-{lesson}.md", at + 1))
}

/// Returns the lesson in a bundled file.
pub(super) fn lesson_of_file(name: &str) -> Option<&'static str> {
    let (_, lesson) = name.strip_suffix(".md")?.split_once('-')?;
    let lesson = LESSONS.iter().find(|known| **known == lesson)?;
    (file_name(lesson)? == name).then_some(lesson)
}

/// Returns the source of the text that the parameter `lesson` names, in a language, and the index
/// of its page.
///
/// # Errors
/// A message with the value found, and the valid ones.
pub fn source_of(lesson: &str, lang: &str) -> Result<(Source, usize), Message> {
    if lesson.starts_with("https://") || lesson.starts_with("http://") {
        let (address, page) = lesson.split_once('#').unwrap_or((lesson, "1"));
        let page = page.parse::<usize>().unwrap_or(1).max(1) - 1;
        return Ok((Source::Web(address.to_owned()), page));
    }
    match file_name(lesson) {
        Some(file) => Ok((Source::BuiltIn(format!("{lang}/{file}")), 0)),
        None => Err(msg!(
            "lesson: found `{found}`, expected {contents}, {lessons}, or an address that starts with https://.",
            found = short(lesson),
            contents = CONTENTS.to_owned(),
            lessons = LESSONS.map(str::to_owned).to_vec()
        )),
    }
}
