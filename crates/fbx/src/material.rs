//! Base colours of materials, and the images that show them.

use ufbx::{MaterialMap, Matrix, UvSet, Vec2, Vec3, VertexVec2, WrapMode};

/// A material, as far as it is read.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The base colour without its texture: red, green, blue, opacity, linear.
    pub color: [f32; 4],
    /// The texture that takes the place of the colour.
    pub texture: Option<Texture>,
}

/// A texture of base colours.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// The number of its image ([`Scene::image`](crate::Scene::image)); `None` where it is computed
    /// from something other than an image, or where the mesh does not say which part of the image
    /// it shows.
    pub image: Option<usize>,
    /// The factor of its colours.
    pub factor: f32,
    /// Whether the edge goes on beyond the image, across and down; otherwise the image repeats.
    pub clamps: [bool; 2],
    /// Whether the same image is the material's opacity: its transparent parts are holes.
    pub cuts_out: bool,
}

/// An image that materials show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Image<'a> {
    /// Its file on the machine where the scene was saved, relative to the scene; empty if it is not
    /// stated. Folders are separated as on that machine.
    pub relative_path: &'a str,
    /// The same with all folders.
    pub absolute_path: &'a str,
    /// The image file, if the scene contains it; otherwise empty.
    pub content: &'a [u8],
}

impl Material {
    /// Reads a material; `is_placed` says whether there are coordinates for its texture.
    pub(crate) fn read(material: &ufbx::Material, is_placed: bool) -> Self {
        let (map, factor) = base_color(material);
        let factor = if factor.has_value { factor.value_vec4.x } else { 1.0 };
        let opacity = &material.pbr.opacity;
        let alpha = if opacity.has_value { opacity.value_vec4.x } else { 1.0 };
        let ufbx::Vec4 { x, y, z, .. } = map.value_vec4;
        let color = if map.has_value {
            [x * factor, y * factor, z * factor, alpha].map(|value| value as f32)
        } else {
            [1.0; 4]
        };
        // Autodesk's programs ignore the colour beside a texture, and some of them save black.
        let texture = texture(material).map(|texture| Texture {
            image: file(texture)
                .filter(|file| is_placed && file.has_file)
                .map(|file| file.file_index as usize),
            factor: factor as f32,
            clamps: [texture.wrap_u, texture.wrap_v].map(|wrap| wrap == WrapMode::Clamp),
            cuts_out: opacity_texture(material).and_then(file).is_some_and(|of_opacity| {
                let own = file(texture).filter(|own| own.has_file && of_opacity.has_file);
                own.is_some_and(|own| own.file_index == of_opacity.file_index)
            }),
        });
        Self { color, texture }
    }
}

/// Returns the base colour of a material and its factor.
fn base_color(material: &ufbx::Material) -> (&MaterialMap, &MaterialMap) {
    if material.pbr.base_color.has_value {
        (&material.pbr.base_color, &material.pbr.base_factor)
    } else {
        (&material.fbx.diffuse_color, &material.fbx.diffuse_factor)
    }
}

/// Returns the texture of a material's base colour.
fn texture(material: &ufbx::Material) -> Option<&ufbx::Texture> {
    let maps = [&material.pbr.base_color, &material.fbx.diffuse_color];
    let mut enabled = maps.into_iter().filter(|map| map.texture_enabled);
    enabled.find_map(|map| map.texture.as_deref())
}

/// Returns the texture of a material's opacity.
fn opacity_texture(material: &ufbx::Material) -> Option<&ufbx::Texture> {
    let maps = [&material.pbr.opacity, &material.fbx.transparency_color];
    let mut enabled = maps.into_iter().filter(|map| map.texture_enabled);
    enabled.find_map(|map| map.texture.as_deref())
}

/// Returns the image of a texture; of several layers the lowest.
fn file(texture: &ufbx::Texture) -> Option<&ufbx::Texture> {
    texture.file_textures.into_iter().next()
}

/// The places of a mesh's corners in the texture of a material.
pub(crate) struct Coordinates<'a> {
    of_corners: &'a VertexVec2,
    /// From the coordinates of the mesh to those of the image.
    image_from_mesh: Option<&'a Matrix>,
}

impl<'a> Coordinates<'a> {
    /// Returns the coordinates for a material's texture: those of the set that it names, or of the
    /// first one. `None` if it has no texture, or the mesh no coordinates.
    pub(crate) fn of(mesh: &'a ufbx::Mesh, material: &'a ufbx::Material) -> Option<Self> {
        let texture = texture(material)?;
        let sets: &[UvSet] = mesh.uv_sets.as_ref();
        let named = sets.iter().find(|set| set.name.as_ref() == texture.uv_set.as_ref());
        let of_corners = &named.or(sets.first())?.vertex_uv;
        let image_from_mesh = texture.has_uv_transform.then_some(&texture.uv_to_texture);
        of_corners.exists.then_some(Self { of_corners, image_from_mesh })
    }

    /// Returns the place of a corner in the image.
    pub(crate) fn at(&self, corner: usize) -> [f32; 2] {
        let value = self.of_corners.indices.as_ref().get(corner);
        let value = value.and_then(|&value| self.of_corners.values.as_ref().get(value as usize));
        let Vec2 { x, y } = value.copied().unwrap_or_default();
        let place = Vec3 { x, y, z: 0.0 };
        let Vec3 { x, y, .. } =
            self.image_from_mesh.map_or(place, |matrix| ufbx::transform_position(matrix, place));
        // In the file, v points up.
        [x as f32, (1.0 - y) as f32]
    }
}
