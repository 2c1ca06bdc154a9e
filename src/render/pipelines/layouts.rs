//! Layouts of bind groups.

use eframe::wgpu;

/// Returns the layout of a group with one uniform block at a dynamic offset.
pub(super) fn uniform_layout(
    device: &wgpu::Device,
    label: &str,
    size: usize,
) -> wgpu::BindGroupLayout {
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

/// Returns the layout of the light map: as depths to compare with, and as depths to read.
pub(super) fn light_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let stage = wgpu::ShaderStages::FRAGMENT;
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("light map"),
        entries: &[
            texture_entry(0, stage, wgpu::TextureSampleType::Depth),
            sampler_entry(1, wgpu::SamplerBindingType::Comparison),
            texture_entry(2, stage, wgpu::TextureSampleType::Float { filterable: false }),
            sampler_entry(3, wgpu::SamplerBindingType::NonFiltering),
        ],
    })
}

/// Returns the layout of a texture of a body.
pub(super) fn body_texture_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let stage = wgpu::ShaderStages::FRAGMENT;
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("texture"),
        entries: &[
            texture_entry(0, stage, wgpu::TextureSampleType::Float { filterable: true }),
            sampler_entry(1, wgpu::SamplerBindingType::Filtering),
        ],
    })
}

/// Returns the entry of a texture.
pub(super) fn texture_entry(
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

/// Returns the entry of a sampler.
pub(super) fn sampler_entry(
    binding: u32,
    kind: wgpu::SamplerBindingType,
) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Sampler(kind),
        count: None,
    }
}
