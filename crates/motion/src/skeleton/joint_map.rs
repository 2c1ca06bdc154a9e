//! The map from the joints of one skeleton to those of another, for retargeting.

use super::ancestry::Ancestry;
use super::{Role, Roles, Side, Skeleton};
use std::collections::HashMap;

/// The joints of a source skeleton that drive the joints of a target: by name and by role, never by
/// index.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JointMap {
    sources: Vec<Option<usize>>,
}

impl JointMap {
    /// Maps joints by role, then by landmark, then by name.
    ///
    /// Joints with a role are mapped to the joint of that role, because one name means different
    /// joints in different rigs (`LeftShoulder` is a collar bone in one and an upper arm in
    /// another). Then the joints at which both arms meet are mapped to each other, and the collar
    /// bones. Every other joint is mapped to the joint of the same name (ignoring name spaces such
    /// as `mixamorig:`), if that lies below the joint that drives its parent.
    #[must_use]
    pub fn between(
        target: &Skeleton,
        target_roles: &Roles,
        source: &Skeleton,
        source_roles: &Roles,
    ) -> Self {
        let mut sources: Vec<Option<usize>> = vec![None; target.len()];
        for role in Role::ALL {
            if let (Some(to), Some(from)) = (
                target_roles.get_within(role, target.len()),
                source_roles.get_within(role, source.len()),
            ) {
                sources[to] = Some(from);
            }
        }
        let (to, from) = (Landmarks::of(target, target_roles), Landmarks::of(source, source_roles));
        for (to, from) in to.pairs(&from) {
            // The chest may be the spine's only joint, and being the parent of the arms matters
            // more.
            if sources[to].is_none() || target_roles.role_of(to) == Some(Role::Spine) {
                sources[to] = Some(from);
            }
        }
        map_by_name(target, source, source_roles, &mut sources);
        Self { sources }
    }

    /// Returns the source's joint that drives a joint of the target.
    #[must_use]
    pub fn source_of(&self, target_joint: usize) -> Option<usize> {
        self.sources.get(target_joint).copied().flatten()
    }

    /// Returns the number of driven joints of the target.
    #[must_use]
    pub fn count(&self) -> usize {
        self.sources.iter().flatten().count()
    }
}

/// Maps every unmapped joint to the first joint of its name that has no role, drives no other
/// joint, and lies below the joint that drives the nearest driven joint above.
fn map_by_name(
    target: &Skeleton,
    source: &Skeleton,
    source_roles: &Roles,
    sources: &mut [Option<usize>],
) {
    let mut by_name: HashMap<&str, Vec<usize>> = HashMap::new();
    let mut taken = vec![false; source.len()];
    for (from, joint) in source.joints().iter().enumerate() {
        by_name.entry(without_name_space(&joint.name)).or_default().push(from);
        taken[from] = source_roles.role_of(from).is_some();
    }
    for &from in sources.iter().flatten() {
        taken[from] = true;
    }
    let ancestry = Ancestry::of(source);
    // The driver of the nearest driven joint at or above each joint; parents come first.
    let mut nearest: Vec<Option<usize>> = Vec::with_capacity(target.len());
    for (joint, ours) in target.joints().iter().enumerate() {
        let above = ours.parent.and_then(|parent| nearest[parent]);
        if sources[joint].is_none() {
            let fits = |from: usize| {
                !taken[from] && above.is_none_or(|above| ancestry.is_below(from, above))
            };
            let found = by_name
                .get(without_name_space(&ours.name))
                .and_then(|named| named.iter().copied().find(|&from| fits(from)));
            if let Some(from) = found {
                taken[from] = true;
                sources[joint] = Some(from);
            }
        }
        nearest.push(sources[joint].or(above));
    }
}

/// Returns the name without its name space.
fn without_name_space(name: &str) -> &str {
    name.rsplit(':').next().unwrap_or(name)
}

/// Joints that follow from roles: the joint at which the arms meet, and the collar bones.
pub(super) struct Landmarks {
    pub(super) chest: Option<usize>,
    pub(super) collars: [Option<usize>; 2],
}

impl Landmarks {
    pub(super) fn of(skeleton: &Skeleton, roles: &Roles) -> Self {
        let above =
            |joint: usize| std::iter::successors(skeleton.parent(joint), |&j| skeleton.parent(j));
        let ancestry = Ancestry::of(skeleton);
        let arms = Side::BOTH.map(|side| roles.get_within(Role::upper_arm(side), skeleton.len()));
        let chest = match arms {
            [Some(left), Some(right)] => above(left).find(|&joint| ancestry.is_below(right, joint)),
            _ => None,
        };
        // If the chest is the hips, there is no back between them.
        let chest = chest.filter(|&chest| roles.role_of(chest) != Some(Role::Hips) && chest > 0);
        let collar = |arm: Option<usize>| {
            above(arm?).take_while(|&joint| Some(joint) != chest).last().filter(|_| chest.is_some())
        };
        Self { chest, collars: arms.map(collar) }
    }

    fn pairs(&self, source: &Self) -> impl Iterator<Item = (usize, usize)> {
        let ours = [self.chest, self.collars[0], self.collars[1]];
        let theirs = [source.chest, source.collars[0], source.collars[1]];
        ours.into_iter().zip(theirs).filter_map(|(to, from)| Some((to?, from?)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::fixtures;

    fn drives(target: &Skeleton, source: &Skeleton, joint: &str) -> Option<String> {
        let map =
            JointMap::between(target, &fixtures::roles(target), source, &fixtures::roles(source));
        map.source_of(target.find(joint)?).map(|from| source.joints()[from].name.clone())
    }

    #[test]
    fn joint_map_between_rigs_maps_every_role_to_itself() {
        let rigs = fixtures::all();
        for (from_rig, source, from_names) in &rigs {
            for (to_rig, target, to_names) in &rigs {
                let map = JointMap::between(
                    target,
                    &fixtures::roles(target),
                    source,
                    &fixtures::roles(source),
                );
                for (to, from) in to_names.iter().zip(from_names) {
                    assert_eq!(
                        map.source_of(target.find(to).unwrap()),
                        source.find(from),
                        "{to_rig} <- {from_rig}: {to}"
                    );
                }
            }
        }
    }

    #[test]
    fn joint_map_with_ambiguous_names_follows_roles() {
        let (cmu, games) = (fixtures::cmu_bvh(), fixtures::games105());
        assert_eq!(drives(&games, &cmu, "lShoulder").as_deref(), Some("LeftArm"));
        assert_eq!(drives(&games, &cmu, "lTorso_Clavicle").as_deref(), Some("LeftShoulder"));
        assert_eq!(drives(&games, &cmu, "lowerback_torso").as_deref(), Some("Spine1"));
        // `Spine1` is the chest of one rig and the middle of the back of the other.
        let lafan = fixtures::lafan();
        assert_eq!(drives(&lafan, &cmu, "Spine2").as_deref(), Some("Spine1"));
        assert_eq!(drives(&lafan, &cmu, "Spine1"), None);
    }

    #[test]
    fn joint_map_of_fingers_is_by_name() {
        let (cmu, mixamo) = (fixtures::cmu_bvh(), fixtures::mixamo());
        assert_eq!(drives(&cmu, &cmu, "LeftThumb").as_deref(), Some("LeftThumb"));
        // Name spaces are ignored.
        assert_eq!(
            drives(&mixamo, &cmu, "mixamorig:LeftHandIndex1").as_deref(),
            Some("LeftHandIndex1")
        );
        assert_eq!(drives(&mixamo, &cmu, "mixamorig:LeftHandThumb1"), None);
        assert_eq!(
            drives(&mixamo, &fixtures::shuffled(&mixamo, 5).0, "mixamorig:RightHandIndex1")
                .as_deref(),
            Some("mixamorig:RightHandIndex1")
        );
    }

    /// Joints that share one name are told apart by their parents.
    #[test]
    fn joint_map_of_equal_names_follows_parents() {
        let mut joints = fixtures::lafan().joints().to_vec();
        for (side, hand) in ["LeftHand", "RightHand"].into_iter().enumerate() {
            let parent = joints.iter().position(|j| j.name == hand);
            joints.push(super::super::Joint {
                name: "finger".into(),
                parent,
                offset: glam::Vec3::X * side as f32,
                end_site: None,
                channels: vec![],
            });
        }
        let source = Skeleton::new(joints).unwrap();
        let (target, order) = fixtures::shuffled(&source, 3);
        let map = JointMap::between(
            &target,
            &fixtures::roles(&target),
            &source,
            &fixtures::roles(&source),
        );
        assert_eq!((0..target.len()).map(|j| map.source_of(j).unwrap()).collect::<Vec<_>>(), order);
    }
}
