//! Oddities of real ASF and AMC files, one test for each kind.

use super::{ASF, amc, clip_of, frame, read_with, skeleton_of};
use glam::Vec3;
use segue_formats::acclaim::{
    AcclaimSkeleton, best_skeleton, read_motion, read_motion_with_progress, read_skeleton,
};
use segue_formats::{ImportOptions, import};

/// Asserts that two files have the content of [`ASF`] and [`amc`] with three frames, and returns
/// their warnings.
fn same(asf: impl AsRef<[u8]>, motion: impl AsRef<[u8]>) -> Vec<String> {
    let (clip, warnings) = clip_of(&asf, &motion);
    let (plain, none) = clip_of(ASF, amc(3));
    assert_eq!(none, [""; 0]);
    assert_eq!(clip, plain, "{}", String::from_utf8_lossy(motion.as_ref()));
    warnings
}

fn same_skeleton(asf: impl AsRef<[u8]>) {
    assert_eq!(same(asf, amc(3)), [""; 0]);
}

fn same_motion(motion: impl AsRef<[u8]>) -> Vec<String> {
    same(ASF, motion)
}

fn refused(asf: &str, motion: &str) -> String {
    read_with(asf, motion, &ImportOptions::default()).unwrap_err().to_string()
}

/// Replaces text as [`str::replace`] does, and asserts that there was any.
fn with(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from}");
    text.replace(from, to)
}

#[test]
fn plain_files_are_read() {
    let (clip, _) = clip_of(ASF, amc(3));
    let joints = clip.skeleton().joints();
    let names: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["root", "thigh", "shin", "spine", "skull"]);
    assert_eq!(
        joints.iter().map(|joint| joint.parent).collect::<Vec<_>>(),
        [None, Some(0), Some(1), Some(0), Some(3)]
    );
    assert_eq!((clip.name(), clip.frames(), clip.fps()), ("take", 3, 120.0));
    assert_eq!(clip.provenance().metres_per_unit, 0.01);
    // A bone is a joint at its start, and its direction has no length.
    assert_eq!((joints[1].offset, joints[3].offset), (Vec3::ZERO, Vec3::ZERO));
    assert!(joints[4].offset.distance(Vec3::Y * 0.6) < 1e-6);
    assert!(joints[4].end_site.unwrap().distance(Vec3::Y * 0.2) < 1e-6);
    assert!(clip.root_translations()[2].distance(Vec3::new(0.035, 0.905, 0.065)) < 1e-6);
}

#[test]
fn comments_and_separators_of_any_kind_are_read() {
    let text = amc(3);
    assert_eq!(same_motion(text.replace('\n', "\r\n")), [""; 0]);
    assert_eq!(same_motion(text.replace('\n', " # x\r \t\n\n")), [""; 0]);
    assert_eq!(same_motion(text.trim_end()), [""; 0]);
    assert_eq!(same_motion(with(&text, "spine 5.5 6.5", "spine (5.5, 6.5)")), [""; 0]);
    assert_eq!(same_motion(with(&text, "spine 5.5 6.5", "spine 5.5,6.5,")), [""; 0]);
    assert_eq!(same_motion([text.as_bytes(), &[0; 100]].concat()), [""; 0]);
    let utf16: Vec<u8> =
        [0xfeff].into_iter().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    assert_eq!(same_motion(utf16), [""; 0]);
    same_skeleton(ASF.replace('\n', "\r\n"));
    same_skeleton(with(ASF, "    dof rx ry rz\n", "# yes\n\tDOF rx, ry, rz # and\n"));
    same_skeleton(with(ASF, "axis 10 20 30 XYZ", "axis (10, 20, 30) xyz"));
    same_skeleton(format!("\u{feff}#!OML:ASF\n{ASF}"));
    assert_eq!(
        same_motion(text.to_uppercase().replace("ROOT", "Root")),
        [""; 0],
        "case does not count"
    );
}

#[test]
fn units_of_length_are_used_if_plausible() {
    // Without usable units the height of the body decides.
    for units in [
        "",
        ":units\n mass 1\n",
        ":units\n length 0\n",
        ":units length inches\n",
        ":units\n length -1 angle deg\n",
        ":units\n length 0.45\n",
    ] {
        let text = with(ASF, ":units\n  mass 1.0\n  length 1.0\n  angle deg\n", units);
        same_skeleton(text);
    }
    // The unit of the file is used if it gives the height of a person: 160 units of 1/2.54 inch are
    // 1.6 m, and 160 units of 1/2 inch are 2.03 m.
    for (length, metres) in [("2.54", 0.01), ("2.0", 0.0127), ("0.1", 0.01)] {
        let (clip, warnings) =
            clip_of(with(ASF, "length 1.0", &format!("length {length}")), amc(1));
        assert!((clip.provenance().metres_per_unit - metres).abs() < 1e-9, "{length}");
        assert_eq!(warnings, [""; 0]);
    }
    let options =
        ImportOptions { metres_per_unit: Some(0.02), fps: Some(60.0), ..ImportOptions::default() };
    let imported = read_with(with(ASF, "length 1.0", "length 2.0"), amc(1), &options).unwrap();
    let clip = &imported.clips[0].clip;
    assert_eq!((clip.provenance().metres_per_unit, clip.fps()), (0.02, 60.0));
    assert_eq!(imported.warnings, [], "the frame rate was given");
}

#[test]
fn units_of_angle_are_used() {
    let numbers = |text: &str| {
        let mut out = String::new();
        for line in text.lines() {
            let mut words = line.split(' ');
            let name = words.next().unwrap();
            let keep = if name == "root" { 3 } else { 0 };
            let values = words.enumerate().map(|(i, word)| {
                let value: f64 = word.parse().unwrap();
                if i < keep { word.to_owned() } else { format!("{:.12}", value.to_radians()) }
            });
            out += &[name.to_owned()].into_iter().chain(values).collect::<Vec<_>>().join(" ");
            out.push('\n');
        }
        out
    };
    let frames: String = (1..=3).map(frame).collect();
    let radians = numbers(&frames);
    let near = |asf: &str, motion: &str| {
        let ((a, warnings), (b, _)) = (clip_of(asf, motion), clip_of(ASF, amc(3)));
        assert_eq!(warnings, [""; 0]);
        let worst = (0..3).flat_map(|f| {
            a.rotations(f)
                .iter()
                .zip(b.rotations(f))
                .map(|(p, q)| p.dot(*q).abs())
                .collect::<Vec<_>>()
        });
        assert!(worst.fold(1.0, f32::min) > 0.999_999, "{motion}");
    };
    let axes = with(
        &with(ASF, "axis 10 20 30", "axis 0.174532925 0.34906585 0.523598776"),
        "axis 0 0 20",
        "axis 0 0 0.34906585",
    );
    near(ASF, &format!(":RADIANS\n{radians}"));
    near(&with(&axes, "angle deg", "angle rad"), &radians);
    near(&with(&axes, "angle deg", "angle Radians"), &format!(":DEGREES\n{frames}"));
    near(ASF, &frames);
    near(&with(ASF, "  angle deg\n", ""), &frames);
}

#[test]
fn bones_missing_from_a_frame_hold_their_pose() {
    let text = with(&amc(3), ":FULLY-SPECIFIED\n", "");
    assert_eq!(same_motion(&text), [""; 0]);
    let second = "2\nroot 2.5 90.5 4.5 10.5 20.5 5.0\nspine 5.5 6.5\n";
    let (clip, warnings) =
        clip_of(ASF, with(&text, &format!("{second}thigh 7.5 8.5 7.5\nshin 11.5\n"), second));
    assert_eq!(warnings, ["1 frame (line 8) without some of the bones; their pose was held"]);
    assert_eq!(clip.rotations(1)[1..3], clip.rotations(0)[1..3]);
    assert_eq!(clip.rotations(2), clip_of(ASF, amc(3)).0.rotations(2));
    // Bones that never have values stay at rest.
    let (clip, warnings) = clip_of(ASF, text.replace("shin 11.5\n", ""));
    assert_eq!(
        warnings,
        ["1 bone of the skeleton without values in the motion, such as `shin`; left at rest"]
    );
    assert_eq!(clip.rotations(1)[2], glam::Quat::IDENTITY);
}

#[test]
fn fields_in_any_order_are_read() {
    same_skeleton(with(
        ASF,
        "    name thigh\n    direction 0.1 -0.9 0\n    length 40\n    axis 10 20 30 XYZ\n    dof rx ry rz\n",
        "    dof rx ry rz length 40 axis 10 20 30\n    direction 0.1\n-0.9 0 name thigh\n",
    ));
    same_skeleton(with(ASF, "    limits (-10.0 170.0)\n", ""));
    same_skeleton(with(ASF, "    limits (-10.0 170.0)\n", "    limits (-inf +inf) (x y)\n"));
    same_skeleton(with(ASF, "  order TX TY TZ RX RY RZ\n  axis XYZ\n", ""));
    same_skeleton(with(ASF, "    id 2\n", "    id x2 y\n"));
    // Sections in any order, and unknown ones.
    let (head, bones) = ASF.split_once(":bonedata").unwrap();
    let (bones, tree) = bones.split_once(":hierarchy").unwrap();
    same_skeleton(format!(":hierarchy{tree}:bonedata{bones}:skin\n a b c\n{head}"));
}

#[test]
fn frames_are_separated_by_any_number() {
    let text = amc(3);
    assert_eq!(
        same_motion(with(
            &with(&with(&text, "\n3\n", "\n903\n"), "\n2\n", "\n902\n"),
            "\n1\n",
            "\n901\n"
        )),
        [""; 0]
    );
    assert_eq!(
        same_motion(with(&text, "\n2\n", "\n4000000000\n")),
        ["2 frame numbers out of order (first: line 9); frames are used in the order of the file"]
    );
    assert_eq!(
        same_motion(with(&text, "\n3\n", "\n99999999999999999999999\n")),
        ["1 frame number out of order (line 14); frames are used in the order of the file"]
    );
    assert_eq!(same_motion(with(&text, "\n3\n", "\n3.0\n")), [""; 0]);
    // Rows over several lines, and all on one.
    assert_eq!(same_motion(text.replace("90.5 ", "90.5\n  ")), [""; 0]);
    let (head, frames) = text.split_once(":DEGREES\n").unwrap();
    assert_eq!(same_motion(format!("{head}:DEGREES\n{}", frames.replace('\n', " "))), [""; 0]);
}

#[test]
fn numbers_in_every_spelling_are_read() {
    assert_eq!(same_motion(with(&amc(3), "5.5 6.5", "+5.5 .65e1")), [""; 0]);
}

#[test]
fn values_not_finite_are_held() {
    let many = amc(60);
    let (clip, warnings) = clip_of(ASF, with(&many, "\n30\nroot 30.5", "\n30\nroot nan"));
    assert_eq!(warnings, ["1 value without a number (line 150); the last good value was held"]);
    assert_eq!(clip.root_translations()[29].x, clip.root_translations()[28].x);
    let error = refused(ASF, &many.replace("shin 11.5", "shin -1.#IND"));
    assert_eq!(
        error,
        "take.amc:8:6: found no number in 60 of 720 values, expected at most 1 % of them"
    );
    assert_eq!(
        same_motion(with(&amc(3), "1.5 90.5 2.5 10.5", "1.5+90.5 2.5 10.5")),
        ["1 missing space between numbers (line 5); split before the sign"]
    );
}

#[test]
fn skeleton_of_another_subject_gives_warnings() {
    // Names that one of the two does not have.
    let renamed = with(&amc(3), "shin", "calf");
    let (clip, warnings) = clip_of(ASF, renamed);
    assert_eq!(
        warnings,
        [
            "1 bone of the motion (line 8) not in the skeleton, such as `calf`; left out",
            "1 bone of the skeleton without values in the motion, such as `shin`; left at rest"
        ]
    );
    assert_eq!(clip.frames(), 3);
    // Degrees of freedom that differ.
    let (clip, warnings) = clip_of(with(ASF, "dof rz rx", "dof rx ry rz"), amc(3));
    assert_eq!(
        warnings,
        [
            "1 bone (line 6) with more or fewer values than the skeleton has degrees of freedom, such as 2 for the 3 of `spine`; left at rest"
        ]
    );
    assert_eq!(clip.rotations(0)[3], glam::Quat::IDENTITY);
    // No bone in common.
    let other = ASF.replace("thigh", "a").replace("shin", "b").replace("spine", "c");
    let error = read_with(
        with(&other, "order TX TY TZ RX RY RZ", "order TX TY TZ"),
        amc(3),
        &ImportOptions::default(),
    )
    .unwrap_err();
    assert_eq!(
        error.to_string(),
        "take.amc:1:1: found no bone with the names and degrees of freedom of the skeleton, expected a motion of the skeleton `toy`"
    );
    assert_eq!(error.hint.unwrap().to_string(), "drop the ASF file that belongs to it");
}

#[test]
fn motion_without_its_skeleton_is_refused() {
    let options = ImportOptions::default();
    let error = import("walk.amc", amc(2).as_bytes(), &options).unwrap_err();
    assert_eq!(
        error.to_string(),
        "walk.amc:1:1: found a motion without its skeleton (.amc), expected the ASF file (.asf) that belongs to it"
    );
    assert!(error.hint.is_some());
    let imported = import("some/toy.asf", ASF.as_bytes(), &options).unwrap();
    let warnings: Vec<String> = imported.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(warnings, ["the file has a skeleton but no animation"]);
    let clip = &imported.clips[0].clip;
    assert_eq!((clip.name(), clip.frames(), clip.skeleton().len()), ("toy", 0, 5));
    assert_eq!(clip.skeleton(), clip_of(ASF, amc(1)).0.skeleton());
}

#[test]
fn truncated_file_loses_its_last_frame() {
    let text = amc(3);
    let plain = clip_of(ASF, &text).0;
    let last = text.rfind("3\nroot").unwrap();
    for end in last + 1..text.len() - 1 {
        let cut = &text[..end];
        let (clip, warnings) = clip_of(ASF, cut);
        let whole = clip.frames() == 3;
        // A file truncated at the end of a line lacks some bones of its last frame; one truncated
        // after a digit may lack the rest of a number.
        let told = warnings.iter().any(|text| {
            text.contains("dropped") || text.contains("held") || text.contains("left out")
        });
        assert!(whole || (clip.frames() == 2 && told), "{warnings:?} {}", &text[last..end]);
        assert_eq!(clip.rotations(1), plain.rotations(1));
    }
    let (clip, warnings) = clip_of(ASF, text.trim_end().trim_end_matches("8.5 6.5\nshin 11.5"));
    assert_eq!(clip.frames(), 2);
    assert_eq!(warnings, ["the last row holds 9 numbers instead of 12 (line 14); dropped"]);
    assert_eq!(
        refused(ASF, "1\nroot 1 2"),
        "take.amc:2:1: found the end of the file, expected a whole frame"
    );
}

#[test]
fn motions_with_faults_are_refused_with_their_place() {
    let text = amc(3);
    let cases = [
        (
            with(&text, "\n3\nroot 3.5 90.5", "\n3\nroot 3.5"),
            "take.amc:15:1: found 5 values for `root`, expected 6: tx ty tz rx ry rz",
        ),
        (
            with(&text, "\n3\nroot 3.5", "\n3\nroot 3.5 7.5"),
            "take.amc:15:1: found 7 values for `root`, expected 6: tx ty tz rx ry rz",
        ),
        (
            with(&text, "\n3\nroot 3.5", "\n3\nroot x3.5"),
            "take.amc:15:6: found `x3.5`, expected a number for `root`",
        ),
        (with(&text, "\n1\n", "\n"), "take.amc:4:1: found `root`, expected the number of a frame"),
        (
            ":DEGREES\n# nothing\n".to_owned(),
            "take.amc:3:1: found the end of the file, expected the number of a frame",
        ),
        (String::new(), "take.amc:1:1: found an empty file, expected a motion file"),
    ];
    for (text, expected) in cases {
        assert_eq!(refused(ASF, &text), expected);
    }
}

#[test]
fn skeletons_with_faults_are_refused_with_their_place() {
    let error = |asf: &str| skeleton_of(asf).unwrap_err().to_string();
    let bone = |name: &str| format!("begin name {name} end\n");
    let tree = |bones: &[&str], lines: &str| {
        let bones: String = bones.iter().map(|name| bone(name)).collect();
        format!(":root\n:bonedata\n{bones}:hierarchy\n{lines}\n")
    };
    let cases = [
        (String::new(), "toy.asf:1:1: found an empty file, expected a motion file"),
        (
            "thigh".to_owned(),
            "toy.asf:1:1: found `thigh`, expected a section of a skeleton, such as `:root`",
        ),
        (
            ASF.split(":hierarchy").next().unwrap().to_owned(),
            "toy.asf:52:1: found the end of the file, expected `:hierarchy`",
        ),
        (
            with(ASF, "direction 0.1 -0.9 0\n", "direction 0.1 up 0\n"),
            "toy.asf:20:19: found `up`, expected a number",
        ),
        (with(ASF, "length 40", "length nan"), "toy.asf:21:12: found `nan`, expected a number"),
        (
            with(ASF, "20 XYZ", "20 XXZ"),
            "toy.asf:33:17: found `XXZ`, expected an order of axes, such as `XYZ`",
        ),
        (
            with(ASF, "dof rz rx", "dof rz rz"),
            "toy.asf:42:12: found `rz`, expected each degree of freedom once",
        ),
        (
            with(ASF, "dof rz rx", "dof rz yaw"),
            "toy.asf:42:12: found `yaw`, expected a degree of freedom: tx, ty, tz, rx, ry, rz or l",
        ),
        (
            with(ASF, "name shin", "name thigh"),
            "toy.asf:30:10: found `thigh`, expected a name that no other bone has",
        ),
        (
            with(ASF, "name shin", "name"),
            "toy.asf:28:3: found a bone without a name, expected a `name` in every bone",
        ),
        (
            with(ASF, "end\n:hierarchy", ":hierarchy"),
            "toy.asf:51:3: found `:hierarchy`, expected `end` of the bone",
        ),
        (
            with(ASF, "thigh shin", "thigh shin spine"),
            "toy.asf:55:16: found `spine`, expected each bone below one other",
        ),
        (
            tree(&["a", "b", "c"], "root c\na b\nb a"),
            "toy.asf:3:12: found `a` below itself, expected a hierarchy without circles",
        ),
        (tree(&["a"], "a a"), "toy.asf:3:12: found `a` below itself"),
        (
            tree(&["a"], "root a\na root"),
            "toy.asf:6:3: found `root`, expected each bone below one other, and the root below none",
        ),
    ];
    for (text, expected) in cases {
        let found = error(&text);
        assert!(found.starts_with(expected), "{found}\n{expected}");
    }

    let odd = |asf: &str| {
        skeleton_of(asf).unwrap().warnings().iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    assert_eq!(
        odd(&tree(&["a", "b"], "root a tail")),
        [
            "1 name in the hierarchy (line 6) without bone, such as `tail`; left out",
            "1 bone (line 4) not below the root, such as `b`; left out"
        ]
    );
    // Deep, but within the limit.
    let chain = |depth: usize| {
        let names: Vec<String> = (0..depth).map(|i| format!("b{i}")).collect();
        let lines: Vec<String> = std::iter::once("root")
            .chain(names.iter().map(String::as_str))
            .zip(&names)
            .map(|(a, b)| format!("{a} {b}"))
            .collect();
        tree(&names.iter().map(String::as_str).collect::<Vec<_>>(), &lines.join("\n"))
    };
    assert_eq!(
        import("deep.asf", chain(4000).as_bytes(), &ImportOptions::default()).unwrap().clips[0]
            .clip
            .skeleton()
            .len(),
        4001
    );
    assert!(error(&chain(10_000)).contains("found a bone below more than 4096 others"));
}

#[test]
fn best_skeleton_prefers_names_and_bones() {
    let plain = skeleton_of(ASF).unwrap();
    let other = skeleton_of(ASF.replace("shin", "calf")).unwrap();
    let foreign =
        skeleton_of(ASF.replace("thigh", "x").replace("shin", "y").replace("spine", "z")).unwrap();
    let motion = amc(2);
    let best = |name: &str, skeletons: &[(&str, &AcclaimSkeleton)]| {
        best_skeleton(name, motion.as_bytes(), skeletons)
    };
    assert_eq!(best("01_01.amc", &[]), None);
    assert_eq!(best("01_01.amc", &[("01.asf", &foreign)]), None, "the root alone is no fit");
    assert_eq!(
        best("01_01.amc", &[("01.asf", &other), ("02.asf", &plain)]),
        Some(1),
        "bones count before names"
    );
    assert_eq!(best("02_01.amc", &[("01.asf", &plain), ("02.asf", &plain)]), Some(1));
    assert_eq!(best("b/walk.amc", &[("a/s.asf", &plain), ("b/s.asf", &plain)]), Some(1));
    assert_eq!(best("walk.amc", &[("a.asf", &plain), ("b.asf", &plain)]), Some(0));
    assert_eq!(best_skeleton("walk.amc", b"HIERARCHY", &[("a.asf", &plain)]), None);
}

#[test]
fn reading_reports_progress_and_stops() {
    let text = amc(12_000);
    let skeleton = skeleton_of(ASF).unwrap();
    let mut seen = vec![];
    let mut watch = |keep: bool| {
        let mut progress = |bytes| {
            seen.push(bytes);
            keep
        };
        read_motion_with_progress(
            "a.amc",
            text.as_bytes(),
            &skeleton,
            &ImportOptions::default(),
            &mut progress,
        )
        .unwrap()
    };
    assert_eq!(watch(true).unwrap().clips[0].clip.frames(), 12_000);
    assert!(watch(false).is_none());
    assert_eq!(seen.len(), text.len() / (1 << 18) + 1);
    let small = ImportOptions { max_bytes: 100, ..ImportOptions::default() };
    assert!(read_motion("a.amc", text.as_bytes(), &skeleton, &small).is_err());
    assert!(read_skeleton("a.asf", ASF.as_bytes(), &small).is_err());
}

#[test]
fn angles_of_many_turns_are_told() {
    let (clip, warnings) = clip_of(ASF, amc(4).replacen("shin 11.5", "shin 1e20", 1));
    assert_eq!(
        warnings,
        ["1 row with an angle of more than a hundred turns, up to 1.0e20°"].map(str::to_owned)
    );
    assert!((0..4).flat_map(|frame| clip.rotations(frame)).all(|turn| turn.is_finite()));
}
