//! Tests of closing cycles.

use super::*;
use crate::clip::JointTranslations;
use crate::registration::fixtures::Walk;
use crate::skeleton::Roles;
use glam::DVec2;
use proptest::prelude::*;

const METHODS: [LoopMethod; 4] = [
    LoopMethod::Exact { half_life_secs: 0.2 },
    LoopMethod::Cubic,
    LoopMethod::Linear,
    LoopMethod::Classic { half_life_secs: 0.2 },
];

fn source_of(clip: Clip) -> Motion {
    Motion::analyze(clip)
}

/// Returns a walk; a stride is 66.7 frames.
fn walk(frames: usize, turning: f32) -> Motion {
    source_of(Walk { frames, turning, heading: 1.0, start: (3.0, -4.0), ..Walk::default() }.clip())
}

fn closed(source: &Motion, cycle: Range<usize>, method: LoopMethod, ratio: f64) -> Loop {
    close_loop(source, cycle, &LoopOptions { method, ratio }).unwrap()
}

/// Returns the visible seam: joint angles between the last frame of a cycle and the first of the
/// next, minus those of the clip's own step.
fn seam_of_frames(source: &Motion, cycle: Range<usize>, made: &Loop) -> f32 {
    let twice = made.repeat(2).unwrap();
    let n = made.clip.frames();
    let own = source.clip();
    let turn = |clip: &Clip, f: usize, joint: usize| {
        quat::log(clip.rotations(f)[joint] * clip.rotations(f - 1)[joint].conjugate())
    };
    (1..own.skeleton().len())
        .map(|joint| (turn(&twice, n, joint) - turn(own, cycle.end, joint)).length())
        .fold(0.0, f32::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn close_loop_closes_pose_and_velocity(
        start in 0usize..30,
        length in 20usize..100,
        turning in -1.0f32..1.0,
        ratio in 0.0f64..1.0,
    ) {
        let source = walk(160, turning);
        for method in &METHODS[..2] {
            let made = closed(&source, start..start + length, *method, ratio);
            prop_assert_eq!((made.clip.frames(), made.frames.len()), (length, length));
            prop_assert!(
                made.seam.turn_deg < 1e-3 && made.seam.turn_dps < 0.1 && made.seam.shift_cm < 1e-3,
                "{method:?} {:?}",
                made.seam
            );
        }
        let linear = closed(&source, start..start + length, LoopMethod::Linear, ratio);
        prop_assert!(linear.seam.turn_deg < 1e-3, "{:?}", linear.seam);
    }

    #[test]
    fn repeated_loop_does_not_drift(
        start in 0usize..30,
        length in 40usize..100,
        turning in -1.0f32..1.0,
    ) {
        let source = walk(160, turning);
        let roles = Roles::detect(source.clip().skeleton());
        let made = closed(&source, start..start + length, METHODS[0], 0.5);
        let played = made.repeat(100).unwrap();
        let frames = crate::clip::character_frames(&played, &roles);
        let first = frames[length].after(&frames[0].inverse());
        let axes = |root: Vec3| [root.x, root.y, root.z].map(f64::from);
        let root = played.root_translations()[0];
        let mut place = Planar::IDENTITY;
        for k in 1..100 {
            place = made.cycle.after(&place);
            let frame = k * length;
            prop_assert_eq!(&played.rotations(frame)[1..], &played.rotations(0)[1..]);
            // In double precision the k-th cycle is transformed by `cycle^k`. The stored value is
            // that, rounded once: to half the distance between neighbouring numbers of single
            // precision, 8 µm at 160 m. Errors do not accumulate.
            let at = place.apply_ground(DVec2::new(root.x.into(), root.z.into()));
            for (stored, exact) in axes(played.root_translations()[frame]).into_iter().zip([
                at.x,
                f64::from(root.y),
                at.y,
            ]) {
                let rounding = 0.5 * f64::from(f32::EPSILON) * exact.abs();
                prop_assert!((stored - exact).abs() <= rounding, "{k}: {stored} {exact}");
            }
            let turned = place.rotation() * played.rotations(0)[0];
            prop_assert!(quat::angle_between(played.rotations(frame)[0], turned) < 1e-6, "{k}");
        }
        prop_assert!(
            first.shift.distance(made.cycle.shift) < 1e-3
                && (first.yaw - made.cycle.yaw).abs() < 1e-4
        );
    }
}

/// Rotations about all axes do not commute: one solution is not enough.
#[test]
fn close_loop_with_large_differences_closes() {
    let skeleton = crate::skeleton::fixtures::cmu_bvh();
    let mut largest = 0.0_f64;
    for seed in 0..4 {
        let source = source_of(crate::clip::fixtures::wander_by(&skeleton, 90, seed, 2.5));
        for (cycle, ratio) in [(3..45, 0.5), (0..30, 1.0), (20..89, 0.2)] {
            for method in &METHODS[..2] {
                let made = closed(&source, cycle.clone(), *method, ratio);
                largest = largest.max(made.before.turn_deg);
                assert!(
                    made.seam.turn_deg < 2e-3 && made.seam.turn_dps < 0.1,
                    "{method:?} {:?} {:?}",
                    made.before,
                    made.seam
                );
            }
        }
    }
    assert!(largest > 60.0, "{largest}");
}

#[test]
fn close_loop_leaves_no_visible_seam() {
    let source = walk(160, 0.3);
    // 60 frames of 66.7: most of a tenth of a stride is missing.
    for cycle in [5..65, 0..60, 99..159] {
        let frames = source.clip().frames();
        let own = cycle.end.min(frames - 1);
        assert_eq!(own, cycle.end);
        let raw =
            source.clip().rotations(cycle.start).iter().zip(source.clip().rotations(cycle.end));
        let gap = raw.skip(1).map(|(a, b)| quat::angle_between(*a, *b)).fold(0.0, f32::max);
        assert!(gap > 0.2);
        let exact = closed(&source, cycle.clone(), METHODS[0], 0.5);
        // Only the root's own step over the ground remains.
        assert!(
            seam_of_frames(&source, cycle.clone(), &exact) < 0.05,
            "{}",
            seam_of_frames(&source, cycle.clone(), &exact)
        );
        assert!((exact.before.turn_deg - f64::from(gap.to_degrees())).abs() < 1e-3);
    }
}

#[test]
fn classic_loop_reports_its_seam() {
    let source = walk(160, 0.0);
    let classic = closed(&source, 5..35, METHODS[3], 0.5);
    let z = crate::math::spring::rate(0.2) * 0.5;
    let k = (1.0 + z) * (-z).exp();
    // Velocities differ as well, so the share is only of the order of that of the pose difference.
    let share = classic.seam.turn_deg / classic.before.turn_deg;
    assert!(share > 0.5 * k && share < 2.5 * k, "{share} {k}");
    assert!(closed(&source, 5..35, METHODS[0], 0.5).seam.turn_deg < 1e-3);
}

#[test]
fn close_loop_of_an_exact_cycle_changes_nothing() {
    // Exactly one stride in 64 frames.
    let source = source_of(Walk { frames: 65, fps: 64.0, cadence: 1.0, ..Walk::default() }.clip());
    for method in METHODS {
        let made = closed(&source, 0..64, method, 0.5);
        let own = source.clip().crop(0..64).unwrap();
        let (p, q) = (made.clip.world_positions(0..64), own.world_positions(0..64));
        let worst = p.iter().zip(&q).map(|(p, q)| p.distance(*q)).fold(0.0, f32::max);
        assert!(worst < 0.01, "{method:?} {worst}");
        let forward = made.cycle.shift.length();
        assert!((forward - 1.3).abs() < 0.01, "{forward}");
    }
}

/// The loop of a clip that turns continues along its own curve.
#[test]
fn close_loop_of_a_turning_clip_continues_its_curve() {
    let source = walk(160, 0.6);
    let made = closed(&source, 10..77, METHODS[0], 0.5);
    assert!((made.cycle.yaw - 0.6 * 67.0 / 60.0).abs() < 0.05, "{:?}", made.cycle);
    let steps: Vec<f64> = {
        let played = made.repeat(3).unwrap();
        let roots = played.root_translations();
        roots.windows(2).map(|p| f64::from((p[1] - p[0]).length()) * 60.0).collect()
    };
    assert!(steps.windows(2).all(|s| (s[1] - s[0]).abs() < 0.08), "no jump of speed at the seams");
}

#[test]
fn close_loop_closes_translations_and_respects_the_ratio() {
    let (clip, n) = ((**walk(100, 0.0).clip()).clone(), 100);
    let values = (0..n).map(|f| Vec3::new(0.2, 0.22 + 0.002 * f as f32, 0.0)).collect();
    let source =
        source_of(clip.with_translations(vec![JointTranslations { joint: 3, values }]).unwrap());
    let start_kept = closed(&source, 10..70, LoopMethod::Exact { half_life_secs: 0.05 }, 0.0);
    assert!((start_kept.clip.translations()[0].values[0].y - 0.24).abs() < 1e-4);
    let end_kept = closed(&source, 10..70, LoopMethod::Exact { half_life_secs: 0.05 }, 1.0);
    let values = &end_kept.clip.translations()[0].values;
    assert!((values[59].y - (0.22 + 0.138)).abs() < 1e-4);
    assert!(values[0].y > 0.35);
    assert_eq!(end_kept.repeat(3).unwrap().translations()[0].values.len(), 180);
}

#[test]
fn close_loop_of_an_invalid_range_is_refused() {
    let source = walk(60, 0.0);
    for cycle in [0..60, 10..11, 40..40, 59..70, 0..usize::MAX, usize::MAX..usize::MAX] {
        let error = close_loop(&source, cycle, &LoopOptions::default()).unwrap_err();
        assert!(matches!(error, LoopError::Range { frames: 60, .. }));
    }
    for half_life_secs in [f64::NAN, -1.0, 1e9] {
        let method = LoopMethod::Exact { half_life_secs };
        assert!(matches!(
            close_loop(&source, 0..59, &LoopOptions { method, ratio: 0.5 }),
            Err(LoopError::HalfLife(_))
        ));
    }
    assert_eq!(closed(&source, 0..59, METHODS[0], 0.5).repeat(0).unwrap().frames(), 0);
    assert!(
        closed(&source, 0..59, LoopMethod::Exact { half_life_secs: 0.0 }, 0.5)
            .clip
            .root_translations()
            .iter()
            .all(|p| p.is_finite())
    );
}
