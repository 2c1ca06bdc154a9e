//! Errors of corpora.

use segue_motion::clip::{ClipError, RetargetError};
use segue_motion::matching::MatchError;
use segue_motion::synth::SynthError;

/// The reason why bytes of a corpus cannot be read, or a corpus cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum CorpusError {
    /// Bytes end too early.
    #[error("{what}: the bytes end too early")]
    Truncated {
        /// The name of the bytes.
        what: &'static str,
    },
    /// More bytes follow than belong there.
    #[error("{what}: more bytes follow than there should")]
    Surplus {
        /// The name of the bytes.
        what: &'static str,
    },
    /// Bytes of another kind.
    #[error("{what}: these bytes are something else")]
    OtherKind {
        /// The name of the bytes.
        what: &'static str,
    },
    /// A version that this program does not read.
    #[error("{what}: found version {found}, expected {expected}")]
    Version {
        /// The name of the bytes.
        what: &'static str,
        /// The version in the bytes.
        found: u32,
        /// The version that is read.
        expected: u32,
    },
    /// Bytes that cannot be unpacked, or contradict each other.
    #[error("{what}: the bytes are damaged")]
    Damaged {
        /// The name of the bytes.
        what: &'static str,
    },
    /// Numbers that contradict each other.
    #[error("{what}: found {found}, expected {expected}")]
    Mismatch {
        /// The name of the number.
        what: &'static str,
        /// The number.
        found: usize,
        /// The number that was expected.
        expected: usize,
    },
    /// A column that the table does not have, or one of another kind.
    #[error("the table has no column `{0}` of this kind")]
    NoColumn(String),
    /// Text that is no JSON of this kind.
    #[error("the text cannot be read: {0}")]
    Json(#[from] serde_json::Error),
    /// A count or a size that does not fit into 32 bits.
    #[error("a corpus has at most 4,294,967,295 clips, frames, and bytes of a clip")]
    TooLarge,
    /// Poses that make no valid clip.
    #[error(transparent)]
    Clip(#[from] ClipError),
    /// Features cannot be laid out.
    #[error(transparent)]
    Features(#[from] MatchError),
    /// The standard body cannot be synthesised.
    #[error(transparent)]
    Body(#[from] SynthError),
    /// A thumbnail cannot be compressed.
    #[error("a thumbnail cannot be compressed: {0}")]
    Compress(#[from] png::EncodingError),
}

/// The reason why a clip cannot be put on the standard body.
#[derive(Debug, thiserror::Error)]
pub enum PlaceError {
    /// A body that stands on four legs.
    #[error("the body stands on four legs: only people are put on the standard body")]
    FourLegs,
    /// It has no frame.
    #[error("it has no frame")]
    Empty,
    /// It is too long to be held in memory.
    #[error("it lasts {secs:.0} s; clips of up to {max_secs:.0} s are placed")]
    TooLong {
        /// Its duration, seconds.
        secs: f64,
        /// The greatest duration, seconds.
        max_secs: f64,
    },
    /// It has values that are not finite.
    #[error("it has values that are not finite numbers")]
    NotFinite,
    /// It has nothing in common with the body.
    #[error(transparent)]
    Retarget(#[from] RetargetError),
    /// It cannot be resampled.
    #[error(transparent)]
    Clip(#[from] ClipError),
    /// It has no features.
    #[error(transparent)]
    Features(#[from] MatchError),
    /// It cannot be written.
    #[error(transparent)]
    Write(#[from] CorpusError),
}
