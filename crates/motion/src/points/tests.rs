//! The solver against motions whose joints and rotations are known.

use super::{PointFit, PointSet, PointsError, joint_points, skeleton_from_points};
use crate::clip::{Clip, Provenance, UpAxis};
use crate::math::quat;
use crate::skeleton::{Role, Roles, Skeleton, WorldPose};
use crate::synth::{Action, Params, synthesize};
use glam::{Quat, Vec3};
use proptest::prelude::*;
use std::sync::Arc;

fn walk() -> Clip {
    synthesize(&Params::new(Action::Walk)).unwrap().clip
}

/// Returns the joint centres of a clip, frame by frame.
fn centres(clip: &Clip) -> Vec<Vec3> {
    clip.world_positions(0..clip.frames())
}

fn fit_of(clip: &Clip, positions: &[Vec3]) -> PointFit {
    let joints = clip.skeleton().joints();
    let names: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
    let parents: Vec<Option<usize>> = joints.iter().map(|joint| joint.parent).collect();
    let points = joint_points(&names, &parents);
    let set = PointSet { points: &points, positions, fps: clip.fps(), up: UpAxis::Y };
    skeleton_from_points(&set).unwrap()
}

fn clip_of(fit: &PointFit, fps: f64) -> Clip {
    let skeleton = Arc::new(Skeleton::new(fit.joints.clone()).unwrap());
    let provenance = Provenance::default();
    Clip::new("fit", skeleton, fps, fit.rotations.clone(), fit.root_translations.clone())
        .unwrap()
        .with_provenance(provenance)
}

/// Returns mean and greatest distance between the joints of two clips, metres.
fn distance(a: &[Vec3], b: &[Vec3]) -> (f32, f32) {
    assert_eq!(a.len(), b.len());
    let distances: Vec<f32> = a.iter().zip(b).map(|(a, b)| a.distance(*b)).collect();
    let mean = distances.iter().sum::<f32>() / distances.len() as f32;
    (mean, distances.into_iter().fold(0.0, f32::max))
}

/// Returns the world rotations of a joint with a role, frame by frame.
fn turns(clip: &Clip, role: Role) -> Vec<Quat> {
    let joint = Roles::by_name(clip.skeleton()).get(role).unwrap();
    let mut world = WorldPose::default();
    (0..clip.frames())
        .map(|frame| {
            clip.world_pose_into(frame, &mut world);
            world.rotations[joint]
        })
        .collect()
}

/// Returns the greatest angle between frames that follow each other, degrees.
fn greatest_step(turns: &[Quat]) -> f32 {
    let steps = turns.windows(2).map(|pair| quat::angle_between(pair[0], pair[1]).to_degrees());
    steps.fold(0.0, f32::max)
}

/// Noise with a seed, −1 to 1.
fn noise(seed: u32) -> f32 {
    let mixed = seed.wrapping_mul(0x9E37_79B1).rotate_left(15).wrapping_mul(0x85EB_CA77);
    (mixed ^ (mixed >> 13)) as f32 / u32::MAX as f32 * 2.0 - 1.0
}

#[test]
fn joint_centres_of_a_walk_give_the_walk() {
    for action in [Action::Walk, Action::Run] {
        let truth = synthesize(&Params::new(action)).unwrap().clip;
        let fit = fit_of(&truth, &centres(&truth));
        let found = clip_of(&fit, truth.fps());
        let (mean, greatest) = distance(&centres(&truth), &centres(&found));
        assert!(mean < 1e-5 && greatest < 1e-4, "{action:?}: {mean} {greatest}");
        assert!(fit.error.greatest < 1e-4, "{:?}", fit.error);
        // The last joint of a limb shows no rotation of its own.
        let last = [Role::Head, Role::LeftToe, Role::RightToe, Role::LeftHand, Role::RightHand];
        for role in Role::ALL.into_iter().filter(|role| !last.contains(role)) {
            let (true_turns, turns) = (turns(&truth, role), turns(&found, role));
            let off: Vec<f32> = true_turns
                .iter()
                .zip(&turns)
                .map(|(a, b)| quat::angle_between(*a, *b).to_degrees())
                .collect();
            let worst = off.iter().fold(0.0_f32, |a, b| a.max(*b));
            let (step, true_step) = (greatest_step(&turns), greatest_step(&true_turns));
            // Hips, spine and feet are at rest by other rules than those of the truth.
            let by_plane =
                !matches!(role, Role::Hips | Role::Spine | Role::LeftFoot | Role::RightFoot);
            assert!(worst < if by_plane { 4.0 } else { 12.0 }, "{}: {worst}", role.name());
            // No twist jumps: a frame turns no joint further than the motion does, and a little.
            assert!(step < true_step + 3.0, "{}: {step} for {true_step}", role.name());
        }
    }
}

#[test]
fn noisy_points_with_gaps_give_nearly_the_walk() {
    let truth = walk();
    let mut positions = centres(&truth);
    let joints = truth.skeleton().len();
    for (index, at) in positions.iter_mut().enumerate() {
        let seed = index as u32 * 3;
        *at += Vec3::new(noise(seed), noise(seed + 1), noise(seed + 2)) * 0.005;
        let (frame, joint) = (index / joints, index % joints);
        // A short gap for every joint, and a long one of both hands and a knee.
        let short = (10 + joint..13 + joint).contains(&frame);
        let long = [2, 17, 21].contains(&joint) && (5..35).contains(&frame);
        if short || long {
            *at = Vec3::NAN;
        }
    }
    let fit = fit_of(&truth, &positions);
    let found = clip_of(&fit, truth.fps());
    let (mean, greatest) = distance(&centres(&truth), &centres(&found));
    assert!(mean < 0.01 && greatest < 0.12, "{mean} {greatest}");
    assert!(
        fit.gaps.points == joints && fit.gaps.filled > 50 && fit.gaps.held >= 90,
        "{:?}",
        fit.gaps
    );
    for role in [Role::Hips, Role::LeftThigh, Role::RightThigh, Role::LeftUpperArm] {
        let (step, true_step) =
            (greatest_step(&turns(&found, role)), greatest_step(&turns(&truth, role)));
        assert!(step < true_step + 8.0, "{}: {step} for {true_step}", role.name());
    }
}

#[test]
fn points_with_z_up_give_the_same_motion() {
    let truth = walk();
    let z_up = |v: Vec3| Vec3::new(v.x, -v.z, v.y);
    let joints = truth.skeleton().joints();
    let names: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
    let parents: Vec<Option<usize>> = joints.iter().map(|joint| joint.parent).collect();
    let points = joint_points(&names, &parents);
    let positions: Vec<Vec3> = centres(&truth).into_iter().map(z_up).collect();
    let set = PointSet { points: &points, positions: &positions, fps: 30.0, up: UpAxis::Z };
    let fit = skeleton_from_points(&set).unwrap();
    let found = centres(&clip_of(&fit, 30.0));
    assert!(distance(&positions, &found).1 < 1e-3);
    // The rest pose stands along Z.
    let foot = fit.joints[2].offset;
    assert!(foot.z < -0.9 * foot.length(), "{foot}");
}

#[test]
fn names_without_meaning_give_the_positions_too() {
    let truth = walk();
    let parents: Vec<Option<usize>> =
        truth.skeleton().joints().iter().map(|joint| joint.parent).collect();
    let names: Vec<String> = (0..parents.len()).map(|index| format!("p{index}")).collect();
    let points = joint_points(&names, &parents);
    let positions = centres(&truth);
    let set = PointSet { points: &points, positions: &positions, fps: truth.fps(), up: UpAxis::Y };
    let fit = skeleton_from_points(&set).unwrap();
    let found = clip_of(&fit, truth.fps());
    assert!(distance(&positions, &centres(&found)).1 < 2e-3, "{:?}", fit.error);
    for joint in 0..found.skeleton().len() {
        let turns: Vec<Quat> =
            (0..found.frames()).map(|frame| found.rotations(frame)[joint]).collect();
        assert!(greatest_step(&turns) < 25.0, "{joint}: {}", greatest_step(&turns));
    }
}

#[test]
fn joint_that_is_never_seen_is_left_out() {
    let truth = walk();
    let joints = truth.skeleton().len();
    let mut positions = centres(&truth);
    positions.iter_mut().skip(10).step_by(joints).for_each(|at| *at = Vec3::NAN);
    let fit = fit_of(&truth, &positions);
    assert_eq!(fit.joints.len(), joints - 1);
    assert_eq!(fit.gaps.unseen, ["Spine1"]);
    let above = fit.joints.iter().find(|joint| joint.name == "Spine2").unwrap().parent.unwrap();
    assert_eq!(fit.joints[above].name, "Spine");
    assert!(fit.error.greatest < 0.02, "{:?}", fit.error);
}

#[test]
fn points_that_are_no_tree_are_refused() {
    let at = [Vec3::X; 4];
    let refused = |parents: &[Option<usize>], positions: &[Vec3]| {
        let names: Vec<String> = (0..parents.len()).map(|index| format!("{index}")).collect();
        let points = joint_points(&names, parents);
        skeleton_from_points(&PointSet { points: &points, positions, fps: 30.0, up: UpAxis::Y })
            .unwrap_err()
    };
    assert!(matches!(refused(&[], &[]), PointsError::Skeleton(_)));
    assert!(matches!(refused(&[None, None], &at), PointsError::Skeleton(_)));
    assert!(matches!(refused(&[Some(1), None], &at), PointsError::Skeleton(_)));
    assert!(matches!(refused(&[None, Some(1)], &at), PointsError::Skeleton(_)));
    assert!(matches!(refused(&[None, Some(0), Some(0)], &at), PointsError::Uneven { .. }));
    assert_eq!(refused(&[None, Some(0)], &[Vec3::NAN; 4]), PointsError::Unseen);
    assert_eq!(refused(&[None, Some(0)], &[]), PointsError::Unseen);
}

proptest! {
    /// Any points give finite positions and unit rotations.
    #[test]
    fn any_points_give_a_valid_motion(
        parents in proptest::collection::vec(any::<prop::sample::Index>(), 1..9),
        frames in 1_usize..6,
        values in proptest::collection::vec(
            prop_oneof![
                6 => (-2.0f32..2.0).boxed(),
                1 => Just(0.0f32).boxed(),
                1 => Just(f32::NAN).boxed(),
                1 => Just(1e30f32).boxed()
            ],
            200,
        ),
        limbs in any::<bool>(),
    ) {
        let names = ["Hips", "LeftUpLeg", "LeftLeg", "RightUpLeg", "Spine", "LeftArm",
            "LeftForeArm", "RightArm", "Head"];
        let count = parents.len();
        let parents: Vec<Option<usize>> = parents
            .iter()
            .enumerate()
            .map(|(index, parent)| (index > 0).then(|| parent.index(index.max(1))))
            .collect();
        let names: Vec<String> = (0..count)
            .map(|index| if limbs { names[index].to_owned() } else { index.to_string() })
            .collect();
        let points = joint_points(&names, &parents);
        let mut values = values.iter().cycle().copied();
        let positions: Vec<Vec3> = (0..frames * count)
            .map(|_| Vec3::from_array([(); 3].map(|()| values.next().unwrap_or_default())))
            .collect();
        let set = PointSet { points: &points, positions: &positions, fps: 30.0, up: UpAxis::Z };
        if let Ok(fit) = skeleton_from_points(&set) {
            prop_assert_eq!(fit.rotations.len(), frames * fit.joints.len());
            prop_assert!(fit.rotations.iter().all(|q| q.is_normalized()), "{:?}", fit.rotations);
            prop_assert!(fit.joints.iter().all(|joint| joint.offset.is_finite()));
            prop_assert!(fit.root_translations.iter().all(|at| at.is_finite()));
        }
    }
}
