//! FBX files that a small writer here makes, read and compared with what Blender reads in them
//! (`oracles/fbx_golden.py` wrote `golden.json`).

mod document;
mod examples;
mod parts;
mod rig;
mod texture;

use glam::Vec3;
use proptest::prelude::*;
use segue_formats::{ImportOptions, ImportedFile, fbx, import};
use segue_motion::clip::UpAxis;
use segue_motion::skeleton::{Role, Roles, Side};
use std::collections::BTreeMap;

/// The greatest distance of a joint from where Blender has it, metres.
const TOLERANCE: f32 = 1e-4;

fn read(name: &str, bytes: &[u8]) -> ImportedFile {
    let options = ImportOptions { drop_t_pose: false, ..ImportOptions::default() };
    import(name, bytes, &options).unwrap_or_else(|error| panic!("{error}"))
}

/// For each take by name, for each joint by name, its position in each frame.
type Golden = BTreeMap<String, BTreeMap<String, Vec<[f32; 3]>>>;

fn golden() -> BTreeMap<String, Golden> {
    serde_json::from_str(include_str!("golden.json")).expect("golden.json is valid")
}

/// Checks every joint of every frame, and returns how many were compared.
fn compare(file: &ImportedFile, golden: &Golden) -> usize {
    assert_eq!(file.clips.len(), golden.len());
    let mut compared = 0;
    for clip in file.clips.iter().map(|found| &found.clip) {
        // The clip of a file with one take has the name of the file.
        let (take, joints) = match golden.get_key_value(clip.name()) {
            Some(found) => found,
            None => golden.first_key_value().expect("a file has takes"),
        };
        let names: Vec<&str> =
            clip.skeleton().joints().iter().map(|joint| joint.name.as_str()).collect();
        let places = clip.world_positions(0..clip.frames());
        for (joint, frames) in joints {
            let Some(index) = names.iter().position(|name| name == joint) else {
                continue;
            };
            assert_eq!(frames.len(), clip.frames(), "{take}");
            for (frame, expected) in frames.iter().enumerate() {
                let found = places[frame * names.len() + index];
                let distance = found.distance(Vec3::from_array(*expected));
                assert!(distance < TOLERANCE, "{take} {joint} {frame}: {found} {expected:?}");
                compared += 1;
            }
        }
    }
    compared
}

#[test]
fn files_of_every_family_have_joints_where_blender_has_them() {
    if let Some(folder) = std::env::var_os("SEGUE_FBX_OUT") {
        for (name, file) in examples::all() {
            let path = std::path::Path::new(&folder).join(format!("{name}.fbx"));
            std::fs::write(path, document::binary(&file.document())).unwrap();
        }
        // The seeds of fuzzing.
        let tiny = examples::tiny().document();
        let seeds = std::path::Path::new(&folder).join("seeds");
        std::fs::create_dir_all(&seeds).unwrap();
        std::fs::write(seeds.join("binary.fbx"), document::binary(&tiny)).unwrap();
        std::fs::write(seeds.join("text.fbx"), document::text(7500, &tiny)).unwrap();
        return;
    }
    let golden = golden();
    for (name, file) in examples::all() {
        let document = file.document();
        for bytes in [document::binary(&document), document::text(7500, &document)] {
            let found = read(&format!("{name}.fbx"), &bytes);
            let compared = compare(&found, &golden[name]);
            let frames: usize = found.clips.iter().map(|found| found.clip.frames()).sum();
            assert!(compared >= 15 * frames, "{name}: {compared} in {frames} frames");
        }
    }
}

#[test]
fn names_with_a_namespace_have_roles() {
    for prefix in ["mixamorig:", "mixamorig1:", "Character1_"] {
        let mut file = examples::namespaced();
        for node in &mut file.nodes {
            node.name = node.name.replace("mixamorig:", prefix);
        }
        let found = read("a.fbx", &document::binary(&file.document()));
        let skeleton = found.clips[0].clip.skeleton();
        let roles = Roles::by_name(skeleton);
        for role in [Role::Hips, Role::Head, Role::foot(Side::Left), Role::hand(Side::Right)] {
            assert!(roles.get(role).is_some(), "{prefix} {role:?}");
        }
        assert_eq!(found.clips[0].clip.name(), "a");
    }
}

#[test]
fn unit_and_up_axis_are_those_of_the_file() {
    for (name, file) in examples::all() {
        let z_up = file.z_up;
        let found = read(name, &document::binary(&file.document()));
        let provenance = found.clips[0].measure.provenance;
        assert_eq!(provenance.metres_per_unit, 0.01, "{name}");
        assert_eq!(provenance.up == UpAxis::Z, z_up, "{name}");
        assert!(found.warnings.is_empty(), "{name}: {:?}", found.warnings);
    }
    // The body in metres, with a unit of centimetres stated: it would be a thumb tall.
    let mut file = examples::several_takes();
    for node in &mut file.nodes {
        node.place = node.place.map(|length| length / 100.0);
    }
    file.takes.clear();
    let found = read("small.fbx", &document::binary(&file.document()));
    assert_eq!(found.clips[0].measure.provenance.metres_per_unit, 1.0);
    let said: Vec<String> = found.warnings.iter().map(ToString::to_string).collect();
    assert!(said.iter().any(|line| line.contains("in the unit of the file")), "{said:?}");
}

#[test]
fn clip_of_a_rate_that_the_file_does_not_have_takes_that_of_the_keys() {
    let found = read("a.fbx", &document::binary(&examples::several_takes().document()));
    let clips: Vec<(&str, usize, f64)> = found
        .clips
        .iter()
        .map(|found| (found.clip.name(), found.clip.frames(), found.clip.fps()))
        .collect();
    assert_eq!(clips, [("Walk", 24, 120.0), ("Run", 30, 120.0)]);
    let options = ImportOptions { fps: Some(30.0), ..ImportOptions::default() };
    let bytes = document::binary(&examples::several_takes().document());
    let found = import("a.fbx", &bytes, &options).unwrap();
    assert_eq!((found.clips[0].clip.frames(), found.clips[0].clip.fps()), (7, 30.0));
}

#[test]
fn skin_at_rest_stands_where_it_was_bound() {
    let file = examples::namespaced();
    let skin = file.skin.clone().unwrap();
    let found = read("a.fbx", &document::binary(&file.document()));
    let mesh = found.clips[0].mesh.as_ref().unwrap();
    assert_eq!(mesh.triangles.len(), 3);
    assert!(mesh.colors.iter().all(|color| color[0] > 0.99 && color[2] < 0.01));
    // The joints at rest have the rotations in which the skin was bound, and its places.
    for vertex in &skin.vertices {
        let expected = Vec3::from_array(vertex.map(|length| (0.01 * length) as f32));
        let nearest = mesh.positions.iter().map(|place| place.distance(expected));
        let nearest = nearest.fold(f32::INFINITY, f32::min);
        assert!(nearest < 1e-4, "{expected} {:?}", mesh.positions);
    }
    assert_eq!(mesh.bind.len(), found.clips[0].clip.skeleton().len());
}

#[test]
fn layer_that_is_added_is_added() {
    let mut file = examples::several_takes();
    file.takes.truncate(1);
    let travel = rig::Track {
        node: 1,
        property: "Lcl Translation",
        values: vec![[0.0, 0.0, 0.0], [0.0, 0.0, 10.0], [0.0, 0.0, 20.0]],
        is_mixed: false,
    };
    let place = |file: &rig::File| {
        let clip = read("a.fbx", &document::binary(&file.document())).clips.remove(0).clip;
        let hips = clip.skeleton().joints().iter().position(|joint| joint.name == "Hips").unwrap();
        let joints = clip.skeleton().len();
        clip.world_positions(0..3).into_iter().skip(hips).step_by(joints).collect::<Vec<_>>()
    };
    let before = place(&file);
    file.takes[0].layers.push(vec![travel]);
    let after = place(&file);
    for (frame, (before, after)) in before.iter().zip(after).enumerate() {
        let expected = *before + Vec3::Z * (0.1 * frame as f32);
        assert!(after.distance(expected) < 1e-5, "{frame}: {before} {after}");
    }
}

#[test]
fn joint_that_grows_moves_what_hangs_on_it() {
    // A foot under a shin whose scale is animated: no rotation can say where it is.
    let mut file = examples::several_takes();
    let scales = [1.0, 1.5, 2.0].map(|scale| [scale; 3]).to_vec();
    let growth = rig::Track { node: 5, property: "Lcl Scaling", values: scales, is_mixed: false };
    file.takes = vec![rig::Take { name: "Grow".into(), layers: vec![vec![growth]] }];
    let clip = read("a.fbx", &document::binary(&file.document())).clips.remove(0).clip;
    let joints: Vec<&str> =
        clip.skeleton().joints().iter().map(|joint| joint.name.as_str()).collect();
    let at = |name: &str, frame: usize| {
        let index = joints.iter().position(|joint| *joint == name).unwrap();
        clip.world_positions(frame..frame + 1)[index]
    };
    let shin = Vec3::new(0.0, -0.42, -0.02).length();
    for (frame, scale) in [1.0, 1.5, 2.0].into_iter().enumerate() {
        let length = at("LeftLeg", frame).distance(at("LeftFoot", frame));
        assert!((length - scale * shin).abs() < 1e-5, "{frame}: {length}");
    }
}

#[test]
fn file_without_motion_is_its_rest_pose() {
    let mut file = examples::namespaced();
    file.takes.clear();
    let found = read("pose.fbx", &document::binary(&file.document()));
    assert_eq!((found.clips.len(), found.clips[0].clip.frames()), (1, 1));
    assert!(found.clips[0].mesh.is_some());
    assert_eq!(found.warnings[0].to_string(), "the file has a skeleton but no animation");
}

#[test]
fn file_without_skeleton_is_refused_with_a_sentence() {
    let mut file = examples::namespaced();
    file.nodes.clear();
    file.takes.clear();
    file.skin = None;
    let error = import("mesh.fbx", &document::binary(&file.document()), &ImportOptions::default());
    let error = error.unwrap_err();
    assert!(error.to_string().contains("without skeleton and without animation"), "{error}");
    assert!(error.hint.is_some());
}

#[test]
fn file_that_is_cut_off_anywhere_is_refused_or_read() {
    let document = examples::namespaced().document();
    for bytes in [document::binary(&document), document::text(7500, &document)] {
        let whole = read("a.fbx", &bytes);
        for part in 1..40 {
            let cut = &bytes[..bytes.len() * part / 40];
            match import("a.fbx", cut, &ImportOptions::default()) {
                Ok(found) => assert!(!found.clips.is_empty()),
                Err(error) => assert!(error.hint.is_some(), "{error}"),
            }
        }
        assert_eq!(whole.clips.len(), 1);
    }
}

#[test]
fn reading_stops_when_it_is_told_to() {
    let bytes = document::binary(&examples::several_takes().document());
    let mut calls = 0;
    let options = ImportOptions::default();
    let stopped = fbx::read_with_progress("a.fbx", &bytes, &|_| None, &options, &mut |_| {
        calls += 1;
        calls < 2
    });
    assert!(stopped.unwrap().is_none());
}

/// Checks that a file which was read is a motion with a consistent mesh.
fn is_whole(found: &ImportedFile) {
    assert!(!found.clips.is_empty());
    for found in &found.clips {
        let clip = &found.clip;
        let is_unit = |frame| clip.rotations(frame).iter().all(|q| q.is_normalized());
        assert!((0..clip.frames()).all(is_unit));
        assert!(clip.root_translations().iter().all(|place| place.is_finite()));
        if let Some(mesh) = &found.mesh {
            let vertices = mesh.positions.len();
            assert!(mesh.positions.iter().chain(&mesh.normals).all(|v| v.is_finite()));
            assert!(mesh.triangles.iter().flatten().all(|&vertex| (vertex as usize) < vertices));
            assert_eq!(mesh.bind.len(), clip.skeleton().len());
            let joints = mesh.bind.len();
            assert!(mesh.joints.iter().flatten().all(|&joint| usize::from(joint) < joints));
        }
    }
}

proptest! {
    #[test]
    fn bytes_that_are_changed_are_read_or_refused(
        is_text in any::<bool>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..4_u8), 1..12),
    ) {
        let document = examples::tiny().document();
        let mut bytes =
            if is_text { document::text(7500, &document) } else { document::binary(&document) };
        for (place, byte, how) in changes {
            let at = place.index(bytes.len());
            match how {
                0 => bytes[at] = byte,
                1 => bytes[at] ^= 1 << (byte % 8),
                2 => drop(bytes.remove(at)),
                _ => bytes.insert(at, byte),
            }
        }
        let options = ImportOptions { max_bytes: 16 << 20, ..ImportOptions::default() };
        if let Ok(found) = fbx::read("changed.fbx", &bytes, &options) {
            is_whole(&found);
        }
    }
}
