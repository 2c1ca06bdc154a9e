//! Base colours of materials, and their textures.

use crate::encoding::encoded;
use crate::gltf::skin::WHITE;
use crate::text::short;
use crate::texture::{ImageBytes, Images};
use crate::warning::WarningKind;
use crate::{Resolve, stem};
use segue_fbx::{Image, Mesh, Scene};
use segue_motion::skin::{AlphaMode, Sampler, Texture, TexturedPart, Wrap};
use std::collections::{BTreeMap, BTreeSet};

/// A mesh with the colours of its vertices.
#[derive(Clone, Debug, Default)]
pub(super) struct PaintedMesh {
    pub(super) mesh: Mesh,
    /// `sRGB`-encoded, with straight alpha.
    pub(super) colors: Vec<[f32; 4]>,
    /// The texture of each material.
    textures: Vec<Option<Texture>>,
    /// What became of its textures.
    pub(super) notes: Vec<WarningKind>,
}

impl PaintedMesh {
    /// Returns the parts of `triangles`, those of the mesh or some of them, with their textures.
    pub(super) fn textured(&self, triangles: &[[u32; 3]]) -> Vec<TexturedPart> {
        let material = |[corner, ..]: &[u32; 3]| self.mesh.material_of.get(*corner as usize);
        let mut parts = Vec::new();
        let mut start = 0;
        for run in triangles.chunk_by(|one, next| material(one) == material(next)) {
            let range = start..start + run.len();
            start = range.end;
            let material = run.first().and_then(material);
            let texture = material.and_then(|own| self.textures.get(*own as usize)?.clone());
            parts.extend(texture.map(|texture| TexturedPart { triangles: range, texture }));
        }
        parts
    }
}

/// The images of a file: those in it, and those beside it.
pub(super) struct Textures<'a> {
    scene: &'a Scene<'a>,
    /// The folder beside the file in which programs put its images: `body.fbm` for `body.fbx`.
    folder: String,
    resolve: Resolve<'a>,
    images: Images,
    /// The images that are neither in the file nor beside it.
    missing: BTreeSet<usize>,
}

impl<'a> Textures<'a> {
    /// Returns the images of the file of that name.
    pub(super) fn new(
        name: &str,
        scene: &'a Scene<'a>,
        resolve: Resolve<'a>,
        max_bytes: usize,
    ) -> Self {
        Self {
            scene,
            folder: format!("{}.fbm", stem(name)),
            resolve,
            images: Images::new(max_bytes),
            missing: BTreeSet::new(),
        }
    }

    /// Returns a mesh with the colours of its vertices, and its textures.
    pub(super) fn painted(&mut self, mesh: Mesh) -> PaintedMesh {
        let mut notes = Vec::new();
        let used: BTreeSet<u32> = mesh.material_of.iter().copied().collect();
        let mut textures = vec![None; mesh.materials.len()];
        for (number, (material, texture)) in (0..).zip(mesh.materials.iter().zip(&mut textures)) {
            if used.contains(&number) {
                *texture = material.texture.as_ref().and_then(|own| self.texture(own, &mut notes));
            }
        }
        let color = |material: &u32| {
            let number = *material as usize;
            let Some(material) = mesh.materials.get(number) else { return WHITE };
            let [r, g, b, alpha] = material.color;
            let alpha = if alpha.is_finite() { alpha.clamp(0.0, 1.0) } else { 1.0 };
            // The texture takes the place of the colour.
            let [r, g, b] = match (&material.texture, textures.get(number)) {
                (Some(texture), Some(Some(_))) => [texture.factor; 3],
                _ => [r, g, b],
            };
            [encoded(r), encoded(g), encoded(b), alpha]
        };
        let of_materials: BTreeMap<u32, [f32; 4]> =
            used.iter().map(|material| (*material, color(material))).collect();
        let of_vertex = |material: &u32| of_materials.get(material).copied().unwrap_or(WHITE);
        let mut colors: Vec<[f32; 4]> = mesh.material_of.iter().map(of_vertex).collect();
        colors.resize(mesh.positions.len(), WHITE);
        PaintedMesh { mesh, colors, textures, notes }
    }

    /// Returns a texture that can be shown, and notes one that cannot.
    fn texture(
        &mut self,
        texture: &segue_fbx::Texture,
        notes: &mut Vec<WarningKind>,
    ) -> Option<Texture> {
        let number = texture.image;
        let image = number.and_then(|number| Some((number, self.scene.image(number)?)));
        let Some((number, file)) = image else {
            notes.push(WarningKind::Textures);
            return None;
        };
        let Self { folder, resolve, missing, images, .. } = self;
        let content = || {
            let content = content(&file, folder, *resolve);
            if content.is_none() {
                missing.insert(number);
            }
            content
        };
        let Some(image) = images.get(number, content) else {
            notes.push(if missing.contains(&number) {
                WarningKind::MissingImage { name: short(base_name(path(&file)).as_bytes()) }
            } else {
                WarningKind::Textures
            });
            return None;
        };
        let wraps = texture.clamps.map(|clamps| if clamps { Wrap::Clamp } else { Wrap::Repeat });
        let alpha = if texture.cuts_out { AlphaMode::Mask(CUTOFF) } else { AlphaMode::Opaque };
        Some(Texture { image, sampler: Sampler { wraps, is_nearest: false }, alpha })
    }
}

/// The opacity below which a point of a texture that cuts out is left out.
const CUTOFF: f32 = 0.5;

/// Returns the image file: of the scene, or else beside it. There it may lie under its relative
/// path, in the folder of the scene's images, or in that of the scene.
fn content<'a>(image: &Image<'a>, folder: &str, resolve: Resolve<'_>) -> Option<ImageBytes<'a>> {
    if !image.content.is_empty() {
        return Some(ImageBytes::Inside(image.content));
    }
    // What is above the folder of the scene is not beside it.
    let relative = image.relative_path.replace('\\', "/");
    let relative = relative.rsplit_once("../").map_or(&*relative, |(_, below)| below);
    let name = base_name(path(image));
    if name.is_empty() {
        return None;
    }
    let paths = [relative, &format!("{folder}/{name}"), name];
    paths.into_iter().find_map(resolve).map(ImageBytes::Beside)
}

/// Returns the path that an image file had.
fn path<'a>(image: &Image<'a>) -> &'a str {
    if image.relative_path.is_empty() { image.absolute_path } else { image.relative_path }
}

/// Returns the name of a file without its folders, which Windows separates by backslashes.
fn base_name(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}
