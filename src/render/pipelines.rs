//! The render pipelines of a device.

mod composite;
mod layouts;
pub(super) mod shaders;
mod stage;

use super::layout::{FigureUniform, ViewUniform};
use composite::composite_pipeline;
use eframe::wgpu;
use layouts::{body_texture_layout, light_layout, texture_entry, uniform_layout};
use shaders::{GROUND, KEY_SHADOW, LIMB, LINE, RING, SHADOW, SKIN, Shader};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering};
use wgpu::CompareFunction::LessEqual;

/// A pipeline of a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PipelineKind {
    Ground,
    Shadow,
    Shade,
    Ring,
    /// Lines on the ground and over everything, without depth.
    FlatLine,
    SpaceLine,
    Solid,
    Edge,
    /// The depths of limbs' front faces, without colours.
    Front,
    Ghost,
    /// Limbs in the light map.
    Cast,
    /// The main light's shadow on the ground, by the light map.
    KeyShadow,
    /// Solid bodies in skins.
    Skin,
    SkinEdge,
    /// Parts of solid bodies of which a texture cuts out something.
    SkinCutOut,
    SkinEdgeCutOut,
    SkinFront,
    SkinGhost,
    /// Bodies in skins in the light map.
    SkinCast,
}

impl PipelineKind {
    /// All pipelines, in order of importance.
    const ALL: [Self; 19] = [
        Self::Ground,
        Self::Skin,
        Self::Front,
        Self::Solid,
        Self::SkinCutOut,
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
        Self::SkinEdgeCutOut,
        Self::Edge,
        Self::SpaceLine,
        Self::Ring,
    ];

    /// Returns whether no picture can be drawn without it.
    const fn is_essential(self) -> bool {
        matches!(self, Self::Ground | Self::Front | Self::Solid | Self::Skin)
    }
}

/// The pipelines of a device. WebGL takes long to make one, so the first picture is drawn with the
/// essential ones, and the others are made one in a frame: in software, where a frame takes longer
/// than all of them, in one.
pub(super) struct Pipelines {
    device: wgpu::Device,
    pub(super) view_layout: wgpu::BindGroupLayout,
    pub(super) figure_layout: wgpu::BindGroupLayout,
    pub(super) joints_layout: wgpu::BindGroupLayout,
    pub(super) light_layout: wgpu::BindGroupLayout,
    pub(super) texture_layout: wgpu::BindGroupLayout,
    pub(super) light_compare: wgpu::Sampler,
    pub(super) light_exactly: wgpu::Sampler,
    pub(super) composite_layout: wgpu::BindGroupLayout,
    pub(super) composite_sampler: wgpu::Sampler,
    pub(super) composite: wgpu::RenderPipeline,
    pub(super) sample_count: u32,
    /// The layout for the ground, lines and rings.
    plain: wgpu::PipelineLayout,
    /// The layout for the main light's shadow on the ground.
    lit: wgpu::PipelineLayout,
    /// The layout for bodies of limbs.
    bodily: wgpu::PipelineLayout,
    /// The layout for bodies in skins.
    skinned: wgpu::PipelineLayout,
    limb: Shader,
    skin: Shader,
    shadow: Shader,
    key_shadow: Shader,
    ground: Shader,
    line: Shader,
    ring: Shader,
    stage: [OnceLock<wgpu::RenderPipeline>; PipelineKind::ALL.len()],
    /// The pipelines that were requested and are not made yet, a bit for each.
    requested: AtomicU32,
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
        let texture_layout = body_texture_layout(device);
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
                &[
                    Some(&view_layout),
                    Some(&light_layout),
                    Some(&joints_layout),
                    Some(&texture_layout),
                ],
            ),
            limb: Shader::new("limb", LIMB),
            skin: Shader::new("skin", SKIN),
            shadow: Shader::new("shadow", SHADOW),
            key_shadow: Shader::new("key shadow", KEY_SHADOW),
            ground: Shader::new("ground", GROUND),
            line: Shader::new("line", LINE),
            ring: Shader::new("ring", RING),
            stage: std::array::from_fn(|_| OnceLock::new()),
            requested: AtomicU32::new(0),
            view_layout,
            figure_layout,
            joints_layout,
            light_layout,
            texture_layout,
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

    /// Returns a pipeline. On the web, it is `None` for one that is not essential and not made yet,
    /// which is then requested. Natively, making one takes negligible time.
    pub(super) fn get(&self, kind: PipelineKind) -> Option<&wgpu::RenderPipeline> {
        let slot = &self.stage[kind as usize];
        if kind.is_essential() || cfg!(not(target_arch = "wasm32")) {
            return Some(slot.get_or_init(|| self.make(kind)));
        }
        if slot.get().is_none() {
            self.requested.fetch_or(1 << kind as u32, Ordering::Relaxed);
        }
        slot.get()
    }

    /// Makes the most important of the requested pipelines. Returns `false` where there is none.
    pub(super) fn make_next(&self) -> bool {
        let requested = self.requested.load(Ordering::Relaxed);
        let Some(&kind) = PipelineKind::ALL.iter().find(|&&kind| requested & 1 << kind as u32 != 0)
        else {
            return false;
        };
        self.stage[kind as usize].get_or_init(|| self.make(kind));
        self.requested.fetch_and(!(1 << kind as u32), Ordering::Relaxed);
        true
    }
}
