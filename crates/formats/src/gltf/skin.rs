//! The mesh of a character: all primitives with a skin on its joints, and the rigid ones that hang
//! from them, bound to the rest pose of the file.

use super::accessor::vectors;
use super::characters::Character;
use super::document::Document;
use super::morph;
use super::node::{Node, Nodes};
use super::texture::{PlacedTexture, colors};
use crate::ImportError;
use crate::texture::Images;
use crate::warning::{Tally, WarningKind};
use glam::{DMat3, DMat4, DVec3, Vec3};
use gltf::json::accessor::Type;
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{Index, Skin};
use segue_motion::skin::{SkinnedMesh, TexturedPart};
use segue_text::{Message, msg};

/// The greatest number of vertices of a character; beyond it the mesh is left out.
pub(crate) const MAX_VERTICES: u64 = 1 << 21;
/// The number of sets of joints and weights that are read; of all their weights the four greatest
/// are used.
const SETS: u32 = 2;

/// Returns the mesh of a character at rest, in the file's unit; `None` if it has none. Parts that
/// cannot be read are left out with a warning.
///
/// The inverse bind matrices may scale, and may describe any pose: vertices are moved to where the
/// skin puts them at rest (section 3.7.3.3 of the specification), and bound there again, so that
/// rigid motions of the joints move them from then on. A mesh without a skin follows the joint that
/// its node is, or hangs from.
pub(super) fn mesh(
    document: &Document<'_>,
    nodes: &Nodes,
    character: &Character,
    images: &mut Images,
    tally: &mut Tally,
) -> Option<SkinnedMesh> {
    let mut joint_of = vec![None; nodes.all.len()];
    for (joint, &node) in character.nodes.iter().enumerate() {
        joint_of[node] = u16::try_from(joint).ok();
    }
    // The joint that each node is, or hangs from; parents come first.
    let mut joint_above = joint_of.clone();
    for &node in &nodes.order {
        let parent = nodes.all[node].parent;
        joint_above[node] = joint_of[node].or_else(|| joint_above[parent?]);
    }
    let mut mesh = SkinnedMesh::default();
    let mut is_colored = false;
    for (index, node) in document.root.nodes.iter().enumerate() {
        let Some(shape) = node.mesh else {
            continue;
        };
        let humanoid = document.humanoid.as_ref();
        if humanoid.is_some_and(|humanoid| humanoid.is_first_person(index, shape.value())) {
            continue;
        }
        let skin = match node.skin {
            Some(skin) => Binding::of_skin(document, nodes, &joint_of, skin),
            None => joint_above[index].map(|joint| Ok(Binding::rigid(joint, &nodes.all[index]))),
        };
        let (Some(shape), Some(skin)) = (document.root.get(shape), skin) else {
            continue;
        };
        let weights = morph::weights(node, shape);
        for primitive in &shape.primitives {
            if is_packed(document, primitive) {
                tally.add(WarningKind::PackedMesh, None);
                continue;
            }
            let before = mesh.positions.len() as u64;
            let read = skin
                .as_ref()
                .map_err(Clone::clone)
                .and_then(|skin| Part::read(document, primitive, weights, skin, before, images));
            match read {
                Ok(Some(part)) => {
                    is_colored |= part.colors.iter().any(|color| *color != WHITE);
                    if part.lacks_texture {
                        tally.add(WarningKind::Textures, None);
                    }
                    part.join(&mut mesh);
                }
                Ok(None) => {}
                Err(error) => tally.add(WarningKind::BrokenMesh { why: error.found }, None),
            }
            if primitive.targets.as_ref().is_some_and(|targets| !targets.is_empty()) {
                tally.add(WarningKind::MorphTargets, None);
            }
        }
    }
    if mesh.triangles.is_empty() {
        return None;
    }
    if !is_colored {
        mesh.colors = Vec::new();
    }
    mesh.join_textured_parts();
    mesh.bind = character.bind(nodes);
    Some(mesh)
}

/// Returns whether the vertices of a primitive are in a form of Draco alone
/// (`KHR_draco_mesh_compression`), which is not read: their accessors have no data.
fn is_packed(document: &Document<'_>, primitive: &Primitive) -> bool {
    let positions = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
    let accessor = positions.and_then(|&positions| document.root.get(positions));
    document.requires("KHR_draco_mesh_compression")
        && accessor.is_some_and(|own| own.buffer_view.is_none() && own.sparse.is_none())
}

pub(crate) const WHITE: [f32; 4] = [1.0; 4];

/// The rest transforms by which a skin deforms its vertices.
pub(crate) struct Binding {
    /// The character's joint for each joint of the skin.
    pub(crate) joints: Vec<Option<u16>>,
    /// For each joint of the skin, the transform from the mesh to the joint at rest.
    pub(crate) rest: Vec<DMat4>,
    /// Whether it is a mesh without a skin, of which all vertices follow one joint.
    pub(crate) is_rigid: bool,
}

impl Binding {
    /// Returns the binding of a skin; `None` where it has nothing to do with the character.
    fn of_skin(
        document: &Document<'_>,
        nodes: &Nodes,
        joint_of: &[Option<u16>],
        skin: Index<Skin>,
    ) -> Option<Result<Self, ImportError>> {
        let skin = document.root.get(skin)?;
        let joint = |node: usize| joint_of.get(node).copied().flatten();
        let joints: Vec<_> = skin.joints.iter().map(|own| joint(own.value())).collect();
        let is_own = joints.iter().any(Option::is_some);
        is_own.then(|| Self::read(document, nodes, skin, joints))
    }

    /// Returns the binding of a node's mesh to one joint.
    fn rigid(joint: u16, node: &Node) -> Self {
        let rest = DMat4::from_mat3_translation(node.world.linear, node.world.position);
        Self { joints: vec![Some(joint)], rest: vec![rest], is_rigid: true }
    }

    fn read(
        document: &Document<'_>,
        nodes: &Nodes,
        skin: &Skin,
        joints: Vec<Option<u16>>,
    ) -> Result<Self, ImportError> {
        let inverse_bind = match skin.inverse_bind_matrices {
            Some(matrices) => document.floats(matrices, Type::Mat4)?,
            None => Vec::new(),
        };
        let (matrices, _) = inverse_bind.as_chunks::<16>();
        if skin.inverse_bind_matrices.is_some() && matrices.len() < joints.len() {
            return Err(document.error(
                msg!(
                    "{matrices} bind matrices for {joints} joints",
                    matrices = matrices.len(),
                    joints = joints.len()
                ),
                "one for each",
            ));
        }
        if !inverse_bind.iter().all(|entry| entry.is_finite()) {
            return Err(document.error("bind matrices that are no numbers", "numbers"));
        }
        let rest = skin.joints.iter().enumerate().map(|(place, node)| {
            let world = nodes.all.get(node.value()).map(|node| node.world).unwrap_or_default();
            let joint = DMat4::from_mat3_translation(world.linear, world.position);
            joint
                * matrices.get(place).map_or(DMat4::IDENTITY, |matrix| {
                    DMat4::from_cols_array(&matrix.map(f64::from))
                })
        });
        Ok(Self { rest: rest.collect(), joints, is_rigid: false })
    }
}

/// One primitive, with its vertices at rest.
#[derive(Default)]
pub(crate) struct Part {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) normals: Vec<Vec3>,
    pub(crate) joints: Vec<[u16; 4]>,
    pub(crate) weights: Vec<[f32; 4]>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// One for each vertex.
    pub(crate) colors: Vec<[f32; 4]>,
    /// The place of each vertex in its texture; empty without textures.
    pub(crate) coordinates: Vec<[f32; 2]>,
    /// The triangles with textures.
    pub(crate) textured: Vec<TexturedPart>,
    /// Whether it has a texture that cannot be read.
    pub(crate) lacks_texture: bool,
}

impl Part {
    /// Reads a primitive; `None` if it is not a surface or has neither a skin
    /// nor a joint to hang from. `before` is the number of
    /// vertices that have been read.
    fn read(
        document: &Document<'_>,
        primitive: &Primitive,
        weights: &[f32],
        binding: &Binding,
        before: u64,
        images: &mut Images,
    ) -> Result<Option<Self>, ImportError> {
        let Checked::Valid(mode) = primitive.mode else {
            return Ok(None);
        };
        let attribute =
            |semantic: Semantic| primitive.attributes.get(&Checked::Valid(semantic)).copied();
        let Some(positions) = attribute(Semantic::Positions)
            .filter(|_| matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan))
        else {
            return Ok(None);
        };
        let claimed = document.claimed(positions);
        if before.saturating_add(claimed) > MAX_VERTICES
            || primitive.indices.is_some_and(|indices| document.claimed(indices) > 3 * MAX_VERTICES)
        {
            return Err(document.error(msg!("{claimed} vertices"), "at most two million"));
        }
        let mut positions = vectors(&document.lengths(positions, Type::Vec3)?);
        let count = positions.len();
        let mut normals = match attribute(Semantic::Normals) {
            Some(normals) => vectors(&document.floats(normals, Type::Vec3)?),
            None => Vec::new(),
        };
        morph::apply(document, primitive, weights, &mut positions, &mut normals)?;
        let mut influences: Vec<Vec<(usize, f32)>> = vec![Vec::new(); count];
        for set in 0..if binding.is_rigid { 0 } else { SETS } {
            let (Some(joints), Some(weights)) =
                (attribute(Semantic::Joints(set)), attribute(Semantic::Weights(set)))
            else {
                break;
            };
            let (joints, weights) =
                (document.integers(joints, Type::Vec4)?, document.floats(weights, Type::Vec4)?);
            if joints.len() != 4 * count || weights.len() != 4 * count {
                return Err(document
                    .error("joints or weights that are not one for each vertex", "one for each"));
            }
            document.spend(count, 4 * size_of::<(usize, f32)>())?;
            for (influences, (joints, weights)) in influences
                .iter_mut()
                .zip(joints.as_chunks::<4>().0.iter().zip(weights.as_chunks::<4>().0))
            {
                for (&joint, &weight) in joints.iter().zip(weights) {
                    if weight > 0.0 && weight.is_finite() {
                        influences.push((joint as usize, weight));
                    }
                }
            }
        }
        if !binding.is_rigid && influences.iter().all(Vec::is_empty) {
            return Ok(None);
        }
        let indices = match primitive.indices {
            Some(indices) => document.integers(indices, Type::Scalar)?,
            None => (0..count as u32).collect(),
        };
        if let Some(index) = indices.iter().find(|index| **index as usize >= count) {
            return Err(document.error(
                msg!("a triangle with vertex {index} of {count}"),
                "a vertex that is there",
            ));
        }
        let colors = colors(document, primitive, count, images);
        let mut part = Self {
            triangles: triangles(&indices, mode),
            colors: colors.of_vertices,
            lacks_texture: matches!(colors.texture, PlacedTexture::Missing),
            positions,
            normals,
            joints: Vec::with_capacity(count),
            weights: Vec::with_capacity(count),
            ..Self::default()
        };
        part.rest(binding, influences)
            .map_err(|found| document.error(found, "joints of the skin"))?;
        if let PlacedTexture::Placed(texture, coordinates) = colors.texture {
            part.coordinates = coordinates;
            part.textured = vec![TexturedPart { triangles: 0..part.triangles.len(), texture }];
        }
        Ok(Some(part))
    }

    /// Moves the vertices to where the skin has them at rest, and sets the joints that move them
    /// from there. `influences` are the joints of the skin and their weights, vertex by vertex.
    pub(crate) fn rest(
        &mut self,
        binding: &Binding,
        influences: impl IntoIterator<Item = Vec<(usize, f32)>>,
    ) -> Result<(), Message> {
        let has_normals = self.normals.len() == self.positions.len();
        let mut mirrored = 0usize;
        for (vertex, mut sorted) in influences.into_iter().enumerate() {
            sorted.sort_by(|x, y| y.1.total_cmp(&x.1));
            sorted.truncate(4);
            let mut total: f32 = sorted.iter().map(|(_, weight)| weight).sum();
            if sorted.is_empty() {
                // A vertex without weights follows the first joint.
                (sorted, total) = (vec![(0, 1.0)], 1.0);
            }
            let (mut matrix, mut joints, mut weights) = (DMat4::ZERO, [0; 4], [0.0; 4]);
            for (place, &(joint, weight)) in sorted.iter().enumerate() {
                let (Some(rest), Some(&own)) = (binding.rest.get(joint), binding.joints.get(joint))
                else {
                    return Err(msg!(
                        "a vertex with joint {joint} of {count}",
                        count = binding.rest.len()
                    ));
                };
                matrix += *rest * f64::from(weight / total);
                joints[place] = own.unwrap_or_default();
                weights[place] = weight / total;
            }
            self.joints.push(joints);
            self.weights.push(weights);
            let linear = DMat3::from_mat4(matrix);
            let (position, normal) =
                (self.positions[vertex], self.normals.get(vertex).copied().unwrap_or_default());
            self.positions[vertex] = matrix.transform_point3(position.as_dvec3()).as_vec3();
            mirrored += usize::from(linear.determinant() < 0.0);
            if has_normals {
                self.normals[vertex] = (cofactors(linear) * normal.as_dvec3()).as_vec3();
            }
        }
        let positions = &self.positions;
        self.triangles.retain(|triangle| {
            triangle.iter().all(|&corner| positions[corner as usize].abs().max_element() < 1e18)
        });
        for position in &mut self.positions {
            if position.abs().max_element().is_nan() || position.abs().max_element() >= 1e18 {
                *position = Vec3::ZERO;
            }
        }
        if 2 * mirrored > self.positions.len() {
            self.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        let computed = segue_motion::skin::normals(&self.positions, &self.triangles);
        if has_normals {
            for (normal, computed) in self.normals.iter_mut().zip(computed) {
                *normal = normal.try_normalize().unwrap_or(computed);
            }
        } else {
            self.normals = computed;
        }
        Ok(())
    }

    pub(crate) fn join(self, mesh: &mut SkinnedMesh) {
        let before = mesh.positions.len() as u32;
        append(&mut mesh.colors, self.colors);
        if !self.coordinates.is_empty() || !mesh.coordinates.is_empty() {
            // Vertices without a texture have the coordinates (0, 0), which nothing uses.
            mesh.coordinates.resize(mesh.positions.len(), [0.0; 2]);
            append(&mut mesh.coordinates, self.coordinates);
            mesh.coordinates.resize(mesh.positions.len() + self.positions.len(), [0.0; 2]);
        }
        let start = mesh.triangles.len();
        mesh.textured.extend(self.textured.into_iter().map(
            |TexturedPart { triangles, texture }| TexturedPart {
                triangles: triangles.start + start..triangles.end + start,
                texture,
            },
        ));
        append(&mut mesh.positions, self.positions);
        append(&mut mesh.normals, self.normals);
        append(&mut mesh.joints, self.joints);
        append(&mut mesh.weights, self.weights);
        let moved = |triangle: [u32; 3]| triangle.map(|corner| corner + before);
        append(&mut mesh.triangles, self.triangles.into_iter().map(moved).collect());
    }
}

/// Appends values; the first ones without a copy.
fn append<T>(all: &mut Vec<T>, values: Vec<T>) {
    if all.is_empty() {
        *all = values;
    } else {
        all.extend(values);
    }
}

/// Returns the matrix that transforms normals with a surface: the inverse transpose times the
/// determinant, which also exists for flattened surfaces.
fn cofactors(m: DMat3) -> DMat3 {
    let [x, y, z]: [DVec3; 3] = [m.x_axis, m.y_axis, m.z_axis];
    let sign = m.determinant().signum();
    DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * sign
}

/// Returns the triangles of a list, a strip or a fan of indices (section 3.7.2.1).
fn triangles(indices: &[u32], mode: Mode) -> Vec<[u32; 3]> {
    let own = |[a, b, c]: [u32; 3]| (a != b && b != c && c != a).then_some([a, b, c]);
    match mode {
        Mode::TriangleStrip => indices
            .windows(3)
            .enumerate()
            .filter_map(|(place, w)| {
                own(if place % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] })
            })
            .collect(),
        Mode::TriangleFan => (indices.get(1..).unwrap_or_default().windows(2))
            .filter_map(|w| own([indices[0], w[0], w[1]]))
            .collect(),
        _ => indices.as_chunks::<3>().0.iter().copied().filter_map(own).collect(),
    }
}
