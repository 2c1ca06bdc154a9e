//! Tests of edits: closed forms, properties, and that contacts, ground frames and seams follow.

use super::*;
use crate::clip::fixtures::{largest_distance, wander};
use crate::clip::{Contacts, JointTranslations, character_frames};
use crate::skeleton::{Role, Roles, Side, fixtures};
use crate::synth::{Action, Params, synthesize};
use glam::{Quat, Vec3};
use proptest::prelude::*;

fn made(params: &Params) -> Motion {
    Motion::analyze(synthesize(params).unwrap().clip)
}

/// Returns a walk to the left with a seam in it.
fn walk(fps: f32) -> Motion {
    made(&Params { turn_rate_dps: 20.0, fps, ..Params::new(Action::Walk) })
        .with_seams(vec![30..42, 60..60])
}

fn planted(motion: &Motion) -> Vec<[bool; 2]> {
    let contacts = motion.contacts();
    let flags = |frame| Side::BOTH.map(|side| contacts.planted(side, frame));
    (0..motion.clip().frames()).map(flags).collect()
}

/// Returns the largest distance between the ground frames of a motion and those that are measured
/// on its clip, metres and radians.
fn frame_error(motion: &Motion) -> f64 {
    let measured = character_frames(motion.clip(), motion.roles());
    let errors = motion.ground_frames().iter().zip(&measured).map(|(carried, measured)| {
        let apart = carried.inverse().after(measured);
        apart.shift.length().max(apart.yaw.abs())
    });
    assert_eq!(measured.len(), motion.ground_frames().len());
    errors.fold(0.0, f64::max)
}

#[test]
fn crop_keeps_contacts_frames_and_seams_of_its_part() {
    let source = walk(60.0);
    let part = source.cropped(35..70).unwrap();
    assert_eq!(part.clip(), &source.clip().crop(35..70).unwrap().into());
    assert_eq!(planted(&part), planted(&source)[35..70]);
    assert_eq!(part.ground_frames(), &source.ground_frames()[35..70]);
    assert_eq!(part.seams(), [0..7, 25..25]);
    assert_eq!(part.ground_m(), source.ground_m());
    assert_eq!(source.cropped(43..59).unwrap().seams(), []);
    let whole = source.clip().frames();
    assert_eq!(source.cropped(0..whole).unwrap(), source);
    assert!(matches!(source.cropped(0..whole + 1), Err(ClipError::OutOfRange { .. })));
    // Only the whole of a cycle is a cycle.
    let cycle = source.clone().declared_cycle(true);
    assert!(cycle.cropped(0..whole).unwrap().is_cycle());
    assert!(!cycle.cropped(1..whole).unwrap().is_cycle());
}

#[test]
fn reversed_motion_plays_backwards() {
    let source = walk(60.0);
    let back = source.reversed();
    let last = source.clip().frames() - 1;
    for frame in [0, 7, last] {
        assert_eq!(back.clip().pose(frame), source.clip().pose(last - frame));
        assert_eq!(back.ground_frames()[frame], source.ground_frames()[last - frame]);
    }
    assert!(planted(&back).into_iter().rev().eq(planted(&source)));
    assert_eq!(back.seams(), [last - 60..last - 60, last - 42..last - 30]);
    assert!(frame_error(&back) < 1e-9);
    assert_eq!(back.reversed(), source);
    // Translations of joints, too.
    let clip = wander(&fixtures::bandai(), 3, 1);
    let values = vec![Vec3::X, Vec3::Y, Vec3::Z];
    let clip = clip.with_translations(vec![JointTranslations { joint: 2, values }]).unwrap();
    assert_eq!(clip.reversed().translations()[0].values, [Vec3::Z, Vec3::Y, Vec3::X]);
}

#[test]
fn mirrored_motion_swaps_sides() {
    let source = walk(60.0);
    let image = source.mirrored().unwrap();
    assert!(planted(&image).into_iter().eq(planted(&source).into_iter().map(|[l, r]| [r, l])));
    assert!(frame_error(&image) < 1e-4, "{}", frame_error(&image));
    let turn = |motion: &Motion| {
        let frames = motion.ground_frames();
        frames.windows(2).map(|pair| pair[0].inverse().after(&pair[1]).yaw).sum::<f64>()
    };
    assert!((turn(&image) + turn(&source)).abs() < 1e-9 && turn(&source) > 0.5);
    assert_eq!(image.seams(), source.seams());
    let twice = image.mirrored().unwrap();
    assert!(largest_distance(source.clip(), twice.clip()) < 1e-4);
    assert_eq!(twice.contacts(), source.contacts());
    assert_eq!(twice.ground_frames(), source.ground_frames());
    let nameless = fixtures::nameless(&fixtures::lafan());
    let nobody = Motion::with_roles(wander(&nameless, 2, 0), &Roles::default());
    assert!(matches!(nobody.mirrored(), Err(MirrorError::NoCounterparts(_))));
}

#[test]
fn resampled_motion_keeps_its_contacts_in_time() {
    for (from, to) in [(30.0, 120.0), (120.0, 30.0), (60.0, 25.0), (30.0, 48.0)] {
        let source = walk(from);
        let other = source.resampled(to, Interpolation::Cubic).unwrap();
        assert_eq!(other.clip().fps(), to);
        let steps = [&source, &other].map(|motion| motion.clip().frames() as f64 - 1.0);
        for frame in 0..other.clip().frames() {
            let nearest = (frame as f64 * steps[0] / steps[1]).round() as usize;
            assert_eq!(planted(&other)[frame], planted(&source)[nearest], "{from} {to} {frame}");
        }
        assert!(frame_error(&other) < 2e-3, "{from} {to}: {}", frame_error(&other));
        let times = steps[1] / steps[0];
        assert_eq!(other.seams()[0].start, (30.0 * times).round() as usize);
    }
    assert_eq!(walk(60.0).resampled(60.0, Interpolation::Cubic).unwrap(), walk(60.0));
    assert!(walk(60.0).resampled(f64::NAN, Interpolation::Cubic).is_err());
}

#[test]
fn resampled_to_a_multiple_and_back_has_the_same_contacts() {
    let source = walk(30.0);
    let finer = source.resampled(120.0, Interpolation::Cubic).unwrap();
    let back = finer.resampled(30.0, Interpolation::Cubic).unwrap();
    assert_eq!(back.contacts(), source.contacts());
    assert_eq!(back.seams(), source.seams());
    assert!(largest_distance(source.clip(), back.clip()) < 1e-5);
}

#[test]
fn scaled_motion_has_other_lengths_and_the_same_rotations() {
    let source = walk(60.0);
    let half = source.scaled(0.5);
    for frame in [0, 40] {
        assert_eq!(half.clip().rotations(frame), source.clip().rotations(frame));
        let [small, large] =
            [&half, &source].map(|motion| motion.clip().world_pose(frame).positions);
        let far = small.iter().zip(&large).map(|(s, l)| s.distance(*l * 0.5)).fold(0.0, f32::max);
        assert!(far < 1e-6, "{far} m");
    }
    assert!((half.body_height() - 0.5 * source.body_height()).abs() < 1e-6);
    assert!((half.ground_m() - 0.5 * source.ground_m()).abs() < 1e-6);
    assert_eq!(half.contacts(), source.contacts());
    assert!(frame_error(&half) < 1e-5);
    let back = half.scaled(2.0);
    assert_eq!(back, source, "a power of two loses nothing");
}

#[test]
fn scaled_clip_keeps_the_joints_above_its_root() {
    let clip = wander(&fixtures::bandai(), 5, 3);
    let folded = clip.clone().folded().unwrap();
    assert!(folded.skeleton().folded_chain().is_some(), "the root of this rig is not its hips");
    let [plain, written] = [&folded, &folded.scaled(2.0)].map(|clip| clip.unfolded().unwrap());
    assert_eq!(written.skeleton().len(), clip.skeleton().len());
    let (p, q) = (plain.world_positions(0..5), written.world_positions(0..5));
    let far = p.iter().zip(&q).map(|(p, q)| (*p * 2.0).distance(*q)).fold(0.0, f32::max);
    assert!(far < 1e-3, "{far} m");
}

#[test]
fn one_frame_and_no_frame_are_edited() {
    for frames in [0, 1] {
        let source = walk(60.0).cropped(0..frames).unwrap();
        let edits = [
            source.reversed(),
            source.mirrored().unwrap(),
            source.resampled(30.0, Interpolation::Cubic).unwrap(),
            source.scaled(3.0),
            source.moved(&Planar::new(1.0, 2.0, 3.0)),
        ];
        for edited in edits {
            assert_eq!((edited.clip().frames(), edited.contacts().frames()), (frames, frames));
            assert_eq!(edited.ground_frames().len(), frames);
        }
    }
}

/// An animal on four legs, with names that give its hind legs the roles of a person's.
#[test]
fn edits_of_a_quadruped_keep_its_joints() {
    let skeleton = fixtures::lafan();
    let mut roles = Roles::detect(&skeleton);
    roles.set(Role::LeftUpperArm, None);
    roles.set(Role::RightUpperArm, None);
    let source = Motion::with_roles(wander(&skeleton, 12, 4), &roles);
    let image = source.mirrored().unwrap().mirrored().unwrap();
    assert!(largest_distance(source.clip(), image.clip()) < 1e-4);
    assert_eq!(source.reversed().clip().skeleton(), source.clip().skeleton());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn reversed_twice_is_the_motion(frames in 0usize..12, seed in 0u64..100) {
        let source = Motion::analyze(wander(&fixtures::lafan(), frames, seed));
        prop_assert_eq!(source.reversed().reversed(), source);
    }

    #[test]
    fn resampled_keeps_both_ends(frames in 1usize..30, fps in 5.0f64..240.0, seed in 0u64..100) {
        let source = Motion::analyze(wander(&fixtures::lafan(), frames, seed));
        let other = source.resampled(fps, Interpolation::Cubic).unwrap();
        let ends = |motion: &Motion| {
            let last = motion.clip().frames() - 1;
            [0, last].map(|frame| (motion.clip().pose(frame), motion.ground_frames()[frame]))
        };
        prop_assert_eq!(ends(&other), ends(&source));
    }

    /// Turns and moves are those of the ground frames.
    #[test]
    fn moved_motion_has_moved_ground_frames(yaw in -3.0f64..3.0, x in -9.0f64..9.0, z in -9.0f64..9.0) {
        let source = walk(30.0);
        let there = Planar::new(yaw, x, z);
        let moved = source.moved(&there);
        for (moved, frame) in moved.ground_frames().iter().zip(source.ground_frames()) {
            prop_assert_eq!(*moved, there.after(frame));
        }
        prop_assert!(frame_error(&moved) < 1e-3);
        prop_assert_eq!(moved.contacts(), source.contacts());
        let turned = moved.clip().rotations(3)[0];
        let wanted = Quat::from_rotation_y(yaw as f32) * source.clip().rotations(3)[0];
        prop_assert!(crate::math::quat::angle_between(turned, wanted) < 1e-5);
    }

    #[test]
    fn scaled_and_back_is_the_motion(factor in 0.1f32..10.0, seed in 0u64..100) {
        let source = Motion::analyze(wander(&fixtures::lafan(), 5, seed));
        let back = source.scaled(factor).scaled(factor.recip());
        prop_assert!(largest_distance(source.clip(), back.clip()) < 1e-5);
    }
}

/// Contacts that were set by hand are not detected again.
#[test]
fn contacts_set_by_hand_follow_every_edit() {
    let source = walk(60.0);
    let frames = source.clip().frames();
    let by_hand = Contacts::from_flags([
        (0..frames).map(|frame| frame % 3 == 0).collect(),
        (0..frames).map(|frame| frame % 5 == 0).collect(),
    ]);
    let source = source.with_contacts(by_hand.clone());
    assert_eq!(source.scaled(2.0).contacts(), &by_hand);
    assert_eq!(source.mirrored().unwrap().contacts(), &by_hand.mirrored());
    assert!(planted(&source.reversed()).into_iter().rev().eq(planted(&source)));
    assert_eq!(planted(&source.cropped(9..20).unwrap()), planted(&source)[9..20]);
}
