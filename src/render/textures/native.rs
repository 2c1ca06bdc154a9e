//! Decoding of images in a desktop window.

use super::{count_levels, fitting, size_of_level, write_level};
use eframe::wgpu;
use image::imageops::{FilterType, resize};
use image::{ImageFormat, RgbaImage};
use std::sync::Arc;

/// A decoded image in the sizes in which it is looked up, each half of the one before.
pub(super) struct DecodedImage(Vec<RgbaImage>);

impl DecodedImage {
    /// Returns the width and height of the first level, pixels.
    pub(super) fn size(&self) -> [u32; 2] {
        self.0.first().map_or([1; 2], |image| image.dimensions().into())
    }

    /// Returns the number of levels.
    pub(super) fn count(&self) -> u32 {
        self.0.len() as u32
    }

    /// Writes all levels into a texture.
    pub(super) fn write(&self, queue: &wgpu::Queue, texture: &wgpu::Texture) {
        for (level, image) in (0..).zip(&self.0) {
            write_level(queue, texture, level, image.dimensions().into(), image);
        }
    }
}

/// Decodes an image with sides of at most `most` pixels, and hands it over at once; `None` for one
/// that is damaged.
pub(super) fn decode(image: &Arc<[u8]>, most: u32, then: impl FnOnce(Option<DecodedImage>)) {
    let formats = [ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::WebP];
    let format = image::guess_format(image).ok().filter(|format| formats.contains(format));
    let decoded = format.and_then(|format| image::load_from_memory_with_format(image, format).ok());
    then(decoded.map(|decoded| {
        let decoded = decoded.into_rgba8();
        let own = decoded.dimensions().into();
        let size = fitting(own, most);
        let mut levels = vec![if size == own { decoded } else { resized(&decoded, size) }];
        for level in 1..count_levels(size) {
            levels.extend(levels.last().map(|last| resized(last, size_of_level(size, level))));
        }
        DecodedImage(levels)
    }));
}

fn resized(image: &RgbaImage, [width, height]: [u32; 2]) -> RgbaImage {
    resize(image, width, height, FilterType::Triangle)
}
