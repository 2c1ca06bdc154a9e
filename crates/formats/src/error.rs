//! Errors about files, with the place of the fault.

use super::text::{position, quoted};
use segue_text::Message;

/// An error about a file: its place, the text that stands there, and the text that was expected.
#[derive(
    Clone,
    Debug,
    PartialEq,
    thiserror::Error,
    segue_text::ToMessage,
    serde::Serialize,
    serde::Deserialize,
)]
#[error("{file}:{line}:{column}: found {found}, expected {expected}")]
pub struct ImportError {
    /// The file's name, as the caller gave it.
    pub file: String,
    /// The line, counted from 1. CRLF, LF and a lone CR each end one line.
    pub line: usize,
    /// The column in characters, counted from 1.
    pub column: usize,
    /// The text at that place.
    pub found: Message,
    /// The text that was expected there.
    pub expected: Message,
    /// Advice to the user, where there is better advice than `expected`.
    pub hint: Option<Message>,
}

impl ImportError {
    /// Returns an error about the file as a whole.
    pub(super) fn whole_file(
        file: &str,
        found: impl Into<Message>,
        expected: impl Into<Message>,
    ) -> Self {
        Self {
            file: file.to_owned(),
            line: 1,
            column: 1,
            found: found.into(),
            expected: expected.into(),
            hint: None,
        }
    }

    pub(super) fn with_hint(mut self, hint: impl Into<Message>) -> Self {
        self.hint = Some(hint.into());
        self
    }
}

/// An [`ImportError`] whose place is still a byte offset. Line and column are computed only when
/// the error is reported.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fault {
    pub(super) at: usize,
    pub(super) found: Message,
    pub(super) expected: Message,
    pub(super) hint: Option<Message>,
}

impl Fault {
    pub(super) fn new(at: usize, found: impl Into<Message>, expected: impl Into<Message>) -> Self {
        Self { at, found: found.into(), expected: expected.into(), hint: None }
    }

    /// Returns a fault at `token`, which is empty at the end of the file.
    pub(super) fn at_token(at: usize, token: &[u8], expected: impl Into<Message>) -> Self {
        let found = if token.is_empty() {
            Message::word("the end of the file")
        } else {
            quoted(token).into()
        };
        Self::new(at, found, expected)
    }

    pub(super) fn with_hint(mut self, hint: impl Into<Message>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    pub(super) fn locate(self, file: &str, text: &[u8]) -> ImportError {
        let (line, column) = position(text, self.at);
        ImportError {
            file: file.to_owned(),
            line,
            column,
            found: self.found,
            expected: self.expected,
            hint: self.hint,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn import_error_displays_place_found_and_expected() {
        let fault = Fault::new(7, "`x`", "a number");
        let error = fault.locate("walk.bvh", "ä\r\nbü\rx".as_bytes());
        assert_eq!(error.to_string(), "walk.bvh:2:3: found `x`, expected a number");
        assert_eq!(Fault::new(8, "a", "b").locate("f", "ä\r\nbü\rx".as_bytes()).line, 3);
    }
}
