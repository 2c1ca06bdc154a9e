use crate::clip::{ClipError, MirrorError, RetargetError};
use crate::synth::SynthError;
use crate::transition::FootLockError;

/// Why there is no database, or no controller, and what would do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MatchError {
    /// No clips.
    #[error("motion matching needs clips: choose at least one")]
    NoClips,
    /// A clip has no frame whose future is known.
    #[error(
        "`{name}` lasts {secs:.2} s, which is too short to look {horizon_secs:.2} s ahead: shorten the trajectory, or take a longer clip"
    )]
    TooShort {
        /// The clip's name.
        name: String,
        /// Its duration, seconds.
        secs: f64,
        /// How far the trajectory looks ahead, seconds.
        horizon_secs: f64,
    },
    /// Hips or feet are not known.
    #[error("the skeleton of `{name}` has no {missing}: choose this joint by hand")]
    NoFeet {
        /// The clip's name.
        name: String,
        /// What a person calls the joint.
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
        /// How far the trajectory looks ahead, seconds.
        horizon_secs: f64,
    },
    /// More frames than are held.
    #[error(
        "{frames} frames are more than the {most} that a database holds: take fewer or shorter clips"
    )]
    TooManyFrames {
        /// Frames at the database's rate, mirrored copies included.
        frames: usize,
        /// The most.
        most: usize,
    },
    /// The trajectory times are none.
    #[error(
        "trajectory times must rise from above 0 s to at most {most_secs} s, and be 1 to {most} in number"
    )]
    Times {
        /// The latest time, seconds.
        most_secs: f64,
        /// The most times.
        most: usize,
    },
    /// A number outside its range.
    #[error("{what} of {value} cannot be used: give a number from {least} to {most}")]
    Setting {
        /// Which number.
        what: &'static str,
        /// The number given.
        value: f64,
        /// The least that can be used.
        least: f64,
        /// The most that can be used.
        most: f64,
    },
    /// A feature is no number: a position in the clip is not finite.
    #[error("`{name}` holds a position that is no number")]
    NotFinite {
        /// The clip's name.
        name: String,
    },
    /// A clip cannot be moved to the first clip's skeleton.
    #[error("`{name}`: {error}")]
    Retarget {
        /// The clip's name.
        name: String,
        /// Why.
        error: RetargetError,
    },
    /// A clip has no mirror image.
    #[error("`{name}`: {error}")]
    Mirror {
        /// The clip's name.
        name: String,
        /// Why.
        error: MirrorError,
    },
    /// A clip cannot be resampled, or a result is no clip.
    #[error(transparent)]
    Clip(#[from] ClipError),
    /// A made motion cannot be made.
    #[error(transparent)]
    Synth(#[from] SynthError),
    /// Feet cannot be planted.
    #[error(transparent)]
    FootLock(#[from] FootLockError),
}
