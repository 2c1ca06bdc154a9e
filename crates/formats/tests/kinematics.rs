//! World positions of joints with every kind of channel, compared with an independent reader
//! (`tests/cases/bvh_kinematics/oracle.py`).

#![expect(clippy::unwrap_used, reason = "helpers of tests: what fails here fails the test")]

mod common;

use glam::Vec3;
use segue_formats::{ImportOptions, import};
use segue_motion::clip::UpAxis;
use std::collections::BTreeMap;

const INPUT: &str = include_str!("cases/bvh_kinematics/input.bvh");
const EXPECTED: &str = include_str!("cases/bvh_kinematics/expected.txt");

fn check(up: UpAxis, metres_per_unit: f64, world_from_file: impl Fn(Vec3) -> Vec3) {
    let options = ImportOptions {
        metres_per_unit: Some(metres_per_unit),
        up: Some(up),
        ..ImportOptions::default()
    };
    let imported = import("input.bvh", INPUT.as_bytes(), &options).unwrap();
    let warnings: Vec<String> = imported.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(warnings[0], "3 scale channels (first: line 13) ignored");
    // The numbers of this file are random: in metres they are far apart.
    let wild = "1 jump of the root from one frame to the next, up to 5.1 m";
    assert!(warnings[1..].iter().all(|warning| warning == wild), "{warnings:?}");
    let clip = &imported.clips[0].clip;
    assert_eq!(
        (clip.frames(), clip.fps(), clip.provenance().metres_per_unit),
        (3, 25.0, metres_per_unit)
    );
    let mut checked = 0;
    for line in EXPECTED.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        let frame: usize = words[0].parse().unwrap();
        let at: Vec<f32> = words[2..].iter().map(|word| word.parse().unwrap()).collect();
        let expected = world_from_file(Vec3::from_slice(&at));
        let world = clip.world_pose(frame);
        let found = match words[1].strip_suffix("_end") {
            Some(name) => {
                let joint = clip.skeleton().find(name).unwrap();
                world.point(joint, clip.skeleton().joints()[joint].end_site.unwrap())
            }
            None => world.positions[clip.skeleton().find(words[1]).unwrap()],
        };
        assert!(found.distance(expected) < 2e-6 * expected.length().max(1.0), "{line}: {found}");
        checked += 1;
    }
    assert_eq!(checked, 3 * 9);
}

#[test]
fn world_positions_equal_the_oracle() {
    check(UpAxis::Y, 1.0, |p| p);
    check(UpAxis::Y, 0.01, |p| p * 0.01);
}

#[test]
fn world_positions_with_z_up_are_rotated() {
    check(UpAxis::Z, 1.0, |p| Vec3::new(p.x, p.z, -p.y));
}

#[test]
fn translations_exist_only_for_moving_joints() {
    let (found, _) = common::one(INPUT);
    let moving: BTreeMap<&str, usize> = found
        .clip
        .translations()
        .iter()
        .map(|t| (found.clip.skeleton().joints()[t.joint].name.as_str(), t.values.len()))
        .collect();
    assert_eq!(moving, BTreeMap::from([("Arm", 3), ("Fin", 3)]));
}
