//! Tests of the metrics of results.

use super::*;
use crate::clip::Clip;
use crate::skeleton::{Roles, fixtures};
use crate::synth::{Action, Params, synthesize};
use glam::{Quat, Vec3};
use std::f32::consts::PI;
use std::sync::Arc;

const JOINT: usize = 3;

/// Returns the trace of three seconds of a body that stands still except for one joint, whose angle
/// is a function of time.
fn turned(fps: f64, degrees: impl Fn(f64) -> f64) -> MotionTrace {
    let skeleton = fixtures::lafan();
    let frames = (3.0 * fps) as usize + 1;
    let mut rotations = vec![Quat::IDENTITY; frames * skeleton.len()];
    for (frame, pose) in rotations.chunks_mut(skeleton.len()).enumerate() {
        pose[JOINT] = Quat::from_rotation_x(degrees(frame as f64 / fps).to_radians() as f32);
    }
    let roles = fixtures::roles(&skeleton);
    let clip = Clip::new("turned", skeleton, fps, rotations, vec![Vec3::Y; frames]).unwrap();
    MotionTrace::new(&clip, &roles)
}

/// Measures a result against a still clip of another rate.
fn beside_standing(result: &MotionTrace) -> ResultMetrics {
    ResultMetrics::measure(result, &[&turned(24.0, |_| 0.0)])
}

#[test]
fn velocity_jump_of_a_smooth_turn_does_not_depend_on_the_frame_rate() {
    // A turn by 60° in half a second along 3x² - 2x³: velocities are continuous, the acceleration
    // jumps to 1440°/s².
    let smooth = |secs: f64| {
        let x = ((secs - 1.0) / 0.5).clamp(0.0, 1.0);
        60.0 * x * x * (3.0 - 2.0 * x)
    };
    let at = |fps: f64| beside_standing(&turned(fps, smooth)).velocity_jump_dps.unwrap();
    let sixty = at(60.0);
    assert!((0.8..1.0).contains(&(sixty / (1440.0 / 30.0))), "{sixty}");
    for fps in [30.0, 50.0, 100.0, 119.88, 120.0, 240.0] {
        assert!((at(fps) / sixty - 1.0).abs() < 0.05, "{fps}: {} and {sixty}", at(fps));
    }
}

#[test]
fn jumps_do_not_depend_on_the_frame_rate() {
    for fps in [30.0, 60.0, 120.0] {
        // A turn that starts with 200°/s.
        let kinked = beside_standing(&turned(fps, |secs| 200.0 * (secs - 1.0).max(0.0)));
        assert!((kinked.velocity_jump_dps.unwrap() - 200.0).abs() < 0.5, "{fps}: {kinked:?}");
        // A pose that jumps by 30°, and one that returns after a frame.
        for back_secs in [9.0, 1.5 / fps] {
            let snapped = beside_standing(&turned(fps, |secs| {
                let since = secs - 1.0 + 0.5 / fps;
                if (0.0..back_secs).contains(&since) { 30.0 } else { 0.0 }
            }));
            assert!((snapped.pose_jump_deg.unwrap() - 30.0).abs() < 0.01, "{fps}: {snapped:?}");
            assert_eq!(snapped.pose_jump_at.unwrap().joint, JOINT);
            let frame = snapped.pose_jump_at.unwrap().frame + 1;
            assert!((fps as usize..=fps as usize + 2).contains(&frame), "{fps}: {snapped:?}");
            assert!(snapped.velocity_jump_dps.unwrap() > 890.0, "{fps}: {snapped:?}");
        }
    }
}

#[test]
fn metrics_of_a_clip_against_itself_are_zero() {
    let glitch = |secs: f64| {
        if (1.0..1.02).contains(&secs) { 25.0 } else { 10.0 * (2.0 * secs).sin() }
    };
    let clip = turned(60.0, glitch);
    let itself = ResultMetrics::measure(&clip, &[&turned(60.0, |_| 0.0), &clip]);
    assert_eq!(
        (itself.pose_jump_deg, itself.velocity_jump_dps, itself.spin_deg),
        (Some(0.0), Some(0.0), Some(0.0))
    );
    assert_eq!((itself.pose_jump_at, itself.velocity_jump_at, itself.spin_at), (None, None, None));
    // Without sources it is reported: there is no clip with such a jump.
    let alone = ResultMetrics::measure(&clip, &[]);
    assert!(alone.pose_jump_deg.unwrap() > 10.0, "{alone:?}");
}

#[test]
fn spin_is_measured_with_and_without_a_source() {
    let clip = synthesize(&Params::new(Action::Walk)).unwrap().clip;
    let roles = Roles::detect(clip.skeleton());
    let walk = MotionTrace::new(&clip, &roles);
    let half = clip.frames() / 2;
    let mut rotations = Vec::new();
    for frame in 0..clip.frames() {
        let share = ((frame as f64 - half as f64) / (0.2 * clip.fps())).clamp(0.0, 1.0);
        let mut pose = clip.rotations(frame).to_vec();
        pose[0] = Quat::from_rotation_y(share as f32 * PI) * pose[0];
        rotations.extend(pose);
    }
    let spun = Clip::new(
        "spun",
        Arc::clone(clip.skeleton()),
        clip.fps(),
        rotations,
        clip.root_translations().to_vec(),
    )
    .unwrap();
    let spun = MotionTrace::new(&spun, &roles);
    for clips in [&[][..], &[&walk]] {
        let before = ResultMetrics::measure(&walk, clips);
        assert!(
            before.spin_deg.unwrap() < 3.0 && before.pose_jump_deg.unwrap() < 1.0,
            "{before:?}"
        );
        let after = ResultMetrics::measure(&spun, clips);
        assert!((160.0..=190.0).contains(&after.spin_deg.unwrap()), "{after:?}");
        assert!(after.spin_at.unwrap().abs_diff(half) < 6, "{after:?}");
    }
    let beside = ResultMetrics::measure(&spun, &[&walk]);
    assert_eq!(beside.pose_jump_at.unwrap().joint, 0);
}

#[test]
fn metrics_without_feet_or_with_one_frame_are_partial() {
    let skeleton = fixtures::lafan();
    let pose = vec![Quat::IDENTITY; skeleton.len()];
    let clip = Clip::new("pose", Arc::clone(&skeleton), 30.0, pose, vec![Vec3::Y]).unwrap();
    let trace = MotionTrace::new(&clip, &Roles::default());
    for clips in [&[][..], &[&trace], &[&turned(60.0, |_| 0.0)]] {
        assert_eq!(ResultMetrics::measure(&trace, clips), ResultMetrics::default());
    }
}

#[test]
fn trace_meter_in_slices_equals_the_trace() {
    let clip = synthesize(&Params::new(Action::Run)).unwrap().clip;
    let roles = Roles::detect(clip.skeleton());
    let mut meter = crate::metrics::TraceMeter::new(&clip, &roles);
    let mut slices = 0;
    while meter.advance(&clip, 50) {
        slices += 1;
    }
    assert!(slices > 10, "{slices}");
    assert_eq!(meter.finish(&clip), MotionTrace::new(&clip, &roles));
}
