//! Tables of the robot against the kinematics of `MuJoCo` (`tests/cases/robot_csv/oracle.py`).

use super::*;
use crate::warning::WarningKind;
use crate::{FileKind, ImportOptions, ImportedFile, import, kind_of};
use glam::Vec3;
use proptest::prelude::*;
use segue_motion::clip::Clip;
use segue_motion::skeleton::{Role, Roles};

const EXPECTED: &str = include_str!("../../tests/cases/robot_csv/expected.txt");
const LAST: &str = include_str!("../../tests/cases/robot_csv/scalar_last.csv");
const FIRST: &str = include_str!("../../tests/cases/robot_csv/scalar_first.csv");
const NAMED: &str = include_str!("../../tests/cases/robot_csv/named.csv");

fn opened(text: &str) -> ImportedFile {
    import("robot.csv", text.as_bytes(), &ImportOptions::default()).unwrap()
}

fn kinds(file: &ImportedFile) -> Vec<WarningKind> {
    file.warnings.iter().map(|warning| warning.kind.clone()).collect()
}

/// Returns the greatest distance of a body from its place by the oracle, metres.
fn greatest_error(clip: &Clip) -> f32 {
    let mut greatest = 0.0_f32;
    let mut checked = 0;
    for line in EXPECTED.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        let frame: usize = words[0].parse().unwrap();
        let [x, y, z] = [2, 3, 4].map(|index| words[index].parse::<f32>().unwrap());
        let joint = clip.skeleton().find(words[1]).unwrap();
        let found = clip.world_pose(frame).positions[joint];
        // Z up to Y up.
        greatest = greatest.max(found.distance(Vec3::new(x, z, -y)));
        checked += 1;
    }
    assert_eq!(checked, 12 * 30);
    greatest
}

#[test]
fn tables_of_all_kinds_put_bodies_where_mujoco_does() {
    for (name, text, fps) in [("last", LAST, 30.0), ("first", FIRST, 30.0), ("named", NAMED, 120.0)]
    {
        assert_eq!(kind_of("x.txt", text.as_bytes()), FileKind::RobotCsv, "{name}");
        let file = opened(text);
        let clip = &file.clips[0].clip;
        assert_eq!((clip.frames(), clip.fps(), clip.skeleton().len()), (12, fps, 30), "{name}");
        let error = greatest_error(clip);
        assert!(error < 2e-5, "{name}: {error} m");
        let kinds = kinds(&file);
        assert!(kinds.contains(&WarningKind::AssumedFrameRate { fps }), "{name}");
        let beyond = kinds.iter().find_map(|kind| match kind {
            WarningKind::BeyondLimits { joint, frames, first, degrees } => {
                Some((joint.as_str(), *frames, *first, degrees.round()))
            }
            _ => None,
        });
        assert_eq!(beyond, Some(("left_knee", 4, 8, 11.0)), "{name}: {kinds:?}");
        assert_eq!(kinds.len(), 2, "{name}: {kinds:?}");
    }
}

#[test]
fn hinges_at_and_beyond_their_limits_are_told_from_free_ones() {
    use HingeState::{AtLimit, BeyondLimit, Free};
    let row = |degrees: f64| {
        let knee = (0..29).map(|hinge| if hinge == 3 { degrees.to_radians() } else { 0.0 });
        let cells = [0.0, 0.0, 0.8, 0.0, 0.0, 0.0, 1.0].into_iter().chain(knee);
        cells.map(|cell| cell.to_string()).collect::<Vec<_>>().join(",")
    };
    // The left knee, hinge 3, bends from -5° to 165°.
    let expected = [
        (0.0, Free),
        (90.0, Free),
        (163.5, Free),
        (164.5, AtLimit),
        (165.0, AtLimit),
        (166.0, BeyondLimit),
        (179.0, BeyondLimit),
        (-3.5, Free),
        (-4.5, AtLimit),
        (-6.0, BeyondLimit),
    ];
    let rows: Vec<String> = expected.iter().map(|(degrees, _)| row(*degrees)).collect();
    let options = ImportOptions { drop_t_pose: false, ..ImportOptions::default() };
    let file = import("robot.csv", rows.join("\n").as_bytes(), &options).unwrap();
    let clip = &file.clips[0].clip;
    let limits = HingeLimits::of(clip.skeleton()).unwrap();
    let knee = clip.skeleton().find("left_knee").unwrap();
    let range = limits.range_degrees(knee).unwrap().map(f64::round);
    assert_eq!((range, limits.range_degrees(0)), ([-5.0, 165.0], None));
    for (frame, (degrees, state)) in expected.into_iter().enumerate() {
        let rotations = clip.rotations(frame);
        assert_eq!(limits.state(knee, rotations[knee]), state, "{degrees}°");
        assert_eq!(limits.state(knee, -rotations[knee]), state, "{degrees}°, negated");
        let others = (0..rotations.len()).filter(|joint| *joint != knee);
        let states = others.map(|joint| limits.state(joint, rotations[joint]));
        assert!(states.into_iter().all(|state| state == Free), "{degrees}°");
    }
    let human = segue_motion::synth::humanoid(1.75).unwrap();
    assert_eq!(HingeLimits::of(&human), None);
}

#[test]
fn robot_has_the_roles_of_a_body() {
    let file = opened(LAST);
    let clip = &file.clips[0].clip;
    let roles = Roles::detect(clip.skeleton());
    let name =
        |role: Role| roles.get(role).map(|joint| clip.skeleton().joints()[joint].name.as_str());
    assert_eq!(name(Role::Hips), Some("pelvis"));
    assert_eq!(name(Role::LeftShin), Some("left_knee"));
    assert_eq!(name(Role::RightForearm), Some("right_elbow"));
    assert!(name(Role::LeftThigh).is_some_and(|name| name.starts_with("left_hip")));
    assert!(name(Role::RightFoot).is_some_and(|name| name.starts_with("right_ankle")));
    let height = file.clips[0].measure.height_metres();
    assert!((1.1..1.5).contains(&height), "{height}");
}

#[test]
fn quaternion_of_a_robot_that_looks_ahead_or_back_follows_the_travel() {
    // Only a turn about the vertical: in the other order the robot stands, too, but looks back.
    let rows = |x: f64| -> String {
        let row = |frame: i32| {
            let angles = ",0".repeat(29);
            format!("{:.3},0,0.79,0,0,0,1{angles}\n", x * f64::from(frame))
        };
        (0..20).map(row).collect()
    };
    let facing = |text: &str| {
        let file = opened(text);
        let pose = file.clips[0].clip.world_pose(0);
        let ambiguous = kinds(&file).iter().find_map(|kind| match kind {
            WarningKind::QuaternionOrder { scalar_first } => Some(*scalar_first),
            _ => None,
        });
        (ambiguous, (pose.rotations[0] * Vec3::X).x > 0.0)
    };
    assert_eq!(facing(&rows(0.1)), (Some(false), true));
    assert_eq!(facing(&rows(0.0)), (Some(false), true));
    assert_eq!(facing(&rows(-0.1)), (Some(true), false));
}

#[test]
fn named_table_without_some_columns_keeps_those_hinges_at_rest() {
    let text = "Frame,root_translateX,root_translateY,root_translateZ,root_rotateX,root_rotateY,\
        root_rotateZ,left_knee_joint_dof,tail_joint_dof\n0,100,200,79,0,0,90,30,5\n";
    let file = opened(text);
    let clip = &file.clips[0].clip;
    assert!(clip.root_translations()[0].distance(Vec3::new(1.0, 0.79, -2.0)) < 1e-6);
    let kinds = kinds(&file);
    assert!(kinds.contains(&WarningKind::UnknownBones { name: "tail_joint_dof".into() }));
    assert!(kinds.contains(&WarningKind::RestingBones { name: "left_hip_pitch".into() }));
    let error =
        import("r.csv", text.replace("root_rotateZ", "turn").as_bytes(), &ImportOptions::default());
    assert!(error.unwrap_err().to_string().contains("`root_rotatez`"));
}

#[test]
fn table_of_something_else_is_refused_with_advice() {
    let error =
        |text: &str| import("t.csv", text.as_bytes(), &ImportOptions::default()).unwrap_err();
    let other = error("time_s,Hips.x_m\r\n0,1\r\n");
    assert!(other.to_string().starts_with("t.csv:1:1: found a table of 2 columns"), "{other}");
    assert!(other.hint.is_some());
    assert!(error("hello").to_string().contains("found `hello`"));
    let word = LAST.replacen("0.79,", "much,", 1);
    assert!(error(&word).to_string().starts_with("t.csv:1:1: found a table of 36 columns"));
    let second = LAST.replacen("0.7858333", "high", 1);
    assert_eq!(error(&second).to_string(), "t.csv:2:18: found `high`, expected a number");
    let narrow = LAST.replacen("0.7858333,", "", 1);
    assert_eq!(error(&narrow).to_string(), "t.csv:2:1: found 35 numbers, expected 36 numbers");
}

#[test]
fn truncated_row_is_dropped_and_missing_numbers_are_held() {
    let cut = &LAST[..LAST.len() - 40];
    let file = opened(cut);
    assert_eq!(file.clips[0].clip.frames(), 11);
    assert!(kinds(&file).iter().any(|kind| matches!(kind, WarningKind::TruncatedRow { .. })));
    let holed = LAST.replacen("0.7858333", "nan", 1);
    let file = opened(&holed);
    assert!((file.clips[0].clip.root_translations()[1].y - 0.79).abs() < 1e-6);
    assert!(kinds(&file).contains(&WarningKind::NotFinite));
}

proptest! {
    /// Any change of a table is read or refused.
    #[test]
    fn any_table_is_read_or_refused(
        named in any::<bool>(),
        edits in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
        cut in any::<prop::sample::Index>(),
    ) {
        let mut bytes = if named { NAMED } else { FIRST }.as_bytes().to_vec();
        for (at, value) in edits {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        bytes.truncate(cut.index(bytes.len() + 1));
        if let Ok(file) = read("any.csv", &bytes, &ImportOptions::default()) {
            let clip = &file.clips[0].clip;
            let poses = clip.world_positions(0..clip.frames());
            prop_assert!(poses.iter().all(|at| at.is_finite()));
        }
    }
}

#[test]
fn written_table_is_read_back() {
    let clip = opened(LAST).clips.remove(0).clip;
    let text = write_robot_csv(&clip, None).unwrap();
    assert!(text.lines().all(|line| line.split(',').count() == COLUMNS));
    let (ours, theirs): (Vec<f64>, Vec<f64>) = (numbers(&text), numbers(LAST));
    assert_eq!(ours.len(), theirs.len());
    for (index, (own, expected)) in ours.iter().zip(&theirs).enumerate() {
        // A quaternion and its opposite are the same rotation.
        let is_turn = (3..7).contains(&(index % COLUMNS));
        let apart = (own - expected).abs();
        let apart = if is_turn { apart.min((own + expected).abs()) } else { apart };
        assert!(apart < 1e-4, "{index}: {own}, not {expected}");
    }
    assert!(greatest_error(&opened(&text).clips[0].clip) < 2e-5);
    // At another rate there are other rows.
    let dense = write_robot_csv(&clip, Some(60.0)).unwrap();
    assert_eq!(dense.lines().count(), 2 * clip.frames() - 1);
}

fn numbers(table: &str) -> Vec<f64> {
    table.lines().flat_map(|line| line.split(',')).map(|cell| cell.parse().unwrap()).collect()
}

#[test]
fn motion_that_is_not_the_robots_is_not_written() {
    let skeleton = segue_motion::skeleton::fixtures::cmu_bvh();
    let other = segue_motion::clip::fixtures::wander(&skeleton, 3, 1);
    assert_eq!(write_robot_csv(&other, None), Err(RobotCsvError::OtherSkeleton));
    let clip = opened(LAST).clips.remove(0).clip;
    let turned = segue_motion::clip::fixtures::wander_by(clip.skeleton(), 8, 1, 0.5);
    let Err(RobotCsvError::OffAxis { degrees, .. }) = write_robot_csv(&turned, None) else {
        panic!("a knee that turns sideways was written");
    };
    assert!(degrees > 2);
    let large = clip.skeleton().scaled(1.1);
    let roots = clip.root_translations().to_vec();
    let rotations = (0..clip.frames()).flat_map(|frame| clip.rotations(frame).to_vec()).collect();
    let large = Clip::new("large", std::sync::Arc::new(large), 30.0, rotations, roots).unwrap();
    assert_eq!(write_robot_csv(&large, None), Err(RobotCsvError::OtherSkeleton));
}
