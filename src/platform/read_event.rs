//! Events of files that a thread or worker reads.

use super::LargeFile;
use segue_session::reading::ReadReport;
use segue_text::{Message, ToMessage};

/// An event of a file that a thread or worker reads.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ReadEvent {
    /// The number of bytes that are read.
    Progress(u64),
    /// The bytes of a small new file, to be stored, or of one that was written.
    Bytes(LargeFile),
    /// There is no memory for the report; the number of bytes that it needs.
    NoRoom(u64),
    /// The end of the task.
    Done(Result<ReadReport, ReadError>),
}

/// The reason why a file was not read, as a clause.
#[cfg_attr(
    not(target_arch = "wasm32"),
    expect(dead_code, reason = "a thread starts, and hands over its report as it is")
)]
#[derive(Clone, Debug, PartialEq, thiserror::Error, ToMessage)]
pub(crate) enum ReadError {
    /// The platform no longer holds the file.
    #[error("it is no longer available: drop it again")]
    Lost,
    /// The browser has no room for a copy of the file.
    #[error("there is no room for the file")]
    NoRoom,
    /// The page has set no function that makes a worker.
    #[error("the page makes no workers")]
    NoWorkers,
    /// The worker's program could not be loaded.
    #[error("the worker could not be started")]
    NotStarted,
    /// The worker ended without a report.
    #[error("the worker sent nothing")]
    NoReport,
    /// A file cannot be made of it, for this reason.
    #[error("{0}")]
    Refused(Message),
    /// The worker's report cannot be unpacked.
    #[error("{0}")]
    InvalidReport(Message),
    /// A failure of the browser or of the worker, in its own words.
    #[error("{0}")]
    Failed(String),
}
