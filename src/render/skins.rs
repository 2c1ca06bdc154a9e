//! Skinned bodies on the GPU: each mesh once, and the joints of all figures of a stage in a
//! texture.

use super::buffers::filled_buffer;
use super::coarse_mesh::coarse_triangles;
use super::frame::SharedMesh;
use super::layout::{JointTexels, SkinVertex};
use super::pipelines::Pipelines;
use super::quality::Quality;
use eframe::wgpu;
use segue_motion::skin::SkinnedMesh;
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
}

/// Triangles between the vertices of a mesh.
pub(super) struct Triangles {
    pub(super) indices: wgpu::Buffer,
    pub(super) index_count: u32,
}

fn vertices(mesh: &SkinnedMesh) -> Vec<SkinVertex> {
    let last_joint = mesh.bind.len().saturating_sub(1) as u16;
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
        }
    };
    (0..mesh.positions.len()).map(vertex).collect()
}

impl SkinBuffers {
    fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        mesh: &Arc<SkinnedMesh>,
        quality: Quality,
    ) -> Self {
        let buffer = |contents: &[u8], usage| filled_buffer(device, queue, "skin", contents, usage);
        let vertices = vertices(mesh);
        let uploaded = |triangles: &[[u32; 3]]| Triangles {
            indices: buffer(bytemuck::cast_slice(triangles), wgpu::BufferUsages::INDEX),
            index_count: 3 * triangles.len() as u32,
        };
        // A triangle with an invalid corner is left out.
        let inside = |triangle: &&[u32; 3]| {
            triangle.iter().all(|&corner| (corner as usize) < vertices.len())
        };
        let triangles: Vec<[u32; 3]> = mesh.triangles.iter().filter(inside).copied().collect();
        Self {
            mesh: Arc::downgrade(mesh),
            vertices: buffer(bytemuck::cast_slice(&vertices), wgpu::BufferUsages::VERTEX),
            fine: uploaded(&triangles),
            coarse: (quality == Quality::Plain).then(|| uploaded(&coarse_triangles(mesh))),
        }
    }
}

/// The meshes of all stages on the device, while their originals exist.
#[derive(Default)]
pub(super) struct SkinStore(Vec<SkinBuffers>);

impl SkinStore {
    /// Uploads new meshes to the device, and drops those whose originals no longer exist.
    pub(super) fn load(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        meshes: &[SharedMesh],
        quality: Quality,
    ) {
        self.0.retain(|buffers| buffers.mesh.strong_count() > 0);
        for SharedMesh(mesh) in meshes {
            if self.get(mesh).is_none() {
                self.0.push(SkinBuffers::new(device, queue, mesh, quality));
            }
        }
    }

    /// Returns the buffers of a loaded mesh.
    pub(super) fn get(&self, mesh: &Arc<SkinnedMesh>) -> Option<&SkinBuffers> {
        self.0.iter().find(|buffers| buffers.mesh.as_ptr() == Arc::as_ptr(mesh))
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
