//! The nodes of a file as a tree, at rest.

use super::document::Document;
use crate::ImportError;
use glam::{DMat3, DMat4, DQuat, DVec3};
use segue_text::{Message, msg};

/// Sizes and distances beyond this lose their meaning in single precision.
const MAX_MAGNITUDE: f64 = 1e18;

/// A node of the file: its place in the tree, and its transform at rest.
pub(crate) struct Node {
    pub(crate) name: String,
    pub(crate) parent: Option<usize>,
    pub(crate) children: Vec<usize>,
    pub(crate) translation: DVec3,
    pub(crate) rotation: DQuat,
    pub(crate) scale: DVec3,
    /// Whether it has neither a mesh nor a camera.
    pub(crate) is_bare: bool,
    /// The node's transform in the world, with its own scale and those above it.
    pub(crate) world: World,
}

/// The transform of a node in the world at rest.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct World {
    pub(crate) position: DVec3,
    /// The product of the rotations alone.
    pub(crate) rotation: DQuat,
    /// The product of rotations and scales, from the node's axes to the world's.
    pub(crate) linear: DMat3,
}

impl World {
    pub(crate) const IDENTITY: Self =
        Self { position: DVec3::ZERO, rotation: DQuat::IDENTITY, linear: DMat3::IDENTITY };

    /// Returns the transform of a node below this one.
    pub(crate) fn then(&self, translation: DVec3, rotation: DQuat, scale: DVec3) -> Self {
        Self {
            position: self.point(translation),
            rotation: (self.rotation * rotation).normalize(),
            linear: self.linear * DMat3::from_quat(rotation) * DMat3::from_diagonal(scale),
        }
    }

    /// Returns whether all its numbers have a meaning in single precision.
    pub(crate) fn is_plausible(&self) -> bool {
        self.position.abs().max_element() < MAX_MAGNITUDE
            && self.linear.to_cols_array().iter().all(|entry| entry.abs() < MAX_MAGNITUDE)
    }

    /// Returns the world position of a translation in the node's axes.
    pub(crate) fn point(&self, translation: DVec3) -> DVec3 {
        self.position + self.linear * translation
    }
}

/// All nodes, and an order in which each is followed by its descendants.
pub(crate) struct Nodes {
    pub(crate) all: Vec<Node>,
    pub(crate) order: Vec<usize>,
    /// The transform above all nodes: from the file's axes to those in which a humanoid faces +Z.
    pub(crate) base: World,
}

impl Nodes {
    pub(super) fn of(document: &Document<'_>) -> Result<Self, ImportError> {
        let all = document.root.nodes.iter().enumerate().map(|(index, node)| at_rest(index, node));
        let base = document.humanoid.as_ref().map_or(World::IDENTITY, |humanoid| {
            let (rotation, linear) = humanoid.turn();
            World { position: DVec3::ZERO, rotation, linear }
        });
        Self::linked(all.collect(), base)
            .map_err(|(found, expected)| document.error(found, expected))
    }

    /// Links nodes, whose children are given, to trees, and places them in the world, below `base`.
    /// The error is the fault that was found, and what was expected.
    pub(crate) fn linked(mut all: Vec<Node>, base: World) -> Result<Self, (Message, &'static str)> {
        const TREE: &str = "a tree of nodes";
        for parent in 0..all.len() {
            for index in 0..all[parent].children.len() {
                let child = all[parent].children[index];
                match all.get_mut(child) {
                    Some(node) if node.parent.is_none() => node.parent = Some(parent),
                    Some(node) => {
                        let found =
                            msg!("node {child} (`{name}`) with two parents", name = node.name);
                        return Err((found, TREE));
                    }
                    None => return Err((msg!("node {child}, which is not there"), TREE)),
                }
            }
        }
        let mut order = Vec::with_capacity(all.len());
        let mut open: Vec<usize> =
            (0..all.len()).rev().filter(|&node| all[node].parent.is_none()).collect();
        while let Some(index) = open.pop() {
            order.push(index);
            open.extend(all[index].children.iter().rev());
            let parent = all[index].parent.map_or(base, |parent| all[parent].world);
            let node = &mut all[index];
            node.world = parent.then(node.translation, node.rotation, node.scale);
            if !node.world.is_plausible() {
                let found =
                    msg!("node {index} (`{name}`) too far from the origin", name = node.name);
                return Err((found, "a scene of some size"));
            }
        }
        if order.len() < all.len() {
            return Err((Message::word("nodes that are below themselves"), TREE));
        }
        Ok(Self { all, order, base })
    }

    /// Returns the nodes from one up to the root of its tree, itself first.
    pub(crate) fn upwards(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
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
