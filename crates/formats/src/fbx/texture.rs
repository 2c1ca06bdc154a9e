//! Colours of vertices: base colours of materials, and base colour textures, of which each vertex
//! takes the colour at its place.

use crate::encoding::encoded;
use crate::gltf::skin::WHITE;
use crate::text::short;
use crate::texture::{Image as DecodedImage, Images, Sampler, Wrap};
use crate::warning::WarningKind;
use crate::{Resolve, stem};
use segue_fbx::{Image, Mesh, Scene, Texture};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

/// A mesh with the colours of its vertices.
#[derive(Clone, Debug, Default)]
pub(super) struct PaintedMesh {
    pub(super) mesh: Mesh,
    /// `sRGB`-encoded, with straight alpha.
    pub(super) colors: Vec<[f32; 4]>,
    /// What became of its textures.
    pub(super) notes: Vec<WarningKind>,
}

/// The images of a file: those in it, and those beside it.
pub(super) struct Textures<'a> {
    scene: &'a Scene<'a>,
    /// The folder beside the file in which programs put its images: `body.fbm` for `body.fbx`.
    folder: String,
    resolve: Resolve<'a>,
    decoded: Images,
    /// The images that are neither in the file nor beside it.
    missing: BTreeSet<usize>,
    /// The greatest memory for decoding one of them, bytes.
    max_bytes: usize,
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
            decoded: Images::default(),
            missing: BTreeSet::new(),
            max_bytes,
        }
    }

    /// Returns a mesh with the colours of its vertices.
    pub(super) fn painted(&mut self, mesh: Mesh) -> PaintedMesh {
        let mut notes = Vec::new();
        let colors = self.colors(&mesh, &mut notes);
        PaintedMesh { mesh, colors, notes }
    }

    fn colors(&mut self, mesh: &Mesh, notes: &mut Vec<WarningKind>) -> Vec<[f32; 4]> {
        let mut colors = vec![WHITE; mesh.positions.len()];
        let mut vertices: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for (vertex, &material) in (0..).zip(&mesh.material_of) {
            vertices.entry(material).or_default().push(vertex);
        }
        // Material by material, so that one image is in use at a time.
        for (material, vertices) in vertices {
            let Some(material) = mesh.materials.get(material as usize) else { continue };
            let [r, g, b, alpha] = material.color;
            let alpha = if alpha.is_finite() { alpha.clamp(0.0, 1.0) } else { 1.0 };
            let shown = material.texture.as_ref().and_then(|texture| self.shown(texture, notes));
            for vertex in vertices {
                let [r, g, b] = match &shown {
                    Some(shown) => shown.color(mesh.coordinates.get(vertex as usize)),
                    None => [r, g, b],
                };
                if let Some(color) = colors.get_mut(vertex as usize) {
                    *color = [encoded(r), encoded(g), encoded(b), alpha];
                }
            }
        }
        colors
    }

    /// Returns a texture that can be shown, and notes what becomes of it.
    fn shown(&mut self, texture: &Texture, notes: &mut Vec<WarningKind>) -> Option<Shown> {
        let number = texture.image;
        let image = number.and_then(|number| Some((number, self.scene.image(number)?)));
        let Some((number, file)) = image else {
            notes.push(WarningKind::Textures);
            return None;
        };
        let Self { folder, resolve, missing, max_bytes, .. } = self;
        let content = || {
            let content = content(&file, folder, *resolve);
            if content.is_none() {
                missing.insert(number);
            }
            content
        };
        let decoded = self.decoded.get(number, content, |bytes| bytes <= *max_bytes);
        let kind = match &decoded {
            Some(_) => WarningKind::TextureAtVertices,
            None if self.missing.contains(&number) => {
                WarningKind::MissingImage { name: short(base_name(path(&file)).as_bytes()) }
            }
            None => WarningKind::Textures,
        };
        notes.push(kind);
        let wraps = texture.clamps.map(|clamps| if clamps { Wrap::Clamp } else { Wrap::Repeat });
        let sampler = Sampler { wraps, is_nearest: false };
        decoded.map(|image| Shown { image, sampler, factor: texture.factor })
    }
}

/// A texture with its image.
struct Shown {
    image: Rc<DecodedImage>,
    sampler: Sampler,
    factor: f32,
}

impl Shown {
    /// Returns the linear colour at a place of the image; white where none is given.
    fn color(&self, place: Option<&[f32; 2]>) -> [f32; 3] {
        let texel = place.map_or([1.0; 3], |place| self.sampler.color(&self.image, *place));
        texel.map(|channel| channel * self.factor)
    }
}

/// Returns the image file: of the scene, or else beside it. There it may lie under its relative
/// path, in the folder of the scene's images, or in that of the scene.
fn content<'a>(image: &Image<'a>, folder: &str, resolve: Resolve<'_>) -> Option<Cow<'a, [u8]>> {
    if !image.content.is_empty() {
        return Some(Cow::Borrowed(image.content));
    }
    // What is above the folder of the scene is not beside it.
    let relative = image.relative_path.replace('\\', "/");
    let relative = relative.rsplit_once("../").map_or(&*relative, |(_, below)| below);
    let name = base_name(path(image));
    if name.is_empty() {
        return None;
    }
    let paths = [relative, &format!("{folder}/{name}"), name];
    paths.into_iter().find_map(resolve).map(|bytes| Cow::Owned(bytes.to_vec()))
}

/// Returns the path that an image file had.
fn path<'a>(image: &Image<'a>) -> &'a str {
    if image.relative_path.is_empty() { image.absolute_path } else { image.relative_path }
}

/// Returns the name of a file without its folders, which Windows separates by backslashes.
fn base_name(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}
