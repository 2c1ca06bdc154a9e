//! The Unitree G1 with 29 hinges.
//!
//! Names, parents, offsets, axes and limits are those of the manufacturer's public `MuJoCo` model
//! (`unitree_robots/g1/g1_29dof.xml` of `unitree_mujoco`), metres and radians, Z up, X ahead.

/// The axis of a hinge in the frame of its body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Axis {
    X,
    Y,
    Z,
}

/// A hinge with the body that it carries.
pub(super) struct Hinge {
    /// The name in the model, without `_joint`.
    pub(super) name: &'static str,
    /// The body that it hangs on: 0 for the pelvis, otherwise one more than the index of its hinge.
    pub(super) parent: usize,
    /// The place of the body in its parent.
    pub(super) offset: [f64; 3],
    /// The rotation of the body in its parent at angle 0: w, x, y, z.
    pub(super) turn: [f64; 4],
    pub(super) axis: Axis,
    /// The least and the greatest angle.
    pub(super) limits: [f64; 2],
}

/// The top of the head above the body of the trunk: the robot stands 1.32 m tall.
pub(super) const HEAD_IN_TORSO: [f64; 3] = [0.0, 0.0, 0.473];
/// The front of the sole in the frame of the last body of a leg.
pub(super) const TOE_IN_FOOT: [f64; 3] = [0.12, 0.0, -0.03];
/// The index of the hinge whose body is the trunk.
pub(super) const TORSO: usize = 14;
/// The indices of the last hinges of the legs.
pub(super) const FEET: [usize; 2] = [5, 11];

const ALONG: [f64; 4] = [1.0, 0.0, 0.0, 0.0];

/// The hinges in the order of the model, which is that of the columns of files.
#[rustfmt::skip]
#[expect(clippy::unreadable_literal, clippy::approx_constant, reason = "as the model has them")]
pub(super) const HINGES: [Hinge; 29] = [
    Hinge { name: "left_hip_pitch", parent: 0, offset: [0.0, 0.064452, -0.1027], turn: ALONG, axis: Axis::Y, limits: [-2.5307, 2.8798] },
    Hinge { name: "left_hip_roll", parent: 1, offset: [0.0, 0.052, -0.030465], turn: [0.996179, 0.0, -0.0873386, 0.0], axis: Axis::X, limits: [-0.5236, 2.9671] },
    Hinge { name: "left_hip_yaw", parent: 2, offset: [0.025001, 0.0, -0.12412], turn: ALONG, axis: Axis::Z, limits: [-2.7576, 2.7576] },
    Hinge { name: "left_knee", parent: 3, offset: [-0.078273, 0.0021489, -0.17734], turn: [0.996179, 0.0, 0.0873386, 0.0], axis: Axis::Y, limits: [-0.087267, 2.8798] },
    Hinge { name: "left_ankle_pitch", parent: 4, offset: [0.0, -9.4445e-05, -0.30001], turn: ALONG, axis: Axis::Y, limits: [-0.87267, 0.5236] },
    Hinge { name: "left_ankle_roll", parent: 5, offset: [0.0, 0.0, -0.017558], turn: ALONG, axis: Axis::X, limits: [-0.2618, 0.2618] },
    Hinge { name: "right_hip_pitch", parent: 0, offset: [0.0, -0.064452, -0.1027], turn: ALONG, axis: Axis::Y, limits: [-2.5307, 2.8798] },
    Hinge { name: "right_hip_roll", parent: 7, offset: [0.0, -0.052, -0.030465], turn: [0.996179, 0.0, -0.0873386, 0.0], axis: Axis::X, limits: [-2.9671, 0.5236] },
    Hinge { name: "right_hip_yaw", parent: 8, offset: [0.025001, 0.0, -0.12412], turn: ALONG, axis: Axis::Z, limits: [-2.7576, 2.7576] },
    Hinge { name: "right_knee", parent: 9, offset: [-0.078273, -0.0021489, -0.17734], turn: [0.996179, 0.0, 0.0873386, 0.0], axis: Axis::Y, limits: [-0.087267, 2.8798] },
    Hinge { name: "right_ankle_pitch", parent: 10, offset: [0.0, 9.4445e-05, -0.30001], turn: ALONG, axis: Axis::Y, limits: [-0.87267, 0.5236] },
    Hinge { name: "right_ankle_roll", parent: 11, offset: [0.0, 0.0, -0.017558], turn: ALONG, axis: Axis::X, limits: [-0.2618, 0.2618] },
    Hinge { name: "waist_yaw", parent: 0, offset: [0.0, 0.0, 0.0], turn: ALONG, axis: Axis::Z, limits: [-2.618, 2.618] },
    Hinge { name: "waist_roll", parent: 13, offset: [-0.0039635, 0.0, 0.035], turn: ALONG, axis: Axis::X, limits: [-0.52, 0.52] },
    Hinge { name: "waist_pitch", parent: 14, offset: [0.0, 0.0, 0.019], turn: ALONG, axis: Axis::Y, limits: [-0.52, 0.52] },
    Hinge { name: "left_shoulder_pitch", parent: 15, offset: [0.0039563, 0.10022, 0.23778], turn: [0.990264, 0.139201, 1.38722e-05, -9.86868e-05], axis: Axis::Y, limits: [-3.0892, 2.6704] },
    Hinge { name: "left_shoulder_roll", parent: 16, offset: [0.0, 0.038, -0.013831], turn: [0.990268, -0.139172, 0.0, 0.0], axis: Axis::X, limits: [-1.5882, 2.2515] },
    Hinge { name: "left_shoulder_yaw", parent: 17, offset: [0.0, 0.00624, -0.1032], turn: ALONG, axis: Axis::Z, limits: [-2.618, 2.618] },
    Hinge { name: "left_elbow", parent: 18, offset: [0.015783, 0.0, -0.080518], turn: ALONG, axis: Axis::Y, limits: [-1.0472, 2.0944] },
    Hinge { name: "left_wrist_roll", parent: 19, offset: [0.1, 0.00188791, -0.01], turn: ALONG, axis: Axis::X, limits: [-1.97222, 1.97222] },
    Hinge { name: "left_wrist_pitch", parent: 20, offset: [0.038, 0.0, 0.0], turn: ALONG, axis: Axis::Y, limits: [-1.61443, 1.61443] },
    Hinge { name: "left_wrist_yaw", parent: 21, offset: [0.046, 0.0, 0.0], turn: ALONG, axis: Axis::Z, limits: [-1.61443, 1.61443] },
    Hinge { name: "right_shoulder_pitch", parent: 15, offset: [0.0039563, -0.10021, 0.23778], turn: [0.990264, -0.139201, 1.38722e-05, 9.86868e-05], axis: Axis::Y, limits: [-3.0892, 2.6704] },
    Hinge { name: "right_shoulder_roll", parent: 23, offset: [0.0, -0.038, -0.013831], turn: [0.990268, 0.139172, 0.0, 0.0], axis: Axis::X, limits: [-2.2515, 1.5882] },
    Hinge { name: "right_shoulder_yaw", parent: 24, offset: [0.0, -0.00624, -0.1032], turn: ALONG, axis: Axis::Z, limits: [-2.618, 2.618] },
    Hinge { name: "right_elbow", parent: 25, offset: [0.015783, 0.0, -0.080518], turn: ALONG, axis: Axis::Y, limits: [-1.0472, 2.0944] },
    Hinge { name: "right_wrist_roll", parent: 26, offset: [0.1, -0.00188791, -0.01], turn: ALONG, axis: Axis::X, limits: [-1.97222, 1.97222] },
    Hinge { name: "right_wrist_pitch", parent: 27, offset: [0.038, 0.0, 0.0], turn: ALONG, axis: Axis::Y, limits: [-1.61443, 1.61443] },
    Hinge { name: "right_wrist_yaw", parent: 28, offset: [0.046, 0.0, 0.0], turn: ALONG, axis: Axis::Z, limits: [-1.61443, 1.61443] },
];
