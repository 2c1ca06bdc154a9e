//! Tests of vertex colours and textures, with images that are written here.

use super::skin::{mesh_of, square};
use super::*;
use ::png::{BitDepth, ColorType, Encoder};

/// Returns a PNG of pixels with 8 bits for each channel.
fn png(width: u32, pixels: &[[u8; 3]]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, width, pixels.len() as u32 / width);
    encoder.set_color(ColorType::Rgb);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(pixels.as_flattened()).unwrap();
    drop(writer);
    bytes
}

const RED: [u8; 3] = [255, 0, 0];
const GREEN: [u8; 3] = [0, 255, 0];
const BLUE: [u8; 3] = [0, 0, 255];
const GRAY: [u8; 3] = [188; 3];

/// Returns the square with white base colour, texture coordinates, and an image.
fn textured(image: &[u8], coordinates: [f32; 8]) -> GltfBuilder {
    let mut builder = square();
    let view = builder.view(image);
    builder.root["images"] = json!([{ "bufferView": view, "mimeType": "image/png" }]);
    builder.root["textures"] = json!([{ "source": 0 }]);
    let coordinates = builder.floats("VEC2", 2, &coordinates);
    builder.root["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = json!(coordinates);
    builder.root["materials"][0]["pbrMetallicRoughness"] =
        json!({ "baseColorTexture": { "index": 0 } });
    builder
}

fn colors(builder: &GltfBuilder) -> Vec<[u8; 3]> {
    let byte = |channel: f32| (channel * 255.0).round() as u8;
    let color = |&[r, g, b, _]: &[f32; 4]| [r, g, b].map(byte);
    mesh_of(&builder.read()).colors.iter().map(color).collect()
}

/// The centres of the four pixels of a square image, by rows from the top.
const CENTRES: [f32; 8] = [0.25, 0.25, 0.75, 0.25, 0.25, 0.75, 0.75, 0.75];

#[test]
fn vertices_have_the_colour_of_the_texture_at_their_place() {
    let image = png(2, &[RED, GREEN, BLUE, GRAY]);
    let builder = textured(&image, CENTRES);
    assert_eq!(colors(&builder), [RED, GREEN, BLUE, GRAY]);
    assert_eq!(sentences(&builder.read())[0], "1 texture is shown by the colour at each vertex");
    // Between pixels in linear light, as a screen shows it: half of red and green are 188 each.
    let between = textured(&image, [0.5, 0.25, 0.25, 0.5, 0.5, 0.75, 1.0, 0.25]);
    let [first, second, third, edge] = colors(&between)[..] else { panic!() };
    assert_eq!((first, second), ([188, 188, 0], [188, 0, 188]));
    assert_eq!(third[2], 225, "half of 1 and of 0.503");
    // The image repeats: its right edge meets its left one.
    assert_eq!(edge, [188, 188, 0]);
}

#[test]
fn texture_wraps_and_filters_as_its_sampler_says() {
    let image = png(2, &[RED, GREEN, BLUE, GRAY]);
    let with = |sampler: Value, coordinates: [f32; 8]| {
        let mut builder = textured(&image, coordinates);
        builder.root["samplers"] = json!([sampler]);
        builder.root["textures"][0]["sampler"] = json!(0);
        colors(&builder)
    };
    let outside = [-0.25, 0.25, 1.25, 0.25, 1.75, 0.25, 0.25, 9.25];
    assert_eq!(with(json!({}), outside), [GREEN, RED, GREEN, RED]);
    let clamped = json!({ "wrapS": 33071, "wrapT": 33071 });
    assert_eq!(with(clamped, outside), [RED, GREEN, GREEN, BLUE]);
    let mirrored = json!({ "wrapS": 33648, "wrapT": 33648 });
    assert_eq!(with(mirrored, outside), [RED, GREEN, RED, BLUE]);
    let nearest = json!({ "magFilter": 9728 });
    let near = [0.49, 0.01, 0.51, 0.49, 0.01, 0.51, 1.01, 0.0];
    assert_eq!(with(nearest, near), [RED, GREEN, BLUE, RED]);
    // Coordinates that are no numbers.
    assert_eq!(
        colors(&textured(&image, [f32::NAN, f32::INFINITY, 1e30, 0.0, 0.0, 0.0, 0.0, 0.0])).len(),
        4
    );
}

#[test]
fn texture_transform_scales_then_rotates_then_moves() {
    let image = png(2, &[RED, GREEN, BLUE, GRAY]);
    let with = |transform: Value, coordinates: [f32; 8]| {
        let mut builder = textured(&image, coordinates);
        builder.root["extensionsUsed"] = json!(["KHR_texture_transform"]);
        builder.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] =
            json!({ "KHR_texture_transform": transform });
        colors(&builder)
    };
    assert_eq!(with(json!({ "offset": [0.5, 0.0] }), CENTRES), [GREEN, RED, GRAY, BLUE]);
    assert_eq!(
        with(json!({ "scale": [2.0, 1.0] }), [0.125, 0.25, 0.375, 0.25, 0.125, 0.75, 0.375, 0.75]),
        [RED, GREEN, BLUE, GRAY]
    );
    // A quarter turn anticlockwise, with v down: (u, v) to (v, -u), here moved back into the image.
    let quarter = json!({ "rotation": std::f32::consts::FRAC_PI_2, "offset": [0.0, 1.0] });
    assert_eq!(with(quarter, CENTRES), [BLUE, RED, GRAY, GREEN]);
    // A quarter turn after a scale: (u, v) to (v, -2u).
    let both = json!({
        "rotation": std::f32::consts::FRAC_PI_2, "scale": [2.0, 1.0], "offset": [0.0, 1.0]
    });
    let halves = [0.125, 0.25, 0.375, 0.25, 0.125, 0.75, 0.375, 0.75];
    assert_eq!(with(both, halves), [BLUE, RED, GRAY, GREEN]);
    // Another set of coordinates.
    let mut builder = textured(&image, [0.25; 8]);
    let other = builder.floats("VEC2", 2, &CENTRES);
    builder.root["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = json!(other);
    builder.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] =
        json!({ "KHR_texture_transform": { "texCoord": 1 } });
    assert_eq!(colors(&builder), [RED, GREEN, BLUE, GRAY]);
}

#[test]
fn colours_of_texture_vertices_and_factor_are_multiplied() {
    let mut builder = textured(&png(1, &[GRAY]), CENTRES);
    let half: [f32; 3] = [0.5, 1.0, 0.0];
    let own = builder.floats("VEC3", 3, &half.repeat(4));
    builder.root["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(own);
    builder.root["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] =
        json!([0.5, 0.5, 1.0, 1.0]);
    // 188 is 0.503 in linear light: an eighth of it and a quarter.
    assert_eq!(colors(&builder)[2], [99, 137, 0]);
    // Without a material, the colours of the vertices alone.
    let primitive = builder.root["meshes"][0]["primitives"][0].as_object_mut().unwrap();
    primitive.remove("material");
    assert_eq!(colors(&builder)[0], [188, 255, 0]);
}

#[test]
fn images_of_every_layout_are_decoded() {
    let write = |color, depth, palette: bool, data: &[u8]| {
        let mut bytes = Vec::new();
        let mut encoder = Encoder::new(&mut bytes, 1, 1);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if palette {
            encoder.set_palette([RED, GREEN].as_flattened().to_vec());
        }
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(data).unwrap();
        drop(writer);
        colors(&textured(&bytes, CENTRES))[0]
    };
    assert_eq!(write(ColorType::Grayscale, BitDepth::Eight, false, &[188]), GRAY);
    assert_eq!(write(ColorType::GrayscaleAlpha, BitDepth::Eight, false, &[188, 9]), GRAY);
    assert_eq!(write(ColorType::Rgba, BitDepth::Eight, false, &[0, 255, 0, 9]), GREEN);
    assert_eq!(write(ColorType::Rgb, BitDepth::Sixteen, false, &[0, 0, 0, 9, 255, 255]), BLUE);
    assert_eq!(write(ColorType::Indexed, BitDepth::One, true, &[0x80]), GREEN);
    // A JPEG of eight by eight pixels in one colour.
    let [r, g, b] = colors(&textured(&jpeg(), CENTRES))[0];
    assert!(r.abs_diff(200) < 4 && g.abs_diff(200) < 4 && b.abs_diff(200) < 4, "{r} {g} {b}");
}

/// Returns a baseline JPEG of one grey block: a difference of brightness and an end of block.
fn jpeg() -> Vec<u8> {
    let mut bytes = vec![0xff, 0xd8, 0xff, 0xdb, 0, 67, 0];
    bytes.extend([8; 64]);
    bytes.extend([0xff, 0xc0, 0, 11, 8, 0, 8, 0, 8, 1, 1, 0x11, 0]);
    // One code for brightness, `0`: a difference of 7 bits. One for the rest, `0`: the end.
    for (class, symbol) in [(0x00, 7), (0x10, 0)] {
        bytes.extend([0xff, 0xc4, 0, 20, class, 1]);
        bytes.extend([0; 15]);
        bytes.push(symbol);
    }
    bytes.extend([0xff, 0xda, 0, 8, 1, 1, 0, 0, 63, 0]);
    // (200 - 128) · 8 / 8 = 72, in seven bits: 0 1001000 0, then ones.
    bytes.extend([0b0100_1000, 0b0111_1111, 0xff, 0xd9]);
    bytes
}

#[test]
fn images_that_cannot_be_read_leave_the_plain_colour() {
    let good = png(2, &[RED, GREEN, BLUE, GRAY]);
    let mut huge = good.clone();
    // A header of 8000 by 8000 pixels, with its checksum.
    huge[16..24].copy_from_slice(&[0, 0, 0x1f, 0x40, 0, 0, 0x1f, 0x40]);
    let checksum = {
        let mut crc = flate2::Crc::new();
        crc.update(&huge[12..29]);
        crc.sum()
    };
    huge[29..33].copy_from_slice(&checksum.to_be_bytes());
    let webp = b"RIFF\x10\0\0\0WEBPVP8L".to_vec();
    let cut_off = good[..good.len() - 20].to_vec();
    for image in [huge, webp, cut_off, b"\xff\xd8\xff\xd9".to_vec(), Vec::new()] {
        let imported = textured(&image, CENTRES).read();
        assert!(mesh_of(&imported).colors.is_empty());
        assert_eq!(sentences(&imported)[0], "imported without 1 texture: the plain colour is used");
    }
    let broken = |change: &dyn Fn(&mut Value)| {
        let mut builder = textured(&good, CENTRES);
        change(&mut builder.root);
        sentences(&builder.read())[0].starts_with("imported without 1 texture")
    };
    assert!(broken(&|root| root["images"] = json!([{ "uri": "nowhere.png" }])));
    assert!(broken(&|root| root["images"] = json!([{ "bufferView": 99 }])));
    assert!(broken(&|root| root["textures"] = json!([{}])));
    assert!(broken(&|root| {
        let attributes = &mut root["meshes"][0]["primitives"][0]["attributes"];
        attributes.as_object_mut().unwrap().remove("TEXCOORD_0");
    }));
}

#[test]
fn image_beside_the_file_is_found() {
    let image = png(2, &[RED, GREEN, BLUE, GRAY]);
    let mut builder = textured(&[], CENTRES);
    builder.root["images"] = json!([{ "uri": "skin%201.png" }]);
    let image: Arc<[u8]> = image.into();
    let beside = |name: &str| (name == "skin 1.png").then(|| Arc::clone(&image));
    let imported = read("a.gltf", &builder.text(), &beside, &ImportOptions::default()).unwrap();
    assert_eq!(mesh_of(&imported).colors[0], [1.0, 0.0, 0.0, 1.0]);
}
