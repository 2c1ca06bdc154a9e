//! Tests of written FBX files, read back.

use super::*;
use crate::{ImportOptions, ImportedFile, import};
use proptest::prelude::*;
use segue_motion::clip::JointTranslations;
use segue_motion::clip::fixtures::wander_by;
use segue_motion::skeleton::fixtures as rigs;
use segue_motion::skeleton::{Joint, Roles};
use segue_motion::synth::{Action, Params, synthesize};
use std::sync::Arc;

/// Tolerance for positions, metres.
const TOLERANCE: f32 = 1e-4;

fn read(bytes: &[u8]) -> ImportedFile {
    import("own.fbx", bytes, &ImportOptions::default()).unwrap()
}

fn read_one(bytes: &[u8]) -> Clip {
    let mut file = read(bytes);
    assert_eq!(file.clips.len(), 1);
    file.clips.remove(0).clip
}

/// Returns the greatest distance of two motions' joints, found by their names, metres. The joints
/// above the one that carries the body are not among those that the reader returns.
fn apart(a: &Clip, b: &Clip) -> f32 {
    assert_eq!(a.frames(), b.frames());
    let above = b.skeleton().folded_chain().map_or(0, |above| above.joints().count());
    assert_eq!(a.skeleton().len(), b.skeleton().len() + above);
    let own: Vec<(usize, usize)> = b
        .skeleton()
        .joints()
        .iter()
        .enumerate()
        .map(|(joint, own)| (a.skeleton().find(&own.name).unwrap(), joint))
        .collect();
    let mut most = 0.0_f32;
    for frame in 0..a.frames() {
        let (here, there) = (a.world_pose(frame), b.world_pose(frame));
        for &(joint, other) in &own {
            most = most.max(here.positions[joint].distance(there.positions[other]));
        }
    }
    most
}

fn made(action: Action) -> Clip {
    synthesize(&Params::new(action)).unwrap().clip
}

#[test]
fn fbx_in_any_unit_and_axes_is_the_same_motion() {
    let walk = made(Action::Walk);
    for metres_per_unit in [None, Some(1.0), Some(0.01), Some(0.0254), Some(f64::NAN)] {
        for up in [None, Some(UpAxis::Y), Some(UpAxis::Z)] {
            let options = FbxOptions { metres_per_unit, up, fps: None };
            let bytes = write_fbx(&[&walk], &options).unwrap();
            assert_eq!(bytes, write_fbx(&[&walk], &options).unwrap());
            let file = read(&bytes);
            assert_eq!(file.warnings, [], "{options:?}");
            let back = &file.clips[0].clip;
            let unit = metres_per_unit.filter(|unit| unit.is_finite()).unwrap_or(0.01);
            assert!((back.provenance().metres_per_unit - unit).abs() < 1e-9);
            assert_eq!(back.provenance().up, up.unwrap_or(UpAxis::Y));
            assert!((back.fps() - walk.fps()).abs() < 1e-9);
            assert!(apart(&walk, back) < TOLERANCE, "{options:?}: {} m", apart(&walk, back));
            let ends = |clip: &Clip| -> Vec<bool> {
                clip.skeleton().joints().iter().map(|joint| joint.end_site.is_some()).collect()
            };
            assert_eq!(ends(back), ends(&walk));
        }
    }
}

/// Returns a motion turned as a whole, and its rest pose turned as well or left as it is.
fn turned(clip: &Clip, turn: Quat, with_rest: bool) -> Clip {
    let skeleton = clip.skeleton();
    let rest = if with_rest { turn } else { Quat::IDENTITY };
    let joints = skeleton.joints().iter().map(|joint| Joint {
        offset: rest * joint.offset,
        end_site: joint.end_site.map(|end| rest * end),
        ..joint.clone()
    });
    let turned = Arc::new(Skeleton::new(joints.collect()).unwrap());
    let rotations = (0..clip.frames()).flat_map(|frame| {
        clip.rotations(frame).iter().enumerate().map(move |(joint, &rotation)| {
            let before = if joint == 0 { turn } else { rest };
            before * rotation * rest.inverse()
        })
    });
    let rotations = rotations.collect();
    let roots = clip.root_translations().iter().map(|&at| turn * at).collect();
    Clip::new(clip.name(), turned, clip.fps(), rotations, roots).unwrap()
}

#[test]
fn fbx_of_a_body_that_stands_or_lies_is_not_turned() {
    let walk = made(Action::Walk);
    let on_its_back = Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2);
    for (turn, with_rest) in [
        (Quat::IDENTITY, false),
        (on_its_back, false),
        (on_its_back, true),
        (on_its_back.inverse(), true),
    ] {
        let clip = turned(&walk, turn, with_rest);
        for up in [UpAxis::Y, UpAxis::Z] {
            let options = FbxOptions { up: Some(up), ..FbxOptions::default() };
            let bytes = write_fbx(&[&clip], &options).unwrap();
            let back = read_one(&bytes);
            assert_eq!(back.provenance().up, up);
            assert!(apart(&clip, &back) < TOLERANCE, "{turn} {up:?}: {} m", apart(&clip, &back));
            // The other axis is the user's word, for files that state theirs wrongly.
            let other = if up == UpAxis::Y { UpAxis::Z } else { UpAxis::Y };
            let given = ImportOptions { up: Some(other), ..ImportOptions::default() };
            let back = import("own.fbx", &bytes, &given).unwrap().clips.remove(0).clip;
            let toward = if up == UpAxis::Z { on_its_back.inverse() } else { on_its_back };
            let expected = turned(&clip, toward, true);
            assert!(apart(&expected, &back) < TOLERANCE, "{turn} {up:?} as {other:?}");
        }
    }
}

#[test]
fn fbx_at_another_rate_has_its_frames() {
    let walk = made(Action::Walk);
    for fps in [30.0, 24.0, 29.97, 12.5, 119.88] {
        let options = FbxOptions { fps: Some(fps), ..FbxOptions::default() };
        let back = read_one(&write_fbx(&[&walk], &options).unwrap());
        assert!((back.fps() - fps).abs() < 1e-3, "{} of {fps}", back.fps());
        let expected = resample(&walk, fps, Interpolation::default()).unwrap();
        assert!(apart(&expected, &back) < TOLERANCE);
    }
}

#[test]
fn fbx_of_several_clips_has_a_take_for_each() {
    let walk = made(Action::Walk);
    let run = made(Action::Run);
    let short = walk.crop(3..10).unwrap().with_name("short");
    let bytes = write_fbx(&[&walk, &run, &short], &FbxOptions::default()).unwrap();
    let file = read(&bytes);
    assert_eq!(file.clips.len(), 3);
    for (clip, back) in [&walk, &run, &short].into_iter().zip(&file.clips) {
        assert_eq!(back.clip.name(), clip.name());
        assert!(apart(clip, &back.clip) < TOLERANCE, "{}", clip.name());
    }
}

#[test]
fn fbx_of_clips_with_other_bones_moves_them_there() {
    let walk = made(Action::Walk);
    let long = Arc::new(walk.skeleton().scaled(1.25));
    let rotations = (0..walk.frames()).flat_map(|f| walk.rotations(f).to_vec()).collect();
    let roots = walk.root_translations().to_vec();
    let tall = Clip::new("tall", long, walk.fps(), rotations, roots).unwrap();
    let file = read(&write_fbx(&[&walk, &tall], &FbxOptions::default()).unwrap());
    assert!(apart(&walk, &file.clips[0].clip) < TOLERANCE);
    assert!(apart(&tall, &file.clips[1].clip) < TOLERANCE);
}

#[test]
fn fbx_of_unrelated_clips_or_none_is_refused() {
    let walk = made(Action::Walk);
    let other = wander_by(&rigs::mixamo(), 4, 1, 0.3).with_name("other");
    let refused = write_fbx(&[&walk, &other], &FbxOptions::default());
    let expected =
        FbxWriteError::OtherSkeleton { clip: "other".into(), first: walk.name().to_owned() };
    assert_eq!(refused, Err(expected));
    assert_eq!(write_fbx(&[], &FbxOptions::default()), Err(FbxWriteError::NoClips));
}

#[test]
fn fbx_of_a_still_clip_keeps_its_frames() {
    let walk = made(Action::Walk);
    let still =
        Clip::from_poses("still", Arc::clone(walk.skeleton()), 24.0, vec![walk.pose(3); 50]);
    let still = still.unwrap();
    let back = read_one(&write_fbx(&[&still], &FbxOptions::default()).unwrap());
    assert_eq!((back.frames(), back.fps()), (50, 24.0));
    assert!(apart(&still, &back) < TOLERANCE);
}

#[test]
fn fbx_of_one_frame_and_of_none_is_read() {
    let walk = made(Action::Walk);
    let one = walk.crop(5..6).unwrap();
    let back = read_one(&write_fbx(&[&one], &FbxOptions::default()).unwrap());
    assert_eq!(back.frames(), 1);
    assert!(apart(&one, &back) < TOLERANCE);
    let none = Clip::new("none", walk.skeleton().clone(), 30.0, vec![], vec![]).unwrap();
    let back = read_one(&write_fbx(&[&none], &FbxOptions::default()).unwrap());
    assert_eq!(back.skeleton().len(), walk.skeleton().len());
}

#[test]
fn fbx_of_a_joint_that_moves_has_its_places() {
    let skeleton = rigs::mixamo();
    let clip = wander_by(&skeleton, 12, 7, 2.0);
    let places = |joint: usize| -> Vec<Vec3> {
        let at = skeleton.joints()[joint].offset;
        (0..12).map(|frame| at + 0.01 * Vec3::new(frame as f32, 1.0, -(frame as f32))).collect()
    };
    let tracks = [3, 9].map(|joint| JointTranslations { joint, values: places(joint) });
    let clip = clip.with_translations(tracks.to_vec()).unwrap();
    let back = read_one(&write_fbx(&[&clip], &FbxOptions::default()).unwrap());
    assert!(apart(&clip, &back) < TOLERANCE);
}

#[test]
fn fbx_of_odd_names_is_read() {
    let names = ["", "  ", "left\0\u{1}foot", "左腳", "a:b|c", "twice", "twice"];
    let joints = names.iter().enumerate().map(|(index, name)| Joint {
        name: (*name).into(),
        parent: index.checked_sub(1),
        offset: Vec3::new(0.0, 0.3, 0.1),
        end_site: None,
        channels: vec![],
    });
    let skeleton = Arc::new(Skeleton::new(joints.collect()).unwrap());
    let clip = wander_by(&skeleton, 5, 2, 1.0).with_name("a\0b|c");
    let back = read_one(&write_fbx(&[&clip], &FbxOptions::default()).unwrap());
    let found: Vec<&str> = back.skeleton().joints().iter().map(|j| j.name.as_str()).collect();
    assert_eq!(found, ["unnamed", "unnamed", "left  foot", "左腳", "a:b|c", "twice", "twice"]);
    for frame in 0..5 {
        let (here, there) = (clip.world_pose(frame), back.world_pose(frame));
        for (p, q) in here.positions.iter().zip(&there.positions) {
            assert!(p.distance(*q) < TOLERANCE);
        }
    }
}

#[test]
fn fbx_angles_go_on_beyond_half_a_turn() {
    let joints = |name: &str, parent| Joint {
        name: name.into(),
        parent,
        offset: Vec3::Y,
        end_site: None,
        channels: vec![],
    };
    let skeleton = Arc::new(Skeleton::new(vec![joints("a", None), joints("b", Some(0))]).unwrap());
    let turn = |frame: usize| Quat::from_rotation_y(0.3 * frame as f32);
    let rotations = (0..60).flat_map(|frame| [turn(frame), turn(2 * frame)]).collect();
    let clip = Clip::new("spin", skeleton.clone(), 30.0, rotations, vec![Vec3::ZERO; 60]).unwrap();
    let axes = FileAxes { units_per_metre: 1.0, up: UpAxis::Y };
    let take = Take::new("take".into(), &clip, &skeleton, axes);
    for channel in take.channels.iter().filter(|channel| channel.property == ROTATION) {
        let step = if channel.model == 0 { 0.3 } else { 0.6_f32 };
        assert_eq!([0, 2].map(|axis| channel.values[axis].len()), [1, 1]);
        for (frame, value) in channel.values[1].iter().enumerate() {
            assert!((value - (step * frame as f32).to_degrees()).abs() < 1e-2);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn fbx_of_any_motion_is_read_back(
        seed in any::<u64>(),
        rig in 0usize..5,
        frames in 1usize..20,
        radians in 0.0f32..3.0,
    ) {
        let rig = [rigs::cmu_asf, rigs::lafan, rigs::bandai, rigs::biped, rigs::games105][rig]();
        let clip = wander_by(&rig, frames, seed, radians);
        let back = read_one(&write_fbx(&[&clip], &FbxOptions::default()).unwrap());
        prop_assert!(apart(&clip, &back) < TOLERANCE);
        prop_assert_eq!(
            Roles::detect(back.skeleton()).get(segue_motion::skeleton::Role::Hips).is_some(),
            Roles::detect(clip.skeleton()).get(segue_motion::skeleton::Role::Hips).is_some()
        );
    }
}
