//! Laying one motion on another: point clouds, their best rigid alignment on the ground, distances between windows of two clips, and the
//! best place to go from one clip to the other.
//!
//! # Windows
//!
//! One convention holds for search, blending and pictures. A transition from clip A to clip B *leaves* A at frame `i`, *enters* B at frame
//! `j` and overlaps `k` frames: the source window runs forward from `i`, `A[i..i + k)`; the target window runs forward from `j`,
//! `B[j..j + k)`. The result is `A[..i]`, the dissolve of the `k` overlapped frames, `B[j + k..]`. A window never crosses the end of its clip.
//!
//! # Units
//!
//! Distances are root-mean-square distances per point. As numbers for people they are scaled to a body of [`REFERENCE_HEIGHT_M`] and given in
//! centimetres ([`rms_cm`]), so that a threshold found with one character carries over to a taller one.

mod align;
mod cloud;
mod clouds;
mod curves;
mod distance;
#[cfg(test)]
pub(crate) mod fixtures;
mod path;
mod path_error;
mod points;
mod pose;
mod self_terms;
mod sweep;
mod terms;
mod transition;

pub use align::{Alignment, align};
pub use clouds::PointClouds;
pub use curves::{Registration, RegistrationOptions};
pub use distance::DistanceMatrix;
pub use path::{MAX_SLOPE_LIMIT, PathEnd, PathOptions, RegistrationPath, optimal_path, path_in_corridor};
pub use path_error::PathError;
pub use points::{REFERENCE_HEIGHT_M, limb_weights, rms_cm, uniform_weights};
pub use pose::{PoseMatch, PoseSearch, PoseWeights};
pub use self_terms::{PausedSelfSweep, SelfSweep, SelfTerms, SymmetricDistances};
pub use sweep::{PausedSweep, Sweep};
pub(crate) use terms::MOST_PAIRS;
pub use terms::{PairTerms, Progress, distances_directly};
pub use transition::{Region, SearchOptions, Transition, TransitionSearch, best_transition};

/// Why two motions cannot be laid on each other.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RegistrationError {
    /// The clouds do not have the same points.
    #[error(
        "two clouds of {source_points} and {target_points} points cannot be laid on each other point by point: use the same joints and frames for both"
    )]
    Points {
        /// Points of the source cloud.
        source_points: usize,
        /// Points of the target cloud.
        target_points: usize,
    },
    /// The weights do not fit the points, or weigh nothing.
    #[error("{found} weights for {expected} joints: give one weight per joint, none negative, and at least one above 0")]
    Weights {
        /// Weights given.
        found: usize,
        /// Joints (or points) to be weighed.
        expected: usize,
    },
    /// A position is not a number.
    #[error("a joint position is not a finite number: repair or crop the clip first")]
    NotFinite,
    /// The clips' skeletons differ.
    #[error("the clips move different skeletons ({source_joints} and {target_joints} joints): retarget one onto the other first")]
    Skeletons {
        /// Joints of the source clip's skeleton.
        source_joints: usize,
        /// Joints of the target clip's skeleton.
        target_joints: usize,
    },
    /// The clips' frame rates differ.
    #[error("the clips run at {source_fps} and {target_fps} frames per second: resample one to the other's rate first")]
    FrameRates {
        /// Frame rate of the source clip.
        source_fps: f64,
        /// Frame rate of the target clip.
        target_fps: f64,
    },
    /// A clip is shorter than the window.
    #[error(
        "a window of {window} frames does not fit into the {which} clip of {frames} frames: lower the window to {frames} or use a longer clip"
    )]
    TooShort {
        /// "outgoing" or "incoming".
        which: &'static str,
        /// Frames of that clip.
        frames: usize,
        /// Frames of the window.
        window: usize,
    },
    /// A clip without frames.
    #[error("the {which} clip has no frames: there is nothing to compare")]
    Empty {
        /// "outgoing" or "incoming".
        which: &'static str,
    },
    /// More pairs than can be held.
    #[error("{pairs} pairs of frames are more than can be compared at once ({most}): crop the clips, or compare every {stride} frames")]
    TooManyPairs {
        /// Pairs of frames asked for.
        pairs: usize,
        /// The most that are held.
        most: usize,
        /// A stride that would do.
        stride: usize,
    },
    /// The sums have not been computed yet.
    #[error("{done} of {total} rows are compared: advance the search to the end first")]
    Unfinished {
        /// Rows done.
        done: usize,
        /// Rows in all.
        total: usize,
    },
}
