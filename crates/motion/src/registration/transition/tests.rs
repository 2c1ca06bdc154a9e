//! Tests of the transition search.

use super::*;
use crate::registration::fixtures::Walk;
use crate::registration::{limb_weights, uniform_weights};

/// Returns the smallest distance over all pairs of frames in the regions, at the full rate.
fn brute_force(a: &Clip, b: &Clip, weights: &[f64], options: &SearchOptions) -> f64 {
    let (leave, _) = options.leave.starts(a.frames(), options.window).unwrap();
    let (enter, _) = options.enter.starts(b.frames(), options.window).unwrap();
    let mut terms = PairTerms::new(a, 0..a.frames(), b, 0..b.frames(), weights, 1).unwrap();
    terms.finish();
    let matrix = terms.distances(options.window, &leave, &enter).unwrap();
    let (r, c) = matrix.minimum().unwrap();
    f64::from(matrix.get(r, c).unwrap())
}

#[test]
fn best_transition_is_close_to_the_best_of_all_pairs() {
    for (frames, fps, window) in [
        (240, 60.0, 20),
        (240, 120.0, 5),
        (900, 120.0, 30),
        (900, 120.0, 120),
        (1300, 240.0, 60),
        (100, 30.0, 8),
    ] {
        for (cadence, turning) in [(1.25, 0.0), (0.7, 0.9), (0.93, -0.4)] {
            let a = Arc::new(Walk { frames, fps, start: (4.0, 9.0), ..Walk::default() }.clip());
            let b = Arc::new(
                Walk {
                    frames: frames * 3 / 4,
                    fps,
                    cadence,
                    turning,
                    swing: 0.6,
                    speed: 1.9,
                    heading: 2.5,
                    ..Walk::default()
                }
                .clip(),
            );
            let weights = limb_weights(a.skeleton());
            let options = SearchOptions::new(window);
            let found = best_transition(&a, &b, &weights, 1.75, &options).unwrap();
            let best = brute_force(&a, &b, &weights, &options);
            let rms = found.alignment.rms_m();
            assert!(rms >= best - 1e-5);
            assert!(
                rms <= (best * 1.05).max(best + 0.002),
                "{frames} {fps} {window} {cadence}: {rms} against {best}"
            );
            assert!(found.leave >= frames / 2 && found.leave + window <= frames);
            assert!(found.enter <= b.frames() / 2 && found.enter + window <= b.frames());
            assert!(!found.grown);
        }
    }
}

#[test]
fn best_transition_of_long_clips_is_refined_in_two_passes() {
    let a = Arc::new(Walk { frames: 8_000, fps: 60.0, ..Walk::default() }.clip());
    let b = Arc::new(
        Walk { frames: 7_000, fps: 60.0, phase: 0.21, heading: 1.0, ..Walk::default() }.clip(),
    );
    let weights = uniform_weights(a.skeleton());
    let found = best_transition(&a, &b, &weights, 1.75, &SearchOptions::new(30)).unwrap();
    // The same walk with another phase and heading: only a fraction of a frame is left.
    assert!(found.rms_cm < 1.0, "{found:?}");
}

#[test]
fn best_transition_into_a_continuation_is_its_frame() {
    let whole = Walk { frames: 300, fps: 60.0, turning: 0.5, ..Walk::default() }.clip();
    let a = Arc::new(whole.crop(0..180).unwrap());
    let moved = crate::math::Planar::new(1.9, -3.0, 8.0);
    let b = Arc::new(whole.crop(140..300).unwrap().transformed(&moved));
    // Frame f of the whole is frame f - 140 of b; windows of 25 frames fit up to frame 155 of a.
    let found = best_transition(
        &a,
        &b,
        &limb_weights(a.skeleton()),
        1.75,
        &SearchOptions { window: 25, leave: Region::SECOND_HALF, enter: Region::FIRST_HALF },
    );
    let found = found.unwrap();
    assert_eq!(found.leave, found.enter + 140, "{found:?}");
    assert!(found.rms_cm < 1e-3);
    assert!((found.alignment.transform.yaw - moved.inverse().yaw).abs() < 1e-4);
    assert!((found.alignment.transform.shift - moved.inverse().shift).length() < 1e-3);
}

#[test]
fn best_transition_of_short_clips_grows_the_region_or_is_refused() {
    let a = Arc::new(Walk { frames: 40, ..Walk::default() }.clip());
    let b = Arc::new(Walk { frames: 30, cadence: 1.1, ..Walk::default() }.clip());
    let weights = limb_weights(a.skeleton());
    // In the second half of a, no window of 25 frames ends before the clip does.
    let found = best_transition(&a, &b, &weights, 1.75, &SearchOptions::new(25)).unwrap();
    assert!(found.grown && found.leave + 25 <= 40 && found.enter + 25 <= 30);
    assert!(!best_transition(&a, &b, &weights, 1.75, &SearchOptions::new(20)).unwrap().grown);
    let error = best_transition(&a, &b, &weights, 1.75, &SearchOptions::new(31)).unwrap_err();
    assert_eq!(error, RegistrationError::TooShort { which: "incoming", frames: 30, window: 31 });
    assert!(error.to_string().contains("lower the window to 30"));
    assert_eq!(
        best_transition(&a, &b, &weights, 1.75, &SearchOptions::new(0)).unwrap().alignment.weight,
        1.0
    );
}

#[test]
fn regions_of_any_numbers_are_clamped() {
    for (from, to) in
        [(f64::NAN, f64::NAN), (2.0, -1.0), (0.3, 0.3), (-1.0, f64::INFINITY), (0.999, 1.0)]
    {
        let (starts, _) = Region { from, to }.starts(50, 10).unwrap();
        assert!(!starts.is_empty() && starts.end <= 41, "{from} {to} {starts:?}");
    }
    assert_eq!(Region::ALL.starts(0, 1), None);
    assert_eq!(Region::SECOND_HALF.starts(50, 10), Some((25..41, false)));
    assert_eq!(Region::FIRST_HALF.starts(50, 10), Some((0..25, false)));
}

#[test]
fn best_transition_of_incompatible_clips_is_refused() {
    let a = Arc::new(Walk::default().clip());
    let b = Arc::new(Walk { fps: 30.0, ..Walk::default() }.clip());
    let weights = limb_weights(a.skeleton());
    assert!(matches!(
        best_transition(&a, &b, &weights, 1.75, &SearchOptions::new(5)),
        Err(RegistrationError::FrameRates { .. })
    ));
    let search = TransitionSearch::new(Arc::clone(&a), Arc::clone(&a), &weights, 1.75).unwrap();
    assert!(matches!(
        search.best(&SearchOptions::new(5)),
        Err(RegistrationError::Unfinished { done: 0, .. })
    ));
}

#[test]
fn best_transition_at_a_fixed_frame_near_the_end_shortens_the_window() {
    let walk = |cadence| {
        let walk = Walk { frames: 60, cadence, ..Walk::default() };
        Arc::new(walk.clip())
    };
    let (a, b) = (walk(1.0), walk(1.2));
    let weights = limb_weights(a.skeleton());
    let asked = SearchOptions::new(25);
    for leave in [10, 35, 36, 50, 58, 59] {
        let options = asked.leaving_at(leave, a.frames());
        assert_eq!(options.window, 25.min(60 - leave));
        let found = best_transition(&a, &b, &weights, 1.75, &options).unwrap();
        assert_eq!((found.leave, found.grown), (leave, false));
        let alignment = exact(&a, leave, &b, found.enter, options.window, &weights).unwrap();
        let rms = rms_cm(alignment.distance, alignment.weight, 1.75);
        assert!((found.rms_cm - rms).abs() < 1e-6, "{leave}: {} against {rms}", found.rms_cm);
        let both = options.entering_at(55, b.frames());
        assert_eq!(both.window, 5.min(60 - leave));
        let found = best_transition(&a, &b, &weights, 1.75, &both).unwrap();
        assert_eq!((found.leave, found.enter, found.grown), (leave, 55, false));
    }
    // A frame beyond the end counts as the last.
    assert_eq!(asked.leaving_at(90, 60), asked.leaving_at(59, 60));
}
