use super::corrections::{BodyAxes, back, corrections};
use super::joint_map::JointMap;
use super::{Pose, Role, Roles, Skeleton, WorldPose, world_pose};
use crate::math::quat;
use glam::{Quat, Vec3};
use std::sync::Arc;

/// Offsets that differ by less are the same, metres.
const SAME_OFFSET_M: f32 = 1e-5;

/// How poses of one skeleton become poses of another.
///
/// A driven joint gets the world rotation of the joint that drives it, times the rotation that
/// takes the target's bone at rest to the source's bone at rest: `world_target = world_source · C`.
/// Where rest directions agree within 2°, C is that of the body as a whole, most often the
/// identity, and what local rotations the files have survives. Joints of the back that nothing
/// drives share the bend between the driven ones around them; other joints that nothing drives keep
/// their rest rotation. A skeleton whose rest pose shows no creature is taken as one that rests in
/// a stance ([`Retargeting::standing`]): bones that correspond by chance would twist the body. The
/// hips' way through the world is scaled by the ratio of the legs' lengths, so that steps keep
/// their proportion and feet do not slide.
#[derive(Clone, Debug)]
pub struct Retargeting {
    source: Arc<Skeleton>,
    target: Arc<Skeleton>,
    map: JointMap,
    corrections: Vec<Quat>,
    whole_body: Quat,
    /// For joints of the back that nothing drives: (driven above, driven below, share of the way
    /// from one to the other).
    shares: Vec<Option<(usize, usize, f32)>>,
    /// Hips of the source and of the target.
    hips: (usize, usize),
    scale: f32,
    same_rig: bool,
    /// The world rotations of the joints in the stances that stand in for rest poses; none where
    /// the rest pose itself counts.
    source_stance: Option<Vec<Quat>>,
    target_stance: Option<Vec<Quat>>,
}

impl Retargeting {
    /// Prepares the way from `source` to `target`; `None` when no joint of the source drives any
    /// joint of the target.
    #[must_use]
    pub fn new(
        source: &Arc<Skeleton>,
        source_roles: &Roles,
        target: &Arc<Skeleton>,
        target_roles: &Roles,
    ) -> Option<Self> {
        Self::standing(source, source_roles, None, target, target_roles, None)
    }

    /// As [`new`](Self::new), with stances ([`canonical_stance`](super::canonical_stance)) in place
    /// of rest poses that show no creature: of the source, and of the target.
    #[must_use]
    pub fn standing(
        source: &Arc<Skeleton>,
        source_roles: &Roles,
        source_stance: Option<&WorldPose>,
        target: &Arc<Skeleton>,
        target_roles: &Roles,
        target_stance: Option<&WorldPose>,
    ) -> Option<Self> {
        let map = JointMap::between(target, target_roles, source, source_roles);
        if map.count() == 0 {
            return None;
        }
        let same_rig = is_same_rig(source, target, &map);
        let stands = |stance: Option<&WorldPose>| {
            stance.filter(|_| !same_rig).map(|stance| stance.rotations.clone())
        };
        let resting = |skeleton: &Arc<Skeleton>, stance: Option<&WorldPose>| match stance
            .filter(|_| !same_rig)
        {
            Some(stance) => Arc::new(skeleton.resting_in(stance)),
            None => Arc::clone(skeleton),
        };
        let (source, target) = (&resting(source, source_stance), &resting(target, target_stance));
        let (source_body, target_body) =
            (BodyAxes::at_rest(source, source_roles), BodyAxes::at_rest(target, target_roles));
        let corrections = if same_rig {
            vec![Quat::IDENTITY; target.len()]
        } else {
            corrections(source, &source_body, target, target_roles, &map)
        };
        let scale = if same_rig { 1.0 } else { scale(source, source_roles, target, target_roles) };
        let hips_of = |skeleton: &Skeleton, roles: &Roles| {
            roles.get_within(Role::Hips, skeleton.len()).unwrap_or(0)
        };
        Some(Self {
            shares: back_shares(target, target_roles, &map),
            hips: (hips_of(source, source_roles), hips_of(target, target_roles)),
            source: Arc::clone(source),
            target: Arc::clone(target),
            map,
            whole_body: source_body.rotation * target_body.rotation.conjugate(),
            corrections,
            scale,
            same_rig,
            source_stance: stands(source_stance),
            target_stance: stands(target_stance),
        })
    }

    /// The joint map.
    #[must_use]
    pub fn map(&self) -> &JointMap {
        &self.map
    }

    /// Whether anything of the source moves a joint of the target: a joint that drives it, or the
    /// bend that it shares with its neighbours.
    #[must_use]
    pub fn moves(&self, target_joint: usize) -> bool {
        self.map.source_of(target_joint).is_some()
            || self.shares.get(target_joint).is_some_and(Option::is_some)
    }

    /// By how much lengths of the source are multiplied on the target.
    #[must_use]
    pub fn scale(&self) -> f32 {
        self.scale
    }

    /// Whether the skeletons differ in nothing but the order of their joints, and in joints that
    /// one of them lacks at its ends.
    #[must_use]
    pub fn is_same_rig(&self) -> bool {
        self.same_rig
    }

    /// The rotation that takes the target's bone at rest, or in its stance, to that of the source
    /// which drives it; the identity for joints that nothing drives.
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
        let against_stance =
            self.source_stance.as_ref().map(|stance| turned_in(&self.source, stance, pose));
        let pose = against_stance.as_ref().unwrap_or(pose);
        let world = world_pose(&self.source, pose);
        let mut worlds: Vec<Quat> = Vec::with_capacity(self.target.len());
        let mut rotations: Vec<Quat> = Vec::with_capacity(self.target.len());
        for (joint, parent) in self.target.joints().iter().map(|j| j.parent).enumerate() {
            let above = parent.map_or(Quat::IDENTITY, |parent| worlds[parent]);
            let turned = self.world_rotation(joint, &world);
            // The root has no rest rotation of its own where the whole body lies another way.
            let rest = if parent.is_none() { self.whole_body } else { Quat::IDENTITY };
            let computed =
                || turned.map_or(rest, |turned| quat::renormalize(above.conjugate() * turned));
            let local = self.local_copy(joint, parent, pose).unwrap_or_else(computed);
            rotations.push(local);
            worlds.push(quat::renormalize(above * local));
        }
        let standing = Pose { root_translation: Vec3::ZERO, rotations, translations: Vec::new() };
        let hips = world_pose(&self.target, &standing).positions[self.hips.1];
        let made =
            Pose { root_translation: world.positions[self.hips.0] * self.scale - hips, ..standing };
        match &self.target_stance {
            Some(stance) => turned_back(&self.target, stance, made),
            None => made,
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
            Some(parent) => {
                self.map.source_of(parent).is_some()
                    && self.map.source_of(parent) == self.source.parent(from)
                    && plain(parent)
            }
        };
        if same_parent && plain(joint) { pose.rotations.get(from).copied() } else { None }
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

/// A pose as one of the skeleton that rests in a stance ([`Skeleton::resting_in`]): every joint at
/// the same place in the world.
fn turned_in(skeleton: &Skeleton, stance: &[Quat], pose: &Pose) -> Pose {
    let of = |joint: Option<usize>| {
        joint.and_then(|joint| stance.get(joint)).copied().unwrap_or(Quat::IDENTITY)
    };
    let local = |(joint, rotation): (usize, &Quat)| {
        quat::renormalize(of(skeleton.parent(joint)) * *rotation * of(Some(joint)).conjugate())
    };
    let moved = |&(joint, value): &(usize, Vec3)| (joint, of(skeleton.parent(joint)) * value);
    Pose {
        root_translation: pose.root_translation,
        rotations: pose.rotations.iter().enumerate().map(local).collect(),
        translations: pose.translations.iter().map(moved).collect(),
    }
}

/// The way back from [`turned_in`], for a pose without translations.
fn turned_back(skeleton: &Skeleton, stance: &[Quat], pose: Pose) -> Pose {
    let of = |joint: Option<usize>| {
        joint.and_then(|joint| stance.get(joint)).copied().unwrap_or(Quat::IDENTITY)
    };
    let local = |(joint, rotation): (usize, &Quat)| {
        quat::renormalize(of(skeleton.parent(joint)).conjugate() * *rotation * of(Some(joint)))
    };
    Pose { rotations: pose.rotations.iter().enumerate().map(local).collect(), ..pose }
}

/// Whether the map keeps parents and offsets.
fn is_same_rig(source: &Skeleton, target: &Skeleton, map: &JointMap) -> bool {
    if map.source_of(0) != Some(0) {
        return false;
    }
    target.joints().iter().enumerate().skip(1).all(|(joint, ours)| match map.source_of(joint) {
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

/// For the joints between hips and head that nothing drives: between which driven joints they lie,
/// and how far along.
fn back_shares(
    target: &Skeleton,
    roles: &Roles,
    map: &JointMap,
) -> Vec<Option<(usize, usize, f32)>> {
    let mut shares = vec![None; target.len()];
    let back = back(target, roles);
    let driven: Vec<usize> =
        (0..back.len()).filter(|&i| map.source_of(back[i]).is_some()).collect();
    for pair in driven.windows(2) {
        for i in pair[0] + 1..pair[1] {
            shares[back[i]] = Some((
                back[pair[0]],
                back[pair[1]],
                (i - pair[0]) as f32 / (pair[1] - pair[0]) as f32,
            ));
        }
    }
    shares
}
