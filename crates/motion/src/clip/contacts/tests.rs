//! Tests of contact detection and of the ground height.

use super::*;
use crate::clip::estimate_ground;
use crate::clip::fixtures::wander_by;
use crate::clip::ground::foot_level;
use crate::clip::{Interpolation, JointTranslations, resample};
use crate::skeleton::{Side, fixtures};
use proptest::prelude::*;
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

const FPS: f64 = 60.0;
/// The time between two touchdowns of a foot, and the duration of its stance, seconds.
const STEP_SECS: f32 = 1.0;
const STANCE_SECS: f32 = 0.6;

/// Returns the position of a foot at a time since its first touchdown: it stands, then swings 1.3 m
/// forward and 12 cm up.
fn step(since_secs: f32) -> Vec3 {
    let (steps, phase) = ((since_secs / STEP_SECS).floor(), since_secs.rem_euclid(STEP_SECS));
    let swing = ((phase - STANCE_SECS) / (STEP_SECS - STANCE_SECS)).max(0.0);
    Vec3::new(0.0, 0.12 * (PI * swing).sin(), 1.3 * (steps + swing - (TAU * swing).sin() / TAU))
}

/// Returns a clip of known steps: the feet are moved by translations, the left one touches down at
/// 0 s, the right one half a step later.
fn steps(frames: usize, scale: f32, way: impl Fn(Side, f32) -> Vec3) -> (Clip, Roles) {
    let skeleton = fixtures::uneven(&fixtures::lafan(), scale, 0.0, 0.0, 0);
    let roles = fixtures::roles(&skeleton);
    let still = wander_by(&skeleton, 1, 0, 0.0).rotations(0).to_vec();
    let clip = Clip::new(
        "steps",
        Arc::clone(&skeleton),
        FPS,
        still.repeat(frames),
        vec![Vec3::Y * 0.95 * scale; frames],
    )
    .unwrap();
    let mut tracks: Vec<JointTranslations> = Side::BOTH
        .into_iter()
        .map(|side| {
            let joint = roles.get(Role::foot(side)).unwrap();
            let at = |frame: usize| {
                skeleton.joints()[joint].offset + way(side, frame as f32 / FPS as f32) * scale
            };
            JointTranslations { joint, values: (0..frames).map(at).collect() }
        })
        .collect();
    tracks.sort_by_key(|track| track.joint);
    (clip.with_translations(tracks).unwrap(), roles)
}

fn walk(side: Side, time_secs: f32) -> Vec3 {
    step(time_secs + if side == Side::Left { 0.0 } else { 0.5 * STEP_SECS })
}

fn detect(clip: &Clip, roles: &Roles) -> Contacts {
    Contacts::detect(clip, roles, &ContactOptions::default())
}

/// Returns whether frames `at` and `wanted` agree to two frames of 1/60 s, the accuracy of a speed
/// threshold.
fn near(at: usize, wanted: f32) -> bool {
    (at as f32 - wanted).abs() <= 2.0
}

#[test]
fn contacts_of_a_made_walk_are_those_of_its_plan() {
    let (clip, roles) = steps(200, 1.0, walk);
    let contacts = detect(&clip, &roles);
    assert_eq!(contacts.frames(), 200);
    let left = contacts.intervals(Side::Left);
    assert_eq!(left.len(), 4, "{left:?}");
    for (i, stance) in left.iter().enumerate() {
        assert!(near(stance.start, 60.0 * i as f32), "{left:?}");
        assert!(near(stance.end, (60.0 * i as f32 + 37.0).min(200.0)), "{left:?}");
    }
    let right = contacts.intervals(Side::Right);
    assert_eq!(right.len(), 4, "{right:?}");
    // The clip begins in the last 0.1 s of the right foot's stance.
    assert!(right[0].start == 0 && near(right[0].end, 7.0), "{right:?}");
    assert!(near(right[1].start, 30.0) && near(right[1].end, 67.0), "{right:?}");
    for frame in 0..250 {
        assert_eq!(
            contacts.planted(Side::Left, frame),
            left.iter().any(|stance| stance.contains(&frame))
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// Neither the height of the captured floor nor the character's size changes the contacts.
    #[test]
    fn contacts_do_not_depend_on_floor_and_size(floor in -0.2f32..0.2, scale in 0.3f32..3.0) {
        let (clip, roles) = steps(150, 1.0, walk);
        let (other, other_roles) = steps(150, scale, |side, t| walk(side, t) + Vec3::Y * floor);
        prop_assert_eq!(detect(&clip, &roles), detect(&other, &other_roles));
        let risen = foot_level(&other, &other_roles) / scale - foot_level(&clip, &roles);
        prop_assert!((risen - floor).abs() < 1e-4);
    }

    /// At other frame rates contacts begin and end at the same time, to within two of the coarser
    /// frames.
    #[test]
    fn contacts_do_not_depend_on_the_frame_rate(fps in 24.0f64..240.0) {
        let (clip, roles) = steps(150, 1.0, walk);
        let other = resample(&clip, fps, Interpolation::Linear).unwrap();
        let coarse_secs = 2.5 / fps.min(FPS);
        let (a, b) = (detect(&clip, &roles), detect(&other, &roles));
        for side in Side::BOTH {
            prop_assert_eq!(a.intervals(side).len(), b.intervals(side).len());
            for (x, y) in a.intervals(side).iter().zip(b.intervals(side)) {
                prop_assert!((clip.time_of(x.start) - other.time_of(y.start)).abs() <= coarse_secs);
                prop_assert!((clip.time_of(x.end) - other.time_of(y.end)).abs() <= coarse_secs);
            }
        }
    }
}

/// A planted foot that trembles between the thresholds is one contact with hysteresis and many
/// without.
#[test]
fn contacts_of_a_trembling_foot_with_hysteresis_are_one() {
    // The left foot stands, rises slowly to 4 cm and trembles there by 5 mm at 2.5 Hz: speeds stay
    // below 0.2 m/s.
    let tremble = |side: Side, t: f32| match side {
        Side::Left => {
            Vec3::Y
                * (0.04 * ((t - 0.4) / 0.4).clamp(0.0, 1.0)
                    + 0.005 * (2.5 * TAU * t.max(0.4)).sin())
        }
        Side::Right => Vec3::ZERO,
    };
    let (clip, roles) = steps(100, 1.0, tremble);
    let options = ContactOptions { min_secs: 0.0, ..ContactOptions::default() };
    let steady = Contacts::detect(&clip, &roles, &options).intervals(Side::Left).len();
    let sharp = ContactOptions {
        leave_height_m: options.enter_height_m,
        leave_speed_mps: options.enter_speed_mps,
        ..options
    };
    let flickers = Contacts::detect(&clip, &roles, &sharp).intervals(Side::Left).len();
    assert_eq!(steady, 1);
    assert!(flickers >= 3, "{flickers}");
}

#[test]
fn drop_short_runs_between_long_ones_removes_them() {
    let flags = |text: &str| text.chars().map(|c| c == '#').collect::<Vec<bool>>();
    let cleaned = |text: &str, value: bool| {
        let mut flags = flags(text);
        drop_short_runs(&mut flags, value, 3);
        flags
    };
    assert_eq!(cleaned("##.####..###...##", false), flags("############...##"));
    assert_eq!(cleaned("#...#....##...###...##", true), flags("#.............###...##"));
    // Runs at an end of the clip may continue beyond it.
    assert_eq!(cleaned("#....", true), flags("#...."));
    assert_eq!(cleaned("", true), flags(""));
}

#[test]
fn contacts_of_a_standing_body_are_one() {
    let (clip, roles) = steps(30, 1.0, |_, _| Vec3::ZERO);
    let contacts = detect(&clip, &roles);
    for side in Side::BOTH {
        assert_eq!(contacts.intervals(side), std::slice::from_ref(&(0..30)));
    }
    // The lowest points of this rig are the tips of its toes.
    assert!((foot_level(&clip, &roles) - 0.015).abs() < 1e-5);
}

#[test]
fn contacts_without_feet_or_frames_are_empty() {
    let (clip, roles) = steps(3, 1.0, walk);
    let without = detect(&clip, &Roles::default());
    assert_eq!((without.frames(), without.intervals(Side::Left).len()), (3, 0));
    assert_eq!(foot_level(&clip, &Roles::default()), 0.0);
    let empty = clip.crop(0..0).unwrap();
    assert_eq!(detect(&empty, &roles), Contacts::default());
    assert_eq!(foot_level(&empty, &roles), 0.0);
    let one = clip.crop(0..1).unwrap();
    assert!(detect(&one, &roles).planted(Side::Left, 0));
    // Roles of another skeleton have indices beyond this one.
    let mut strange = Roles::default();
    strange.set(Role::LeftFoot, Some(9999));
    assert!(detect(&clip, &strange).intervals(Side::Left).is_empty());
}

/// In a sprint a planted foot moves at 1 m/s and the floor leans by 4 cm from one foot to the
/// other.
#[test]
fn contacts_of_a_sprint_on_a_leaning_floor_are_found() {
    let sprint = |side: Side, t: f32| {
        let lean = if side == Side::Left { 0.04 } else { 0.0 };
        let creep = Vec3::Z * 0.9 * t.rem_euclid(STEP_SECS / 4.0);
        step(4.0 * t + if side == Side::Left { 0.0 } else { 0.5 }) * Vec3::new(1.0, 1.5, 1.0)
            + creep
            + Vec3::Y * lean
    };
    let (still, roles) = steps(120, 1.0, sprint);
    let roots = (0..120).map(|frame| Vec3::new(0.0, 0.95, 5.2 * frame as f32 / FPS as f32));
    // The feet are moved relative to the body, so the body's own motion is subtracted from theirs.
    let poses = (0..120).zip(roots).map(|(frame, root)| {
        let mut pose = still.pose(frame);
        pose.translations.iter_mut().for_each(|(_, at)| at.z -= root.z);
        pose.root_translation = root;
        pose
    });
    let clip = Clip::from_poses("sprint", Arc::clone(still.skeleton()), FPS, poses).unwrap();
    for side in Side::BOTH {
        let sprinting = detect(&clip, &roles).intervals(side);
        assert!((7..=9).contains(&sprinting.len()), "{side:?}: {sprinting:?}");
        assert!(sprinting.iter().all(|stance| stance.len() <= 11), "{side:?}: {sprinting:?}");
    }
    // For a body that stays in place the limits are not scaled.
    assert_eq!(detect(&still, &roles).intervals(Side::Right).len(), 0);
}

#[test]
fn phase_runs_from_touchdown_to_touchdown() {
    let stances = |list: &[std::ops::Range<usize>]| {
        let mut flags = vec![false; 100];
        for stance in list {
            flags[stance.clone()].fill(true);
        }
        flags
    };
    let contacts =
        Contacts::from_flags([stances(&[0..5, 20..30, 40..50, 80..90]), stances(&[0..40, 60..70])]);
    let phase = |frame| contacts.phase(Side::Left, frame).unwrap();
    assert_eq!([phase(20), phase(25), phase(40), phase(60)], [0.0, 0.25, 0.0, 0.5]);
    // The nearest stride is repeated before the first and after the last touchdown.
    assert_eq!([phase(15), phase(0), phase(90)], [0.75, 0.0, 0.25]);
    assert_eq!(contacts.phase(Side::Right, 30), None);
    assert_eq!(Contacts::default().phase(Side::Left, 0), None);
}

/// The ground is y = 0 unless planted feet contradict that.
#[test]
fn ground_of_a_walk_is_zero_unless_feet_contradict() {
    for (floor, scale) in [
        (0.0, 1.0),
        (0.02, 1.0),
        (-0.02, 1.0),
        (0.025, 0.5),
        (-0.2, 1.0),
        (0.15, 1.0),
        (0.3, 2.0),
        (-1.0, 0.5),
    ] {
        let (clip, roles) = steps(200, scale, |side, t| walk(side, t) + Vec3::Y * (floor / scale));
        let ground = estimate_ground(&clip, &roles, &detect(&clip, &roles));
        let expected = if floor.abs() < 0.03 * scale { 0.0 } else { floor };
        // The tips of this rig's toes are 1.5 cm above its soles.
        assert!((ground - expected).abs() <= 0.02 * scale, "{floor} m, size {scale}: {ground} m");
        assert!(expected != 0.0 || ground == 0.0, "{floor} m, size {scale}: {ground} m");
    }
    let (clip, roles) = steps(20, 1.0, walk);
    let never = Contacts::from_flags([vec![false; 20], vec![false; 20]]);
    assert_eq!(estimate_ground(&clip, &roles, &never), 0.0);
    assert_eq!(estimate_ground(&clip, &Roles::default(), &detect(&clip, &roles)), 0.0);
}

#[test]
fn mirrored_contacts_are_swapped() {
    let contacts = Contacts::from_flags([vec![true, false, true], vec![false, false, true]]);
    let swapped = Contacts::from_flags([vec![false, false, true], vec![true, false, true]]);
    assert_eq!(contacts.mirrored(), swapped);
    assert_eq!(swapped.mirrored(), contacts);
}

#[test]
fn contacts_of_frames_follow_these_frames() {
    let contacts = Contacts::from_flags([vec![true, false, true], vec![false, false, true]]);
    let backwards = contacts.of_frames(&[2, 1, 0, 9]);
    let wanted = [vec![true, false, true, false], vec![true, false, false, false]];
    assert_eq!(backwards, Contacts::from_flags(wanted));
    assert_eq!(contacts.of_frames(&[]).frames(), 0);
}
