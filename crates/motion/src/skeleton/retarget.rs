//! Retargeting of poses from one skeleton to another.

use super::corrections::{BodyAxes, back, corrections};
use super::joint_map::JointMap;
use super::{Pose, Role, Roles, Skeleton, WorldPose, world_pose};
use crate::math::quat;
use glam::{Quat, Vec3};
use std::sync::Arc;

/// Smaller differences of offsets are ignored, metres.
const SAME_OFFSET_M: f32 = 1e-5;

/// The retargeting of poses from one skeleton to another.
///
/// A driven joint gets the world rotation of its driving joint, times the rotation from the
/// target's bone at rest to the source's bone at rest: `world_target = world_source · C`. Where
/// rest directions agree within 2°, C is that of the body as a whole, most often the identity, and
/// the local rotations of the files are kept. Undriven joints of the back share the bend between
/// the driven ones around them; other undriven joints keep their rest rotation. A skeleton with an
/// implausible rest pose is replaced by one that rests in a stance ([`Retargeting::standing`]):
/// bones in accidental directions would twist the body. The hips' trajectory through the world is
/// scaled by the ratio of the legs' lengths, so that steps keep their proportion and feet do not
/// slide.
#[derive(Clone, Debug)]
pub struct Retargeting {
    source: Arc<Skeleton>,
    target: Arc<Skeleton>,
    map: JointMap,
    corrections: Vec<Quat>,
    whole_body: Quat,
    /// For undriven joints of the back: (driven above, driven below, share of the distance from the
    /// first to the second).
    shares: Vec<Option<(usize, usize, f32)>>,
    /// Hips of the source and of the target.
    hips: (usize, usize),
    scale: f32,
    same_rig: bool,
    /// The world rotations of the joints in the stance that replaces the rest pose; `None` where
    /// the rest pose is used.
    source_stance: Option<Vec<Quat>>,
    target_stance: Option<Vec<Quat>>,
}

impl Retargeting {
    /// Prepares retargeting from `source` to `target`; `None` when no joint of the source drives
    /// any joint of the target.
    #[must_use]
    pub fn new(
        source: &Arc<Skeleton>,
        source_roles: &Roles,
        target: &Arc<Skeleton>,
        target_roles: &Roles,
    ) -> Option<Self> {
        Self::standing(source, source_roles, None, target, target_roles, None)
    }

    /// Prepares retargeting as [`new`](Self::new) does, with stances
    /// ([`canonical_stance`](super::canonical_stance)) in place of implausible rest poses of the
    /// source, and of the target.
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

    /// Returns the joint map.
    #[must_use]
    pub fn map(&self) -> &JointMap {
        &self.map
    }

    /// Returns whether the source moves a joint of the target: by a driving joint, or by the bend
    /// that it shares with its neighbours.
    #[must_use]
    pub fn moves(&self, target_joint: usize) -> bool {
        self.map.source_of(target_joint).is_some()
            || self.shares.get(target_joint).is_some_and(Option::is_some)
    }

    /// Returns the factor from lengths of the source to lengths of the target.
    #[must_use]
    pub fn scale(&self) -> f32 {
        self.scale
    }

    /// Returns whether the skeletons differ only in the order of their joints, and in joints that
    /// one of them lacks at its ends.
    #[must_use]
    pub(crate) fn is_same_rig(&self) -> bool {
        self.same_rig
    }

    /// Returns the rotation from the target's bone at rest, or in its stance, to that of its
    /// driving joint; the identity for undriven joints.
    #[must_use]
    pub fn correction(&self, target_joint: usize) -> Quat {
        self.corrections.get(target_joint).copied().unwrap_or(Quat::IDENTITY)
    }

    /// Retargets a pose of the source to the target.
    #[must_use]
    pub fn pose(&self, pose: &Pose) -> Pose {
        if self.same_rig {
            return self.copied(pose);
        }
        let against_stance =
            self.source_stance.as_ref().map(|stance| into_stance(&self.source, stance, pose));
        let pose = against_stance.as_ref().unwrap_or(pose);
        let world = world_pose(&self.source, pose);
        let mut worlds: Vec<Quat> = Vec::with_capacity(self.target.len());
        let mut rotations: Vec<Quat> = Vec::with_capacity(self.target.len());
        for (joint, parent) in self.target.joints().iter().map(|j| j.parent).enumerate() {
            let above = parent.map_or(Quat::IDENTITY, |parent| worlds[parent]);
            let turned = self.world_rotation(joint, &world);
            // If the axes of the whole body differ, the root has their rotation at rest.
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
            Some(stance) => out_of_stance(&self.target, stance, made),
            None => made,
        }
    }

    /// Returns the world rotation of a joint that is driven or shares the bend of its neighbours.
    fn world_rotation(&self, joint: usize, source: &WorldPose) -> Option<Quat> {
        if let Some(from) = self.map.source_of(joint) {
            return Some(source.rotations[from] * self.corrections[joint]);
        }
        let (above, below, share) = self.shares[joint]?;
        let (above, below) = (self.map.source_of(above)?, self.map.source_of(below)?);
        Some(quat::slerp(source.rotations[above], source.rotations[below], share) * self.whole_body)
    }

    /// Returns the source's own local rotation, where neither joint nor parent needs a correction.
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

    /// Retargets a pose to the same rig with its joints in another order.
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

/// Converts a pose to the skeleton that rests in a stance ([`Skeleton::resting_in`]), with every
/// joint at the same position in the world.
fn into_stance(skeleton: &Skeleton, stance: &[Quat], pose: &Pose) -> Pose {
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

/// Converts a pose without translations back: the inverse of [`into_stance`].
fn out_of_stance(skeleton: &Skeleton, stance: &[Quat], pose: Pose) -> Pose {
    let of = |joint: Option<usize>| {
        joint.and_then(|joint| stance.get(joint)).copied().unwrap_or(Quat::IDENTITY)
    };
    let local = |(joint, rotation): (usize, &Quat)| {
        quat::renormalize(of(skeleton.parent(joint)).conjugate() * *rotation * of(Some(joint)))
    };
    Pose { rotations: pose.rotations.iter().enumerate().map(local).collect(), ..pose }
}

/// Returns whether the map keeps parents and offsets.
fn is_same_rig(source: &Skeleton, target: &Skeleton, map: &JointMap) -> bool {
    if map.source_of(0) != Some(0) {
        return false;
    }
    target.joints().iter().enumerate().skip(1).all(|(joint, ours)| match map.source_of(joint) {
        // Undriven joints are allowed only at the ends.
        None => !target.children(joint).any(|child| map.source_of(child).is_some()),
        Some(from) => {
            let theirs = &source.joints()[from];
            ours.parent.map(|parent| map.source_of(parent)) == Some(theirs.parent)
                && ours.offset.distance(theirs.offset) < SAME_OFFSET_M
        }
    })
}

/// Returns the ratio of the legs' lengths, otherwise that of the bodies' heights.
fn scale(source: &Skeleton, source_roles: &Roles, target: &Skeleton, target_roles: &Roles) -> f32 {
    let ratio = match (target_roles.leg_length(target), source_roles.leg_length(source)) {
        (Some(ours), Some(theirs)) => ours / theirs,
        _ => target_roles.body_height(target) / source_roles.body_height(source),
    };
    if ratio.is_finite() && ratio > 0.0 { ratio } else { 1.0 }
}

/// Returns, for the undriven joints between hips and head, the driven joints between which they
/// lie, and how far along.
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
