//! The robot as joints: bodies in the orientation of the pelvis at rest.

use super::g1::{Axis, FEET, HEAD_IN_TORSO, HINGES, TOE_IN_FOOT, TORSO};
use crate::raw::RawMotion;
use glam::{DQuat, DVec3, Quat, Vec3};
use segue_motion::skeleton::{Joint, Skeleton};

/// Joints of the robot are at most this far from their places in the model, metres.
const SAME_PLACE_M: f32 = 1e-3;

/// The pose of a robot in a frame, metres and radians, Z up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RobotPose {
    pub(super) place: DVec3,
    /// The rotation of the pelvis.
    pub(super) turn: DQuat,
    pub(super) angles: [f64; HINGES.len()],
}

/// The robot's joints, and the axes of its hinges at rest in the frame of the pelvis.
pub(super) struct Robot {
    joints: Vec<Joint>,
    axes: Vec<DVec3>,
}

impl Robot {
    /// Returns the robot. At rest its bodies are rotated against each other, joints are not: each
    /// offset and axis is turned into the frame of the pelvis.
    pub(super) fn new() -> Self {
        let joint = |name: &str, parent: Option<usize>, offset: DVec3| Joint {
            name: name.to_owned(),
            parent,
            offset: offset.as_vec3(),
            end_site: None,
            channels: Vec::new(),
        };
        let mut joints = vec![joint("pelvis", None, DVec3::ZERO)];
        let mut turns = vec![DQuat::IDENTITY];
        let mut axes = Vec::with_capacity(HINGES.len());
        for hinge in &HINGES {
            let above = turns[hinge.parent];
            let [w, x, y, z] = hinge.turn;
            let turn = above * DQuat::from_xyzw(x, y, z, w).normalize();
            joints.push(joint(hinge.name, Some(hinge.parent), above * DVec3::from(hinge.offset)));
            turns.push(turn);
            let axis = match hinge.axis {
                Axis::X => DVec3::X,
                Axis::Y => DVec3::Y,
                Axis::Z => DVec3::Z,
            };
            axes.push(turn * axis);
        }
        let mut end = |hinge: usize, point: [f64; 3]| {
            joints[hinge + 1].end_site = Some((turns[hinge + 1] * DVec3::from(point)).as_vec3());
        };
        end(TORSO, HEAD_IN_TORSO);
        for foot in FEET {
            end(foot, TOE_IN_FOOT);
        }
        Self { joints, axes }
    }

    /// Returns the joints, Z up.
    pub(super) fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Returns the axes of the hinges at rest in the frame of the pelvis, Z up.
    pub(super) fn axes(&self) -> &[DVec3] {
        &self.axes
    }

    /// Returns the motion of these poses.
    pub(super) fn motion(self, poses: &[RobotPose]) -> RawMotion {
        let mut raw = RawMotion {
            rotations: Vec::with_capacity(poses.len() * self.joints.len()),
            root_translations: poses.iter().map(|pose| pose.place.as_vec3()).collect::<Vec<Vec3>>(),
            joints: self.joints,
            ..RawMotion::default()
        };
        for pose in poses {
            raw.rotations.push(pose.turn.as_quat());
            let turn = |(axis, angle): (&DVec3, &f64)| -> Quat {
                DQuat::from_axis_angle(*axis, *angle).as_quat()
            };
            raw.rotations.extend(self.axes.iter().zip(&pose.angles).map(turn));
        }
        raw
    }
}

/// Returns the angle of the part of a rotation that is about an axis, radians, from -2π to 2π.
pub(super) fn angle_about(turn: DQuat, axis: DVec3) -> f64 {
    2.0 * libm::atan2(turn.xyz().dot(axis), turn.w)
}

/// Returns a direction of the clip, which is Y up, with Z up.
pub(super) fn direction(v: Vec3) -> DVec3 {
    DVec3::new(v.x.into(), (-v.z).into(), v.y.into())
}

/// Returns a rotation of the clip, which is Y up, with Z up, of length 1.
pub(super) fn z_up(q: Quat) -> DQuat {
    let v = direction(Vec3::new(q.x, q.y, q.z));
    let q = DQuat::from_xyzw(v.x, v.y, v.z, q.w.into());
    let length = q.length();
    if length > 1e-6 && length.is_finite() { q * length.recip() } else { DQuat::IDENTITY }
}

/// Returns whether a skeleton is the robot's.
pub(super) fn is_robot(skeleton: &Skeleton, robot: &Robot) -> bool {
    let (joints, expected) = (skeleton.joints(), robot.joints());
    joints.len() == expected.len()
        && joints.iter().zip(expected).all(|(own, expected)| {
            let is_there = own.parent.is_none()
                || direction(own.offset).as_vec3().distance(expected.offset) < SAME_PLACE_M;
            own.name == expected.name && own.parent == expected.parent && is_there
        })
}
