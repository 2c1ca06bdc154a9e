use super::*;
use crate::registration::fixtures::Walk;
use crate::registration::{align, limb_weights};
use proptest::prelude::*;

fn pair() -> (Clip, Clip) {
    let a = Walk {
        frames: 67,
        turning: 0.7,
        start: (30.0, -12.0),
        ..Walk::default()
    }
    .clip();
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

fn sums(a: &Clip, b: &Clip, stride: usize) -> PairSums {
    let mut sums = PairSums::new(a, 0..a.frames(), b, 0..b.frames(), &limb_weights(a.skeleton()), stride).unwrap();
    sums.finish();
    sums
}

#[test]
fn equals_the_definition_at_every_window() {
    let (a, b) = pair();
    for stride in [1, 3] {
        let sums = sums(&a, &b, stride);
        for window in [1, 2, 5, 30, 53] {
            let fast = sums.distances(window, &(10..67), &(0..40)).unwrap();
            let slow = sums.distances_directly(window, &(10..67), &(0..40)).unwrap();
            assert_eq!(
                (fast.rows(), fast.columns(), fast.frames(0, 0)),
                (slow.rows(), slow.columns(), slow.frames(0, 0))
            );
            assert!(fast.rows() > 0);
            for (fast, slow) in fast.rms_m().iter().zip(slow.rms_m()) {
                assert!((fast - slow).abs() < 1e-6, "{fast} {slow}");
            }
        }
    }
}

#[test]
fn equals_aligning_the_point_clouds() {
    let (a, b) = pair();
    let (sums, weights) = (sums(&a, &b, 1), limb_weights(a.skeleton()));
    let grid = sums.distances(9, &(0..67), &(0..53)).unwrap();
    assert_eq!((grid.rows(), grid.columns()), (67 - 9 + 1, 53 - 9 + 1));
    for (i, j) in [(0, 0), (17, 31), (58, 44)] {
        let clouds = align(&a.world_positions(i..i + 9), &b.world_positions(j..j + 9), &weights, 0.0).unwrap();
        let cached = sums.alignment(i, j, 9, 0.0).unwrap();
        assert!((f64::from(grid.get(i, j).unwrap()) - clouds.rms_m()).abs() < 1e-6);
        assert!((cached.distance - clouds.distance).abs() < 1e-9);
        assert!((cached.transform.yaw - clouds.transform.yaw).abs() < 1e-7);
        assert!((cached.transform.shift - clouds.transform.shift).length() < 1e-6);
    }
}

#[test]
fn slices_add_up_to_the_whole() {
    let (a, b) = pair();
    let whole = sums(&a, &b, 2);
    let mut sliced = PairSums::new(&a, 0..67, &b, 0..53, &limb_weights(a.skeleton()), 2).unwrap();
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
}

#[test]
fn a_band_gives_what_the_whole_gives() {
    let (a, b) = pair();
    let weights = limb_weights(a.skeleton());
    let mut banded = PairSums::banded(&a, 20..20 + 6 + 24, &b, 8..8 + 6 + 24, &weights, 1, 6).unwrap();
    banded.finish();
    let (rows, columns) = (20..26, 8..14);
    let near = banded.distances(25, &rows, &columns).unwrap();
    let all = sums(&a, &b, 1).distances(25, &rows, &columns).unwrap();
    assert_eq!((near.rows(), near.columns()), (6, 6));
    for (near, all) in near.rms_m().iter().zip(all.rms_m()) {
        assert!((near - all).abs() < 1e-6);
    }
}

#[test]
fn a_clip_against_itself_is_zero_on_the_diagonal() {
    let a = Walk {
        start: (80.0, 3.0),
        ..Walk::default()
    }
    .clip();
    let grid = sums(&a, &a, 1).distances(12, &(0..120), &(0..120)).unwrap();
    for i in 0..grid.rows() {
        assert!(grid.get(i, i).unwrap() < 1e-5, "{:?}", grid.get(i, i));
    }
}

#[test]
fn windows_never_cross_an_end() {
    let (a, b) = pair();
    let sums = sums(&a, &b, 4);
    for window in [1, 4, 5, 52, 53, 54, 1000] {
        let grid = sums.distances(window, &(0..1000), &(0..1000)).unwrap();
        if window > 53 {
            assert!(grid.rms_m().is_empty() && grid.minimum().is_none() && grid.local_minima().is_empty());
        } else {
            let (i, j) = grid.frames(grid.rows() - 1, grid.columns() - 1);
            assert!(i + window <= 67 && j + window <= 53);
            assert!(i + window + 4 > 67 && j + window + 4 > 53, "nothing that fits is left out");
        }
    }
}

proptest! {
    #[test]
    fn moving_a_clip_over_the_ground_changes_no_distance(yaw in -3.0f64..3.0, x in -50.0f64..50.0, z in -50.0f64..50.0) {
        let (a, b) = pair();
        let moved = b.transformed(&crate::math::Planar::new(yaw, x, z));
        let all = 0..67;
        let (still, moved) = (sums(&a, &b, 2).distances(7, &all, &all).unwrap(), sums(&a, &moved, 2).distances(7, &all, &all).unwrap());
        for (still, moved) in still.rms_m().iter().zip(moved.rms_m()) {
            prop_assert!((still - moved).abs() < 2e-5, "{still} {moved}");
        }
    }
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let (a, b) = pair();
    let weights = limb_weights(a.skeleton());
    assert_eq!(
        PairSums::new(&a, 70..80, &b, 0..5, &weights, 1).unwrap_err(),
        RegistrationError::Empty { which: "outgoing" }
    );
    assert_eq!(
        PairSums::new(&a, 0..5, &b, 5..5, &weights, 1).unwrap_err(),
        RegistrationError::Empty { which: "incoming" }
    );
    assert!(matches!(
        PairSums::new(&a, 0..5, &b, 0..5, &weights[1..], 1),
        Err(RegistrationError::Weights { .. })
    ));
    let sums = sums(&a, &b, 1);
    assert!(matches!(
        sums.alignment(60, 0, 9, 0.0),
        Err(RegistrationError::TooShort { which: "outgoing", .. })
    ));
}
