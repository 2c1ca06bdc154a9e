//! The pipelines of a stage: their settings, and how one is made.

use super::shaders::Shader;
use super::{PipelineKind, Pipelines};
use crate::render::layout::{
    COLOR_FORMAT, DEPTH_FORMAT, LimbInstance, MAP_FORMAT, RingInstance, SkinInstance, SkinVertex,
    StrokeInstance,
};
use crate::render::mesh::ConeVertex;
use eframe::wgpu;
use wgpu::CompareFunction::{Less, LessEqual};
use wgpu::Face::{Back, Front};

/// The settings in which the pipelines of a stage differ.
struct Settings<'a> {
    label: &'a str,
    shader: &'a Shader,
    layout: &'a wgpu::PipelineLayout,
    /// The entry points of the vertex and of the fragment stage. Without the latter, a pipeline
    /// writes only the depths of the light map.
    entries: [&'a str; 2],
    buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    blend: Option<wgpu::BlendState>,
    writes: wgpu::ColorWrites,
    /// The comparison of depths, and whether they are written.
    depth: Option<(wgpu::CompareFunction, bool)>,
    topology: wgpu::PrimitiveTopology,
    cull: Option<wgpu::Face>,
    stencil: wgpu::StencilState,
}

const OVER: wgpu::BlendState = wgpu::BlendState::ALPHA_BLENDING;

/// Multiplies the target's alpha, which is the share of light that is left, by that of the source.
const DARKEN: wgpu::BlendState = wgpu::BlendState {
    color: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Zero,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    },
    alpha: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Zero,
        dst_factor: wgpu::BlendFactor::OneMinusSrcAlpha,
        operation: wgpu::BlendOperation::Add,
    },
};

/// Interpolates from full shadow (the source) to full light (the target) by the target's alpha.
const SHADE: wgpu::BlendState = wgpu::BlendState {
    color: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::OneMinusDstAlpha,
        dst_factor: wgpu::BlendFactor::DstAlpha,
        operation: wgpu::BlendOperation::Add,
    },
    alpha: wgpu::BlendComponent::REPLACE,
};

/// Returns a stencil state by which a pixel is coloured once for each ghost, even where its limbs
/// overlap. The stencil holds the number of the last ghost.
fn once_per_ghost() -> wgpu::StencilState {
    let face = wgpu::StencilFaceState {
        compare: wgpu::CompareFunction::NotEqual,
        fail_op: wgpu::StencilOperation::Keep,
        depth_fail_op: wgpu::StencilOperation::Keep,
        pass_op: wgpu::StencilOperation::Replace,
    };
    wgpu::StencilState { front: face, back: face, read_mask: 0xff, write_mask: 0xff }
}

impl Pipelines {
    /// Makes a pipeline.
    pub(super) fn make(&self, kind: PipelineKind) -> wgpu::RenderPipeline {
        let device = &self.device;
        let mesh_attributes = wgpu::vertex_attr_array![0 => Float32x4];
        let limb_attributes = wgpu::vertex_attr_array![1 => Float32x4, 2 => Float32x4, 3 => Float32x4, 4 => Unorm8x4, 5 => Uint8x4, 6 => Uint8x4, 7 => Uint8x4, 8 => Uint8x4, 9 => Uint8x4, 10 => Float32];
        let line_attributes = wgpu::vertex_attr_array![
            0 => Float32x3, 1 => Float32x3, 2 => Float32x3, 3 => Float32x3, 4 => Unorm8x4, 5 => Unorm8x4, 6 => Float32
        ];
        let ring_attributes = wgpu::vertex_attr_array![0 => Float32x4, 1 => Unorm8x4, 2 => Float32];
        let mesh_buffer = wgpu::VertexBufferLayout {
            array_stride: size_of::<ConeVertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &mesh_attributes,
        };
        let instances = |stride: usize, attributes| wgpu::VertexBufferLayout {
            array_stride: stride as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes,
        };
        let limb_buffer = instances(size_of::<LimbInstance>(), &limb_attributes[..]);
        let limb_buffers = [Some(mesh_buffer), Some(limb_buffer.clone())];
        // The shadow reads the limbs without their colours.
        let [place_a, place_b, flat, .., strength] = limb_attributes;
        let shadow_attributes = [place_a, place_b, flat, strength];
        let shadow_buffers =
            [Some(wgpu::VertexBufferLayout { attributes: &shadow_attributes, ..limb_buffer })];
        let skin_attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Snorm16x4, 2 => Uint16x4, 3 => Unorm16x4, 4 => Unorm8x4, 7 => Float32x3];
        let skin_figure_attributes = wgpu::vertex_attr_array![5 => Uint32x2, 6 => Unorm8x4];
        let skin_buffers = [
            Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<SkinVertex>() as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &skin_attributes,
            }),
            Some(instances(size_of::<SkinInstance>(), &skin_figure_attributes[..])),
        ];
        let line_buffers = [Some(instances(size_of::<StrokeInstance>(), &line_attributes[..]))];
        let ring_buffers = [Some(instances(size_of::<RingInstance>(), &ring_attributes[..]))];

        let ground_settings = |label, entry, blend| Settings {
            label,
            shader: &self.ground,
            layout: &self.plain,
            entries: ["vs_ground", entry],
            buffers: &[],
            blend,
            writes: wgpu::ColorWrites::ALL,
            depth: None,
            topology: wgpu::PrimitiveTopology::TriangleList,
            cull: None,
            stencil: wgpu::StencilState::default(),
        };
        let quad = wgpu::PrimitiveTopology::TriangleStrip;
        let line_settings = |label, depth| Settings {
            shader: &self.line,
            entries: ["vs_line", "fs_line"],
            buffers: &line_buffers,
            topology: quad,
            depth,
            ..ground_settings(label, "", Some(OVER))
        };
        let shadow_settings = |label, shader, layout, entries| Settings {
            shader,
            layout,
            entries,
            writes: wgpu::ColorWrites::ALPHA,
            topology: quad,
            ..ground_settings(label, "", Some(DARKEN))
        };
        let limb_settings = |label, entries, depth, blend, cull| Settings {
            label,
            shader: &self.limb,
            layout: &self.bodily,
            entries,
            buffers: &limb_buffers,
            blend,
            writes: wgpu::ColorWrites::ALL,
            depth: Some(depth),
            topology: wgpu::PrimitiveTopology::TriangleList,
            cull: Some(cull),
            stencil: wgpu::StencilState::default(),
        };
        let skin_settings = |label, entries, depth, blend, cull| Settings {
            shader: &self.skin,
            layout: &self.skinned,
            buffers: &skin_buffers,
            ..limb_settings(label, entries, depth, blend, cull)
        };
        let settings = match kind {
            PipelineKind::Ground => ground_settings("ground", "fs_ground", None),
            PipelineKind::Shade => ground_settings("shade", "fs_shade", Some(SHADE)),
            PipelineKind::Shadow => Settings {
                buffers: &shadow_buffers,
                ..shadow_settings("shadow", &self.shadow, &self.plain, ["vs_shadow", "fs_shadow"])
            },
            PipelineKind::KeyShadow => shadow_settings(
                "key shadow",
                &self.key_shadow,
                &self.lit,
                ["vs_key_shadow", "fs_key_shadow"],
            ),
            PipelineKind::Cast => Settings {
                layout: &self.plain,
                ..limb_settings("cast", ["vs_cast", ""], (Less, true), None, Back)
            },
            PipelineKind::Ring => Settings {
                shader: &self.ring,
                entries: ["vs_ring", "fs_ring"],
                buffers: &ring_buffers,
                topology: quad,
                ..ground_settings("ring", "", Some(OVER))
            },
            PipelineKind::FlatLine => line_settings("line", None),
            PipelineKind::SpaceLine => line_settings("line in space", Some((LessEqual, true))),
            PipelineKind::Solid => {
                limb_settings("limb", ["vs_limb", "fs_solid"], (LessEqual, false), None, Back)
            }
            PipelineKind::Edge => {
                limb_settings("limb edge", ["vs_edge", "fs_edge"], (Less, true), Some(OVER), Front)
            }
            PipelineKind::Front => Settings {
                writes: wgpu::ColorWrites::empty(),
                ..limb_settings("limb front", ["vs_limb", "fs_depth"], (Less, true), None, Back)
            },
            PipelineKind::Ghost => Settings {
                stencil: once_per_ghost(),
                ..limb_settings(
                    "ghost",
                    ["vs_limb", "fs_ghost"],
                    (LessEqual, false),
                    Some(OVER),
                    Back,
                )
            },
            PipelineKind::Skin => {
                skin_settings("skin", ["vs_skin", "fs_skin"], (Less, true), None, Back)
            }
            PipelineKind::SkinEdge => skin_settings(
                "skin edge",
                ["vs_skin_edge", "fs_skin_edge"],
                (Less, true),
                Some(OVER),
                Front,
            ),
            PipelineKind::SkinCutOut => skin_settings(
                "cut-out skin",
                ["vs_skin", "fs_skin_cut_out"],
                (Less, true),
                None,
                Back,
            ),
            PipelineKind::SkinEdgeCutOut => skin_settings(
                "cut-out skin edge",
                ["vs_skin_edge", "fs_skin_edge_cut_out"],
                (Less, true),
                Some(OVER),
                Front,
            ),
            PipelineKind::SkinFront => Settings {
                writes: wgpu::ColorWrites::empty(),
                ..skin_settings("skin front", ["vs_skin", "fs_depth"], (Less, true), None, Back)
            },
            PipelineKind::SkinGhost => Settings {
                stencil: once_per_ghost(),
                ..skin_settings(
                    "skin ghost",
                    ["vs_skin", "fs_skin_ghost"],
                    (LessEqual, false),
                    Some(OVER),
                    Back,
                )
            },
            PipelineKind::SkinCast => {
                skin_settings("skin cast", ["vs_skin_cast", ""], (Less, true), None, Back)
            }
        };
        stage_pipeline(device, &settings, self.sample_count)
    }
}

/// Makes a pipeline by its settings.
fn stage_pipeline(
    device: &wgpu::Device,
    settings: &Settings<'_>,
    sample_count: u32,
) -> wgpu::RenderPipeline {
    let module = settings.shader.module(device);
    let is_depth_only = settings.entries[1].is_empty();
    let targets = [Some(wgpu::ColorTargetState {
        format: COLOR_FORMAT,
        blend: settings.blend,
        write_mask: settings.writes,
    })];
    let (compare, write) = settings.depth.unwrap_or((wgpu::CompareFunction::Always, false));
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(settings.label),
        layout: Some(settings.layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(settings.entries[0]),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: settings.buffers,
        },
        primitive: wgpu::PrimitiveState {
            topology: settings.topology,
            cull_mode: settings.cull,
            ..wgpu::PrimitiveState::default()
        },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: if is_depth_only { MAP_FORMAT } else { DEPTH_FORMAT },
            depth_write_enabled: Some(write),
            depth_compare: Some(compare),
            stencil: settings.stencil.clone(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState {
            count: if is_depth_only { 1 } else { sample_count },
            ..wgpu::MultisampleState::default()
        },
        fragment: (!is_depth_only).then(|| wgpu::FragmentState {
            module,
            entry_point: Some(settings.entries[1]),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}
