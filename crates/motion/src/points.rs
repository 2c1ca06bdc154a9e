//! Skeletons from points: joint centres or optical markers over time become joints with rotations.
//!
//! # The idea
//!
//! Cameras see points, not rotations. A point that is the centre of a joint says where a bone
//! begins; two of them give its direction, and three that are not on a line give everything:
//!
//! ```text
//! length   median over all frames of the distance between a joint and its child
//! cluster  a joint with several children (hips, chest, head): the rotation that takes their mean
//!          shape to the points of the frame, in the least-squares sense
//! swing    a joint with one child: the shortest rotation from the parent's to the bone's direction
//! twist    about that direction: from a helper point beside the bone, otherwise from the plane in
//!          which the limb bends (knees, elbows), for the back from hips to shoulders
//! ```
//!
//! [`skeleton_from_points`] does this from the root outwards, and each bone aims from where the
//! kinematics have put its joint, so that errors of length do not add up. A straight limb has no
//! plane; there the twist is carried over from the frames before and after in which it is bent.
//!
//! Short gaps are filled in the position of the point, long ones in the rotation of the bone, which
//! leaves a limb at its length. [`PointFit::gaps`] says how many.
//!
//! Where names tell the limbs of a person ([`Roles::by_name`](crate::skeleton::Roles::by_name)),
//! the rest pose is a T-pose; otherwise it is the body as it stands in the first complete frame,
//! with each bone in its mean direction as seen from its parent.
//!
//! [`body_from_markers`] computes joint centres from the markers of the usual sets, by their
//! labels.
//!
//! # Example
//!
//! ```
//! use glam::Vec3;
//! use segue_motion::clip::UpAxis;
//! use segue_motion::points::{PointSet, joint_points, skeleton_from_points};
//!
//! // An arm of two bones that bends at the elbow, over 31 frames.
//! let points = joint_points(&["Shoulder", "Elbow", "Wrist"], &[None, Some(0), Some(1)]);
//! let mut positions = Vec::new();
//! for frame in 0..31 {
//!     let bend = frame as f32 * 0.05;
//!     let elbow = Vec3::new(0.3, 1.4, 0.0);
//!     positions.push(Vec3::new(0.0, 1.4, 0.0));
//!     positions.push(elbow);
//!     positions.push(elbow + Vec3::new(bend.cos(), 0.0, bend.sin()) * 0.25);
//! }
//! let set = PointSet { points: &points, positions: &positions, fps: 30.0, up: UpAxis::Y };
//! let fit = skeleton_from_points(&set)?;
//! assert!((fit.joints[2].offset.length() - 0.25).abs() < 1e-6);
//! assert!(fit.error.greatest < 1e-6);
//! # Ok::<(), segue_motion::points::PointsError>(())
//! ```
//!
//! # Accuracy and cost
//!
//! From the joint centres of a synthesised walk every joint is found within 0.1 mm, and with noise
//! of 5 mm and gaps of half a second within 1 cm on average. The twist of a limb is known as well
//! as its bend is: 20° and more decide it. The last joint of a limb keeps the rotation of the one
//! before. O(frames × points).
//!
//! # What it does not do
//!
//! Points have to be labelled, and one body is solved at a time. No model of a person restricts
//! what comes out: no joint limits, no symmetry of the sides.
//!
//! # Sources
//!
//! The rotation of a cluster is that of [`best_fit`](crate::math::quat::best_fit). Regressions of
//! joint centres cite theirs at [`body_from_markers`].

mod body;
mod gaps;
mod markers;
mod rest;
mod solve;
#[cfg(test)]
mod tests;
mod twist;

pub use gaps::Gaps;
pub use markers::{MarkerBody, body_from_markers};
pub use solve::skeleton_from_points;

use crate::clip::UpAxis;
use crate::skeleton::{Joint, SkeletonError};
use glam::{Quat, Vec3};

/// A point of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyPoint {
    /// Its name; for joints, that of the joint.
    pub name: String,
    /// The index of the joint that it hangs on, smaller than its own. `None` for the root.
    pub parent: Option<usize>,
    /// Its part in the skeleton.
    pub kind: PointKind,
}

/// The part of a point in the skeleton that is made from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointKind {
    /// It is the centre of a joint.
    Joint,
    /// It is fixed to its parent's bone and helps to find that joint's rotation; no joint is made
    /// of it.
    Helper {
        /// Where it lies beside the bone in a T-pose that faces +Z with Y up: its direction across
        /// the bone. It decides the twist of a bone with one child; zero where unknown.
        beside: Vec3,
    },
}

/// Points over time.
#[derive(Clone, Copy, Debug)]
pub struct PointSet<'a> {
    /// The points: the root first, parents before children.
    pub points: &'a [BodyPoint],
    /// Their positions in the world, frame by frame, in any unit; a position that is not finite is
    /// a gap.
    pub positions: &'a [Vec3],
    /// Frames per second.
    pub fps: f64,
    /// The axis that points up.
    pub up: UpAxis,
}

/// A skeleton with a motion, in the unit and axes of the points.
#[derive(Clone, Debug, PartialEq)]
pub struct PointFit {
    /// The joints; points that are never seen are left out.
    pub joints: Vec<Joint>,
    /// The index of the point of each joint.
    pub sources: Vec<usize>,
    /// Local rotations, frame by frame.
    pub rotations: Vec<Quat>,
    /// The position of the root in each frame.
    pub root_translations: Vec<Vec3>,
    /// The gaps that were filled.
    pub gaps: Gaps,
    /// The distance of the joints from the points.
    pub error: FitError,
}

/// The distance between joints and the points that they were made from, in the unit of the points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FitError {
    /// The mean over all frames and joints.
    pub mean: f32,
    /// The greatest.
    pub greatest: f32,
}

/// Error in a set of points.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, segue_text::ToMessage)]
pub enum PointsError {
    /// The points are no tree of joints with helpers at its joints.
    #[error(transparent)]
    Skeleton(#[from] SkeletonError),
    /// The number of positions is no multiple of the number of points.
    #[error("{positions} positions are no whole number of frames of {points} points")]
    Uneven {
        /// The number of positions.
        positions: usize,
        /// The number of points.
        points: usize,
    },
    /// There is no frame, or no point is seen in any.
    #[error("no point is seen in any frame")]
    Unseen,
}

/// Returns points that are all centres of joints, with these names and parents. Missing parents are
/// the root.
#[must_use]
pub fn joint_points(names: &[impl AsRef<str>], parents: &[Option<usize>]) -> Vec<BodyPoint> {
    names
        .iter()
        .enumerate()
        .map(|(index, name)| BodyPoint {
            name: name.as_ref().to_owned(),
            parent: match parents.get(index) {
                Some(parent) => *parent,
                None => (index > 0).then_some(0),
            },
            kind: PointKind::Joint,
        })
        .collect()
}
