//! Mirroring of poses: counterparts of joints, and rotations between their frames.

use super::roles::{Tokens, are_counterparts, read};
use super::{Pose, Role, Roles, Side, Skeleton};
use crate::math::quat;
use crate::math::sort::{sort_by, sort_by_key};
use glam::{Quat, Vec3};

/// An axis of the rest pose this near to the skeleton's left-right axis is taken as that axis: cos
/// 15°.
const AXIS_COSINE: f32 = 0.966;
/// Joints nearer to each other are at one position, metres.
const MIN_BONE_M: f32 = 1e-6;
/// Smaller corrections are dropped, radians.
const MIN_CORRECTION_RADIANS: f32 = 1e-4;
/// Points nearer to the line of a bone than this share of its length do not determine a rotation
/// about it.
const MIN_DISTANCE_FROM_BONE: f32 = 0.05;
/// Two subtrees are counterparts by shape when the mirror image of one misses the other by at most
/// this share of its distance.
const SHAPE_TOLERANCE: f32 = 0.35;

/// Joints with more children than this (more than any body has) are compared by role and name only:
/// comparing shapes is quadratic.
const MAX_SIBLINGS: usize = 256;

/// Error of a skeleton in which no left joint has a counterpart on the right.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error, segue_text::ToMessage)]
#[error(
    "no joint on the left has a counterpart on the right: set the body parts, at least both thighs or upper arms"
)]
pub struct NoCounterparts;

/// The mirror image of a skeleton: the counterpart of each joint, and the rotation between their
/// frames.
///
/// With S the reflection `x → -x` of the world and M that of the rest pose in its own plane of
/// symmetry, a joint `j` with the counterpart `p` gets the world rotation `S · R(p) · M · C(j)`,
/// where `C(j)` rotates the bones that start at `j` to the mirror images of those that start at
/// `p`, each in its own joint's frame: exactly for the single bone of a limb, as nearly as possible
/// for several (hips, chest, hand). With a symmetric rest pose C is the identity. With any other
/// the bones still have the directions of the mirror image, and only their lengths are the
/// skeleton's own: the axes of the joints do not matter. Mirroring twice gives the original back,
/// because `C(p) = M · C(j)⁻¹ · M`.
///
/// A single bone leaves the rotation about itself open. A symmetric rest pose determines it, too;
/// an implausible rest pose does not, and a spine could come out rotated by half a turn. In that
/// case the motion determines it ([`Mirror::of_motion`]): on average the left does the same as the
/// right.
#[derive(Clone, Debug, PartialEq)]
pub struct Mirror {
    /// Unit normal of the rest pose's plane of symmetry.
    normal: Vec3,
    /// The counterpart of every joint: itself in the middle of the body, `None` where there is
    /// none.
    counterparts: Vec<Option<usize>>,
    parents: Vec<Option<usize>>,
    offsets: Vec<Vec3>,
    corrections: Vec<Quat>,
}

impl Mirror {
    /// Pairs the joints of a skeleton: those with roles (or above a joint with a role) by role,
    /// others by name, then by position at rest.
    ///
    /// # Errors
    /// [`NoCounterparts`] when roles and names give no pair.
    pub fn of(skeleton: &Skeleton, roles: &Roles) -> Result<Self, NoCounterparts> {
        Self::with_usual_rotations(skeleton, roles, None)
    }

    /// Pairs the joints as [`of`](Self::of) does, for a skeleton with an implausible rest pose.
    /// `usual` is the mean local rotation of each joint in a motion. Rotations that the bones leave
    /// open are chosen so that the mirror image has these means, too, as nearly as possible.
    ///
    /// # Errors
    /// The same as for [`of`](Self::of).
    pub fn of_motion(
        skeleton: &Skeleton,
        roles: &Roles,
        usual: &[Quat],
    ) -> Result<Self, NoCounterparts> {
        Self::with_usual_rotations(skeleton, roles, Some(usual))
    }

    fn with_usual_rotations(
        skeleton: &Skeleton,
        roles: &Roles,
        usual: Option<&[Quat]>,
    ) -> Result<Self, NoCounterparts> {
        let rest = skeleton.rest_positions();
        let normal = left_right_axis(skeleton, roles, &rest).ok_or(NoCounterparts)?;
        let pairing = CounterpartSearch::new(skeleton, roles, &rest, normal);
        let counterparts = pairing.counterparts();
        if !counterparts
            .iter()
            .enumerate()
            .any(|(joint, other)| other.is_some_and(|other| other != joint))
        {
            return Err(NoCounterparts);
        }
        let mut mirror = Self {
            normal,
            counterparts,
            parents: skeleton.joints().iter().map(|j| j.parent).collect(),
            offsets: skeleton.joints().iter().map(|j| j.offset).collect(),
            corrections: vec![Quat::IDENTITY; skeleton.len()],
        };
        for joint in 0..skeleton.len() {
            let Some(other) = mirror.counterparts[joint] else {
                continue;
            };
            let bones = mirror.bones_below(joint);
            // Several bones may all lie on one line, and then leave the rotation about it open. The
            // longest represents them; in the middle of the body their sum does, for a bone of one
            // side would be rotated to that of the other, and mirroring twice would not give the
            // pose back.
            let sum = |bones: &[(Vec3, Vec3)]| {
                bones
                    .iter()
                    .fold((Vec3::ZERO, Vec3::ZERO), |sum, bone| (sum.0 + bone.0, sum.1 + bone.1))
            };
            let longest =
                bones.iter().copied().max_by(|a, b| a.0.length().total_cmp(&b.0.length()));
            let bone = match (pairing.bone(joint), pairing.bone(other)) {
                (Some(bone), Some(others)) => Some((bone, mirror.reflected(others))),
                _ if other == joint => Some(sum(&bones)),
                _ => longest,
            };
            let bone = bone.filter(|(bone, _)| bone.length() > MIN_BONE_M);
            let near = usual.and_then(|usual| mirror.usual_correction(joint, other, usual));
            mirror.corrections[joint] = match (bone, quat::best_fit(&bones)) {
                // The second of a pair is computed from the first, so that they are inverse to the
                // last bit.
                _ if other < joint => {
                    mirror.reflected_rotation(mirror.corrections[other].conjugate())
                }
                (_, Some(turn)) if pairing.bone(joint).is_none() => turn,
                (Some((bone, others)), _) => {
                    turned_about_bone(bone, others, &bones, near.unwrap_or(Quat::IDENTITY))
                }
                _ if near.is_some() => near.unwrap_or(Quat::IDENTITY),
                // Joints without bones follow their parent, except in the middle, where a joint is
                // the mirror image of itself.
                _ if other != joint => mirror.parents[joint]
                    .map_or(Quat::IDENTITY, |parent| mirror.corrections[parent]),
                _ => Quat::IDENTITY,
            };
            if quat::angle_between(mirror.corrections[joint], Quat::IDENTITY)
                < MIN_CORRECTION_RADIANS
            {
                mirror.corrections[joint] = Quat::IDENTITY;
            }
        }
        Ok(mirror)
    }

    /// Returns the correction for which the mirror image of the counterpart's usual rotation is the
    /// joint's own usual rotation.
    fn usual_correction(&self, joint: usize, other: usize, usual: &[Quat]) -> Option<Quat> {
        let parent = self.parents[joint]?;
        let image =
            self.corrections[parent].conjugate() * self.reflected_rotation(*usual.get(other)?);
        Some(quat::renormalize(image.conjugate() * *usual.get(joint)?))
    }

    /// Returns the bones that start at a joint, each with the mirror image of the one that starts
    /// at its counterpart and ends at the counterpart of its end.
    fn bones_below(&self, joint: usize) -> Vec<(Vec3, Vec3)> {
        let below =
            (joint + 1..self.parents.len()).filter(|&child| self.parents[child] == Some(joint));
        let pair = |child: usize| {
            let other = self.counterparts[child]
                .filter(|&other| self.parents[other] == self.counterparts[joint])?;
            Some((self.offsets[child], self.reflected(self.offsets[other])))
        };
        below.filter_map(pair).collect()
    }

    /// Returns the counterpart of a joint: itself in the middle of the body; `None` for a joint
    /// without counterpart.
    #[must_use]
    pub fn counterpart(&self, joint: usize) -> Option<usize> {
        self.counterparts.get(joint).copied().flatten()
    }

    /// Mirrors a pose in the plane x = 0 of the world. Joints without counterpart keep their own
    /// rotation.
    #[must_use]
    pub fn pose(&self, pose: &Pose) -> Pose {
        let local = |joint: usize| pose.rotations.get(joint).copied().unwrap_or(Quat::IDENTITY);
        let rotations = (0..self.counterparts.len()).map(|joint| {
            match (self.counterparts[joint], self.parents[joint]) {
                (Some(other), Some(parent)) => {
                    let mirrored = self.reflected_rotation(local(other));
                    quat::renormalize(
                        self.corrections[parent].conjugate() * mirrored * self.corrections[joint],
                    )
                }
                (_, None) => {
                    // S · R · M = (S · R · S) · (S · M), and two reflections are the product of
                    // their normals as pure quaternions.
                    let q = local(joint);
                    let (x, n) = (Quat::from_xyzw(1.0, 0.0, 0.0, 0.0), self.normal);
                    let reflections = x * Quat::from_xyzw(n.x, n.y, n.z, 0.0);
                    quat::renormalize(
                        Quat::from_xyzw(q.x, -q.y, -q.z, q.w)
                            * reflections
                            * self.corrections[joint],
                    )
                }
                (None, Some(_)) => local(joint),
            }
        });
        let mut translations: Vec<(usize, Vec3)> = pose
            .translations
            .iter()
            .map(|&(joint, value)| self.translation(joint, value))
            .collect();
        sort_by_key(&mut translations, |&(joint, _)| joint);
        Pose {
            root_translation: pose.root_translation * Vec3::new(-1.0, 1.0, 1.0),
            rotations: rotations.collect(),
            translations,
        }
    }

    /// Mirrors the local translation of `joint`; returns the joint that it applies to, and the
    /// translation.
    fn translation(&self, joint: usize, value: Vec3) -> (usize, Vec3) {
        let (Some(other), Some(Some(parent))) = (self.counterpart(joint), self.parents.get(joint))
        else {
            return (joint, value);
        };
        let into_parent = self.parents[other]
            .map_or(Quat::IDENTITY, |parent| self.corrections[parent].conjugate());
        if other == joint {
            return (joint, self.corrections[*parent].conjugate() * self.reflected(value));
        }
        // Only the difference to rest is mirrored, so that a bone at its rest length keeps its own
        // length.
        (other, self.offsets[other] + into_parent * self.reflected(value - self.offsets[joint]))
    }

    /// Returns M · v.
    fn reflected(&self, v: Vec3) -> Vec3 {
        v - 2.0 * self.normal * self.normal.dot(v)
    }

    /// Returns M · q · M.
    fn reflected_rotation(&self, q: Quat) -> Quat {
        let v = -self.reflected(Vec3::new(q.x, q.y, q.z));
        Quat::from_xyzw(v.x, v.y, v.z, q.w)
    }
}

/// Returns the rotation from one bone to another that also brings the other bones of the joint as
/// near as possible to their targets; without other bones, the one nearest to `near`.
fn turned_about_bone(from: Vec3, to: Vec3, bones: &[(Vec3, Vec3)], near: Quat) -> Quat {
    let turn = quat::renormalize(quat::between_directions(near * from, to) * near);
    let Some(axis) = to.try_normalize() else {
        return turn;
    };
    let (mut sin, mut cos, mut size) = (0.0, 0.0, 0.0_f32);
    for &(bone, wanted) in bones {
        let across = |v: Vec3| v - axis * axis.dot(v);
        let (bone, wanted) = (across(turn * bone), across(wanted));
        sin += axis.dot(bone.cross(wanted));
        cos += bone.dot(wanted);
        size = size.max(bone.length().min(wanted.length()));
    }
    if size < MIN_DISTANCE_FROM_BONE * from.length() {
        return turn;
    }
    quat::renormalize(Quat::from_axis_angle(axis, libm::atan2f(sin, cos)) * turn)
}

/// Returns the unit vector from right to left of the rest pose: by roles, otherwise by names.
fn left_right_axis(skeleton: &Skeleton, roles: &Roles, rest: &[Vec3]) -> Option<Vec3> {
    let at = |role| roles.get(role).and_then(|joint| rest.get(joint).copied());
    let by_role = Role::ALL.into_iter().filter(|role| role.side() == Some(Side::Left));
    let mut differences: Vec<Vec3> =
        by_role.filter_map(|role| Some(at(role)? - at(role.mirrored())?)).collect();
    if differences.is_empty() {
        let names: Vec<Tokens> = skeleton.joints().iter().map(|joint| read(&joint.name)).collect();
        for (a, first) in names.iter().enumerate().filter(|(_, name)| name.side == Some(Side::Left))
        {
            let second = names.iter().position(|second| are_counterparts(first, second));
            differences.extend(second.map(|b| rest[a] - rest[b]));
        }
    }
    // The sign of a difference does not matter for a plane, but differences must not cancel out.
    let longest = differences.iter().copied().max_by(|a, b| a.length().total_cmp(&b.length()))?;
    let axis = differences
        .iter()
        .map(|&d| if d.dot(longest) < 0.0 { -d } else { d })
        .sum::<Vec3>()
        .try_normalize()
        .unwrap_or(Vec3::X);
    let snapped =
        [Vec3::X, Vec3::Y, Vec3::Z].into_iter().find(|unit| axis.dot(*unit).abs() > AXIS_COSINE);
    Some(snapped.unwrap_or(axis))
}

/// The data for finding counterparts.
struct CounterpartSearch<'a> {
    skeleton: &'a Skeleton,
    names: Vec<Tokens>,
    children: Vec<Vec<usize>>,
    /// For every joint, the roles of itself and all joints below, as bits.
    roles_below: Vec<u32>,
    /// For every joint, the mean position of itself, the joints and the end sites below, relative
    /// to its parent.
    centres: Vec<Vec3>,
    normal: Vec3,
}

impl<'a> CounterpartSearch<'a> {
    fn new(skeleton: &'a Skeleton, roles: &Roles, rest: &[Vec3], normal: Vec3) -> Self {
        let joints = skeleton.joints();
        let mut children = vec![Vec::new(); joints.len()];
        let mut roles_below = vec![0u32; joints.len()];
        let mut sums: Vec<(Vec3, f32)> = rest.iter().map(|&p| (p, 1.0)).collect();
        for role in Role::ALL {
            if let Some(joint) = roles.get_within(role, joints.len()) {
                roles_below[joint] |= 1 << role.index();
            }
        }
        for (index, joint) in joints.iter().enumerate().rev() {
            if let Some(end) = joint.end_site {
                sums[index] = (sums[index].0 + rest[index] + end, sums[index].1 + 1.0);
            }
            if let Some(parent) = joint.parent {
                children[parent].insert(0, index);
                roles_below[parent] |= roles_below[index];
                sums[parent] = (sums[parent].0 + sums[index].0, sums[parent].1 + sums[index].1);
            }
        }
        let from = |index: usize| joints[index].parent.map_or(Vec3::ZERO, |parent| rest[parent]);
        let centres = sums
            .iter()
            .enumerate()
            .map(|(index, (sum, count))| *sum / *count - from(index))
            .collect();
        let names = joints.iter().map(|joint| read(&joint.name)).collect();
        Self { skeleton, names, children, roles_below, centres, normal }
    }

    /// Returns the counterpart of every joint, from the root down: children of counterparts are
    /// compared with each other.
    fn counterparts(&self) -> Vec<Option<usize>> {
        let mut counterparts: Vec<Option<usize>> = vec![None; self.skeleton.len()];
        counterparts[0] = Some(0);
        for joint in 0..self.skeleton.len() {
            // Parents come before children, so the counterpart of a joint is known before its
            // children are compared.
            let Some(other) = counterparts[joint].filter(|&other| joint <= other) else {
                continue;
            };
            let mut candidates: Vec<(u8, f32, usize, usize)> = Vec::new();
            for &a in &self.children[joint] {
                for &b in self.children[other].iter().filter(|&&b| joint != other || a <= b) {
                    candidates.extend(
                        self.likeness(a, b, joint == other).map(|(rank, cost)| (rank, cost, a, b)),
                    );
                }
            }
            sort_by(&mut candidates, |x, y| x.0.cmp(&y.0).then(x.1.total_cmp(&y.1)));
            for (_, _, a, b) in candidates {
                if counterparts[a].is_none() && counterparts[b].is_none() {
                    counterparts[a] = Some(b);
                    counterparts[b] = Some(a);
                }
            }
        }
        counterparts
    }

    /// Returns the quality of a pair of joints: rank (roles, names, shape), then the distance by
    /// which the mirror image misses. `None` for no pair.
    fn likeness(&self, a: usize, b: usize, in_the_middle: bool) -> Option<(u8, f32)> {
        let reflected = self.centres[a] - 2.0 * self.normal * self.normal.dot(self.centres[a]);
        let cost = reflected.distance(self.centres[b]);
        let (below_a, below_b) = (self.roles_below[a], self.roles_below[b]);
        if below_a != 0 || below_b != 0 {
            // Roles decide where there are any, though some may be missing on one side.
            let mirrored = mirrored_roles(below_a);
            return if mirrored & below_b != 0 {
                Some((0, cost))
            } else {
                (a == b).then_some((3, cost))
            };
        }
        if a != b && are_counterparts(&self.names[a], &self.names[b]) {
            return Some((1, cost));
        }
        let siblings = self.skeleton.parent(a).map_or(0, |parent| self.children[parent].len());
        let fits =
            siblings <= MAX_SIBLINGS && cost <= SHAPE_TOLERANCE * self.centres[a].length() + 1e-4;
        // A joint off the middle without a partner, such as a tail or the strap of a bag, is its
        // own counterpart.
        if fits { Some((2, cost)) } else { (in_the_middle && a == b).then_some((3, cost)) }
    }

    /// Returns the direction of the bone that starts at a joint, not of unit length: to the only
    /// child, or the only one with a role below; for a leaf to its end site. Joints at the same
    /// position count as one.
    fn bone(&self, joint: usize) -> Option<Vec3> {
        let mut at = joint;
        loop {
            let children = &self.children[at];
            let next = match children.as_slice() {
                [] => {
                    return self.skeleton.joints()[at]
                        .end_site
                        .filter(|end| end.length() > MIN_BONE_M);
                }
                [only] => *only,
                several => {
                    let mut leading = several.iter().filter(|&&child| self.roles_below[child] != 0);
                    leading.next().copied().filter(|_| leading.next().is_none())?
                }
            };
            let offset = self.skeleton.joints()[next].offset;
            if offset.length() > MIN_BONE_M {
                return Some(offset);
            }
            at = next;
        }
    }
}

fn mirrored_roles(bits: u32) -> u32 {
    Role::ALL
        .into_iter()
        .filter(|role| bits & (1 << role.index()) != 0)
        .fold(0, |sum, role| sum | 1 << role.mirrored().index())
}

#[cfg(test)]
mod tests {
    use super::super::{Joint, fixtures};
    use super::*;

    fn counterpart_names(
        skeleton: &Skeleton,
        roles: &Roles,
        names: &Skeleton,
    ) -> Vec<(String, String)> {
        let mirror = Mirror::of(skeleton, roles).unwrap();
        let name = |joint: usize| names.joints()[joint].name.clone();
        (0..skeleton.len())
            .map(|joint| (name(joint), name(mirror.counterpart(joint).unwrap())))
            .collect()
    }

    /// Fingers, eyes, collar bones and twist joints have their counterparts, with names or without.
    #[test]
    fn counterparts_of_every_rig_are_complete() {
        for (rig, skeleton, _) in fixtures::all() {
            for seed in 0..3 {
                let (skeleton, _) =
                    fixtures::shuffled(&fixtures::uneven(&skeleton, 1.0, 0.02, 0.03, seed), seed);
                let roles = fixtures::roles(&skeleton);
                for names_count in [true, false] {
                    let seen =
                        if names_count { skeleton.clone() } else { fixtures::nameless(&skeleton) };
                    for (name, other) in counterpart_names(&seen, &roles, &skeleton) {
                        let (ours, theirs) = (read(&name), read(&other));
                        assert!(
                            name == other || are_counterparts(&ours, &theirs),
                            "{rig}: {name} and {other}"
                        );
                        let is_sided = ours.side.is_some() && name != "L5";
                        assert_eq!(name != other, is_sided, "{rig}: {name} and {other}");
                    }
                }
            }
        }
    }

    #[test]
    fn mirrored_joint_without_counterpart_keeps_its_rotation() {
        let mut joints = fixtures::lafan().joints().to_vec();
        let hand = joints.iter().position(|joint| joint.name == "RightHand");
        joints.push(Joint {
            name: "Sword".into(),
            parent: hand,
            offset: Vec3::NEG_X * 0.1,
            end_site: None,
            channels: vec![],
        });
        let skeleton = Skeleton::new(joints).unwrap();
        let mirror = Mirror::of(&skeleton, &fixtures::roles(&skeleton)).unwrap();
        assert_eq!(mirror.counterpart(skeleton.len() - 1), None);
        let mut pose = Pose { rotations: vec![Quat::IDENTITY; skeleton.len()], ..Pose::default() };
        pose.rotations[skeleton.len() - 1] = Quat::from_rotation_x(0.5);
        assert_eq!(mirror.pose(&pose).rotations[skeleton.len() - 1], Quat::from_rotation_x(0.5));
    }

    #[test]
    fn corrections_of_a_pair_are_inverse() {
        let skeleton = fixtures::uneven(&fixtures::mixamo(), 1.0, 0.3, 0.2, 6);
        let mirror = Mirror::of(&skeleton, &fixtures::roles(&skeleton)).unwrap();
        for joint in 0..skeleton.len() {
            let other = mirror.counterpart(joint).unwrap();
            let back =
                mirror.reflected_rotation(mirror.corrections[other]) * mirror.corrections[joint];
            assert!(quat::log(back).length() < 1e-6, "{joint}");
        }
    }
}
