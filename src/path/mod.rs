//! Path editing: drag the road, the character follows (Gleicher, Motion Path Editing, 2001).
//!
//! The way of a character's root over the ground is fitted by a cubic B-spline. What the fit leaves over, sway of the hips and the angle between
//! body and path, is kept in the path's moving frame: +Z along the path, +X to its left. When the path changes, every frame is moved with the frame of the path
//! that it rides in, and the feet are planted again. Turns that are sharper than the motion knows are told.
//!
//! Accuracy: a path that is not edited gives its motion back to 1e-4 m and 1e-4 rad, and one that is moved rigidly moves it rigidly. What it does not do: it
//! bends motions, and neither invents steps nor takes them away; a path of twice the length is walked halfway, or with strides twice as long, as
//! [`Timing`] says.
//!
//! ```
//! use glam::DVec2;
//! use segue::blend::Source;
//! use segue::path::{CarryOptions, FitOptions, FittedPath, PathEdit, Pins, Road, carry};
//! use segue::skeleton::Roles;
//! use segue::synth::{Action, Params, synthesize};
//! use std::sync::Arc;
//!
//! let walk = Arc::new(synthesize(&Params::new(Action::Walk))?.clip);
//! let roles = Roles::detect(walk.skeleton());
//! let path = FittedPath::new(Arc::new(Source::new(walk, &roles)), &FitOptions { control_points: 6, ..FitOptions::default() })?;
//! assert!(path.error().rms_cm < 5.0);
//!
//! // The fourth control point half a metre to the left: the walk takes a bow.
//! let spline = path.road().spline();
//! let to = spline.points()[3] + DVec2::new(0.5, 0.0);
//! let bow = spline.edited(&PathEdit::Move { index: 3, to }, Pins::default())?;
//! let out = carry(&path, &Road::new(bow)?, &CarryOptions::default())?;
//! assert_eq!(out.clip.frames(), path.source().clip().frames());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::clip::ClipError;
use crate::transition::FootLockError;

mod carry;
mod code;
mod edit;
mod fit;
mod fitted;
mod motion;
mod road;
mod spline;
mod turning;

pub use carry::{Carried, CarryOptions, Orientation, Timing, carry};
pub use edit::{PathEdit, Pins};
pub use fit::{FitOptions, MOST_SMOOTHING, drawn_path, fit_spline};
pub use fitted::{FitError, FittedPath};
pub use motion::{EditedMotion, MotionOptions, PathEditor, Slide};
pub use road::{Road, Waypoint};
pub use spline::{FARTHEST_M, GroundSpline, Jet, LEAST_POINTS, MOST_POINTS};
pub use turning::{HardTurn, hard_turns, turn_rates};

/// Why a path cannot be fitted, edited or walked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PathEditError {
    /// No motion to take a path from.
    #[error("{frames} frames are no way over the ground: take a clip of two or more")]
    Frames {
        /// Frames that there are.
        frames: usize,
    },
    /// The character does not go anywhere.
    #[error("this motion stays within {:.0} cm, so that there is no path to edit: take one that goes somewhere, or move the whole clip", extent_m * 100.0)]
    Stands {
        /// The diagonal of the box around the root's way, metres.
        extent_m: f64,
    },
    /// A path that is a point.
    #[error("a path of {:.1} cm has no direction: draw its control points apart", length_m * 100.0)]
    NoLength {
        /// Its length, metres.
        length_m: f64,
    },
    /// Too few or too many control points.
    #[error("a path of {points} control points cannot be used: take {LEAST_POINTS} to {MOST_POINTS}")]
    ControlPoints {
        /// The number asked for.
        points: usize,
    },
    /// A point that is no place.
    #[error("point {index} is not within {FARTHEST_M} m of the origin")]
    Point {
        /// Which.
        index: usize,
    },
    /// Knots that do not fit.
    #[error("knots have to rise between 0 and 1, four fewer than control points and not too close to each other: take another place")]
    Knots,
    /// Parameters that are none.
    #[error("each point needs a parameter from 0 to 1, at least two of them different, and none below the one before")]
    Parameters,
    /// A control point that is not there.
    #[error("there is no control point {index} among {points}")]
    NoSuchPoint {
        /// Which.
        index: usize,
        /// Points that there are.
        points: usize,
    },
    /// A control point that has to stay.
    #[error("control point {index} cannot be removed: ends stay, and so do the last {least}")]
    NotRemoved {
        /// Which.
        index: usize,
        /// The fewest points of this path.
        least: usize,
    },
    /// An end that has to stay where it is.
    #[error("an end of the path is pinned: free it first")]
    Pinned,
    /// Too few control points for a loop.
    #[error("{points} control points do not make a loop: add points until there are {least}")]
    TooFewToClose {
        /// Points that there are.
        points: usize,
        /// Points that a loop needs.
        least: usize,
    },
    /// A number out of range.
    #[error("a {what} of {value} cannot be used: give a number from {least} to {most}")]
    Option {
        /// Which number.
        what: &'static str,
        /// The number given.
        value: f64,
        /// The smallest number.
        least: f64,
        /// The largest number.
        most: f64,
    },
    /// A word that is no path.
    #[error("this is not a path from a link: copy the whole link")]
    Code,
    /// Feet cannot be planted.
    #[error(transparent)]
    FootLock(#[from] FootLockError),
    /// The result is no clip.
    #[error(transparent)]
    Clip(#[from] ClipError),
}
