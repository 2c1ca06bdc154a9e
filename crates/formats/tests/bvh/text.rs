//! Encodings, white space, keywords and names.

use super::*;

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
        assert_eq!(warnings, ["no frame time; 30 frames per second are assumed"]);
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
