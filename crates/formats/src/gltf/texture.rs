//! Base colours of primitives: factors, colours of vertices, and textures.

use super::document::Document;
use crate::encoding::encoded;
use crate::texture::{Images, coordinate};
use gltf::json::Material;
use gltf::json::accessor::Type;
use gltf::json::material::{AlphaMode as GltfAlphaMode, PbrBaseColorFactor};
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::texture::{Info, MagFilter, WrappingMode};
use gltf::json::validation::Checked;
use segue_motion::skin::{AlphaMode, Sampler, Texture, Wrap};
use serde::Deserialize;

/// The opacity below which a point of a mask is left out, where the file states none.
const DEFAULT_CUTOFF: f32 = 0.5;

/// The colours of a primitive.
pub(super) struct Colors {
    /// One for each vertex: `sRGB`-encoded, with straight alpha. A texture is multiplied by them.
    pub(super) of_vertices: Vec<[f32; 4]>,
    pub(super) texture: PlacedTexture,
}

/// The texture of a primitive.
pub(super) enum PlacedTexture {
    /// It has none.
    None,
    /// The texture, and the place of each vertex in it.
    Placed(Texture, Vec<[f32; 2]>),
    /// It cannot be read.
    Missing,
}

/// Returns the colours of a primitive's `count` vertices: the product of factor and colours in the
/// file (section 3.9.2 of the specification), in linear light; and its texture.
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
    let own = vertex_colors(document, primitive, count);
    let of_vertex = |vertex: usize| {
        let [r, g, b, a] =
            own.as_ref().and_then(|own| own.get(vertex)).copied().unwrap_or([1.0; 4]);
        let alpha = a * factor[3];
        [
            encoded(r * factor[0]),
            encoded(g * factor[1]),
            encoded(b * factor[2]),
            if alpha.is_finite() { alpha.clamp(0.0, 1.0) } else { 1.0 },
        ]
    };
    let info = surface.and_then(|surface| surface.base_color_texture.as_ref());
    let texture = match info.zip(material) {
        None => PlacedTexture::None,
        Some((info, material)) => placed(document, primitive, (info, material), count, images)
            .unwrap_or(PlacedTexture::Missing),
    };
    Colors { of_vertices: (0..count).map(of_vertex).collect(), texture }
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

/// Returns the texture of a material, placed on a primitive; `None` where image or coordinates
/// cannot be read.
fn placed(
    document: &Document<'_>,
    primitive: &Primitive,
    (info, material): (&Info, &Material),
    count: usize,
    images: &mut Images,
) -> Option<PlacedTexture> {
    let transform = info.extensions.as_ref().and_then(|own| own.texture_transform.as_ref());
    let set = transform.and_then(|own| own.tex_coord).unwrap_or(info.tex_coord);
    let index = *primitive.attributes.get(&Checked::Valid(Semantic::TexCoords(set)))?;
    // Not normalised integers are plain values (`KHR_mesh_quantization`).
    let coordinates = document.lengths(index, Type::Vec2).ok()?;
    let coordinates = coordinates.as_chunks::<2>().0;
    if coordinates.len() != count {
        return None;
    }
    let texture = document.root.get(info.index)?;
    // An image in WebP comes before the other one.
    let webp = document.webp.source_of(info.index.value());
    let mut image = |source: usize| images.get(source, || document.image(source));
    let image = webp.and_then(&mut image).or_else(|| image(texture.source.value()))?;
    let (cos, sin, [du, dv], [su, sv]) = match transform {
        Some(own) => {
            (libm::cosf(own.rotation.0), libm::sinf(own.rotation.0), own.offset.0, own.scale.0)
        }
        None => (1.0, 0.0, [0.0; 2], [1.0; 2]),
    };
    let place = |&[u, v]: &[f32; 2]| {
        // Offset · rotation · scale; v points down.
        let (u, v) = (su * u, sv * v);
        [du + cos * u + sin * v, dv - sin * u + cos * v].map(coordinate)
    };
    let sampler = texture.sampler.and_then(|index| document.root.get(index));
    let wrap = |mode: Option<Checked<WrappingMode>>| match mode {
        Some(Checked::Valid(WrappingMode::ClampToEdge)) => Wrap::Clamp,
        Some(Checked::Valid(WrappingMode::MirroredRepeat)) => Wrap::Mirror,
        _ => Wrap::Repeat,
    };
    let magnified = sampler.and_then(|sampler| sampler.mag_filter);
    let cutoff = material.alpha_cutoff.map_or(DEFAULT_CUTOFF, |cutoff| cutoff.0);
    let texture = Texture {
        image,
        sampler: Sampler {
            wraps: [sampler.map(|own| own.wrap_s), sampler.map(|own| own.wrap_t)].map(wrap),
            is_nearest: magnified == Some(Checked::Valid(MagFilter::Nearest)),
        },
        alpha: match material.alpha_mode {
            Checked::Valid(GltfAlphaMode::Mask) => AlphaMode::Mask(cutoff.max(0.0)),
            Checked::Valid(GltfAlphaMode::Blend) => AlphaMode::Blend,
            Checked::Valid(GltfAlphaMode::Opaque) | Checked::Invalid => AlphaMode::Opaque,
        },
    };
    Some(PlacedTexture::Placed(texture, coordinates.iter().map(place).collect()))
}

/// The images in WebP of a file's textures (`EXT_texture_webp`).
#[derive(Default, Deserialize)]
pub(super) struct WebpTextures {
    #[serde(default)]
    textures: Vec<WebpTexture>,
}

#[derive(Default, Deserialize)]
struct WebpTexture {
    #[serde(default)]
    extensions: WebpExtensions,
}

#[derive(Default, Deserialize)]
struct WebpExtensions {
    #[serde(rename = "EXT_texture_webp")]
    webp: Option<WebpSource>,
}

#[derive(Deserialize)]
struct WebpSource {
    source: usize,
}

impl WebpTextures {
    /// Returns those of a file, from its JSON; none where they are not as specified.
    pub(super) fn read(json: &[u8]) -> Self {
        let has_any = memchr::memmem::find(json, b"EXT_texture_webp").is_some();
        has_any.then(|| serde_json::from_slice(json).ok()).flatten().unwrap_or_default()
    }

    /// Returns the image of a texture.
    fn source_of(&self, texture: usize) -> Option<usize> {
        Some(self.textures.get(texture)?.extensions.webp.as_ref()?.source)
    }
}
