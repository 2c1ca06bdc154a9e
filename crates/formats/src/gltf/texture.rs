//! Colours of vertices: base colour factors, colours in the file, and base colour textures, of
//! which each vertex takes the colour at its place.

use super::document::Document;
use crate::encoding::encoded;
use crate::texture::{Images, Sampler, TextureUse, Wrap};
use gltf::json::Material;
use gltf::json::accessor::Type;
use gltf::json::material::PbrBaseColorFactor;
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::texture::{Info, MagFilter, WrappingMode};
use gltf::json::validation::Checked;

/// The colours of a primitive, and what became of its texture.
pub(super) struct Colors {
    /// One for each vertex: `sRGB`-encoded, with straight alpha.
    pub(super) of_vertices: Vec<[f32; 4]>,
    pub(super) texture: TextureUse,
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
    let source = texture.source.value();
    let image = images.get(source, || document.image(source), |bytes| document.has_room(bytes))?;
    let sampler = texture.sampler.and_then(|index| document.root.get(index));
    let sampler = sampler.map_or_else(Sampler::default, sampler_of);
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
            sampler.color(&image, [du + cos * u + sin * v, dv - sin * u + cos * v])
        };
        coordinates.iter().map(texel).collect()
    })
}

fn sampler_of(sampler: &gltf::json::texture::Sampler) -> Sampler {
    let wrap = |mode: Checked<WrappingMode>| match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Wrap::Repeat,
    };
    Sampler {
        wraps: [wrap(sampler.wrap_s), wrap(sampler.wrap_t)],
        is_nearest: sampler.mag_filter == Some(Checked::Valid(MagFilter::Nearest)),
    }
}
