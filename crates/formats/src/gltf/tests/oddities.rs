//! Tests of unusual and invalid files.

use super::*;
use std::sync::Arc;

#[test]
fn oddities_of_a_file_give_warnings() {
    let nodes = json!([
        { "name": "Hips", "children": [1], "scale": [1, 2, 1] },
        { "name": "Chest", "children": [2], "translation": [0, 0.5, 0] },
        { "translation": [0, 0.5, 0] }
    ]);
    let mut builder = GltfBuilder::new(&nodes, &[0, 1]);
    let times = [0.0, 0.0123, 0.5171, 0.9];
    builder.channel(
        0,
        "translation",
        "LINEAR",
        &times,
        &[0.0, 1.0, 0.0, f32::NAN, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0, 1.0, 0.0],
    );
    builder.channel(
        0,
        "scale",
        "LINEAR",
        &times,
        &[1.0, 2.0, 1.0, 1.0, 2.0, 1.0, 1.0, 2.0, 1.0, 1.0, 2.0, 1.0],
    );
    builder.channel(
        1,
        "scale",
        "STEP",
        &times,
        &[1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 3.0, 1.0, 1.0, 1.0, 1.0],
    );
    let imported = builder.read();
    assert_eq!(
        sentences(&imported),
        [
            "1 animated scale ignored",
            "1 value without a number; the last good value was held",
            "the keys have no common rate; sampled at 30 frames per second",
            "1 node scaled by a different factor along each axis; joints below are exact at rest and approximate in motion",
        ]
    );
    assert_eq!(
        only(&imported).skeleton().rest_positions()[1],
        Vec3::Y,
        "as tall as the scale makes it"
    );
    // A file in centimetres, against the specification.
    let mut builder = GltfBuilder::new(
        &json!([
            { "name": "Hips", "children": [1], "translation": [0, 90, 0] },
            { "name": "Head", "translation": [0, 85, 0] },
            { "name": "Foot", "translation": [0, -88, 0] }
        ]),
        &[0, 1, 2],
    );
    builder.root["nodes"][0]["children"] = json!([1, 2]);
    let imported =
        read("tall.gltf", &builder.text(), &|_| None, &ImportOptions::default()).unwrap();
    assert_eq!(
        sentences(&imported),
        [
            "the body is far too large for metres; units of 0.01 m are assumed",
            "the file has a skeleton but no animation"
        ]
    );
    assert_eq!(only(&imported).root_translations()[0], Vec3::Y * 0.9);
}

#[test]
fn buffers_are_found_beside_the_file_or_refused_by_name() {
    let mut builder = GltfBuilder::new(&two_bones(), &[0, 1]);
    builder.channel(1, "rotation", "LINEAR", &[0.0, 1.0], &[about_z(0.0), about_z(1.0)].concat());
    let mut root = builder.root.clone();
    root["buffers"] = json!([{ "byteLength": builder.bytes.len(), "uri": "my%20walk.bin" }]);
    let text = root.to_string();
    let bytes: Arc<[u8]> = builder.bytes.clone().into();
    let beside = |name: &str| (name == "my walk.bin").then(|| Arc::clone(&bytes));
    let imported = read("a.gltf", text.as_bytes(), &beside, &ImportOptions::default()).unwrap();
    assert_eq!(only(&imported).frames(), 31);
    let error = read("a.gltf", text.as_bytes(), &|_| None, &ImportOptions::default()).unwrap_err();
    assert!(error.to_string().contains("found no file `my%20walk.bin` beside it"), "{error}");
    assert!(error.hint.is_some());
    let short: Arc<[u8]> = builder.bytes[..30].into();
    let error =
        read("a.gltf", text.as_bytes(), &|_| Some(Arc::clone(&short)), &ImportOptions::default())
            .unwrap_err();
    assert!(error.to_string().contains("expected all bytes of the animation"), "{error}");
    // Buffers without data are usual where all data is packed.
    let mut packed = root.clone();
    packed["buffers"] = json!([{ "byteLength": builder.bytes.len() }]);
    packed["extensionsRequired"] = json!(["EXT_meshopt_compression"]);
    let packed = packed.to_string();
    let error =
        read("a.gltf", packed.as_bytes(), &|_| None, &ImportOptions::default()).unwrap_err();
    assert!(error.to_string().contains("found data that was packed by meshopt"), "{error}");
    assert!(error.hint.is_some_and(|hint| hint.to_string().contains("without compression")));
    // A missing buffer of images alone is no error.
    root["buffers"] = json!([
        { "byteLength": builder.bytes.len(), "uri": "walk.bin" },
        { "byteLength": 9, "uri": "images.bin" }
    ]);
    let beside = |name: &str| (name == "walk.bin").then(|| Arc::clone(&bytes));
    assert!(
        read("a.gltf", root.to_string().as_bytes(), &beside, &ImportOptions::default()).is_ok()
    );
}

#[test]
fn invalid_gltf_is_refused_with_its_place() {
    let say = |text: &str| open(text.as_bytes()).unwrap_err().to_string();
    assert!(
        say("{\n \"asset\": {]").starts_with("dir/builder.gltf:2:12: found JSON that is not glTF"),
        "{}",
        say("{\n \"asset\": {]")
    );
    assert!(
        say(r#"{"asset":{"version":"1.0"},"nodes":{}}"#)
            .contains("found glTF version 1.0, expected glTF 2.0")
    );
    assert!(
        say(r#"{"asset":{"version":"2.0"},"nodes":[{"children":[0]}]}"#)
            .contains("below themselves")
    );
    assert!(
        say(r#"{"asset":{"version":"2.0"},"nodes":[{"children":[2]},{"children":[2]},{}]}"#)
            .contains("two parents")
    );
    assert!(
        say(r#"{"asset":{"version":"2.0"},"nodes":[{"children":[9]}]}"#)
            .contains("node 9, which is not there")
    );
    assert!(
        say(r#"{"asset":{"version":"2.0"},"nodes":[{}],"skins":[{"joints":[4]}]}"#)
            .contains("node 4 in a skin")
    );
    let huge = r#"{"asset":{"version":"2.0"},"nodes":[{"scale":[1e30,1e30,1e30],"children":[1]},{"translation":[1,0,0]}],"skins":[{"joints":[0]}]}"#;
    assert!(say(huge).contains("too far from the origin"));
    let glb = write_glb(&wander(&fixtures::cmu_bvh(), 3, 1), &GlbOptions::default()).unwrap();
    let cut = open(&glb[..glb.len() - 5]).unwrap_err().to_string();
    assert!(cut.contains("the file was cut off, expected a whole glTF 2.0 file"), "{cut}");
    assert!(
        open(b"glTF").is_err()
            && open(b"glTF\x01\0\0\0").unwrap_err().to_string().contains("glTF version 1")
    );
}

#[test]
fn invalid_keys_are_refused() {
    let say = |times: &[f32], values: usize, stride: Option<u32>| {
        let mut builder = GltfBuilder::new(&two_bones(), &[0, 1]);
        builder.channel(1, "rotation", "LINEAR", times, &about_z(0.0).repeat(values));
        if let Some(stride) = stride {
            builder.root["bufferViews"][1]["byteStride"] = json!(stride);
        }
        open(&builder.text()).map_or_else(|error| error.to_string(), |_| "read".to_owned())
    };
    assert_eq!(say(&[0.0, 1.0], 2, None), "read");
    assert!(say(&[1.0, 0.0], 2, None).contains("expected rising times"));
    assert!(say(&[0.0, f32::NAN], 2, None).contains("expected rising times"));
    assert!(
        say(&[0.0, 1.0], 3, None).contains("found 3 values for 2 keys, expected 1 for each key")
    );
    assert!(say(&[0.0, 1.0], 2, Some(4)).contains("for 2 values of 16"));
}

#[test]
fn channels_without_a_node_are_skipped() {
    let mut builder = GltfBuilder::new(&two_bones(), &[0, 1]);
    builder.channel(1, "rotation", "LINEAR", &[0.0, 1.0], &[about_z(0.0), about_z(1.0)].concat());
    let pointer = json!({
        "sampler": 0,
        "target": { "path": "pointer", "extensions": { "KHR_animation_pointer": { "pointer": "/materials/0" } } }
    });
    builder.root["animations"][0]["channels"].as_array_mut().unwrap().push(pointer);
    builder.root["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    assert_eq!(only(&builder.read()).frames(), 31);
}

#[test]
fn small_files_cannot_claim_much_memory() {
    let refused = |builder: &GltfBuilder| open(&builder.text()).unwrap_err().to_string();
    let mut builder = GltfBuilder::new(&two_bones(), &[0, 1]);
    builder.channel(1, "rotation", "LINEAR", &[0.0, 4e9], &[about_z(0.0), about_z(1.0)].concat());
    assert!(refused(&builder).contains("more motion than fits"), "{}", refused(&builder));
    for accessor in [
        json!({ "componentType": 5126, "count": 4_000_000_000_u64, "type": "SCALAR" }),
        json!({
            "bufferView": 0, "componentType": 5126, "count": 4_000_000_000_u64, "type": "SCALAR"
        }),
        json!({ "bufferView": 0, "componentType": 5126, "count": u64::MAX, "type": "SCALAR" }),
    ] {
        let mut builder = GltfBuilder::new(&two_bones(), &[0, 1]);
        let view = builder.view(&[0; 64]);
        let input = builder.accessor(accessor);
        builder.sampler(1, "rotation", json!({ "input": input, "output": input }));
        assert!(open(&builder.text()).is_err());
        // With a stride of zero they would all fit.
        builder.root["bufferViews"][view]["byteStride"] = json!(0);
        assert!(open(&builder.text()).is_err());
    }
}
