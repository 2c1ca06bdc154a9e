//! The robot as joints: bodies in the orientation of the pelvis at rest.

use super::g1::{Axis, FEET, HEAD_IN_TORSO, HINGES, TOE_IN_FOOT, TORSO};
use crate::raw::RawMotion;
use glam::{DQuat, DVec3, Quat, Vec3};
use segue_motion::skeleton::Joint;

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
