//! Tests of textured bodies, with images that are written here.

use super::skins::{SIZE, stage_of};
use super::{Gpu, gpu};
use crate::render::Image;
use glam::Vec3;
use image::{ImageFormat, Rgba, RgbaImage};
use segue_motion::skin::{
    AlphaMode, RigidTransform, Sampler, SkinnedMesh, Texture, TexturedPart, Wrap,
};
use segue_scene::{Camera, Lens, Skinning, Stage};
use std::io::Cursor;
use std::sync::Arc;

const RED: [u8; 4] = [230, 20, 20, 255];
const GREEN: [u8; 4] = [20, 230, 20, 255];
const BLUE: [u8; 4] = [20, 20, 230, 255];
const CLEAR: [u8; 4] = [230, 230, 20, 60];

/// Returns an image file of two by two pixels.
fn four_pixels(format: ImageFormat, pixels: [[u8; 4]; 4]) -> Arc<[u8]> {
    let image = RgbaImage::from_fn(2, 2, |x, y| Rgba(pixels[(2 * y + x) as usize]));
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner().into()
}

fn texture(image: Arc<[u8]>) -> Texture {
    let sampler = Sampler { wraps: [Wrap::Clamp; 2], is_nearest: true };
    Texture { image, sampler, alpha: AlphaMode::Opaque }
}

/// Returns a square of a metre that faces the camera, with an image all over.
fn wall(texture: Texture) -> SkinnedMesh {
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    SkinnedMesh {
        positions: corners.map(|[u, v]| Vec3::new(u - 0.5, 1.5 - v, 0.0)).into(),
        normals: vec![Vec3::Z; 4],
        joints: vec![[0; 4]; 4],
        weights: vec![[1.0, 0.0, 0.0, 0.0]; 4],
        triangles: vec![[0, 2, 3], [0, 3, 1]],
        coordinates: corners.into(),
        textured: vec![TexturedPart { triangles: 0..2, texture }],
        bind: vec![RigidTransform::IDENTITY],
        ..SkinnedMesh::default()
    }
}

fn stage(mesh: SkinnedMesh) -> Stage {
    let mut stage = stage_of(&Arc::new(mesh), &[RigidTransform::IDENTITY], Skinning::Linear);
    stage.panes[0].camera = Camera {
        target: Vec3::Y,
        yaw: 0.0,
        pitch: 0.0,
        distance: 2.2,
        lens: Lens::Orthographic,
        ..Camera::default()
    };
    stage
}

/// Returns the colours at the middles of the four quarters of the wall, by name.
fn quarters(image: &Image) -> [&'static str; 4] {
    let (near, far) = (SIZE * 38 / 100, SIZE * 62 / 100);
    [[near, near], [far, near], [near, far], [far, far]].map(|[x, y]| {
        let at = 4 * (y * image.width + x) as usize;
        let [r, g, b] = [0, 1, 2].map(|channel| u32::from(image.rgba[at + channel]));
        match [r > 2 * g.max(b), g > 2 * r.max(b), b > 2 * r.max(g)] {
            [true, _, _] => "red",
            [_, true, _] => "green",
            [_, _, true] => "blue",
            _ if r.min(g) > 2 * b => "yellow",
            _ if r.min(g).min(b) > 120 => "white",
            _ => "dark",
        }
    })
}

fn drawn(gpu: &mut Gpu, name: &str, mesh: SkinnedMesh) -> [&'static str; 4] {
    quarters(&gpu.draw(&format!("texture-{name}"), &stage(mesh), [SIZE, SIZE]))
}

#[test]
fn image_lies_on_the_triangles_as_the_coordinates_say() {
    let Some(mut gpu) = gpu() else { return };
    let pixels = [RED, GREEN, BLUE, CLEAR];
    for (name, format) in [("png", ImageFormat::Png), ("webp", ImageFormat::WebP)] {
        let mesh = wall(texture(four_pixels(format, pixels)));
        // Opaque textures show what their opacity would hide.
        assert_eq!(drawn(&mut gpu, name, mesh), ["red", "green", "blue", "yellow"]);
    }
    // Two by two metres, of which the square shows one, half of it beyond the image.
    let beyond = |wraps| {
        let image = four_pixels(ImageFormat::Png, pixels);
        let mut mesh =
            wall(Texture { sampler: Sampler { wraps, is_nearest: true }, ..texture(image) });
        mesh.coordinates.iter_mut().for_each(|[u, v]| (*u, *v) = (0.5 + *u, *v));
        mesh
    };
    let clamped = beyond([Wrap::Clamp, Wrap::Repeat]);
    assert_eq!(drawn(&mut gpu, "clamp", clamped), ["green", "green", "yellow", "yellow"]);
    let repeated = beyond([Wrap::Repeat, Wrap::Clamp]);
    assert_eq!(drawn(&mut gpu, "repeat", repeated), ["green", "red", "yellow", "blue"]);
    let mut mirrored = beyond([Wrap::Mirror, Wrap::Clamp]);
    mirrored.coordinates.iter_mut().for_each(|[u, _]| *u += 0.5);
    assert_eq!(drawn(&mut gpu, "mirror", mirrored), ["green", "red", "yellow", "blue"]);
}

#[test]
fn colours_of_vertices_and_texture_are_multiplied_where_the_body_shows_its_own() {
    let Some(mut gpu) = gpu() else { return };
    let white = texture(four_pixels(ImageFormat::Png, [[255; 4]; 4]));
    let mut mesh = wall(white.clone());
    mesh.colors = vec![[1.0, 0.0, 0.0, 1.0]; 4];
    assert_eq!(drawn(&mut gpu, "tinted", mesh), ["red"; 4]);
    assert_eq!(drawn(&mut gpu, "white", wall(white)), ["white"; 4]);
    // A body that shows the colours of its joints: red.
    let mut stage = stage(wall(texture(four_pixels(ImageFormat::Png, [GREEN; 4]))));
    stage.panes[0].figures[0].skin.as_mut().unwrap().colored = true;
    let image = gpu.draw("texture-colored", &stage, [SIZE, SIZE]);
    assert_eq!(quarters(&image), ["red"; 4]);
}

#[test]
fn texture_that_cuts_out_shows_what_is_behind() {
    let Some(mut gpu) = gpu() else { return };
    let image = four_pixels(ImageFormat::Png, [RED, CLEAR, BLUE, CLEAR]);
    let cut_out = |alpha| wall(Texture { alpha, ..texture(Arc::clone(&image)) });
    let blended = cut_out(AlphaMode::Blend);
    assert_eq!(drawn(&mut gpu, "blend", blended), ["red", "dark", "blue", "dark"]);
    // 60 of 255 are more than a tenth.
    let little = cut_out(AlphaMode::Mask(0.1));
    assert_eq!(drawn(&mut gpu, "little", little), ["red", "yellow", "blue", "yellow"]);
    let most = cut_out(AlphaMode::Mask(0.9));
    assert_eq!(drawn(&mut gpu, "most", most), ["red", "dark", "blue", "dark"]);
    // The opacity of the vertices counts, too.
    let mut glass = cut_out(AlphaMode::Mask(0.9));
    glass.colors = vec![[1.0, 1.0, 1.0, 0.5]; 4];
    assert_eq!(drawn(&mut gpu, "glass", glass), ["dark"; 4]);
    // A wall in front of another one, as one mesh with a part that is cut out and one that is not.
    let mut both = cut_out(AlphaMode::Mask(0.5));
    let mut behind = wall(texture(four_pixels(ImageFormat::Png, [GREEN; 4])));
    both.positions.iter_mut().for_each(|position| position.z += 0.1);
    both.positions.append(&mut behind.positions);
    both.normals.append(&mut behind.normals);
    both.joints.append(&mut behind.joints);
    both.weights.append(&mut behind.weights);
    both.coordinates.append(&mut behind.coordinates);
    both.triangles.extend(behind.triangles.iter().map(|triangle| triangle.map(|own| own + 4)));
    let texture = behind.textured.remove(0).texture;
    both.textured.push(TexturedPart { triangles: 2..4, texture });
    assert_eq!(drawn(&mut gpu, "both", both), ["red", "green", "blue", "green"]);
}

#[test]
fn image_that_cannot_be_decoded_leaves_the_colours_of_the_vertices() {
    let Some(mut gpu) = gpu() else { return };
    let mut image = four_pixels(ImageFormat::Png, [GREEN; 4]).to_vec();
    image.truncate(50);
    let mut mesh = wall(texture(image.into()));
    mesh.colors = vec![[1.0, 0.0, 0.0, 1.0]; 4];
    assert_eq!(drawn(&mut gpu, "broken", mesh), ["red"; 4]);
}
