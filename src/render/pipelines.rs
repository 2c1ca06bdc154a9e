//! The render pipelines of a device.

use super::layout::{
    COLOR_FORMAT, DEPTH_FORMAT, FigureUniform, LimbInstance, MAP_FORMAT, RingInstance,
    SkinInstance, SkinVertex, StrokeInstance, ViewUniform,
};
use super::mesh::ConeVertex;
use eframe::wgpu;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering};
use wgpu::CompareFunction::{Less, LessEqual};
use wgpu::Face::{Back, Front};

/// The shaders as they are compiled: what all share comes first.
pub(super) const LIMB: &str =
    concat!(include_str!("view.wgsl"), include_str!("light.wgsl"), include_str!("limb.wgsl"));
pub(super) const SKIN: &str =
    concat!(include_str!("view.wgsl"), include_str!("light.wgsl"), include_str!("skin.wgsl"));
pub(super) const KEY_SHADOW: &str =
    concat!(include_str!("view.wgsl"), include_str!("light.wgsl"), include_str!("key_shadow.wgsl"));
pub(super) const SHADOW: &str = concat!(include_str!("view.wgsl"), include_str!("shadow.wgsl"));
pub(super) const GROUND: &str = concat!(include_str!("view.wgsl"), include_str!("ground.wgsl"));
pub(super) const LINE: &str = concat!(include_str!("view.wgsl"), include_str!("line.wgsl"));
pub(super) const RING: &str = concat!(include_str!("view.wgsl"), include_str!("ring.wgsl"));
pub(super) const COMPOSITE: &str = include_str!("composite.wgsl");

/// What a stage is drawn with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Brush {
    Ground,
    Shadow,
    Shade,
    Ring,
    /// On the ground and over everything: no depth.
    FlatLine,
    SpaceLine,
    Solid,
    Edge,
    /// Only the depth of the limbs' fronts.
    Front,
    Ghost,
    /// A body in the light map.
    Cast,
    /// What the light map says of the ground.
    KeyShadow,
    /// The same of bodies in skins.
    Skin,
    SkinEdge,
    SkinFront,
    SkinGhost,
    SkinCast,
}

impl Brush {
    /// In the order in which they are missed.
    const ALL: [Self; 17] = [
        Self::Ground,
        Self::Skin,
        Self::Front,
        Self::Solid,
        Self::Shadow,
        Self::Shade,
        Self::SkinCast,
        Self::Cast,
        Self::KeyShadow,
        Self::FlatLine,
        Self::SkinFront,
        Self::SkinGhost,
        Self::Ghost,
        Self::SkinEdge,
        Self::Edge,
        Self::SpaceLine,
        Self::Ring,
    ];

    /// Whether there is no picture without it.
    const fn is_vital(self) -> bool {
        matches!(self, Self::Ground | Self::Front | Self::Solid | Self::Skin)
    }
}

/// The pipelines of a device. WebGL takes long to make one: the first picture comes with those that
/// it cannot do without, and the others are made one in a frame.
pub(super) struct Pipelines {
    device: wgpu::Device,
    pub(super) view_layout: wgpu::BindGroupLayout,
    pub(super) figure_layout: wgpu::BindGroupLayout,
    pub(super) joints_layout: wgpu::BindGroupLayout,
    pub(super) light_layout: wgpu::BindGroupLayout,
    pub(super) light_compare: wgpu::Sampler,
    pub(super) light_exactly: wgpu::Sampler,
    pub(super) composite_layout: wgpu::BindGroupLayout,
    pub(super) composite_sampler: wgpu::Sampler,
    pub(super) composite: wgpu::RenderPipeline,
    pub(super) sample_count: u32,
    /// For what lies on the ground and in space.
    plain: wgpu::PipelineLayout,
    /// For what the main light falls on.
    lit: wgpu::PipelineLayout,
    /// For bodies.
    bodily: wgpu::PipelineLayout,
    /// For bodies in skins.
    skinned: wgpu::PipelineLayout,
    limb: Shader,
    skin: Shader,
    shadow: Shader,
    key_shadow: Shader,
    ground: Shader,
    line: Shader,
    ring: Shader,
    made: [OnceLock<wgpu::RenderPipeline>; Brush::ALL.len()],
    /// Those that were asked for: a bit each.
    wanted: AtomicU32,
}

/// A shader that is compiled when the first pipeline needs it.
struct Shader {
    label: &'static str,
    source: &'static str,
    module: OnceLock<wgpu::ShaderModule>,
}

impl Shader {
    const fn new(label: &'static str, source: &'static str) -> Self {
        Self { label, source, module: OnceLock::new() }
    }

    fn module(&self, device: &wgpu::Device) -> &wgpu::ShaderModule {
        self.module.get_or_init(|| {
            device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(self.label),
                source: wgpu::ShaderSource::Wgsl(self.source.into()),
            })
        })
    }
}

/// What differs between the pipelines of the stage.
struct Recipe<'a> {
    label: &'a str,
    shader: &'a Shader,
    layout: &'a wgpu::PipelineLayout,
    entries: [&'a str; 2],
    buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    blend: Option<wgpu::BlendState>,
    writes: wgpu::ColorWrites,
    /// Compare and write.
    depth: Option<(wgpu::CompareFunction, bool)>,
    topology: wgpu::PrimitiveTopology,
    cull: Option<wgpu::Face>,
    stencil: wgpu::StencilState,
}

const OVER: wgpu::BlendState = wgpu::BlendState::ALPHA_BLENDING;

/// Takes light away: the target's alpha is what is left of it.
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

/// Between full shadow (what is drawn) and full light (what is there), by the light that is left.
const SHADE: wgpu::BlendState = wgpu::BlendState {
    color: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::OneMinusDstAlpha,
        dst_factor: wgpu::BlendFactor::DstAlpha,
        operation: wgpu::BlendOperation::Add,
    },
    alpha: wgpu::BlendComponent::REPLACE,
};

/// Where two limbs of a ghost share a surface, it is coloured once: the stencil keeps the number of
/// the ghost that was there last.
fn once_per_ghost() -> wgpu::StencilState {
    let face = wgpu::StencilFaceState {
        compare: wgpu::CompareFunction::NotEqual,
        fail_op: wgpu::StencilOperation::Keep,
        depth_fail_op: wgpu::StencilOperation::Keep,
        pass_op: wgpu::StencilOperation::Replace,
    };
    wgpu::StencilState { front: face, back: face, read_mask: 0xff, write_mask: 0xff }
}

fn uniform_layout(device: &wgpu::Device, label: &str, size: usize) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some(label),
        entries: &[wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: true,
                min_binding_size: wgpu::BufferSize::new(size as u64),
            },
            count: None,
        }],
    })
}

/// The light map as depths to compare with, and as depths.
fn light_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let seen = wgpu::ShaderStages::FRAGMENT;
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("light map"),
        entries: &[
            texture_entry(0, seen, wgpu::TextureSampleType::Depth),
            sampler_entry(1, wgpu::SamplerBindingType::Comparison),
            texture_entry(2, seen, wgpu::TextureSampleType::Float { filterable: false }),
            sampler_entry(3, wgpu::SamplerBindingType::NonFiltering),
        ],
    })
}

fn texture_entry(
    binding: u32,
    visibility: wgpu::ShaderStages,
    sample_type: wgpu::TextureSampleType,
) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility,
        ty: wgpu::BindingType::Texture {
            sample_type,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        },
        count: None,
    }
}

fn sampler_entry(binding: u32, kind: wgpu::SamplerBindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Sampler(kind),
        count: None,
    }
}

impl Pipelines {
    pub(super) fn new(
        device: &wgpu::Device,
        output_format: wgpu::TextureFormat,
        sample_count: u32,
    ) -> Self {
        let view_layout = uniform_layout(device, "stage view", size_of::<ViewUniform>());
        let figure_layout = uniform_layout(device, "stage figure", size_of::<FigureUniform>());
        let layout = |label, groups: &[Option<&wgpu::BindGroupLayout>]| {
            device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(label),
                bind_group_layouts: groups,
                immediate_size: 0,
            })
        };
        let light_layout = light_layout(device);
        let joints_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("joints"),
            entries: &[texture_entry(
                0,
                wgpu::ShaderStages::VERTEX,
                wgpu::TextureSampleType::Float { filterable: false },
            )],
        });
        let (composite_layout, composite) = composite_pipeline(device, output_format);
        Self {
            plain: layout("stage", &[Some(&view_layout)]),
            lit: layout("stage light", &[Some(&view_layout), Some(&light_layout)]),
            bodily: layout(
                "stage bodies",
                &[Some(&view_layout), Some(&light_layout), Some(&figure_layout)],
            ),
            skinned: layout(
                "stage skins",
                &[Some(&view_layout), Some(&light_layout), Some(&joints_layout)],
            ),
            limb: Shader::new("limb", LIMB),
            skin: Shader::new("skin", SKIN),
            shadow: Shader::new("shadow", SHADOW),
            key_shadow: Shader::new("key shadow", KEY_SHADOW),
            ground: Shader::new("ground", GROUND),
            line: Shader::new("line", LINE),
            ring: Shader::new("ring", RING),
            made: std::array::from_fn(|_| OnceLock::new()),
            wanted: AtomicU32::new(0),
            view_layout,
            figure_layout,
            joints_layout,
            light_layout,
            light_compare: device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("light map"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                compare: Some(LessEqual),
                ..wgpu::SamplerDescriptor::default()
            }),
            light_exactly: device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("light map as it is"),
                ..wgpu::SamplerDescriptor::default()
            }),
            composite_layout,
            composite_sampler: device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("stage composite"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..wgpu::SamplerDescriptor::default()
            }),
            composite,
            sample_count,
            device: device.clone(),
        }
    }

    /// The pipeline; `None` where the picture can do without it until it is made. Natively that
    /// takes no time worth a word.
    pub(super) fn get(&self, brush: Brush) -> Option<&wgpu::RenderPipeline> {
        let slot = &self.made[brush as usize];
        if brush.is_vital() || cfg!(not(target_arch = "wasm32")) {
            return Some(slot.get_or_init(|| self.make(brush)));
        }
        if slot.get().is_none() {
            self.wanted.fetch_or(1 << brush as u32, Ordering::Relaxed);
        }
        slot.get()
    }

    /// Makes the next one that was asked for in vain.
    pub(super) fn make_next(&self) {
        let wanted = self.wanted.load(Ordering::Relaxed);
        let Some(&brush) = Brush::ALL.iter().find(|&&brush| wanted & 1 << brush as u32 != 0) else {
            return;
        };
        self.made[brush as usize].get_or_init(|| self.make(brush));
        self.wanted.fetch_and(!(1 << brush as u32), Ordering::Relaxed);
    }

    fn make(&self, brush: Brush) -> wgpu::RenderPipeline {
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
        // The shadow reads the limbs, but for their colour.
        let [place_a, place_b, flat, .., strength] = limb_attributes;
        let shadow_attributes = [place_a, place_b, flat, strength];
        let shadow_buffers =
            [Some(wgpu::VertexBufferLayout { attributes: &shadow_attributes, ..limb_buffer })];
        let skin_attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Snorm16x4, 2 => Uint16x4, 3 => Unorm16x4, 4 => Unorm8x4];
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

        let ground_recipe = |label, entry, blend| Recipe {
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
        let line_recipe = |label, depth| Recipe {
            shader: &self.line,
            entries: ["vs_line", "fs_line"],
            buffers: &line_buffers,
            topology: quad,
            depth,
            ..ground_recipe(label, "", Some(OVER))
        };
        let shadow_recipe = |label, shader, layout, entries| Recipe {
            shader,
            layout,
            entries,
            writes: wgpu::ColorWrites::ALPHA,
            topology: quad,
            ..ground_recipe(label, "", Some(DARKEN))
        };
        let limb_recipe = |label, entries, depth, blend, cull| Recipe {
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
        let skin_recipe = |label, entries, depth, blend, cull| Recipe {
            shader: &self.skin,
            layout: &self.skinned,
            buffers: &skin_buffers,
            ..limb_recipe(label, entries, depth, blend, cull)
        };
        let recipe = match brush {
            Brush::Ground => ground_recipe("ground", "fs_ground", None),
            Brush::Shade => ground_recipe("shade", "fs_shade", Some(SHADE)),
            Brush::Shadow => Recipe {
                buffers: &shadow_buffers,
                ..shadow_recipe("shadow", &self.shadow, &self.plain, ["vs_shadow", "fs_shadow"])
            },
            Brush::KeyShadow => shadow_recipe(
                "key shadow",
                &self.key_shadow,
                &self.lit,
                ["vs_key_shadow", "fs_key_shadow"],
            ),
            Brush::Cast => Recipe {
                layout: &self.plain,
                ..limb_recipe("cast", ["vs_cast", ""], (Less, true), None, Back)
            },
            Brush::Ring => Recipe {
                shader: &self.ring,
                entries: ["vs_ring", "fs_ring"],
                buffers: &ring_buffers,
                topology: quad,
                ..ground_recipe("ring", "", Some(OVER))
            },
            Brush::FlatLine => line_recipe("line", None),
            Brush::SpaceLine => line_recipe("line in space", Some((LessEqual, true))),
            Brush::Solid => {
                limb_recipe("limb", ["vs_limb", "fs_solid"], (LessEqual, false), None, Back)
            }
            Brush::Edge => {
                limb_recipe("limb edge", ["vs_edge", "fs_edge"], (Less, true), Some(OVER), Front)
            }
            Brush::Front => Recipe {
                writes: wgpu::ColorWrites::empty(),
                ..limb_recipe("limb front", ["vs_limb", "fs_depth"], (Less, true), None, Back)
            },
            Brush::Ghost => Recipe {
                stencil: once_per_ghost(),
                ..limb_recipe(
                    "ghost",
                    ["vs_limb", "fs_ghost"],
                    (LessEqual, false),
                    Some(OVER),
                    Back,
                )
            },
            Brush::Skin => skin_recipe("skin", ["vs_skin", "fs_skin"], (Less, true), None, Back),
            Brush::SkinEdge => skin_recipe(
                "skin edge",
                ["vs_skin_edge", "fs_skin_edge"],
                (Less, true),
                Some(OVER),
                Front,
            ),
            Brush::SkinFront => Recipe {
                writes: wgpu::ColorWrites::empty(),
                ..skin_recipe("skin front", ["vs_skin", "fs_depth"], (Less, true), None, Back)
            },
            Brush::SkinGhost => Recipe {
                stencil: once_per_ghost(),
                ..skin_recipe(
                    "skin ghost",
                    ["vs_skin", "fs_skin_ghost"],
                    (LessEqual, false),
                    Some(OVER),
                    Back,
                )
            },
            Brush::SkinCast => {
                skin_recipe("skin cast", ["vs_skin_cast", ""], (Less, true), None, Back)
            }
        };
        stage_pipeline(device, &recipe, self.sample_count)
    }
}

/// A recipe without an entry for colours only finds depths, for the light map.
fn stage_pipeline(
    device: &wgpu::Device,
    recipe: &Recipe<'_>,
    sample_count: u32,
) -> wgpu::RenderPipeline {
    let module = recipe.shader.module(device);
    let is_cast = recipe.entries[1].is_empty();
    let targets = [Some(wgpu::ColorTargetState {
        format: COLOR_FORMAT,
        blend: recipe.blend,
        write_mask: recipe.writes,
    })];
    let (compare, write) = recipe.depth.unwrap_or((wgpu::CompareFunction::Always, false));
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(recipe.label),
        layout: Some(recipe.layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(recipe.entries[0]),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: recipe.buffers,
        },
        primitive: wgpu::PrimitiveState {
            topology: recipe.topology,
            cull_mode: recipe.cull,
            ..wgpu::PrimitiveState::default()
        },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: if is_cast { MAP_FORMAT } else { DEPTH_FORMAT },
            depth_write_enabled: Some(write),
            depth_compare: Some(compare),
            stencil: recipe.stencil.clone(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState {
            count: if is_cast { 1 } else { sample_count },
            ..wgpu::MultisampleState::default()
        },
        fragment: (!is_cast).then(|| wgpu::FragmentState {
            module,
            entry_point: Some(recipe.entries[1]),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn composite_pipeline(
    device: &wgpu::Device,
    output_format: wgpu::TextureFormat,
) -> (wgpu::BindGroupLayout, wgpu::RenderPipeline) {
    let group = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("stage composite"),
        entries: &[
            texture_entry(
                0,
                wgpu::ShaderStages::FRAGMENT,
                wgpu::TextureSampleType::Float { filterable: true },
            ),
            sampler_entry(1, wgpu::SamplerBindingType::Filtering),
        ],
    });
    let shader = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("composite"),
        source: wgpu::ShaderSource::Wgsl(COMPOSITE.into()),
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("stage composite"),
        bind_group_layouts: &[Some(&group)],
        immediate_size: 0,
    });
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("stage composite"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &shader,
            entry_point: Some("vs_composite"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        // egui's pass has neither depth nor samples unless the app asks for them.
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &shader,
            entry_point: Some(if output_format.is_srgb() { "fs_linear" } else { "fs_encoded" }),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format: output_format,
                blend: None,
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    });
    (group, pipeline)
}
