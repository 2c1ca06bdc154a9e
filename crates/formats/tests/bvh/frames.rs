//! Rows of numbers and frame times.

use super::*;
use segue_formats::import_with_progress;

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
        let said = format!(
            "a frame time of {time} is not a time (line 23); 30 frames per second are assumed"
        );
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
fn angles_of_many_turns_are_told() {
    let told = |angle: &str| {
        let (found, warnings) = one(chain(4).replace("8.5 9.5\n2.5", &format!("8.5 {angle}\n2.5")));
        assert!((0..4).flat_map(|frame| found.clip.rotations(frame)).all(|turn| turn.is_finite()));
        warnings
    };
    for (angle, shown) in [("1e20", "1.0e20"), ("-99999", "99999")] {
        assert_eq!(
            told(angle),
            [format!("1 row with an angle of more than a hundred turns, up to {shown}°")]
        );
    }
    assert_eq!(told("35999"), [""; 0]);
    // A position may be as large: a walk in millimetres.
    let (_, warnings) = one(chain(4).replace("\n0.5 90.5", "\n40000 90.5"));
    assert!(warnings.iter().all(|warning| !warning.contains("turns")), "{warnings:?}");
}
