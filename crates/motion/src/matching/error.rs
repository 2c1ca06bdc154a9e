//! Errors of databases and controllers.

use crate::clip::{ClipError, MirrorError, RetargetError};
use crate::synth::SynthError;
use crate::transition::FootLockError;

/// Error building a database or a controller.
#[derive(Clone, Debug, PartialEq, thiserror::Error, segue_text::ToMessage)]
pub enum MatchError {
    /// There are no clips.
    #[error("motion matching needs clips: choose at least one")]
    NoClips,
    /// A clip has no frame whose trajectory is known.
    #[error(
        "`{name}` lasts {secs:.2} s, which is too short to look {horizon_secs:.2} s ahead: shorten the trajectory, or choose a longer clip"
    )]
    TooShort {
        /// The clip's name.
        name: String,
        /// Its duration, seconds.
        secs: f64,
        /// The farthest trajectory time, seconds.
        horizon_secs: f64,
    },
    /// Hips or feet are unknown.
    #[error("the skeleton of `{name}` has no {missing}: set its body parts")]
    NoFeet {
        /// The clip's name.
        name: String,
        /// Name of the joint on screen.
        missing: &'static str,
    },
    /// All clips are too short.
    #[error(
        "none of the {clips} clips has a frame that can be searched: the longest lasts {longest_secs:.2} s, the trajectory looks {horizon_secs:.2} s ahead"
    )]
    NoValidFrame {
        /// Clips given.
        clips: usize,
        /// Duration of the longest, seconds.
        longest_secs: f64,
        /// The farthest trajectory time, seconds.
        horizon_secs: f64,
    },
    /// More frames than a database may hold.
    #[error(
        "{frames} frames are more than the {most} that a database holds: choose fewer or shorter clips"
    )]
    TooManyFrames {
        /// Frames at the database's rate, mirrored copies included.
        frames: usize,
        /// The limit.
        most: usize,
    },
    /// The trajectory times are out of range.
    #[error(
        "trajectory times must rise from above 0 s to at most {most_secs} s, and be 1 to {most} in number"
    )]
    Times {
        /// The greatest time, seconds.
        most_secs: f64,
        /// The greatest number of times.
        most: usize,
    },
    /// A number out of range.
    #[error("{what} of {value} cannot be used: give a number from {least} to {most}")]
    Setting {
        /// Name of the number.
        what: &'static str,
        /// The number given.
        value: f64,
        /// The least value.
        least: f64,
        /// The greatest value.
        most: f64,
    },
    /// A feature is not finite, because a position in the clip is not.
    #[error("`{name}` contains a position that is not a number")]
    NotFinite {
        /// The clip's name.
        name: String,
    },
    /// A clip cannot be retargeted to the first clip's skeleton.
    #[error("`{name}`: {error}")]
    Retarget {
        /// The clip's name.
        name: String,
        /// The reason.
        error: RetargetError,
    },
    /// A clip has no mirror image.
    #[error("`{name}`: {error}")]
    Mirror {
        /// The clip's name.
        name: String,
        /// The reason.
        error: MirrorError,
    },
    /// A clip cannot be resampled, or a result is not a valid clip.
    #[error(transparent)]
    Clip(#[from] ClipError),
    /// A motion cannot be synthesised.
    #[error(transparent)]
    Synth(#[from] SynthError),
    /// Feet cannot be planted.
    #[error(transparent)]
    FootLock(#[from] FootLockError),
}
