//! Skinned bodies on the GPU: each mesh once, and the joints of all figures of a stage in a
//! texture.

use super::buffers::filled_buffer;
use super::coarse_mesh::Clusters;
use super::frame::SharedMesh;
use super::layout::{JointTexels, SkinVertex};
use super::pipelines::Pipelines;
use super::quality::Quality;
use super::textures::{BoundTexture, TextureStore};
use eframe::wgpu;
use segue_motion::skin::{AlphaMode, SkinnedMesh, Texture};
use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::{Arc, Weak};

/// The number of joints in a row of their texture, as in skin.wgsl.
const JOINTS_IN_ROW: usize = 512;

/// A mesh in the memory of the device.
pub(super) struct SkinBuffers {
    mesh: Weak<SkinnedMesh>,
    pub(super) vertices: wgpu::Buffer,
    pub(super) fine: Triangles,
    /// Fewer triangles, for pictures in motion without a graphics card; `None` with one.
    pub(super) coarse: Option<Triangles>,
    /// The textures of the parts of these triangles, and whether something is cut out of them.
    pub(super) surfaces: Vec<Surface>,
}

/// Triangles between the vertices of a mesh.
pub(super) struct Triangles {
    pub(super) indices: wgpu::Buffer,
    /// The indices of each part of the mesh.
    pub(super) parts: Vec<Range<u32>>,
}

impl Triangles {
    /// Returns the indices of the whole mesh.
    pub(super) fn all(&self) -> Range<u32> {
        0..self.parts.last().map_or(0, |part| part.end)
    }
}

/// The surface of a part of a mesh.
pub(super) struct Surface {
    /// Its texture, if it has one.
    pub(super) texture: Option<BoundTexture>,
    /// Whether the texture cuts out something.
    pub(super) cuts_out: bool,
}

fn vertices(mesh: &SkinnedMesh) -> Vec<SkinVertex> {
    let last_joint = mesh.bind.len().saturating_sub(1) as u16;
    let cutoff = |texture: Option<&Texture>| texture.map_or(0.0, |own| own.alpha.cutoff());
    let cutoffs: Vec<f32> = mesh.parts().into_iter().map(|(_, own)| cutoff(own)).collect();
    let parts = mesh.part_of_vertices();
    let vertex = |index: usize| {
        let normal = mesh.normals.get(index).copied().unwrap_or_default();
        let joints = mesh.joints.get(index).copied().unwrap_or_default();
        let weights = mesh.weights.get(index).copied().unwrap_or_default();
        let tint = mesh.colors.get(index).copied().unwrap_or([1.0; 4]);
        SkinVertex {
            position: mesh
                .positions
                .get(index)
                .copied()
                .filter(|p| p.is_finite())
                .unwrap_or_default()
                .to_array(),
            normal: normal
                .extend(0.0)
                .to_array()
                .map(|part| (part.clamp(-1.0, 1.0) * 32_767.0) as i16),
            joints: joints.map(|joint| joint.min(last_joint)),
            weights: weights.map(|weight| (weight.clamp(0.0, 1.0) * 65_535.0 + 0.5) as u16),
            tint: tint.map(|part| (part.clamp(0.0, 1.0) * 255.0 + 0.5) as u8),
            texture: {
                let [u, v] = mesh.coordinates.get(index).copied().unwrap_or_default();
                [u, v, cutoffs.get(parts[index]).copied().unwrap_or_default()]
            },
        }
    };
    (0..mesh.positions.len()).map(vertex).collect()
}

/// Selects those triangles of a part that are drawn.
type Select<'a> = &'a dyn Fn(&[[u32; 3]]) -> Vec<[u32; 3]>;

impl SkinBuffers {
    fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        mesh: &Arc<SkinnedMesh>,
        quality: Quality,
        mut texture_of: impl FnMut(&Texture) -> BoundTexture,
    ) -> Self {
        let buffer = |contents: &[u8], usage| filled_buffer(device, queue, "skin", contents, usage);
        let vertices = vertices(mesh);
        let parts = mesh.parts();
        let uploaded = |select: Select<'_>| {
            let mut triangles: Vec<[u32; 3]> = Vec::new();
            let ranges = parts.iter().map(|(range, _)| {
                let start = triangles.len() as u32;
                triangles.extend(select(&mesh.triangles[range.clone()]));
                3 * start..3 * triangles.len() as u32
            });
            let parts = ranges.collect();
            let indices = buffer(bytemuck::cast_slice(&triangles), wgpu::BufferUsages::INDEX);
            Triangles { indices, parts }
        };
        // A triangle with an invalid corner is left out.
        let inside = |triangle: &&[u32; 3]| {
            triangle.iter().all(|&corner| (corner as usize) < vertices.len())
        };
        let fine = |triangles: &[[u32; 3]]| triangles.iter().filter(inside).copied().collect();
        let surface = |texture: Option<&Texture>| Surface {
            cuts_out: texture.is_some_and(|texture| texture.alpha != AlphaMode::Opaque),
            texture: texture.map(&mut texture_of),
        };
        Self {
            mesh: Arc::downgrade(mesh),
            vertices: buffer(bytemuck::cast_slice(&vertices), wgpu::BufferUsages::VERTEX),
            fine: uploaded(&fine),
            coarse: (quality == Quality::Plain).then(|| {
                let clusters = Clusters::of(mesh);
                uploaded(&|triangles| clusters.coarse(triangles))
            }),
            surfaces: parts.iter().map(|(_, texture)| *texture).map(surface).collect(),
        }
    }
}

/// The meshes of all stages on the device, while their originals exist.
#[derive(Default)]
pub(super) struct SkinStore {
    meshes: Vec<SkinBuffers>,
    pub(super) textures: TextureStore,
}

impl SkinStore {
    /// Uploads new meshes to the device, and drops those whose originals no longer exist.
    pub(super) fn load(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pipelines: &Pipelines,
        meshes: &[SharedMesh],
        quality: Quality,
    ) {
        self.meshes.retain(|buffers| buffers.mesh.strong_count() > 0);
        self.textures.prepare(device, queue, pipelines);
        for SharedMesh(mesh) in meshes {
            if self.get(mesh).is_none() {
                let images =
                    mesh.textured.iter().map(|part| Arc::as_ptr(&part.texture.image).addr());
                let count = images.collect::<BTreeSet<_>>().len();
                let texture =
                    |own: &Texture| self.textures.load(device, queue, pipelines, own, count);
                self.meshes.push(SkinBuffers::new(device, queue, mesh, quality, texture));
            }
        }
    }

    /// Returns the buffers of a loaded mesh.
    pub(super) fn get(&self, mesh: &Arc<SkinnedMesh>) -> Option<&SkinBuffers> {
        self.meshes.iter().find(|buffers| buffers.mesh.as_ptr() == Arc::as_ptr(mesh))
    }
}

/// The joints of the figures of one stage.
#[derive(Default)]
pub(super) struct JointTexture {
    texture: Option<wgpu::Texture>,
    pub(super) bound: Option<wgpu::BindGroup>,
    /// The rows to write; the last one is padded.
    rows: Vec<JointTexels>,
}

impl JointTexture {
    /// Writes the joints, into a larger texture where it is needed. Joints beyond the largest
    /// texture are left out.
    pub(super) fn write(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pipelines: &Pipelines,
        joints: &[JointTexels],
    ) {
        let max_rows = device.limits().max_texture_dimension_2d;
        let needed = (joints.len().div_ceil(JOINTS_IN_ROW) as u32).clamp(1, max_rows);
        if joints.is_empty() && self.bound.is_some() {
            return;
        }
        let texture = match self.texture.take() {
            Some(texture) if texture.height() >= needed => texture,
            _ => {
                let texture = device.create_texture(&wgpu::TextureDescriptor {
                    label: Some("joints"),
                    size: wgpu::Extent3d {
                        width: 2 * JOINTS_IN_ROW as u32,
                        height: needed.next_power_of_two().min(max_rows),
                        depth_or_array_layers: 1,
                    },
                    mip_level_count: 1,
                    sample_count: 1,
                    dimension: wgpu::TextureDimension::D2,
                    format: wgpu::TextureFormat::Rgba32Float,
                    usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
                    view_formats: &[],
                });
                let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
                self.bound = Some(device.create_bind_group(&wgpu::BindGroupDescriptor {
                    label: Some("joints"),
                    layout: &pipelines.joints_layout,
                    entries: &[wgpu::BindGroupEntry {
                        binding: 0,
                        resource: wgpu::BindingResource::TextureView(&view),
                    }],
                }));
                texture
            }
        };
        self.rows.clear();
        self.rows.extend_from_slice(joints);
        self.rows.resize(needed as usize * JOINTS_IN_ROW, [[0.0; 4]; 2]);
        queue.write_texture(
            texture.as_image_copy(),
            bytemuck::cast_slice(&self.rows),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some((JOINTS_IN_ROW * size_of::<JointTexels>()) as u32),
                rows_per_image: None,
            },
            wgpu::Extent3d {
                width: 2 * JOINTS_IN_ROW as u32,
                height: needed,
                depth_or_array_layers: 1,
            },
        );
        self.texture = Some(texture);
    }
}
