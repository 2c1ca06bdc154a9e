//! Tests of registered blends.

use super::*;
use crate::registration::fixtures::Walk;
use crate::registration::{PairTerms, RegistrationOptions, limb_weights};

fn source(walk: Walk) -> Motion {
    Motion::analyze(walk.clip())
}

fn register(a: &Motion, b: &Motion) -> Registration {
    let (a, b) = (a.clip(), b.clip());
    let mut terms =
        PairTerms::new(a, 0..a.frames(), b, 0..b.frames(), &limb_weights(a.skeleton()), 1).unwrap();
    terms.finish();
    let matrix = terms.distances(5, &(0..a.frames()), &(0..b.frames())).unwrap();
    Registration::new(&terms, &matrix, &RegistrationOptions::new(a.fps())).unwrap()
}

/// Returns three walks of different stride, speed and curvature.
fn walks() -> [Motion; 3] {
    let brisk = Walk {
        frames: 240,
        cadence: 1.1,
        speed: 1.6,
        swing: 0.55,
        turning: 0.4,
        start: (8.0, -3.0),
        heading: 2.0,
        ..Walk::default()
    };
    let slow = Walk {
        frames: 330,
        cadence: 0.75,
        speed: 0.9,
        swing: 0.35,
        turning: -0.3,
        ..Walk::default()
    };
    [source(Walk { frames: 280, ..Walk::default() }), source(brisk), source(slow)]
}

/// Returns the largest distance of any joint between a frame of one clip and a transformed frame of
/// another.
fn apart(result: &Clip, frame: usize, of: &Clip, in_of: usize, moved: &Planar) -> f32 {
    let (a, b) = (result.world_positions(frame..frame + 1), of.world_positions(in_of..in_of + 1));
    a.iter().zip(&b).map(|(a, b)| a.distance(moved.apply(*b))).fold(0.0, f32::max)
}

#[test]
fn registered_blend_with_all_weight_on_one_clip_is_that_clip() {
    let [a, b, c] = walks();
    let (to_b, to_c) = (register(&a, &b), register(&a, &c));
    for alone in 0..3 {
        let weights =
            [1, 2].map(|partner| WeightCurve::constant(if partner == alone { 1.0 } else { 0.0 }));
        let partners = [
            Partner { source: &b, registration: &to_b, weight: &weights[0] },
            Partner { source: &c, registration: &to_c, weight: &weights[1] },
        ];
        let out = registered_blend(&a, &partners).unwrap();
        let of = [&a, &b, &c][alone];
        assert_eq!(out.clip.frames(), of.clip().frames(), "all of it plays");
        let lies =
            if alone == 0 { Planar::IDENTITY } else { [&to_b, &to_c][alone - 1].alignment_at(0.0) };
        for frame in 0..out.clip.frames() {
            assert!(
                (out.mixes[frame].frames[alone] - frame as f64).abs() < 1e-5,
                "{:?}",
                out.mixes[frame]
            );
            let off = apart(&out.clip, frame, of.clip(), frame, &lies);
            assert!(off < 1e-4, "clip {alone}, frame {frame}: {off} m");
        }
    }
}

#[test]
fn registered_blend_halfway_has_mean_duration_and_stride() {
    let [a, b, c] = walks();
    let (to_b, to_c) = (register(&a, &b), register(&a, &c));
    let half = WeightCurve::constant(0.5);
    let blend = |source, registration| {
        let partner = Partner { source, registration, weight: &half };
        registered_blend(&a, &[partner]).unwrap()
    };
    // The clocks advance by their mean: 280 and 240 frames make 260, 280 and 330 make 305.
    for (out, frames) in [(blend(&b, &to_b), 260), (blend(&c, &to_c), 305)] {
        assert!(out.clip.frames().abs_diff(frames) <= 1, "{}", out.clip.frames());
        // The legs swing in step in all clips, so that the amplitude of the blend is the mean of
        // theirs.
        let swing = |clip: &Clip| {
            (0..clip.frames())
                .map(|frame| quat::log(clip.rotations(frame)[7]).x)
                .fold(0.0, f32::max)
        };
        assert!(swing(&out.clip) > 0.38, "{}", swing(&out.clip));
        for pair in out.frames.windows(2) {
            assert!(
                pair[0].shift.distance(pair[1].shift) < 0.04,
                "no step is longer than the longest of the clips"
            );
        }
    }
}

#[test]
fn registered_join_is_all_a_then_all_b() {
    let [a, b, _] = walks();
    let registration = register(&a, &b);
    let join = registered_join(&a, &b, &registration, 80, 200, WeightLaw::Smooth).unwrap();
    let (out, transition) = (&join.joined.clip, join.joined.transition.clone());
    assert_eq!(transition.start, 80);
    for frame in 0..=80 {
        assert!(apart(out, frame, a.clip(), frame, &Planar::IDENTITY) < 1e-5);
    }
    let last = join.during.last().unwrap();
    let enter = last.frames[1].round() as usize;
    assert!(
        (last.frames[1] - enter as f64).abs() < 1e-6,
        "B is met in a frame of its own: {}",
        last.frames[1]
    );
    assert_eq!(last.weights, [0.0, 1.0]);
    assert_eq!(out.frames(), transition.end + b.clip().frames() - enter - 1);
    for (frame, in_b) in (transition.end - 1..out.frames()).zip(enter..) {
        assert!(apart(out, frame, b.clip(), in_b, &join.joined.world_from_b) < 1e-4, "{frame}");
    }
    // Clocks run at their own speed, except for the rounding to a whole last frame.
    for pair in join.during.windows(2) {
        let step = |k: usize| pair[1].frames[k] - pair[0].frames[k];
        let mean = 0.5
            * (step(0) * (pair[0].weights[0] + pair[1].weights[0])
                + step(1) * (pair[0].weights[1] + pair[1].weights[1]));
        assert!((mean - 1.0).abs() < 0.02, "{mean}");
    }
    for pair in join.joined.frames.windows(2) {
        assert!(
            pair[0].shift.distance(pair[1].shift) < 0.04
                && wrap_angle(pair[1].yaw - pair[0].yaw).abs() < 0.05
        );
    }
    assert!(transition.contains(&join.joined.handover));
    let contacts = |source: &Motion| {
        let flags: Vec<bool> = (0..source.clip().frames()).map(|frame| frame % 40 < 20).collect();
        Contacts::from_flags([flags.clone(), flags])
    };
    assert_eq!(join.contacts(&contacts(&a), &contacts(&b)).frames(), out.frames());
}

#[test]
fn registered_blend_of_unregistered_clips_is_refused() {
    let [a, b, _] = walks();
    let registration = register(&a, &b);
    for (leave, arrive) in [(200, 200), (279, 400), (5000, 6000), (100, 50)] {
        assert!(
            matches!(
                registered_join(&a, &b, &registration, leave, arrive, WeightLaw::Linear),
                Err(BlendError::NothingInCommon { .. })
            ),
            "{leave} {arrive}"
        );
    }
    let other = source(Walk { fps: 30.0, ..Walk::default() });
    let half = WeightCurve::constant(0.5);
    let partner = Partner { source: &other, registration: &registration, weight: &half };
    assert!(matches!(registered_blend(&a, &[partner]), Err(BlendError::FrameRates { .. })));
    let all = registered_blend(&a, &[]).unwrap();
    assert_eq!(all.clip.frames(), a.clip().frames());
}
