//! Angles of the robot's hinges, and their limits, in motions on its skeleton.

use super::g1::HINGES;
use super::robot::{Robot, angle_about, is_robot, z_up};
use glam::{DVec3, Quat};
use segue_motion::skeleton::Skeleton;
use std::f64::consts::{PI, TAU};

/// An angle beyond a limit by less than this is a rounding error, radians.
pub(super) const TOLERANCE: f64 = 1e-3;
/// An angle this near to a limit is at it, radians (1°).
const NEAR: f64 = PI / 180.0;

/// The place of a hinge's angle between its limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HingeState {
    /// More than 1° away from both limits.
    Free,
    /// At most 1° from a limit.
    AtLimit,
    /// Past a limit.
    BeyondLimit,
}

/// The hinges of a robot, for the joints of a skeleton.
#[derive(Clone, Debug, PartialEq)]
pub struct HingeLimits {
    axes: Vec<DVec3>,
}

impl HingeLimits {
    /// Returns the hinges of a skeleton; `None` if it is not the Unitree G1's, the only robot whose
    /// hinges are known.
    #[must_use]
    pub fn of(skeleton: &Skeleton) -> Option<Self> {
        // The stage asks in every frame: counting is cheaper than comparing names.
        if skeleton.len() != HINGES.len() + 1 {
            return None;
        }
        let robot = Robot::new();
        is_robot(skeleton, &robot).then(|| Self { axes: robot.axes().to_vec() })
    }

    /// Returns the least and the greatest angle of a joint's hinge, degrees; `None` for the pelvis,
    /// which moves freely.
    #[must_use]
    pub fn range_degrees(&self, joint: usize) -> Option<[f64; 2]> {
        let hinge = HINGES.get(joint.checked_sub(1)?)?;
        Some(hinge.limits.map(f64::to_degrees))
    }

    /// Returns the place of a joint's angle between its limits. `rotation` is the joint's rotation
    /// in its parent (Y up), of which the part about the hinge's axis counts.
    #[must_use]
    pub fn state(&self, joint: usize, rotation: Quat) -> HingeState {
        let hinge =
            joint.checked_sub(1).and_then(|index| HINGES.get(index).zip(self.axes.get(index)));
        let Some((hinge, axis)) = hinge else {
            return HingeState::Free;
        };
        let angle = angle_about(z_up(rotation), *axis);
        let angle = angle - TAU * (angle / TAU).round();
        let [least, greatest] = hinge.limits;
        let excess = (least - angle).max(angle - greatest);
        if excess > TOLERANCE {
            HingeState::BeyondLimit
        } else if excess >= -NEAR {
            HingeState::AtLimit
        } else {
            HingeState::Free
        }
    }
}
