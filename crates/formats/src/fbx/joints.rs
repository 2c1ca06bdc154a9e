//! The nodes of a file as a tree at rest, and the sets of them that are skeletons.

use super::sample::{Local, local};
use crate::ImportError;
use crate::gltf::node::{Node, Nodes, World};
use crate::warning::{Tally, WarningKind};
use glam::{DMat3, DQuat, DVec3};
use segue_fbx::{Movement, NodeKind, OpenError, Scene, Transform};

/// A skeleton of fewer bones is left out beside one of at least [`WHOLE`] bones.
const SCRAP: usize = 3;
/// The least number of bones of a body.
const WHOLE: usize = 8;

/// Returns the nodes at rest: with their own translations and scales, and the rotations of the bind
/// pose.
pub(super) fn rest_nodes(
    name: &str,
    scene: &Scene<'_>,
    upright: DQuat,
) -> Result<Nodes, ImportError> {
    let nodes = scene.nodes();
    let mut children = vec![Vec::new(); nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        if let Some(siblings) = node.parent.and_then(|parent| children.get_mut(parent)) {
            siblings.push(index);
        }
    }
    // The rotation of each node in the world at rest.
    let mut turned: Vec<DQuat> = Vec::with_capacity(nodes.len());
    let mut all = Vec::with_capacity(nodes.len());
    for (index, (node, children)) in nodes.iter().zip(children).enumerate() {
        let Local { translation, rotation, scale } = local(node.local, node.parent, upright);
        let above = node.parent.and_then(|parent| turned.get(parent).copied()).unwrap_or_default();
        let bind = node.bind.and_then(rotation_of).map(|bind| upright * bind);
        let world = bind.unwrap_or(above * rotation);
        turned.push(world);
        all.push(Node {
            name: match node.name.as_str() {
                "" => format!("node {index}"),
                name => name.to_owned(),
            },
            parent: None,
            children,
            translation,
            rotation: (above.inverse() * world).normalize(),
            scale,
            is_bare: matches!(node.kind, NodeKind::Bone | NodeKind::Empty),
            world: World::IDENTITY,
        });
    }
    Nodes::linked(all, World::IDENTITY)
        .map_err(|(found, expected)| ImportError::whole_file(name, found, expected))
}

/// Returns the rotation of a transform with scale, if it has one.
fn rotation_of(columns: [[f64; 3]; 4]) -> Option<DQuat> {
    let [x, y, z] = [0, 1, 2].map(|axis| DVec3::from_array(columns[axis]));
    let (x, y) = (x.try_normalize()?, y.try_normalize()?);
    let across = x.cross(y).try_normalize()?;
    // A mirrored or flat transform has no rotation.
    (across.dot(z) > 0.0)
        .then(|| DQuat::from_mat3(&DMat3::from_cols(x, across.cross(x), across)).normalize())
}

/// Returns for each node whether it has another transform than at rest in some take.
pub(super) fn moving(scene: &Scene<'_>) -> Result<Vec<bool>, OpenError> {
    let mut poses = scene.poses();
    let mut moves = vec![false; scene.nodes().len()];
    for (take, found) in scene.takes().iter().enumerate() {
        let start = found.span_secs.as_ref().map_or(0.0, |span| span.start);
        for (node, moves) in moves.iter_mut().enumerate() {
            *moves |= match found.movements.get(node) {
                Some(Movement::Moves) => true,
                Some(Movement::Held) => {
                    let own = scene.nodes().get(node).map_or(Transform::IDENTITY, |own| own.local);
                    differs(own, poses.transform(take, node, start)?)
                }
                _ => false,
            };
        }
    }
    Ok(moves)
}

/// Returns whether the transform of a node in a take differs from that outside.
fn differs(own: Transform, held: Transform) -> bool {
    let vector = |v: [f64; 3]| DVec3::from_array(v);
    let size = vector(own.translation).length().max(1.0);
    let turned = DQuat::from_array(own.rotation).dot(DQuat::from_array(held.rotation)).abs();
    vector(own.translation).distance(vector(held.translation)) > 1e-5 * size
        || vector(own.scale).distance(vector(held.scale)) > 1e-5
        || turned < 1.0 - 1e-9
}

/// Returns the sets of nodes that belong together as skeletons: all bones below a topmost bone, and
/// the nodes of each skin.
pub(super) fn skeletons(
    scene: &Scene<'_>,
    skins: &[Vec<usize>],
    moves: &[bool],
    tally: &mut Tally,
) -> Vec<Vec<usize>> {
    let nodes = scene.nodes();
    let mut is_skinned = vec![false; nodes.len()];
    for &node in skins.iter().flatten() {
        if let Some(skinned) = is_skinned.get_mut(node) {
            *skinned = true;
        }
    }
    let mut children = vec![0_usize; nodes.len()];
    for parent in nodes.iter().filter_map(|node| node.parent) {
        children[parent] += 1;
    }
    // The topmost bone above each node; parents come first.
    let mut tops: Vec<Option<usize>> = Vec::with_capacity(nodes.len());
    let mut sets: Vec<Vec<usize>> = vec![Vec::new(); nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        let above = node.parent.and_then(|parent| tops.get(parent).copied().flatten());
        let top = above.or((node.kind == NodeKind::Bone).then_some(index));
        tops.push(top);
        let is_end = names_an_end(&node.name)
            && children[index] == 0
            && !moves.get(index).is_some_and(|moves| *moves)
            && !is_skinned[index]
            && node.parent.is_some_and(|parent| children[parent] == 1);
        if let (Some(top), NodeKind::Bone, false) = (top, node.kind, is_end) {
            sets[top].push(index);
        }
    }
    sets.retain(|set| !set.is_empty());
    let has_body = sets.iter().any(|set| set.len() >= WHOLE);
    sets.retain(|set| {
        let is_scrap = has_body && set.len() < SCRAP && !set.iter().any(|&node| is_skinned[node]);
        if let (true, Some(&first)) = (is_scrap, set.first()) {
            let name = nodes[first].name.clone();
            for _ in 0..set.len() {
                tally.add(WarningKind::LooseBones { name: name.clone() }, None);
            }
        }
        !is_scrap
    });
    sets.extend(skins.iter().filter(|skin| !skin.is_empty()).cloned());
    sets
}

/// Returns whether a bone only marks where its parent ends, as programs name it: `HeadTop_End`,
/// `Bip01 HeadNub`.
fn names_an_end(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    ["end", "nub", "tip"].iter().any(|ending| name.ends_with(ending))
}
