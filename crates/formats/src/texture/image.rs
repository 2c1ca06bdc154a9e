//! Images of textures: PNG and JPEG, as linear colours.

use crate::encoding::linear;
use png::{ColorType, Decoder, Limits, Transformations};
use std::io::Cursor;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// The greatest number of pixels for each byte of a file: deflate packs a thousand bytes into one.
/// A header that claims more is wrong, and nothing is allocated for it.
const MAX_PIXELS_PER_BYTE: usize = 1024;

/// The greatest side of an image, pixels.
const MAX_SIDE: usize = 8192;

/// An image of 8 bits for each channel, rows from the top.
pub(crate) struct Image {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Red, green and blue, `sRGB`-encoded.
    pixels: Vec<[u8; 3]>,
}

impl Image {
    /// Decodes an image; `has_room` says whether there is memory for so many bytes. Returns `None`
    /// for other formats, and for one that is damaged or too large.
    pub(super) fn decode(bytes: &[u8], has_room: impl FnOnce(usize) -> bool) -> Option<Self> {
        if bytes.starts_with(b"\x89PNG") {
            decode_png(bytes, has_room)
        } else if bytes.starts_with(b"\xff\xd8\xff") {
            decode_jpeg(bytes, has_room)
        } else {
            None
        }
    }

    /// Returns the number of bytes that it takes.
    pub(super) fn bytes(&self) -> usize {
        self.pixels.len() * size_of::<[u8; 3]>()
    }

    /// Returns the linear colour of a pixel.
    pub(super) fn pixel(&self, column: usize, row: usize) -> [f32; 3] {
        let pixel = self.pixels.get(row * self.width + column).copied().unwrap_or([u8::MAX; 3]);
        pixel.map(|channel| linear(f32::from(channel) / 255.0))
    }
}

/// Returns whether an image of this size can be in a file of so many bytes, and is no larger than
/// those that are read.
fn is_plausible(width: usize, height: usize, bytes: usize) -> bool {
    (1..=MAX_SIDE).contains(&width)
        && (1..=MAX_SIDE).contains(&height)
        && width * height <= bytes.saturating_mul(MAX_PIXELS_PER_BYTE)
}

fn decode_png(bytes: &[u8], has_room: impl FnOnce(usize) -> bool) -> Option<Image> {
    let limits = Limits { bytes: bytes.len().saturating_add(1 << 20) };
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_transformations(Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().ok()?;
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    let size = reader.output_buffer_size()?;
    if !is_plausible(width, height, bytes.len()) || !has_room(size + 3 * width * height) {
        return None;
    }
    let mut buffer = vec![0; size];
    let frame = reader.next_frame(&mut buffer).ok()?;
    let pixels: Vec<[u8; 3]> = match frame.color_type {
        ColorType::Grayscale => buffer.iter().map(|&gray| [gray; 3]).collect(),
        ColorType::GrayscaleAlpha => {
            buffer.as_chunks::<2>().0.iter().map(|&[gray, _]| [gray; 3]).collect()
        }
        ColorType::Rgb => buffer.as_chunks::<3>().0.to_vec(),
        ColorType::Rgba => {
            buffer.as_chunks::<4>().0.iter().map(|&[r, g, b, _]| [r, g, b]).collect()
        }
        ColorType::Indexed => return None,
    };
    (pixels.len() == width * height).then_some(Image { width, height, pixels })
}

fn decode_jpeg(bytes: &[u8], has_room: impl FnOnce(usize) -> bool) -> Option<Image> {
    let options = DecoderOptions::default()
        .set_max_width(MAX_SIDE)
        .set_max_height(MAX_SIDE)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().ok()?;
    let (width, height) = decoder.dimensions()?;
    // The decoder keeps coefficients of 16 bits for the whole of a progressive image.
    if !is_plausible(width, height, bytes.len()) || !has_room(12 * width * height) {
        return None;
    }
    let buffer = decoder.decode().ok()?;
    let pixels = buffer.as_chunks::<3>().0.to_vec();
    (pixels.len() == width * height).then_some(Image { width, height, pixels })
}
