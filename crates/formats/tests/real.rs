//! Captured motion from public databases: it loads with the right size and up axis, and reads back
//! equal from a written file.

mod common;

use common::{bvh_files, points, shared_data};
use segue_formats::bvh::{WriteOptions, write};
use segue_formats::{CMU_METRES_PER_UNIT, ImportOptions, import};
use segue_motion::clip::{Clip, UpAxis};
use segue_motion::math::quat;

/// Returns the height of the body, metres: the median over all frames of the extent from the lowest
/// to the highest joint or end site.
fn standing_height(clip: &Clip) -> f32 {
    let height = |frame: usize| {
        let ys: Vec<f32> = points(clip, frame).iter().map(|p| p.y).collect();
        ys.iter().copied().fold(f32::MIN, f32::max) - ys.iter().copied().fold(f32::MAX, f32::min)
    };
    let mut heights: Vec<f32> = (0..clip.frames()).step_by(5).map(height).collect();
    heights.sort_by(f32::total_cmp);
    heights[heights.len() / 2]
}

/// Returns the length that conversions of CMU motion lose, metres: their `Neck` has no OFFSET,
/// where the database has a bone (thorax) as long as the one below it, `Spine1`.
fn lost_in_conversion(clip: &Clip) -> f32 {
    let joints = clip.skeleton().joints();
    let neck = joints.iter().find(|joint| joint.name == "Neck" && joint.offset == glam::Vec3::ZERO);
    neck.and_then(|neck| neck.parent).map_or(0.0, |spine| joints[spine].offset.length())
}

/// Returns the lowest point of the median frame, metres above the ground.
fn feet_above_ground(clip: &Clip) -> f32 {
    let low = |frame: usize| points(clip, frame).iter().map(|p| p.y).fold(f32::MAX, f32::min);
    let mut lows: Vec<f32> = (0..clip.frames()).step_by(5).map(low).collect();
    lows.sort_by(f32::total_cmp);
    lows[lows.len() / 2]
}

#[test]
fn captured_people_have_plausible_height_and_ground_contact() {
    let Some(data) = shared_data() else { return };
    // Name, joints, frames after the T-pose row, frames per second, metres per unit, and whether
    // there is a T-pose row.
    let expected = [
        ("01_01.bvh", 31, 2751, 120.0, CMU_METRES_PER_UNIT, true),
        ("pirouette.bvh", 43, 591, 120.0, 0.01, true),
        ("run.bvh", 31, 74, 120.0, CMU_METRES_PER_UNIT, true),
        ("idle.bvh", 20, 200, 60.0, 1.0, false),
        ("run_forward.bvh", 20, 45, 60.0, 1.0, false),
        ("walkF.bvh", 20, 182, 60.0, 1.0, false),
        ("walk_and_ture_right.bvh", 20, 197, 60.0, 1.0, false),
        ("walk_and_turn_left.bvh", 20, 420, 100.0, 1.0, false),
        ("walk_forward.bvh", 20, 100, 100.0, 1.0, false),
    ];
    let files: Vec<(String, Vec<u8>)> =
        ["cmu", "games105"].iter().flat_map(|folder| bvh_files(&data.join(folder))).collect();
    assert_eq!(
        files.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(),
        expected.map(|row| row.0)
    );
    for ((name, bytes), (_, joints, frames, fps, unit, t_pose)) in files.iter().zip(expected) {
        let imported = import(name, bytes, &ImportOptions::default())
            .unwrap_or_else(|error| panic!("{error}"));
        let found = &imported.clips[0];
        let clip = &found.clip;
        let lost = lost_in_conversion(clip);
        let rest = found.measure.height_metres() as f32 + lost;
        let (height, feet) = (standing_height(clip) + lost, feet_above_ground(clip));
        let warnings: Vec<String> = imported.warnings.iter().map(ToString::to_string).collect();
        println!(
            "{name} | {} | {} | {} | {:.5} | {:?} | rest {:.2} m, moving {height:.2} m, feet {feet:.3} m | {}",
            clip.skeleton().len(),
            clip.frames(),
            clip.fps(),
            found.measure.provenance.metres_per_unit,
            found.measure.provenance.up,
            rest,
            warnings.join("; ")
        );
        assert_eq!(
            (clip.skeleton().len(), clip.frames(), clip.fps()),
            (joints, frames, fps),
            "{name}"
        );
        assert_eq!(found.measure.provenance.metres_per_unit, unit, "{name}");
        assert_eq!(clip.provenance().up, UpAxis::Y, "{name}");
        assert_eq!((found.t_pose_first_row, found.t_pose_dropped), (t_pose, t_pose), "{name}");
        assert_eq!(warnings.len(), usize::from(t_pose), "{name}: {warnings:?}");
        assert!((1.4..2.1).contains(&rest), "{name}: {rest} m");
        assert!((1.4..2.1).contains(&height), "{name}: {height} m");
        assert!(feet.abs() < 0.15, "{name}: feet at {feet} m");
        assert!(clip.rotations(frames - 1).iter().all(|q| q.is_normalized()), "{name}");
    }
}

#[test]
fn captured_t_pose_row_can_be_kept() {
    let Some(data) = shared_data() else { return };
    let bytes = std::fs::read(data.join("cmu/run.bvh")).unwrap();
    let options = ImportOptions { drop_t_pose: false, ..ImportOptions::default() };
    let imported = import("run.bvh", &bytes, &options).unwrap();
    assert_eq!(imported.clips[0].clip.frames(), 75);
    assert!(imported.clips[0].t_pose_first_row && !imported.clips[0].t_pose_dropped);
    assert_eq!(
        imported.warnings[0].to_string(),
        "the first row is a T-pose (line 188); kept and marked"
    );
}

#[test]
fn captured_motion_reads_back_equal() {
    let Some(data) = shared_data() else { return };
    let files = ["cmu", "games105"].iter().flat_map(|folder| bvh_files(&data.join(folder)));
    for (name, bytes) in files.filter(|(name, _)| name != "01_01.bvh") {
        let clip = import(&name, &bytes, &ImportOptions::default()).unwrap().clips.remove(0).clip;
        for up in [UpAxis::Y, UpAxis::Z] {
            let text = write(&clip, &WriteOptions { up: Some(up), ..WriteOptions::default() });
            let back = import(&name, text.as_bytes(), &ImportOptions::default()).unwrap();
            assert_eq!(back.warnings, [], "{name}");
            let back = &back.clips[0].clip;
            assert_eq!(
                (back.provenance().up, back.provenance().metres_per_unit),
                (up, clip.provenance().metres_per_unit),
                "{name}"
            );
            let channels = |clip: &Clip| {
                clip.skeleton().joints().iter().map(|j| j.channels.clone()).collect::<Vec<_>>()
            };
            assert_eq!(channels(back), channels(&clip), "{name}");
            assert_eq!(back.frames(), clip.frames());
            for frame in 0..clip.frames() {
                assert!(
                    back.root_translations()[frame].distance(clip.root_translations()[frame])
                        < 1e-5,
                    "{name}"
                );
                for (a, b) in back.rotations(frame).iter().zip(clip.rotations(frame)) {
                    assert!(quat::angle_between(*a, *b) < 1e-5, "{name}, frame {frame}");
                }
            }
        }
    }
}
