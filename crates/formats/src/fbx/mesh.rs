//! The mesh of a character, bound to its rest pose.

use super::texture::PaintedMesh;
use crate::gltf::characters::Character;
use crate::gltf::node::Nodes;
use crate::gltf::skin::{Binding, Part, WHITE};
use crate::texture::coordinate;
use crate::warning::{Tally, WarningKind};
use glam::{DMat3, DMat4, DVec3, Vec3};
use segue_motion::skin::SkinnedMesh;
use std::mem::take;

/// Returns the mesh of a character at rest, in the file's unit; `None` if it has none. Parts that
/// cannot be read are left out with a warning.
///
/// The meshes are taken if this is the last character of the file.
///
/// As in glTF files, vertices are moved to where the skin puts them at rest, and bound there again.
pub(super) fn mesh(
    meshes: &mut [PaintedMesh],
    is_last: bool,
    nodes: &Nodes,
    character: &Character,
    tally: &mut Tally,
) -> Option<SkinnedMesh> {
    let mut joint_of = vec![None; nodes.all.len()];
    for (joint, &node) in character.nodes.iter().enumerate() {
        joint_of[node] = u16::try_from(joint).ok();
    }
    let mut whole = SkinnedMesh::default();
    for painted in meshes {
        let mesh = &painted.mesh;
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
        // The last one that needs a mesh has it without a copy.
        let mut painted = if is_last { take(painted) } else { painted.clone() };
        let mesh = &mut painted.mesh;
        let mut part = Part {
            positions: take(&mut mesh.positions).into_iter().map(Vec3::from_array).collect(),
            normals: take(&mut mesh.normals).into_iter().map(Vec3::from_array).collect(),
            triangles: take(&mut mesh.triangles),
            joints: Vec::with_capacity(mesh.point_of.len()),
            weights: Vec::with_capacity(mesh.point_of.len()),
            ..Part::default()
        };
        let influences = mesh.point_of.iter().map(|point| {
            let influences = mesh.influences.get(*point as usize).into_iter().flatten();
            let has_weight =
                influences.filter(|found| found.weight > 0.0 && found.weight.is_finite());
            has_weight.map(|found| (found.cluster as usize, found.weight)).collect()
        });
        match part.rest(&binding, influences) {
            Ok(()) => {
                part.textured = painted.textured(&part.triangles);
                if !part.textured.is_empty() {
                    let places = painted.mesh.coordinates.into_iter();
                    part.coordinates = places.map(|place| place.map(coordinate)).collect();
                }
                part.colors = painted.colors;
                part.join(&mut whole);
            }
            Err(why) => {
                tally.add(WarningKind::BrokenMesh { why }, None);
                continue;
            }
        }
        for note in painted.notes {
            tally.add(note, None);
        }
        if painted.mesh.has_shapes {
            tally.add(WarningKind::MorphTargets, None);
        }
    }
    if whole.triangles.is_empty() {
        return None;
    }
    if whole.colors.iter().all(|color| *color == WHITE) {
        whole.colors = Vec::new();
    }
    whole.join_textured_parts();
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
