//! Tests of glTF files: the files are built here as JSON with embedded numbers, and compared with
//! matrices multiplied node by node.

use super::*;
use crate::{ImportError, ImportOptions, ImportedFile};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use glam::{Quat, Vec3};
use segue_motion::clip::fixtures::wander;
use segue_motion::clip::{Clip, JointTranslations};
use segue_motion::math::quat;
use segue_motion::skeleton::fixtures;
use serde_json::{Value, json};
use std::sync::Arc;

mod humanoid;
mod oddities;
mod properties;
mod several;
mod skin;
mod texture;

/// Changes the name of the generator in a file of Segue's.
fn by_another_program(mut bytes: Vec<u8>) -> Vec<u8> {
    let at = bytes.windows(6).position(|w| w == b"Segue ").unwrap();
    bytes[at..at + 5].copy_from_slice(b"Other");
    bytes
}

/// A glTF file under construction.
struct GltfBuilder {
    root: Value,
    bytes: Vec<u8>,
}

impl GltfBuilder {
    /// Returns a file with nodes, and a skin with joints.
    fn new(nodes: &Value, joints: &[usize]) -> Self {
        let mut root = json!({
            "asset": { "version": "2.0" }, "nodes": nodes, "accessors": [], "bufferViews": []
        });
        if !joints.is_empty() {
            root["skins"] = json!([{ "joints": joints }]);
        }
        Self { root, bytes: Vec::new() }
    }

    fn list(&mut self, key: &str) -> &mut Vec<Value> {
        if self.root[key].is_null() {
            self.root[key] = json!([]);
        }
        self.root[key].as_array_mut().unwrap()
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        let view =
            json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        self.bytes.extend_from_slice(bytes);
        self.list("bufferViews").push(view);
        self.list("bufferViews").len() - 1
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.list("accessors").push(accessor);
        self.list("accessors").len() - 1
    }

    fn floats(&mut self, kind: &str, width: usize, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let view = self.view(&bytes);
        self.accessor(json!({
            "bufferView": view, "componentType": 5126, "count": values.len() / width, "type": kind
        }))
    }

    /// Adds a channel to the first animation.
    fn channel(
        &mut self,
        node: usize,
        path: &str,
        interpolation: &str,
        times: &[f32],
        values: &[f32],
    ) {
        let input = self.floats("SCALAR", 1, times);
        let (kind, width) = if path == "rotation" { ("VEC4", 4) } else { ("VEC3", 3) };
        let output = self.floats(kind, width, values);
        self.sampler(
            node,
            path,
            json!({ "input": input, "output": output, "interpolation": interpolation }),
        );
    }

    fn sampler(&mut self, node: usize, path: &str, sampler: Value) {
        if self.root["animations"].is_null() {
            self.root["animations"] = json!([{ "samplers": [], "channels": [] }]);
        }
        let animation = &mut self.root["animations"][0];
        let samplers = animation["samplers"].as_array_mut().unwrap();
        samplers.push(sampler);
        let index = samplers.len() - 1;
        let channel = json!({ "sampler": index, "target": { "node": node, "path": path } });
        animation["channels"].as_array_mut().unwrap().push(channel);
    }

    fn text(&self) -> Vec<u8> {
        let mut root = self.root.clone();
        let data = format!("data:application/octet-stream;base64,{}", STANDARD.encode(&self.bytes));
        root["buffers"] = json!([{ "byteLength": self.bytes.len(), "uri": data }]);
        root.to_string().into_bytes()
    }

    fn read(&self) -> ImportedFile {
        open(&self.text()).unwrap_or_else(|error| panic!("{error}"))
    }
}

fn open(bytes: &[u8]) -> Result<ImportedFile, ImportError> {
    let options = ImportOptions {
        drop_t_pose: false,
        metres_per_unit: Some(1.0),
        ..ImportOptions::default()
    };
    read("dir/builder.gltf", bytes, &|_| None, &options)
}

fn only(imported: &ImportedFile) -> &Clip {
    assert_eq!(imported.clips.len(), 1);
    &imported.clips[0].clip
}

fn sentences(imported: &ImportedFile) -> Vec<String> {
    imported.warnings.iter().map(ToString::to_string).collect()
}

/// Returns two bones: `Hips` at 1 m with `Chest` 0.5 m above.
fn two_bones() -> Value {
    json!([
        { "name": "Hips", "translation": [0, 1, 0], "children": [1] },
        { "name": "Chest", "translation": [0, 0.5, 0], "children": [2] },
        { "name": "Tip", "translation": [0, 0.3, 0] }
    ])
}

fn about_z(angle: f32) -> [f32; 4] {
    Quat::from_rotation_z(angle).to_array()
}

#[test]
fn written_clip_reads_back_equal() {
    let clip = wander(&fixtures::cmu_bvh(), 40, 5).with_name("wander & more");
    let values = (0..40).map(|i| Vec3::new(0.02, 0.3 + 0.001 * i as f32, 0.0)).collect();
    let clip = clip.with_translations(vec![JointTranslations { joint: 7, values }]).unwrap();
    let bytes = write_glb(&clip, &GlbOptions::default()).unwrap();
    assert_eq!(bytes, write_glb(&clip, &GlbOptions::default()).unwrap());
    assert!(is_gltf(&bytes) && bytes.len().is_multiple_of(4));
    let imported = read("x.glb", &bytes, &|_| None, &ImportOptions::default()).unwrap();
    assert_eq!(sentences(&imported), [""; 0]);
    let back = only(&imported);
    assert_eq!((back.name(), back.fps(), back.frames()), ("wander & more", 30.0, 40));
    assert_eq!(back.provenance().metres_per_unit, 1.0);
    // Nodes are read depth first.
    let joints = clip.skeleton().joints();
    let places: Vec<usize> =
        joints.iter().map(|joint| back.skeleton().find(&joint.name).unwrap()).collect();
    for (b, &place) in joints.iter().zip(&places) {
        let a = &back.skeleton().joints()[place];
        assert_eq!(a.parent, b.parent.map(|parent| places[parent]));
        assert!(a.offset.distance(b.offset) < 1e-6 && a.end_site.is_some() == b.end_site.is_some());
        assert!(a.end_site.unwrap_or_default().distance(b.end_site.unwrap_or_default()) < 1e-6);
    }
    for frame in 0..40 {
        let (found, expected) = (back.world_pose(frame), clip.world_pose(frame));
        for (joint, &place) in places.iter().enumerate() {
            assert!(
                found.positions[place].distance(expected.positions[joint]) < 1e-5,
                "frame {frame}"
            );
            assert!(
                quat::angle_between(back.rotations(frame)[place], clip.rotations(frame)[joint])
                    < 1e-5
            );
        }
    }
    // At another rate, and without frames.
    let half = write_glb(&clip, &GlbOptions { fps: Some(60.0), ..GlbOptions::default() }).unwrap();
    assert_eq!(
        only(&read("x.glb", &half, &|_| None, &ImportOptions::default()).unwrap()).frames(),
        79
    );
    let still = write_glb(&clip.crop(0..0).unwrap(), &GlbOptions::default()).unwrap();
    let imported = read("x.glb", &still, &|_| None, &ImportOptions::default()).unwrap();
    assert_eq!(sentences(&imported), ["the file has a skeleton but no animation"]);
    assert_eq!((only(&imported).frames(), only(&imported).name()), (1, "x"));
}

#[test]
fn interpolation_follows_the_specification() {
    let times = [0.0, 0.5, 1.0];
    let mut builder = GltfBuilder::new(&two_bones(), &[0, 1]);
    builder.channel(
        0,
        "translation",
        "STEP",
        &times,
        &[0.0, 1.0, 0.0, 2.0, 1.0, 0.0, 3.0, 1.0, 0.0],
    );
    let turns = [about_z(0.0), about_z(1.0), about_z(0.5)];
    // The negated quaternion: interpolation must still take the shorter way.
    let turns = [turns[0], turns[1].map(|v| -v), turns[2]].concat();
    builder.channel(1, "rotation", "LINEAR", &times, &turns);
    let imported = builder.read();
    let clip = only(&imported);
    assert_eq!((clip.fps(), clip.frames()), (30.0, 31));
    assert_eq!(
        clip.skeleton().joints()[1].end_site,
        Some(Vec3::Y * 0.3),
        "a leaf that does not move is an end"
    );
    let x = |frame: usize| clip.root_translations()[frame].x;
    assert_eq!((x(0), x(14), x(15), x(29), x(30)), (0.0, 0.0, 2.0, 2.0, 3.0));
    for (frame, angle) in [(0, 0.0), (3, 0.2), (15, 1.0), (18, 0.9), (30, 0.5)] {
        assert!(
            quat::angle_between(clip.rotations(frame)[1], Quat::from_rotation_z(angle)) < 1e-5,
            "frame {frame}"
        );
    }
    // A cubic, which a spline with the right tangents follows exactly.
    let (value, slope) = (|t: f32| t * t * t - t + 1.0, |t: f32| 3.0 * t * t - 1.0);
    let triples: Vec<f32> = times
        .iter()
        .flat_map(|&t| [0.0, slope(t), 0.0, 0.0, value(t), 0.0, 0.0, slope(t), 0.0])
        .collect();
    let mut builder = GltfBuilder::new(&two_bones(), &[0, 1]);
    builder.channel(0, "translation", "CUBICSPLINE", &times, &triples);
    let imported = builder.read();
    for (frame, place) in only(&imported).root_translations().iter().enumerate() {
        assert!((place.y - value(frame as f32 / 30.0)).abs() < 1e-6, "frame {frame}");
    }
}

#[test]
fn accessors_of_every_layout_are_read() {
    let mut builder = GltfBuilder::new(&two_bones(), &[0, 1]);
    // Rotations as normalised shorts, interleaved with other data.
    let turns: Vec<u8> = [0.0, 0.4, 0.8]
        .into_iter()
        .flat_map(|angle| {
            let q = about_z(angle).map(|v| ((v * 32767.0).round() as i16).to_le_bytes());
            [q.concat(), vec![0xee; 4]].concat()
        })
        .collect();
    let view = builder.view(&turns);
    builder.root["bufferViews"][view]["byteStride"] = json!(12);
    let input = builder.floats("SCALAR", 1, &[0.0, 0.1, 0.2]);
    let output = builder.accessor(json!({
        "bufferView": view, "componentType": 5122, "normalized": true, "count": 3, "type": "VEC4"
    }));
    builder.sampler(1, "rotation", json!({ "input": input, "output": output }));
    // Translations that are all zero except the last one.
    let (indices, values) =
        (builder.view(&[2]), builder.view(&[0, 0, 128, 63, 0, 0, 0, 64, 0, 0, 64, 64]));
    let output = builder.accessor(json!({ "componentType": 5126, "count": 3, "type": "VEC3", "sparse": {
        "count": 1, "indices": { "bufferView": indices, "componentType": 5121 }, "values": { "bufferView": values } } }));
    builder.sampler(0, "translation", json!({ "input": input, "output": output }));
    let imported = builder.read();
    let clip = only(&imported);
    assert_eq!((clip.fps(), clip.frames()), (30.0, 7));
    assert_eq!(
        (clip.root_translations()[3], clip.root_translations()[6]),
        (Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0))
    );
    assert!(quat::angle_between(clip.rotations(3)[1], Quat::from_rotation_z(0.4)) < 1e-4);
    assert!(clip.rotations(5).iter().all(|q| q.is_normalized()));
}

#[test]
fn skeleton_with_a_skin_includes_moving_nodes_above() {
    // World > Mover (moves) > Armature > {Hips > Chest > Head, Mesh}, and a lamp beside it. `Chest`
    // is in no skin.
    let nodes = json!([
        { "name": "World", "children": [1, 7], "scale": [0.01, 0.01, 0.01] },
        { "name": "Mover", "children": [2] },
        { "name": "Armature", "children": [3, 6], "rotation": [-0.707_106_77, 0, 0, 0.707_106_77] },
        { "name": "Hips", "children": [4], "translation": [0, 0, 90] },
        { "name": "Chest", "children": [5], "translation": [0, 0, 40] },
        { "name": "Head", "translation": [0, 0, 30] },
        { "name": "Mesh", "mesh": 0, "skin": 0 },
        { "name": "Lamp", "translation": [0, 300, 0] }
    ]);
    let mut builder = GltfBuilder::new(&nodes, &[5, 3]);
    builder.root["meshes"] = json!([{ "primitives": [{ "attributes": {} }] }]);
    builder.channel(1, "translation", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 100.0, 0.0, 0.0]);
    builder.channel(7, "translation", "LINEAR", &[0.0, 1.0], &[0.0; 6]);
    let imported = builder.read();
    let clip = only(&imported);
    let joints: Vec<_> =
        clip.skeleton().joints().iter().map(|joint| (joint.name.as_str(), joint.parent)).collect();
    assert_eq!(
        joints,
        [
            ("Mover", None),
            ("Armature", Some(0)),
            ("Hips", Some(1)),
            ("Chest", Some(2)),
            ("Head", Some(3))
        ]
    );
    let top = |frame: usize| clip.world_pose(frame).positions[4];
    assert!(
        top(0).distance(Vec3::new(0.0, 1.6, 0.0)) < 1e-6
            && top(30).distance(Vec3::new(1.0, 1.6, 0.0)) < 1e-6
    );
    // At rest, no joint is rotated, whatever the nodes are.
    assert!(clip.rotations(0).iter().all(|q| quat::angle_between(*q, Quat::IDENTITY) < 1e-6));
    assert!(clip.skeleton().rest_positions()[4].distance(Vec3::Y * 1.6) < 1e-6);
}

#[test]
fn characters_and_animations_each_give_a_clip() {
    let mut builder = GltfBuilder::new(
        &json!([
            { "name": "A", "children": [1] },
            { "name": "A2", "translation": [0, 1, 0] },
            { "name": "B", "children": [3] },
            { "name": "B2", "translation": [0, 1, 0] }
        ]),
        &[],
    );
    builder.root["skins"] = json!([{ "joints": [0, 1] }, { "joints": [1] }, { "joints": [2, 3] }]);
    builder.channel(0, "rotation", "LINEAR", &[0.0, 1.0], &[about_z(0.0), about_z(1.0)].concat());
    let first = builder.root["animations"][0].clone();
    builder.root["animations"] =
        json!([first, first, { "name": "unused", "channels": [], "samplers": [] }]);
    builder.root["animations"][0]["name"] = json!("walk");
    let imported = builder.read();
    let clips: Vec<_> = imported
        .clips
        .iter()
        .map(|found| (found.clip.name(), found.clip.skeleton().len(), found.clip.frames()))
        .collect();
    assert_eq!(clips, [("walk (A)", 2, 31), ("builder 2 (A)", 2, 31), ("builder (B)", 2, 1)]);
    assert_eq!(sentences(&imported), ["the file has a skeleton but no animation"]);
}

#[test]
fn skeleton_without_a_skin_is_the_moving_nodes() {
    let nodes = json!([
        { "name": "Scene", "children": [1, 5], "translation": [0, 0, 1] },
        { "name": "Hips", "children": [2, 3, 6], "translation": [0, 1, 0] },
        { "name": "Leg", "translation": [0.1, -0.5, 0] },
        { "name": "Spine", "children": [4], "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0.5, 0, 1] },
        { "name": "Head", "translation": [0, 0.2, 0] },
        { "name": "Camera", "camera": 0 },
        { "name": "Skirt", "mesh": 0 }
    ]);
    let mut builder = GltfBuilder::new(&nodes, &[]);
    builder.channel(1, "translation", "LINEAR", &[0.0, 1.0], &[0.0, 1.0, 0.0, 0.0, 1.0, 2.0]);
    builder.channel(3, "rotation", "LINEAR", &[0.0, 1.0], &[about_z(0.0), about_z(1.0)].concat());
    let imported = builder.read();
    let clip = only(&imported);
    let joints: Vec<_> = clip.skeleton().joints().iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(joints, ["Hips", "Leg", "Spine"]);
    assert_eq!(clip.skeleton().joints()[2].end_site, Some(Vec3::Y * 0.2));
    assert_eq!(clip.root_translations()[30], Vec3::new(0.0, 1.0, 3.0));
    let still = open(br#"{"asset":{"version":"2.0"},"nodes":[{}]}"#).unwrap_err();
    assert!(
        still.to_string().contains("found a file without skeleton and without animation"),
        "{still}"
    );
}
