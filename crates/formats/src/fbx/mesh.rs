//! The mesh of a character, bound to its rest pose.

use crate::encoding::encoded;
use crate::gltf::characters::Character;
use crate::gltf::node::Nodes;
use crate::gltf::skin::{Binding, Part, WHITE};
use crate::warning::{Tally, WarningKind};
use glam::{DMat3, DMat4, DVec3, Vec3};
use segue_fbx::Mesh;
use segue_motion::skin::SkinnedMesh;

/// Returns the mesh of a character at rest, in the file's unit; `None` if it has none. Parts that
/// cannot be read are left out with a warning.
///
/// As in glTF files, vertices are moved to where the skin puts them at rest, and bound there again.
pub(super) fn mesh(
    meshes: &[Mesh],
    nodes: &Nodes,
    character: &Character,
    tally: &mut Tally,
) -> Option<SkinnedMesh> {
    let mut joint_of = vec![None; nodes.all.len()];
    for (joint, &node) in character.nodes.iter().enumerate() {
        joint_of[node] = u16::try_from(joint).ok();
    }
    let mut whole = SkinnedMesh::default();
    for mesh in meshes {
        let joints: Vec<Option<u16>> = mesh
            .clusters
            .iter()
            .map(|cluster| joint_of.get(cluster.node).copied().flatten())
            .collect();
        if joints.iter().all(Option::is_none) {
            continue;
        }
        let binding = Binding {
            rest: mesh.clusters.iter().map(|cluster| rest(nodes, cluster)).collect(),
            joints,
            is_rigid: false,
        };
        let given = mesh.colors.iter().map(|&[r, g, b, a]| {
            let opacity = if a.is_finite() { a.clamp(0.0, 1.0) } else { 1.0 };
            [encoded(r), encoded(g), encoded(b), opacity]
        });
        let colors = given.chain(std::iter::repeat(WHITE)).take(mesh.positions.len()).collect();
        let mut part = Part {
            positions: mesh.positions.iter().copied().map(Vec3::from_array).collect(),
            normals: mesh.normals.iter().copied().map(Vec3::from_array).collect(),
            triangles: mesh.triangles.clone(),
            colors,
            ..Part::default()
        };
        let influences: Vec<Vec<(usize, f32)>> = mesh
            .influences
            .iter()
            .map(|influences| {
                let has_weight = influences
                    .iter()
                    .filter(|found| found.weight > 0.0 && found.weight.is_finite());
                has_weight.map(|found| (found.cluster as usize, found.weight)).collect()
            })
            .collect();
        match part.rest(&binding, &influences) {
            Ok(()) => part.join(&mut whole),
            Err(why) => {
                tally.add(WarningKind::BrokenMesh { why }, None);
                continue;
            }
        }
        for _ in 0..mesh.textures {
            tally.add(WarningKind::Textures, None);
        }
        if mesh.has_shapes {
            tally.add(WarningKind::MorphTargets, None);
        }
    }
    if whole.triangles.is_empty() {
        return None;
    }
    if whole.colors.iter().all(|color| *color == WHITE) {
        whole.colors = Vec::new();
    }
    whole.bind = character.bind(nodes);
    Some(whole)
}

/// Returns the transform from a mesh to the world at rest by one of its clusters.
fn rest(nodes: &Nodes, cluster: &segue_fbx::Cluster) -> DMat4 {
    let [x, y, z, at] = cluster.node_from_mesh.map(DVec3::from_array);
    let node_from_mesh = DMat4::from_mat3_translation(DMat3::from_cols(x, y, z), at);
    let node = nodes.all.get(cluster.node).map(|node| node.world).unwrap_or_default();
    DMat4::from_mat3_translation(node.linear, node.position) * node_from_mesh
}
