//! Limbs of two bones, and rotations that bring their ends to other places.

use crate::math::{curve, quat};
use crate::skeleton::{Foot, FootPair, Role, Roles, Side, Skeleton, WorldPose, two_bone_ik};
use glam::{Mat3, Quat, Vec3};

/// The least flexion of the knee to which a leg is stretched, unless the clip itself stretches it
/// further: near full stretch the knee would snap. A leg of bones `a` and `b` and length `l` that
/// becomes longer by `d` turns its knee by `d l / (a b sin φ)`: at this limit 1.2° per millimetre
/// on a leg of 0.85 m, with the hips 5 mm lower than for a straight leg.
const MIN_FLEXION_RADIANS: f32 = 0.22;
/// Sine of the flexion below which the knee's own plane is uncertain, and the leg's usual plane is
/// used.
const PLANE_SINE: f32 = 0.2;

/// The joints of a leg or an arm, and their parents.
#[derive(Clone, Debug)]
pub(crate) struct Limb {
    joints: [usize; 3],
    parents: [usize; 3],
    /// The axis about which its middle joint bends where no pose shows that, in the frame of the
    /// upper bone of a body that faces +Z.
    straight_axis: Vec3,
}

/// The world pose of a leg or an arm in one frame of a clip.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LimbPose {
    /// Hip to knee and knee to ankle, or shoulder to elbow and elbow to wrist.
    pub(crate) thigh: Vec3,
    pub(crate) shin: Vec3,
    pub(crate) rotations: [Quat; 3],
    pub(crate) parents: [Quat; 3],
}

/// The flexions that a knee or an elbow can have, radians: 0 for a straight limb.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flexion {
    pub(crate) least: f32,
    pub(crate) most: f32,
}

impl Limb {
    /// Returns the leg of a side; `None` where thigh, shin and foot are not one below the other.
    pub(crate) fn leg(skeleton: &Skeleton, roles: &Roles, side: Side) -> Option<Self> {
        Self::on(skeleton, roles, side.into())
    }

    /// Returns the leg on a foot; `None` where its joints are not one below the other.
    pub(crate) fn on(skeleton: &Skeleton, roles: &Roles, foot: Foot) -> Option<Self> {
        let leg = Self::of(skeleton, roles, foot.leg())?;
        // Elbows of forelegs point backward.
        let straight_axis = match foot.pair {
            FootPair::Hind => Vec3::X,
            FootPair::Fore => Vec3::NEG_X,
        };
        Some(Self { straight_axis, ..leg })
    }

    /// Returns the arm of a side; `None` where upper arm, forearm and hand are not one below the
    /// other.
    pub(crate) fn arm(skeleton: &Skeleton, roles: &Roles, side: Side) -> Option<Self> {
        Self::of(skeleton, roles, Role::arm(side))
    }

    fn of(skeleton: &Skeleton, roles: &Roles, roles_of_joints: [Role; 3]) -> Option<Self> {
        let [first, second, third] =
            roles_of_joints.map(|role| roles.get_within(role, skeleton.len()));
        let joints = [first?, second?, third?];
        let above = |joint: usize, wanted: usize| {
            std::iter::successors(skeleton.parent(joint), |&j| skeleton.parent(j))
                .any(|j| j == wanted)
        };
        let [Some(a), Some(b), Some(c)] = joints.map(|joint| skeleton.parent(joint)) else {
            return None;
        };
        let chain = above(joints[1], joints[0]) && above(joints[2], joints[1]);
        let rest = skeleton.rest_positions();
        let bones = [0, 1].map(|bone| rest[joints[bone]].distance(rest[joints[bone + 1]]));
        (chain && bones.iter().all(|length| *length > 1e-3)).then_some(Self {
            joints,
            parents: [a, b, c],
            straight_axis: Vec3::X,
        })
    }

    /// Returns thigh, shin and foot.
    pub(crate) fn joints(&self) -> [usize; 3] {
        self.joints
    }

    /// Returns the axis about which this knee bends over some poses, in the thigh's frame; bent
    /// poses count more. Where all are straight it is the lateral axis of the body.
    pub(crate) fn usual_axis(&self, posed: impl IntoIterator<Item = LimbPose>) -> Vec3 {
        let bend = |posed: LimbPose| posed.rotations[0].conjugate() * posed.bend();
        let sum: Vec3 = posed.into_iter().map(bend).sum();
        sum.try_normalize().unwrap_or(self.straight_axis)
    }

    /// Moves the ankle by `shift` (metres, world) as [`foot_lock`] does, with the hips fixed:
    /// writes the local rotations of thigh, shin and foot. `world` is the pose before; it may hold
    /// these joints and their ancestors alone.
    pub(crate) fn move_ankle(
        &self,
        world: &WorldPose,
        shift: Vec3,
        usual_axis: Vec3,
        local: &mut [Quat],
    ) {
        let posed = self.pose(world);
        let [upper, lower] = posed.turned(shift, usual_axis);
        self.write(&posed, [upper, lower, Quat::IDENTITY], local);
    }

    /// Returns by how much the hips are too high for this leg when its ankle is moved by `shift`,
    /// metres.
    pub(crate) fn too_high(&self, world: &WorldPose, shift: Vec3) -> f32 {
        self.pose(world).too_high(shift, 0.0)
    }

    /// Returns the limb in a pose of the skeleton.
    pub(crate) fn pose(&self, world: &WorldPose) -> LimbPose {
        let [hip, knee, ankle] = self.joints.map(|joint| world.positions[joint]);
        LimbPose {
            thigh: knee - hip,
            shin: ankle - knee,
            rotations: self.joints.map(|joint| world.rotations[joint]),
            parents: self.parents.map(|joint| world.rotations[joint]),
        }
    }

    /// Writes local rotations after thigh, shin and foot were each rotated in the world.
    pub(crate) fn write(
        &self,
        posed: &LimbPose,
        [upper, lower, own]: [Quat; 3],
        local: &mut [Quat],
    ) {
        let [thigh, shin, foot] = self.joints;
        let (rotations, parents) = (posed.rotations, posed.parents);
        local[thigh] = quat::renormalize(parents[0].conjugate() * upper * rotations[0]);
        local[shin] = quat::renormalize((upper * parents[1]).conjugate() * lower * rotations[1]);
        local[foot] = quat::renormalize((lower * parents[2]).conjugate() * own * rotations[2]);
    }
}

impl LimbPose {
    /// Returns the vector from the limb's start to its end.
    pub(crate) fn line(&self) -> Vec3 {
        self.thigh + self.shin
    }

    /// Returns the cross product of the bones over the product of their lengths: it points along
    /// the axis about which the knee is bent, and its length is the sine of the flexion.
    pub(crate) fn bend(&self) -> Vec3 {
        self.thigh.cross(self.shin) / (self.thigh.length() * self.shin.length()).max(1e-9)
    }

    /// Returns the greatest length of this leg.
    pub(crate) fn reach(&self) -> f32 {
        let (a, b) = (self.thigh.length(), self.shin.length());
        let reach = (a * a + b * b + 2.0 * a * b * libm::cosf(MIN_FLEXION_RADIANS)).sqrt();
        reach.max(self.line().length())
    }

    /// Returns by how much the hip is too high for the ankle to be moved by `shift` after the hip
    /// was raised by `height`, metres; 0 where the leg reaches.
    pub(crate) fn too_high(&self, shift: Vec3, height: f32) -> f32 {
        let asked = self.line() + shift;
        let (reach, aside) = (self.reach(), Vec3::new(asked.x, 0.0, asked.z).length());
        // Beyond the reach sideways no height helps: the hip is not lowered below the ankle.
        let highest = (reach * reach - aside * aside).max(0.0).sqrt();
        // Single-precision rounding counts as 0.
        (height - asked.y - highest - 1e-5).max(0.0)
    }

    /// Returns world rotations of thigh and shin that move the ankle by `shift` relative to the
    /// hip.
    ///
    /// `usual_axis` is the axis of the knee in the thigh's frame. Where the leg is not bent in one
    /// plane about the axis used, or the knee is bent the wrong way, a difference of angles does
    /// not quite reach; the remainder is then solved for once more.
    pub(crate) fn turned(&self, shift: Vec3, usual_axis: Vec3) -> [Quat; 2] {
        let (a, b) = (self.thigh.length(), self.shin.length());
        let bend = self.bend();
        let usual = self.rotations[0] * usual_axis;
        // A knee that is bent the wrong way has no plane of its own either.
        let own = curve::smoothstep(bend.dot(usual) / PLANE_SINE);
        let line = self.line();
        let axis = bend * own + usual * PLANE_SINE * (1.0 - own);
        let from = two_bone_ik(line, a, b, axis);
        let wanted = (line + shift).clamp_length_max(self.reach());
        let mut asked = wanted;
        let mut turns = [Quat::IDENTITY; 2];
        for _ in 0..3 {
            let swing = quat::between_directions(line, asked);
            let to = two_bone_ik(asked, a, b, swing * from.hinge);
            turns = [(from.upper, to.upper), (from.lower, to.lower)].map(|(bone, turned)| {
                quat::renormalize(basis(turned, to.hinge) * basis(bone, from.hinge).conjugate())
            });
            let missing = wanted - (turns[0] * self.thigh + turns[1] * self.shin);
            if missing.length_squared() < 1e-10 {
                break;
            }
            asked = (asked + missing).clamp_length_max(self.reach());
        }
        turns
    }
}

impl LimbPose {
    /// Returns the flexion about `usual_axis`, an axis in the frame of the upper bone, radians:
    /// negative where the limb is bent backwards.
    pub(crate) fn flexion(&self, usual_axis: Vec3) -> f32 {
        let sine = self.bend().dot(self.rotations[0] * usual_axis);
        let lengths = (self.thigh.length() * self.shin.length()).max(1e-9);
        libm::atan2f(sine, self.thigh.dot(self.shin) / lengths)
    }

    /// Returns the distance from start to end at a flexion, metres.
    fn distance_at(&self, flexion: f32) -> f32 {
        let (a, b) = (self.thigh.length(), self.shin.length());
        (a * a + b * b + 2.0 * a * b * libm::cosf(flexion)).max(0.0).sqrt()
    }

    /// Returns world rotations of the two bones that move the end by `shift` relative to the start,
    /// as far as the limits allow: the limb bends about `usual_axis`, an axis in the frame of the
    /// upper bone, and never backwards.
    ///
    /// Unlike [`turned`](Self::turned), which applies a difference, this solves for the limb as a
    /// whole, so that a limb that was bent backwards comes out bent forwards. The knee keeps its
    /// own plane where it is bent enough to have one. Near full stretch the end follows its target
    /// less and less (a smooth limit), from the extension on that the limb has already.
    pub(crate) fn solved(&self, shift: Vec3, usual_axis: Vec3, limits: Flexion) -> [Quat; 2] {
        let (a, b) = (self.thigh.length(), self.shin.length());
        let (bend, usual) = (self.bend(), self.rotations[0] * usual_axis);
        let own = curve::smoothstep(bend.dot(usual) / PLANE_SINE);
        let axis = bend * own + usual * PLANE_SINE * (1.0 - own);
        let line = self.line();
        let (nearest, farthest) = (self.distance_at(limits.most), self.distance_at(limits.least));
        let asked = line + shift;
        let distance = asked.length();
        let limited = curve::soft_limit(distance, self.reach().min(farthest), farthest);
        let asked =
            asked.normalize_or(line.normalize_or(Vec3::NEG_Y)) * limited.min(farthest).max(nearest);
        let hinge = across(axis, line.normalize_or(Vec3::NEG_Y));
        let to = two_bone_ik(asked, a, b, quat::between_directions(line, asked) * hinge);
        [(self.thigh, to.upper), (self.shin, to.lower)].map(|(bone, turned)| {
            let bone = bone.normalize_or(Vec3::NEG_Y);
            let from = basis(bone, across(axis, bone));
            quat::renormalize(basis(turned, to.hinge) * from.conjugate())
        })
    }
}

/// Returns the unit vector across `along`, a unit vector, that is nearest to `axis`.
fn across(axis: Vec3, along: Vec3) -> Vec3 {
    axis.reject_from_normalized(along).normalize_or(along.any_orthonormal_vector())
}

/// Returns the rotation from X to `hinge` and from Y to `bone`, perpendicular unit vectors.
fn basis(bone: Vec3, hinge: Vec3) -> Quat {
    Quat::from_mat3(&Mat3::from_cols(hinge, bone, hinge.cross(bone)))
}
