//! Memory layouts of instances, vertices and uniform blocks, and the formats of targets.

use eframe::wgpu;
use segue_scene::Color;

/// The format of a stage's colours. They are sRGB-encoded, as egui's own, so that blending looks
/// the same in the stage and beside it.
pub(super) const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// The format of a stage's depths.
pub(super) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth24PlusStencil8;
/// The format of the light map.
pub(super) const MAP_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth16Unorm;

/// The greatest number of limbs of one body that blend into the others and shade them.
pub(super) const MAX_NEIGHBOURS: usize = 48;
/// The greatest number of other limbs that a limb is blended with and shaded by.
pub(super) const MAX_NEAREST: usize = 20;

/// A limb of limb.wgsl.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct LimbInstance {
    pub(super) a: [f32; 4],
    pub(super) b: [f32; 4],
    pub(super) flat: [f32; 4],
    pub(super) color: [u8; 4],
    pub(super) near: [u8; MAX_NEAREST],
    pub(super) shadow: f32,
}

/// A figure in its skin.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct SkinInstance {
    /// The index of its first joint, and the source of its colour, as in skin.wgsl.
    pub(super) figure: [u32; 2],
    pub(super) color: [u8; 4],
}

/// The two texels of a joint, as in skin.wgsl.
pub(super) type JointTexels = [[f32; 4]; 2];

/// A piece of a line of line.wgsl.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct StrokeInstance {
    pub(super) points: [[f32; 3]; 4],
    pub(super) colors: [[u8; 4]; 2],
    pub(super) width: f32,
}

/// A ring of ring.wgsl.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct RingInstance {
    pub(super) place: [f32; 4],
    pub(super) color: [u8; 4],
    pub(super) fill: f32,
}

/// `View` of view.wgsl.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct ViewUniform {
    pub(super) clip_from_world: [f32; 16],
    pub(super) eye: [f32; 4],
    pub(super) right: [f32; 4],
    pub(super) up: [f32; 4],
    pub(super) forward: [f32; 4],
    pub(super) viewport: [f32; 4],
    pub(super) key: [f32; 4],
    pub(super) background_top: Color,
    pub(super) background_bottom: Color,
    pub(super) floor: [f32; 4],
    pub(super) focus: [f32; 4],
    pub(super) grid: Color,
    pub(super) edge: Color,
    pub(super) style: [f32; 4],
    pub(super) light_center: [f32; 4],
    pub(super) light_right: [f32; 4],
    pub(super) light_up: [f32; 4],
    pub(super) light_tile: [f32; 4],
    pub(super) light_tile_metres: [f32; 4],
    pub(super) more: [f32; 4],
}

impl ViewUniform {
    /// Returns whether edges are visible.
    pub(super) fn has_edges(&self) -> bool {
        self.edge[3] > 0.0 && self.style[0] > 0.0
    }
}

/// `Figure` of limb.wgsl.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct FigureUniform {
    pub(super) about: [f32; 4],
    pub(super) neighbours: [[f32; 4]; 3 * MAX_NEIGHBOURS],
}

/// A vertex of skin.wgsl.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct SkinVertex {
    pub(super) position: [f32; 3],
    pub(super) normal: [i16; 4],
    pub(super) joints: [u16; 4],
    pub(super) weights: [u16; 4],
    pub(super) tint: [u8; 4],
    /// The place in the image of its texture, and the opacity below which a point is left out.
    pub(super) texture: [f32; 3],
}
