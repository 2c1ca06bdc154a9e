//! Artefact metrics of captured takes, and of takes that were damaged on purpose, compared with an
//! independent implementation (`tests/oracles/artefacts.py`).

#![expect(clippy::unwrap_used, reason = "helpers of tests: what fails here fails the test")]

use glam::{Quat, Vec3};
use segue_formats::{ImportOptions, import, unpack_gzip};
use segue_motion::clip::Clip;
use segue_motion::math::stats;
use segue_motion::metrics::MotionTrace;
use segue_motion::skeleton::Roles;
use std::sync::Arc;

#[derive(serde::Deserialize)]
struct Case {
    take: String,
    sources: Vec<String>,
    change: Option<Change>,
    numbers: Numbers,
}

#[derive(serde::Deserialize)]
struct Change {
    kind: String,
    #[serde(default)]
    frame: usize,
    #[serde(default)]
    joint: String,
    amount: f32,
}

#[derive(serde::Deserialize)]
struct Numbers {
    frames: usize,
    flashes: usize,
    spins: usize,
    root_jumps: usize,
    max_turn_deg: f64,
    stances: usize,
    stance_median_cm: Option<f64>,
    stance_p90_cm: Option<f64>,
    skating_cm_per_sec: f64,
}

fn take(name: &str) -> Clip {
    let path = format!("{}/assets/samples/{name}.bvh.gz", env!("CARGO_MANIFEST_DIR"));
    let file = format!("{name}.bvh");
    let bytes = unpack_gzip(&file, &std::fs::read(path).unwrap(), 1 << 26).unwrap();
    import(&file, &bytes, &ImportOptions::default()).unwrap().clips.remove(0).clip
}

/// Returns a clip with a change applied to each frame.
fn altered(clip: &Clip, change: impl Fn(usize, &mut [Quat], &mut Vec3)) -> Clip {
    let (mut rotations, mut roots) = (Vec::new(), Vec::new());
    for frame in 0..clip.frames() {
        let (mut pose, mut root) =
            (clip.rotations(frame).to_vec(), clip.root_translations()[frame]);
        change(frame, &mut pose, &mut root);
        rotations.extend(pose);
        roots.push(root);
    }
    Clip::new("changed", Arc::clone(clip.skeleton()), clip.fps(), rotations, roots).unwrap()
}

/// Returns the median over the frames of the body's height, from the lowest to the highest joint or
/// end, m.
fn height_m(clip: &Clip) -> f32 {
    let ends: Vec<(usize, Vec3)> = (clip.skeleton().joints().iter().enumerate())
        .filter_map(|(index, joint)| Some((index, joint.end_site?)))
        .collect();
    let height = |frame| {
        let world = clip.world_pose(frame);
        let tips = ends.iter().map(|&(joint, end)| world.point(joint, end).y);
        let (low, high) = (world.positions.iter().map(|point| point.y).chain(tips))
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)));
        high - low
    };
    let heights: Vec<f32> = (0..clip.frames()).map(height).collect();
    stats::percentile(&heights, 0.5).expect("a clip has frames")
}

fn changed(clip: &Clip, how: &Change) -> Clip {
    let (height, fps) = (height_m(clip), clip.fps() as f32);
    let joint = clip.skeleton().find(&how.joint).unwrap_or(0);
    let behind = |frame: usize| frame >= how.frame;
    altered(clip, |frame, pose, root| match how.kind.as_str() {
        "flash" if behind(frame) => pose[joint] *= Quat::from_rotation_x(how.amount.to_radians()),
        "spin" => {
            let share = ((frame as f32 - how.frame as f32) / 12.0).clamp(0.0, 1.0);
            pose[0] = Quat::from_rotation_y((share * how.amount).to_radians()) * pose[0];
        }
        "jump" if behind(frame) => root.x += how.amount * height,
        "pull" => root.x += how.amount * height * frame as f32 / fps,
        _ => {}
    })
}

#[test]
fn artefacts_of_takes_equal_the_oracle() {
    let cases: Vec<Case> = serde_json::from_str(include_str!("oracles/artefacts.json")).unwrap();
    assert!(cases.len() > 10);
    let close = |a: f64, b: f64| (a - b).abs() <= 0.01 * b.abs() + 1e-3;
    for (index, case) in cases.iter().enumerate() {
        let clip = take(&case.take);
        let clip =
            case.change.as_ref().map_or_else(|| clip.clone(), |change| changed(&clip, change));
        let trace = |clip: &Clip| MotionTrace::new(clip, &Roles::detect(clip.skeleton()));
        let sources: Vec<MotionTrace> =
            case.sources.iter().map(|name| trace(&take(name))).collect();
        let (own, expected) = (trace(&clip), &case.numbers);
        let found = own.beside(&sources.iter().collect::<Vec<_>>());
        assert_eq!(clip.frames(), expected.frames, "{index}");
        assert_eq!(found.flashes, expected.flashes, "{index}: {found:?}");
        assert_eq!(found.spins, expected.spins, "{index}");
        assert_eq!(found.root_jumps, expected.root_jumps, "{index}");
        assert_eq!(own.stances_cm().len(), expected.stances, "{index}");
        assert!(
            close(own.max_turn_deg(), expected.max_turn_deg),
            "{index}: {}",
            own.max_turn_deg()
        );
        let skating = own.skating_cm_per_sec().unwrap();
        assert!(close(skating, expected.skating_cm_per_sec), "{index}: {skating}");
        let stances: Vec<f32> = own.stances_cm().iter().map(|cm| *cm as f32).collect();
        for (share, cm) in [(0.5, expected.stance_median_cm), (0.9, expected.stance_p90_cm)] {
            let found = stats::percentile(&stances, share).map(f64::from);
            assert_eq!(found.is_some(), cm.is_some(), "{index}");
            assert!(
                found.zip(cm).is_none_or(|(found, cm)| close(found, cm)),
                "{index}: {found:?} {cm:?}"
            );
        }
    }
}

#[test]
fn artefacts_of_a_part_of_its_source_are_none() {
    // Its one glitch is faster than twice the 99.9th percentile, and yet its own.
    let clip = take("01_01");
    let roles = Roles::detect(clip.skeleton());
    let whole = MotionTrace::new(&clip, &roles);
    let found = whole.beside(&[&whole]);
    assert!(found.flashes == 1 && found.new_flashes.is_empty(), "{found:?}");
    assert_eq!((found.root_jumps, found.new_root_jumps, found.spins), (0, 0, 0));
    let joint = clip.skeleton().find("LeftForeArm").unwrap();
    let snapped = altered(&clip, |frame, pose, _| {
        if frame > 900 {
            pose[joint] *= Quat::from_rotation_x(1.2);
        }
    });
    let found = MotionTrace::new(&snapped, &roles).beside(&[&whole]);
    let [flash] = found.new_flashes[..] else { panic!("{found:?}") };
    assert!((flash.frame, flash.joint) == (900, joint) && flash.times > 2.0, "{flash:?}");
}
