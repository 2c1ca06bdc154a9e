//! Tests of the alignment of point clouds.

use super::*;
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

#[derive(serde::Deserialize)]
struct Golden {
    cases: Vec<Case>,
}

#[derive(serde::Deserialize)]
struct Case {
    weights: Vec<f64>,
    source: Vec<Vec3>,
    target: Vec<Vec3>,
    yaw: f64,
    x0: f64,
    z0: f64,
    distance: f64,
}

fn cost(transform: &Planar, source: &[Vec3], target: &[Vec3], weights: &[f64]) -> f64 {
    let (sin, cos) = transform.yaw.sin_cos();
    let points = source.iter().zip(target).enumerate();
    points
        .map(|(index, (p, q))| {
            let (p, q) = (p.as_dvec3(), q.as_dvec3());
            let image = DVec3::new(
                q.x * cos + q.z * sin + transform.shift.x,
                q.y,
                -q.x * sin + q.z * cos + transform.shift.y,
            );
            weights[index % weights.len()] * (p - image).length_squared()
        })
        .sum()
}

/// Returns the best of `steps` yaws, each with its best shift: the difference of the weighted
/// means.
fn by_grid_search(source: &[Vec3], target: &[Vec3], weights: &[f64], steps: usize) -> f64 {
    let weight = |index: usize| weights[index % weights.len()];
    let total: f64 = (0..source.len()).map(weight).sum();
    let mean = |points: &[Vec3]| {
        points.iter().enumerate().map(|(index, p)| weight(index) * p.as_dvec3()).sum::<DVec3>()
            / total
    };
    let (p, q) = (mean(source), mean(target));
    (0..steps)
        .map(|step| {
            let yaw = TAU * step as f64 / steps as f64 - PI;
            let (sin, cos) = yaw.sin_cos();
            let shift = DVec2::new(p.x - (q.x * cos + q.z * sin), p.z - (-q.x * sin + q.z * cos));
            cost(&Planar { yaw, shift }, source, target, weights)
        })
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn align_agrees_with_least_squares() {
    let golden: Golden =
        serde_json::from_str(include_str!("../../../tests/golden/align.json")).unwrap();
    assert_eq!(golden.cases.len(), 5);
    for case in golden.cases {
        let found = align(&case.source, &case.target, &case.weights, 0.0).unwrap();
        assert!(
            (found.distance - case.distance).abs() < 1e-9 * (1.0 + case.distance),
            "{} {}",
            found.distance,
            case.distance
        );
        assert!(crate::math::wrap_angle(found.transform.yaw - case.yaw).abs() < 1e-6);
        // 40 m from the origin, an uncertainty of 1e-7 of the yaw moves the shift.
        assert!(
            (found.transform.shift - DVec2::new(case.x0, case.z0)).length() < 1e-4,
            "{:?} {} {}",
            found.transform,
            case.x0,
            case.z0
        );
        assert!(!found.turn_is_free);
    }
}

#[test]
fn align_agrees_with_a_search_over_20_000_yaws() {
    let golden: Golden =
        serde_json::from_str(include_str!("../../../tests/golden/align.json")).unwrap();
    for case in golden.cases {
        let found = align(&case.source, &case.target, &case.weights, 0.0).unwrap();
        let searched = by_grid_search(&case.source, &case.target, &case.weights, 20_000);
        assert!(found.distance <= searched + 1e-9);
        assert!(
            (found.distance - searched).abs() < 1e-6 * (1.0 + searched),
            "{} {searched}",
            found.distance
        );
    }
}

fn cloud() -> impl Strategy<Value = Vec<Vec3>> {
    prop::collection::vec(
        (-2.0f32..2.0, 0.0f32..2.0, -2.0f32..2.0).prop_map(|(x, y, z)| Vec3::new(x, y, z)),
        12,
    )
}

proptest! {
    #[test]
    fn align_distance_is_that_of_its_transform(
        source in cloud(),
        target in cloud(),
        w in prop::collection::vec(0.1f64..2.0, 4),
    ) {
        let found = align(&source, &target, &w, 0.0).unwrap();
        let left = cost(&found.transform, &source, &target, &w);
        prop_assert!(
            (left - found.distance).abs() < 1e-9 * (1.0 + left),
            "{} {left}",
            found.distance
        );
    }

    #[test]
    fn align_distance_is_a_local_minimum(
        source in cloud(),
        target in cloud(),
        yaw in -3.1f64..3.1,
        x in -1.0f64..1.0,
        z in -1.0f64..1.0,
    ) {
        let found = align(&source, &target, &[1.0], 0.0).unwrap();
        prop_assert!(
            found.distance <= cost(&Planar::new(yaw, x, z), &source, &target, &[1.0]) + 1e-9
        );
    }

    #[test]
    fn align_of_a_moved_cloud_is_the_inverse_transform(
        target in cloud(),
        yaw in -3.1f64..3.1,
        x in -9.0f64..9.0,
        z in -9.0f64..9.0,
    ) {
        let moved = Planar::new(yaw, x, z);
        let source: Vec<Vec3> = target.iter().map(|&p| moved.apply(p)).collect();
        let found = align(&source, &target, &[1.0], 0.0).unwrap();
        prop_assert!(found.distance < 1e-9);
        prop_assert!(crate::math::wrap_angle(found.transform.yaw - yaw).abs() < 1e-4);
        prop_assert!((found.transform.shift - moved.shift).length() < 1e-4);
    }
}

#[test]
fn align_of_half_a_turn_is_half_a_turn() {
    // `atan` of the quotient would give 0 here: the target is the source turned by π.
    let source = [Vec3::new(1.0, 0.0, 0.2), Vec3::new(-0.5, 1.0, 0.0), Vec3::new(0.1, 0.5, -0.9)];
    let target = source.map(|p| Vec3::new(-p.x, p.y, -p.z));
    let found = align(&source, &target, &[1.0], 0.0).unwrap();
    assert!((found.transform.yaw.abs() - PI).abs() < 1e-9);
    assert!(found.distance < 1e-12);
}

#[test]
fn align_with_a_free_yaw_takes_the_fallback() {
    // One point over another point; a vertical line far away; a square on a point.
    let point = [Vec3::new(30.1, 1.0, -7.3)];
    let line = [Vec3::new(30.1, 1.0, -7.3), Vec3::new(30.1, 2.0, -7.3)];
    let square = [Vec3::X, Vec3::Z, -Vec3::X, -Vec3::Z];
    for (source, target, distance) in [
        (&point[..], &point[..], 0.0),
        (&line[..], &line[..], 0.0),
        (&square[..], &[Vec3::ZERO; 4][..], 4.0),
    ] {
        let found = align(source, target, &[1.0], 0.7).unwrap();
        assert!(found.turn_is_free, "{found:?}");
        assert!((found.distance - distance).abs() < 1e-9);
        assert_eq!(found.transform.yaw, 0.7);
        assert!((cost(&found.transform, source, target, &[1.0]) - distance).abs() < 1e-9);
    }
}

#[test]
fn align_of_invalid_clouds_is_refused() {
    let two = [Vec3::ZERO, Vec3::X];
    assert_eq!(
        align(&two, &two[..1], &[1.0], 0.0),
        Err(RegistrationError::Points { source_points: 2, target_points: 1 })
    );
    for weights in [&[][..], &[0.0], &[-1.0, 2.0], &[f64::NAN], &[1.0, 1.0, 1.0]] {
        assert!(
            matches!(align(&two, &two, weights, 0.0), Err(RegistrationError::Weights { .. })),
            "{weights:?}"
        );
    }
    assert_eq!(align(&[Vec3::NAN, Vec3::X], &two, &[1.0], 0.0), Err(RegistrationError::NotFinite));
    assert!(align(&[], &[], &[1.0], 0.0).is_err());
}
