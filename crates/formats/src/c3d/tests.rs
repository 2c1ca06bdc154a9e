//! C3D files of all processors against what other programs read (`tests/cases/c3d/oracle.py`), and
//! broken ones.

use super::read::points;
use super::*;
use crate::warning::{Tally, WarningKind};
use crate::{FileKind, ImportOptions, import, kind_of};
use glam::Vec3;
use proptest::prelude::*;
use segue_motion::clip::UpAxis;
use std::collections::BTreeMap;

const EXPECTED: &str = include_str!("../../tests/cases/c3d/expected.txt");

macro_rules! cases {
    ($($name:literal),*) => {
        [$(($name, include_bytes!(concat!("../../tests/cases/c3d/", $name)).as_slice())),*]
    };
}

const CASES: [(&str, &[u8]); 8] = cases![
    "intel_int.c3d",
    "intel_float.c3d",
    "dec_int.c3d",
    "dec_float.c3d",
    "mips_int.c3d",
    "mips_float.c3d",
    "ezc3d.c3d",
    "python_c3d.c3d"
];

/// Returns the expected places of a file, frame by frame; `None` for a gap.
fn expected(name: &str) -> Vec<Option<Vec3>> {
    let rows = EXPECTED.lines().filter_map(|line| line.strip_prefix(name));
    rows.map(|row| {
        let values: Vec<f32> =
            row.split_whitespace().skip(2).filter_map(|word| word.parse().ok()).collect();
        (values.len() == 3).then(|| Vec3::from_slice(&values))
    })
    .collect()
}

#[test]
fn points_of_every_processor_are_those_that_others_read() {
    for (name, bytes) in CASES {
        assert_eq!(kind_of("x", bytes), FileKind::C3d, "{name}");
        let mut tally = Tally::default();
        let points = points(name, bytes, &mut tally).unwrap();
        assert_eq!(points.labels, ["LASI", "RASI", "Ball", "Box", "Far"], "{name}");
        let expected = expected(name);
        assert_eq!(points.positions.len(), expected.len(), "{name}");
        for (index, (found, expected)) in points.positions.iter().zip(&expected).enumerate() {
            match expected {
                Some(at) => assert!(found.distance(*at) < 1e-3, "{name} {index}: {found} {at}"),
                None => assert!(found.is_nan(), "{name} {index}: {found}"),
            }
        }
        let by_hand = name != "ezc3d.c3d" && name != "python_c3d.c3d";
        let rate = if by_hand {
            50.0
        } else if name == "ezc3d.c3d" {
            120.0
        } else {
            60.0
        };
        assert_eq!(points.fps, Some(rate), "{name}");
        assert_eq!(points.unit, Some(if name == "ezc3d.c3d" { 1.0 } else { 0.001 }), "{name}");
        if by_hand {
            assert_eq!(points.up, Some(UpAxis::Z), "{name}");
        }
        assert!(tally.into_warnings(b"").is_empty(), "{name}");
    }
}

#[test]
fn c3d_of_unknown_labels_becomes_points_in_metres() {
    let file = import("take.c3d", CASES[1].1, &ImportOptions::default()).unwrap();
    let clip = &file.clips[0].clip;
    assert_eq!((clip.frames(), clip.skeleton().len(), clip.fps()), (7, 6, 50.0));
    assert_eq!(clip.skeleton().joints()[3].name, "Ball");
    // Z up: (400, 0, 900) mm is (0.4, 0.9, 0) m.
    let first = clip.world_positions(0..1)[1];
    assert!(first.distance(Vec3::new(0.4, 0.9, 0.0)) < 1e-5, "{first}");
    let kinds: Vec<&WarningKind> = file.warnings.iter().map(|warning| &warning.kind).collect();
    assert!(kinds.contains(&&WarningKind::PointsOnly { points: 5 }), "{kinds:?}");
}

#[test]
fn c3d_that_is_cut_off_has_the_frames_that_are_there() {
    let (_, whole) = CASES[1];
    // Two blocks of parameters, one of the header, and three and a half frames of 96 bytes.
    let cut = &whole[..3 * 512 + 336];
    let mut tally = Tally::default();
    let points = points("cut.c3d", cut, &mut tally).unwrap();
    assert_eq!(points.positions.len(), 3 * 5);
    let kind = WarningKind::FrameCount { declared: "7".into(), found: 3 };
    assert_eq!(tally.into_warnings(b"")[0].kind, kind);
}

#[test]
fn c3d_without_points_is_refused() {
    let mut none = CASES[0].1.to_vec();
    // The number of points is the first parameter, and the second word of the header.
    let at = 512 + 4 + 10 + 2 + 4 + 2 + 2;
    assert_eq!(none[at], 5, "the number of points");
    (none[at], none[2]) = (0, 0);
    let error = import("none.c3d", &none, &ImportOptions::default()).unwrap_err();
    assert!(error.to_string().contains("a C3D file without points"), "{error}");
    let error = import("x.c3d", b"not one", &ImportOptions::default()).unwrap_err();
    assert!(error.to_string().contains("no header of a C3D file"), "{error}");
    let header_alone = &CASES[0].1[..3 * 512];
    let error = import("h.c3d", header_alone, &ImportOptions::default()).unwrap_err();
    assert!(error.to_string().contains("a C3D file without frames"), "{error}");
}

#[test]
fn c3d_of_a_body_has_joints() {
    // The labels of the made file, exchanged for those of hips and a leg: five points.
    let mut bytes = CASES[1].1.to_vec();
    let labels: BTreeMap<&[u8], &[u8]> = [
        (b"LASI  ".as_slice(), b"RHJC  ".as_slice()),
        (b"RASI  ", b"LHJC  "),
        (b"Ball  ", b"LKJC  "),
        (b"Box   ", b"LAJC  "),
        (b"Far   ", b"LTOE  "),
    ]
    .into();
    for (from, to) in labels {
        let at = bytes.windows(6).position(|word| word == from).unwrap();
        bytes[at..at + 6].copy_from_slice(to);
    }
    let file = import("body.c3d", &bytes, &ImportOptions::default()).unwrap();
    let names: Vec<&str> =
        file.clips[0].clip.skeleton().joints().iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["Hips", "LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToe", "RightUpLeg"]);
    let kinds: Vec<&WarningKind> = file.warnings.iter().map(|warning| &warning.kind).collect();
    assert!(
        kinds
            .iter()
            .any(|kind| matches!(kind, WarningKind::SkeletonFromPoints { markers: 5, of: 5, .. })),
        "{kinds:?}"
    );
}

proptest! {
    /// Any bytes in a file are read or refused, in bounded memory.
    #[test]
    fn any_bytes_are_read_or_refused(
        case in 0_usize..CASES.len(),
        edits in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..12),
        cut in any::<prop::sample::Index>(),
        whole in any::<bool>(),
    ) {
        let mut bytes = CASES[case].1.to_vec();
        for (at, value) in edits {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        if !whole {
            bytes.truncate(cut.index(bytes.len()));
        }
        if let Ok(file) = read("any.c3d", &bytes, &ImportOptions::default()) {
            for imported in &file.clips {
                let clip = &imported.clip;
                prop_assert!(clip.frames() * clip.skeleton().len() <= 4 * bytes.len());
                let poses = clip.world_positions(0..clip.frames());
                prop_assert!(poses.iter().all(|at| at.is_finite()));
            }
        }
    }
}
