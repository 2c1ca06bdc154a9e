use super::joint_map::{JointMap, Landmarks};
use super::roles::is_below;
use super::{Pose, Role, Roles, Side, Skeleton, WorldPose, world_pose};
use crate::math::quat;
use glam::{Mat3, Quat, Vec3};
use std::sync::Arc;

/// Rest directions that differ by less are the same by intention, radians (2°): local rotations are then copied as they are.
const SAME_DIRECTION_RADIANS: f32 = 0.035;
/// In the back, neck and head the same holds up to 15°: there rigs place their joints differently in one and the same body.
const SAME_BACK_RADIANS: f32 = 0.26;
/// Collar bones start anywhere between breast bone and spine, so their directions differ by more in one body: up to 45°.
const SAME_COLLAR_RADIANS: f32 = 0.79;
/// Ankles lie higher or lower above one and the same sole: up to 35° the foot counts as flat in both rigs, and only its heading is corrected.
const SAME_FOOT_RADIANS: f32 = 0.61;
/// Offsets that differ by less are the same, metres.
const SAME_OFFSET_M: f32 = 1e-5;

/// How poses of one skeleton become poses of another.
///
/// A driven joint gets the world rotation of the joint that drives it, times the rotation that takes the target's bone at rest to the
/// source's bone at rest: `world_target = world_source · C`. Where rest directions agree within 2°, C is that of the body as a whole, most
/// often the identity, and what local rotations the files have survives. Joints of the back that nothing drives share the bend between the
/// driven ones around them; other joints that nothing drives keep their rest rotation. The hips' way through the world is scaled by the
/// ratio of the legs' lengths, so that steps keep their proportion and feet do not slide.
#[derive(Clone, Debug)]
pub struct Retargeting {
    source: Arc<Skeleton>,
    target: Arc<Skeleton>,
    map: JointMap,
    corrections: Vec<Quat>,
    whole_body: Quat,
    /// For joints of the back that nothing drives: (driven above, driven below, share of the way from one to the other).
    shares: Vec<Option<(usize, usize, f32)>>,
    /// Hips of the source and of the target.
    hips: (usize, usize),
    scale: f32,
    same_rig: bool,
}

impl Retargeting {
    /// Prepares the way from `source` to `target`; `None` when no joint of the source drives any joint of the target.
    #[must_use]
    pub fn new(source: &Arc<Skeleton>, source_roles: &Roles, target: &Arc<Skeleton>, target_roles: &Roles) -> Option<Self> {
        let map = JointMap::between(target, target_roles, source, source_roles);
        if map.count() == 0 {
            return None;
        }
        let same_rig = is_same_rig(source, target, &map);
        let (from_body, to_body) = (BodyAxes::at_rest(source, source_roles), BodyAxes::at_rest(target, target_roles));
        let whole_body = from_body.rotation * to_body.rotation.conjugate();
        let scale = if same_rig {
            1.0
        } else {
            scale(source, source_roles, target, target_roles)
        };
        let hips_of = |skeleton: &Skeleton, roles: &Roles| roles.get_within(Role::Hips, skeleton.len()).unwrap_or(0);
        let mut retargeting = Self {
            corrections: vec![Quat::IDENTITY; target.len()],
            shares: back_shares(target, target_roles, &map),
            hips: (hips_of(source, source_roles), hips_of(target, target_roles)),
            source: Arc::clone(source),
            target: Arc::clone(target),
            map,
            whole_body,
            scale,
            same_rig,
        };
        if !same_rig {
            retargeting.find_corrections(target_roles, &from_body);
        }
        Some(retargeting)
    }

    fn find_corrections(&mut self, target_roles: &Roles, source_body: &BodyAxes) {
        let (source_rest, target_rest) = (self.source.rest_positions(), self.target.rest_positions());
        let back = back(&self.target, target_roles);
        let landmarks = Landmarks::of(&self.target, target_roles);
        let is_any = |joint: usize, role: fn(Side) -> Role| Side::BOTH.into_iter().any(|side| target_roles.get(role(side)) == Some(joint));
        for joint in 0..self.target.len() {
            let Some(from) = self.map.source_of(joint) else { continue };
            let inherited = self.driven_above(joint).map_or(self.whole_body, |above| self.corrections[above]);
            self.corrections[joint] = match self.bone(joint, from, target_roles, landmarks.chest, &source_rest, &target_rest) {
                Bone::Trunk => self.whole_body,
                // A hand without fingers is straight where the other one is: it bends against its forearm as in the source.
                Bone::None => inherited,
                Bone::Direction { target, source } => {
                    let (from, left, up) = (self.whole_body * target, source_body.left, source_body.rotation * Vec3::Y);
                    let angle = quat::log(quat::between_directions(from, source)).length();
                    let turn = match angle {
                        a if a < SAME_DIRECTION_RADIANS => Quat::IDENTITY,
                        a if a < SAME_BACK_RADIANS && back.contains(&joint) => Quat::IDENTITY,
                        a if a < SAME_COLLAR_RADIANS && landmarks.collars.contains(&Some(joint)) => Quat::IDENTITY,
                        a if a < SAME_FOOT_RADIANS && is_any(joint, Role::foot) => heading_turn(from, source, up),
                        a if a < SAME_FOOT_RADIANS && is_any(joint, Role::toe) => inherited * self.whole_body.conjugate(),
                        _ => turn_about(from, source, left),
                    };
                    quat::renormalize(turn * self.whole_body)
                }
            };
        }
    }

    fn driven_above(&self, joint: usize) -> Option<usize> {
        std::iter::successors(self.target.parent(joint), |&j| self.target.parent(j)).find(|&j| self.map.source_of(j).is_some())
    }

    /// The bones that start at a joint of the target and at the one that drives it, both to joints (or ends) that correspond.
    fn bone(
        &self,
        joint: usize,
        from: usize,
        target_roles: &Roles,
        chest: Option<usize>,
        source_rest: &[Vec3],
        target_rest: &[Vec3],
    ) -> Bone {
        let role = target_roles.role_of(joint);
        if role == Some(Role::Hips) || chest == Some(joint) || (role.is_none() && joint == 0) {
            return Bone::Trunk;
        }
        let long = |v: Vec3| v.length() > 1e-4;
        // The chest first, for the back; then joints with roles (toes come before a heel), then the nearest in the tree.
        let mut below: Vec<usize> = (joint + 1..self.target.len())
            .filter(|&j| is_below(&self.target, j, joint))
            .collect();
        below.sort_by_key(|&j| (chest != Some(j), target_roles.role_of(j).is_none(), j));
        for below in below {
            let Some(end) = self.map.source_of(below).filter(|&end| is_below(&self.source, end, from)) else {
                continue;
            };
            let (ours, theirs) = (target_rest[below] - target_rest[joint], source_rest[end] - source_rest[from]);
            if long(ours) && long(theirs) {
                return Bone::Direction {
                    target: ours,
                    source: theirs,
                };
            }
        }
        match (self.target.joints()[joint].end_site, self.source.joints()[from].end_site) {
            (Some(ours), Some(theirs)) if long(ours) && long(theirs) => Bone::Direction {
                target: ours,
                source: theirs,
            },
            _ => Bone::None,
        }
    }

    /// The joint map.
    #[must_use]
    pub fn map(&self) -> &JointMap {
        &self.map
    }

    /// By how much lengths of the source are multiplied on the target.
    #[must_use]
    pub fn scale(&self) -> f32 {
        self.scale
    }

    /// Whether the skeletons differ in nothing but the order of their joints, and in joints that one of them lacks at its ends.
    #[must_use]
    pub fn is_same_rig(&self) -> bool {
        self.same_rig
    }

    /// The rotation that takes the target's bone at rest to that of the source which drives it; the identity for joints that nothing drives.
    #[must_use]
    pub fn correction(&self, target_joint: usize) -> Quat {
        self.corrections.get(target_joint).copied().unwrap_or(Quat::IDENTITY)
    }

    /// A pose of the source as a pose of the target.
    #[must_use]
    pub fn pose(&self, pose: &Pose) -> Pose {
        if self.same_rig {
            return self.copied(pose);
        }
        let world = world_pose(&self.source, pose);
        let mut worlds: Vec<Quat> = Vec::with_capacity(self.target.len());
        let mut rotations: Vec<Quat> = Vec::with_capacity(self.target.len());
        for (joint, parent) in self.target.joints().iter().map(|j| j.parent).enumerate() {
            let above = parent.map_or(Quat::IDENTITY, |parent| worlds[parent]);
            let turned = self.world_rotation(joint, &world);
            // The root has no rest rotation of its own where the whole body lies another way.
            let rest = if parent.is_none() { self.whole_body } else { Quat::IDENTITY };
            let computed = || turned.map_or(rest, |turned| quat::renormalize(above.conjugate() * turned));
            let local = self.local_copy(joint, parent, pose).unwrap_or_else(computed);
            rotations.push(local);
            worlds.push(quat::renormalize(above * local));
        }
        let standing = Pose {
            root_translation: Vec3::ZERO,
            rotations,
            translations: Vec::new(),
        };
        let hips = world_pose(&self.target, &standing).positions[self.hips.1];
        Pose {
            root_translation: world.positions[self.hips.0] * self.scale - hips,
            ..standing
        }
    }

    /// The world rotation of a joint that is driven or shares the bend of its neighbours.
    fn world_rotation(&self, joint: usize, source: &WorldPose) -> Option<Quat> {
        if let Some(from) = self.map.source_of(joint) {
            return Some(source.rotations[from] * self.corrections[joint]);
        }
        let (above, below, share) = self.shares[joint]?;
        let (above, below) = (self.map.source_of(above)?, self.map.source_of(below)?);
        Some(quat::slerp(source.rotations[above], source.rotations[below], share) * self.whole_body)
    }

    /// The source's own local rotation, where neither joint nor parent needs a correction.
    fn local_copy(&self, joint: usize, parent: Option<usize>, pose: &Pose) -> Option<Quat> {
        let from = self.map.source_of(joint)?;
        let plain = |joint: usize| self.corrections[joint] == Quat::IDENTITY;
        let same_parent = match parent {
            None => from == 0,
            Some(parent) => self.map.source_of(parent).is_some() && self.map.source_of(parent) == self.source.parent(from) && plain(parent),
        };
        if same_parent && plain(joint) {
            pose.rotations.get(from).copied()
        } else {
            None
        }
    }

    /// The pose of the same rig with its joints in another order.
    fn copied(&self, pose: &Pose) -> Pose {
        let rotation = |joint| {
            self.map
                .source_of(joint)
                .and_then(|from| pose.rotations.get(from).copied())
                .unwrap_or(Quat::IDENTITY)
        };
        let joints = 0..self.target.len();
        let translation = |joint: usize| {
            let from = self.map.source_of(joint)?;
            let at = pose.translations.iter().find(|(moved, _)| *moved == from)?;
            Some((joint, at.1))
        };
        Pose {
            root_translation: pose.root_translation,
            rotations: joints.clone().map(rotation).collect(),
            translations: joints.skip(1).filter_map(translation).collect(),
        }
    }
}

/// What is known about how a joint's frame lies at rest.
enum Bone {
    /// Bones that correspond, not of unit length.
    Direction { target: Vec3, source: Vec3 },
    /// Hips or chest: they lie as the body does.
    Trunk,
    /// Nothing.
    None,
}

/// The turn from the direction `from` to `to`. Where they are opposite there are many; this one is about `left`, as legs and spines bend.
fn turn_about(from: Vec3, to: Vec3, left: Vec3) -> Quat {
    let turn = quat::between_directions(from, to);
    let opposite = quat::log(turn).length() > std::f32::consts::PI - SAME_DIRECTION_RADIANS;
    if opposite && from.try_normalize().is_some_and(|from| from.dot(left).abs() < 0.5) {
        let half_turn = Quat::from_axis_angle(left, std::f32::consts::PI);
        return quat::between_directions(half_turn * from, to) * half_turn;
    }
    turn
}

/// The turn about `up` from the heading of `from` to that of `to`; none below 2°.
fn heading_turn(from: Vec3, to: Vec3, up: Vec3) -> Quat {
    let level = |v: Vec3| v - up * up.dot(v);
    let turn = quat::between_directions(level(from), level(to));
    if quat::log(turn).length() < SAME_DIRECTION_RADIANS { Quat::IDENTITY } else { turn }
}

/// How a body lies at rest.
struct BodyAxes {
    /// From right to left, unit length.
    left: Vec3,
    /// Takes +X to the left and +Y along the back upwards.
    rotation: Quat,
}

impl BodyAxes {
    /// Axes from hips or shoulders and the back; those of the world where roles are missing. An axis within 15° of a world axis is that axis.
    fn at_rest(skeleton: &Skeleton, roles: &Roles) -> Self {
        let rest = skeleton.rest_positions();
        let at = |role| roles.get(role).and_then(|joint| rest.get(joint).copied());
        let across = |role: fn(Side) -> Role| Some(at(role(Side::Left))? - at(role(Side::Right))?).filter(|v| v.length() > 1e-4);
        let middle = |role: fn(Side) -> Role| Some((at(role(Side::Left))? + at(role(Side::Right))?) * 0.5);
        let low = middle(Role::thigh).or_else(|| at(Role::Hips));
        let high = at(Role::Head).or_else(|| middle(Role::upper_arm)).or_else(|| at(Role::Spine));
        let left = snapped(across(Role::thigh).or_else(|| across(Role::upper_arm)));
        let up = snapped(low.zip(high).map(|(low, high)| high - low));
        let (Some(left), Some(up)) = (left, up) else {
            return Self {
                left: Vec3::X,
                rotation: Quat::IDENTITY,
            };
        };
        let Some(up) = (up - left * left.dot(up)).try_normalize() else {
            return Self {
                left,
                rotation: Quat::IDENTITY,
            };
        };
        let rotation = quat::renormalize(Quat::from_mat3(&Mat3::from_cols(left, up, left.cross(up))));
        Self { left, rotation }
    }
}

/// A unit vector, exactly along an axis of the world where it is within 15° of one.
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

/// Whether the map keeps parents and offsets.
fn is_same_rig(source: &Skeleton, target: &Skeleton, map: &JointMap) -> bool {
    if map.source_of(0) != Some(0) {
        return false;
    }
    target
        .joints()
        .iter()
        .enumerate()
        .skip(1)
        .all(|(joint, ours)| match map.source_of(joint) {
            // What nothing drives may hang at the ends only.
            None => !target.children(joint).any(|child| map.source_of(child).is_some()),
            Some(from) => {
                let theirs = &source.joints()[from];
                ours.parent.map(|parent| map.source_of(parent)) == Some(theirs.parent)
                    && ours.offset.distance(theirs.offset) < SAME_OFFSET_M
            }
        })
}

/// The ratio of the legs' lengths, else that of the bodies' heights.
fn scale(source: &Skeleton, source_roles: &Roles, target: &Skeleton, target_roles: &Roles) -> f32 {
    let ratio = match (target_roles.leg_length(target), source_roles.leg_length(source)) {
        (Some(ours), Some(theirs)) => ours / theirs,
        _ => target_roles.body_height(target) / source_roles.body_height(source),
    };
    if ratio.is_finite() && ratio > 0.0 { ratio } else { 1.0 }
}

/// For the joints between hips and head that nothing drives: between which driven joints they lie, and how far along.
fn back_shares(target: &Skeleton, roles: &Roles, map: &JointMap) -> Vec<Option<(usize, usize, f32)>> {
    let mut shares = vec![None; target.len()];
    let back = back(target, roles);
    let driven: Vec<usize> = (0..back.len()).filter(|&i| map.source_of(back[i]).is_some()).collect();
    for pair in driven.windows(2) {
        for i in pair[0] + 1..pair[1] {
            shares[back[i]] = Some((back[pair[0]], back[pair[1]], (i - pair[0]) as f32 / (pair[1] - pair[0]) as f32));
        }
    }
    shares
}

/// The joints from the hips up to the head, both included; none where either is unknown or they are not above each other.
fn back(skeleton: &Skeleton, roles: &Roles) -> Vec<usize> {
    let joint = |role| roles.get_within(role, skeleton.len());
    let (Some(hips), Some(head)) = (joint(Role::Hips), joint(Role::Head)) else {
        return Vec::new();
    };
    if !is_below(skeleton, head, hips) {
        return Vec::new();
    }
    let mut back: Vec<usize> = std::iter::successors(Some(head), |&j| skeleton.parent(j))
        .take_while(|&joint| joint != hips)
        .collect();
    back.push(hips);
    back.reverse();
    back
}
