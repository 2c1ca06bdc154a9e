//! Images of base colour textures: whether they can be shown. Nothing of them is decoded here.

use imagesize::ImageType;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The greatest number of pixels of all images of a file: decoded, they take a gigabyte.
const MAX_PIXELS: usize = 1 << 28;

/// The greatest side of an image, pixels.
const MAX_SIDE: usize = 8192;

/// The end of a PNG: its last chunk, which is empty.
const PNG_END: &[u8] = b"IEND";

/// The bytes of an image, wherever they are.
pub(crate) enum ImageBytes<'a> {
    /// In the file.
    Inside(&'a [u8]),
    /// Decoded from a data URI.
    Decoded(Vec<u8>),
    /// Beside the file.
    Beside(Arc<[u8]>),
}

impl AsRef<[u8]> for ImageBytes<'_> {
    fn as_ref(&self) -> &[u8] {
        match self {
            Self::Inside(bytes) => bytes,
            Self::Decoded(bytes) => bytes,
            Self::Beside(bytes) => bytes,
        }
    }
}

impl From<ImageBytes<'_>> for Arc<[u8]> {
    fn from(bytes: ImageBytes<'_>) -> Self {
        match bytes {
            ImageBytes::Inside(bytes) => bytes.into(),
            ImageBytes::Decoded(bytes) => bytes.into(),
            ImageBytes::Beside(bytes) => bytes,
        }
    }
}

/// The images of a file that its meshes show. One that cannot be shown is `None`.
pub(crate) struct Images {
    known: BTreeMap<usize, Option<Arc<[u8]>>>,
    bytes_left: usize,
    pixels_left: usize,
}

impl Images {
    /// Returns the images of a file for which at most so many bytes may be allocated.
    pub(crate) fn new(max_bytes: usize) -> Self {
        Self { known: BTreeMap::new(), bytes_left: max_bytes, pixels_left: MAX_PIXELS }
    }

    /// Returns an image by its number in the file; `None` if it cannot be shown, or if there is no
    /// room for it. `content` returns its bytes.
    pub(crate) fn get<'a>(
        &mut self,
        index: usize,
        content: impl FnOnce() -> Option<ImageBytes<'a>>,
    ) -> Option<Arc<[u8]>> {
        if let Some(known) = self.known.get(&index) {
            return known.clone();
        }
        let image = content().filter(|image| self.makes_room(image.as_ref())).map(Arc::from);
        self.known.insert(index, image.clone());
        image
    }

    /// Counts an image, if it can be shown and there is room for it.
    fn makes_room(&mut self, image: &[u8]) -> bool {
        let left = pixels(image).and_then(|pixels| {
            Some((self.bytes_left.checked_sub(image.len())?, self.pixels_left.checked_sub(pixels)?))
        });
        (self.bytes_left, self.pixels_left) = left.unwrap_or((self.bytes_left, self.pixels_left));
        left.is_some()
    }
}

/// Returns the number of pixels of an image that browsers show and that `.glb` files hold: a PNG,
/// JPEG or WebP that is whole; `None` for other bytes.
fn pixels(bytes: &[u8]) -> Option<usize> {
    let is_whole = match imagesize::image_type(bytes).ok()? {
        ImageType::Png => memchr::memmem::rfind(bytes, PNG_END).is_some(),
        // Browsers show a JPEG that is cut off, and fill the missing rows with grey.
        ImageType::Jpeg => true,
        // RIFF: four letters and the number of bytes behind them.
        ImageType::Webp => {
            let size = u32::from_le_bytes(*bytes.get(4..)?.first_chunk()?);
            size as usize <= bytes.len() - 8
        }
        _ => false,
    };
    let size = imagesize::blob_size(bytes).ok().filter(|_| is_whole)?;
    let sides = [size.width, size.height];
    sides.iter().all(|side| (1..=MAX_SIDE).contains(side)).then(|| size.width * size.height)
}

/// Returns a texture coordinate, or 0 for one that is too large to find a texel, or no number.
pub(crate) fn coordinate(number: f32) -> f32 {
    if number.abs() < 1e6 { number } else { 0.0 }
}

/// Returns the media type of an image that was read here.
pub(crate) fn media_type(image: &[u8]) -> &'static str {
    match imagesize::image_type(image) {
        Ok(ImageType::Jpeg) => "image/jpeg",
        Ok(ImageType::Webp) => WEBP,
        _ => "image/png",
    }
}

/// The media type of WebP, which glTF has by an extension.
pub(crate) const WEBP: &str = "image/webp";
