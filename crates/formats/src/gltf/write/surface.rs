//! The surfaces of a mesh in a GLB file: its primitives and their materials.

use super::MADE_BODY;
use super::file::{File, UNSIGNED_BYTE, UNSIGNED_INT, UNSIGNED_SHORT};
use crate::encoding::linear;
use glam::Vec3;
use segue_motion::skin::{AlphaMode, SkinnedMesh, Texture};
use serde_json::{Value, json};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// The greatest number of materials that colours of vertices become. Beyond it, the vertices keep
/// their colours, which some programs do not show.
const MAX_COLORS: usize = 64;
/// The colour of a body without one, linear.
const CLAY: [f32; 4] = [0.7, 0.7, 0.7, 1.0];

/// A part of a mesh with one material.
pub(super) struct Surface<'a> {
    mesh: Cow<'a, SkinnedMesh>,
    texture: Option<&'a Texture>,
    /// Linear; `None` where each vertex has its own.
    color: Option<[f32; 4]>,
}

/// Splits a mesh into parts of one texture and one colour each, in the order in which they occur. A
/// triangle has the colour of its first corner, unless all vertices of a part keep theirs.
pub(super) fn surfaces(mesh: &SkinnedMesh) -> Vec<Surface<'_>> {
    let mut surfaces = Vec::new();
    let parts = mesh.parts();
    for (range, texture) in parts.iter().cloned() {
        let triangles = &mesh.triangles[range];
        let groups = by_color(mesh, triangles);
        let is_whole = parts.len() == 1 && groups.len() == 1;
        let mesh_of = |triangles: &[[u32; 3]]| {
            if is_whole { Cow::Borrowed(mesh) } else { Cow::Owned(part(mesh, triangles)) }
        };
        // Below a texture, colours shade it, and rarely end at the edges of triangles.
        let is_plain = || {
            let color = |corner: &u32| mesh.colors.get(*corner as usize);
            let corners = triangles.as_flattened();
            corners.windows(2).all(|pair| color(&pair[0]) == color(&pair[1]))
        };
        if groups.len() > MAX_COLORS || texture.is_some() && !is_plain() {
            surfaces.push(Surface { mesh: mesh_of(triangles), texture, color: None });
            continue;
        }
        let plain = if mesh.has_own_colors() { [1.0; 4] } else { CLAY };
        surfaces.extend(groups.into_iter().map(|(color, triangles)| Surface {
            mesh: mesh_of(&triangles),
            texture,
            color: Some(color.map_or(plain, |color| in_linear_light(color.map(f32::from_bits)))),
        }));
    }
    surfaces
}

/// Triangles of one colour, as bits.
type ColorGroup = (Option<[u32; 4]>, Vec<[u32; 3]>);

/// Returns triangles by the colours of their first corners, in the order in which these occur.
fn by_color(mesh: &SkinnedMesh, triangles: &[[u32; 3]]) -> Vec<ColorGroup> {
    let color_of = |triangle: &[u32; 3]| {
        mesh.colors.get(triangle[0] as usize).map(|color| color.map(f32::to_bits))
    };
    let mut places = BTreeMap::new();
    let mut groups: Vec<ColorGroup> = Vec::new();
    for triangle in triangles {
        let color = color_of(triangle);
        let place = *places.entry(color).or_insert(groups.len());
        if place == groups.len() {
            groups.push((color, Vec::new()));
        }
        groups[place].1.push(*triangle);
    }
    groups
}

/// Converts an `sRGB`-encoded colour, whose alpha stays as it is.
fn in_linear_light([r, g, b, a]: [f32; 4]) -> [f32; 4] {
    [linear(r), linear(g), linear(b), a]
}

/// Returns a mesh of some triangles, with their vertices in order.
fn part(mesh: &SkinnedMesh, triangles: &[[u32; 3]]) -> SkinnedMesh {
    let mut vertices: Vec<u32> = triangles.as_flattened().to_vec();
    vertices.sort_unstable();
    vertices.dedup();
    let index = |vertex: u32| vertices.partition_point(|known| *known < vertex) as u32;
    SkinnedMesh {
        triangles: triangles.iter().map(|triangle| triangle.map(index)).collect(),
        positions: picked(&mesh.positions, &vertices),
        normals: picked(&mesh.normals, &vertices),
        joints: picked(&mesh.joints, &vertices),
        weights: picked(&mesh.weights, &vertices),
        colors: picked(&mesh.colors, &vertices),
        coordinates: picked(&mesh.coordinates, &vertices),
        ..SkinnedMesh::default()
    }
}

fn picked<T: Copy + Default>(values: &[T], vertices: &[u32]) -> Vec<T> {
    if values.is_empty() {
        return Vec::new();
    }
    let value = |&vertex: &u32| values.get(vertex as usize).copied().unwrap_or_default();
    vertices.iter().map(value).collect()
}

/// Returns a material: clay for a generated body; for a character, whose surfaces may be open, the
/// colour on both sides.
pub(super) fn material(file: &mut File, surface: &Surface<'_>, name: &str, index: usize) -> Value {
    let mut base = json!({
        "baseColorFactor": surface.color.unwrap_or([1.0; 4]), "metallicFactor": 0.0,
        "roughnessFactor": 0.8
    });
    if name == MADE_BODY {
        return json!({ "name": "Clay", "pbrMetallicRoughness": base });
    }
    if let Some(texture) = surface.texture {
        base["baseColorTexture"] = json!({ "index": file.texture(texture) });
    }
    let mut material = json!({
        "name": format!("{name} {}", index + 1), "pbrMetallicRoughness": base, "doubleSided": true
    });
    match surface.texture.map(|texture| texture.alpha) {
        None | Some(AlphaMode::Opaque) => {}
        Some(AlphaMode::Mask(cutoff)) => {
            material["alphaMode"] = json!("MASK");
            material["alphaCutoff"] = json!(cutoff);
        }
        Some(AlphaMode::Blend) => material["alphaMode"] = json!("BLEND"),
    }
    material
}

pub(super) fn primitive(
    file: &mut File,
    surface: &Surface<'_>,
    joints: usize,
    material: usize,
) -> Value {
    let mesh = &*surface.mesh;
    let vectors = |vectors: &[Vec3]| vectors.iter().flat_map(Vec3::to_array).collect::<Vec<f32>>();
    let low = mesh.positions.iter().copied().reduce(Vec3::min).unwrap_or_default();
    let high = mesh.positions.iter().copied().reduce(Vec3::max).unwrap_or_default();
    let position =
        file.floats(&vectors(&mesh.positions), "VEC3", Some((&low.to_array(), &high.to_array())));
    let normal = file.floats(&vectors(&mesh.normals), "VEC3", None);
    let count = mesh.positions.len();
    let weights: Vec<[u8; 4]> = mesh.weights.iter().map(bytes_of).collect();
    // Joints without weight must be joint 0 in the format.
    let followed = mesh.joints.iter().zip(&weights).flat_map(|(joints, weights)| {
        let pairs = joints.iter().zip(weights);
        pairs.map(|(&joint, &weight)| if weight > 0 { joint } else { 0 })
    });
    let (component, followed): (u32, Vec<u8>) = if joints <= 1 << 8 {
        (UNSIGNED_BYTE, followed.map(|joint| joint as u8).collect())
    } else {
        (UNSIGNED_SHORT, followed.flat_map(u16::to_le_bytes).collect())
    };
    let followed = file
        .accessor(&followed, json!({ "componentType": component, "count": count, "type": "VEC4" }));
    let weights = file.accessor(
        weights.as_flattened(),
        json!({
            "componentType": UNSIGNED_BYTE, "normalized": true, "count": count, "type": "VEC4"
        }),
    );
    let mut attributes = json!({
        "POSITION": position, "NORMAL": normal, "JOINTS_0": followed, "WEIGHTS_0": weights
    });
    let mut vertex_views = vec![position, normal, followed, weights];
    if surface.texture.is_some() {
        let mut coordinates = mesh.coordinates.clone();
        coordinates.resize(count, [0.0; 2]);
        let coordinates = file.floats(coordinates.as_flattened(), "VEC2", None);
        attributes["TEXCOORD_0"] = json!(coordinates);
        vertex_views.push(coordinates);
    }
    if surface.color.is_none() {
        let mut colors: Vec<[f32; 4]> =
            mesh.colors.iter().map(|color| in_linear_light(*color)).collect();
        colors.resize(count, [1.0; 4]);
        let colors = file.floats(colors.as_flattened(), "VEC4", None);
        attributes["COLOR_0"] = json!(colors);
        vertex_views.push(colors);
    }
    let corners = mesh.triangles.as_flattened();
    let (component, indices): (u32, Vec<u8>) = if u16::try_from(count).is_ok() {
        (UNSIGNED_SHORT, corners.iter().flat_map(|&corner| (corner as u16).to_le_bytes()).collect())
    } else {
        (UNSIGNED_INT, corners.iter().flat_map(|corner| corner.to_le_bytes()).collect())
    };
    let indices = file.accessor(
        &indices,
        json!({ "componentType": component, "count": corners.len(), "type": "SCALAR" }),
    );
    for accessor in vertex_views {
        // ARRAY_BUFFER: vertices.
        file.views[accessor]["target"] = json!(34962);
    }
    // ELEMENT_ARRAY_BUFFER.
    file.views[indices]["target"] = json!(34963);
    json!({ "attributes": attributes, "indices": indices, "material": material })
}

/// Quantises weights to bytes whose sum is exactly 255.
fn bytes_of(weights: &[f32; 4]) -> [u8; 4] {
    let mut bytes = weights.map(|weight| (weight * 255.0).round() as u8);
    let [first, rest @ ..] = &mut bytes;
    *first = rest.iter().fold(255, |left, byte| left.saturating_sub(*byte));
    bytes
}
