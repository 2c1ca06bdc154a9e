//! Base colour textures of FBX files, with images that are written here.

use crate::document::{self, Element, Value, leaf, property};
use crate::examples;
use crate::rig::{File, Material, Paint, Texture};
use png::{ColorType, Encoder};
use segue_formats::{ImportOptions, ImportedFile, fbx};
use segue_motion::skin::{AlphaMode, TexturedPart, Wrap};
use std::sync::Arc;

const RED: [u8; 3] = [255, 0, 0];
const GREEN: [u8; 3] = [0, 255, 0];
const BLUE: [u8; 3] = [0, 0, 255];
const GRAY: [u8; 3] = [188; 3];

/// The centres of the four pixels of [`image`], as the corners of the example's quad: red, green,
/// gray, blue; and a triangle in the middle of the red one. v points up.
const CENTRES: [[f64; 2]; 7] = [
    [0.25, 0.75],
    [0.75, 0.75],
    [0.75, 0.25],
    [0.25, 0.25],
    [0.25, 0.75],
    [0.25, 0.75],
    [0.25, 0.75],
];

/// Returns a PNG of two by two pixels: red and green above blue and gray.
fn image() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, 2, 2);
    encoder.set_color(ColorType::Rgb);
    let mut writer = encoder.write_header().expect("memory");
    writer.write_image_data([RED, GREEN, BLUE, GRAY].as_flattened()).expect("memory");
    drop(writer);
    bytes
}

/// Returns a texture with the image inside of the file.
fn inside() -> Texture {
    Texture {
        relative_path: "..\\images\\skin.png",
        absolute_path: "C:\\work\\images\\skin.png",
        content: image(),
        more: Vec::new(),
        is_opacity: false,
    }
}

/// Returns the example with these materials, and a material for the quad and one for the triangle.
fn painted(materials: Vec<Material>, of_faces: [i32; 2]) -> File {
    let mut file = examples::namespaced();
    let paint =
        Paint { sets: vec![("map1", CENTRES.to_vec())], materials, of_faces: of_faces.into() };
    file.skin.as_mut().expect("it has a skin").paint = Some(paint);
    file
}

/// Returns the example with one texture all over. The colour beside it is black.
fn textured(texture: Texture) -> File {
    painted(vec![Material { color: [0.0; 3], factor: 1.0, texture: Some(texture) }], [0, 0])
}

fn read_beside(bytes: &[u8], beside: &dyn Fn(&str) -> Option<Arc<[u8]>>) -> ImportedFile {
    let options = ImportOptions::default();
    let read = fbx::read_with_progress("dir/body.fbx", bytes, beside, &options, &mut |_| true);
    read.expect("a file that is read").expect("nothing stopped it")
}

fn read(file: &File) -> ImportedFile {
    read_beside(&document::binary(&file.document()), &|_| None)
}

/// Returns the colours of the vertices, in the order in which faces have them: where they have a
/// texture, its pixel there, which must be the one of [`image`], times their own.
fn colors(found: &ImportedFile) -> Vec<[u8; 3]> {
    let mesh = found.clips[0].mesh.as_ref().expect("a mesh");
    let byte = |channel: f32| (channel * 255.0).round() as u8;
    let own =
        |vertex: usize| mesh.colors.get(vertex).map_or([255; 3], |c| [c[0], c[1], c[2]].map(byte));
    let mut colors: Vec<[u8; 3]> = (0..mesh.positions.len()).map(own).collect();
    for TexturedPart { triangles, texture } in &mesh.textured {
        assert_eq!(texture.image[..], image());
        for &corner in mesh.triangles[triangles.clone()].as_flattened() {
            let place = mesh.coordinates[corner as usize];
            let [column, row] = [0, 1].map(|axis| {
                let texel = (2.0 * place[axis]).floor() as i32;
                match texture.sampler.wraps[axis] {
                    Wrap::Clamp => texel.clamp(0, 1),
                    Wrap::Repeat => texel.rem_euclid(2),
                    Wrap::Mirror => panic!("FBX has none"),
                }
            });
            let pixel = [RED, GREEN, BLUE, GRAY][(2 * row + column) as usize];
            let factor = own(corner as usize);
            colors[corner as usize] =
                std::array::from_fn(|channel| product(pixel[channel], factor[channel]));
        }
    }
    colors
}

/// Returns the product of two `sRGB`-encoded channels in linear light (IEC 61966-2-1).
fn product(one: u8, other: u8) -> u8 {
    let linear = |byte: u8| {
        let encoded = f64::from(byte) / 255.0;
        if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
    };
    let product = linear(one) * linear(other);
    let encoded = if product <= 0.003_130_8 {
        12.92 * product
    } else {
        1.055 * product.powf(1.0 / 2.4) - 0.055
    };
    (encoded * 255.0).round() as u8
}

fn sentences(found: &ImportedFile) -> Vec<String> {
    found.warnings.iter().map(ToString::to_string).collect()
}

#[test]
fn embedded_texture_is_read_with_its_coordinates() {
    let document = textured(inside()).document();
    for bytes in [document::binary(&document), document::text(7500, &document)] {
        let found = read_beside(&bytes, &|_| None);
        let colors = colors(&found);
        assert!([RED, GREEN, BLUE, GRAY].iter().all(|color| colors.contains(color)), "{colors:?}");
        assert_eq!(sentences(&found), [""; 0]);
        let [part] = &found.clips[0].mesh.as_ref().unwrap().textured[..] else { panic!("one") };
        assert_eq!((part.triangles.clone(), part.texture.alpha), (0..3, AlphaMode::Opaque));
    }
    // One that is that of the opacity, too, cuts out what it shows.
    let found = read(&textured(Texture { is_opacity: true, ..inside() }));
    let mesh = found.clips[0].mesh.as_ref().unwrap();
    assert_eq!(mesh.textured[0].texture.alpha, AlphaMode::Mask(0.5));
    // Corners of one vertex with two places in the image are two vertices.
    let found = read(&textured(inside()));
    assert_eq!(found.clips[0].mesh.as_ref().unwrap().positions.len(), 7);
}

#[test]
fn texture_wraps_scales_and_is_placed_as_the_file_says() {
    let with = |more: Vec<Element>, places: [[f64; 2]; 4]| {
        let mut file = textured(Texture { more, ..inside() });
        let paint = file.skin.as_mut().unwrap().paint.as_mut().unwrap();
        paint.sets = vec![("map1", vec![[0.25, 0.75]; 7])];
        let mut second = vec![places[3]; 7];
        second[..4].copy_from_slice(&places);
        paint.sets.push(("map2", second));
        let found = read(&file);
        let mut colors = colors(&found);
        colors.sort_unstable();
        colors.dedup();
        colors
    };
    let set = || {
        leaf("P", ["UVSet", "KString", "", "", "map2"].map(|word| Value::Text(word.into())).into())
    };
    let outside = [[-0.25, 0.75], [1.75, 1.25], [0.25, 0.75], [0.25, 0.75]];
    assert_eq!(with(vec![], outside), [RED], "the first set");
    assert_eq!(with(vec![set()], outside), sorted([GRAY, GREEN, RED]));
    let clamps = ["WrapModeU", "WrapModeV"].map(|name| property(name, "enum", &[1.0]));
    let clamped = with(clamps.into_iter().chain([set()]).collect(), outside);
    assert_eq!(clamped, sorted([GREEN, RED]));
    // An image that is twice as large: a quarter of it is on the square of the coordinates.
    let large = property("Scaling", "Vector3D", &[2.0, 2.0, 1.0]);
    let places = [[0.5, 0.5], [1.5, 0.5], [0.5, 1.5], [0.5, 1.5]];
    assert_eq!(with(vec![large, set()], places), sorted([BLUE, GRAY, RED]));
}

fn sorted<const N: usize>(mut colors: [[u8; 3]; N]) -> [[u8; 3]; N] {
    colors.sort_unstable();
    colors
}

#[test]
fn each_material_has_its_own_colour_or_texture() {
    let plain = Material { color: [0.0, 1.0, 0.0], factor: 0.5, texture: None };
    // The colour beside a texture does not count, its factor does.
    let half = Material { color: [0.0; 3], factor: 0.5, texture: Some(inside()) };
    let found = read(&painted(vec![plain, half], [1, 0]));
    let mesh = found.clips[0].mesh.as_ref().unwrap();
    let of_triangle = |place: usize| mesh.triangles[place].map(|v| colors(&found)[v as usize]);
    // Triangles without a texture come first.
    let quad: Vec<_> = [of_triangle(1), of_triangle(2)].concat();
    // Half of 1 and of 0.503 in linear light, the factor in eight bits.
    for color in [[188, 0, 0], [0, 188, 0], [0, 0, 188], [138; 3]] {
        assert!(quad.contains(&color), "{color:?} {quad:?}");
    }
    assert_eq!(of_triangle(0), [[0, 188, 0]; 3]);
}

#[test]
fn image_beside_the_file_is_found_by_its_name() {
    let bytes = document::binary(&textured(Texture { content: Vec::new(), ..inside() }).document());
    let image: Arc<[u8]> = image().into();
    for place in ["images/skin.png", "body.fbm/skin.png", "skin.png"] {
        let found = read_beside(&bytes, &|path| (path == place).then(|| Arc::clone(&image)));
        assert!(colors(&found).contains(&GREEN), "{place}");
    }
    let found = read_beside(&bytes, &|_| None);
    assert_eq!(
        sentences(&found),
        [
            "imported without 1 texture whose image is not in the file, such as `skin.png`: open them together; the plain colour is used"
        ]
    );
    assert_eq!(colors(&found)[0], [0; 3]);
    // Another scene has the absolute path alone, and none has no path.
    for (absolute_path, name) in [
        ("/home/a/face.png", "`face.png`"),
        ("C:\\x\\y.tga", "`y.tga`"),
        ("", "1 texture: the plain"),
    ] {
        let texture = Texture { content: Vec::new(), relative_path: "", absolute_path, ..inside() };
        let said = sentences(&read(&textured(texture)));
        assert!(said[0].contains(name), "{said:?}");
    }
}

#[test]
fn images_that_cannot_be_read_leave_the_plain_colour() {
    let cut_off = image()[..40].to_vec();
    let mut file = textured(inside());
    file.skin.as_mut().unwrap().paint.as_mut().unwrap().sets.clear();
    let texture = |content: Vec<u8>| textured(Texture { content, ..inside() });
    for file in [texture(cut_off), texture(b"8BPS".to_vec()), file] {
        let found = read(&file);
        assert_eq!(sentences(&found), ["imported without 1 texture: the plain colour is used"]);
        assert!(colors(&found).iter().all(|color| *color == [0; 3]));
    }
}
