//! The nodes of a file as a tree, at rest.

use super::document::Document;
use crate::ImportError;
use glam::{DMat3, DMat4, DQuat, DVec3};
use segue_text::msg;

/// Sizes and distances beyond this lose their meaning in single precision.
const MAX_MAGNITUDE: f64 = 1e18;

/// A node of the file: its place in the tree, and its transform at rest.
pub(super) struct Node {
    pub(super) name: String,
    pub(super) parent: Option<usize>,
    pub(super) children: Vec<usize>,
    pub(super) translation: DVec3,
    pub(super) rotation: DQuat,
    pub(super) scale: DVec3,
    /// Whether it has neither a mesh nor a camera.
    pub(super) is_bare: bool,
    /// The node's transform in the world, with its own scale and those above it.
    pub(super) world: World,
}

/// The transform of a node in the world at rest.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct World {
    pub(super) position: DVec3,
    /// The product of the rotations alone.
    pub(super) rotation: DQuat,
    /// The product of rotations and scales, from the node's axes to the world's.
    pub(super) linear: DMat3,
}

impl World {
    pub(super) const IDENTITY: Self =
        Self { position: DVec3::ZERO, rotation: DQuat::IDENTITY, linear: DMat3::IDENTITY };

    /// Returns the world position of a translation in the node's axes.
    pub(super) fn point(&self, translation: DVec3) -> DVec3 {
        self.position + self.linear * translation
    }
}

/// All nodes, and an order in which each is followed by its descendants.
pub(super) struct Nodes {
    pub(super) all: Vec<Node>,
    pub(super) order: Vec<usize>,
    /// The transform above all nodes: from the file's axes to those in which a humanoid faces +Z.
    pub(super) base: World,
}

impl Nodes {
    pub(super) fn of(document: &Document<'_>) -> Result<Self, ImportError> {
        let mut all: Vec<Node> = document
            .root
            .nodes
            .iter()
            .enumerate()
            .map(|(index, node)| at_rest(index, node))
            .collect();
        for parent in 0..all.len() {
            for index in 0..all[parent].children.len() {
                let child = all[parent].children[index];
                match all.get_mut(child) {
                    Some(node) if node.parent.is_none() => node.parent = Some(parent),
                    Some(node) => {
                        let found =
                            msg!("node {child} (`{name}`) with two parents", name = node.name);
                        return Err(document.error(found, "a tree of nodes"));
                    }
                    None => {
                        return Err(document
                            .error(msg!("node {child}, which is not there"), "a tree of nodes"));
                    }
                }
            }
        }
        let base = match &document.humanoid {
            None => World::IDENTITY,
            Some(humanoid) => {
                let (rotation, linear) = humanoid.turn();
                World { position: DVec3::ZERO, rotation, linear }
            }
        };
        let mut order = Vec::with_capacity(all.len());
        let mut open: Vec<usize> =
            (0..all.len()).rev().filter(|&node| all[node].parent.is_none()).collect();
        while let Some(index) = open.pop() {
            order.push(index);
            open.extend(all[index].children.iter().rev());
            let parent = all[index].parent.map_or(base, |parent| all[parent].world);
            let node = &mut all[index];
            node.world = World {
                position: parent.point(node.translation),
                rotation: (parent.rotation * node.rotation).normalize(),
                linear: parent.linear
                    * DMat3::from_quat(node.rotation)
                    * DMat3::from_diagonal(node.scale),
            };
            let World { position, linear, .. } = node.world;
            if !(position.abs().max_element() < MAX_MAGNITUDE
                && linear.to_cols_array().iter().all(|entry| entry.abs() < MAX_MAGNITUDE))
            {
                let found =
                    msg!("node {index} (`{name}`) too far from the origin", name = node.name);
                return Err(document.error(found, "a scene of some size"));
            }
        }
        if order.len() < all.len() {
            return Err(document.error("nodes that are below themselves", "a tree of nodes"));
        }
        Ok(Self { all, order, base })
    }

    /// Returns the nodes from one up to the root of its tree, itself first.
    pub(super) fn upwards(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(Some(node), |&node| self.all[node].parent)
    }
}

fn at_rest(index: usize, node: &gltf::json::Node) -> Node {
    let vector = |v: Option<[f32; 3]>, default: DVec3| {
        v.map_or(default, |v| DVec3::from_array(v.map(f64::from)))
    };
    let mut translation = vector(node.translation, DVec3::ZERO);
    let mut rotation =
        node.rotation.map_or(DQuat::IDENTITY, |q| DQuat::from_array(q.0.map(f64::from)));
    let mut scale = vector(node.scale, DVec3::ONE);
    if let Some(matrix) = node.matrix {
        (scale, rotation, translation) =
            DMat4::from_cols_array(&matrix.map(f64::from)).to_scale_rotation_translation();
    }
    let length = rotation.length();
    Node {
        name: match &node.name {
            Some(name) if !name.is_empty() => name.clone(),
            _ => format!("node {index}"),
        },
        parent: None,
        children: node.children.iter().flatten().map(gltf::json::Index::value).collect(),
        translation: if translation.is_finite() { translation } else { DVec3::ZERO },
        // A matrix without volume has no rotation.
        rotation: if length.is_finite() && length > 1e-6 {
            rotation * length.recip()
        } else {
            DQuat::IDENTITY
        },
        scale: if scale.is_finite() { scale } else { DVec3::ONE },
        is_bare: node.mesh.is_none() && node.camera.is_none(),
        world: World::IDENTITY,
    }
}
