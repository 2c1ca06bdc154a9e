//! Rendering of a stage to a picture in memory.

use super::{Refinement, StageRenderer};
use eframe::wgpu;
use flate2::{Compression, Crc, write::ZlibEncoder};
use segue_scene::Stage;
use std::io::Write as _;
use std::sync::mpsc;
use std::time::Duration;

/// A picture: rows from the top, four bytes per pixel (red, green, blue, alpha), sRGB-encoded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Image {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) rgba: Vec<u8>,
}

/// The reason why there is no picture.
#[derive(Debug, thiserror::Error, segue_text::ToMessage)]
pub(crate) enum ImageError {
    /// The size is zero or more than the device can draw.
    #[error(
        "a picture of {0} × {1} pixels cannot be drawn: choose a size from 1 × 1 up to what the graphics card allows"
    )]
    Size(u32, u32),
    /// The device did not return the pixels.
    #[error(
        "the graphics card did not give the picture back ({0}): try again, or reload if the picture on the page is gone too"
    )]
    Device(String),
    /// The picture was not encoded.
    #[error("the picture could not be packed as PNG: {why}", why = .0.to_string())]
    Pack(#[from] std::io::Error),
}

/// The alignment of rows that are copied from a texture, bytes.
const ROW_ALIGNMENT: u32 = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT;
const SNAPSHOT: u64 = u64::MAX;

/// Draws a stage off the screen, and waits for its pixels. Only natively, because a page must not
/// block; it reads its canvas.
pub(crate) fn render_to_image(
    renderer: &mut StageRenderer,
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    stage: &Stage,
    [width, height]: [u32; 2],
) -> Result<Image, ImageError> {
    let largest = device.limits().max_texture_dimension_2d;
    if width == 0 || height == 0 || width > largest || height > largest {
        return Err(ImageError::Size(width, height));
    }
    let mut encoder = device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("stage image") });
    renderer.begin_frame(0.0, Refinement::Now);
    renderer.prepare(device, queue, &mut encoder, SNAPSHOT, stage, [width, height]);
    let Some(view) = renderer.view(SNAPSHOT) else {
        return Err(ImageError::Size(width, height));
    };
    let image = read_texture(device, queue, encoder, &view.targets.color);
    renderer.forget(SNAPSHOT);
    image
}

/// Submits the commands of `encoder`, and waits for the pixels of a texture with four bytes each.
pub(super) fn read_texture(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    mut encoder: wgpu::CommandEncoder,
    texture: &wgpu::Texture,
) -> Result<Image, ImageError> {
    let (width, height) = (texture.width(), texture.height());
    let row = (width * 4).next_multiple_of(ROW_ALIGNMENT);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("stage image"),
        size: u64::from(row) * u64::from(height),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(row),
                rows_per_image: None,
            },
        },
        wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
    );
    let submitted = queue.submit([encoder.finish()]);

    let (sender, receiver) = mpsc::channel();
    buffer.slice(..).map_async(wgpu::MapMode::Read, move |result| {
        // The receiver is gone when the wait below has failed.
        drop(sender.send(result));
    });
    let device_error = |e: &dyn std::fmt::Display| ImageError::Device(e.to_string());
    device
        .poll(wgpu::PollType::Wait {
            submission_index: Some(submitted),
            timeout: Some(Duration::from_mins(3)),
        })
        .map_err(|e| device_error(&e))?;
    receiver.try_recv().map_err(|e| device_error(&e))?.map_err(|e| device_error(&e))?;
    let mapped = buffer.slice(..).get_mapped_range().map_err(|e| device_error(&e))?;
    let rgba = mapped
        .chunks_exact(row as usize)
        .flat_map(|line| line.iter().take(width as usize * 4))
        .copied()
        .collect();
    Ok(Image { width, height, rgba })
}

impl Image {
    /// Returns the colour of a pixel, counted from the top left corner; `None` outside.
    pub(crate) fn pixel(&self, x: u32, y: u32) -> Option<[u8; 4]> {
        let start = (y as usize * self.width as usize + x as usize) * 4;
        (x < self.width).then(|| self.rgba.get(start..start + 4)?.try_into().ok()).flatten()
    }

    /// Returns the picture as a PNG file (ISO/IEC 15948), 8 bits per channel.
    pub(crate) fn to_png(&self) -> Result<Vec<u8>, ImageError> {
        let mut packed = ZlibEncoder::new(Vec::new(), Compression::default());
        let row = self.width as usize * 4;
        for (y, line) in self.rgba.chunks_exact(row.max(1)).enumerate() {
            // The filter "up", the difference from the row above, compresses smooth pictures well.
            packed.write_all(&[if y == 0 { 0 } else { 2 }])?;
            if y == 0 {
                packed.write_all(line)?;
            } else {
                let above = &self.rgba[(y - 1) * row..y * row];
                let difference: Vec<u8> =
                    line.iter().zip(above).map(|(&x, &up)| x.wrapping_sub(up)).collect();
                packed.write_all(&difference)?;
            }
        }
        let data = packed.finish()?;
        let mut png = b"\x89PNG\r\n\x1a\n".to_vec();
        let mut header = Vec::new();
        header.extend(self.width.to_be_bytes());
        header.extend(self.height.to_be_bytes());
        // Depth 8, colour with alpha, deflate, standard filters, no interlacing.
        header.extend([8, 6, 0, 0, 0]);
        for (kind, content) in [(b"IHDR", &header), (b"IDAT", &data), (b"IEND", &Vec::new())] {
            png.extend((content.len() as u32).to_be_bytes());
            let mut crc = Crc::new();
            crc.update(kind);
            crc.update(content);
            png.extend(kind);
            png.extend(content);
            png.extend(crc.sum().to_be_bytes());
        }
        Ok(png)
    }
}
