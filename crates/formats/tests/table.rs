//! Oddities of real BVH files, one test for each kind, on synthetic files.

#![expect(clippy::unwrap_used, reason = "helpers of tests: what fails here fails the test")]

mod common;

use common::{CHAIN, chain, one, read, row};
use glam::{Quat, Vec3};
use segue_formats::{ImportError, ImportOptions, bvh, import, import_with_progress};
use segue_motion::clip::{Clip, UpAxis};
use segue_motion::skeleton::Channel;

/// Returns the motion of [`chain`] with four frames.
fn plain() -> Clip {
    let (found, warnings) = one(chain(4));
    assert_eq!(warnings, [""; 0]);
    assert_eq!((found.clip.frames(), found.clip.fps()), (4, 100.0));
    found.clip
}

/// Asserts that a file has the content of [`plain`] and returns its warnings.
fn same(text: impl AsRef<[u8]>) -> Vec<String> {
    let (found, warnings) = one(text.as_ref());
    assert_eq!(found.clip, plain(), "{}", String::from_utf8_lossy(text.as_ref()));
    warnings
}

fn refused(text: impl AsRef<[u8]>) -> ImportError {
    read(text).unwrap_err()
}

fn utf16(text: &str) -> Vec<u8> {
    [0xfeff].into_iter().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect()
}

#[test]
fn line_ends_and_white_space_of_any_kind_are_read() {
    let text = chain(4);
    assert_eq!(same(text.replace('\n', "\r\n")), [""; 0]);
    assert_eq!(same(text.replace('\n', "\r")), [""; 0]);
    assert_eq!(same(text.replace('\n', " \t \r\n\n\t\n\r")), [""; 0]);
    assert_eq!(same(text.replace(' ', "\t")), [""; 0]);
    assert_eq!(same(text.replace(' ', " \x0b \x0c ")), [""; 0]);
    assert_eq!(same(text.trim_end()), [""; 0]);
    // Errors count lines, whatever ends them.
    for end in ["\n", "\r\n", "\r"] {
        assert_eq!(
            refused(text.replace("9.5\n2.5", "\n2.5").replace('\n', end)).line,
            25,
            "{end:?}"
        );
    }
}

#[test]
fn encodings_comments_and_padding_are_read() {
    let text = chain(4);
    assert_eq!(same(format!("\u{feff}{text}")), [""; 0]);
    assert_eq!(same(utf16(&text)), [""; 0]);
    let swapped: Vec<u8> = utf16(&text).chunks(2).flat_map(|pair| [pair[1], pair[0]]).collect();
    assert_eq!(same(swapped), [""; 0]);
    assert_eq!(same(utf16(&text.replace('\n', "\r\n"))), [""; 0]);
    assert_eq!(same(format!("# by hand\n// and # twice\n{text}")), [""; 0]);
    assert_eq!(same(text.replace("MOTION\n", "# here it comes\nMOTION // now\n")), [""; 0]);
    assert_eq!(same(text.replace("\n2.5 ", "\n# a row\n2.5 ")), [""; 0]);
    assert_eq!(same([text.as_bytes(), &[0; 4096]].concat()), [""; 0]);
    assert_eq!(
        refused(utf16(&text.replace("OFFSET 0 12 0", "OFFSET 0 ä12 0"))).to_string(),
        "test.bvh:8:14: found `ä12`, expected a number"
    );
}

#[test]
fn keywords_in_any_case_are_read() {
    let motion = chain(4);
    let shout = |text: &str, names: &[&str]| {
        names
            .iter()
            .fold(text.to_uppercase(), |text, name| text.replace(&name.to_uppercase(), name))
    };
    assert_eq!(same(shout(&motion, &["Pelvis", "Torso", "Skull"])), [""; 0]);
    let whisper = ["Pelvis", "Torso", "Skull"]
        .iter()
        .fold(motion.to_lowercase(), |text, name| text.replace(&name.to_lowercase(), name));
    assert_eq!(same(whisper), [""; 0]);
}

#[test]
fn headers_without_colons_spaces_or_frame_time_are_read() {
    let with = |header: &str| chain(4).replace("Frames: 4\nFrame Time: 0.01\n", header);
    for header in [
        "Frames:4\nFrameTime:0.01\n",
        "Frames : 4\nFrame  Time : 0.01\n",
        "frames 4 frame time .01\n",
        "Frame Time: 1e-2\nFrames: 4\n",
    ] {
        assert_eq!(same(with(header)), [""; 0], "{header}");
    }
    assert_eq!(same(with("Frame Time: 0.01\n")), [""; 0], "the number of frames is no news");
    assert_eq!(
        same(with("Frames: four\nFrame Time: 0.01\n")),
        ["the header says four frames (line 22), the file holds 4; the rows count"]
    );
    for header in ["Frames: 4\n", "Frames: 4\nFrame Time:\n"] {
        let (found, warnings) = one(with(header));
        assert_eq!((found.clip.fps(), found.clip.frames()), (30.0, 4));
        assert_eq!(warnings, ["no frame time; 30 frames per second are taken"]);
    }
}

#[test]
fn braces_on_any_line_are_read() {
    let text = chain(4);
    assert_eq!(same(text.replace("\n{", " {").replace("\n  {", "{")), [""; 0]);
    let swapped = text.replace(
        "    OFFSET 0 12 0\n    CHANNELS 3 Zrotation Xrotation Yrotation\n",
        "CHANNELS 3 Zrotation\nXrotation Yrotation OFFSET 0\n12 0\n",
    );
    assert_ne!(swapped, text);
    assert_eq!(same(swapped), [""; 0]);
    // The whole HIERARCHY on one line: names end at the brace.
    let (hierarchy, motion) = text.split_once("MOTION").unwrap();
    assert_eq!(same(format!("{}MOTION{motion}", hierarchy.replace('\n', " "))), [""; 0]);
    // No CHANNELS at all, and no OFFSET either.
    let (found, warnings) = one("ROOT a\n{\n OFFSET 0 1 0\n JOINT b\n {\n }\n}\n");
    assert_eq!(found.clip.skeleton().joints()[1].channels, []);
    assert_eq!(
        warnings,
        [
            "1 joint without OFFSET (line 4); placed on the parent",
            "the file has a skeleton but no animation"
        ]
    );
}

#[test]
fn end_sites_missing_named_or_repeated_are_read() {
    let text = chain(4);
    let without = text.replace("      End Site\n      {\n        OFFSET 0 22 0\n      }\n", "");
    assert_eq!(one(without).0.clip.skeleton().joints()[2].end_site, None);
    assert_eq!(same(text.replace("End Site", "End Site the top of the head")), [""; 0]);
    assert_eq!(same(text.replace("End Site", "EndSite")), [""; 0]);
    let twice = text.replace(
        "      End Site",
        "      End Site\n      {\n        OFFSET 0 22 0\n      }\n      End Site",
    );
    assert_eq!(same(twice), ["1 joint with more than one End Site (line 20); one was kept"]);
    let with_channels = text
        .replace("OFFSET 0 22 0", "OFFSET 0 22 0 CHANNELS 1 Xrotation")
        .replace(" 9.5\n", " 9.5 77\n");
    assert_eq!(same(with_channels), ["1 channel of End Sites (line 16) ignored"]);
    let (found, _) =
        one(text.replace("JOINT Torso", "JOINT End").replace("JOINT Skull", "JOINT Frames: 4"));
    assert_eq!(
        found.clip.skeleton().joints().iter().map(|j| j.name.as_str()).collect::<Vec<_>>(),
        ["Pelvis", "End", "Frames: 4"]
    );
}

#[test]
fn names_are_kept_as_written() {
    let names = |text: &[u8]| {
        one(text).0.clip.skeleton().joints().iter().map(|j| j.name.clone()).collect::<Vec<_>>()
    };
    let named =
        |first: &str, second: &str| chain(1).replace("Pelvis", first).replace("Torso", second);
    assert_eq!(
        names(named("left upper arm", "rig:Bip01 L.Thigh-2").as_bytes())[..2],
        ["left upper arm", "rig:Bip01 L.Thigh-2"]
    );
    assert_eq!(names(named("腰", "Größe").as_bytes())[..2], ["腰", "Größe"]);
    assert_eq!(names(named("twin", "twin").as_bytes())[..2], ["twin", "twin"]);
    // Joints are identified by their place, so equal names change nothing in their motion.
    let twins = one(chain(4).replace("Pelvis", "twin").replace("Torso", "twin")).0.clip;
    assert_eq!(
        (twins.rotations(3), twins.skeleton().joints()[2].parent),
        (plain().rotations(3), Some(1))
    );
    assert_eq!(names(named("", "// #1").as_bytes())[..2], ["", "// #1"]);
    let latin1: Vec<u8> = named("Hüfte", "b").chars().map(|c| c as u8).collect();
    assert_eq!(names(&latin1)[0], "Hüfte");
    assert_eq!(one(latin1).1, ["1 name not in UTF-8 (line 2); read as Latin-1"]);
}

#[test]
fn roots_each_give_a_character() {
    let second = "ROOT Other\n{\n OFFSET 100 80 0\n CHANNELS 2 Yposition Yrotation\n JOINT Tip\n {\n OFFSET 0 85 0\n CHANNELS 1 Xrotation\n }\n}\n";
    let rows = [0, 1, 2, 3]
        .map(|frame| format!("{} {} {} 30\n", row(frame), 80 + frame, 10 * frame))
        .concat();
    let imported =
        read(format!("{CHAIN}{second}MOTION\nFrames: 4\nFrame Time: 0.01\n{rows}")).unwrap();
    assert_eq!(imported.warnings, []);
    let [first, other] = &imported.clips[..] else { panic!("two characters") };
    assert_eq!((first.clip.name(), other.clip.name()), ("test (Pelvis)", "test (Other)"));
    assert_eq!(first.clip, plain().with_name("test (Pelvis)"));
    assert_eq!(other.clip.skeleton().len(), 2);
    assert!(other.clip.root_translations()[3].distance(Vec3::new(1.0, 0.83, 0.0)) < 1e-6);
    assert!(
        (other.clip.rotations(3)[0] - Quat::from_rotation_y(30f32.to_radians())).length() < 1e-6
    );
    assert!(
        (other.clip.rotations(3)[1] - Quat::from_rotation_x(30f32.to_radians())).length() < 1e-6
    );
}

#[test]
fn channels_of_any_number_are_read() {
    // 9 with scales, then 2, then 0: the scales are skipped.
    let text = CHAIN
        .replace("CHANNELS 6 Xposition", "CHANNELS 9 Xscale Yscale Zscale Xposition")
        .replacen("CHANNELS 3 Zrotation Xrotation Yrotation", "CHANNELS 2 Yrotation Xrotation", 1)
        .replacen("CHANNELS 3 Zrotation Xrotation Yrotation", "CHANNELS 0", 1);
    let (found, warnings) =
        one(format!("{text}MOTION\nFrames: 1\nFrame Time: 0.01\n7 8 9 1 2 3 10 20 30 40 50\n"));
    assert_eq!(warnings, ["3 scale channels (first: line 5) ignored"]);
    let turn = |x: f32, y: f32| {
        Quat::from_rotation_y(y.to_radians()) * Quat::from_rotation_x(x.to_radians())
    };
    assert!(found.clip.root_translations()[0].distance(Vec3::new(0.01, 0.02, 0.03)) < 1e-7);
    assert!((found.clip.rotations(0)[1] - turn(50.0, 40.0)).length() < 1e-6);
    assert_eq!(found.clip.rotations(0)[2], Quat::IDENTITY);
    let joints = found.clip.skeleton().joints();
    assert_eq!(joints[0].channels.len(), 6, "scales are no channels of a clip");
    assert_eq!(joints[1].channels, [Channel::YRotation, Channel::XRotation]);
}

#[test]
fn channels_in_any_order_are_read() {
    // Rotations before positions, positions between rotations, and any order of axes: the order of
    // rotations is that of the product.
    let text = CHAIN
        .replace(
            "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation",
            "CHANNELS 6 Yrotation Zposition Xrotation Xposition Zrotation Yposition",
        )
        .replacen(
            "CHANNELS 3 Zrotation Xrotation Yrotation",
            "CHANNELS 3 Xrotation Yrotation Zrotation",
            1,
        )
        .replacen(
            "CHANNELS 3 Zrotation Xrotation Yrotation",
            "CHANNELS 3 Yrotation Xrotation Yrotation",
            1,
        );
    let text =
        format!("{text}MOTION\nFrames: 1\nFrame Time: 0.01\n10 3 20 1 30 2 40 50 60 70 80 90\n");
    // A single frame, bent double, from which the up axis must not be inferred.
    let options = ImportOptions {
        up: Some(UpAxis::Y),
        metres_per_unit: Some(0.01),
        ..ImportOptions::default()
    };
    let imported = import("test.bvh", text.as_bytes(), &options).unwrap();
    assert_eq!(imported.warnings, []);
    let found = &imported.clips[0];
    let turn = |axis: Vec3, degrees: f32| Quat::from_axis_angle(axis, degrees.to_radians());
    let expected = [
        turn(Vec3::Y, 10.0) * turn(Vec3::X, 20.0) * turn(Vec3::Z, 30.0),
        turn(Vec3::X, 40.0) * turn(Vec3::Y, 50.0) * turn(Vec3::Z, 60.0),
        turn(Vec3::Y, 70.0) * turn(Vec3::X, 80.0) * turn(Vec3::Y, 90.0),
    ];
    for (found, expected) in found.clip.rotations(0).iter().zip(expected) {
        assert!((*found - expected).length() < 1e-6, "{found} {expected}");
    }
    assert!(found.clip.root_translations()[0].distance(Vec3::new(0.01, 0.02, 0.03)) < 1e-7);
}

#[test]
fn positions_replace_the_offset() {
    let hierarchy = CHAIN
        .replace(
            "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation",
            "CHANNELS 1 Yrotation",
        )
        .replacen("CHANNELS 3 Zrotation Xrotation Yrotation", "CHANNELS 2 Xposition Zrotation", 1)
        .replacen(
            "CHANNELS 3 Zrotation Xrotation Yrotation",
            "CHANNELS 3 Xposition Yposition Zposition",
            1,
        );
    let (found, _) = one(format!(
        "{hierarchy}MOTION\nFrames: 2\nFrame Time: 0.01\n5 3 10 0 42 0\n6 4 20 0 42 0\n"
    ));
    assert_eq!(found.clip.root_translations(), [Vec3::new(0.0, 0.88, 0.0); 2]);
    // The Torso moves in x only and keeps its OFFSET in y; the Skull stays at its OFFSET.
    let [track] = found.clip.translations() else { panic!("one joint moves") };
    assert_eq!(track.joint, 1);
    assert!(track.values[1].distance(Vec3::new(0.04, 0.12, 0.0)) < 1e-6);
}

#[test]
fn root_that_never_moves_is_folded_and_written_again() {
    let text = "ROOT reference\n{\n OFFSET 0 0 0\n CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n JOINT Hips\n {\n  \
                OFFSET 0 0 0\n  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n  JOINT Head\n  {\n   OFFSET 0 75 0\n  \
                }\n  JOINT Foot\n  {\n   OFFSET 0 -90 0\n  }\n }\n}\n\
                MOTION\nFrames: 2\nFrame Time: .0083333\n0 0 0 0 0 0 1 90 0 0 0 5\n0 0 0 0 0 0 3 90 0 0 0 6\n";
    let (found, warnings) = one(text);
    assert_eq!(warnings, [""; 0]);
    let names = |clip: &Clip| {
        clip.skeleton().joints().iter().map(|joint| joint.name.clone()).collect::<Vec<_>>()
    };
    assert_eq!(names(&found.clip), ["Hips", "Head", "Foot"]);
    assert!(found.clip.translations().is_empty());
    for (root, x) in found.clip.root_translations().iter().zip([0.01, 0.03]) {
        assert!(root.distance(Vec3::new(x, 0.9, 0.0)) < 1e-6);
    }
    assert!(found.clip.world_pose(1).positions[1].distance(Vec3::new(0.03, 1.65, 0.0)) < 1e-5);
    assert!((found.measure.height_metres() - 1.65).abs() < 1e-5);
    let written = bvh::write(&found.clip, &bvh::WriteOptions::default());
    assert!(written.contains("ROOT reference") && written.contains("JOINT Hips"));
    let rows: Vec<&str> =
        written.lines().skip_while(|line| !line.starts_with("Frame Time")).skip(1).collect();
    assert!(rows.iter().all(|row| row.starts_with("0 0 0 0 0 0 ")), "{rows:?}");
}

#[test]
fn offsets_of_zero_take_the_rest_pose_from_the_first_frame() {
    let six = "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation";
    let text = format!(
        "ROOT a\n{{\nOFFSET 0 0 0\n{six}\nJOINT b\n{{\nOFFSET 0 0 0\n{six}\nJOINT c\n{{\nOFFSET 0 0 0\n{six}\n}}\n}}\nJOINT d\n{{\nOFFSET 0 0 0\n{six}\n}}\n}}\n\
         MOTION\nFrames: 2\nFrame Time: 0.01\n0 95 0 0 0 0  0 45 0 0 0 0  0 30 0 0 0 0  0 -93 0 0 0 0\n1 95 0 0 0 0  0 45 0 0 0 0  0 31 0 0 0 0  0 -93 0 0 0 0\n"
    );
    let (found, warnings) = one(text);
    assert_eq!(warnings, ["all OFFSETs are zero; the rest pose was taken from the first row"]);
    let joints = found.clip.skeleton().joints();
    assert!(
        joints[1].offset.distance(Vec3::Y * 0.45) < 1e-6
            && joints[3].offset.distance(Vec3::Y * -0.93) < 1e-6
    );
    assert_eq!(found.clip.provenance().metres_per_unit, 0.01);
    assert_eq!(
        found.clip.translations().iter().map(|t| t.joint).collect::<Vec<_>>(),
        [2],
        "b and d never leave their new rest offsets"
    );
}

#[test]
fn channels_with_a_wrong_number_follow_their_names() {
    let text = chain(4).replace("    CHANNELS 3 Z", "    CHANNELS 6 Z");
    let said = "CHANNELS lines give numbers that disagree with the names after it (first: line 9), such as 6 for 3; the names count";
    assert_eq!(same(text), [format!("2 {said}")]);
    assert_eq!(same(chain(4).replace("CHANNELS 6 X", "CHANNELS X")).len(), 1);
    let error = refused(chain(4).replace("Zposition", "Wposition"));
    assert_eq!(
        error.to_string(),
        "test.bvh:5:34: found `Wposition`, expected a channel (`Xposition` … `Zposition`, `Xrotation` … `Zrotation`)"
    );
}

#[test]
fn frames_with_a_wrong_header_follow_the_rows() {
    for declared in ["3", "5", "0", "-4", "4000000000", "99999999999999999999"] {
        let text = chain(4).replace("Frames: 4", &format!("Frames: {declared}"));
        assert_eq!(
            same(text),
            [format!(
                "the header says {declared} frames (line 22), the file holds 4; the rows count"
            )]
        );
    }
}

#[test]
fn rows_across_lines_are_read_and_wrong_rows_refused() {
    let text = chain(4);
    let (head, rows) = text.split_once("0.01\n").unwrap();
    let note =
        "no line holds exactly one frame (line 24); the numbers were read one after the other";
    assert_eq!(same(format!("{head}0.01\n{}", rows.replace('\n', " "))), [note]);
    let numbers: Vec<&str> = rows.split_whitespace().collect();
    for width in [1, 5, 7, 24] {
        let lines: Vec<String> = numbers.chunks(width).map(|line| line.join(" ")).collect();
        assert_eq!(same(format!("{head}0.01\n{}\n", lines.join("\n"))), [note], "{width}");
    }
    // A truncated last row: with and without its line end, inside a number, inside an exponent.
    for cut in ["0.5 90.5", "0.5 90.5\n", "0.5 90.5 -", "0.5 90.5 1e-"] {
        let warnings = same(format!("{text}{cut}"));
        assert_eq!(
            warnings,
            ["the last row holds 2 numbers instead of 12 (line 28); dropped"],
            "{cut:?}"
        );
    }
    let long = refused(text.replace("9.5\n2.5", "9.5 1 2\n2.5"));
    assert_eq!(
        long.to_string(),
        "test.bvh:25:1: found a row of more than 12 numbers, expected 12 numbers, one for each channel"
    );
    let short = refused(text.replace("8.5 9.5\n2.5", "8.5\n2.5"));
    assert_eq!(
        short.to_string(),
        "test.bvh:25:1: found a row of 11 numbers, expected 12 numbers, one for each channel"
    );
    assert_eq!(
        refused(format!("{text}1 2 3 four\n")).to_string(),
        "test.bvh:28:7: found `four`, expected a number"
    );
}

#[test]
fn clip_of_no_frames_is_a_skeleton() {
    for text in [CHAIN.to_owned(), chain(0), format!("{CHAIN}MOTION"), CHAIN.trim_end().to_owned()]
    {
        let (found, warnings) = one(&text);
        assert_eq!((found.clip.frames(), found.clip.skeleton().len()), (0, 3));
        assert_eq!(
            warnings.last().map(String::as_str),
            Some("the file has a skeleton but no animation")
        );
        assert!((found.measure.height_metres() - 1.64).abs() < 1e-5);
    }
    let (found, warnings) = one(chain(1));
    assert_eq!((found.clip.frames(), warnings.len()), (1, 0));
    assert_eq!(found.clip.rotations(0), plain().rotations(0));
}

#[test]
fn frame_times_invalid_or_rounded_are_read() {
    let fps = |time: &str| {
        let (found, warnings) = one(chain(2).replace("0.01\n", &format!("{time}\n")));
        (found.clip.fps(), warnings)
    };
    for (time, expected) in [
        (".0083333", 120.0),
        (".03333", 30.0),
        ("0.0416667", 24.0),
        ("0.016667", 60.0),
        ("1e-2", 100.0),
    ] {
        assert_eq!(fps(time), (expected, vec![]), "{time}");
    }
    for expected in [23.976, 119.88, 29.97] {
        let (found, warnings) = fps(&format!("{:.9}", 1.0 / expected));
        assert!(
            (found - expected).abs() < 1e-3 && found != expected.round() && warnings.is_empty(),
            "{found}"
        );
    }
    for time in ["0", "-0.01", "nan", "soon"] {
        let said =
            format!("a frame time of {time} is no time (line 23); 30 frames per second are taken");
        assert_eq!(fps(time), (30.0, vec![said]));
    }
    // A frame rate that the user gives is used without a warning.
    let options = ImportOptions { fps: Some(48.0), ..ImportOptions::default() };
    let imported =
        import("test.bvh", chain(2).replace("0.01\n", "0\n").as_bytes(), &options).unwrap();
    assert_eq!((imported.clips[0].clip.fps(), imported.warnings.len()), (48.0, 0));
    let options = ImportOptions { fps: Some(f64::NAN), ..ImportOptions::default() };
    assert_eq!(
        import("test.bvh", chain(2).as_bytes(), &options).unwrap().clips[0].clip.fps(),
        100.0
    );
}

#[test]
fn numbers_in_every_spelling_are_read() {
    let text = chain(1).replace(
        "0.5 90.5 0.5 1.5 2.5 3.0 4.5",
        "+.5 9.05E+1 0.5000000000000000000001 1.5 2.50 3 45e-1",
    );
    assert_eq!(one(text).0.clip, one(chain(1)).0.clip);
    let (found, warnings) =
        one(chain(1).replace("0.5 90.5 0.5 1.5 2.5 3.0", "4.9e-324 1e-310 1e-7 7.6e-016 -0 -0.0"));
    assert_eq!(warnings, [""; 0]);
    assert!((found.clip.rotations(0)[0] - Quat::IDENTITY).length() < 1e-15);
    assert!(found.clip.root_translations()[0].distance(Vec3::ZERO) < 1e-8);
}

#[test]
fn values_not_finite_repeat_the_last_good_one() {
    // 600 values, of which 6 are invalid: exactly 1 %.
    let spoilt = |count: usize| {
        let words = ["nan", "-nan(ind)", "1.#IND", "-1.#IND00", "inf", "1.#QNAN", "-Infinity"];
        let spoil = |frame: usize| words.get(frame.wrapping_sub(10)).filter(|_| frame < 10 + count);
        let rows: Vec<String> = (0..50)
            .map(|frame| {
                spoil(frame).map_or_else(
                    || row(frame),
                    |word| row(frame).replace(" 4.5 5.5 ", &format!(" {word} 5.5 ")),
                )
            })
            .collect();
        format!("{CHAIN}MOTION\nFrames: 50\nFrame Time: 0.01\n{}\n", rows.join("\n"))
    };
    let (found, warnings) = one(spoilt(6));
    assert_eq!(
        warnings,
        ["6 values without a number (first: line 34); the last good value was held"]
    );
    assert_eq!(
        found.clip,
        one(chain(50)).0.clip,
        "the spoilt channel never changes, so that its last good value is its value"
    );
    let error = refused(spoilt(7));
    assert_eq!(
        (error.line, error.found.to_string().as_str(), error.expected.to_string().as_str()),
        (34, "no number in 7 of 600 values", "at most 1 % of them")
    );
    // Before any good value, positions are the OFFSET and rotations 0.
    let (found, _) = one(chain(50)
        .replacen("0.5 90.5 0.5 1.5 2.5", "nan nan nan nan 0", 1)
        .replacen(" 3.0 ", " 0 ", 1));
    assert!(found.clip.root_translations()[0].distance(Vec3::Y * 0.88) < 1e-6);
    assert_eq!(found.clip.rotations(0)[0], Quat::IDENTITY);
    assert_eq!(
        refused(chain(1).replace("OFFSET 0 12 0", "OFFSET 0 nan 0")).expected.to_string(),
        "a number"
    );
}

#[test]
fn decimal_commas_in_some_numbers_are_refused() {
    let commas = |text: &str| {
        let spelt = |word: &str| match word.parse::<f64>() {
            Ok(_) if word.contains('.') => word.replace('.', ","),
            Ok(_) => format!("{word},0"),
            Err(_) => word.to_owned(),
        };
        let line = |line: &str| {
            let (head, tail) = line.split_at(line.len() - line.trim_start().len());
            if tail.starts_with("CHANNELS") || tail.starts_with("Frames") {
                line.to_owned()
            } else {
                format!("{head}{}", tail.split(' ').map(spelt).collect::<Vec<_>>().join(" "))
            }
        };
        text.lines().map(line).collect::<Vec<_>>().join("\n")
    };
    let text = commas(&chain(4));
    assert!(text.contains("OFFSET 0,0 12,0 0,0") && text.contains("Frame Time: 0,01"));
    assert_eq!(same(&text), ["the numbers have decimal commas; read as points"]);
    assert_eq!(same(text.replace(" 1,5 ", " 15,0e-1 ")).len(), 1);
    // With one point or one integer among them, or with commas between numbers, a file is refused
    // at the first comma.
    let mixed = refused(text.replacen("1,5", "1.5", 1));
    assert_eq!(
        mixed.to_string(),
        "test.bvh:4:10: found `0,0`, expected a number with a decimal point"
    );
    assert!(mixed.hint.is_some_and(|hint| hint.to_string().contains("every number")));
    assert_eq!(
        refused(chain(4).replacen("1.5", "1,5", 1)).to_string(),
        "test.bvh:24:14: found `1,5`, expected a number with a decimal point"
    );
    assert_eq!(
        refused(chain(4).replace("0.5 90.5 0.5", "0.5, 90.5, 0.5")).found.to_string(),
        "`0.5,`"
    );
    assert_eq!(
        refused(chain(4).replace("0.5 90.5 0.5", "0.5,90.5,0.5")).found.to_string(),
        "`0.5,90.5,0.5`"
    );
}

#[test]
fn missing_spaces_before_signs_are_inserted() {
    let text = chain(4).replace(" 1.5 2.5 ", " 1.5-2.5 ");
    let spaced = chain(4).replace(" 1.5 2.5 ", " 1.5 -2.5 ");
    let (found, warnings) = one(&text);
    assert_eq!(found.clip, one(spaced).0.clip);
    assert_eq!(
        warnings,
        ["4 missing spaces between numbers (first: line 24); split before the sign"]
    );
    // Also across lines, and after an exponent.
    let rows = "0e-1+1-2+3-4+5-6+7-8+9-10+11\n".repeat(3);
    assert_eq!(
        one(format!("{CHAIN}MOTION\nFrames: 3\nFrame Time: 0.01\n{rows}")).0.clip.frames(),
        3
    );
}

#[test]
fn chains_that_are_too_deep_are_refused() {
    let nested = |depth: usize| {
        let joints = "JOINT j\n{\nOFFSET 0 1 0\nCHANNELS 1 Xrotation\n".repeat(depth - 1);
        let rows = "0 ".repeat(depth) + "\n";
        format!(
            "ROOT r\n{{\nOFFSET 0 1 0\nCHANNELS 1 Xrotation\n{joints}{}MOTION\nFrames: 2\nFrame Time: 0.01\n{rows}{rows}",
            "}\n".repeat(depth)
        )
    };
    let (found, warnings) = one(nested(3000));
    assert_eq!((found.clip.skeleton().len(), found.clip.frames(), warnings.len()), (3000, 2, 0));
    assert_eq!(one(nested(4096)).0.clip.skeleton().len(), 4096);
    let error = refused(nested(4097));
    assert_eq!(
        (error.found.to_string().as_str(), error.expected.to_string().as_str()),
        ("joints nested more than 4096 deep", "at most 4096 levels")
    );
    // Opening braces only: neither a stack overflow nor a long wait.
    assert!(
        refused("ROOT a {".to_owned() + &"JOINT a {".repeat(1_000_000))
            .found
            .to_string()
            .contains("4096")
    );
}

#[test]
fn t_pose_in_front_is_marked_and_dropped() {
    let bones = "CHANNELS 3 Zrotation Xrotation Yrotation";
    let mut hierarchy = CHAIN.replace("    }\n  }\n", "    }\n  }\n  @\n");
    let limb = |name: &str, x: f64| {
        format!(
            "JOINT {name}\n{{\nOFFSET {x} -40 0\n{bones}\nJOINT {name}2\n{{\nOFFSET 0 -40 0\n{bones}\n}}\n}}\n"
        )
    };
    hierarchy = hierarchy.replace('@', &(limb("L", 10.0) + &limb("R", -10.0)));
    let walk: String = (0..20).map(|frame| row(frame) + &" 20 -30 11".repeat(4) + "\n").collect();
    let t_pose = format!("0 88 0 {}\n", "0 ".repeat(21));
    let text = format!("{hierarchy}MOTION\nFrames: 21\nFrame Time: .0083333\n{t_pose}{walk}");
    let (found, warnings) = one(&text);
    assert!(found.t_pose_first_row && found.t_pose_dropped);
    assert_eq!(found.clip.frames(), 20);
    assert_eq!(
        warnings,
        [format!(
            "the first row is a T-pose (line {}); dropped",
            text.lines().position(|l| l.starts_with("0 88")).unwrap() + 1
        )]
    );
    let options = ImportOptions { drop_t_pose: false, ..ImportOptions::default() };
    let kept = import("test.bvh", text.as_bytes(), &options).unwrap().clips.remove(0);
    assert!(kept.t_pose_first_row && !kept.t_pose_dropped);
    assert_eq!(kept.clip.crop(1..21).unwrap(), found.clip);
}

#[test]
fn large_files_report_progress_and_have_a_limit() {
    let text = chain(20_000);
    let mut reports = vec![];
    let imported =
        import_with_progress("test.bvh", text.as_bytes(), &ImportOptions::default(), &mut |done| {
            reports.push(done);
            true
        });
    assert_eq!(imported.unwrap().unwrap().clips[0].clip.frames(), 20_000);
    assert!(
        reports.len() >= 3 && reports.is_sorted() && reports.iter().all(|&done| done <= text.len())
    );
    let stopped =
        import_with_progress("test.bvh", text.as_bytes(), &ImportOptions::default(), &mut |_| {
            false
        });
    assert_eq!(stopped.unwrap(), None);
    let options = ImportOptions { max_bytes: 1 << 20, ..ImportOptions::default() };
    assert_eq!(
        import("test.bvh", text.as_bytes(), &options).unwrap_err().expected.to_string(),
        "at most 1 MB"
    );
}

#[test]
fn unit_and_up_axis_are_inferred_or_given() {
    let z_up = chain(2)
        .replace("OFFSET 0 88 0", "OFFSET 0 0 88")
        .replace("OFFSET 0 12 0", "OFFSET 0 0 12")
        .replace("OFFSET 0 42 0", "OFFSET 0 0 42");
    let (found, warnings) = one(z_up.replace("OFFSET 0 22 0", "OFFSET 0 0 22"));
    assert_eq!((found.clip.provenance().up, warnings.len()), (UpAxis::Z, 0));
    assert!(found.clip.skeleton().joints()[1].offset.distance(Vec3::Y * 0.12) < 1e-6);
    assert_eq!(found.measure.to_string(), "164.0 units tall, read as centimetres: 1.64 m; Z up");
    // x, y, z of the file are x, z, -y of the clip.
    assert!(found.clip.root_translations()[0].distance(Vec3::new(0.005, 0.005, -0.905)) < 1e-6);
    let options = ImportOptions {
        metres_per_unit: Some(0.02),
        up: Some(UpAxis::Y),
        ..ImportOptions::default()
    };
    let given = import("test.bvh", chain(2).as_bytes(), &options).unwrap().clips.remove(0);
    assert!(given.clip.skeleton().joints()[1].offset.distance(Vec3::Y * 0.24) < 1e-6);
    assert_eq!(given.measure.to_string(), "164.0 units tall, set to units of 0.02 m: 3.28 m; Y up");
}
