//! Thirty small files that break importers, with the expected result of each.

mod common;

use common::{bvh_files, shared_data};
use glam::{Quat, Vec3};
use segue_formats::{ImportOptions, ImportedFile, import};
use segue_motion::clip::{Clip, UpAxis};
use segue_motion::skeleton::Channel;

/// Joint names of the plain files.
const NAMES: [&str; 3] = ["Hips", "Spine", "Head"];

/// Returns `Rz · Rx · Ry` from degrees, by glam.
fn zxy(z: f32, x: f32, y: f32) -> Quat {
    Quat::from_rotation_z(z.to_radians())
        * Quat::from_rotation_x(x.to_radians())
        * Quat::from_rotation_y(y.to_radians())
}

fn assert_near(found: Quat, expected: Quat, what: &str) {
    assert!(
        (found * expected.conjugate()).to_axis_angle().1.min(1.0) < 1e-5
            || (found - expected).length() < 1e-6,
        "{what}: {found} {expected}"
    );
}

/// Checks the motion that almost all of the files hold, in metres.
fn check_motion(name: &str, clip: &Clip, frames: usize) {
    assert_eq!((clip.frames(), clip.fps()), (frames, 30.0), "{name}");
    assert_eq!(clip.provenance().metres_per_unit, 0.01, "{name}");
    assert_eq!(clip.provenance().up, UpAxis::Y, "{name}");
    let heights = [0.9, 0.91, 0.905, 0.9];
    for (frame, &height) in heights.iter().enumerate().take(frames) {
        let f = frame as f32;
        let at = Vec3::new(0.01 * f, height, 0.05 * f);
        assert!(clip.root_translations()[frame].distance(at) < 1e-6, "{name}, frame {frame}");
        assert_near(clip.rotations(frame)[0], zxy(0.0, 0.0, 10.0 + f), name);
        assert_near(
            clip.rotations(frame)[1],
            zxy(1.0 + 0.5 * f, 2.0 + 0.5 * f, 3.0 + 0.5 * f),
            name,
        );
        assert_near(
            clip.rotations(frame)[2],
            zxy(4.0 + 0.5 * f, 5.0 + 0.5 * f, 6.0 + 0.5 * f),
            name,
        );
    }
    assert_eq!(clip.translations(), [], "{name}");
}

fn check_skeleton(name: &str, clip: &Clip, names: [&str; 3], has_end_site: bool) {
    let joints = clip.skeleton().joints();
    assert_eq!(joints.iter().map(|j| j.name.as_str()).collect::<Vec<_>>(), names, "{name}");
    assert_eq!(
        joints.iter().map(|j| j.parent).collect::<Vec<_>>(),
        [None, Some(0), Some(1)],
        "{name}"
    );
    for (joint, height) in joints.iter().zip([0.9, 0.1, 0.4]) {
        assert!(joint.offset.distance(Vec3::Y * height) < 1e-6, "{name}");
    }
    assert_eq!(joints[2].end_site.is_some(), has_end_site, "{name}");
    assert!(joints[2].end_site.is_none_or(|end| end.distance(Vec3::Y * 0.2) < 1e-6), "{name}");
    assert_eq!([joints[0].end_site, joints[1].end_site], [None, None], "{name}");
}

#[test]
fn hard_files_are_read_as_expected() {
    let Some(data) = shared_data() else { return };
    let files = bvh_files(&data.join("hard"));
    assert_eq!(files.len(), 30);
    for (name, bytes) in &files {
        let result = import(name, bytes, &ImportOptions::default());
        if name == "45_short_row.bvh" {
            let error = result.unwrap_err();
            assert_eq!(
                error.to_string(),
                "45_short_row.bvh:25:1: found a row of 10 numbers, expected 12 numbers, one for each channel"
            );
            assert!(error.hint.is_some());
            continue;
        }
        let ImportedFile { clips, warnings } = result.unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(clips.len(), 1, "{name}");
        assert!(!clips[0].t_pose_first_row, "{name}");
        let clip = &clips[0].clip;
        let warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
        let (mut expected_warnings, mut names, mut has_end_site) = (vec![], NAMES, true);
        match name.as_str() {
            // Files that deviate from the base file.
            "16_missing_end_site.bvh" => {
                has_end_site = false;
                check_motion(name, clip, 4);
            }
            "19_names_colon_dot.bvh" => {
                names = ["mixamorig:Hips", "spine.001", "Head-1"];
                check_motion(name, clip, 4);
            }
            "20_names_nonascii.bvh" => {
                names = ["センター", "Säule", "头"];
                check_motion(name, clip, 4);
            }
            "21_names_keywords.bvh" => {
                names = ["Hips", "End", "MOTION"];
                check_motion(name, clip, 4);
            }
            "24_rot_first_root.bvh" => {
                // Zrotation Xrotation Yrotation Xposition Yposition Zposition = 2 90.5 10 0 0 12 in
                // the third frame.
                assert_eq!(clip.frames(), 4);
                assert_near(clip.rotations(2)[0], zxy(2.0, 90.5, 10.0), name);
                assert!(clip.root_translations()[2].distance(Vec3::new(0.0, 0.0, 0.12)) < 1e-6);
                assert_eq!(
                    clip.skeleton().joints()[0].channels[..2],
                    [Channel::ZRotation, Channel::XRotation]
                );
            }
            "25_all_six_channels.bvh" => {
                // All positions are the OFFSETs: no joint moves against its parent.
                assert_eq!(clip.skeleton().joints()[2].channels.len(), 6);
                check_motion(name, clip, 4);
            }
            "27_zero_channel_joint.bvh" | "29_one_channel_joint.bvh" => {
                assert_eq!(clip.frames(), 4);
                let one = name.starts_with("29");
                assert_eq!(
                    clip.skeleton().joints()[1].channels,
                    if one { vec![Channel::XRotation] } else { vec![] }
                );
                for frame in 0..4 {
                    let f = frame as f32;
                    let spine = if one { zxy(0.0, 1.0 + 0.5 * f, 0.0) } else { Quat::IDENTITY };
                    assert_near(clip.rotations(frame)[1], spine, name);
                    assert_near(
                        clip.rotations(frame)[2],
                        zxy(4.0 + 0.5 * f, 5.0 + 0.5 * f, 6.0 + 0.5 * f),
                        name,
                    );
                }
            }
            "31_frames_too_many_declared.bvh" => {
                expected_warnings =
                    vec!["the header says 9 frames (line 22), the file holds 4; the rows count"];
                check_motion(name, clip, 4);
            }
            "32_frames_too_few_declared.bvh" => {
                expected_warnings =
                    vec!["the header says 3 frames (line 22), the file holds 4; the rows count"];
                check_motion(name, clip, 4);
            }
            "33_zero_frames.bvh" | "37_no_motion_section.bvh" => {
                expected_warnings = vec!["the file has a skeleton but no animation"];
                check_motion(name, clip, 0);
            }
            "34_one_frame.bvh" => check_motion(name, clip, 1),
            "38_sci_notation.bvh" => {
                assert_near(clip.rotations(0)[1], zxy(1.25e-5, 2.0, 3.0), name);
                assert_near(clip.rotations(1)[1], zxy(-4.002_063_2e-7, 2.5, 3.5), name);
                assert_near(clip.rotations(3)[2], zxy(5.5, 6.5, 7.5), name);
                assert_eq!(clip.frames(), 4);
            }
            "43_single_line_motion.bvh" => {
                expected_warnings = vec![
                    "no line holds exactly one frame (line 24); the numbers were read one after the other",
                ];
                check_motion(name, clip, 4);
            }
            "49_plus_and_leading_dot.bvh" => {
                assert_near(clip.rotations(0)[0], zxy(0.0, 0.0, 10.0), name);
                assert_near(clip.rotations(0)[1], zxy(0.0083, 2.0, 3.0), name);
                assert_eq!(clip.frames(), 4);
            }
            // The base file, and spellings of it that change nothing.
            "00_base.bvh"
            | "01_crlf.bvh"
            | "03_mixed_eol.bvh"
            | "04_bom.bvh"
            | "05_tabs_in_motion.bvh"
            | "06_trailing_ws_blank_lines.bvh"
            | "08_no_final_newline.bvh"
            | "09_frames_tab_header.bvh"
            | "10_frames_space_colon.bvh"
            | "12_frames_nospace.bvh"
            | "14_channel_case.bvh"
            | "17_end_site_named.bvh"
            | "48_comments.bvh" => check_motion(name, clip, 4),
            _ => panic!("{name} has no expectation"),
        }
        check_skeleton(name, clip, names, has_end_site);
        assert_eq!(clip.fps(), 30.0, "{name}");
        assert_eq!(warnings, expected_warnings, "{name}");
    }
}
