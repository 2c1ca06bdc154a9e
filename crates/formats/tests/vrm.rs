//! A VRM animation, and its motion on bodies of VRM 1.0 and 0.x, compared with three.js and
//! three-vrm (`tests/oracles/vrm.mjs`, which also writes the files).

#![expect(clippy::unwrap_used, reason = "helpers of tests: what fails here fails the test")]

use glam::Vec3;
use segue_formats::{FileKind, ImportOptions, ImportedClip, import, kind_of};
use segue_motion::skeleton::{Retargeting, Role, RoleSource, world_pose};
use serde_json::Value;

const MOTION: &[u8] = include_bytes!("cases/vrm/motion.vrma");
const ONE: &[u8] = include_bytes!("cases/vrm/one.vrm");
const ZERO: &[u8] = include_bytes!("cases/vrm/zero.vrm");
const EXPECTED: &str = include_str!("cases/vrm/expected.json");

/// The greatest distance from the oracle's joints, metres.
const MAX_ERROR_M: f32 = 1e-4;

fn read(name: &str, bytes: &[u8]) -> ImportedClip {
    let imported = import(name, bytes, &ImportOptions::default()).unwrap();
    assert_eq!(imported.clips.len(), 1);
    imported.clips.into_iter().next().unwrap()
}

/// Returns the nodes of the bones by the order of the oracle: nodes have names that tell nothing,
/// or those of the bones.
fn node_names(bytes: &[u8]) -> Vec<String> {
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let json: Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    let nodes = json["nodes"].as_array().unwrap();
    nodes[1..24].iter().map(|node| node["name"].as_str().unwrap().to_owned()).collect()
}

/// Returns the positions of the oracle: for each frame those of all bones.
fn expected(file: &str) -> Vec<Vec<Vec3>> {
    let all: Value = serde_json::from_str(EXPECTED).unwrap();
    serde_json::from_value(all[file].clone()).unwrap()
}

/// Returns the farthest distance of the bones' joints from the oracle's.
fn farthest(file: &str, names: &[String], frame: impl Fn(usize, &str) -> Vec3) -> f32 {
    let expected = expected(file);
    assert_eq!((expected.len(), expected[0].len()), (24, names.len()));
    let distances = expected.iter().enumerate().flat_map(|(index, bones)| {
        bones
            .iter()
            .zip(names)
            .map(|(bone, name)| frame(index, name).distance(*bone))
            .collect::<Vec<_>>()
    });
    distances.fold(0.0, f32::max)
}

#[test]
fn animation_of_vrm_moves_as_in_three_js() {
    assert_eq!(kind_of("a/Motion.VRMA", MOTION), FileKind::Vrma);
    let own = read("motion.vrma", MOTION);
    let clip = &own.clip;
    assert_eq!((clip.name(), clip.frames(), clip.fps()), ("sway", 24, 30.0));
    let error = farthest("motion.vrma", &node_names(MOTION), |frame, name| {
        clip.world_pose(frame).positions[clip.skeleton().find(name).unwrap()]
    });
    assert!(error < MAX_ERROR_M, "{error} m");
}

#[test]
fn animation_on_vrm_bodies_is_as_by_three_vrm() {
    let motion = read("motion.vrma", MOTION);
    let roles = motion.roles.unwrap();
    for (name, bytes) in [("one.vrm", ONE), ("zero.vrm", ZERO)] {
        assert_eq!(kind_of(name, bytes), FileKind::Vrm);
        let body = read(name, bytes);
        let (skeleton, own) = (body.clip.skeleton(), body.roles.unwrap());
        for role in Role::ALL {
            assert_eq!(own.source(role), Some(RoleSource::ByFile), "{name}: {role:?}");
        }
        let way = Retargeting::new(motion.clip.skeleton(), &roles, skeleton, &own).unwrap();
        let poses: Vec<_> = (0..24)
            .map(|frame| world_pose(skeleton, &way.pose(&motion.clip.pose(frame))))
            .collect();
        let error = farthest(name, &node_names(bytes), |frame, name| {
            poses[frame].positions[skeleton.find(name).unwrap()]
        });
        assert!(error < MAX_ERROR_M, "{name}: {error} m");
    }
}
