//! The textures that a stage is drawn into.

use super::layout::{COLOR_FORMAT, DEPTH_FORMAT};
use super::pipelines::Pipelines;
use eframe::wgpu;

/// The textures that a stage is drawn into.
pub(super) struct Targets {
    pub(super) size: [u32; 2],
    /// The finished picture.
    #[cfg(test)]
    pub(super) color: wgpu::Texture,
    pub(super) color_view: wgpu::TextureView,
    /// The multisampled colours; `None` where the device has one sample per pixel.
    pub(super) samples: Option<wgpu::TextureView>,
    pub(super) depth: wgpu::TextureView,
    /// The bind group that the page samples the finished picture with.
    pub(super) composite: wgpu::BindGroup,
}

impl Targets {
    pub(super) fn new(device: &wgpu::Device, pipelines: &Pipelines, size: [u32; 2]) -> Self {
        let sample_count = pipelines.sample_count;
        let texture = |label, format, sample_count, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d {
                    width: size[0].max(1),
                    height: size[1].max(1),
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        let attachment = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let color = texture(
            "stage",
            COLOR_FORMAT,
            1,
            attachment | wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC,
        );
        let color_view = color.create_view(&wgpu::TextureViewDescriptor::default());
        let view =
            |texture: wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let samples = (sample_count > 1)
            .then(|| view(texture("stage samples", COLOR_FORMAT, sample_count, attachment)));
        let depth = view(texture("stage depth", DEPTH_FORMAT, sample_count, attachment));
        let composite = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("stage composite"),
            layout: &pipelines.composite_layout,
            entries: &[
                wgpu::BindGroupEntry {
                    binding: 0,
                    resource: wgpu::BindingResource::TextureView(&color_view),
                },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::Sampler(&pipelines.composite_sampler),
                },
            ],
        });
        Self {
            size,
            #[cfg(test)]
            color,
            color_view,
            samples,
            depth,
            composite,
        }
    }
}
