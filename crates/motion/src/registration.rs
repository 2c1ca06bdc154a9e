//! Registration of motions: point clouds, their best rigid alignment on the ground, distances
//! between windows of two clips, the best transition between two clips, and the time warp between
//! them.
//!
//! # The idea
//!
//! Joint angles are a poor measure of likeness: a degree in the hip moves the foot, a degree in the
//! finger moves nothing. Instead, the joints' *positions* over a window of frames are taken as a
//! cloud of points, the second cloud is shifted and turned over the ground until it fits the first
//! best, and the remaining distance is measured. There is a closed form; with weights w, W = Σw and
//! bars for weighted sums:
//!
//! ```text
//! A = Σw(x z' - x' z) - (x̄ z̄' - x̄' z̄)/W       θ = atan2(A, B)
//! B = Σw(x x' + z z') - (x̄ x̄' + z̄ z̄')/W       D = S + S' - 2·hypot(A, B) + Σw(y - y')²
//! ```
//!
//! S and S' are the centred spreads of both clouds over the ground. `atan(A / B)` in place of
//! `atan2` is half a turn off for half of all clouds: the cause of sudden spins.
//!
//! The distances of all pairs of windows form a picture, a row for each frame of A and a column for
//! each of B. Two walks give dark diagonal valleys, one for every stride; the minima along them are
//! the best transitions ([`TransitionSearch`]). Each term of D is a sum along a diagonal, so the
//! products of single frames are computed once, and another window length is a running sum
//! ([`PairTerms`]). A path along a valley ([`optimal_path`]) assigns frames of A to frames of B:
//! smoothed, it is the time warp of a [`Registration`], with the alignment along it.
//!
//! # Windows and units
//!
//! One convention holds for search, blending and pictures. A transition from clip A to clip B
//! *leaves* A at frame `i`, *enters* B at frame `j` and overlaps `k` frames: the source window runs
//! forward from `i`, `A[i..i + k)`; the target window runs forward from `j`, `B[j..j + k)`. A
//! window never crosses the end of its clip. Distances are root-mean-square distances per point,
//! scaled to a body of [`REFERENCE_HEIGHT_M`] and given in centimetres ([`rms_cm`]), so that a
//! threshold found with one character holds for a taller one.
//!
//! # Example
//!
//! ```
//! use segue_motion::math::Planar;
//! use segue_motion::registration::{PairTerms, Registration, RegistrationOptions};
//! use segue_motion::registration::{align, limb_weights};
//! use segue_motion::synth::{Action, Params, synthesize};
//!
//! let walk = |speed_mps| synthesize(&Params { speed_mps, ..Params::new(Action::Walk) });
//! let (slow, fast) = (walk(1.0)?, walk(1.6)?);
//! let (a, b) = (&slow.clip, &fast.clip);
//! let weights = limb_weights(a.skeleton());
//!
//! // Moved over the ground a motion stays the same, and alignment finds the transform back.
//! let moved = Planar::new(2.5, 3.0, -2.0);
//! let there = a.transformed(&moved);
//! let found = align(&a.world_positions(0..10), &there.world_positions(0..10), &weights, 0.0)?;
//! assert!(found.rms_m() < 1e-5 && found.transform.after(&moved).shift.length() < 1e-5);
//!
//! // Register a cycle of a slow walk with a cycle of a fast one.
//! let mut terms = PairTerms::new(a, 0..a.frames(), b, 0..b.frames(), &weights, 1)?;
//! terms.finish();
//! let matrix = terms.distances(5, &(0..a.frames()), &(0..b.frames()))?;
//! let registered = Registration::new(&terms, &matrix, &RegistrationOptions::new(a.fps()))?;
//! let cycle = f64::from(slow.truth.cycle_secs) * a.fps();
//! let warped = (registered.warp().at(1.5 * cycle) - registered.warp().at(0.5 * cycle)) / cycle;
//! assert!((warped - f64::from(fast.truth.cycle_secs / slow.truth.cycle_secs)).abs() < 0.02);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Accuracy and cost
//!
//! Alignments agree with `SciPy`'s least squares to 1e-9 of the distance, and with a search over
//! 20,000 angles. The fast distances differ from the definition ([`distances_directly`]) by less
//! than 4e-7 m² in the mean square. Paths are the cheapest of *all* paths, verified by enumeration
//! on small matrices. The search over a coarse grid comes within 5 % or 0.2 cm of the best pair of
//! all frames. Cost for N frames, J joints, windows of K: O(N²J) once and O(N²) per window, in
//! place of O(N²JK).
//!
//! # What it does not do
//!
//! It compares joint positions, neither forces nor meaning. Rotations are about the vertical alone:
//! a climb cannot be aligned with a walk. Heights are compared, but never shifted. Clips must have
//! the same skeleton and frame rate.
//!
//! # Sources
//!
//! Kovar, Gleicher, Pighin, "Motion Graphs", 2002, section 3.1 (clouds, alignment, distance).
//! Kovar, Gleicher, "Flexible Automatic Motion Blending with Registration Curves", 2003 (path, time
//! warp, alignment curve). Sakoe, Chiba 1978 (weights of the path's steps).

mod align;
mod cloud;
mod clouds;
mod curves;
mod distance;
#[expect(
    clippy::missing_panics_doc,
    clippy::must_use_candidate,
    clippy::unwrap_used,
    reason = "made for tests"
)]
#[cfg(any(test, feature = "fixtures"))]
pub mod fixtures;
mod path;
mod path_error;
mod points;
mod pose;
mod posed_clip;
mod row_sweep;
mod row_terms;
mod self_terms;
mod sweep;
mod terms;
mod transition;

pub use align::{Alignment, align};
pub(crate) use clouds::{PointClouds, PointCloudsBuilder};
pub use curves::{Registration, RegistrationOptions, RegistrationParts};
pub use distance::DistanceMatrix;
pub use path::{
    MAX_SLOPE_LIMIT, PathEnd, PathOptions, RegistrationPath, TimeWarpSearch, optimal_path,
    path_in_corridor,
};
pub use path_error::PathError;
pub use points::{REFERENCE_HEIGHT_M, limb_weights, rms_cm, uniform_weights};
pub use pose::{PoseMatch, PoseSearch, PoseWeights};
pub(crate) use row_sweep::RowSweep;
pub(crate) use row_terms::RowTerms;
pub(crate) use self_terms::{PausedSelfSweep, SelfSweep, SelfTerms, SymmetricDistances};
pub(crate) use sweep::ROWS_PER_SUM;
pub use sweep::{PausedSweep, Sweep};
pub(crate) use terms::{MAX_PAIRS, check_pairs};
pub use terms::{PairTerms, Progress, distances_directly};
pub use transition::{Region, SearchOptions, TransitionSearch, WindowMatch, best_transition};

/// Error aligning or comparing two motions.
#[derive(Clone, Debug, PartialEq, thiserror::Error, segue_text::ToMessage)]
pub enum RegistrationError {
    /// The clouds do not have the same points.
    #[error(
        "two clouds of {source_points} and {target_points} points cannot be compared point by point: use the same joints and frames for both"
    )]
    Points {
        /// Points of the source cloud.
        source_points: usize,
        /// Points of the target cloud.
        target_points: usize,
    },
    /// The number of weights differs from the number of points, or all are 0.
    #[error(
        "{found} weights for {expected} joints: give one weight per joint, none negative, and at least one above 0"
    )]
    Weights {
        /// Weights given.
        found: usize,
        /// Joints (or points) to be weighted.
        expected: usize,
    },
    /// A position is not a number.
    #[error("a joint position is not a finite number: trim that part of the clip off")]
    NotFinite,
    /// The clips' skeletons differ.
    #[error(
        "the clips move different skeletons ({source_joints} and {target_joints} joints): retarget one onto the other first"
    )]
    Skeletons {
        /// Joints of the source clip's skeleton.
        source_joints: usize,
        /// Joints of the target clip's skeleton.
        target_joints: usize,
    },
    /// The clips' frame rates differ.
    #[error(
        "the clips run at {source_fps} and {target_fps} frames per second: resample one to the other's rate first"
    )]
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
    /// More pairs of frames than can be held in memory.
    #[error(
        "{pairs} pairs of frames are more than can be compared at once ({most}): trim the clips, or divide their frame rate by {stride}"
    )]
    TooManyPairs {
        /// Pairs of frames asked for.
        pairs: usize,
        /// The limit.
        most: usize,
        /// A stride that would fit.
        stride: usize,
    },
    /// The pair sums have not been computed yet.
    #[error("{done} of {total} rows are compared: advance the search to the end first")]
    Unfinished {
        /// Rows done.
        done: usize,
        /// Rows in all.
        total: usize,
    },
}
