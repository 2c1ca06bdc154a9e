//! Tests of time warps and alignment curves.

use super::*;
use crate::clip::Clip;
use crate::clip::fixtures::{points_clip, points_skeleton};
use crate::registration::fixtures::Walk;
use crate::registration::limb_weights;

use proptest::prelude::*;
use std::f64::consts::PI;

fn registered(a: &Clip, b: &Clip, window: usize, options: &RegistrationOptions) -> Registration {
    let mut terms =
        PairTerms::new(a, 0..a.frames(), b, 0..b.frames(), &limb_weights(a.skeleton()), 1).unwrap();
    terms.finish();
    let matrix = terms.distances(window, &(0..a.frames()), &(0..b.frames())).unwrap();
    Registration::new(&terms, &matrix, options).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    /// The path has any steps, and pins anywhere on it.
    #[test]
    fn time_warp_increases_through_its_fixed_points(
        steps in prop::collection::vec(0u8..3, 1..80),
        pins in prop::collection::vec(0usize..80, 0..4),
        smoothing in 0.0f64..20.0,
    ) {
        let mut path = vec![(0.0, 0.0)];
        for step in steps {
            let &(i, j) = path.last().unwrap();
            path.push(match step {
                0 => (i + 1.0, j),
                1 => (i, j + 1.0),
                _ => (i + 1.0, j + 1.0),
            });
        }
        let last = path.len() - 1;
        prop_assume!(path[last].0 > 0.0 && path[last].1 > 0.0);
        let mut at: Vec<usize> = pins.into_iter().filter(|&pin| pin > 0 && pin < last).collect();
        at.sort_unstable();
        let mut fixed = vec![path[0]];
        for pin in at {
            let before = fixed[fixed.len() - 1];
            if path[pin].0 > before.0
                && path[pin].1 > before.1
                && path[pin].0 < path[last].0
                && path[pin].1 < path[last].1
            {
                fixed.push(path[pin]);
            }
        }
        fixed.push(path[last]);
        let warp = time_warp(&path, &fixed, smoothing).unwrap();
        for &(i, j) in &fixed {
            prop_assert!((warp.at(i) - j).abs() < 1e-9);
        }
        let points: Vec<_> = warp.points().collect();
        for pair in points.windows(2) {
            prop_assert!(pair[1].0 > pair[0].0 && pair[1].1 > pair[0].1, "{pair:?}");
        }
    }
}

/// The warp of a walk registered to itself at another playback speed has that slope.
#[test]
fn warp_of_a_slower_clip_has_its_speed() {
    let (fast, slow) = (
        Walk { frames: 150, cadence: 0.9, ..Walk::default() }.clip(),
        Walk { frames: 200, cadence: 0.9 * 0.75, speed: 1.3 * 0.75, ..Walk::default() }.clip(),
    );
    let found = registered(&fast, &slow, 5, &RegistrationOptions::new(60.0));
    let warp = found.warp();
    assert_eq!((warp.first(), warp.last()), ((0.0, 0.0), (149.0, 199.0)));
    for frame in 10..140 {
        let (at, wanted) = (warp.at(f64::from(frame)), f64::from(frame) / 0.75);
        assert!((at - wanted).abs() < 1.5, "{frame}: {at} {wanted}");
        assert!(
            (0.9..1.9).contains(&warp.slope(f64::from(frame))),
            "{frame} {}",
            warp.slope(f64::from(frame))
        );
    }
    assert!(found.path().mean_m < 0.01, "{}", found.path().mean_m);
}

/// One character walks straight on, the other in circles. The yaw between them grows over whole
/// turns, and the transform aligns one with the other everywhere.
#[test]
fn alignment_of_a_circling_clip_is_unwrapped() {
    let straight = Walk { frames: 500, ..Walk::default() }.clip();
    let circling =
        Walk { frames: 500, turning: 1.5, start: (300.0, -200.0), heading: 2.0, ..Walk::default() }
            .clip();
    let found = registered(&straight, &circling, 5, &RegistrationOptions::new(60.0));
    let mut before = found.alignment_at(0.0).yaw;
    let begin = before;
    for step in 1..=998 {
        let frame = f64::from(step) / 2.0;
        let here = found.alignment_at(frame);
        assert!((here.yaw - before).abs() < 0.1, "{frame}: {before} {}", here.yaw);
        before = here.yaw;
        if step % 2 == 0 && frame > 15.0 && frame < 485.0 {
            let in_b = found.warp().at(frame).round() as usize;
            let off = here.apply(circling.root_translations()[in_b])
                - straight.root_translations()[frame as usize];
            assert!(off.length() < 0.06, "{frame}: {off}");
        }
    }
    let turned = before - begin;
    assert!((turned + 1.5 * 499.0 / 60.0).abs() < 0.4, "{turned}");
    assert!(turned.abs() > 2.0 * PI);
}

#[test]
fn warp_with_pins_passes_through_them() {
    let walk = Walk { frames: 160, ..Walk::default() }.clip();
    let mut options = RegistrationOptions::new(60.0);
    options.path.pins = vec![(60, 75)];
    let found = registered(&walk, &walk, 5, &options);
    assert!((found.warp().at(62.0) - 77.0).abs() < 1e-9);
    options.path.pins.push((70, 71));
    let terms = {
        let mut terms =
            PairTerms::new(&walk, 0..160, &walk, 0..160, &limb_weights(walk.skeleton()), 1)
                .unwrap();
        terms.finish();
        terms
    };
    let matrix = terms.distances(5, &(0..160), &(0..160)).unwrap();
    assert!(matches!(Registration::new(&terms, &matrix, &options), Err(PathError::Pins { .. })));
}

/// The warp of a clip registered to its moved copy is the identity, and the alignment is the
/// inverse transform.
#[test]
fn alignment_of_a_moved_clip_is_the_inverse_transform() {
    let walk = Walk { frames: 120, turning: 0.8, ..Walk::default() }.clip();
    let there = Planar::new(2.5, 40.0, -7.0);
    let found = registered(&walk, &walk.transformed(&there), 9, &RegistrationOptions::new(60.0));
    for frame in 0..120 {
        let frame = f64::from(frame);
        assert!((found.warp().at(frame) - frame).abs() < 1e-9);
        let still = found.alignment_at(frame).after(&there);
        assert!(still.yaw.abs() < 1e-4 && still.shift.length() < 1e-2, "{frame} {still:?}");
    }
}

#[derive(serde::Deserialize)]
struct Golden {
    source: Vec<Vec<[f32; 3]>>,
    target: Vec<Vec<[f32; 3]>>,
    weights: Vec<f64>,
    windows: Vec<GoldenWindow>,
}

#[derive(serde::Deserialize)]
struct GoldenWindow {
    window: usize,
    rms_m: Vec<Vec<f32>>,
    at_5_9: [f64; 3],
    paths: Vec<GoldenPath>,
}

#[derive(serde::Deserialize)]
struct GoldenPath {
    slope_limit: usize,
    cells: Vec<(usize, usize)>,
    mean_m: f64,
    warps: Vec<GoldenWarp>,
}

#[derive(serde::Deserialize)]
struct GoldenWarp {
    smoothing: usize,
    at_frames: Vec<f64>,
}

/// The bound of the error of the mean squared distance per point, m².
const BOUND: f64 = 3e-7;

#[test]
fn matrix_path_and_warp_agree_with_scipy() {
    let golden: Golden =
        serde_json::from_str(include_str!("../../../tests/oracles/registration.json")).unwrap();
    let skeleton = points_skeleton(golden.source[0].len());
    let (source, target) = (
        points_clip(&skeleton, 30.0, &golden.source),
        points_clip(&skeleton, 30.0, &golden.target),
    );
    let mut terms = PairTerms::new(&source, 0..24, &target, 0..30, &golden.weights, 1).unwrap();
    terms.finish();
    for case in &golden.windows {
        let matrix = terms.distances(case.window, &(0..24), &(0..30)).unwrap();
        assert_eq!((matrix.rows(), matrix.columns()), (case.rms_m.len(), case.rms_m[0].len()));
        for (row, wanted) in case.rms_m.iter().enumerate() {
            for (found, wanted) in matrix.row(row).iter().zip(wanted) {
                let [found, wanted] = [found, wanted].map(|of| f64::from(*of).powi(2));
                assert!((found - wanted).abs() < BOUND, "{found} {wanted}");
            }
        }
        let found = terms.alignment(5, 9, case.window, 0.0).unwrap().transform;
        for (found, wanted) in
            [found.yaw, found.shift.x, found.shift.y].into_iter().zip(case.at_5_9)
        {
            assert!((found - wanted).abs() < 1e-5, "{found} {wanted}");
        }
        for path in &case.paths {
            for warp in &path.warps {
                let options = RegistrationOptions {
                    path: PathOptions { slope_limit: path.slope_limit, ..PathOptions::default() },
                    smoothing: warp.smoothing,
                };
                let found = Registration::new(&terms, &matrix, &options).unwrap();
                assert_eq!(found.path().cells, path.cells);
                // One cell may be of equal windows.
                let within = BOUND.sqrt() / path.cells.len() as f64;
                assert!((found.path().mean_m - path.mean_m).abs() < within);
                for (frame, &wanted) in warp.at_frames.iter().enumerate() {
                    let at = found.warp().at(frame as f64);
                    // The straightening is known to 1e-5 there.
                    assert!(
                        (at - wanted).abs() < 1e-3,
                        "{} {frame}: {at} {wanted}",
                        warp.smoothing
                    );
                }
            }
        }
    }
}
