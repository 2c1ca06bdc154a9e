//! Twist that is spread over the joints that a rig has for it.

use super::TargetBody;
use crate::clip::{Clip, ClipError};
use crate::math::quat;
use crate::skeleton::{Role, Roles, Side, Skeleton, is_below};
use glam::{Quat, Vec3};
use std::ops::Range;
use std::sync::Arc;

/// A joint beside its bone by more than this share of the bone's length is no twist joint.
const MAX_BESIDE: f32 = 0.25;

/// A joint that takes a share of the twist along a bone.
#[derive(Clone, Debug, PartialEq)]
struct TwistJoint {
    joint: usize,
    /// The joint whose rotation has the twist: that at the far end of a forearm or a shin, that at
    /// the near end of an upper arm or a thigh.
    of: usize,
    /// The axis of the bone, in the frame of the joint at its near end.
    axis: Vec3,
    /// The share of the twist that the joint shall have in the end: 0 at the near end, 1 at the far
    /// one; for upper arms and thighs less 1, since it takes back what its parent has too much.
    share: f32,
}

/// The spreading of twist over the target's twist joints, in slices.
#[derive(Debug)]
pub(super) struct TwistSpread {
    joints: Vec<TwistJoint>,
    /// The rotation of every joint in its parent's frame that counts as untwisted.
    neutral: Vec<Quat>,
    /// The angle of each twist joint's limb in the frame before, radians.
    before: Vec<f32>,
    rotations: Vec<Quat>,
}

impl TwistSpread {
    /// Prepares spreading for a clip of a body; `None` for a body without twist joints.
    pub(super) fn new(target: &TargetBody) -> Option<Self> {
        let joints = twist_joints(&target.skeleton, &target.roles);
        if joints.is_empty() {
            return None;
        }
        let neutral = |joint: usize| match &target.stance {
            None => Quat::IDENTITY,
            Some(stance) => {
                let above = target.skeleton.parent(joint).map(|parent| stance.rotations[parent]);
                above.unwrap_or_default().conjugate() * stance.rotations[joint]
            }
        };
        Some(Self {
            neutral: (0..target.skeleton.len()).map(neutral).collect(),
            before: vec![0.0; joints.len()],
            rotations: Vec::new(),
            joints,
        })
    }

    /// Spreads the twist of these frames, which follow those that are done.
    pub(super) fn spread(&mut self, clip: &Clip, frames: Range<usize>) {
        for frame in frames {
            let first = self.rotations.len();
            self.rotations.extend_from_slice(clip.rotations(frame));
            let (local, neutral) = (&mut self.rotations[first..], &self.neutral);
            for (twisted, before) in self.joints.iter().zip(&mut self.before) {
                let own = local[twisted.of] * neutral[twisted.of].conjugate();
                let angle = twist_angle(own, twisted.axis, *before);
                *before = angle;
                let share = Quat::from_axis_angle(twisted.axis, angle * twisted.share);
                local[twisted.joint] = quat::renormalize(share * neutral[twisted.joint]);
            }
        }
    }

    /// Returns the clip with the twist spread, when all frames are done.
    pub(super) fn clip(self, clip: &Clip) -> Result<Clip, ClipError> {
        let made = Clip::new(
            clip.name(),
            Arc::clone(clip.skeleton()),
            clip.fps(),
            self.rotations,
            clip.root_translations().to_vec(),
        )?;
        Ok(made.with_translations(clip.translations().to_vec())?.with_provenance(clip.provenance()))
    }
}

/// Returns the angle of the twist of a rotation about a unit axis, radians: that of swing and
/// twist, in the turn that is nearest to `before`.
fn twist_angle(rotation: Quat, axis: Vec3, before: f32) -> f32 {
    let angle = 2.0 * libm::atan2f(rotation.xyz().dot(axis), rotation.w);
    angle + ((before - angle) / std::f32::consts::TAU).round() * std::f32::consts::TAU
}

/// Returns the twist joints of the limbs: those named so that lie on the bone and have no other
/// bones below them.
fn twist_joints(skeleton: &Skeleton, roles: &Roles) -> Vec<TwistJoint> {
    let rest = skeleton.rest_positions();
    let mut found: Vec<TwistJoint> = Vec::new();
    for side in Side::BOTH {
        let ([thigh, shin, foot, _], [upper, forearm, hand]) = (Role::leg(side), Role::arm(side));
        let bones = [(upper, forearm, true), (forearm, hand, false), (thigh, shin, true)];
        for (near, far, is_upper) in bones.into_iter().chain([(shin, foot, false)]) {
            let joint = |role| roles.get_within(role, skeleton.len());
            let (Some(near), Some(far)) = (joint(near), joint(far)) else { continue };
            let bone = rest[far] - rest[near];
            let Some(axis) = bone.try_normalize() else { continue };
            let named = skeleton.children(near).filter(|&j| {
                let name = skeleton.joints()[j].name.to_lowercase();
                (name.contains("twist") || name.contains("roll"))
                    && j != far
                    && !is_below(skeleton, far, j)
                    && roles.role_of(j).is_none()
                    && skeleton.children(j).next().is_none()
            });
            for joint in named {
                let offset = rest[joint] - rest[near];
                let along = offset.dot(axis) / bone.length();
                let beside = offset.reject_from_normalized(axis).length() / bone.length();
                if beside > MAX_BESIDE || !(-0.05..=1.05).contains(&along) {
                    continue;
                }
                let share = along.clamp(0.0, 1.0) - f32::from(u8::from(is_upper));
                let of = if is_upper { near } else { far };
                found.push(TwistJoint { joint, of, axis, share });
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::{Joint, fixtures};

    /// Returns a body with a twist joint half-way along each forearm and upper arm.
    fn with_twist_joints() -> Skeleton {
        let plain = fixtures::lafan();
        let roles = fixtures::roles(&plain);
        let mut joints = plain.joints().to_vec();
        for side in Side::BOTH {
            let [upper, forearm, hand] = Role::arm(side).map(|role| roles.get(role).unwrap());
            for (near, far) in [(upper, forearm), (forearm, hand)] {
                joints.push(Joint {
                    name: format!("{}_twist_01", plain.joints()[near].name),
                    parent: Some(near),
                    offset: plain.joints()[far].offset * 0.25,
                    end_site: None,
                    channels: vec![],
                });
            }
        }
        Skeleton::new(joints).unwrap()
    }

    #[test]
    fn twist_is_spread_by_the_place_along_the_bone() {
        let skeleton = Arc::new(with_twist_joints());
        let roles = Roles::detect(&skeleton);
        assert_eq!(twist_joints(&skeleton, &roles).len(), 4);
        let joint = |name: &str| skeleton.find(name).unwrap();
        let [upper, forearm, hand] = Role::arm(Side::Left).map(|role| roles.get(role).unwrap());
        let along = |joint: usize| skeleton.joints()[joint].offset.normalize_or_zero();
        let frames = 9;
        let mut rotations = Vec::new();
        for frame in 0..frames {
            let mut pose = vec![Quat::IDENTITY; skeleton.len()];
            // Past half a turn: the twist goes on, and does not jump back by a whole one.
            let angle = 0.5 * frame as f32;
            pose[hand] = Quat::from_axis_angle(along(hand), angle);
            pose[upper] = Quat::from_axis_angle(along(forearm), angle);
            rotations.extend(pose);
        }
        let clip =
            Clip::new("twist", Arc::clone(&skeleton), 30.0, rotations, vec![Vec3::ZERO; frames])
                .unwrap();
        let mut twist = TwistSpread::new(&TargetBody::at_rest(&skeleton, &roles)).unwrap();
        twist.spread(&clip, 0..frames);
        let made = twist.clip(&clip).unwrap();
        for frame in 0..frames {
            let angle = 0.5 * frame as f32;
            let own = |name: &str| {
                let share = Quat::from_axis_angle(along(hand), angle * 0.25);
                let back = Quat::from_axis_angle(along(forearm), -angle * 0.75);
                let wanted = if name.contains("Fore") { share } else { back };
                quat::angle_between(made.rotations(frame)[joint(name)], wanted)
            };
            assert!(own("LeftForeArm_twist_01") < 1e-3, "{frame}");
            assert!(own("LeftArm_twist_01") < 1e-3, "{frame}");
            for other in 0..skeleton.len() {
                if !skeleton.joints()[other].name.contains("twist") {
                    assert_eq!(made.rotations(frame)[other], clip.rotations(frame)[other]);
                }
            }
        }
    }
}
