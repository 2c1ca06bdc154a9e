//! Colours of vertices: base colour factors, colours in the file, and base colour textures, of
//! which each vertex takes the colour at its place.

use super::document::Document;
use super::image::Image;
use crate::encoding::encoded;
use gltf::json::Material;
use gltf::json::accessor::Type;
use gltf::json::material::PbrBaseColorFactor;
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::texture::{Info, MagFilter, Sampler, WrappingMode};
use gltf::json::validation::Checked;
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
pub(super) struct Images {
    decoded: BTreeMap<usize, Option<Rc<Image>>>,
    /// The bytes of these images.
    bytes: usize,
    /// The bytes of all images that were decoded.
    total: usize,
}

impl Images {
    fn get(&mut self, document: &Document<'_>, index: usize) -> Option<Rc<Image>> {
        if let Some(known) = self.decoded.get(&index) {
            return known.clone();
        }
        let is_allowed = |size: usize| self.total < MAX_DECODED_BYTES && document.has_room(size);
        let image = document.image(index).and_then(|bytes| Image::decode(&bytes, is_allowed));
        let image = image.map(Rc::new);
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

/// The colours of a primitive, and what became of its texture.
pub(super) struct Colors {
    /// One for each vertex: `sRGB`-encoded, with straight alpha.
    pub(super) of_vertices: Vec<[f32; 4]>,
    pub(super) texture: TextureUse,
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

/// Returns the colours of a primitive's `count` vertices: the product of factor, texture and
/// colours in the file (section 3.9.2 of the specification), in linear light.
pub(super) fn colors(
    document: &Document<'_>,
    primitive: &Primitive,
    count: usize,
    images: &mut Images,
) -> Colors {
    let material: Option<&Material> = primitive.material.and_then(|index| document.root.get(index));
    let surface = material.map(|material| &material.pbr_metallic_roughness);
    let PbrBaseColorFactor(factor) =
        surface.map_or_else(PbrBaseColorFactor::default, |surface| surface.base_color_factor);
    let info = surface.and_then(|surface| surface.base_color_texture.as_ref());
    let sampled = info.map(|info| sampled(document, primitive, info, count, images));
    let own = vertex_colors(document, primitive, count);
    let of_vertex = |vertex: usize| {
        let texel = match &sampled {
            Some(Some(texels)) => texels.get(vertex).copied().unwrap_or([1.0; 3]),
            _ => [1.0; 3],
        };
        let [r, g, b, a] =
            own.as_ref().and_then(|own| own.get(vertex)).copied().unwrap_or([1.0; 4]);
        let color = [r * texel[0], g * texel[1], b * texel[2]];
        let alpha = a * factor[3];
        [
            encoded(color[0] * factor[0]),
            encoded(color[1] * factor[1]),
            encoded(color[2] * factor[2]),
            if alpha.is_finite() { alpha.clamp(0.0, 1.0) } else { 1.0 },
        ]
    };
    Colors {
        of_vertices: (0..count).map(of_vertex).collect(),
        texture: match sampled {
            None => TextureUse::None,
            Some(Some(_)) => TextureUse::AtVertices,
            Some(None) => TextureUse::Missing,
        },
    }
}

/// Returns the colours that a primitive has itself (`COLOR_0`), with alpha 1 where it has none.
fn vertex_colors(
    document: &Document<'_>,
    primitive: &Primitive,
    count: usize,
) -> Option<Vec<[f32; 4]>> {
    let index = *primitive.attributes.get(&Checked::Valid(Semantic::Colors(0)))?;
    let colors: Vec<[f32; 4]> = match document.root.get(index)?.type_ {
        Checked::Valid(Type::Vec3) => {
            let values = document.floats(index, Type::Vec3).ok()?;
            values.as_chunks::<3>().0.iter().map(|&[r, g, b]| [r, g, b, 1.0]).collect()
        }
        _ => document.floats(index, Type::Vec4).ok()?.as_chunks::<4>().0.to_vec(),
    };
    (colors.len() == count).then_some(colors)
}

/// Returns the linear colour of a texture at each vertex; `None` where image or coordinates cannot
/// be read.
fn sampled(
    document: &Document<'_>,
    primitive: &Primitive,
    info: &Info,
    count: usize,
    images: &mut Images,
) -> Option<Vec<[f32; 3]>> {
    let transform = info.extensions.as_ref().and_then(|own| own.texture_transform.as_ref());
    let set = transform.and_then(|own| own.tex_coord).unwrap_or(info.tex_coord);
    let index = *primitive.attributes.get(&Checked::Valid(Semantic::TexCoords(set)))?;
    // Not normalised integers are plain values (`KHR_mesh_quantization`).
    let coordinates = document.lengths(index, Type::Vec2).ok()?;
    let texture = document.root.get(info.index)?;
    let image = images.get(document, texture.source.value())?;
    let way = Way::of(texture.sampler.and_then(|index| document.root.get(index)));
    let (cos, sin, [du, dv], [su, sv]) = match transform {
        Some(own) => {
            (libm::cosf(own.rotation.0), libm::sinf(own.rotation.0), own.offset.0, own.scale.0)
        }
        None => (1.0, 0.0, [0.0; 2], [1.0; 2]),
    };
    let coordinates = coordinates.as_chunks::<2>().0;
    (coordinates.len() == count).then(|| {
        let texel = |&[u, v]: &[f32; 2]| {
            // Offset · rotation · scale; v points down.
            let (u, v) = (su * u, sv * v);
            way.color(&image, [du + cos * u + sin * v, dv - sin * u + cos * v])
        };
        coordinates.iter().map(texel).collect()
    })
}

/// The way in which an image is looked up.
struct Way {
    wraps: [WrappingMode; 2],
    is_nearest: bool,
}

impl Way {
    fn of(sampler: Option<&Sampler>) -> Self {
        let mode = |mode: Checked<WrappingMode>| match mode {
            Checked::Valid(mode) => mode,
            Checked::Invalid => WrappingMode::Repeat,
        };
        sampler.map_or(Self { wraps: [WrappingMode::Repeat; 2], is_nearest: false }, |sampler| {
            Self {
                wraps: [mode(sampler.wrap_s), mode(sampler.wrap_t)],
                is_nearest: sampler.mag_filter == Some(Checked::Valid(MagFilter::Nearest)),
            }
        })
    }

    /// Returns the linear colour at texture coordinates: (0, 0) is the upper left corner of the
    /// image, (1, 1) its lower right one.
    fn color(&self, image: &Image, [u, v]: [f32; 2]) -> [f32; 3] {
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
    fn of(coordinate: f32, size: usize, wrap: WrappingMode, is_nearest: bool) -> Self {
        // Coordinates this large have no fraction in single precision.
        let coordinate =
            if coordinate.abs() < 1e6 { f64::from(coordinate) } else { 0.0 } * size as f64;
        let wrapped = |texel: f64| {
            let size = size as f64;
            let texel = match wrap {
                WrappingMode::ClampToEdge => texel,
                WrappingMode::Repeat => texel.rem_euclid(size),
                WrappingMode::MirroredRepeat => {
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
