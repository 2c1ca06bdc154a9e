//! The joint that carries the body, and the joints that a file has above it.

use super::{Joint, Role, Roles, Side, Skeleton};
use glam::{Quat, Vec3};

/// A child holds the body when at least this share of the length of all bones below its parent is
/// below it.
const BODY_SHARE: f32 = 0.9;

/// Returns the joint at which legs and trunk meet: it carries the body through the world.
///
/// With both hip joints known, that is their lowest common ancestor together with spine, arms and
/// head, as far as the rig has these. Without legs it is the first joint from the root at which the
/// body branches: as long as one child holds nine tenths of the length of all bones below a joint,
/// and branches itself, the search goes on at that child. The result depends on names and bone
/// lengths alone, so that it is the same for all clips of a rig.
#[must_use]
pub fn carrier(skeleton: &Skeleton, roles: &Roles) -> usize {
    let joint = |role| roles.get_within(role, skeleton.len());
    let thighs: Vec<usize> =
        Side::BOTH.into_iter().filter_map(|side| joint(Role::thigh(side))).collect();
    if thighs.len() < 2 {
        return first_branching(skeleton);
    }
    let arms = Side::BOTH.map(Role::upper_arm);
    let trunk = [Role::Spine, Role::Head].into_iter().chain(arms).filter_map(joint);
    // Named hips count only if both legs hang from them: thighs may start at a separate joint
    // below.
    let meet = |a, b| lowest_common_ancestor(skeleton, a, b);
    let below_hips =
        joint(Role::Hips).filter(|&hips| thighs.iter().all(|&thigh| meet(hips, thigh) == hips));
    thighs.into_iter().chain(trunk).chain(below_hips).reduce(meet).unwrap_or(0)
}

fn lowest_common_ancestor(skeleton: &Skeleton, mut a: usize, mut b: usize) -> usize {
    // Parents stand before their children: the later of two is never an ancestor of the other.
    while a != b {
        let later = a.max(b);
        let parent = skeleton.parent(later).unwrap_or(0);
        if later == a {
            a = parent;
        } else {
            b = parent;
        }
    }
    a
}

fn first_branching(skeleton: &Skeleton) -> usize {
    let joints = skeleton.joints();
    // The length of all bones below each joint, and whether the tree branches there or below.
    let mut below = vec![0.0_f32; joints.len()];
    let mut children = vec![0_usize; joints.len()];
    let mut branches = vec![false; joints.len()];
    for (index, joint) in joints.iter().enumerate().rev() {
        branches[index] |= children[index] > 1;
        below[index] += joint.end_site.map_or(0.0, Vec3::length);
        if let Some(parent) = joint.parent {
            below[parent] += below[index] + joint.offset.length();
            children[parent] += 1;
            branches[parent] |= branches[index];
        }
    }
    let mut carrier = 0;
    // The bone between the root and a body that hangs from it belongs to neither.
    while let Some(child) = skeleton.children(carrier).find(|&child| {
        let own = joints[child].offset.length();
        branches[child] && below[child] > 0.0 && below[child] >= BODY_SHARE * (below[carrier] - own)
    }) {
        carrier = child;
    }
    carrier
}

/// The joints that a file has above the carrier, and their motion: the data from which an exporter
/// writes them again.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FoldedChain {
    /// From the file's root to the parent of the carrier; each is the parent of the next.
    pub(crate) chain: Vec<ChainJoint>,
    /// Rest translation of the carrier from its parent, in the parent's frame, metres.
    pub(crate) carrier_offset: Vec3,
    /// Other joints of the file that hang from the chain. In the skeleton they hang from the
    /// carrier.
    pub(crate) beside: Vec<ChainChild>,
    /// For each joint of the skeleton, its index in the file.
    pub(crate) file_index: Vec<usize>,
    /// The motion of the chain.
    pub(crate) follows: ChainMotion,
}

/// A joint above the carrier.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct ChainJoint {
    /// The joint as in the file; its `parent` is an index of the file.
    pub(crate) joint: Joint,
    /// Its index in the file.
    pub(crate) file_index: usize,
    /// Its local rotation where it does not move (`parent_from_joint`).
    pub(crate) rotation: Quat,
    /// Its local translation where it does not move, metres.
    pub(crate) translation: Vec3,
}

/// A joint that hangs from a joint above the carrier.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct ChainChild {
    /// Its index in the skeleton.
    pub(crate) joint: usize,
    /// The joint of the chain from which it hangs in the file.
    pub(crate) hangs_on: usize,
    /// Its rest translation from that joint, metres.
    pub(crate) offset: Vec3,
}

/// The motion of the joints above a carrier.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) enum ChainMotion {
    /// They stand still.
    Still,
    /// One of them stays level and moves over the ground below the character, as in game engines.
    OnGround {
        /// Its index in the chain.
        joint: usize,
        /// Its height, metres.
        height: f32,
        /// Its world rotation where its yaw is 0.
        rotation: Quat,
        /// Its position in the character's smoothed ground frame, (x, z) metres.
        shift: [f64; 2],
        /// Its yaw relative to the character's, radians; `None` where it keeps its own.
        yaw: Option<f64>,
    },
    /// One of them moves rigidly with the carrier.
    WithCarrier {
        /// Its index in the chain.
        joint: usize,
        /// Its rotation in the carrier's frame.
        rotation: Quat,
        /// Its translation in the carrier's frame, metres.
        translation: Vec3,
    },
}

impl Skeleton {
    /// Returns whether another skeleton has the same joints, by their names and parents, also above
    /// the one that carries the body: clips of both fit into one file.
    #[must_use]
    pub fn has_joints_of(&self, other: &Self) -> bool {
        fn same(a: &[Joint], b: &[Joint]) -> bool {
            let key = |joint: &Joint| (joint.parent, joint.name.clone());
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| key(a) == key(b))
        }
        same(self.joints(), other.joints())
            && match (self.folded_chain(), other.folded_chain()) {
                (None, None) => true,
                (Some(a), Some(b)) => {
                    let hangs = |above: &FoldedChain| -> Vec<(usize, usize)> {
                        above.beside.iter().map(|child| (child.joint, child.hangs_on)).collect()
                    };
                    a.file_index == b.file_index
                        && hangs(a) == hangs(b)
                        && a.chain.len() == b.chain.len()
                        && a.joints().zip(b.joints()).all(|(a, b)| a.name == b.name)
                }
                _ => false,
            }
    }
}

impl FoldedChain {
    /// Returns the joints of the file, with their names, from its root down to the carrier's
    /// parent.
    pub fn joints(&self) -> impl Iterator<Item = &Joint> {
        self.chain.iter().map(|above| &above.joint)
    }

    /// Returns for each joint of the file the joint of the skeleton that represents it; joints
    /// above the carrier are represented by the carrier.
    #[must_use]
    pub fn from_file(&self) -> Vec<usize> {
        let mut taken = vec![0; self.chain.len() + self.file_index.len()];
        for (joint, &file) in self.file_index.iter().enumerate() {
            if let Some(place) = taken.get_mut(file) {
                *place = joint;
            }
        }
        taken
    }

    /// Returns for each joint of the skeleton its index in the file.
    #[must_use]
    pub fn file_index(&self) -> &[usize] {
        &self.file_index
    }

    /// Returns the same joints with all lengths multiplied by `factor`.
    pub(super) fn scaled(&self, factor: f32) -> Self {
        let mut scaled = self.clone();
        for above in &mut scaled.chain {
            above.joint.offset *= factor;
            above.joint.end_site = above.joint.end_site.map(|end| end * factor);
            above.translation *= factor;
        }
        scaled.carrier_offset *= factor;
        for child in &mut scaled.beside {
            child.offset *= factor;
        }
        match &mut scaled.follows {
            ChainMotion::Still => {}
            ChainMotion::OnGround { height, shift, .. } => {
                *height *= factor;
                *shift = shift.map(|metres| metres * f64::from(factor));
            }
            ChainMotion::WithCarrier { translation, .. } => *translation *= factor,
        }
        scaled
    }

    /// Returns whether the indices are valid for a skeleton of this many joints. Data from outside
    /// may not be.
    #[must_use]
    pub fn fits(&self, joints: usize) -> bool {
        let all = joints + self.chain.len();
        let mut seen = vec![false; all];
        let places =
            self.file_index.iter().copied().chain(self.chain.iter().map(|above| above.file_index));
        let each_once = places
            .filter(|&place| seen.get_mut(place).is_some_and(|seen| !std::mem::replace(seen, true)))
            .count();
        let moved = match self.follows {
            ChainMotion::Still => 0,
            ChainMotion::OnGround { joint, .. } | ChainMotion::WithCarrier { joint, .. } => joint,
        };
        self.file_index.len() == joints
            && each_once == all
            && !self.chain.is_empty()
            && moved < self.chain.len()
            && self
                .beside
                .iter()
                .all(|beside| beside.joint < joints && beside.hangs_on < self.chain.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::fixtures;

    fn tree(parents: &[(Option<usize>, &str, Vec3)]) -> Skeleton {
        let joint = |&(parent, name, offset): &(Option<usize>, &str, Vec3)| Joint {
            name: name.into(),
            parent,
            offset,
            end_site: None,
            channels: vec![],
        };
        Skeleton::new(parents.iter().map(joint).collect()).unwrap()
    }

    #[test]
    fn carrier_of_a_person_is_where_legs_and_trunk_meet() {
        for (rig, skeleton, _) in fixtures::all() {
            let roles = fixtures::roles(&skeleton);
            let found = carrier(&skeleton, &roles);
            let hips = roles.get(Role::Hips).unwrap();
            let is_above = |joint: usize| lowest_common_ancestor(&skeleton, found, joint) == found;
            assert!(is_above(hips) && roles.get(Role::LeftThigh).is_some_and(is_above), "{rig}");
            assert!(
                skeleton.parent(found).is_none() || found == hips,
                "{rig}: joint {found} in place of the hips, {hips}"
            );
        }
        assert_eq!(carrier(&fixtures::bandai(), &fixtures::roles(&fixtures::bandai())), 1);
    }

    #[test]
    fn carrier_without_legs_is_where_the_body_branches() {
        let at = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let spider = tree(&[
            (None, "scene", Vec3::ZERO),
            (Some(0), "mover", at(0.0, 9.0)),
            (Some(1), "body", at(0.0, 0.1)),
            (Some(2), "leg a", at(1.0, 0.0)),
            (Some(2), "leg b", at(-1.0, 0.0)),
            (Some(3), "tip a", at(1.0, -1.0)),
            (Some(4), "tip b", at(-1.0, -1.0)),
        ]);
        assert_eq!(carrier(&spider, &Roles::default()), 2);
        // A chain never branches: its root carries it, however long it is.
        let chain =
            tree(&[(None, "a", Vec3::ZERO), (Some(0), "b", Vec3::Y), (Some(1), "c", Vec3::Y)]);
        assert_eq!(carrier(&chain, &Roles::default()), 0);
        // A body that hangs from its chest is carried by it, whatever the names of the joints
        // below.
        let chest = tree(&[
            (None, "chest", Vec3::ZERO),
            (Some(0), "head", at(0.0, 0.6)),
            (Some(0), "hips", at(0.0, -0.5)),
            (Some(2), "leg a", at(0.5, -0.5)),
            (Some(2), "leg b", at(-0.5, -0.5)),
        ]);
        assert_eq!(carrier(&chest, &Roles::default()), 0);
    }
}
