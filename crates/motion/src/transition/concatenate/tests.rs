//! Tests of transitions by all methods.

use super::*;
use crate::clip::{Clip, Interpolation, JointTranslations, Motion, resample};
use crate::math::Decay;
use crate::registration::fixtures::Walk;
use glam::Quat;
use proptest::prelude::*;
use std::sync::Arc;

const KINDS: [Inertialization; 4] = [
    Inertialization::Offset(Decay::Spring { half_life_secs: 0.1 }),
    Inertialization::Offset(Decay::Cubic { blend_secs: 0.4 }),
    Inertialization::Offset(Decay::Quintic { blend_secs: 0.4 }),
    Inertialization::DeadBlend { blend_secs: 0.4, extrapolation_half_life_secs: 0.1 },
];

const ROOT_OPTIONS: [(bool, RootBlend); 3] =
    [(true, RootBlend::Velocity), (true, RootBlend::World), (false, RootBlend::Velocity)];

fn source_of(clip: Clip) -> Motion {
    Motion::analyze(clip)
}

fn source(walk: Walk) -> Motion {
    source_of(walk.clip())
}

fn two_walks() -> (Motion, Motion) {
    let a = source(Walk { frames: 120, turning: 0.4, ..Walk::default() });
    let b = source(Walk {
        frames: 260,
        speed: 2.2,
        cadence: 1.3,
        swing: 0.7,
        phase: 0.3,
        heading: 2.5,
        start: (7.0, -5.0),
        ..Walk::default()
    });
    (a, b)
}

fn made(
    a: &Motion,
    leave: usize,
    b: &Motion,
    enter: usize,
    how: Inertialization,
    (align, root): (bool, RootBlend),
) -> Concatenation {
    let method = Method::Inertialize(how);
    concatenate(
        a,
        leave,
        b,
        enter,
        &TransitionOptions { align, root, ..TransitionOptions::new(method) },
    )
    .unwrap()
}

/// Returns the largest distance between joints of two clips, and the largest angle.
fn difference(a: &Clip, b: &Clip) -> (f32, f32) {
    assert_eq!(a.frames(), b.frames());
    let (p, q) = (a.world_positions(0..a.frames()), b.world_positions(0..b.frames()));
    let distance = p.iter().zip(&q).map(|(p, q)| p.distance(*q)).fold(0.0, f32::max);
    let angles = (0..a.frames()).flat_map(|f| a.rotations(f).iter().zip(b.rotations(f)));
    (distance, angles.map(|(p, q)| quat::angle_between(*p, *q)).fold(0.0, f32::max))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn concatenate_without_difference_leaves_b_unchanged(
        at in 0usize..119,
        turning in -1.0f32..1.0,
    ) {
        let a = source(Walk {
            frames: 120,
            turning,
            heading: 3.0,
            start: (3.0, -2.0),
            ..Walk::default()
        });
        // An extrapolated pose differs from the motion that it came from, so that dead blending
        // alone changes a clip that is joined to itself.
        for how in &KINDS[..3] {
            for place in ROOT_OPTIONS {
                let out = made(&a, at, &a, at, *how, place);
                let (distance, angle) = difference(&out.clip, a.clip());
                prop_assert!(
                    distance < 2e-5 && angle < 2e-5,
                    "{how:?} {place:?}: {distance} {angle}"
                );
            }
        }
    }

    #[test]
    fn concatenate_does_not_depend_on_the_position_of_b(
        yaw in -3.0f64..3.0,
        x in -9.0f64..9.0,
        z in -9.0f64..9.0,
    ) {
        let (a, b) = two_walks();
        let moved = source_of(b.clip().transformed(&Planar::new(yaw, x, z)));
        for how in KINDS {
            for place in &ROOT_OPTIONS[..2] {
                let (here, there) =
                    (made(&a, 70, &b, 10, how, *place), made(&a, 70, &moved, 10, how, *place));
                let (distance, _) = difference(&here.clip, &there.clip);
                prop_assert!(distance < 1e-3, "{how:?} {distance}");
            }
        }
    }

    #[test]
    fn concatenate_is_a_before_the_transition_and_b_after_it(
        leave in 0usize..=120,
        enter in 0usize..260,
    ) {
        let (a, b) = two_walks();
        for how in KINDS {
            for place in ROOT_OPTIONS {
                let out = made(&a, leave, &b, enter, how, place);
                prop_assert_eq!(out.clip.frames(), leave + 260 - enter);
                prop_assert_eq!(out.frames.len(), out.clip.frames());
                prop_assert_eq!(out.b_during.len(), out.transition.len());
                prop_assert!(
                    out.transition.start == leave && out.transition.end <= out.clip.frames()
                );
                prop_assert!(out.transition.contains(&out.handover) || out.transition.is_empty());
                prop_assert_eq!(
                    &out.clip.crop(0..leave).unwrap().with_name(""),
                    &a.clip().crop(0..leave).unwrap().with_name("")
                );
                let settled = leave + (how.settling_secs() * 60.0).ceil() as usize;
                for f in (settled..out.clip.frames()).step_by(7) {
                    let mut expected = b.clip().world_pose(enter + f - leave);
                    expected.apply(&out.world_from_b);
                    for (p, q) in out.clip.world_pose(f).positions.iter().zip(&expected.positions) {
                        prop_assert!(p.distance(*q) < 1e-4, "{how:?} {place:?} frame {f} {p} {q}");
                    }
                }
                prop_assert!(out.clip.root_translations().iter().all(|p| p.is_finite()));
                if !place.0 {
                    prop_assert_eq!(out.world_from_b, Planar::IDENTITY);
                }
            }
        }
    }
}

/// The step over the seam is A's step: in pose, and over the ground.
#[test]
fn concatenate_continues_the_step_of_a() {
    let (a, b) = two_walks();
    for how in KINDS {
        for place in ROOT_OPTIONS {
            let out = made(&a, 70, &b, 31, how, place);
            let turn = |clip: &Clip, joint: usize| {
                quat::log(clip.rotations(70)[joint] * clip.rotations(69)[joint].conjugate()) * 60.0
            };
            for joint in 0..a.clip().skeleton().len() {
                let off = turn(&out.clip, joint) - turn(a.clip(), joint);
                // Without alignment the root has two and a half radians to turn, and starts at
                // once.
                let bound = if place.0 || joint > 0 { 0.9 } else { 4.5 };
                assert!(off.length() < bound, "{how:?} {place:?} {joint}: {off}");
            }
            let step =
                |clip: &Clip| (clip.root_translations()[70] - clip.root_translations()[69]) * 60.0;
            let off = step(&out.clip) - step(a.clip());
            // Without alignment B is metres away, and a quintic that would overshoot accelerates
            // hard.
            assert!(!place.0 || off.length() < 0.6, "{how:?} {place:?} {off}");
        }
        // A cut is discontinuous.
        let cut = concatenate(&a, 70, &b, 31, &TransitionOptions::new(Method::Cut)).unwrap();
        assert!((quat::angle_between(cut.clip.rotations(70)[3], cut.clip.rotations(69)[3])) > 0.2);
    }
}

/// The difference of the first step's angular velocity to A's decreases with the duration of a
/// frame: the velocity is continuous, also for large offsets.
#[test]
fn concatenate_of_fine_frames_has_continuous_velocity() {
    let jump = |fps: f64, how| {
        let n = fps as usize;
        let walk = |phase: f32, swing: f32, speed: f32| {
            source(Walk { frames: 2 * n, fps, phase, swing, speed, ..Walk::default() })
        };
        let (a, b) = (walk(0.0, 1.3, 1.0), walk(0.4, 1.3, 2.0));
        let out = made(&a, n, &b, n / 2, how, ROOT_OPTIONS[0]);
        let turn = |clip: &Clip, joint: usize| {
            quat::log(clip.rotations(n)[joint] * clip.rotations(n - 1)[joint].conjugate())
                * fps as f32
        };
        (0..13)
            .map(|joint| (turn(&out.clip, joint) - turn(a.clip(), joint)).length())
            .fold(0.0, f32::max)
    };
    for how in KINDS {
        let (coarse, fine) = (jump(300.0, how), jump(1200.0, how));
        assert!(fine < coarse / 3.0 + 0.02, "{how:?} {coarse} {fine}");
    }
}

/// A clip that is cut in two and joined again: its ends are extrapolated, so only the change of a
/// step in one frame is bridged.
#[test]
fn concatenate_of_two_halves_is_the_whole_clip() {
    let whole = Walk { frames: 200, fps: 120.0, turning: 0.5, ..Walk::default() }.clip();
    for at in [70, 93, 120] {
        let (a, b) =
            (source_of(whole.crop(0..at).unwrap()), source_of(whole.crop(at..200).unwrap()));
        for how in &KINDS[..3] {
            let out = made(&a, at, &b, 0, *how, ROOT_OPTIONS[0]);
            let (distance, _) = difference(&out.clip, &whole);
            // An arm swings as a sine; knees stop suddenly.
            let arm =
                |f: usize| quat::angle_between(out.clip.rotations(f)[3], whole.rotations(f)[3]);
            let angle = (0..200).map(arm).fold(0.0, f32::max);
            assert!(distance < 0.05 && angle < 0.02, "{how:?} {at} {distance} {angle}");
        }
    }
}

#[test]
fn concatenate_with_duration_0_is_a_cut() {
    let (a, b) = two_walks();
    for root in [RootBlend::Velocity, RootBlend::World] {
        let cut = concatenate(
            &a,
            70,
            &b,
            10,
            &TransitionOptions { root, ..TransitionOptions::new(Method::Cut) },
        )
        .unwrap();
        for how in [
            Inertialization::Offset(Decay::Spring { half_life_secs: 0.0 }),
            Inertialization::Offset(Decay::Cubic { blend_secs: 0.0 }),
            Inertialization::Offset(Decay::Quintic { blend_secs: 0.0 }),
            Inertialization::DeadBlend { blend_secs: 0.0, extrapolation_half_life_secs: 0.0 },
        ] {
            let out = made(&a, 70, &b, 10, how, (true, root));
            let (distance, angle) = difference(&out.clip, &cut.clip);
            assert!(distance < 1e-4 && angle < 1e-4, "{how:?} {distance} {angle}");
            assert_eq!((out.transition, out.handover), (70..70, 70));
        }
    }
}

#[test]
fn concatenate_by_any_method_agrees_with_its_function() {
    let (a, b) = two_walks();
    let window = 20;
    let law = WeightLaw::Linear;
    let through =
        concatenate(&a, 70, &b, 10, &TransitionOptions::new(Method::Dissolve { window, law }))
            .unwrap();
    let direct =
        dissolve(&a, 70, &b, 10, &DissolveOptions { window, law, ..DissolveOptions::default() })
            .unwrap();
    assert_eq!(through, direct);
    let long = made(&a, 70, &b, 10, KINDS[0], ROOT_OPTIONS[0]);
    assert_eq!(long.clip.frames(), through.clip.frames());
}

/// At half the frame rate the seam is half a frame later at most. Frames at the same times differ
/// by less than 4 cm and 6°, in a transition between two gaits that differ by 20 cm and 60°.
#[test]
fn concatenate_at_half_the_frame_rate_is_nearly_the_same() {
    let at = |fps: f64| {
        let scale = (fps / 60.0) as usize;
        let walk = |phase: f32, swing: f32, speed: f32, turning: f32| {
            source(Walk {
                frames: 120 * scale + 1,
                fps,
                phase,
                swing,
                speed,
                turning,
                ..Walk::default()
            })
        };
        (walk(0.0, 0.4, 1.2, 0.0), walk(0.35, 0.8, 2.6, 0.5), 60 * scale + 1, 30 * scale + 1, scale)
    };
    for how in KINDS {
        let run = |fps: f64| {
            let (a, b, leave, enter, scale) = at(fps);
            (made(&a, leave, &b, enter, how, ROOT_OPTIONS[0]).clip, scale)
        };
        let ((coarse, _), (fine, scale)) = (run(60.0), run(120.0));
        let coarse_again = resample(&fine, 60.0, Interpolation::Nearest).unwrap();
        assert_eq!(scale, 2);
        let (distance, angle) = difference(&coarse, &coarse_again);
        assert!(
            distance < 0.04 && angle < 6_f32.to_radians(),
            "{how:?} {distance} {}",
            angle.to_degrees()
        );
    }
}

#[test]
fn concatenate_inertializes_joint_translations() {
    let (a, b) = two_walks();
    let values = (0..120).map(|f| Vec3::new(0.2, 0.22 + 0.001 * f as f32, 0.0)).collect();
    let moving = source_of(
        (**a.clip())
            .clone()
            .with_translations(vec![JointTranslations { joint: 3, values }])
            .unwrap(),
    );
    for how in KINDS {
        let out = made(&moving, 70, &b, 10, how, ROOT_OPTIONS[0]);
        let track = &out.clip.translations()[0];
        assert_eq!((track.joint, track.values.len()), (3, out.clip.frames()));
        assert_eq!(track.values[69].y, 0.22 + 0.069);
        // It continues upwards for a moment, and then comes to rest where B has it.
        assert!(track.values[70].y > 0.22 + 0.065, "{how:?} {}", track.values[70].y);
        assert!((track.values[240].y - 0.22).abs() < 1e-5);
    }
}

#[test]
fn concatenate_to_a_faster_gait_does_not_overshoot_its_speed() {
    let glide = |speed: f32| {
        source(Walk { frames: 200, speed, cadence: 0.0, swing: 0.0, ..Walk::default() })
    };
    let (a, b) = (glide(1.0), glide(3.0));
    for how in KINDS {
        let out = made(&a, 50, &b, 20, how, ROOT_OPTIONS[0]);
        let speeds: Vec<f32> =
            out.clip.root_translations().windows(2).map(|p| p[0].distance(p[1]) * 60.0).collect();
        let rises = speeds.windows(2).all(|s| s[1] > s[0] - 1e-3);
        // An extrapolated pose slows down first.
        assert!(rises || matches!(how, Inertialization::DeadBlend { .. }), "{how:?} {speeds:?}");
        assert!(speeds.iter().all(|s| (0.5..3.01).contains(s)), "{how:?} {speeds:?}");
        assert!((speeds[49] - 1.0).abs() < 0.1 && (speeds[180] - 3.0).abs() < 1e-3);
    }
}

#[test]
fn concatenate_of_incompatible_clips_is_refused() {
    let (a, b) = two_walks();
    for secs in [-0.1, 61.0, f64::NAN, f64::INFINITY] {
        for how in [
            Inertialization::Offset(Decay::Spring { half_life_secs: secs }),
            Inertialization::Offset(Decay::Quintic { blend_secs: secs }),
            Inertialization::DeadBlend { blend_secs: 0.3, extrapolation_half_life_secs: secs },
        ] {
            let options = TransitionOptions::new(Method::Inertialize(how));
            assert!(
                matches!(concatenate(&a, 50, &b, 10, &options), Err(BlendError::Time { .. })),
                "{secs}"
            );
        }
    }
    let options = TransitionOptions::new(Method::Inertialize(KINDS[0]));
    assert!(concatenate(&a, 120, &b, 259, &options).is_ok());
    assert!(matches!(concatenate(&a, 121, &b, 0, &options), Err(BlendError::Window { .. })));
    assert!(matches!(concatenate(&a, 0, &b, 260, &options), Err(BlendError::Window { .. })));
    let one = source(Walk { frames: 1, ..Walk::default() });
    assert_eq!(concatenate(&one, 1, &one, 0, &options).unwrap().clip.frames(), 2);
}

/// B walks straight on for half a second and then turns left: the mean over its first stride is
/// half a turn to the left already.
#[test]
fn concatenate_before_a_turn_does_not_turn_the_other_way() {
    let straight = Walk { frames: 200, cadence: 0.0, swing: 0.0, ..Walk::default() }.clip();
    let yaw = |frame: usize| 0.04 * frame.saturating_sub(35) as f32;
    let turned = |clip: &Clip, yaw: &dyn Fn(usize) -> f32| {
        let joints = clip.skeleton().len();
        let mut rotations: Vec<Quat> =
            (0..clip.frames()).flat_map(|frame| clip.rotations(frame).to_vec()).collect();
        for (frame, root) in rotations.iter_mut().step_by(joints).enumerate() {
            *root = Quat::from_rotation_y(yaw(frame)) * *root;
        }
        let roots = clip.root_translations().to_vec();
        source_of(
            Clip::new("turning", Arc::clone(clip.skeleton()), clip.fps(), rotations, roots)
                .unwrap(),
        )
    };
    let (a, b) = (source_of(straight.clone()), turned(&straight, &yaw));
    // The reverse: A has turned, and walks straight where it is left.
    let (before, after) =
        (turned(&straight, &|frame| yaw(frame.min(90))), source_of(straight.clone()));
    for how in KINDS {
        let out = made(&a, 100, &b, 5, how, ROOT_OPTIONS[0]);
        let least =
            out.frames[100..130].iter().map(|frame| frame.yaw).fold(f64::INFINITY, f64::min);
        assert!(least > -0.5_f64.to_radians(), "{how:?} {}", least.to_degrees());
        let out = made(&before, 94, &after, 20, how, ROOT_OPTIONS[0]);
        let turned = wrap_angle(out.frames[180].yaw - out.frames[93].yaw);
        assert!(turned.abs() < 0.5_f64.to_radians(), "{how:?} {}", turned.to_degrees());
    }
    // A turn that both clips make is handed over: a steady turn decays in its own time.
    let (steady, out) = (turned(&straight, &|frame| 0.02 * frame as f32), source_of(straight));
    let made = made(&steady, 100, &out, 20, KINDS[0], ROOT_OPTIONS[0]);
    let turned = wrap_angle(made.frames[180].yaw - made.frames[99].yaw);
    let wanted = 0.02 * 60.0 * 2.0 / crate::math::spring::rate(0.1) * 0.5;
    assert!(turned > wanted, "{turned} {wanted}");
}
