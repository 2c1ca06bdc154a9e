//! Tests of the metrics of transitions.

use super::*;
use crate::blend::{DissolveOptions, RootBlend, WeightLaw, dissolve};
use crate::registration::fixtures::Walk;
use crate::skeleton::Side;
use crate::synth::{Action, Params, synthesize};
use glam::Quat;
use std::sync::Arc;

const FPS: f64 = 60.0;

/// Returns a clip with both feet on the ground, 3 cm above y = 0 at the tips of the feet.
fn still(frames: usize) -> Clip {
    Walk { frames, fps: FPS, speed: 0.0, cadence: 0.0, swing: 0.0, ..Walk::default() }.clip()
}

/// Returns a clip that glides without moving a limb.
fn gliding(speed: f32) -> Clip {
    Walk { frames: 120, fps: FPS, speed, cadence: 0.0, swing: 0.0, ..Walk::default() }.clip()
}

fn edited(clip: &Clip, edit: impl Fn(usize, &mut [Quat], &mut Vec3)) -> Clip {
    let mut roots = clip.root_translations().to_vec();
    let mut rotations = vec![];
    for (frame, root) in roots.iter_mut().enumerate() {
        let mut pose = clip.rotations(frame).to_vec();
        edit(frame, &mut pose, root);
        rotations.extend(pose);
    }
    Clip::new("edited", Arc::clone(clip.skeleton()), clip.fps(), rotations, roots).unwrap()
}

fn measure(
    result: &Clip,
    transition: Range<usize>,
    enter: usize,
    a: &Motion,
    b: &Motion,
) -> TransitionMetrics {
    let roles = Roles::detect(result.skeleton());
    let (start, end) = (transition.start, transition.end);
    TransitionMetrics::of(&Subject {
        result,
        start,
        end,
        handover: usize::midpoint(start, end),
        enter,
        a,
        b,
        roles: &roles,
        ground_m: 0.0,
    })
}

fn blended(
    a: &Motion,
    leave: usize,
    b: &Motion,
    enter: usize,
    options: &DissolveOptions,
) -> (Concatenation, TransitionMetrics) {
    let out = dissolve(a, leave, b, enter, options).unwrap();
    let metrics = measure(&out.clip, out.transition.clone(), enter, a, b);
    (out, metrics)
}

fn assert_near(value: Option<f64>, expected: f64, tolerance: f64) {
    let value = value.unwrap_or(f64::NAN);
    assert!((value - expected).abs() <= tolerance, "{value}, expected {expected}");
}

fn ramp(frame: usize, range: Range<usize>) -> f32 {
    ((frame as f32 - range.start as f32) / range.len() as f32).clamp(0.0, 1.0)
}

#[test]
fn metrics_of_a_still_clip_are_zero() {
    let a = Motion::analyze(still(90));
    let metrics = measure(&still(90), 30..50, 30, &a, &a);
    for (value, what) in [
        (metrics.seam_deg, "seam"),
        (metrics.seam_dps, "velocity"),
        (metrics.jump_cm, "jump"),
        (metrics.spin_deg, "spin"),
        (metrics.skate_cm, "skate"),
        (metrics.penetration_cm, "penetration"),
    ] {
        assert_eq!(value, Some(0.0), "{what}");
    }
    assert_eq!((metrics.seam_joint, metrics.lag_s), (None, None));
}

#[test]
fn seam_of_a_jump_of_30_degrees_is_30_degrees() {
    let a = Motion::analyze(still(90));
    let result = edited(&still(90), |frame, pose, _| {
        if frame >= 30 {
            pose[4] *= Quat::from_rotation_y(30_f32.to_radians());
        }
    });
    let cut = measure(&result, 30..30, 30, &a, &a);
    assert_near(cut.seam_deg, 30.0, 1e-3);
    assert_near(cut.seam_dps, 30.0 * FPS, 0.05);
    assert_eq!(cut.seam_joint, Some(4));
    assert_near(cut.jump_cm, 0.0, 1e-9);
    assert_near(cut.spin_deg, 0.0, 1e-9);
    // Anywhere in the window, borders included.
    for start in [20, 25, 30] {
        assert_near(measure(&result, start..start + 10, start, &a, &a).seam_deg, 30.0, 1e-3);
    }
    assert_eq!(measure(&result, 50..60, 50, &a, &a).seam_deg, Some(0.0));
}

#[test]
fn seam_of_usual_motion_is_zero() {
    // A joint that turns at a steady 300° per second has no jump. The same joint that stops
    // suddenly has one of 300° per second.
    let turning = |stop: usize| {
        edited(&still(200), |frame, pose, _| {
            pose[4] = Quat::from_rotation_x(5_f32.to_radians() * frame.min(stop) as f32);
        })
    };
    let a = Motion::analyze(turning(1000));
    let steady = measure(&turning(1000), 90..110, 90, &a, &a);
    assert_near(steady.seam_deg, 0.0, 1e-3);
    assert_near(steady.seam_dps, 0.0, 0.05);
    let stopping = measure(&turning(100), 90..110, 90, &a, &Motion::analyze(still(200)));
    assert_near(stopping.seam_deg, 0.0, 1e-3);
    assert_near(stopping.seam_dps, 300.0, 0.1);
}

#[test]
fn spin_is_measured_beyond_that_of_the_sources() {
    let spun = |clip: &Clip, degrees: f32| {
        edited(clip, |frame, pose, _| {
            pose[0] = Quat::from_rotation_y(degrees.to_radians() * ramp(frame, 30..60)) * pose[0];
        })
    };
    let a = Motion::analyze(still(90));
    for degrees in [180.0, -180.0, 360.0, 25.0] {
        assert_near(
            measure(&spun(&still(90), degrees), 31..61, 31, &a, &a).spin_deg,
            f64::from(degrees).abs(),
            0.01,
        );
    }
    // There and back again is a spin of one way.
    let back = edited(&still(90), |frame, pose, _| {
        pose[0] = Quat::from_rotation_y(
            (ramp(frame, 30..45) - ramp(frame, 45..60)) * 90_f32.to_radians(),
        ) * pose[0];
    });
    assert_near(measure(&back, 31..61, 31, &a, &a).spin_deg, 90.0, 0.01);
    // A source that turns 60° per second allows as much, to its side.
    let turning = Walk {
        frames: 90,
        fps: FPS,
        speed: 0.0,
        cadence: 0.0,
        swing: 0.0,
        turning: 60_f32.to_radians(),
        ..Walk::default()
    }
    .clip();
    let b = Motion::analyze(turning.clone());
    assert_near(measure(&turning, 31..61, 31, &a, &b).spin_deg, 0.0, 0.01);
    assert_near(measure(&spun(&turning, 45.0), 31..60, 31, &a, &b).spin_deg, 45.0, 0.01);
    assert_near(measure(&spun(&turning, -45.0), 31..60, 31, &a, &b).spin_deg, 45.0 - 30.0, 0.01);
}

#[test]
fn skate_of_a_foot_sliding_5_cm_is_5_cm() {
    let a = Motion::analyze(still(120));
    assert!(a.contacts().planted(Side::Left, 40) && a.contacts().planted(Side::Right, 40));
    let slid =
        |way: &dyn Fn(usize) -> f32| edited(&still(120), |frame, _, root| root.x += way(frame));
    let once = measure(&slid(&|f| 0.05 * ramp(f, 50..60)), 45..65, 45, &a, &a);
    assert_near(once.skate_cm, 5.0, 1e-3);
    assert_near(once.jump_cm, 0.5, 1e-3);
    // Back again: the value is the greatest distance.
    let back = measure(&slid(&|f| 0.05 * (ramp(f, 50..55) - ramp(f, 55..60))), 45..65, 45, &a, &a);
    assert_near(back.skate_cm, 5.0, 1e-3);
    // For one foot only: the leg swings, the other stands.
    let leg = edited(&still(120), |frame, pose, _| {
        pose[7] = Quat::from_rotation_x(-0.2 * ramp(frame, 50..60));
    });
    let metrics = measure(&leg, 45..65, 45, &a, &a);
    // The foot's points turn about the hip joint; the ankle, 0.85 m below it, moves least over the
    // ground.
    let way = |point: Vec3| (point - Quat::from_rotation_x(-0.2) * point).z.abs();
    let least = way(Vec3::new(0.0, -0.85, 0.0)).min(way(Vec3::new(0.0, -0.91, 0.2)));
    assert_near(metrics.skate_cm, f64::from(least) * 100.0, 0.05);
}

#[test]
fn skate_of_a_foot_in_the_air_is_zero() {
    let glides = gliding(1.0);
    let a = Motion::analyze(glides.clone());
    assert_eq!(measure(&glides, 45..65, 45, &a, &a).skate_cm, None);
    // Slides of a foot in its own clip are not attributed to the transition.
    let slow = gliding(0.3);
    let b = Motion::analyze(slow.clone());
    assert!(b.contacts().planted(Side::Left, 50));
    assert_near(measure(&slow, 45..65, 45, &b, &b).skate_cm, 0.0, 1e-3);
}

#[test]
fn penetration_is_that_of_the_deepest_point_in_the_transition() {
    let a = Motion::analyze(still(90));
    let lowered = |at: usize| {
        edited(&still(90), move |frame, _, root| root.y -= if frame == at { 0.08 } else { 0.0 })
    };
    assert_near(measure(&lowered(40), 35..45, 35, &a, &a).penetration_cm, 5.0, 1e-3);
    assert_near(measure(&lowered(20), 35..45, 35, &a, &a).penetration_cm, 0.0, 1e-9);
}

#[test]
fn lag_of_a_dissolve_follows_its_weights() {
    let (a, b) = (Motion::analyze(gliding(1.0)), Motion::analyze(gliding(2.0)));
    // The share 1 - w of the difference is closed: 0.9 at t = 0.9 for the line, at t = 0.8042 for
    // 3t² - 2t³ (NumPy's roots), and at t = 0.7534 for the quintic.
    for (law, t) in
        [(WeightLaw::Linear, 0.9), (WeightLaw::Smooth, 0.804_200), (WeightLaw::Smoother, 0.753_364)]
    {
        let options = DissolveOptions { window: 60, law, ..DissolveOptions::default() };
        let (_, metrics) = blended(&a, 40, &b, 20, &options);
        assert_near(metrics.lag_s, t * 60.0 / FPS, 0.6 / FPS);
    }
    let (_, cut) =
        blended(&a, 40, &b, 20, &DissolveOptions { window: 0, ..DissolveOptions::default() });
    assert_eq!(cut.lag_s, Some(0.0));
    let (_, alike) =
        blended(&a, 40, &Motion::analyze(gliding(1.05)), 20, &DissolveOptions::default());
    assert_eq!(alike.lag_s, None);
}

fn made(params: &Params) -> Motion {
    Motion::analyze(synthesize(params).unwrap().clip)
}

#[test]
fn metrics_of_a_continued_walk_are_zero() {
    let walk = made(&Params { turn_rate_dps: 20.0, ..Params::new(Action::Walk) });
    for root in [RootBlend::Velocity, RootBlend::World] {
        for window in [0, 12, 30] {
            let (_, metrics) = blended(
                &walk,
                60,
                &walk,
                60,
                &DissolveOptions { window, root, ..DissolveOptions::default() },
            );
            assert_near(metrics.skate_cm, 0.0, 0.01);
            assert_near(metrics.jump_cm, 0.0, 0.01);
            assert_near(metrics.spin_deg, 0.0, 0.01);
            assert_near(metrics.penetration_cm, 0.0, 0.5);
            assert_near(metrics.seam_deg, 0.0, 0.01);
            assert_near(metrics.seam_dps, 0.0, 0.5);
        }
    }
}

#[test]
fn seam_of_shorter_windows_is_greater() {
    let walk = made(&Params::new(Action::Walk));
    for (other, enter) in
        [(made(&Params::new(Action::Run)), 17), (made(&Params::new(Action::Idle)), 40)]
    {
        let at = |window: usize| {
            blended(
                &walk,
                70,
                &other,
                enter,
                &DissolveOptions { window, ..DissolveOptions::default() },
            )
            .1
        };
        let (seams, speeds): (Vec<f64>, Vec<f64>) = [0, 2, 4, 8, 16, 32]
            .map(at)
            .iter()
            .map(|m| (m.seam_deg.unwrap(), m.seam_dps.unwrap()))
            .unzip();
        assert!(seams.windows(2).all(|pair| pair[1] <= pair[0]), "{seams:?}");
        assert!(speeds.windows(2).all(|pair| pair[1] <= pair[0]), "{speeds:?}");
        assert!(seams[0] > 10.0 && seams[0] > 4.0 * seams[3], "{seams:?}");
    }
}

#[test]
fn metrics_of_root_blends_differ_as_documented() {
    // A walk to the north and one to the south, 5 m apart.
    let north = made(&Params::new(Action::Walk));
    let clip = synthesize(&Params { speed_mps: 1.0, ..Params::new(Action::Walk) }).unwrap().clip;
    let south = Motion::analyze(clip.transformed(&Planar::new(3.0, 5.0, 0.0)));
    let at = |align: bool, root: RootBlend, window: usize| {
        blended(
            &north,
            70,
            &south,
            30,
            &DissolveOptions { window, align, root, ..DissolveOptions::default() },
        )
        .1
    };
    let (velocity, flying, flash) = (
        at(true, RootBlend::Velocity, 30),
        at(false, RootBlend::World, 30),
        at(false, RootBlend::World, 0),
    );
    assert!(velocity.spin_deg.unwrap() < 3.0, "{velocity:?}");
    assert!(flying.spin_deg.unwrap() > 150.0, "{flying:?}");
    assert!(flash.jump_cm.unwrap() > 400.0 && flash.seam_deg.unwrap() > 150.0, "{flash:?}");
    assert!(
        flying.skate_cm.unwrap() > 5.0 * velocity.skate_cm.unwrap().max(1.0),
        "{flying:?} {velocity:?}"
    );
    assert!(flying.jump_cm.unwrap() > velocity.jump_cm.unwrap() + 10.0);
}

#[test]
fn metrics_of_unusual_subjects_are_finite() {
    let clip = still(20);
    let (a, empty) = (Motion::analyze(clip.clone()), Motion::analyze(clip.crop(0..0).unwrap()));
    for result in
        [clip.clone(), clip.crop(0..0).unwrap(), clip.crop(0..1).unwrap(), clip.crop(0..2).unwrap()]
    {
        for transition in
            [0..0, 0..20, 19..20, 20..20, 5..500, 900..1000, usize::MAX - 1..usize::MAX]
        {
            for enter in [0, 19, 20, usize::MAX] {
                for (a, b) in [(&a, &a), (&empty, &a), (&a, &empty)] {
                    let metrics = measure(&result, transition.clone(), enter, a, b);
                    let numbers = [metrics.jump_cm, metrics.penetration_cm, metrics.lag_s];
                    assert!(numbers.into_iter().flatten().all(|v| v.is_finite() && v >= 0.0));
                }
            }
        }
    }
}
