//! Properties of any clip and any bytes: a clip reads back equal from its own file, and no file
//! makes the reader panic.

#![expect(clippy::unwrap_used, reason = "helpers of tests: what fails here fails the test")]

mod common;

use common::chain;
use glam::{Quat, Vec3};
use proptest::prelude::*;
use segue_formats::bvh::{RotationOrder, WriteOptions, write};
use segue_formats::gltf::{self, GlbOptions, write_glb};
use segue_formats::{ImportOptions, import};
use segue_motion::clip::{Clip, JointTranslations, Provenance, UpAxis};
use segue_motion::math::quat;
use segue_motion::skeleton::{Channel, Joint, Skeleton};
use std::sync::Arc;

const CHANNELS: [Channel; 6] = [
    Channel::XPosition,
    Channel::YPosition,
    Channel::ZPosition,
    Channel::XRotation,
    Channel::YRotation,
    Channel::ZRotation,
];

fn vector(size: f32) -> impl Strategy<Value = Vec3> {
    (-size..size, -size..size, -size..size).prop_map(|(x, y, z)| Vec3::new(x, y, z))
}

/// Any rotation; often one in which some order of channels is in gimbal lock, or nearly.
fn rotation() -> impl Strategy<Value = Quat> {
    let quarter = std::f32::consts::FRAC_PI_2;
    let locked = (0..6_usize, -4.0f32..4.0, -9.0f32..0.0, any::<bool>(), -4.0f32..4.0).prop_map(
        move |(order, a, near, up, c)| {
            let orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
            let axes = orders[order].map(|axis: usize| Vec3::AXES[axis]);
            let middle = if up { quarter } else { -quarter } + 10f32.powf(near);
            Quat::from_axis_angle(axes[0], a)
                * Quat::from_axis_angle(axes[1], middle)
                * Quat::from_axis_angle(axes[2], c)
        },
    );
    prop_oneof![
        3 => vector(4.0).prop_map(quat::exp),
        1 => Just(Quat::IDENTITY),
        2 => locked,
    ]
}

/// A joint: its parent among those before it, its offset, its end site, and its channels.
type Bone = (prop::sample::Index, Vec3, Option<Vec3>, Vec<Channel>);

fn bone() -> impl Strategy<Value = Bone> {
    let end = proptest::option::of(vector(0.5));
    (
        any::<prop::sample::Index>(),
        vector(1.0),
        end,
        prop::collection::vec(prop::sample::select(CHANNELS.to_vec()), 0..7),
    )
}

fn clip() -> impl Strategy<Value = Clip> {
    let fps = prop::sample::select(vec![24.0, 30.0, 120.0, 23.976, 119.88, 0.5]);
    let provenance = (
        prop::sample::select(vec![1.0, 0.01, 0.0254 / 0.45, 0.001]),
        prop::sample::select(vec![UpAxis::Y, UpAxis::Z]),
    );
    (prop::collection::vec(bone(), 1..12), 0..5_usize, fps, provenance).prop_flat_map(
        |(bones, frames, fps, (metres_per_unit, up))| {
            let joint = |(index, (parent, offset, end_site, channels)): (usize, Bone)| Joint {
                name: format!("joint {index}"),
                parent: (index > 0).then(|| parent.index(index)),
                offset,
                end_site,
                channels,
            };
            let joints: Vec<Joint> = bones.into_iter().enumerate().map(joint).collect();
            let rotations = prop::collection::vec(rotation(), joints.len() * frames);
            let roots = prop::collection::vec(vector(50.0), frames);
            let moving = prop::collection::vec(
                proptest::option::weighted(0.3, prop::collection::vec(vector(2.0), frames)),
                joints.len() - 1,
            );
            (Just(joints), rotations, roots, moving).prop_map(
                move |(joints, rotations, roots, moving)| {
                    let tracks = moving.into_iter().enumerate().filter_map(|(index, values)| {
                        Some(JointTranslations { joint: index + 1, values: values? })
                    });
                    let skeleton = Arc::new(Skeleton::new(joints).unwrap());
                    let clip = Clip::new("clip", skeleton, fps, rotations, roots)
                        .unwrap()
                        .with_translations(tracks.collect())
                        .unwrap();
                    clip.with_provenance(Provenance { metres_per_unit, up })
                },
            )
        },
    )
}

fn options() -> impl Strategy<Value = WriteOptions> {
    use RotationOrder::{Xyz, Xzy, Yxz, Yzx, Zxy, Zyx};
    let unit = proptest::option::of(prop::sample::select(vec![1.0, 0.01, 0.3048]));
    let up = proptest::option::of(prop::sample::select(vec![UpAxis::Y, UpAxis::Z]));
    let order = proptest::option::of(prop::sample::select(vec![Xyz, Xzy, Yxz, Yzx, Zxy, Zyx]));
    (unit, up, order).prop_map(|(metres_per_unit, up, rotation_order)| WriteOptions {
        metres_per_unit,
        up,
        rotation_order,
        fps: None,
    })
}

/// Returns the local translation of a joint, whether it moves or not.
fn translation(clip: &Clip, joint: usize, frame: usize) -> Vec3 {
    let track = clip.translations().iter().find(|track| track.joint == joint);
    track.map_or(clip.skeleton().joints()[joint].offset, |track| track.values[frame])
}

/// Returns the joints in the order of a file, depth first.
fn file_order(skeleton: &Skeleton) -> Vec<usize> {
    let (mut order, mut todo) = (vec![], vec![0]);
    while let Some(joint) = todo.pop() {
        order.push(joint);
        let children: Vec<usize> = skeleton.children(joint).collect();
        todo.extend(children.into_iter().rev());
    }
    order
}

/// Returns for each joint that was read the joint of the written clip, whose form with the carrier
/// first is `folded`.
fn written_joints(back: &Clip, clip: &Clip, folded: &Clip) -> Vec<usize> {
    let order = file_order(clip.skeleton());
    let joints = 0..back.skeleton().len();
    let in_file = |found: usize| {
        back.skeleton().folded_chain().map_or(found, |above| above.file_index()[found])
    };
    let in_folded = |joint: usize| {
        folded.skeleton().folded_chain().map_or(joint, |above| above.from_file()[joint])
    };
    joints.map(|found| in_folded(order[in_file(found)])).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn written_bvh_reads_back_equal(clip in clip(), options in options()) {
        let text = write(&clip, &options);
        let provenance = Provenance {
            metres_per_unit: options.metres_per_unit.unwrap_or(clip.provenance().metres_per_unit),
            up: options.up.unwrap_or(clip.provenance().up),
        };
        let reading = ImportOptions {
            metres_per_unit: Some(provenance.metres_per_unit),
            up: Some(provenance.up),
            drop_t_pose: false,
            ..ImportOptions::default()
        };
        let imported = import("clip.bvh", text.as_bytes(), &reading)
            .map_err(|error| TestCaseError::fail(format!("{error}\n{text}")))?;
        let back = &imported.clips[0].clip;
        prop_assert_eq!(
            (back.name(), back.frames(), back.provenance()),
            ("clip", clip.frames(), provenance)
        );
        prop_assert!((back.fps() - clip.fps()).abs() < 1e-9 * clip.fps());
        let folded = clip.clone().folded().unwrap();
        let order = written_joints(back, &clip, &folded);
        let clip = folded;
        prop_assert_eq!(order.len(), clip.skeleton().len());
        for (found, &joint) in order.iter().enumerate() {
            let (a, b) = (&back.skeleton().joints()[found], &clip.skeleton().joints()[joint]);
            prop_assert_eq!(&a.name, &b.name);
            prop_assert_eq!(a.parent.map(|parent| order[parent]), b.parent);
            // The offset of a root with positions is zero in the file.
            prop_assert!(found == 0 || a.offset.distance(b.offset) < 1e-5);
            prop_assert_eq!(a.end_site.is_some(), b.end_site.is_some());
            prop_assert!(
                a.end_site.unwrap_or_default().distance(b.end_site.unwrap_or_default()) < 1e-5
            );
            for frame in 0..clip.frames() {
                let angle =
                    quat::angle_between(back.rotations(frame)[found], clip.rotations(frame)[joint]);
                prop_assert!(angle < 1e-5, "{}, frame {frame}: {angle} rad", b.name);
                if joint > 0 {
                    let (a, b) =
                        (translation(back, found, frame), translation(&clip, joint, frame));
                    prop_assert!(a.distance(b) < 1e-5, "joint {joint} at {a}, not {b}\n{text}");
                }
            }
        }
        for (a, b) in back.root_translations().iter().zip(clip.root_translations()) {
            prop_assert!(a.distance(*b) < 1e-5, "{a} {b}");
        }
        // A clip that was read is written the same way again.
        let again = write(back, &WriteOptions::default());
        let twice = import("clip.bvh", again.as_bytes(), &reading)
            .map_err(|error| TestCaseError::fail(error.to_string()))?;
        prop_assert_eq!(twice.clips[0].clip.frames(), back.frames());
    }

    #[test]
    fn written_glb_reads_back_equal(clip in clip()) {
        let bytes = write_glb(&clip, &GlbOptions::default()).unwrap();
        let reading = ImportOptions {
            metres_per_unit: Some(1.0),
            fps: Some(clip.fps()),
            drop_t_pose: false,
            ..ImportOptions::default()
        };
        let imported = gltf::read("clip.glb", &bytes, &|_| None, &reading)
            .map_err(|error| TestCaseError::fail(error.to_string()))?;
        let back = &imported.clips[0].clip;
        prop_assert_eq!(
            (back.name(), back.fps(), back.frames()),
            ("clip", clip.fps(), clip.frames().max(1))
        );
        let folded = clip.clone().folded().unwrap();
        let order = written_joints(back, &clip, &folded);
        let clip = folded;
        prop_assert_eq!(order.len(), clip.skeleton().len());
        for (found, &joint) in order.iter().enumerate() {
            let (a, b) = (&back.skeleton().joints()[found], &clip.skeleton().joints()[joint]);
            prop_assert_eq!((&a.name, a.parent.map(|parent| order[parent])), (&b.name, b.parent));
            prop_assert!(found == 0 || a.offset.distance(b.offset) < 1e-5);
            prop_assert_eq!(a.end_site.is_some(), b.end_site.is_some());
            prop_assert!(
                a.end_site.unwrap_or_default().distance(b.end_site.unwrap_or_default()) < 1e-5
            );
            for frame in 0..clip.frames() {
                prop_assert!(
                    quat::angle_between(back.rotations(frame)[found], clip.rotations(frame)[joint])
                        < 1e-5
                );
                if joint > 0 {
                    prop_assert!(
                        translation(back, found, frame).distance(translation(&clip, joint, frame))
                            < 1e-5
                    );
                }
            }
        }
        for (a, b) in back.root_translations().iter().zip(clip.root_translations()) {
            prop_assert!(a.distance(*b) < 1e-5, "{a} {b}");
        }
    }

    #[test]
    fn damaged_files_are_read_or_refused(
        clip in clip(),
        plain: bool,
        edits in prop::collection::vec(
            (any::<prop::sample::Index>(), 0..6_u8, any::<u8>(), any::<prop::sample::Index>()),
            0..8,
        ),
    ) {
        let mut bytes =
            if plain { chain(5) } else { write(&clip, &WriteOptions::default()) }.into_bytes();
        let pieces: [&[u8]; 14] = [
            b"{",
            b"}",
            b"\n",
            b" nan ",
            b"-",
            b"1e999",
            b",",
            b"\xff\xfe",
            b"\0",
            b"JOINT x {",
            b"MOTION",
            b"End Site",
            b"CHANNELS 99",
            b"1.#IND",
        ];
        for (at, kind, byte, other) in edits {
            if bytes.is_empty() {
                break;
            }
            let (at, other) = (at.index(bytes.len()), other.index(bytes.len()));
            match kind {
                0 => bytes[at] = byte,
                1 => bytes.truncate(at),
                2 => drop(bytes.drain(at.min(other)..at.max(other))),
                3 => drop(
                    bytes.splice(at..at, pieces[usize::from(byte) % pieces.len()].iter().copied()),
                ),
                4 => bytes.swap(at, other),
                _ => {
                    let copy = bytes[at.min(other)..at.max(other)].to_vec();
                    drop(bytes.splice(at..at, copy));
                }
            }
        }
        match import("spoilt.bvh", &bytes, &ImportOptions::default()) {
            Ok(imported) => {
                prop_assert!(!imported.clips.is_empty());
                for found in &imported.clips {
                    let mut rotations =
                        (0..found.clip.frames()).flat_map(|frame| found.clip.rotations(frame));
                    prop_assert!(rotations.all(|q| q.is_normalized()));
                    prop_assert!(found.clip.root_translations().iter().all(|p| p.is_finite()));
                    // A clip that was read can be written and read again.
                    let text = write(&found.clip, &WriteOptions::default());
                    let again = import(
                        "again.bvh",
                        text.as_bytes(),
                        &ImportOptions { drop_t_pose: false, ..ImportOptions::default() },
                    );
                    prop_assert_eq!(
                        again.map(|again| again.clips[0].clip.frames()),
                        Ok(found.clip.frames())
                    );
                }
                prop_assert!(
                    imported
                        .warnings
                        .iter()
                        .all(|warning| warning.count > 0 && !warning.to_string().contains('\n'))
                );
            }
            Err(error) => {
                prop_assert!(
                    error.line >= 1 && error.column >= 1 && !error.to_string().contains('\n'),
                    "{}",
                    error
                );
                prop_assert!(!error.found.is_empty() && !error.expected.is_empty());
            }
        }
    }

    #[test]
    fn plain_rows_equal_the_slow_path(
        clip in clip(),
        edits in prop::collection::vec((any::<prop::sample::Index>(), "[-+0-9.,e \tn#\n]"), 0..4),
    ) {
        let mut text = write(&clip, &WriteOptions::default());
        let rows = text.find("Frame Time").unwrap();
        for (at, piece) in edits {
            let at = rows + at.index(text.len() - rows);
            text.insert_str(at, &piece);
        }
        // Other white space, with which no line takes the fast path.
        let slow = text.replace('\n', "\x0b\n");
        let read = |text: &str| {
            import("clip.bvh", text.as_bytes(), &ImportOptions::default())
                .map_err(|error| (error.line, error.expected))
        };
        prop_assert_eq!(read(&text), read(&slow));
    }

    #[test]
    fn any_bytes_are_read_or_refused(
        bytes in prop::collection::vec(any::<u8>(), 0..200),
        tail in "[ -~\n\r\t{}0-9.,eE+-]{0,80}",
    ) {
        for text in [
            bytes.clone(),
            tail.clone().into_bytes(),
            format!("ROOT a {{ CHANNELS 2 Xrotation Yposition }} MOTION {tail}").into_bytes(),
        ] {
            if let Err(error) = import("any.bvh", &text, &ImportOptions::default()) {
                prop_assert!(error.to_string().starts_with("any.bvh:"));
            }
        }
    }
}

#[test]
fn long_runs_of_anything_are_read_in_linear_time() {
    // Each would take minutes or hours if it were read repeatedly.
    let head =
        "ROOT a { CHANNELS 2 Xrotation Yposition } MOTION Frames: 4000000000 Frame Time: 0.01\n";
    let big = 2_000_000;
    let mut texts = vec![
        format!("{head}1{}", "-1".repeat(big)),
        format!("{head}{}", "1-1\n".repeat(big / 4)),
        format!("{head}{}", "nan ".repeat(big / 4)),
        format!("{head}{}", "1".repeat(big)),
        format!("{head}{}", "#".repeat(big)),
        format!("{head}{}", "#\n".repeat(big / 2)),
        format!("{head}{}", "\r".repeat(big)),
        format!("{head}{}", "1,5 ".repeat(big / 4)),
        format!("{head}{}nan(", "1 2\n".repeat(big / 4)),
    ];
    texts.extend(
        ["{", "}", "ROOT a { } ", "ROOT a {", "End ", "\0", "\u{feff}"]
            .map(|piece| piece.repeat(big / 8)),
    );
    texts.push(format!("ROOT a {{ {} }}", "CHANNELS 1 Xrotation ".repeat(big / 20)));
    texts.push(format!("ROOT a {{ {} }}", "JOINT b { OFFSET 1 2 3 } ".repeat(big / 20)));
    texts.push(format!("ROOT a {{ {} }}", "End Site { OFFSET 1 2 3 } ".repeat(big / 20)));
    texts.push(format!("ROOT {} {{ }}", "a".repeat(big)));
    let start = std::time::Instant::now();
    for text in &texts {
        if let Ok(imported) = import("long.bvh", text.as_bytes(), &ImportOptions::default()) {
            assert!(!imported.clips.is_empty());
        }
    }
    assert!(start.elapsed().as_secs() < 60, "{:?} for {} texts", start.elapsed(), texts.len());
}
