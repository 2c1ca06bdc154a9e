//! Selection of the nodes that are joints of a character.

use super::node::{Nodes, World};
use glam::{DVec3, Quat};
use segue_motion::skeleton::Joint;
use segue_motion::skin::RigidTransform;
use std::collections::BTreeMap;
use std::ops::Range;

/// A character: some nodes of the file as joints, parents first.
pub(crate) struct Character {
    /// The node of each joint.
    pub(crate) nodes: Vec<usize>,
    /// The joints in the file's unit, with axes that have no rotation at rest.
    pub(crate) joints: Vec<Joint>,
    /// The node above the root; it never moves.
    pub(crate) above: World,
    /// The number of nodes whose scale differs by axis: they shear their descendants when they
    /// rotate.
    pub(crate) uneven: usize,
}

impl Character {
    /// Returns, for each joint, the transform from the world at rest to its axes.
    pub(crate) fn bind(&self, nodes: &Nodes) -> Vec<RigidTransform> {
        let place = |node: &usize| nodes.all[*node].world.position.as_vec3();
        let bind = |node| RigidTransform { rotation: Quat::IDENTITY, translation: -place(node) };
        self.nodes.iter().map(bind).collect()
    }
}

/// Returns the characters of a file, in the order of its nodes. Each of `skins` is a set of joints
/// that belong together, and `moves` says which nodes an animation moves or rotates.
///
/// With skins, a character is a tree of skins: skins of which one is below the other, or that share
/// joints. Its joints are those of the skins and the nodes between them, up to the last node above
/// them that moves. The skins of a humanoid are one character, together with the nodes of its bone
/// map (`humanoid`); a humanoid animation has these nodes alone. In other files, each tree of nodes
/// is a character, made of the nodes that move, the nodes between them, and the nodes below them
/// that show nothing.
pub(crate) fn characters(
    nodes: &Nodes,
    skins: &[Vec<usize>],
    humanoid: Option<&[usize]>,
    moves: &[bool],
) -> Vec<Character> {
    let mut search = Search::new(nodes, moves);
    for joints in skins {
        search.add(joints);
    }
    if let Some(humanoid) = humanoid {
        let is_there = |node: &usize| *node < nodes.all.len();
        let mut joints: Vec<usize> = humanoid.iter().copied().filter(is_there).collect();
        joints.extend((0..nodes.all.len()).filter(|&node| search.is_joint[node]));
        search.tops.clear();
        search.add(&joints);
    }
    search.has_joints = !search.tops.is_empty();
    if !search.has_joints {
        let moving: Vec<usize> = nodes.order.iter().copied().filter(|&node| moves[node]).collect();
        search.add(&moving);
    }
    let mut tops = std::mem::take(&mut search.tops);
    tops.sort_by_key(|&top| search.below[top].start);
    // Nodes below another character belong to that character.
    let mut end = 0;
    tops.retain(|&top| {
        let is_first = search.below[top].start >= end;
        end = end.max(search.below[top].end);
        is_first
    });
    tops.into_iter().map(|top| search.character(top)).collect()
}

struct Search<'a> {
    nodes: &'a Nodes,
    moves: &'a [bool],
    /// For every node, its subtree: a range of [`Nodes::order`] that starts with the node itself.
    below: Vec<Range<usize>>,
    /// For every node, the root of its tree.
    roots: Vec<usize>,
    /// Whether a node is a joint of a skin or of a bone map, or moves where the file has neither.
    is_joint: Vec<bool>,
    /// Whether the file has a skin or a bone map.
    has_joints: bool,
    /// The top node of each set of joints.
    tops: Vec<usize>,
    /// The nodes of the character that is being built.
    taken: Vec<bool>,
    /// The joint index of each of these nodes.
    indices: Vec<usize>,
    /// The ends of their bones.
    ends: Vec<Option<DVec3>>,
}

impl<'a> Search<'a> {
    fn new(nodes: &'a Nodes, moves: &'a [bool]) -> Self {
        let count = nodes.all.len();
        let mut below = vec![0..0; count];
        let mut roots: Vec<usize> = (0..count).collect();
        for (place, &node) in nodes.order.iter().enumerate() {
            below[node] = place..place + 1;
            if let Some(parent) = nodes.all[node].parent {
                roots[node] = roots[parent];
            }
        }
        for &node in nodes.order.iter().rev() {
            if let Some(parent) = nodes.all[node].parent {
                below[parent].end = below[parent].end.max(below[node].end);
            }
        }
        Self {
            nodes,
            moves,
            below,
            roots,
            is_joint: vec![false; count],
            has_joints: false,
            tops: Vec::new(),
            taken: vec![false; count],
            indices: vec![0; count],
            ends: vec![None; count],
        }
    }

    /// Adds a set of joints that belong together, as far as they are in one tree: their top is the
    /// lowest node that is each of them or above it.
    fn add(&mut self, joints: &[usize]) {
        let mut tops: BTreeMap<usize, usize> = BTreeMap::new();
        for &joint in joints {
            self.is_joint[joint] = true;
            let top = tops.entry(self.roots[joint]).or_insert(joint);
            let place = self.below[joint].start;
            while let (false, Some(parent)) =
                (self.below[*top].contains(&place), self.nodes.all[*top].parent)
            {
                *top = parent;
            }
        }
        self.tops.extend(tops.into_values());
    }

    fn character(&mut self, top: usize) -> Character {
        let nodes = self.nodes;
        let start = self.below[top].start;
        self.taken[top] = true;
        for &node in &nodes.order[self.below[top].clone()] {
            let this = &nodes.all[node];
            let hangs_on = !self.has_joints
                && this.is_bare
                && this.parent.is_some_and(|parent| self.taken[parent]);
            if self.is_joint[node] || hangs_on || (self.moves[node] && this.is_bare) {
                let path = nodes.upwards(node).take_while(|&node| self.below[node].start > start);
                for node in path {
                    if std::mem::replace(&mut self.taken[node], true) {
                        break;
                    }
                }
            }
        }
        let root = nodes.upwards(top).filter(|&node| self.moves[node]).last().unwrap_or(top);
        for node in nodes.upwards(top) {
            self.taken[node] = true;
            if node == root {
                break;
            }
        }
        let below = &nodes.order[self.below[root].clone()];
        for &node in below {
            self.take_as_end(node);
        }
        let above = nodes.all[root].parent.map_or(nodes.base, |parent| nodes.all[parent].world);
        let joint_nodes: Vec<usize> =
            below.iter().copied().filter(|&node| self.taken[node]).collect();
        let joints = joint_nodes
            .iter()
            .enumerate()
            .map(|(index, &node)| self.joint(index, node, root))
            .collect();
        let uneven = |node: &&usize| {
            is_uneven(nodes.all[**node].scale) && !nodes.all[**node].children.is_empty()
        };
        let uneven = joint_nodes.iter().filter(uneven).count();
        for &node in below {
            self.taken[node] = false;
            self.ends[node] = None;
        }
        Character { nodes: joint_nodes, joints, above, uneven }
    }

    /// Takes a leaf that only marks the end of its parent's bone as an end site instead of a joint.
    fn take_as_end(&mut self, node: usize) {
        let leaf = &self.nodes.all[node];
        let Some(parent) = leaf.parent.filter(|&parent| self.taken[parent]) else {
            return;
        };
        let (above, is_joint) = (&self.nodes.all[parent], self.is_joint[node] || self.moves[node]);
        let says_so = above.children.len() == 1
            || leaf.name.strip_prefix(above.name.as_str()) == Some("_end");
        if !is_joint && leaf.is_bare && leaf.children.is_empty() && says_so {
            self.taken[node] = false;
            self.ends[parent] = self.ends[parent].or(Some(leaf.world.position));
        }
    }

    fn joint(&mut self, index: usize, node: usize, root: usize) -> Joint {
        self.indices[node] = index;
        let this = &self.nodes.all[node];
        let position = this.world.position;
        let parent = this.parent.filter(|_| node != root);
        let offset =
            position - parent.map_or(DVec3::ZERO, |parent| self.nodes.all[parent].world.position);
        Joint {
            name: this.name.clone(),
            parent: parent.map(|parent| self.indices[parent]),
            offset: offset.as_vec3(),
            end_site: self.ends[node].map(|end| (end - position).as_vec3()),
            channels: Vec::new(),
        }
    }
}

fn is_uneven(scale: DVec3) -> bool {
    let size = scale.abs();
    size.max_element() - size.min_element() > 1e-3 * size.max_element()
}
