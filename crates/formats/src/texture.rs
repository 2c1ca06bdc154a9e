//! Base colour textures, of which each vertex takes the colour at its place: decoded images, and
//! how they are looked up.

mod image;

pub(crate) use image::Image;

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::rc::Rc;

/// The greatest size of all decoded images of a character together, bytes; beyond it they are
/// decoded again where they are needed.
const MAX_KEPT_BYTES: usize = 96 << 20;

/// The greatest size of all images that are decoded for a character, bytes, those that are decoded
/// again included: it bounds the time.
const MAX_DECODED_BYTES: usize = 1 << 30;

/// The decoded images of a file. An image that cannot be decoded is `None`.
#[derive(Default)]
pub(crate) struct Images {
    decoded: BTreeMap<usize, Option<Rc<Image>>>,
    /// The bytes of these images.
    bytes: usize,
    /// The bytes of all images that were decoded.
    total: usize,
}

impl Images {
    /// Returns an image by its number in the file; `None` if it cannot be decoded. `content`
    /// returns its bytes, and `has_room` whether there is memory for so many bytes.
    pub(crate) fn get<'a>(
        &mut self,
        index: usize,
        content: impl FnOnce() -> Option<Cow<'a, [u8]>>,
        has_room: impl Fn(usize) -> bool,
    ) -> Option<Rc<Image>> {
        if let Some(known) = self.decoded.get(&index) {
            return known.clone();
        }
        let is_allowed = |size: usize| self.total < MAX_DECODED_BYTES && has_room(size);
        let image = content().and_then(|bytes| Image::decode(&bytes, is_allowed)).map(Rc::new);
        let size = image.as_ref().map_or(0, |image| image.bytes());
        if self.bytes.saturating_add(size) > MAX_KEPT_BYTES {
            self.decoded.clear();
            self.bytes = 0;
        }
        self.bytes += size;
        self.total = self.total.saturating_add(size);
        self.decoded.insert(index, image.clone());
        image
    }
}

/// The use of a base colour texture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum TextureUse {
    /// There is none.
    #[default]
    None,
    /// Each vertex has its colour at the vertex's place.
    AtVertices,
    /// It cannot be read.
    Missing,
}

/// What is beyond the edges of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wrap {
    /// The colour of the edge.
    Clamp,
    /// The image again.
    Repeat,
    /// The image again, mirrored.
    Mirror,
}

/// The way in which an image is looked up.
pub(crate) struct Sampler {
    /// Across and down.
    pub(crate) wraps: [Wrap; 2],
    /// Whether the nearest texel counts alone; otherwise the four around a place are mixed.
    pub(crate) is_nearest: bool,
}

impl Default for Sampler {
    /// The image repeats, and texels are mixed.
    fn default() -> Self {
        Self { wraps: [Wrap::Repeat; 2], is_nearest: false }
    }
}

impl Sampler {
    /// Returns the linear colour at texture coordinates: (0, 0) is the upper left corner of the
    /// image, (1, 1) its lower right one.
    pub(crate) fn color(&self, image: &Image, [u, v]: [f32; 2]) -> [f32; 3] {
        let across = Texels::of(u, image.width, self.wraps[0], self.is_nearest);
        let down = Texels::of(v, image.height, self.wraps[1], self.is_nearest);
        let mut color = [0.0; 3];
        for (row, of_row) in [(down.first, 1.0 - down.share), (down.next, down.share)] {
            for (column, of_column) in
                [(across.first, 1.0 - across.share), (across.next, across.share)]
            {
                let texel = image.pixel(column, row);
                for (sum, channel) in color.iter_mut().zip(texel) {
                    *sum += channel * of_row * of_column;
                }
            }
        }
        color
    }
}

/// Two neighbouring texels along one axis, and the share of the second.
struct Texels {
    first: usize,
    next: usize,
    share: f32,
}

impl Texels {
    fn of(coordinate: f32, size: usize, wrap: Wrap, is_nearest: bool) -> Self {
        // Coordinates this large have no fraction in single precision.
        let coordinate =
            if coordinate.abs() < 1e6 { f64::from(coordinate) } else { 0.0 } * size as f64;
        let wrapped = |texel: f64| {
            let size = size as f64;
            let texel = match wrap {
                Wrap::Clamp => texel,
                Wrap::Repeat => texel.rem_euclid(size),
                Wrap::Mirror => {
                    let there = texel.rem_euclid(2.0 * size);
                    if there < size { there } else { 2.0 * size - 1.0 - there }
                }
            };
            texel.clamp(0.0, size - 1.0) as usize
        };
        if is_nearest {
            let texel = wrapped(coordinate.floor());
            return Self { first: texel, next: texel, share: 0.0 };
        }
        // Texels have their colours at their centres.
        let first = (coordinate - 0.5).floor();
        Self {
            first: wrapped(first),
            next: wrapped(first + 1.0),
            share: (coordinate - 0.5 - first) as f32,
        }
    }
}
