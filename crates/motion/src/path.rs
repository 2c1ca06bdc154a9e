//! Path editing: motion that follows an edited path over the ground.
//!
//! # The idea
//!
//! A walk is separated into its path and the motion of the body along it. The trajectory of the
//! character's root over the ground is fitted by a cubic B-spline C(u) with N control points; the
//! residual of the fit, sway of the hips and the angle between body and path, is kept in the path's
//! moving frame: +Z along the path, +X to its left.
//!
//! ```text
//! fit     min  mean |C(u_k) - p_k|² + smoothing · mean |h Δ_i|²
//!         Δ: change of slope of the control polygon, h: spacing of its points
//! carry   new(k) = new path(v_k) · path(u_k)⁻¹ · character(k)
//!         v_k: the place on the new path, by Timing
//! ```
//!
//! Picture a dancer in a tram: bend the rails, and the dance goes along. When the path changes,
//! every frame is moved with the frame of the path that it belongs to ([`carry()`]), and the feet
//! are planted again ([`PathEditor`]). [`Timing`] determines whether distance, speed or duration is
//! kept when a path becomes longer. [`hard_turns`] reports turns that are sharper than those of the
//! original motion (curvature × speed).
//!
//! # Example
//!
//! ```
//! use glam::DVec2;
//! use segue_motion::clip::{Clip, Motion};
//! use segue_motion::path::{
//!     ArcLengthPath, CarryOptions, FitOptions, FittedPath, PathEdit, Pins, carry,
//! };
//! use segue_motion::synth::{Action, Params, synthesize};
//! use std::sync::Arc;
//!
//! let walk = Arc::new(synthesize(&Params::new(Action::Walk))?.clip);
//! let fit = FitOptions { control_points: 6, ..FitOptions::default() };
//! let path = FittedPath::new(Arc::new(Motion::analyze(Arc::clone(&walk))), &fit)?;
//! assert!(path.error().rms_cm < 5.0);
//!
//! // On its own path the walk is itself.
//! let same = carry(&path, path.curve(), &CarryOptions::default())?.clip;
//! let mut pairs = same.root_translations().iter().zip(walk.root_translations());
//! assert!(pairs.all(|(p, q)| p.distance(*q) < 1e-4));
//!
//! // The fourth control point half a metre to the left: the walk makes a curve.
//! let spline = path.curve().spline();
//! let to = spline.points()[3] + DVec2::new(0.5, 0.0);
//! let bow = spline.edited(&PathEdit::Move { index: 3, to }, Pins::default())?;
//! let out = carry(&path, &ArcLengthPath::new(bow)?, &CarryOptions::default())?.clip;
//! let left = |clip: &Clip| clip.root_translations().iter().map(|p| p.x).fold(0.0, f32::max);
//! assert!(left(&walk) < 0.05 && left(&out) > 0.25 && out.frames() == walk.frames());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Accuracy and cost
//!
//! An unedited path reproduces its motion to 1e-4 m and 1e-4 radians, and a path that is moved
//! rigidly moves it rigidly. Control points agree with `SciPy`'s least squares to 1e-9 m. Joints of
//! one frame keep their distances whatever is done to the path, until feet are planted. A fit is
//! O(frames + control points), a carried motion O(frames × joints).
//!
//! # What it does not do
//!
//! It bends motions, and neither adds nor removes steps: a path of twice the length is walked
//! halfway, or with strides twice as long, by [`Timing`]. A motion in place has no path. Balance is
//! not maintained: a character on a hairpin does not lean.
//!
//! # Sources
//!
//! Gleicher, "Motion Path Editing", 2001. de Boor, "A Practical Guide to Splines"; Boehm 1980
//! (adding a knot); Dierckx 1993, section 4.1 (least squares by rotations); Eilers and Marx 1996
//! (smoothing).

use crate::clip::ClipError;
use crate::transition::FootLockError;

mod arc_length;
mod carry;
mod code;
mod edit;
mod fit;
mod fitted;
mod motion;
mod spline;
mod turning;

pub use arc_length::{ArcLengthPath, Waypoint};
pub use carry::{CarriedMotion, CarryOptions, Offset, Orientation, Timing, carry};
pub use edit::{PathEdit, Pins};
pub use fit::{FitOptions, MAX_SMOOTHING, drawn_path, fit_spline};
pub use fitted::{FitError, FittedPath, PathFitting};
pub use motion::{EditedMotion, MotionCarrying, MotionOptions, PathEditor, Slide};
pub use spline::{GroundSpline, Jet, MAX_DISTANCE_M, MAX_POINTS, MIN_POINTS, SplineEnds};
pub use turning::{HardTurn, hard_turns, turn_rates};

/// Error fitting, editing or following a path.
#[derive(Clone, Debug, PartialEq, thiserror::Error, segue_text::ToMessage)]
pub enum PathEditError {
    /// The clip is too short to have a path.
    #[error("a clip of {frames} frames has no path over the ground: choose one of at least two")]
    Frames {
        /// Number of frames.
        frames: usize,
    },
    /// The character does not travel.
    #[error(
        "this motion stays within {extent_cm:.0} cm, so it has no path to edit: choose one that travels",
        extent_cm = extent_m * 100.0
    )]
    NoTravel {
        /// The diagonal of the bounding box of the root's trajectory, metres.
        extent_m: f64,
    },
    /// The path is shorter than the least length.
    #[error(
        "a path of {length_cm:.1} cm has no direction: draw its control points apart",
        length_cm = length_m * 100.0
    )]
    NoLength {
        /// Its length, metres.
        length_m: f64,
    },
    /// Too few or too many control points.
    #[error("a path of {points} control points cannot be used: take {MIN_POINTS} to {MAX_POINTS}")]
    ControlPoints {
        /// The number asked for.
        points: usize,
    },
    /// A point that is not finite, or too far from the origin.
    #[error("point {index} is not within {MAX_DISTANCE_M} m of the origin")]
    Point {
        /// Index of the point.
        index: usize,
    },
    /// Knots that do not rise, or not as many as needed.
    #[error(
        "knots have to rise between 0 and 1, four fewer than control points and not too close to each other: choose another place"
    )]
    Knots,
    /// Parameters that are out of range, equal or descending.
    #[error(
        "each point needs a parameter from 0 to 1, at least two of them different, and none below the one before"
    )]
    Parameters,
    /// An index beyond the last control point.
    #[error("there is no control point {index} among {points}")]
    NoSuchPoint {
        /// The index.
        index: usize,
        /// Number of control points.
        points: usize,
    },
    /// A control point that must not be removed.
    #[error("control point {index} cannot be removed: ends stay, and so do the last {least}")]
    NotRemoved {
        /// Index of the point.
        index: usize,
        /// The least number of points of this path.
        least: usize,
    },
    /// An end that is pinned.
    #[error("an end of the path is pinned: free it first")]
    Pinned,
    /// Too few control points for a closed path.
    #[error("{points} control points do not make a loop: add points until there are {least}")]
    TooFewToClose {
        /// Number of control points.
        points: usize,
        /// The least number of points of a closed path.
        least: usize,
    },
    /// A number out of range.
    #[error("a {what} of {value} cannot be used: give a number from {least} to {most}")]
    Option {
        /// Name of the number.
        what: &'static str,
        /// The number given.
        value: f64,
        /// The smallest number.
        least: f64,
        /// The largest number.
        most: f64,
    },
    /// A text that is not an encoded path.
    #[error("this is not a path from a link: copy the whole link")]
    Code,
    /// Feet cannot be planted.
    #[error(transparent)]
    FootLock(#[from] FootLockError),
    /// The result is not a valid clip.
    #[error(transparent)]
    Clip(#[from] ClipError),
}
