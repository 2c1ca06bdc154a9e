//! Markers on a synthesised walk, whose joints are known.

use super::body_from_markers;
use crate::clip::{Clip, UpAxis};
use crate::points::{PointSet, skeleton_from_points};
use crate::skeleton::{Skeleton, WorldPose};
use crate::synth::{Action, Params, synthesize};
use glam::Vec3;
use std::sync::Arc;

/// Returns labels and positions of markers on a walk, millimetres: with or without the medial ones.
fn markers(clip: &Clip, medial: bool) -> (Vec<String>, Vec<Vec3>) {
    let joint = |name: &str| clip.skeleton().find(name).unwrap();
    let mut world = WorldPose::default();
    let mut labels: Vec<String> = Vec::new();
    let mut positions = Vec::new();
    for frame in 0..clip.frames() {
        clip.world_pose_into(frame, &mut world);
        let mut row: Vec<(String, Vec3)> = Vec::new();
        let at = |name: &str, offset: Vec3| world.point(joint(name), offset);
        let hip_y = -0.035;
        // The pelvis whose hip joints, by the regression, are those of the skeleton.
        let (wide, deep) = ((0.091 - 0.0073) / 0.33, 0.15);
        let (up, ahead) = (hip_y + 0.30 * wide + 0.0109, 0.24 * deep + 0.0099);
        for (side, sign) in [("L", 1.0), ("R", -1.0)] {
            let long = if side == "L" { "Left" } else { "Right" };
            let mut add = |name: &str, place: Vec3| row.push((format!("{side}{name}"), place));
            let x = |x: f32| Vec3::new(sign * x, 0.0, 0.0);
            add("ASI", at("Hips", Vec3::new(sign * wide * 0.5, up, ahead)));
            add("PSI", at("Hips", Vec3::new(sign * 0.04, up, ahead - deep)));
            add("KNE", at(&format!("{long}UpLeg"), Vec3::new(sign * 0.058, -0.42875, 0.0)));
            add("ANK", at(&format!("{long}Leg"), Vec3::new(sign * 0.044, -0.4305, 0.0)));
            add("HEE", at(&format!("{long}Foot"), Vec3::new(0.0, -0.03, -0.06)));
            add("TOE", at(&format!("{long}Toe"), Vec3::ZERO));
            let neck_hips = at("Neck", Vec3::ZERO) - at("Hips", x(0.0) + Vec3::Y * hip_y);
            let up_trunk = neck_hips.normalize_or_zero() * (0.17 * 0.392);
            add("SHO", at(&format!("{long}Arm"), Vec3::ZERO) + up_trunk);
            add("ELB", at(&format!("{long}ForeArm"), Vec3::Y * 0.042));
            add("WRA", at(&format!("{long}Hand"), Vec3::Z * 0.03));
            add("WRB", at(&format!("{long}Hand"), Vec3::Z * -0.03));
            add("FHD", at("Head", Vec3::new(sign * 0.07, 0.1, 0.09)));
            add("BHD", at("Head", Vec3::new(sign * 0.07, 0.1, -0.09)));
            if medial {
                add(
                    "KneeMed",
                    at(&format!("{long}UpLeg"), Vec3::new(sign * -0.058, -0.42875, 0.0)),
                );
                add("AnkleMed", at(&format!("{long}Leg"), Vec3::new(sign * -0.044, -0.4305, 0.0)));
                add("ElbowMed", at(&format!("{long}ForeArm"), Vec3::Y * -0.042));
            }
        }
        row.push(("C7".into(), at("Neck", Vec3::Z * -0.06)));
        row.push(("CLAV".into(), at("Neck", Vec3::Z * 0.06)));
        row.push(("T10".into(), at("Spine2", Vec3::Z * -0.1)));
        row.push(("STRN".into(), at("Spine2", Vec3::Z * 0.1)));
        row.push(("Cup".into(), Vec3::ONE));
        labels = row.iter().map(|(label, _)| label.clone()).collect();
        positions.extend(row.iter().map(|(_, place)| *place * 1000.0));
    }
    (labels, positions)
}

/// Returns the mean distance of each joint from that of the walk, metres, by name.
fn errors(clip: &Clip, labels: &[String], positions: &[Vec3]) -> Vec<(&'static str, f32)> {
    let body = body_from_markers(labels, positions, 1e-3).unwrap();
    let set = PointSet {
        points: &body.points,
        positions: &body.positions,
        fps: clip.fps(),
        up: UpAxis::Y,
    };
    let fit = skeleton_from_points(&set).unwrap();
    let skeleton = Arc::new(Skeleton::new(fit.joints).unwrap());
    let found =
        Clip::new("fit", skeleton, clip.fps(), fit.rotations, fit.root_translations).unwrap();
    let names = [
        "LeftUpLeg",
        "RightUpLeg",
        "LeftLeg",
        "RightLeg",
        "LeftFoot",
        "RightFoot",
        "LeftToe",
        "RightToe",
        "Neck",
        "LeftArm",
        "RightArm",
        "LeftForeArm",
        "RightForeArm",
        "LeftHand",
        "RightHand",
    ];
    let truth = clip.world_positions(0..clip.frames());
    let here = found.world_positions(0..found.frames());
    let mean = |name: &&'static str| {
        let (a, b) = (clip.skeleton().find(name).unwrap(), found.skeleton().find(name).unwrap());
        let (n, m) = (clip.skeleton().len(), found.skeleton().len());
        let sum: f32 = (0..clip.frames())
            .map(|frame| truth[frame * n + a].distance(here[frame * m + b] * 1e-3))
            .sum();
        (*name, sum / clip.frames() as f32)
    };
    names.iter().map(mean).collect()
}

#[test]
fn markers_of_both_sides_of_joints_give_their_centres() {
    let walk = synthesize(&Params::new(Action::Walk)).unwrap().clip;
    let (labels, positions) = markers(&walk, true);
    for (name, error) in errors(&walk, &labels, &positions) {
        assert!(error < 0.006, "{name}: {error}");
    }
}

#[test]
fn lateral_markers_alone_give_centres_within_one_centimetre() {
    let walk = synthesize(&Params::new(Action::Walk)).unwrap().clip;
    let (labels, mut positions) = markers(&walk, false);
    // Noise of 3 mm, and gaps of a fifth of a second in every marker.
    let markers = labels.len();
    for (index, at) in positions.iter_mut().enumerate() {
        let (frame, marker) = (index / markers, index % markers);
        let wave = |k: f32| (index as f32 * k).sin() * 3.0;
        *at += Vec3::new(wave(12.9), wave(78.2), wave(37.7));
        if (20 + marker..26 + marker).contains(&frame) {
            *at = Vec3::NAN;
        }
    }
    for (name, error) in errors(&walk, &labels, &positions) {
        assert!(error < 0.01, "{name}: {error}");
    }
}

#[test]
fn labels_without_hips_or_legs_make_no_body() {
    let none =
        |labels: &[&str]| body_from_markers(labels, &vec![Vec3::ONE; labels.len()], 1e-3).is_none();
    assert!(none(&[]));
    assert!(none(&["M1", "M2", "M3"]));
    assert!(none(&["LASI", "RASI", "SACR"]));
    assert!(none(&["LASI", "RASI", "LKNE", "LANK"]), "without the back of the pelvis");
    assert!(!none(&["LASI", "RASI", "SACR", "LKNE", "LANK"]));
    assert!(!none(&["left_hip", "right_hip", "left_knee", "left_ankle"]));
}
