//! Morph targets: a mesh keeps the shape that the file's weights give it at rest (section 3.7.2.2
//! of the specification).

use super::accessor::vectors;
use super::document::Document;
use crate::ImportError;
use glam::Vec3;
use gltf::json::accessor::Type;
use gltf::json::mesh::Primitive;

/// Returns the weights of a mesh's morph targets at rest: those of its node, otherwise its own.
/// Targets beyond the end have weight 0.
pub(super) fn weights<'a>(node: &'a gltf::json::Node, mesh: &'a gltf::json::Mesh) -> &'a [f32] {
    node.weights.as_deref().or(mesh.weights.as_deref()).unwrap_or_default()
}

/// Adds the displacements of all targets, each times its weight. Normals that are not one for each
/// vertex are left alone.
pub(super) fn apply(
    document: &Document<'_>,
    primitive: &Primitive,
    weights: &[f32],
    positions: &mut [Vec3],
    normals: &mut [Vec3],
) -> Result<(), ImportError> {
    let targets = primitive.targets.iter().flatten().zip(weights);
    for (target, &weight) in targets.filter(|(_, weight)| **weight != 0.0 && weight.is_finite()) {
        if let Some(moves) = target.positions {
            add(document, positions, &vectors(&document.lengths(moves, Type::Vec3)?), weight)?;
        }
        if let Some(turns) = target.normals.filter(|_| normals.len() == positions.len()) {
            add(document, normals, &vectors(&document.floats(turns, Type::Vec3)?), weight)?;
        }
    }
    Ok(())
}

fn add(
    document: &Document<'_>,
    values: &mut [Vec3],
    differences: &[Vec3],
    weight: f32,
) -> Result<(), ImportError> {
    if values.len() != differences.len() {
        return Err(
            document.error("a morph target that is not one value for each vertex", "one for each")
        );
    }
    for (value, difference) in values.iter_mut().zip(differences) {
        *value += *difference * weight;
    }
    Ok(())
}
