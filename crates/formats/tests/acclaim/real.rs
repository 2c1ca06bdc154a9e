//! Captured motion of the CMU database: equal to the BVH of the same take, of plausible height, and
//! on the ground.

use super::common::{points, shared_data};
use super::{NO_RATE, skeleton_of};
use segue_formats::acclaim::{AcclaimSkeleton, best_skeleton, read_motion, read_skeleton};
use segue_formats::{CMU_METRES_PER_UNIT, ImportOptions, ImportedFile, WarningKind, import};
use segue_motion::skeleton::{Role, RoleSource, Roles};
use std::path::Path;

fn real_skeleton(path: &Path) -> AcclaimSkeleton {
    let bytes = std::fs::read(path).unwrap();
    read_skeleton(&path.to_string_lossy(), &bytes, &ImportOptions::default())
        .unwrap_or_else(|error| panic!("{error}"))
}

fn real_motion(path: &Path, skeleton: &AcclaimSkeleton) -> ImportedFile {
    let bytes = std::fs::read(path).unwrap();
    read_motion(&path.to_string_lossy(), &bytes, skeleton, &ImportOptions::default())
        .unwrap_or_else(|error| panic!("{error}"))
}

/// Joints of the conversion to BVH, those of the original at the same place, and the distance by
/// which the conversion moved them, file units: its `Neck` and shoulders have no offset where the
/// database has a bone.
const SAME: [(&str, &str, f32); 16] = [
    ("Hips", "root", 0.0),
    ("LeftUpLeg", "lfemur", 0.0),
    ("LeftLeg", "ltibia", 0.0),
    ("LeftFoot", "lfoot", 0.0),
    ("LeftToeBase", "ltoes", 0.0),
    ("RightUpLeg", "rfemur", 0.0),
    ("RightLeg", "rtibia", 0.0),
    ("RightFoot", "rfoot", 0.0),
    ("RightToeBase", "rtoes", 0.0),
    ("Spine", "upperback", 0.0),
    ("Spine1", "thorax", 0.0),
    ("Head", "head", 2.064_88),
    ("LeftArm", "lhumerus", 2.064_88),
    ("LeftHand", "lwrist", 2.064_88),
    ("RightArm", "rhumerus", 2.064_88),
    ("RightHand", "rwrist", 2.064_88),
];

#[test]
fn captured_take_as_amc_equals_its_bvh() {
    let Some(data) = shared_data() else { return };
    let ours =
        real_motion(&data.join("cmu/01_01.amc"), &real_skeleton(&data.join("cmu/01_01.asf")))
            .clips
            .remove(0)
            .clip;
    let bytes = std::fs::read(data.join("cmu/01_01.bvh")).unwrap();
    let theirs =
        import("01_01.bvh", &bytes, &ImportOptions::default()).unwrap().clips.remove(0).clip;
    assert_eq!((ours.frames(), ours.fps()), (2751, 120.0));
    assert_eq!((theirs.frames(), theirs.fps()), (2751, 120.0));
    assert_eq!(ours.provenance(), theirs.provenance());
    let unit = CMU_METRES_PER_UNIT as f32;
    let pairs = SAME.map(|(a, b, off)| {
        (theirs.skeleton().find(a).unwrap(), ours.skeleton().find(b).unwrap(), off)
    });
    for frame in 0..ours.frames() {
        let (p, q) = (theirs.world_pose(frame), ours.world_pose(frame));
        for ((a, b, off), (name, ..)) in pairs.iter().zip(SAME) {
            let apart = p.positions[*a].distance(q.positions[*b]) / unit;
            assert!((apart - off).abs() < 1e-3, "{name}, frame {frame}: {apart}");
            assert!(p.rotations[*a].dot(q.rotations[*b]).abs() > 0.999_99, "{name}, frame {frame}");
        }
    }
}

#[test]
fn captured_people_have_plausible_height_ground_contact_and_roles() {
    let Some(data) = shared_data() else { return };
    let (first, sixteenth) =
        (real_skeleton(&data.join("cmu/01_01.asf")), real_skeleton(&data.join("cmu/16/16.asf")));
    let entries = std::fs::read_dir(data.join("cmu/16")).unwrap();
    let mut paths: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "amc"));
    paths.push(data.join("cmu/01_01.amc"));
    assert!(paths.len() > 15);
    for path in paths {
        let (name, bytes) = (path.to_string_lossy().into_owned(), std::fs::read(&path).unwrap());
        let best =
            best_skeleton(&name, &bytes, &[("01_01.asf", &first), ("16.asf", &sixteenth)]).unwrap();
        assert_eq!(best, usize::from(!name.ends_with("01_01.amc")), "{name}");
        let found = real_motion(&path, if best == 0 { &first } else { &sixteenth });
        let warnings: Vec<String> = found.warnings.iter().map(ToString::to_string).collect();
        assert_eq!(warnings, [NO_RATE], "{name}");
        let found = &found.clips[0];
        assert!(!found.t_pose_first_row);
        assert_eq!(found.measure.provenance.metres_per_unit, CMU_METRES_PER_UNIT);
        assert!((1.5..2.0).contains(&found.measure.height_metres()), "{name}: {}", found.measure);
        let clip = &found.clip;
        let bounds = |frame: usize| {
            let ys = points(clip, frame).into_iter().map(|p| p.y);
            ys.fold((f32::MAX, f32::MIN), |(low, high), y| (low.min(y), high.max(y)))
        };
        let all: Vec<(f32, f32)> = (0..clip.frames()).map(bounds).collect();
        let lowest = all.iter().map(|b| b.0).fold(f32::MAX, f32::min);
        let mut heights: Vec<f32> = all.iter().map(|b| b.1 - b.0).collect();
        heights.sort_by(f32::total_cmp);
        assert!(lowest.abs() < 0.04, "{name}: {lowest} m");
        assert!(
            (1.4..2.0).contains(&heights[heights.len() / 2]),
            "{name}: {} m",
            heights[heights.len() / 2]
        );
        let roles = Roles::detect(clip.skeleton());
        assert!(
            Role::ALL.iter().all(|&role| roles.source(role) == Some(RoleSource::ByName)),
            "{name}"
        );
    }
}

#[test]
fn legs_of_another_length_give_a_warning() {
    let Some(data) = shared_data() else { return };
    let text = std::fs::read_to_string(data.join("cmu/16/16.asf")).unwrap();
    let motion = std::fs::read(data.join("cmu/16/16_15.amc")).unwrap();
    let warning_of = |text: &str| {
        let skeleton = skeleton_of(text).unwrap();
        let imported =
            read_motion("16_15.amc", &motion, &skeleton, &ImportOptions::default()).unwrap();
        imported
            .warnings
            .into_iter()
            .find(|warning| matches!(warning.kind, WarningKind::OffGround { .. }))
    };
    assert_eq!(warning_of(&text), None);
    // The lengths of the four long bones of the legs begin with 7.
    let longer = warning_of(&text.replace("length 7.", "length 9.")).unwrap().to_string();
    assert!(
        longer.contains("cm below the ground; the skeleton may be that of another person"),
        "{longer}"
    );
    let shorter = warning_of(&text.replace("length 7.", "length 4.")).unwrap().to_string();
    assert!(shorter.contains("cm above the ground"), "{shorter}");
}
