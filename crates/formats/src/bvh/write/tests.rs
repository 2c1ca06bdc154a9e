//! Tests of written BVH files.

use super::*;
use segue_motion::clip::{JointTranslations, Provenance};
use std::sync::Arc;

fn joint(parent: Option<usize>, name: &str, channels: &[Channel]) -> Joint {
    Joint {
        name: name.into(),
        parent,
        offset: Vec3::new(0.0, 0.1, 0.0),
        end_site: None,
        channels: channels.to_vec(),
    }
}

fn clip(joints: Vec<Joint>, rotations: Vec<Quat>) -> Clip {
    let frames = rotations.len() / joints.len();
    let skeleton = Arc::new(Skeleton::new(joints).unwrap());
    Clip::new("c", skeleton, 120.0, rotations, vec![Vec3::new(0.0, 0.1, 0.0); frames]).unwrap()
}

#[test]
fn write_without_channels_adds_those_of_the_motion() {
    let turned = Quat::from_rotation_x(0.5);
    let joints =
        vec![joint(None, "Hips", &[]), joint(Some(0), "Still", &[]), joint(Some(1), "Turns", &[])];
    let clip = clip(joints, vec![Quat::IDENTITY, Quat::IDENTITY, turned])
        .with_provenance(Provenance::default());
    let expected = "HIERARCHY\nROOT Hips\n{\n\tOFFSET 0 0 0\n\tCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n\
                    \tJOINT Still\n\t{\n\t\tOFFSET 0 10 0\n\t\tCHANNELS 0\n\t\tJOINT Turns\n\t\t{\n\t\t\tOFFSET 0 10 0\n\
                    \t\t\tCHANNELS 3 Zrotation Xrotation Yrotation\n\t\t\tEnd Site\n\t\t\t{\n\t\t\t\tOFFSET 0 0 0\n\t\t\t}\n\t\t}\n\t}\n}\n\
                    MOTION\nFrames: 1\nFrame Time: 0.008333333333333333\n0 10 0 0 0 0 0 28.64789 0\n";
    assert_eq!(write(&clip, &WriteOptions::default()), expected);
}

#[test]
fn write_keeps_channels_that_hold_the_motion() {
    use Channel::{XPosition, XRotation, YRotation, ZRotation};
    let channels_of = |channels: &[Channel], q: Quat, options: &WriteOptions| {
        let joints = vec![
            joint(None, "r", &[XPosition, ZRotation, YRotation, XRotation]),
            joint(Some(0), "j", channels),
        ];
        let text = write(&clip(joints, vec![Quat::IDENTITY, q]), options);
        let lines: Vec<&str> =
            text.lines().filter(|line| line.contains("CHANNELS")).map(str::trim).collect();
        lines[1].to_owned()
    };
    let (about_x, about_all) = (
        Quat::from_rotation_x(1.0),
        Quat::from_rotation_x(1.0) * Quat::from_rotation_y(0.5) * Quat::from_rotation_z(0.2),
    );
    let own = WriteOptions::default();
    assert_eq!(channels_of(&[XRotation], about_x, &own), "CHANNELS 1 Xrotation");
    assert_eq!(
        channels_of(&[XRotation], about_all, &own),
        "CHANNELS 3 Zrotation Xrotation Yrotation"
    );
    assert_eq!(
        channels_of(&[YRotation, XRotation], about_x, &own),
        "CHANNELS 2 Yrotation Xrotation"
    );
    assert_eq!(
        channels_of(&[XRotation, YRotation, ZRotation], about_all, &own),
        "CHANNELS 3 Xrotation Yrotation Zrotation"
    );
    assert_eq!(
        channels_of(&[ZRotation, XRotation, ZRotation], about_all, &own),
        "CHANNELS 3 Zrotation Xrotation Yrotation"
    );
    let chosen = WriteOptions { rotation_order: Some(RotationOrder::Yzx), ..own };
    assert_eq!(
        channels_of(&[XRotation, YRotation, ZRotation], about_all, &chosen),
        "CHANNELS 3 Yrotation Zrotation Xrotation"
    );
    assert_eq!(channels_of(&[], Quat::IDENTITY, &chosen), "CHANNELS 0");
    assert_eq!(
        channels_of(&[XPosition, XRotation], about_all, &own),
        "CHANNELS 4 Xposition Zrotation Xrotation Yrotation"
    );
    assert_eq!(
        channels_of(&[XRotation, XPosition], about_all, &own),
        "CHANNELS 4 Zrotation Xrotation Yrotation Xposition"
    );
}

#[test]
fn write_of_a_moving_joint_adds_positions() {
    let joints =
        vec![joint(None, "r", &[Channel::XPosition]), joint(Some(0), "j", &[Channel::ZRotation])];
    let clip = clip(joints, vec![Quat::IDENTITY; 2]);
    let track = JointTranslations { joint: 1, values: vec![Vec3::new(0.0, 0.25, 0.0)] };
    let clip = clip.with_translations(vec![track]).unwrap();
    let text =
        write(&clip, &WriteOptions { metres_per_unit: Some(1.0), ..WriteOptions::default() });
    assert!(text.contains("CHANNELS 4 Xposition Yposition Zposition Zrotation\n"), "{text}");
    assert!(text.ends_with("\n0 0 0.25 0 0\n"), "{text}");
}

#[test]
fn write_of_names_keeps_them_on_one_line() {
    assert_eq!(written_name("a{b}\nc "), "a(b) c");
    assert_eq!(written_name("mixamorig:Hips センター"), "mixamorig:Hips センター");
}

#[test]
fn number_has_no_trailing_zeros() {
    let text = |value: f64| {
        let mut out = String::from("x");
        number(&mut out, value, 6);
        out
    };
    for (value, expected) in [
        (0.0, "x0"),
        (-1e-9, "x0"),
        (100.0, "x100"),
        (-0.5, "x-0.5"),
        (1.0 / 3.0, "x0.333333"),
        (1e12, "x1000000000000"),
    ] {
        assert_eq!(text(value), expected);
    }
}

#[test]
fn write_at_another_rate_resamples() {
    let joints = vec![joint(None, "r", &[])];
    let clip = clip(joints, (0..5).map(|i| Quat::from_rotation_x(0.1 * i as f32)).collect());
    let at = |fps| {
        let options = WriteOptions { fps, ..WriteOptions::default() };
        write(&clip, &options)
    };
    assert!(
        at(Some(60.0)).contains(
            "Frames: 3\nFrame Time: 0.016666666666666666\n0 10 0 0 0 0\n0 10 0 0 11.459156 0\n"
        ),
        "{}",
        at(Some(60.0))
    );
    for no_rate in [None, Some(0.0), Some(f64::NAN), Some(1e9)] {
        assert!(at(no_rate).contains("Frames: 5\nFrame Time: 0.008333333333333333\n"));
    }
}
