//! Tests of vertex colours and textures, with images that are written here.

use super::skin::{mesh_of, square};
use super::*;
use crate::gltf::write_character_glb;
use crate::texture::{ImageBytes, Images};
use ::png::{ColorType, Encoder};
use segue_motion::skin::{AlphaMode, Sampler, SkinnedMesh, Texture, TexturedPart, Wrap};

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

/// A WebP of one pixel, without loss.
const WEBP: [u8; 34] =
    *b"RIFF\x1a\0\0\0WEBPVP8L\x0d\0\0\0/\0\0\0\x10\x07\x10\x11\x11\x88\x88\xfe\x07\0";

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

/// The centres of the four pixels of a square image, by rows from the top.
const CENTRES: [f32; 8] = [0.25, 0.25, 0.75, 0.25, 0.25, 0.75, 0.75, 0.75];

/// Returns the only texture of a mesh.
fn texture_of(imported: &ImportedFile) -> Texture {
    let [part] = &mesh_of(imported).textured[..] else { panic!("one texture") };
    part.texture.clone()
}

/// Returns the texture coordinates, in quarters.
fn quarters(builder: &GltfBuilder) -> Vec<[i32; 2]> {
    let imported = builder.read();
    let quarters = |own: &[f32; 2]| own.map(|value| (4.0 * value).round() as i32);
    mesh_of(&imported).coordinates.iter().map(quarters).collect()
}

#[test]
fn texture_is_read_with_its_image_and_coordinates() {
    for image in [png(2, &[RED, GREEN, BLUE, GRAY]), jpeg()] {
        let imported = textured(&image, CENTRES).read();
        let mesh = mesh_of(&imported);
        let texture = Texture {
            image: image.into(),
            sampler: Sampler { wraps: [Wrap::Repeat; 2], is_nearest: false },
            alpha: AlphaMode::Opaque,
        };
        assert_eq!(mesh.textured, [TexturedPart { triangles: 0..2, texture }]);
        assert_eq!(mesh.coordinates.as_flattened(), CENTRES);
        assert_eq!(mesh.colors, [[1.0; 4]; 0], "the texture alone");
        assert_eq!(sentences(&imported), ["the file has a skeleton but no animation"]);
    }
}

#[test]
fn texture_wraps_filters_and_cuts_out_as_the_file_says() {
    let image = png(1, &[RED]);
    let with = |sampler: Value, material: Value| {
        let mut builder = textured(&image, CENTRES);
        builder.root["samplers"] = json!([sampler]);
        builder.root["textures"][0]["sampler"] = json!(0);
        for (key, value) in material.as_object().unwrap() {
            builder.root["materials"][0][key] = value.clone();
        }
        let texture = texture_of(&builder.read());
        (texture.sampler.wraps, texture.sampler.is_nearest, texture.alpha)
    };
    let plain = ([Wrap::Repeat; 2], false, AlphaMode::Opaque);
    assert_eq!(with(json!({}), json!({ "alphaMode": "OPAQUE", "alphaCutoff": 0.3 })), plain);
    assert_eq!(
        with(json!({ "wrapS": 33071, "wrapT": 33648, "magFilter": 9728 }), json!({})),
        ([Wrap::Clamp, Wrap::Mirror], true, AlphaMode::Opaque)
    );
    let alpha = |material: Value| with(json!({ "magFilter": 9729 }), material).2;
    assert_eq!(alpha(json!({ "alphaMode": "MASK" })), AlphaMode::Mask(0.5));
    assert_eq!(alpha(json!({ "alphaMode": "MASK", "alphaCutoff": 0.25 })), AlphaMode::Mask(0.25));
    assert_eq!(alpha(json!({ "alphaMode": "MASK", "alphaCutoff": -1.0 })), AlphaMode::Mask(0.0));
    assert_eq!(alpha(json!({ "alphaMode": "BLEND" })), AlphaMode::Blend);
}

#[test]
fn texture_transform_scales_then_rotates_then_moves() {
    let image = png(1, &[RED]);
    let with = |transform: Value| {
        let mut builder = textured(&image, CENTRES);
        builder.root["extensionsUsed"] = json!(["KHR_texture_transform"]);
        builder.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] =
            json!({ "KHR_texture_transform": transform });
        quarters(&builder)
    };
    assert_eq!(with(json!({})), [[1, 1], [3, 1], [1, 3], [3, 3]]);
    assert_eq!(with(json!({ "offset": [0.5, 0.0] })), [[3, 1], [5, 1], [3, 3], [5, 3]]);
    assert_eq!(with(json!({ "scale": [2.0, 1.0] })), [[2, 1], [6, 1], [2, 3], [6, 3]]);
    // A quarter turn anticlockwise, with v down: (u, v) to (v, -u), here moved back into the image.
    let quarter = json!({ "rotation": std::f32::consts::FRAC_PI_2, "offset": [0.0, 1.0] });
    assert_eq!(with(quarter), [[1, 3], [1, 1], [3, 3], [3, 1]]);
    // A quarter turn after a scale: (u, v) to (v, -2u).
    let both = json!({
        "rotation": std::f32::consts::FRAC_PI_2, "scale": [2.0, 1.0], "offset": [0.0, 1.0]
    });
    assert_eq!(with(both), [[1, 2], [1, -2], [3, 2], [3, -2]]);
    // Another set of coordinates.
    let mut builder = textured(&image, [0.25; 8]);
    let other = builder.floats("VEC2", 2, &CENTRES);
    builder.root["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = json!(other);
    builder.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] =
        json!({ "KHR_texture_transform": { "texCoord": 1 } });
    assert_eq!(quarters(&builder), [[1, 1], [3, 1], [1, 3], [3, 3]]);
    // Coordinates that are no numbers, or have no fraction.
    let broken = [f32::NAN, f32::INFINITY, 1e30, 0.25, 0.5, -1e9, 0.0, 0.0];
    assert_eq!(quarters(&textured(&image, broken)), [[0, 0], [0, 1], [2, 0], [0, 0]]);
}

#[test]
fn colours_of_vertices_and_factor_are_multiplied_beside_a_texture() {
    let mut builder = textured(&png(1, &[GRAY]), CENTRES);
    let half: [f32; 3] = [0.5, 1.0, 0.0];
    let own = builder.floats("VEC3", 3, &half.repeat(4));
    builder.root["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(own);
    builder.root["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] =
        json!([0.5, 0.5, 1.0, 1.0]);
    let color = |builder: &GltfBuilder| {
        let byte = |channel: f32| (channel * 255.0).round() as u8;
        let [r, g, b, _] = mesh_of(&builder.read()).colors[2];
        [r, g, b].map(byte)
    };
    // A quarter and a half in linear light.
    builder.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] =
        json!({ "index": 0 });
    assert_eq!(color(&builder), [137, 188, 0]);
    assert_eq!(mesh_of(&builder.read()).textured.len(), 1);
    // Without a material, the colours of the vertices alone.
    let primitive = builder.root["meshes"][0]["primitives"][0].as_object_mut().unwrap();
    primitive.remove("material");
    assert_eq!(color(&builder), [188, 255, 0]);
    assert!(mesh_of(&builder.read()).textured.is_empty());
}

#[test]
fn image_in_webp_comes_before_the_other_one() {
    let mut builder = textured(&png(1, &[RED]), CENTRES);
    let view = builder.view(&WEBP);
    builder.root["images"].as_array_mut().unwrap().push(json!({
        "bufferView": view, "mimeType": "image/webp"
    }));
    builder.root["extensionsUsed"] = json!(["EXT_texture_webp"]);
    let webp = |source: usize| json!({ "EXT_texture_webp": { "source": source } });
    builder.root["textures"] = json!([{ "source": 0, "extensions": webp(1) }]);
    assert_eq!(texture_of(&builder.read()).image[..], WEBP);
    // Without another one, and with one that is not there.
    builder.root["textures"] = json!([{ "extensions": webp(1) }]);
    assert_eq!(texture_of(&builder.read()).image[..], WEBP);
    builder.root["textures"] = json!([{ "source": 0, "extensions": webp(7) }]);
    assert_eq!(texture_of(&builder.read()).image[..4], *b"\x89PNG");
}

#[test]
fn written_textures_are_read_again() {
    let imported = textured(&png(2, &[RED, GREEN, BLUE, GRAY]), CENTRES).read();
    let (clip, square) = (&imported.clips[0].clip, mesh_of(&imported));
    let image = Arc::clone(&square.textured[0].texture.image);
    // Five squares: without a texture, and with two images in two ways.
    let mut mesh = SkinnedMesh { bind: square.bind.clone(), ..SkinnedMesh::default() };
    for number in 0..5 {
        mesh.positions.extend(&square.positions);
        mesh.normals.extend(&square.normals);
        mesh.joints.extend(&square.joints);
        mesh.weights.extend(&square.weights);
        mesh.coordinates.extend(&square.coordinates);
        mesh.triangles
            .extend(square.triangles.iter().map(|own| own.map(|corner| corner + 4 * number)));
    }
    mesh.colors = vec![[1.0; 4]; 20];
    mesh.colors[..4].fill([0.0, 1.0, 0.0, 1.0]);
    mesh.colors[17] = [1.0, 0.5, 0.0, 0.25];
    let mirrored = Sampler { wraps: [Wrap::Clamp, Wrap::Mirror], is_nearest: false };
    let nearest = Sampler { wraps: [Wrap::Repeat; 2], is_nearest: true };
    let textures = [
        Texture { sampler: mirrored, ..square.textured[0].texture.clone() },
        Texture { image: WEBP.into(), sampler: nearest, alpha: AlphaMode::Mask(0.25) },
        Texture { alpha: AlphaMode::Blend, ..square.textured[0].texture.clone() },
        square.textured[0].texture.clone(),
    ];
    mesh.textured = (1..)
        .zip(textures)
        .map(|(number, texture)| TexturedPart { triangles: 2 * number..2 * number + 2, texture })
        .collect();
    let bytes = write_character_glb(clip, &mesh, &GlbOptions::default()).unwrap();
    let again = read("a.glb", &bytes, &|_| None, &ImportOptions::default()).unwrap();
    let found = mesh_of(&again);
    assert_eq!(sentences(&again), [""; 0]);
    assert_eq!(found.textured, mesh.textured);
    assert_eq!(
        (&found.coordinates[4..], &found.triangles),
        (&mesh.coordinates[4..], &mesh.triangles)
    );
    let apart = |[one, other]: [&[f32; 4]; 2]| (0..4).any(|at| (one[at] - other[at]).abs() > 1e-5);
    assert!(!found.colors.iter().zip(&mesh.colors).any(|(one, other)| apart([one, other])));
    // A mesh that is white without its textures stays white.
    mesh.colors = Vec::new();
    let bytes = write_character_glb(clip, &mesh, &GlbOptions::default()).unwrap();
    let again = read("a.glb", &bytes, &|_| None, &ImportOptions::default()).unwrap();
    assert_eq!((&mesh_of(&again).colors, &mesh_of(&again).textured), (&vec![], &mesh.textured));
    // Each image is in the file once.
    let count = |bytes: &[u8]| memchr::memmem::find_iter(&again_bytes(&again, clip), bytes).count();
    assert_eq!((count(&image), count(&WEBP)), (1, 1));
}

/// Returns a file that was read, written again.
fn again_bytes(imported: &ImportedFile, clip: &segue_motion::clip::Clip) -> Vec<u8> {
    write_character_glb(clip, mesh_of(imported), &GlbOptions::default()).unwrap()
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
    // A header of 9000 by 9000 pixels, with its checksum.
    huge[16..24].copy_from_slice(&[0, 0, 0x23, 0x28, 0, 0, 0x23, 0x28]);
    let checksum = {
        let mut crc = flate2::Crc::new();
        crc.update(&huge[12..29]);
        crc.sum()
    };
    huge[29..33].copy_from_slice(&checksum.to_be_bytes());
    let webp = WEBP[..30].to_vec();
    let cut_off = good[..good.len() - 20].to_vec();
    let no_size = b"\xff\xd8\xff\xd9".to_vec();
    let gif = b"GIF89a\x01\0\x01\0\0\0\0;".to_vec();
    for image in [huge, webp, cut_off, no_size, gif, Vec::new()] {
        let imported = textured(&image, CENTRES).read();
        assert!(!mesh_of(&imported).has_own_colors());
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
    assert_eq!(texture_of(&imported).image, image);
}

#[test]
fn images_beyond_the_memory_of_a_file_leave_the_plain_colour() {
    let image = png(2, &[RED, GREEN, BLUE, GRAY]);
    let mut images = Images::new(2 * image.len());
    let mut get = |index: usize| {
        let image = images.get(index, || Some(ImageBytes::Inside(&image)));
        image.map(|image| image.len())
    };
    assert_eq!(
        [0, 1, 2, 0].map(&mut get),
        [Some(image.len()), Some(image.len()), None, Some(image.len())]
    );
    // Four images of 8192 by 8192 pixels are a gigabyte.
    let mut large = image.clone();
    large[16..24].copy_from_slice(&[0, 0, 0x20, 0, 0, 0, 0x20, 0]);
    let mut images = Images::new(usize::MAX);
    let mut get = |index: usize| images.get(index, || Some(ImageBytes::Inside(&large))).is_some();
    assert_eq!([0, 1, 2, 3, 4].map(&mut get), [true, true, true, true, false]);
    assert!(images.get(5, || Some(ImageBytes::Inside(&WEBP))).is_none());
}

#[test]
fn colours_become_materials_unless_they_are_many() {
    let imported = square().read();
    let (clip, square) = (&imported.clips[0].clip, mesh_of(&imported));
    let materials = |count: u32| {
        let mut mesh = SkinnedMesh { bind: square.bind.clone(), ..SkinnedMesh::default() };
        for number in 0..count {
            mesh.positions.extend(&square.positions);
            mesh.normals.extend(&square.normals);
            mesh.joints.extend(&square.joints);
            mesh.weights.extend(&square.weights);
            mesh.colors.extend([[number as f32 / count as f32, 0.0, 0.0, 1.0]; 4]);
            mesh.triangles
                .extend(square.triangles.iter().map(|own| own.map(|corner| corner + 4 * number)));
        }
        let bytes = write_character_glb(clip, &mesh, &GlbOptions::default()).unwrap();
        let length = u32::from_le_bytes(*bytes[12..].first_chunk().unwrap()) as usize;
        let root: Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
        let again = read("a.glb", &bytes, &|_| None, &ImportOptions::default()).unwrap();
        let apart = mesh_of(&again).colors.iter().zip(&mesh.colors);
        assert!(apart.clone().all(|(one, other)| (one[0] - other[0]).abs() < 1e-5));
        assert_eq!(apart.len(), 4 * count as usize);
        root["materials"].as_array().unwrap().len()
    };
    assert_eq!((materials(2), materials(64), materials(65)), (2, 64, 1));
}
