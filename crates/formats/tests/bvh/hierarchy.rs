//! Joints, channels, units and axes.

use super::*;
use segue_formats::bvh;
use segue_motion::skeleton::Channel;

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
