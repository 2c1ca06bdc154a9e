//! Bone maps: the joint of each body part in all clips of a rig, as corrected by hand.
//!
//! A rig is a set of joint names with their parents: clips whose files list the same joints in
//! another order, or in other lengths, are of one rig. A correction of one clip holds for all of
//! them, also for those that are opened later. A map is stored with the work, and saved and read as
//! a file of its own ([`json`](BoneMap::to_json)). Links hold the corrections of the clips that
//! they name, if these are few.

mod json;
mod link;

pub(crate) use json::is_bone_map;
pub use json::{BoneMapError, MAX_BONE_MAP_BYTES, role_of_word, word_of_role};
pub(crate) use link::{BONES, MAX_LINKED_RIGS, linked_maps};

use crate::hex;
use segue_motion::clip::Motion;
use segue_motion::skeleton::{Mirror, Role, Roles, Skeleton};
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use std::collections::BTreeMap;

/// The most rigs that are remembered.
pub(crate) const MAX_RIGS: usize = 256;

/// The number of hexadecimal digits of a rig's name.
const RIG_DIGITS: usize = 16;

/// The joints of body parts, by name.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct BoneMap {
    /// The rig ([`rig_of`]); empty for any rig that has these joints.
    pub rig: String,
    /// The name of each part's joint ([`name_of`]); `None` for a part that has no joint. A part
    /// that is not named is as it was found.
    pub roles: BTreeMap<Role, Option<String>>,
}

/// The maps of all rigs that were corrected, by [`rig_of`].
pub(crate) type BoneMaps = BTreeMap<String, BoneMap>;

impl BoneMap {
    /// Returns the map of the present roles of a skeleton, with every part.
    #[must_use]
    pub fn of(skeleton: &Skeleton, roles: &Roles) -> Self {
        let name = |role| {
            let joint = roles.get_within(role, skeleton.len())?;
            Some(name_of(skeleton, joint))
        };
        Self {
            rig: rig_of(skeleton),
            roles: Role::ALL.into_iter().map(|role| (role, name(role))).collect(),
        }
    }

    /// Returns the roles of a skeleton by this map: `found` with the parts of the map, which are
    /// set by hand where they differ. `None` if the skeleton lacks one of the joints.
    #[must_use]
    pub fn roles_for(&self, skeleton: &Skeleton, found: &Roles) -> Option<Roles> {
        let mut changes = Vec::new();
        for (&role, name) in &self.roles {
            let joint = match name {
                Some(name) => Some(joint_named(skeleton, name)?),
                None => None,
            };
            changes.push((role, joint));
        }
        Some(with_changes(found, &changes))
    }
}

/// Returns roles with some of them set by hand; those that are so already keep their source.
pub(crate) fn with_changes(roles: &Roles, changes: &[(Role, Option<usize>)]) -> Roles {
    let mut changed = roles.clone();
    let differing = || changes.iter().filter(|&&(role, joint)| roles.get(role) != joint);
    // First they are freed, so that two parts can exchange their joints.
    for &(role, _) in differing() {
        changed.set(role, None);
    }
    for &(role, joint) in differing() {
        changed.set(role, joint);
    }
    changed
}

/// Returns the name of a skeleton's rig: hexadecimal digits that depend on the names of its joints
/// and of their parents, and on nothing else.
#[must_use]
pub fn rig_of(skeleton: &Skeleton) -> String {
    let joints = skeleton.joints();
    let mut rows: Vec<(&str, &str)> = joints
        .iter()
        .map(|joint| {
            let parent = joint.parent.and_then(|parent| joints.get(parent));
            (joint.name.as_str(), parent.map_or("", |parent| parent.name.as_str()))
        })
        .collect();
    rows.sort_unstable();
    let mut digest = Sha256::new();
    for (name, parent) in rows {
        // The lengths keep names apart, whatever they contain.
        digest.update((name.len() as u64).to_le_bytes());
        digest.update(name);
        digest.update((parent.len() as u64).to_le_bytes());
        digest.update(parent);
    }
    digest.finalize().get(..RIG_DIGITS / 2).map(hex).unwrap_or_default()
}

/// Returns the name of a joint that [`joint_named`] finds again in any skeleton of the rig: its own
/// name, with as many names before it, `Arm/Hand`, as tell it from others. Of joints that no path
/// tells apart, the first is found.
#[must_use]
pub fn name_of(skeleton: &Skeleton, joint: usize) -> String {
    let mut path = String::new();
    let mut at = Some(joint);
    while let Some(own) = at.and_then(|joint| skeleton.joints().get(joint)) {
        path = if path.is_empty() { own.name.clone() } else { format!("{}/{path}", own.name) };
        if joint_named(skeleton, &path) == Some(joint) || path.len() > MAX_NAME_BYTES {
            break;
        }
        at = own.parent;
    }
    path
}

/// The longest path of names, bytes: a chain of many joints with one name has no shorter one.
const MAX_NAME_BYTES: usize = 1024;

/// Returns the joint of that name, or at the end of that path of names ([`name_of`]).
#[must_use]
pub fn joint_named(skeleton: &Skeleton, path: &str) -> Option<usize> {
    let ends_so = |joint: usize| {
        let (mut rest, mut at) = (path, Some(joint));
        while let Some(own) = at.and_then(|joint| skeleton.joints().get(joint)) {
            let Some(above) = rest.strip_suffix(own.name.as_str()) else { return false };
            if above.is_empty() {
                return true;
            }
            let Some(above) = above.strip_suffix('/') else { return false };
            (rest, at) = (above, own.parent);
        }
        false
    };
    (0..skeleton.len()).find(|&joint| ends_so(joint))
}

/// Returns the changes that give a part a joint, and with `both_sides` the part on the other side
/// its counterpart, where the skeleton has one.
#[must_use]
pub fn role_changes(
    motion: &Motion,
    role: Role,
    joint: Option<usize>,
    both_sides: bool,
) -> Vec<(Role, Option<usize>)> {
    let mut changes = vec![(role, joint)];
    let other = role.mirrored();
    if !both_sides || other == role {
        return changes;
    }
    let Some(joint) = joint else {
        changes.push((other, None));
        return changes;
    };
    let skeleton = motion.clip().skeleton();
    // The parts in question say nothing about which joints are counterparts.
    let mut roles = motion.roles().clone();
    for role in [role, other] {
        roles.set(role, None);
    }
    let mirror = Mirror::of(skeleton, &roles).or_else(|_| Mirror::of(skeleton, motion.roles()));
    let counterpart = mirror.ok().and_then(|mirror| mirror.counterpart(joint));
    changes.extend(counterpart.filter(|&own| own != joint).map(|own| (other, Some(own))));
    changes
}

/// Returns the roles of a clip by its rig's map; `None` if there is no map of it, or nothing in it.
pub(crate) fn mapped(maps: &BoneMaps, skeleton: &Skeleton, found: &Roles) -> Option<Roles> {
    if maps.is_empty() {
        return None;
    }
    let map = maps.get(&rig_of(skeleton)).filter(|map| !map.roles.is_empty())?;
    map.roles_for(skeleton, found)
}

#[cfg(test)]
mod tests;
