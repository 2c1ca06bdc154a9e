//! Skinned meshes as vertices, triangles and weights.

use crate::material::{Coordinates, Material};
use crate::matrix::columns;
use ufbx::{SceneRoot, SkinDeformer};

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

/// A skinned mesh. A vertex at a hard edge, between two materials, or at the seam of a texture is
/// there more than once.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// In the file's unit and the mesh's own axes.
    pub positions: Vec<[f32; 3]>,
    /// Unit vectors, one for each position; empty if the file has none.
    pub normals: Vec<[f32; 3]>,
    /// The place of each position in the texture of its material: (0, 0) is the upper left corner
    /// of the image, (1, 1) its lower right one. Empty if no material has a texture.
    pub coordinates: Vec<[f32; 2]>,
    /// The control point of the file that each position is, an index of
    /// [`influences`](Self::influences).
    pub point_of: Vec<u32>,
    /// Of each control point, the heaviest first; those without weight are zero.
    pub influences: Vec<[Influence; MAX_INFLUENCES]>,
    /// Three indices of positions, anticlockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// The skin.
    pub clusters: Vec<Cluster>,
    /// The materials.
    pub materials: Vec<Material>,
    /// The material of each position, an index of [`materials`](Self::materials); without materials
    /// it is 0.
    pub material_of: Vec<u32>,
    /// Whether it has blend shapes, which are not read.
    pub has_shapes: bool,
}

pub(crate) fn meshes(root: &SceneRoot, max_vertices: usize) -> (Vec<Mesh>, usize) {
    let (mut meshes, mut vertices, mut left_out) = (Vec::new(), 0, 0);
    for mesh in &root.meshes {
        let Some(skin) = mesh.skin_deformers.into_iter().next() else {
            continue;
        };
        if vertices + mesh.num_indices.max(mesh.num_vertices) > max_vertices {
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
        let own: Vec<&ufbx::Material> = mesh.materials.into_iter().collect();
        let coordinates: Vec<Option<Coordinates<'_>>> =
            own.iter().map(|material| Coordinates::of(mesh, material)).collect();
        read.materials = own
            .iter()
            .zip(&coordinates)
            .map(|(material, coordinates)| Material::read(material, coordinates.is_some()))
            .collect();
        let has_texture = coordinates.iter().any(Option::is_some);
        let has_normals = mesh.vertex_normal.exists;
        let count = mesh.num_vertices.min(mesh.num_indices);
        read.positions.reserve_exact(count);
        read.normals.reserve_exact(if has_normals { count } else { 0 });
        read.coordinates.reserve_exact(if has_texture { count } else { 0 });
        read.material_of.reserve_exact(count);
        read.point_of.reserve_exact(count);
        read.triangles.reserve_exact(mesh.num_triangles);
        let mut copies = Copies::of(mesh.num_vertices);
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
                    let found = coordinates.get(material as usize).and_then(Option::as_ref);
                    let place = found.map_or([0.0; 2], |coordinates| coordinates.at(corner));
                    if let Some(index) = copies.find(vertex, |index| {
                        read.material_of.get(index) == Some(&material)
                            && (!has_normals || is_same(read.normals.get(index), &normal))
                            && (!has_texture || is_same(read.coordinates.get(index), &place))
                    }) {
                        return Some(index);
                    }
                    read.positions.push([position.x as f32, position.y as f32, position.z as f32]);
                    if has_normals {
                        read.normals.push(normal);
                    }
                    if has_texture {
                        read.coordinates.push(place);
                    }
                    read.material_of.push(material);
                    read.point_of.push(vertex);
                    Some(copies.add(vertex))
                });
                if let [Some(a), Some(b), Some(c)] = own {
                    read.triangles.push([a, b, c]);
                }
            }
        }
        drop(copies);
        read.influences = influences(skin, &places, mesh.num_vertices);
        read
    }
}

/// The vertices that were made of each vertex of the file: a chain for each, because a table of all
/// their values would take more memory than the mesh.
struct Copies {
    /// The last vertex that was made of each vertex of the file.
    last: Vec<u32>,
    /// The one before each vertex that was made.
    before: Vec<u32>,
}

impl Copies {
    /// The end of a chain.
    const NONE: u32 = u32::MAX;
    /// The number of vertices of a chain that are compared; in those of no sensible mesh are more.
    const MAX_COMPARED: usize = 64;

    /// Returns chains for the vertices of a file.
    fn of(vertices: usize) -> Self {
        Self { last: vec![Self::NONE; vertices], before: Vec::with_capacity(vertices) }
    }

    /// Returns a vertex that was made of a vertex of the file, and is the wanted one.
    fn find(&self, vertex: u32, is_wanted: impl Fn(usize) -> bool) -> Option<u32> {
        let last = self.last.get(vertex as usize).copied();
        let before = |own: &u32| self.before.get(*own as usize).copied();
        let mut chain = std::iter::successors(last, before).take_while(|own| *own != Self::NONE);
        chain.by_ref().take(Self::MAX_COMPARED).find(|own| is_wanted(*own as usize))
    }

    /// Adds the next vertex that is made, and returns its number.
    fn add(&mut self, vertex: u32) -> u32 {
        let own = self.before.len() as u32;
        let last = self.last.get_mut(vertex as usize);
        self.before.push(last.map_or(Self::NONE, |last| std::mem::replace(last, own)));
        own
    }
}

/// Returns whether numbers are the same to the last bit.
fn is_same<const N: usize>(one: Option<&[f32; N]>, other: &[f32; N]) -> bool {
    one.is_some_and(|one| one.map(f32::to_bits) == other.map(f32::to_bits))
}

/// Returns the heaviest clusters of each control point. ufbx would list all of them, in 16 bytes
/// for each and 16 more for a point.
fn influences(
    skin: &SkinDeformer,
    places: &[Option<u32>],
    points: usize,
) -> Vec<[Influence; MAX_INFLUENCES]> {
    let mut influences = vec![[Influence::default(); MAX_INFLUENCES]; points];
    for (own, place) in skin.clusters.into_iter().zip(places) {
        let Some(cluster) = *place else { continue };
        for (&point, &weight) in own.vertices.as_ref().iter().zip(own.weights.as_ref()) {
            if let Some(heaviest) = influences.get_mut(point as usize) {
                add(heaviest, Influence { cluster, weight: weight as f32 });
            }
        }
    }
    influences
}

/// Adds an influence behind those that are at least as heavy, and drops the lightest one. Weights
/// that are negative, or no numbers, are not added.
fn add(heaviest: &mut [Influence; MAX_INFLUENCES], found: Influence) {
    let place = heaviest.iter().position(|other| found.weight > other.weight);
    if let Some(lighter) = place.and_then(|place| heaviest.get_mut(place..)) {
        lighter.rotate_right(1);
        if let Some(first) = lighter.first_mut() {
            *first = found;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn influences_are_the_heaviest_in_order() {
        let weights = [0.2, -1.0, 0.1, 0.4, f32::NAN, 0.2, 0.0, 0.3, 0.1, 0.4, f32::INFINITY];
        for count in 0..=weights.len() {
            let all = (0..).zip(weights).take(count);
            let all = all.map(|(cluster, weight)| Influence { cluster, weight });
            let mut found = [Influence::default(); MAX_INFLUENCES];
            all.clone().for_each(|influence| add(&mut found, influence));
            let mut sorted: Vec<Influence> = all.filter(|own| own.weight > 0.0).collect();
            sorted.sort_by(|one, other| other.weight.total_cmp(&one.weight));
            sorted.resize(MAX_INFLUENCES, Influence::default());
            assert_eq!(found, sorted[..], "{count}");
        }
    }
}
