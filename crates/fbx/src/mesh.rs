//! Skinned meshes as vertices, triangles and weights.

use crate::matrix::columns;
use std::collections::HashMap;
use ufbx::{Material, SceneRoot, SkinDeformer};

/// The greatest number of clusters that move one vertex; of more, the heaviest count.
pub const MAX_INFLUENCES: usize = 4;

/// A part of a skin: the vertices that follow one node.
#[derive(Clone, Debug, PartialEq)]
pub struct Cluster {
    /// The node.
    pub node: usize,
    /// The columns of the transform from the mesh's vertices to the node's axes when they were
    /// bound.
    pub node_from_mesh: [[f64; 3]; 4],
}

/// The share of one cluster in the movement of a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Influence {
    /// An index of [`Mesh::clusters`].
    pub cluster: u32,
    /// From 0; the influences of one vertex need not sum to 1.
    pub weight: f32,
}

/// A skinned mesh. A vertex at a hard edge, or between two colours, is there more than once.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// In the file's unit and the mesh's own axes.
    pub positions: Vec<[f32; 3]>,
    /// Unit vectors, one for each position; empty if the file has none.
    pub normals: Vec<[f32; 3]>,
    /// The base colour of each position: red, green, blue, opacity, linear.
    pub colors: Vec<[f32; 4]>,
    /// Of each position, the heaviest first; those without weight are zero.
    pub influences: Vec<[Influence; MAX_INFLUENCES]>,
    /// Three indices of positions, anticlockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// The skin.
    pub clusters: Vec<Cluster>,
    /// The number of its materials with an image.
    pub textures: usize,
    /// Whether it has blend shapes, which are not read.
    pub has_shapes: bool,
}

pub(crate) fn meshes(root: &SceneRoot, max_vertices: usize) -> (Vec<Mesh>, usize) {
    let (mut meshes, mut vertices, mut left_out) = (Vec::new(), 0, 0);
    for mesh in &root.meshes {
        let Some(skin) = mesh.skin_deformers.into_iter().next() else {
            continue;
        };
        if vertices + mesh.num_indices > max_vertices {
            left_out += 1;
            continue;
        }
        let read = Mesh::read(mesh, skin);
        vertices += read.positions.len();
        if !read.triangles.is_empty() && !read.clusters.is_empty() {
            meshes.push(read);
        }
    }
    (meshes, left_out)
}

impl Mesh {
    fn read(mesh: &ufbx::Mesh, skin: &SkinDeformer) -> Self {
        let mut read = Self { has_shapes: !mesh.blend_deformers.is_empty(), ..Self::default() };
        // The clusters without a node are left out, and the indices of the others change.
        let mut places = vec![None; skin.clusters.len()];
        for (cluster, place) in skin.clusters.into_iter().zip(&mut places) {
            let node = cluster.bone_node.as_ref().map(|node| node.element.typed_id as usize);
            if let Some(node) = node.and_then(|node| node.checked_sub(1)) {
                *place = Some(read.clusters.len() as u32);
                let node_from_mesh = columns(&cluster.geometry_to_bone);
                read.clusters.push(Cluster { node, node_from_mesh });
            }
        }
        let materials: Vec<[f32; 4]> = mesh.materials.into_iter().map(color).collect();
        let has_texture = |material: &&Material| {
            material.pbr.base_color.texture.is_some()
                || material.fbx.diffuse_color.texture.is_some()
        };
        read.textures = mesh.materials.into_iter().filter(has_texture).count();
        let has_normals = mesh.vertex_normal.exists;
        let mut vertices = HashMap::new();
        let mut corners = Vec::new();
        for (place, face) in mesh.faces.as_ref().iter().enumerate() {
            if face.num_indices < 3 {
                continue;
            }
            let material = mesh.face_material.as_ref().get(place).copied().unwrap_or_default();
            corners.clear();
            corners.resize(3 * (face.num_indices as usize - 2), 0);
            let triangles = ufbx::triangulate_face(&mut corners, mesh, *face) as usize;
            for triangle in corners.as_chunks::<3>().0.iter().take(triangles) {
                let own = triangle.map(|corner| {
                    let corner = corner as usize;
                    let vertex = mesh.vertex_indices.as_ref().get(corner).copied()?;
                    let position = mesh.vertices.as_ref().get(vertex as usize)?;
                    let normal = if has_normals {
                        let normal = ufbx::get_vertex_vec3(&mesh.vertex_normal, corner);
                        [normal.x as f32, normal.y as f32, normal.z as f32]
                    } else {
                        [0.0; 3]
                    };
                    let key = (vertex, normal.map(f32::to_bits), material);
                    let next = vertices.len() as u32;
                    let index = *vertices.entry(key).or_insert(next);
                    if index == next {
                        read.positions.push([
                            position.x as f32,
                            position.y as f32,
                            position.z as f32,
                        ]);
                        if has_normals {
                            read.normals.push(normal);
                        }
                        let color = materials.get(material as usize).copied();
                        read.colors.push(color.unwrap_or([1.0; 4]));
                        read.influences.push(influences(skin, &places, vertex as usize));
                    }
                    Some(index)
                });
                if let [Some(a), Some(b), Some(c)] = own {
                    read.triangles.push([a, b, c]);
                }
            }
        }
        read
    }
}

/// Returns the heaviest clusters of a vertex.
fn influences(
    skin: &SkinDeformer,
    places: &[Option<u32>],
    vertex: usize,
) -> [Influence; MAX_INFLUENCES] {
    let mut heaviest = [Influence::default(); MAX_INFLUENCES];
    let Some(vertex) = skin.vertices.as_ref().get(vertex) else {
        return heaviest;
    };
    let (first, count) = (vertex.weight_begin as usize, vertex.num_weights as usize);
    let weights = skin.weights.as_ref().get(first..first + count).unwrap_or_default();
    // ufbx sorts them by weight.
    let found = weights.iter().filter_map(|weight| {
        let cluster = (*places.get(weight.cluster_index as usize)?)?;
        Some(Influence { cluster, weight: weight.weight as f32 })
    });
    for (place, influence) in heaviest.iter_mut().zip(found) {
        *place = influence;
    }
    heaviest
}

/// Returns the base colour of a material, linear.
fn color(material: &Material) -> [f32; 4] {
    let (map, factor) = if material.pbr.base_color.has_value {
        (&material.pbr.base_color, &material.pbr.base_factor)
    } else {
        (&material.fbx.diffuse_color, &material.fbx.diffuse_factor)
    };
    if !map.has_value {
        return [1.0; 4];
    }
    let factor = if factor.has_value { factor.value_vec4.x } else { 1.0 };
    let ufbx::Vec4 { x, y, z, .. } = map.value_vec4;
    let opacity = &material.pbr.opacity;
    let alpha = if opacity.has_value { opacity.value_vec4.x } else { 1.0 };
    [x * factor, y * factor, z * factor, alpha].map(|value| value as f32)
}
