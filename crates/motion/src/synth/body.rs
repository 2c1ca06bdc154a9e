//! The body: 22 joints with the proportions of an adult, as fractions of body height.

use super::SynthError;
use crate::skeleton::{Channel, Joint, Skeleton};
use glam::Vec3;
use std::sync::Arc;

/// Indices of the joints of [`humanoid`].
pub(super) mod joint {
    pub(in crate::synth) const HIPS: usize = 0;
    /// Left leg first; add 4 for the right one: thigh, shank, foot, toes.
    pub(in crate::synth) const UP_LEG: [usize; 2] = [1, 5];
    pub(in crate::synth) const LEG: [usize; 2] = [2, 6];
    pub(in crate::synth) const FOOT: [usize; 2] = [3, 7];
    pub(in crate::synth) const TOE: [usize; 2] = [4, 8];
    pub(in crate::synth) const SPINE: [usize; 3] = [9, 10, 11];
    pub(in crate::synth) const NECK: usize = 12;
    pub(in crate::synth) const HEAD: usize = 13;
    pub(in crate::synth) const SHOULDER: [usize; 2] = [14, 18];
    pub(in crate::synth) const ARM: [usize; 2] = [15, 19];
    pub(in crate::synth) const FORE_ARM: [usize; 2] = [16, 20];
    pub(in crate::synth) const HAND: [usize; 2] = [17, 21];
    pub(in crate::synth) const COUNT: usize = 22;
}

// Fractions of body height after Drillis and Contini 1966, as tabulated in Winter, "Biomechanics
// and Motor Control of Human Movement", figure 4.1: ankle 0.039, knee 0.285 and hip 0.530 above the
// ground, shoulder 0.818, upper arm 0.186, forearm 0.146, hand 0.108, foot 0.152 long. The division
// of the trunk and of the foot follows the usual joint centres.
const ANKLE_HEIGHT: f32 = 0.039;
const SHANK: f32 = 0.246;
const THIGH: f32 = 0.245;
const HIP_HALF_WIDTH: f32 = 0.052;
const HIPS_ABOVE_HIP_JOINTS: f32 = 0.020;
const BALL_HEIGHT: f32 = 0.012;
const BALL_AHEAD: f32 = 0.078;
const TOES: f32 = 0.038;
const HEEL_BEHIND: f32 = 0.036;

/// Measures of a body for planning its motion, metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body {
    /// Hip joint to knee.
    pub(super) thigh: f32,
    /// Knee to ankle.
    pub(super) shank: f32,
    /// Hip joints in the frame of the hips: left, right.
    pub(super) hip_in_hips: [Vec3; 2],
    /// The joint of the toes in the frame of the foot.
    pub(super) ball_in_foot: Vec3,
    /// The tip of the toes in the frame of the toes.
    pub(super) tip_in_toes: Vec3,
    /// The contact point of the heel in the frame of the foot.
    pub(super) heel_in_foot: Vec3,
    /// Ratio of the height to that of the reference adult of 1.75 m.
    pub(super) scale: f32,
}

impl Body {
    pub(super) fn new(height_m: f32) -> Self {
        let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z) * height_m;
        Self {
            thigh: THIGH * height_m,
            shank: SHANK * height_m,
            hip_in_hips: [
                at(HIP_HALF_WIDTH, -HIPS_ABOVE_HIP_JOINTS, 0.0),
                at(-HIP_HALF_WIDTH, -HIPS_ABOVE_HIP_JOINTS, 0.0),
            ],
            ball_in_foot: at(0.0, BALL_HEIGHT - ANKLE_HEIGHT, BALL_AHEAD),
            tip_in_toes: at(0.0, -0.5 * BALL_HEIGHT, TOES),
            heel_in_foot: at(0.0, -ANKLE_HEIGHT, -HEEL_BEHIND),
            scale: height_m / 1.75,
        }
    }

    /// Returns the length of the straight leg from hip joint to ankle.
    pub(super) fn leg(&self) -> f32 {
        self.thigh + self.shank
    }

    /// Returns the height of the ankle above the sole.
    pub(super) fn ankle_height(&self) -> f32 {
        -self.heel_in_foot.y
    }

    /// Returns the height of the hip joints of a body that stands straight: the leg length of the
    /// gait literature.
    pub(super) fn hip_height(&self) -> f32 {
        self.leg() + self.ankle_height()
    }

    /// Returns the distance from hip joint to ankle when the knee is flexed by `radians`.
    pub(super) fn reach_at_flexion(&self, radians: f32) -> f32 {
        let (a, b) = (self.thigh, self.shank);
        (a * a + b * b + 2.0 * a * b * libm::cosf(radians)).max(0.0).sqrt()
    }
}

/// Returns the contact point of the heel in the frame of `LeftFoot` and `RightFoot` of
/// [`humanoid`], metres.
///
/// No joint is there. This point and the joints `LeftToe` and `RightToe` stand still in the frames
/// given by [`super::FootContact`].
#[must_use]
pub fn heel_in_foot(height_m: f32) -> Vec3 {
    Body::new(height_m).heel_in_foot
}

/// Returns the skeleton of a person of `height_m` metres: 22 joints named as in `LaFAN1`, in a
/// T-pose that faces +Z, +Y up, left on +X.
///
/// Proportions after Drillis and Contini 1966 (Winter, "Biomechanics and Motor Control of Human
/// Movement", figure 4.1). Channels as in most BVH files: position and ZYX rotation for the root,
/// ZYX rotation for the rest. The root's offset is its height at rest.
///
/// # Errors
/// [`SynthError::OutOfRange`] when the height is not between 1.0 and 2.2 m.
pub fn humanoid(height_m: f32) -> Result<Arc<Skeleton>, SynthError> {
    super::Params { height_m, ..super::Params::default() }.validate()?;
    let body = Body::new(height_m);
    let mut joints: Vec<Joint> = Vec::with_capacity(joint::COUNT);
    let mut add = |name: &str, parent: Option<usize>, offset: Vec3, end_site: Option<Vec3>| {
        let rotations = [Channel::ZRotation, Channel::YRotation, Channel::XRotation];
        let positions = [Channel::XPosition, Channel::YPosition, Channel::ZPosition];
        let channels =
            if parent.is_none() { [positions, rotations].concat() } else { rotations.to_vec() };
        joints.push(Joint {
            name: name.to_owned(),
            parent,
            offset: offset * height_m,
            end_site: end_site.map(|e| e * height_m),
            channels,
        });
    };
    let up = Vec3::Y;
    add("Hips", None, up * (ANKLE_HEIGHT + SHANK + THIGH + HIPS_ABOVE_HIP_JOINTS), None);
    for (side, (name, mirror)) in [("Left", 1.0), ("Right", -1.0)].into_iter().enumerate() {
        let first = joint::UP_LEG[side];
        add(
            &format!("{name}UpLeg"),
            Some(joint::HIPS),
            Vec3::new(mirror * HIP_HALF_WIDTH, -HIPS_ABOVE_HIP_JOINTS, 0.0),
            None,
        );
        add(&format!("{name}Leg"), Some(first), up * -THIGH, None);
        add(&format!("{name}Foot"), Some(first + 1), up * -SHANK, None);
        let ball = body.ball_in_foot / height_m;
        add(
            &format!("{name}Toe"),
            Some(first + 2),
            ball,
            Some(Vec3::new(0.0, -0.5 * BALL_HEIGHT, TOES)),
        );
    }
    add("Spine", Some(joint::HIPS), Vec3::new(0.0, 0.045, -0.004), None);
    add("Spine1", Some(9), Vec3::new(0.0, 0.066, -0.003), None);
    add("Spine2", Some(10), Vec3::new(0.0, 0.070, 0.002), None);
    add("Neck", Some(11), Vec3::new(0.0, 0.108, -0.003), None);
    add("Head", Some(12), Vec3::new(0.0, 0.060, 0.010), Some(Vec3::new(0.0, 0.101, 0.006)));
    for (side, (name, mirror)) in [("Left", 1.0), ("Right", -1.0)].into_iter().enumerate() {
        let first = joint::SHOULDER[side];
        add(&format!("{name}Shoulder"), Some(11), Vec3::new(mirror * 0.024, 0.082, 0.006), None);
        add(&format!("{name}Arm"), Some(first), Vec3::new(mirror * 0.088, 0.005, -0.008), None);
        add(&format!("{name}ForeArm"), Some(first + 1), Vec3::new(mirror * 0.186, 0.0, 0.0), None);
        add(
            &format!("{name}Hand"),
            Some(first + 2),
            Vec3::new(mirror * 0.146, 0.0, 0.0),
            Some(Vec3::new(mirror * 0.100, 0.0, 0.0)),
        );
    }
    Ok(Arc::new(Skeleton::new(joints)?))
}
