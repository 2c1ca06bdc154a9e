//! Base colour textures of bodies on the device. The platform decodes their images: in a browser,
//! beside the page's thread.

#[cfg(not(target_arch = "wasm32"))]
mod native;
#[cfg(target_arch = "wasm32")]
mod web;

#[cfg(not(target_arch = "wasm32"))]
use native::{DecodedImage, decode};
#[cfg(target_arch = "wasm32")]
use web::{DecodedImage, decode};

use super::pipelines::Pipelines;
use eframe::wgpu;
use segue_motion::skin::{Sampler, Texture, Wrap};
use std::sync::{Arc, OnceLock, Weak};

/// The greatest side of an image on the device, pixels.
const MAX_SIDE: u32 = 2048;

/// The greatest number of texels of all images of a mesh: 64 MB, and a third more for the smaller
/// levels.
const MAX_TEXELS: u32 = 4096 * 4096;

/// The format of images: the device mixes their texels in linear light.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// A texture that is bound once its image is decoded.
pub(super) type BoundTexture = Arc<OnceLock<wgpu::BindGroup>>;

/// Returns the greatest side of each image of a mesh with so many of them.
fn max_side(images: usize) -> u32 {
    let fits = |side: &u32| images as u64 * u64::from(side * side) <= u64::from(MAX_TEXELS);
    let mut sides = std::iter::successors(Some(MAX_SIDE), |side| (*side > 1).then_some(side / 2));
    sides.find(fits).unwrap_or(1)
}

/// Returns the size of a level.
fn size_of_level(size: [u32; 2], level: u32) -> [u32; 2] {
    size.map(|side| (side >> level).max(1))
}

/// Returns the size of an image whose sides are no longer than `most` pixels.
fn fitting([width, height]: [u32; 2], most: u32) -> [u32; 2] {
    let longest = width.max(height).max(most);
    [width, height]
        .map(|side| (u64::from(side) * u64::from(most) / u64::from(longest)) as u32)
        .map(|side| side.max(1))
}

/// Returns the number of levels down to a single texel.
fn count_levels([width, height]: [u32; 2]) -> u32 {
    width.max(height).max(1).ilog2() + 1
}

/// The textures of all meshes on the device, while these exist.
#[derive(Default)]
pub(super) struct TextureStore {
    /// The one of everything without a texture.
    white: Option<wgpu::BindGroup>,
    loaded: Vec<Loaded>,
}

/// A texture on the device.
struct Loaded {
    image: Weak<[u8]>,
    sampler: Sampler,
    bound: Weak<OnceLock<wgpu::BindGroup>>,
}

impl TextureStore {
    /// Prepares for new meshes: makes the white texture, and drops those that no mesh has any more.
    pub(super) fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pipelines: &Pipelines,
    ) {
        self.loaded.retain(|loaded| loaded.bound.strong_count() > 0);
        self.white.get_or_insert_with(|| white(device, queue, pipelines));
    }

    /// Returns the texture of everything without one.
    pub(super) fn white(&self) -> Option<&wgpu::BindGroup> {
        self.white.as_ref()
    }

    /// Returns a texture, of a mesh with `count` images, which is bound as soon as its image is
    /// decoded. Where it cannot be, white takes its place.
    pub(super) fn load(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pipelines: &Pipelines,
        texture: &Texture,
        count: usize,
    ) -> BoundTexture {
        let known = self.loaded.iter().find(|loaded| {
            std::ptr::addr_eq(loaded.image.as_ptr(), Arc::as_ptr(&texture.image))
                && loaded.sampler == texture.sampler
        });
        if let Some(bound) = known.and_then(|loaded| loaded.bound.upgrade()) {
            return bound;
        }
        let bound = BoundTexture::default();
        let (sampler, white) = (sampler(device, texture.sampler), self.white.clone());
        let (device, queue) = (device.clone(), queue.clone());
        let (layout, later) = (pipelines.texture_layout.clone(), Arc::downgrade(&bound));
        decode(&texture.image, max_side(count), move |levels| {
            let Some(bound) = later.upgrade() else { return };
            let group = if let Some(levels) = levels {
                Some(upload(&device, &queue, (&layout, &sampler), &levels))
            } else {
                log::warn!("the image of a texture cannot be decoded");
                white
            };
            if let Some(group) = group {
                bound.get_or_init(|| group);
            }
        });
        self.loaded.push(Loaded {
            image: Arc::downgrade(&texture.image),
            sampler: texture.sampler,
            bound: Arc::downgrade(&bound),
        });
        bound
    }
}

/// Makes a sampler that looks an image up in that way.
fn sampler(device: &wgpu::Device, wanted: Sampler) -> wgpu::Sampler {
    let [address_mode_u, address_mode_v] = wanted.wraps.map(|wrap| match wrap {
        Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
    });
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("texture"),
        address_mode_u,
        address_mode_v,
        mag_filter: if wanted.is_nearest {
            wgpu::FilterMode::Nearest
        } else {
            wgpu::FilterMode::Linear
        },
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..wgpu::SamplerDescriptor::default()
    })
}

/// Uploads a decoded image.
fn upload(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    (layout, sampler): (&wgpu::BindGroupLayout, &wgpu::Sampler),
    levels: &DecodedImage,
) -> wgpu::BindGroup {
    let texture = empty(device, levels.size(), levels.count());
    levels.write(queue, &texture);
    bind(device, layout, &texture, sampler)
}

/// Makes a texture without content.
fn empty(device: &wgpu::Device, [width, height]: [u32; 2], levels: u32) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some("texture"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: levels,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: FORMAT,
        // Browsers draw decoded images into it.
        usage: wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_DST
            | wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    })
}

fn bind(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    texture: &wgpu::Texture,
    sampler: &wgpu::Sampler,
) -> wgpu::BindGroup {
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("texture"),
        layout,
        entries: &[
            wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(&view),
            },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(sampler) },
        ],
    })
}

/// Makes a texture of one white texel.
fn white(device: &wgpu::Device, queue: &wgpu::Queue, pipelines: &Pipelines) -> wgpu::BindGroup {
    let texture = empty(device, [1; 2], 1);
    write_level(queue, &texture, 0, [1; 2], &[u8::MAX; 4]);
    let sampler = device.create_sampler(&wgpu::SamplerDescriptor::default());
    bind(device, &pipelines.texture_layout, &texture, &sampler)
}

/// Writes the pixels of one level: red, green, blue and alpha, rows from the top.
fn write_level(
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
    level: u32,
    [width, height]: [u32; 2],
    pixels: &[u8],
) {
    queue.write_texture(
        wgpu::TexelCopyTextureInfo { mip_level: level, ..texture.as_image_copy() },
        pixels,
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * width),
            rows_per_image: None,
        },
        wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_fit_and_halve_down_to_a_texel() {
        assert_eq!(fitting([640, 480], 2048), [640, 480]);
        assert_eq!(fitting([8192, 4096], 2048), [2048, 1024]);
        assert_eq!(fitting([3, 6000], 2048), [1, 2048]);
        assert_eq!(
            (count_levels([1, 1]), count_levels([5, 4]), count_levels([2048, 3])),
            (1, 3, 12)
        );
        assert_eq!(size_of_level([5, 1], 1), [2, 1]);
    }

    #[test]
    fn many_images_are_smaller_so_that_all_fit() {
        assert_eq!([1, 4, 5, 16, 17, 1 << 24].map(max_side), [2048, 2048, 1024, 1024, 512, 1]);
    }
}
