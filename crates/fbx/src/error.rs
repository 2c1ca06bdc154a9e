//! Reasons for which a file is not opened.

use ufbx::ErrorType;

/// The reason for which a file was not opened.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OpenError {
    /// The caller's progress function returned `false`.
    #[error("stopped")]
    Stopped,
    /// It is not an FBX file.
    #[error("not an FBX file")]
    NotFbx,
    /// The file ends before its content does.
    #[error("a truncated file")]
    Truncated,
    /// The version of the format is not read.
    #[error("an unsupported version of FBX")]
    Version,
    /// Its content needs more memory than [`max_memory`](crate::OpenOptions::max_memory), or than
    /// there is.
    #[error("more content than fits into memory: export fewer takes at once, or without meshes")]
    Memory,
    /// The keys of its animations, unpacked, need more memory than that.
    #[error("more keys than fit into memory: export fewer takes at once, or fewer keys")]
    Keys,
    /// Nodes lie deeper below each other than the limit.
    #[error("nodes nested too deep")]
    Depth,
    /// Anything else, as ufbx describes it.
    #[error("{0}")]
    Broken(String),
}

impl OpenError {
    /// Returns the error for a file that is not the same when it is read again.
    pub(crate) fn differs() -> Self {
        Self::Broken("a file that differs from itself".into())
    }
}

impl From<ufbx::Error> for OpenError {
    fn from(error: ufbx::Error) -> Self {
        match error.type_ {
            ErrorType::Cancelled => Self::Stopped,
            ErrorType::UnrecognizedFileFormat => Self::NotFbx,
            ErrorType::EmptyFile | ErrorType::TruncatedFile | ErrorType::Io => Self::Truncated,
            ErrorType::UnsupportedVersion => Self::Version,
            ErrorType::OutOfMemory | ErrorType::MemoryLimit | ErrorType::AllocationLimit => {
                Self::Memory
            }
            ErrorType::NodeDepthLimit => Self::Depth,
            _ => Self::Broken(error.description.as_ref().to_owned()),
        }
    }
}
