//! Encodings of one motion in many files: the same joints at the same world positions, written as
//! rigs of different kinds.

#![allow(unreachable_pub, reason = "a module of a test binary")]

use glam::{Quat, Vec3};
use segue_formats::bvh::{RotationOrder, WriteOptions, write};
use segue_motion::clip::{Clip, JointTranslations};
use segue_motion::math::Planar;
use segue_motion::skeleton::{Channel, Joint, Role, Roles, Side, Skeleton, WorldPose};
use std::f32::consts::FRAC_PI_2;
use std::sync::Arc;

/// The position and rotation of a rig's joint above the body, for each frame.
type Above = Vec<(Vec3, Quat)>;

/// Returns the motion as files of ten kinds, by name. The first joint of `clip` carries the body.
pub fn encodings(clip: &Clip) -> Vec<(&'static str, String)> {
    let frames = clip.frames();
    let plain = |options: &WriteOptions| write(&bare(clip), options);
    let usual = WriteOptions::default();
    let ordered = |order| WriteOptions { rotation_order: Some(order), ..usual };
    let inches = WriteOptions { metres_per_unit: Some(0.0254), ..usual };
    let lying = Quat::from_rotation_x(-FRAC_PI_2);
    vec![
        ("plain", plain(&usual)),
        ("order_xyz", plain(&ordered(RotationOrder::Xyz))),
        ("order_yxz", plain(&ordered(RotationOrder::Yxz))),
        ("inches", plain(&inches)),
        ("static_root", write(&hung(clip, &vec![(Vec3::ZERO, Quat::IDENTITY); frames]), &usual)),
        ("static_root_turned", write(&hung(clip, &vec![(Vec3::ZERO, lying); frames]), &usual)),
        ("root_motion", write(&hung(clip, &on_the_ground(clip)), &usual)),
        ("turned_frames", write(&with_turned_frames(clip), &usual)),
        ("all_positions", write(&with_all_positions(clip), &usual)),
        ("z_up", write(&z_up(clip), &usual)),
    ]
}

fn rebuilt(
    clip: &Clip,
    joints: Vec<Joint>,
    rotations: Vec<Quat>,
    roots: Vec<Vec3>,
    tracks: Vec<JointTranslations>,
) -> Clip {
    let skeleton = Arc::new(Skeleton::new(joints).expect("a tree"));
    let made = Clip::new(clip.name(), skeleton, clip.fps(), rotations, roots).expect("a clip");
    made.with_translations(tracks).expect("translations that fit")
}

/// Returns the joints without the channels of their source file.
fn bare_joints(clip: &Clip) -> Vec<Joint> {
    let joints = clip.skeleton().joints().iter();
    joints.map(|joint| Joint { channels: vec![], ..joint.clone() }).collect()
}

fn all_rotations(clip: &Clip) -> Vec<Quat> {
    (0..clip.frames()).flat_map(|frame| clip.rotations(frame).to_vec()).collect()
}

fn bare(clip: &Clip) -> Clip {
    let (roots, tracks) = (clip.root_translations().to_vec(), clip.translations().to_vec());
    rebuilt(clip, bare_joints(clip), all_rotations(clip), roots, tracks)
}

/// Returns the body below a root of its own.
fn hung(clip: &Clip, above: &Above) -> Clip {
    let mut joints = vec![Joint {
        name: "Reference".into(),
        parent: None,
        offset: Vec3::ZERO,
        end_site: None,
        channels: vec![],
    }];
    for mut joint in bare_joints(clip) {
        if joint.parent.is_none() {
            joint.offset = Vec3::ZERO;
        }
        joint.parent = Some(joint.parent.map_or(0, |parent| parent + 1));
        joints.push(joint);
    }
    let (mut rotations, mut carried) = (Vec::new(), Vec::new());
    for (frame, (at, turned)) in above.iter().enumerate() {
        let own = clip.rotations(frame);
        let back = turned.conjugate();
        rotations.push(*turned);
        rotations.push(back * own[0]);
        rotations.extend_from_slice(&own[1..]);
        carried.push(back * (clip.root_translations()[frame] - *at));
    }
    let others = clip
        .translations()
        .iter()
        .map(|track| JointTranslations { joint: track.joint + 1, values: track.values.clone() });
    let tracks = std::iter::once(JointTranslations { joint: 1, values: carried }).chain(others);
    let roots = above.iter().map(|(at, _)| *at).collect();
    rebuilt(clip, joints, rotations, roots, tracks.collect())
}

/// Returns the position below the body on the ground, with the mean heading of the hips over 15
/// frames: the root of game engines.
fn on_the_ground(clip: &Clip) -> Above {
    let roles = Roles::detect(clip.skeleton());
    let [left, right] = Side::BOTH.map(|side| roles.get(Role::thigh(side)).expect("a leg"));
    let mut world = WorldPose::default();
    let mut yaws: Vec<f64> = Vec::new();
    for frame in 0..clip.frames() {
        clip.world_pose_into(frame, &mut world);
        let across = world.positions[left] - world.positions[right];
        let yaw = f64::from(-across.z).atan2(f64::from(across.x));
        let before = yaws.last().copied().unwrap_or(yaw);
        let turn = yaw - before;
        yaws.push(before + turn.sin().atan2(turn.cos()));
    }
    let smooth = |frame: usize| {
        let at = |offset: isize| {
            yaws[(frame as isize + offset).clamp(0, yaws.len() as isize - 1) as usize]
        };
        (-7..=7).map(at).sum::<f64>() / 15.0
    };
    let place = |frame: usize| {
        (
            clip.root_translations()[frame] * Vec3::new(1.0, 0.0, 1.0),
            Quat::from_rotation_y(smooth(frame) as f32),
        )
    };
    (0..clip.frames()).map(place).collect()
}

/// Returns the clip with each joint's axes rotated by a constant, as in files whose bones point
/// along X: the rest pose is meaningless.
fn with_turned_frames(clip: &Clip) -> Clip {
    let mut state = 7_u64;
    let mut random = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1 << 24) as f32 * 6.0 - 3.0
    };
    let mut joints = bare_joints(clip);
    let turns: Vec<Quat> = joints
        .iter()
        .map(|_| Quat::from_scaled_axis(Vec3::new(random(), random(), random())))
        .collect();
    for (index, joint) in joints.iter_mut().enumerate() {
        if let Some(parent) = joint.parent {
            joint.offset = turns[parent].conjugate() * joint.offset;
        }
        joint.end_site = joint.end_site.map(|end| turns[index].conjugate() * end);
    }
    let mut rotations = Vec::new();
    for frame in 0..clip.frames() {
        for (index, (&own, joint)) in clip.rotations(frame).iter().zip(&joints).enumerate() {
            let parent = joint.parent.map_or(Quat::IDENTITY, |parent| turns[parent]);
            rotations.push(parent.conjugate() * own * turns[index]);
        }
    }
    let tracks = clip.translations().iter().map(|track| {
        let parent = joints[track.joint].parent.expect("not the root");
        JointTranslations {
            joint: track.joint,
            values: track.values.iter().map(|value| turns[parent].conjugate() * *value).collect(),
        }
    });
    let tracks = tracks.collect();
    rebuilt(clip, joints, rotations, clip.root_translations().to_vec(), tracks)
}

/// Returns the clip with position channels on every joint, as some exporters write them.
fn with_all_positions(clip: &Clip) -> Clip {
    use Channel::{XPosition, XRotation, YPosition, YRotation, ZPosition, ZRotation};
    let mut joints = bare_joints(clip);
    for joint in &mut joints {
        joint.channels = vec![XPosition, YPosition, ZPosition, ZRotation, XRotation, YRotation];
    }
    let (roots, tracks) = (clip.root_translations().to_vec(), clip.translations().to_vec());
    rebuilt(clip, joints, all_rotations(clip), roots, tracks)
}

/// Returns the world rotated so that +Z is up, with the same rest pose: only the root's values show
/// it.
fn z_up(clip: &Clip) -> Clip {
    let turn = Quat::from_rotation_x(FRAC_PI_2);
    let mut rotations = all_rotations(clip);
    for root in rotations.iter_mut().step_by(clip.skeleton().len()) {
        *root = turn * *root;
    }
    let roots = clip.root_translations().iter().map(|at| turn * *at).collect();
    rebuilt(clip, bare_joints(clip), rotations, roots, clip.translations().to_vec())
}

/// Returns the motion at another place in the world, with another facing.
pub fn placed(clip: &Clip) -> Clip {
    clip.transformed(&Planar::new(170_f64.to_radians(), 5.0, -3.0))
}
