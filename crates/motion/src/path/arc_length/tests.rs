//! Tests of arc length.

use super::*;
use proptest::prelude::*;
use std::f64::consts::FRAC_PI_2;

fn curve(points: &[(f64, f64)]) -> ArcLengthPath {
    ArcLengthPath::new(
        GroundSpline::uniform(points.iter().map(|&p| DVec2::from(p)).collect()).unwrap(),
    )
    .unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn length_and_parameter_are_inverse(
        way in prop::collection::vec((-3.0f64..3.0, -3.0f64..3.0), 4..12),
        share in 0.0f64..1.0,
    ) {
        let curve = curve(&way);
        let along = curve.length_m() * share;
        let u = curve.parameter_at(along);
        prop_assert!((curve.length_at(u) - along).abs() < 1e-9);
        prop_assert!((curve.parameter_at(curve.length_at(share)) - share).abs() < 1e-6);
        prop_assert!(curve.at(u).frame.shift.distance(curve.at_length(along).frame.shift) < 1e-9);
    }

    /// The quadrature is compared with twenty thousand chords, which cut off the tip of a hairpin.
    #[test]
    fn length_agrees_with_many_chords(
        way in prop::collection::vec((-3.0f64..3.0, -3.0f64..3.0), 4..12),
    ) {
        let curve = curve(&way);
        let mut chords = 0.0;
        for k in 0..20_000 {
            let at = |k: i32| curve.spline().position(f64::from(k) / 20_000.0);
            chords += at(k).distance(at(k + 1));
        }
        prop_assert!(
            (chords - curve.length_m()).abs() < 2e-5 * chords,
            "{chords} {}",
            curve.length_m()
        );
    }

    /// The frame's +Z runs along the path, and the curvature is the turn per metre.
    #[test]
    fn waypoints_run_along_the_path(
        way in prop::collection::vec((-3.0f64..3.0, -3.0f64..3.0), 4..12),
        share in 0.01f64..0.99,
    ) {
        let curve = curve(&way);
        let (step, along) = (1e-5 * curve.length_m(), share * curve.length_m());
        let [before, here, after] = [-1.0, 0.0, 1.0].map(|k| curve.at_length(along + k * step));
        // Near the tip of a hairpin a step is long.
        prop_assume!(here.curvature.abs() * step < 1e-3);
        let way = after.frame.shift - before.frame.shift;
        let forward = here.frame.forward();
        prop_assert!(
            way.normalize_or_zero()
                .distance(DVec2::new(f64::from(forward.x), f64::from(forward.z)))
                < 1e-3
        );
        let turn = crate::math::wrap_angle(after.frame.yaw - before.frame.yaw) / (2.0 * step);
        prop_assert!(
            (turn - here.curvature).abs() < 0.01 * (1.0 + here.curvature.abs()),
            "{turn} {}",
            here.curvature
        );
    }
}

/// The path turns back almost in a point. A quadrature with fixed parts would be 3 mm too short in
/// 3.6 m.
#[test]
fn length_of_a_hairpin_agrees_with_its_chords() {
    let curve = curve(&[
        (2.136_294_058_034_753, 1.723_512_390_519_103),
        (0.0, -2.877_905_455_329_102_6),
        (1.458_126_835_186_948_5, 0.237_735_531_810_650_38),
        (1.328_933_628_357_663, -0.219_980_384_635_775_46),
    ]);
    let at = |k: i32| curve.spline().position(f64::from(k) / 200_000.0);
    let chords: f64 = (0..200_000).map(|k| at(k).distance(at(k + 1))).sum();
    assert!((chords - curve.length_m()).abs() < 2e-6, "{chords} {}", curve.length_m());
    for k in 0..=100 {
        let along = curve.length_m() * f64::from(k) / 100.0;
        assert!((curve.length_at(curve.parameter_at(along)) - along).abs() < 1e-9, "{along}");
    }
}

#[test]
fn path_beyond_its_ends_is_straight_or_repeats() {
    let line = curve(&[(0.0, 0.0), (0.0, 1.0), (0.0, 2.0), (0.0, 3.0)]);
    assert!((line.length_m() - 3.0).abs() < 1e-12);
    assert!(line.at_length(5.0).frame.shift.distance(DVec2::new(0.0, 5.0)) < 1e-9);
    assert!(line.at_length(-1.0).frame.shift.distance(DVec2::new(0.0, -1.0)) < 1e-9);
    // From +Z to the left is towards +X.
    let left = curve(&[(0.0, 0.0), (0.0, 1.0), (0.0, 2.0), (2.0, 3.0)]);
    assert!(left.at(0.9).curvature > 0.0 && left.at(0.9).frame.yaw > 0.0);

    let ring: Vec<DVec2> =
        (0..9).map(|k| DVec2::from_angle(f64::from(k) * FRAC_PI_2 / 2.0) * 3.0).collect();
    let ring = ArcLengthPath::new(GroundSpline::uniform(ring).unwrap().joined()).unwrap();
    let (a, b) = (ring.at_length(1.0), ring.at_length(1.0 + 2.0 * ring.length_m()));
    assert!(a.frame.shift.distance(b.frame.shift) < 1e-9 && b.along_m > a.along_m);
    let (before, after) =
        (ring.at_length(ring.length_m() - 1e-6), ring.at_length(ring.length_m() + 1e-6));
    assert!(before.frame.shift.distance(after.frame.shift) < 3e-6);
    assert!(crate::math::wrap_angle(after.frame.yaw - before.frame.yaw).abs() < 1e-5);
}

/// The speed of a path is 0 at coinciding control points, and it still has a direction there.
#[test]
fn heading_at_coinciding_points_is_that_of_the_next_part() {
    let doubled = curve(&[(0.0, 0.0), (0.0, 0.0), (0.0, 0.0), (1.0, 0.0), (2.0, 0.0)]);
    assert!((doubled.at(0.0).frame.yaw - FRAC_PI_2).abs() < 1e-6);
    assert_eq!(doubled.at(0.0).curvature, 0.0);
    for k in 0..=40 {
        let along = doubled.length_m() * f64::from(k) / 40.0;
        assert!((doubled.length_at(doubled.parameter_at(along)) - along).abs() < 1e-9);
    }
    let point = GroundSpline::uniform(vec![DVec2::ONE; 5]).unwrap();
    assert!(matches!(ArcLengthPath::new(point), Err(PathEditError::NoLength { .. })));
    for at in [f64::NAN, f64::INFINITY, -f64::INFINITY] {
        let place = doubled.at(at).frame.shift;
        assert!(place.is_finite(), "{at}");
    }
}
