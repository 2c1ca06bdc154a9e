//! Tests of pair terms and sweeps against the definition.

use super::*;
use crate::registration::fixtures::Walk;
use crate::registration::limb_weights;
use glam::{Quat, Vec3};
use proptest::prelude::*;
use std::f32::consts::{FRAC_PI_2, TAU};

fn pair() -> (Clip, Clip) {
    let a = Walk { frames: 67, turning: 0.7, start: (30.0, -12.0), ..Walk::default() }.clip();
    let b = Walk {
        frames: 53,
        speed: 2.0,
        cadence: 1.3,
        swing: 0.7,
        phase: 0.3,
        heading: 2.0,
        ..Walk::default()
    }
    .clip();
    (a, b)
}

fn terms(a: &Clip, b: &Clip, stride: usize) -> PairTerms {
    let mut terms =
        PairTerms::new(a, 0..a.frames(), b, 0..b.frames(), &limb_weights(a.skeleton()), stride)
            .unwrap();
    terms.finish();
    terms
}

/// The greatest error of the mean squared distance per point in these clips, m². Harder poses may
/// reach 4e-7, the bound that is documented.
const BOUND: f64 = 3e-7;

fn near(fast: f32, slow: f32) -> bool {
    (f64::from(fast).powi(2) - f64::from(slow).powi(2)).abs() < BOUND
}

#[test]
fn distances_agree_with_the_definition() {
    let (a, b) = pair();
    for stride in [1, 3] {
        let terms = terms(&a, &b, stride);
        for window in [1, 2, 5, 30, 53] {
            let fast = terms.distances(window, &(0..67), &(0..53)).unwrap();
            let slow = distances_directly(
                (&a, 0..67),
                (&b, 0..53),
                &limb_weights(a.skeleton()),
                window,
                stride,
            )
            .unwrap();
            assert_eq!(
                (fast.rows(), fast.columns(), fast.frames(0, 0)),
                (slow.rows(), slow.columns(), slow.frames(0, 0))
            );
            assert!(fast.rows() > 0);
            for (&fast, &slow) in fast.rms_m().iter().zip(slow.rms_m()) {
                assert!(near(fast, slow), "{fast} {slow}");
            }
            let part = terms.distances(window, &(10..40), &(7..31)).unwrap();
            for (row, column) in (0..part.rows())
                .flat_map(|row| (0..part.columns()).map(move |column| (row, column)))
            {
                let (i, j) = part.frames(row, column);
                let whole = fast.get(i / stride, j / stride).unwrap();
                assert!((part.get(row, column).unwrap() - whole).abs() < 1e-6);
            }
        }
    }
}

#[test]
fn distance_of_a_pose_and_the_same_turned_is_within_the_bound() {
    let (walk, directions) = (Walk::default().clip(), 48);
    for lying in [false, true] {
        let poses = (0..directions).map(|step| {
            let turn = Quat::from_rotation_y(step as f32 * TAU / directions as f32);
            let hips = if lying { Quat::from_rotation_x(FRAC_PI_2) } else { Quat::IDENTITY };
            let mut pose = walk.pose(7);
            pose.rotations[0] = turn * hips * pose.rotations[0];
            pose.root_translation = turn * Vec3::new(0.3, 0.9, -0.2);
            pose
        });
        let skeleton = Arc::clone(walk.skeleton());
        let clip = Clip::from_poses("turned", skeleton, 30.0, poses).unwrap();
        let found = terms(&clip, &clip, 1).distances(1, &(0..directions), &(0..directions));
        for (at, &distance) in found.unwrap().rms_m().iter().enumerate() {
            assert!(near(distance, 0.0), "{lying} {at}: {distance}");
            // Nothing is left but the rounding of running sums.
            assert!(at % (directions + 1) > 0 || distance < 1e-7, "itself: {distance}");
        }
    }
}

/// 1.6 km from the origin, at walking pace for minutes: the centres are large, and the remaining
/// distances are not.
#[test]
fn distances_far_from_the_origin_keep_their_digits() {
    let walk =
        Walk { frames: 400, fps: 10.0, start: (1600.0, -900.0), speed: 3.0, ..Walk::default() };
    let a = walk.clip();
    let b = Walk { cadence: 0.91, start: (-3.0, 0.0), ..walk }.clip();
    let fast = terms(&a, &b, 1).distances(4, &(0..400), &(0..400)).unwrap();
    let slow =
        distances_directly((&a, 0..400), (&b, 0..400), &limb_weights(a.skeleton()), 4, 1).unwrap();
    // The positions themselves are rounded to a tenth of a millimetre there.
    for (&fast, &slow) in fast.rms_m().iter().zip(slow.rms_m()) {
        assert!(near(fast, slow), "{fast} {slow}");
    }
}

#[test]
fn alignment_agrees_with_that_of_the_point_clouds() {
    let (a, b) = pair();
    let (terms, weights) = (terms(&a, &b, 1), limb_weights(a.skeleton()));
    let matrix = terms.distances(9, &(0..67), &(0..53)).unwrap();
    assert_eq!((matrix.rows(), matrix.columns()), (67 - 9 + 1, 53 - 9 + 1));
    for (i, j) in [(0, 0), (17, 31), (58, 44)] {
        let clouds =
            align(&a.world_positions(i..i + 9), &b.world_positions(j..j + 9), &weights, 0.0)
                .unwrap();
        let cached = terms.alignment(i, j, 9, 0.0).unwrap();
        assert!(near(matrix.get(i, j).unwrap(), clouds.rms_m() as f32));
        assert!((cached.distance - clouds.distance).abs() < BOUND * cached.weight);
        assert!((cached.transform.yaw - clouds.transform.yaw).abs() < 2e-7);
        assert!((cached.transform.shift - clouds.transform.shift).length() < 1e-6);
    }
}

#[test]
fn sweep_in_slices_equals_the_whole() {
    let (a, b) = pair();
    let whole = terms(&a, &b, 2);
    let mut sliced = PairTerms::new(&a, 0..67, &b, 0..53, &limb_weights(a.skeleton()), 2).unwrap();
    assert_eq!(
        sliced.distances(5, &(0..67), &(0..53)),
        Err(RegistrationError::Unfinished { done: 0, total: 34 })
    );
    let mut calls = 0;
    while !sliced.advance(4).is_complete() {
        calls += 1;
    }
    assert_eq!(calls, 8);
    assert_eq!(
        sliced.distances(5, &(0..67), &(0..53)).unwrap(),
        whole.distances(5, &(0..67), &(0..53)).unwrap()
    );
    let mut sweep = whole.sweep(5, &(0..67), &(0..53)).unwrap();
    let rows = sweep.advance(7);
    // A sweep may stop borrowing the terms in between.
    let paused = sweep.pause();
    assert_eq!((paused.progress(), paused.window()), (rows, 5));
    let sweep = paused.resume(&whole);
    assert_eq!((rows.done, rows.is_complete()), (7, false));
    assert_eq!(sweep.finish(), whole.distances(5, &(0..67), &(0..53)).unwrap());
}

#[test]
fn banded_terms_agree_with_all_terms() {
    let (a, b) = pair();
    let weights = limb_weights(a.skeleton());
    let mut banded =
        PairTerms::banded(&a, 20..20 + 6 + 24, &b, 8..8 + 6 + 24, &weights, 1, 6).unwrap();
    banded.finish();
    let (rows, columns) = (20..26, 8..14);
    let near = banded.distances(25, &rows, &columns).unwrap();
    let all = terms(&a, &b, 1).distances(25, &rows, &columns).unwrap();
    assert_eq!((near.rows(), near.columns()), (6, 6));
    for (banded, all) in near.rms_m().iter().zip(all.rms_m()) {
        assert!((banded - all).abs() < 1e-6);
    }
}

#[test]
fn distances_of_a_clip_with_itself_are_zero_on_the_diagonal() {
    let a = Walk { start: (80.0, 3.0), ..Walk::default() }.clip();
    let matrix = terms(&a, &a, 1).distances(12, &(0..120), &(0..120)).unwrap();
    for i in 0..matrix.rows() {
        assert!(matrix.get(i, i).unwrap() < 1e-5, "{:?}", matrix.get(i, i));
    }
}

#[test]
fn distances_of_windows_never_cross_an_end() {
    let (a, b) = pair();
    let terms = terms(&a, &b, 4);
    for window in [1, 4, 5, 52, 53, 54, 1000] {
        let matrix = terms.distances(window, &(0..1000), &(0..1000)).unwrap();
        if window > 53 {
            assert!(
                matrix.rms_m().is_empty()
                    && matrix.minimum().is_none()
                    && matrix.local_minima().is_empty()
            );
        } else {
            let (i, j) = matrix.frames(matrix.rows() - 1, matrix.columns() - 1);
            assert!(i + window <= 67 && j + window <= 53);
            assert!(i + window + 4 > 67 && j + window + 4 > 53, "nothing that fits is left out");
        }
    }
}

proptest! {
    #[test]
    fn distances_do_not_depend_on_the_ground_position(
        yaw in -3.0f64..3.0,
        x in -50.0f64..50.0,
        z in -50.0f64..50.0,
    ) {
        let (a, b) = pair();
        let moved = b.transformed(&crate::math::Planar::new(yaw, x, z));
        let all = 0..67;
        let (still, moved) = (
            terms(&a, &b, 2).distances(7, &all, &all).unwrap(),
            terms(&a, &moved, 2).distances(7, &all, &all).unwrap(),
        );
        for (still, moved) in still.rms_m().iter().zip(moved.rms_m()) {
            // The moved positions are rounded too.
            prop_assert!((still - moved).abs() < 2e-5, "{still} {moved}");
        }
    }
}

#[test]
fn pair_terms_of_incompatible_clips_are_refused() {
    let (a, b) = pair();
    let weights = limb_weights(a.skeleton());
    assert_eq!(
        PairTerms::new(&a, 70..80, &b, 0..5, &weights, 1).unwrap_err(),
        RegistrationError::Empty { which: "outgoing" }
    );
    assert_eq!(
        PairTerms::new(&a, 0..5, &b, 5..5, &weights, 1).unwrap_err(),
        RegistrationError::Empty { which: "incoming" }
    );
    assert!(matches!(
        PairTerms::new(&a, 0..5, &b, 0..5, &weights[1..], 1),
        Err(RegistrationError::Weights { .. })
    ));
    let long = Walk { frames: 9000, ..Walk::default() }.clip();
    assert!(matches!(
        PairTerms::new(&long, 0..9000, &long, 0..9000, &weights, 1),
        Err(RegistrationError::TooManyPairs { stride: 3, .. })
    ));
    assert!(PairTerms::new(&long, 0..9000, &long, 0..9000, &weights, 3).is_ok());
    let terms = terms(&a, &b, 1);
    assert!(matches!(
        terms.alignment(60, 0, 9, 0.0),
        Err(RegistrationError::TooShort { which: "outgoing", .. })
    ));
}
