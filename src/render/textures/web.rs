//! Decoding of images in a browser.

use super::{count_levels, fitting, size_of_level};
use eframe::wgpu;
use js_sys::{Array, Uint8Array};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::pin::Pin;
use std::sync::Arc;
use wasm_bindgen::{JsCast as _, JsValue};
use wasm_bindgen_futures::{JsFuture, spawn_local};
use web_sys::{
    Blob, ColorSpaceConversion, ImageBitmap, ImageBitmapOptions, PremultiplyAlpha, ResizeQuality,
    Window,
};

/// A decoded image in the sizes in which it is looked up, each half of the one before.
pub(super) struct DecodedImage(Vec<ImageBitmap>);

impl DecodedImage {
    /// Returns the width and height of the first level, pixels.
    pub(super) fn size(&self) -> [u32; 2] {
        self.0.first().map_or([1; 2], |image| [image.width(), image.height()])
    }

    /// Returns the number of levels.
    pub(super) fn count(&self) -> u32 {
        self.0.len() as u32
    }

    /// Writes all levels into a texture.
    pub(super) fn write(&self, queue: &wgpu::Queue, texture: &wgpu::Texture) {
        for (level, image) in (0..).zip(&self.0) {
            queue.copy_external_image_to_texture(
                &wgpu::CopyExternalImageSourceInfo {
                    source: wgpu::ExternalImageSource::ImageBitmap(image.clone()),
                    origin: wgpu::Origin2d::ZERO,
                    flip_y: false,
                },
                wgpu::CopyExternalImageDestInfo {
                    texture,
                    mip_level: level,
                    origin: wgpu::Origin3d::ZERO,
                    aspect: wgpu::TextureAspect::All,
                    color_space: wgpu::PredefinedColorSpace::Srgb,
                    premultiplied_alpha: false,
                },
                wgpu::Extent3d {
                    width: image.width(),
                    height: image.height(),
                    depth_or_array_layers: 1,
                },
            );
        }
        // WebGL copies with the next submission.
        queue.submit([]);
    }
}

impl Drop for DecodedImage {
    /// Frees the pixels, which are outside of this module's memory.
    fn drop(&mut self) {
        for image in &self.0 {
            image.close();
        }
    }
}

type Task = Pin<Box<dyn Future<Output = ()>>>;

thread_local! {
    /// The images to decode after the present one; `None` while there is none.
    static WAITING: RefCell<Option<VecDeque<Task>>> = const { RefCell::new(None) };
}

/// Runs tasks one after the other: browsers hold the whole of an image that they decode.
fn run_in_turn(task: Task) {
    let task = WAITING.with_borrow_mut(|waiting| {
        if let Some(waiting) = waiting {
            waiting.push_back(task);
            None
        } else {
            *waiting = Some(VecDeque::new());
            Some(task)
        }
    });
    let Some(mut task) = task else { return };
    spawn_local(async move {
        loop {
            task.await;
            let next = WAITING.with_borrow_mut(|waiting| {
                let next = waiting.as_mut().and_then(VecDeque::pop_front);
                if next.is_none() {
                    *waiting = None;
                }
                next
            });
            let Some(next) = next else { return };
            task = next;
        }
    });
}

/// Decodes an image with sides of at most `most` pixels, and hands it over later; `None` for one
/// that is damaged.
pub(super) fn decode(
    image: &Arc<[u8]>,
    most: u32,
    then: impl FnOnce(Option<DecodedImage>) + 'static,
) {
    let image = Arc::clone(image);
    run_in_turn(Box::pin(async move { then(levels(&image, most).await.ok()) }));
}

async fn levels(image: &[u8], most: u32) -> Result<DecodedImage, JsValue> {
    let window = web_sys::window().ok_or(JsValue::NULL)?;
    let options = ImageBitmapOptions::new();
    options.set_premultiply_alpha(PremultiplyAlpha::None);
    options.set_color_space_conversion(ColorSpaceConversion::None);
    let blob = Blob::new_with_u8_array_sequence(&Array::of1(&Uint8Array::from(image)))?;
    let whole: ImageBitmap = JsFuture::from(
        window.create_image_bitmap_with_blob_and_image_bitmap_options(&blob, &options)?,
    )
    .await?
    .dyn_into()?;
    let whole = DecodedImage(vec![whole]);
    let size = fitting(whole.size(), most);
    options.set_resize_quality(ResizeQuality::Medium);
    let mut levels = if size == whole.size() {
        whole
    } else {
        DecodedImage(vec![resized(&window, &whole, size, &options).await?])
    };
    for level in 1..count_levels(size) {
        let smaller = resized(&window, &levels, size_of_level(size, level), &options).await?;
        levels.0.push(smaller);
    }
    Ok(levels)
}

/// Returns the last level in another size.
async fn resized(
    window: &Window,
    levels: &DecodedImage,
    [width, height]: [u32; 2],
    options: &ImageBitmapOptions,
) -> Result<ImageBitmap, JsValue> {
    let last = levels.0.last().ok_or(JsValue::NULL)?;
    options.set_resize_width(width);
    options.set_resize_height(height);
    let resizing =
        window.create_image_bitmap_with_image_bitmap_and_image_bitmap_options(last, options)?;
    let resized: ImageBitmap = JsFuture::from(resizing).await?.dyn_into()?;
    // A browser that does not know the option returns the same size.
    if [resized.width(), resized.height()] == [width, height] {
        Ok(resized)
    } else {
        Err(JsValue::NULL)
    }
}
