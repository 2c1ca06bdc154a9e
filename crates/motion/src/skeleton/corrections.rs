//! Corrections between the rest poses of two skeletons, for retargeting.

use super::ancestry::Ancestry;
use super::joint_map::{JointMap, Landmarks};
use super::{Role, Roles, Side, Skeleton};
use crate::math::quat;
use glam::{Mat3, Quat, Vec3};

/// Rest directions that differ by less are considered equal, radians (2°): local rotations are then
/// copied unchanged.
const MIN_CORRECTION_RADIANS: f32 = 0.035;
/// The limit for back, neck and head, radians (15°): rigs place these joints differently in one and
/// the same body.
const MIN_BACK_CORRECTION_RADIANS: f32 = 0.26;
/// The limit for collar bones, radians (45°): they start anywhere between breast bone and spine.
const MIN_COLLAR_CORRECTION_RADIANS: f32 = 0.79;
/// The limit for feet, radians (35°): ankles lie higher or lower above one and the same sole. Below
/// it the foot counts as flat in both rigs, and only its heading is corrected.
const MIN_FOOT_CORRECTION_RADIANS: f32 = 0.61;

/// Returns for every driven joint of the target the rotation from its bone at rest to that of its
/// driving joint; the identity for other joints.
pub(super) fn corrections(
    source: &Skeleton,
    source_body: &BodyAxes,
    target: &Skeleton,
    target_roles: &Roles,
    map: &JointMap,
) -> Vec<Quat> {
    let whole_body =
        source_body.rotation * BodyAxes::at_rest(target, target_roles).rotation.conjugate();
    let (left, up) = (source_body.left, source_body.rotation * Vec3::Y);
    let landmarks = Landmarks::of(target, target_roles);
    let back = back(target, target_roles);
    let bones = Bones::new(source, target, target_roles, map, landmarks.chest);
    let is_any = |joint: usize, role: fn(Side) -> Role| {
        Side::BOTH.into_iter().any(|side| target_roles.get(role(side)) == Some(joint))
    };
    let mut corrections = vec![Quat::IDENTITY; target.len()];
    // The correction of the nearest driven joint at or above each joint; parents come first.
    let mut nearest = vec![whole_body; target.len()];
    for joint in 0..target.len() {
        let inherited = target.parent(joint).map_or(whole_body, |parent| nearest[parent]);
        nearest[joint] = inherited;
        let Some(from) = map.source_of(joint) else {
            continue;
        };
        corrections[joint] = match bones.at(joint, from) {
            Bone::Trunk => whole_body,
            // A hand without fingers counts as straight: it bends against its forearm as in the
            // source.
            Bone::None => inherited,
            Bone::Direction { target, source } => {
                let target = whole_body * target;
                let turn = match quat::log(quat::between_directions(target, source)).length() {
                    a if a < MIN_CORRECTION_RADIANS => Quat::IDENTITY,
                    a if a < MIN_BACK_CORRECTION_RADIANS && back.contains(&joint) => Quat::IDENTITY,
                    a if a < MIN_COLLAR_CORRECTION_RADIANS
                        && landmarks.collars.contains(&Some(joint)) =>
                    {
                        Quat::IDENTITY
                    }
                    a if a < MIN_FOOT_CORRECTION_RADIANS && is_any(joint, Role::foot) => {
                        heading_turn(target, source, up)
                    }
                    a if a < MIN_FOOT_CORRECTION_RADIANS && is_any(joint, Role::toe) => {
                        inherited * whole_body.conjugate()
                    }
                    _ => turn_about(target, source, left),
                };
                quat::renormalize(turn * whole_body)
            }
        };
        nearest[joint] = corrections[joint];
    }
    corrections
}

/// The corresponding bones of two skeletons.
struct Bones<'a> {
    source: &'a Skeleton,
    target: &'a Skeleton,
    map: &'a JointMap,
    source_rest: Vec<Vec3>,
    target_rest: Vec<Vec3>,
    source_tree: Ancestry,
    target_tree: Ancestry,
    /// Preference of each joint of the target as the end of the bone above it: 0 the chest, 1
    /// joints with roles (toes come before a heel), 2 all others.
    ranks: Vec<u8>,
    hips: Option<usize>,
}

impl<'a> Bones<'a> {
    fn new(
        source: &'a Skeleton,
        target: &'a Skeleton,
        target_roles: &Roles,
        map: &'a JointMap,
        chest: Option<usize>,
    ) -> Self {
        let rank = |joint: usize| match target_roles.role_of(joint) {
            _ if chest == Some(joint) => 0,
            Some(_) => 1,
            None => 2,
        };
        Self {
            source,
            target,
            map,
            source_rest: source.rest_positions(),
            target_rest: target.rest_positions(),
            source_tree: Ancestry::of(source),
            target_tree: Ancestry::of(target),
            ranks: (0..target.len()).map(rank).collect(),
            hips: target_roles.get(Role::Hips),
        }
    }

    /// Returns the bones that start at a joint of the target and at its driving joint, both to
    /// corresponding joints (or end sites).
    fn at(&self, joint: usize, from: usize) -> Bone {
        if self.hips == Some(joint) || self.ranks[joint] == 0 || (joint == 0 && self.ranks[0] == 2)
        {
            return Bone::Trunk;
        }
        let long = |v: Vec3| v.length() > 1e-4;
        let bone_to = |below: usize| {
            let end = self.map.source_of(below)?;
            let bones = (
                self.target_rest[below] - self.target_rest[joint],
                self.source_rest[end] - self.source_rest[from],
            );
            let below_both =
                self.target_tree.is_below(below, joint) && self.source_tree.is_below(end, from);
            (below_both && long(bones.0) && long(bones.1)).then_some((
                self.ranks[below],
                below,
                bones,
            ))
        };
        let best = (joint + 1..self.target.len())
            .filter_map(bone_to)
            .min_by_key(|&(rank, below, _)| (rank, below));
        if let Some((_, _, (target, source))) = best {
            return Bone::Direction { target, source };
        }
        match (self.target.joints()[joint].end_site, self.source.joints()[from].end_site) {
            (Some(target), Some(source)) if long(target) && long(source) => {
                Bone::Direction { target, source }
            }
            _ => Bone::None,
        }
    }
}

/// The known direction of a joint's bone at rest.
enum Bone {
    /// Corresponding bones, not of unit length.
    Direction { target: Vec3, source: Vec3 },
    /// Hips or chest: they have the axes of the body.
    Trunk,
    /// Nothing is known.
    None,
}

/// Returns the rotation from the direction `from` to `to`. Where they are opposite it is about
/// `left`, as legs and spines bend.
fn turn_about(from: Vec3, to: Vec3, left: Vec3) -> Quat {
    let turn = quat::between_directions(from, to);
    let opposite = quat::log(turn).length() > std::f32::consts::PI - MIN_CORRECTION_RADIANS;
    if opposite && from.try_normalize().is_some_and(|from| from.dot(left).abs() < 0.5) {
        let half_turn = Quat::from_axis_angle(left, std::f32::consts::PI);
        return quat::between_directions(half_turn * from, to) * half_turn;
    }
    turn
}

/// Returns the rotation about `up` from the heading of `from` to that of `to`; the identity below
/// 2°.
fn heading_turn(from: Vec3, to: Vec3, up: Vec3) -> Quat {
    let level = |v: Vec3| v - up * up.dot(v);
    let turn = quat::between_directions(level(from), level(to));
    if quat::log(turn).length() < MIN_CORRECTION_RADIANS { Quat::IDENTITY } else { turn }
}

/// The axes of a body at rest.
pub(super) struct BodyAxes {
    /// From right to left, unit length.
    pub(super) left: Vec3,
    /// Rotates +X to the left and +Y up along the back.
    pub(super) rotation: Quat,
}

impl BodyAxes {
    /// Returns axes from hips or shoulders and the back; those of the world where roles are
    /// missing. An axis within 15° of a world axis is set to that axis.
    pub(super) fn at_rest(skeleton: &Skeleton, roles: &Roles) -> Self {
        let rest = skeleton.rest_positions();
        let at = |role| roles.get(role).and_then(|joint| rest.get(joint).copied());
        let across = |role: fn(Side) -> Role| {
            Some(at(role(Side::Left))? - at(role(Side::Right))?).filter(|v| v.length() > 1e-4)
        };
        let middle =
            |role: fn(Side) -> Role| Some((at(role(Side::Left))? + at(role(Side::Right))?) * 0.5);
        let low = middle(Role::thigh).or_else(|| at(Role::Hips));
        let high = at(Role::Head).or_else(|| middle(Role::upper_arm)).or_else(|| at(Role::Spine));
        let left = snapped(across(Role::thigh).or_else(|| across(Role::upper_arm)));
        let up = snapped(low.zip(high).map(|(low, high)| high - low));
        let (Some(left), Some(up)) = (left, up) else {
            return Self { left: Vec3::X, rotation: Quat::IDENTITY };
        };
        let Some(up) = (up - left * left.dot(up)).try_normalize() else {
            return Self { left, rotation: Quat::IDENTITY };
        };
        let rotation =
            quat::renormalize(Quat::from_mat3(&Mat3::from_cols(left, up, left.cross(up))));
        Self { left, rotation }
    }
}

/// Returns a unit vector, snapped to an axis of the world within 15°.
fn snapped(v: Option<Vec3>) -> Option<Vec3> {
    let v = v?.try_normalize()?;
    Some(
        Vec3::AXES
            .into_iter()
            .flat_map(|axis| [axis, -axis])
            .find(|axis| axis.dot(v) > 0.966)
            .unwrap_or(v),
    )
}

/// Returns the joints from the hips up to the head, both included; empty where either is unknown or
/// the head is not below the hips.
pub(super) fn back(skeleton: &Skeleton, roles: &Roles) -> Vec<usize> {
    let joint = |role| roles.get_within(role, skeleton.len());
    let (Some(hips), Some(head)) = (joint(Role::Hips), joint(Role::Head)) else {
        return Vec::new();
    };
    if !std::iter::successors(Some(head), |&j| skeleton.parent(j)).any(|joint| joint == hips) {
        return Vec::new();
    }
    let mut back: Vec<usize> = std::iter::successors(Some(head), |&j| skeleton.parent(j))
        .take_while(|&joint| joint != hips)
        .collect();
    back.push(hips);
    back.reverse();
    back
}
