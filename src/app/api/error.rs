//! Errors of the page's API.

use segue_session::export::{ExportBody, ExportError, ExportFormat, ExportRoot};
use segue_session::{CommandError, LabError, NoResult, ValueError};
use segue_text::Message;

/// The reason why a call of the page's API is rejected. Its `Display` is the text of the rejection.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum ApiError {
    /// A key that is not in the table of parameters.
    #[error("`{0}` is not a parameter; keys() lists them")]
    UnknownKey(String),
    /// A value that does not fit its parameter.
    #[error(transparent)]
    Value(#[from] ValueError),
    /// A parameter whose value names a clip that does not exist.
    #[error("{key}: {error}")]
    NoClip {
        /// The key of the parameter.
        key: &'static str,
        /// The error with the id of the clip.
        error: CommandError,
    },
    /// A list of clips that no motion graph can be built from.
    #[error("{key}: {error}")]
    GraphClips {
        /// The key of the parameter.
        key: &'static str,
        /// The reason.
        error: LabError,
    },
    /// A command that the session refused.
    #[error(transparent)]
    Command(#[from] CommandError),
    /// A file that was not loaded.
    #[error("{0}")]
    Load(Message),
    /// A name that no file under way has.
    #[error("stop: found `{0}`, expected the name of a file that is under way")]
    NotUnderWay(String),
    /// A time that is not finite.
    #[error("{call}: found {secs}, expected seconds")]
    NotSeconds {
        /// The name of the call.
        call: &'static str,
        /// The time.
        secs: f64,
    },
    /// A name of neither a clip nor a result.
    #[error("found `{0}`, expected the id of a clip, `result`, or `result:1` for the second pane")]
    UnknownMotion(String),
    /// The index of a result beyond the last pane.
    #[error("found `{found}`, expected a pane from `result:0` to `result:{last}`")]
    UnknownPane {
        /// The name of the result.
        found: String,
        /// The index of the last pane.
        last: usize,
    },
    /// A name of no result, where only a result can be used.
    #[error("found `{0}`, expected `result`, or `result:1` for the second pane")]
    NotAResult(String),
    /// A clip of the library whose motion is not in memory.
    #[error("`{0}` is not loaded yet; put it into a or b first")]
    NotLoaded(String),
    /// A clip without frames has no pose.
    #[error("the clip has no frames")]
    NoFrames,
    /// A pane without a result.
    #[error(transparent)]
    NoResult(#[from] NoResult),
    /// A name of no export format.
    #[error("found `{0}`, expected one of {names}", names = ExportFormat::ALL.map(ExportFormat::name).join(", "))]
    UnknownFormat(String),
    /// A name of no body for export.
    #[error("found `{0}`, expected one of {names}", names = ExportBody::ALL.map(ExportBody::name).join(", "))]
    UnknownBody(String),
    /// A name of no joint for the motion over the ground.
    #[error("root: found `{0}`, expected one of {names}", names = ExportRoot::ALL.map(ExportRoot::name).join(", "))]
    UnknownRoot(String),
    /// A frame rate out of range.
    #[error("fps: found {0}, expected 1 to 1000 frames per second")]
    UnfitRate(f64),
    /// A storage that does not answer.
    #[error(
        "loaded: the browser's storage has not answered for 30 s: stored clips are missing; close other windows of Segue and reload"
    )]
    StorageLate,
    /// A motion that cannot be written in the format.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// A recording that cannot begin.
    #[error("record: {0}")]
    Recording(Message),
}
