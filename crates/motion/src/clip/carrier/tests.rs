//! Tests of folding and unfolding the joints above the carrier.

use super::*;
use crate::clip::fixtures::wander;
use crate::clip::{Provenance, UpAxis};
use crate::skeleton::{Role, fixtures};
use proptest::prelude::*;

/// Returns a walk of a body with two joints above its hips, a root and one more below it, which
/// have the poses `above` in every frame.
fn with_joints_above(clip: &Clip, above: impl Fn(usize) -> (Vec3, Quat)) -> Clip {
    let joint = |name: &str, parent, offset| Joint {
        name: name.into(),
        parent,
        offset,
        end_site: None,
        channels: vec![],
    };
    // A marker beside the body, attached to the root.
    let mut joints = vec![
        joint("Reference", None, Vec3::ZERO),
        joint("Marker", Some(0), Vec3::new(1.0, 2.0, 0.5)),
    ];
    let mut body = clip.skeleton().joints().to_vec();
    for joint in &mut body {
        joint.parent = Some(joint.parent.map_or(0, |parent| parent + 2));
    }
    body[0].offset = Vec3::Y;
    joints.extend(body);
    let skeleton = Arc::new(Skeleton::new(joints).unwrap());
    let (mut rotations, mut roots, mut hips) = (Vec::new(), Vec::new(), Vec::new());
    for frame in 0..clip.frames() {
        let (at, turned) = above(frame);
        let own = clip.rotations(frame);
        rotations.extend([
            turned,
            Quat::from_rotation_x(0.1 * frame as f32),
            turned.conjugate() * own[0],
        ]);
        rotations.extend_from_slice(&own[1..]);
        roots.push(at);
        hips.push(turned.conjugate() * (clip.root_translations()[frame] - at));
    }
    let hips = JointTranslations { joint: 2, values: hips };
    let provenance = Provenance { metres_per_unit: 0.0254, up: UpAxis::Z };
    let clip = Clip::new("hung", skeleton, 30.0, rotations, roots).unwrap();
    clip.with_translations(vec![hips]).unwrap().with_provenance(provenance)
}

fn largest(a: &[Vec3], b: &[Vec3]) -> f32 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

/// Returns the world positions of the joints of a body, without the marker.
fn body_of(clip: &Clip, joints: &[&str]) -> Vec<Vec3> {
    let places: Vec<usize> =
        joints.iter().map(|name| clip.skeleton().find(name).unwrap()).collect();
    let all = clip.world_positions(0..clip.frames());
    all.chunks(clip.skeleton().len())
        .flat_map(|frame| places.iter().map(|&joint| frame[joint]).collect::<Vec<_>>())
        .collect()
}

fn names(clip: &Clip) -> Vec<&str> {
    clip.skeleton().joints().iter().map(|joint| joint.name.as_str()).collect()
}

fn check_unfolded(file: &Clip, body: &Clip) {
    let folded = file.clone().folded().unwrap();
    assert_eq!(folded.skeleton().parent(0), None);
    assert_eq!(folded.skeleton().joints()[0].name, body.skeleton().joints()[0].name);
    assert!(largest(&body_of(&folded, &names(body)), &body_of(body, &names(body))) < 1e-5);
    assert!(largest(&body_of(&folded, &["Marker"]), &body_of(file, &["Marker"])) < 1e-4);
    // Folding a folded clip changes nothing.
    assert_eq!(folded.clone().folded().as_ref(), Ok(&folded));
    let back = folded.unfolded().unwrap();
    assert_eq!(back.skeleton(), file.skeleton());
    assert_eq!(
        (back.fps(), back.name(), back.provenance()),
        (file.fps(), file.name(), file.provenance())
    );
    let below: Vec<&str> = names(file).into_iter().filter(|name| *name != "Reference").collect();
    assert!(largest(&body_of(&back, &below), &body_of(file, &below)) < 1e-4);
}

#[test]
fn folded_still_root_unfolds_still() {
    let body = wander(&fixtures::lafan(), 40, 5);
    for turned in [
        Quat::IDENTITY,
        Quat::from_rotation_y(2.9),
        Quat::from_euler(glam::EulerRot::XYZ, -1.5, 0.3, 2.0),
    ] {
        let file = with_joints_above(&body, |_| (Vec3::new(3.0, 0.2, -4.0), turned));
        check_unfolded(&file, &body);
        let back = file.clone().folded().unwrap().unfolded().unwrap();
        for (there, here) in file.root_translations().iter().zip(back.root_translations()) {
            assert!(there.distance(*here) < 1e-5);
        }
    }
}

#[test]
fn folded_ground_root_unfolds_on_the_ground() {
    let body = wander(&fixtures::lafan(), 120, 3);
    let frames = character_frames(&body, &Roles::detect(body.skeleton()));
    let below: Vec<Planar> = smoothed(&frames, body.fps());
    let file = with_joints_above(&body, |frame| {
        (below[frame].origin() + Vec3::Y * 0.01, below[frame].rotation())
    });
    check_unfolded(&file, &body);
    let folded = file.clone().folded().unwrap();
    let back = folded.unfolded().unwrap();
    assert!(largest(file.root_translations(), back.root_translations()) < 1e-3);
    // Elsewhere in the world the root follows, and stays level.
    let elsewhere = Planar::new(1.0, 20.0, -3.0);
    let moved = folded.transformed(&elsewhere).unfolded().unwrap();
    for (there, here) in file.root_translations().iter().zip(moved.root_translations()) {
        assert!(elsewhere.apply(*there).distance(*here) < 1e-3, "{there} {here}");
    }
}

#[test]
fn folded_rigid_root_unfolds_with_the_carrier() {
    let body = wander(&fixtures::lafan(), 30, 8);
    let file = with_joints_above(&body, |frame| {
        let (at, turned) = (body.root_translations()[frame], body.rotations(frame)[0]);
        (at + turned * Vec3::new(0.0, 0.1, 0.02), turned * Quat::from_rotation_z(0.4))
    });
    check_unfolded(&file, &body);
    let back = file.clone().folded().unwrap().unfolded().unwrap();
    assert!(largest(file.root_translations(), back.root_translations()) < 1e-4);
}

#[test]
fn folded_clip_without_frames_keeps_its_rest_pose() {
    let body = wander(&fixtures::lafan(), 1, 8);
    let file = with_joints_above(&body, |_| (Vec3::ZERO, Quat::IDENTITY)).crop(0..0).unwrap();
    let folded = file.clone().folded().unwrap();
    assert_eq!((folded.frames(), folded.skeleton().len()), (0, file.skeleton().len() - 1));
    assert_eq!(folded.unfolded().unwrap().skeleton(), file.skeleton());
    // The rest pose keeps its position.
    let hips = file.skeleton().find(&body.skeleton().joints()[0].name).unwrap();
    assert_eq!(folded.skeleton().joints()[0].offset, file.skeleton().rest_positions()[hips]);
}

#[test]
fn skeletons_with_other_folded_chains_are_equal() {
    let body = wander(&fixtures::lafan(), 5, 8);
    let still = with_joints_above(&body, |_| (Vec3::ZERO, Quat::IDENTITY)).folded().unwrap();
    let turned =
        with_joints_above(&body, |_| (Vec3::X, Quat::from_rotation_y(3.0))).folded().unwrap();
    assert_eq!(still.skeleton(), turned.skeleton());
    assert_ne!(still.skeleton().folded_chain(), turned.skeleton().folded_chain());
    let roles = Roles::detect(still.skeleton());
    assert_eq!(roles.get(Role::Hips), Some(0));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// The body stays in place, however the joints above it move.
    #[test]
    fn folded_clip_keeps_world_positions(
        seed in 0u64..1000,
        speed in 0.0f32..4.0,
        lean in -1.0f32..1.0,
    ) {
        let body = wander(&fixtures::cmu_bvh(), 12, seed);
        let file = with_joints_above(&body, |frame| {
            let t = frame as f32 * 0.1;
            (
                Vec3::new(speed * t, lean * t, 0.3),
                Quat::from_rotation_y(speed * t) * Quat::from_rotation_x(lean * t),
            )
        });
        check_unfolded(&file, &body);
    }
}
