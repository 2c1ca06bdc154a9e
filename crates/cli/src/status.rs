//! How a run ends: the exit codes, and the errors that end it.

use crate::labs::command_of;
use segue_batch::{BatchError, FileError};
use std::fmt;
use std::io;
use std::process::ExitCode;

/// The exit codes, for `--help`.
pub(crate) const EXIT_CODES: &str = "\
Exit codes:
  0  all is well
  1  findings of `lint` that fail, or clips that give no result
  2  the command line is wrong
  3  a file could not be read or written; what the others gave is there";

/// The result of a run. Of several, the greatest is the exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Status {
    /// All is well.
    Fine = 0,
    /// There are findings, or there is no result.
    Findings = 1,
    /// The command line is wrong.
    Usage = 2,
    /// A file could not be read or written.
    Unreadable = 3,
}

impl From<Status> for ExitCode {
    fn from(status: Status) -> Self {
        Self::from(status as u8)
    }
}

/// The reason why a run ended early.
#[derive(Clone, Debug)]
pub(crate) struct Failure {
    /// The exit code.
    pub(crate) status: Status,
    /// The sentence; empty where the reader of the output has left.
    text: String,
}

impl Failure {
    /// Returns the failure of a wrong command line.
    pub(crate) fn usage(text: impl Into<String>) -> Self {
        Self { status: Status::Usage, text: text.into() }
    }

    /// Returns the failure of a file that cannot be read or written.
    pub(crate) fn unreadable(text: impl Into<String>) -> Self {
        Self { status: Status::Unreadable, text: text.into() }
    }

    /// Returns the sentence; `None` where nobody reads it.
    pub(crate) fn text(&self) -> Option<&str> {
        Some(self.text.as_str()).filter(|text| !text.is_empty())
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl From<io::Error> for Failure {
    /// Converts an error of writing to the terminal or a pipe. A pipe that was closed, as by
    /// `head`, is none.
    fn from(error: io::Error) -> Self {
        if error.kind() == io::ErrorKind::BrokenPipe {
            return Self { status: Status::Fine, text: String::new() };
        }
        Self::unreadable(format!("the output cannot be written: {error}"))
    }
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        Self::unreadable(error.to_string())
    }
}

impl From<BatchError> for Failure {
    fn from(error: BatchError) -> Self {
        let name = |lab: segue_session::LabId| {
            command_of(lab.word()).map_or(lab.word(), |command| command.name)
        };
        match error {
            BatchError::OtherLab(lab) => Self::usage(format!(
                "the link opens another lab: use `segue {} --link …`",
                name(lab)
            )),
            BatchError::Clips { lab, expected, found } => {
                Self::usage(format!("`segue {}` takes {expected}; here are {found}", name(lab)))
            }
            error @ (BatchError::Command(_) | BatchError::NoParameter(_)) => {
                Self::usage(error.to_string())
            }
            BatchError::File(error) => error.into(),
            error @ (BatchError::Import(_) | BatchError::Unusable(_)) => {
                Self::unreadable(error.to_string())
            }
        }
    }
}
