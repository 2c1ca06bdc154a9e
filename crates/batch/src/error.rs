//! The reasons why files cannot be read, or give no result.

use segue_formats::ImportError;
use segue_session::{CommandError, LabId};
use std::io;
use std::path::PathBuf;

/// The reason why there are no bytes of a file.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// It is larger than what is read.
    #[error(
        "{name} has {mb} MB; files of up to {max_mb} MB are read",
        mb = .bytes.div_ceil(1 << 20), max_mb = .max_bytes >> 20
    )]
    TooLarge {
        /// Its path with `/` between folders.
        name: String,
        /// Its size, bytes.
        bytes: u64,
        /// The greatest size, bytes.
        max_bytes: usize,
    },
    /// The system does not give it.
    #[error("{name} cannot be read: {error}")]
    System {
        /// Its path with `/` between folders.
        name: String,
        /// The path by which it was opened.
        path: PathBuf,
        /// The message of the operating system.
        error: io::Error,
    },
}

/// The reason why a session gives no result.
#[derive(Debug, thiserror::Error)]
pub enum BatchError {
    /// A link opens another lab than the one that was asked for.
    #[error("the link opens the lab `{word}`", word = .0.word())]
    OtherLab(LabId),
    /// A lab takes another number of clips.
    #[error("`{word}` takes {expected}; here are {found}", word = .lab.word())]
    Clips {
        /// The lab.
        lab: LabId,
        /// The number that it takes, in words.
        expected: &'static str,
        /// The number of clips.
        found: usize,
    },
    /// A value or clip that does not fit.
    #[error(transparent)]
    Command(#[from] CommandError),
    /// There is no parameter of that name.
    #[error("`{0}` is not a parameter: docs/parameters.md has all")]
    NoParameter(String),
    /// A file has no bytes.
    #[error(transparent)]
    File(#[from] FileError),
    /// A file cannot be read.
    #[error("{}", import_text(.0))]
    Import(Box<ImportError>),
    /// A file was read, and cannot be used.
    #[error("{0}")]
    Unusable(String),
}

impl From<ImportError> for BatchError {
    fn from(error: ImportError) -> Self {
        Self::Import(Box::new(error))
    }
}

/// Returns an error about a file as a sentence, with the advice that it has.
#[must_use]
pub fn import_text(error: &ImportError) -> String {
    match &error.hint {
        Some(hint) => format!("{error} ({hint})"),
        None => error.to_string(),
    }
}
