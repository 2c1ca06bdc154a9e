//! Tests of path fits.

use super::*;
use crate::path::ArcLengthPath;
use proptest::prelude::*;
use std::collections::BTreeMap;

#[derive(serde::Deserialize)]
struct Golden {
    ways: BTreeMap<String, Vec<[f64; 2]>>,
    fits: Vec<Fit>,
    curves: Vec<Curve>,
}

#[derive(serde::Deserialize)]
struct Fit {
    name: String,
    control_points: usize,
    smoothing: f64,
    pin_ends: bool,
    found: Vec<[f64; 2]>,
}

#[derive(serde::Deserialize)]
struct Curve {
    name: String,
    points: Vec<[f64; 2]>,
    at: Vec<f64>,
    position: Vec<[f64; 2]>,
    first: Vec<[f64; 2]>,
    second: Vec<[f64; 2]>,
    curvature: Vec<f64>,
    length: Vec<f64>,
    insert_at: f64,
    inserted: Vec<[f64; 2]>,
}

fn golden() -> Golden {
    serde_json::from_str(include_str!("../../../tests/oracles/path.json")).unwrap()
}

fn points(list: &[[f64; 2]]) -> Vec<DVec2> {
    list.iter().map(|&p| DVec2::from(p)).collect()
}

#[test]
fn fit_agrees_with_scipy() {
    let golden = golden();
    let mut worst: f64 = 0.0;
    for fit in &golden.fits {
        let way = points(&golden.ways[&fit.name]);
        let (parameters, _) = chord_parameters(&way);
        let options = FitOptions {
            control_points: fit.control_points,
            smoothing: fit.smoothing,
            pin_ends: fit.pin_ends,
            ..FitOptions::default()
        };
        let spline = fit_spline(&way, &parameters, &options).unwrap();
        for (own, other) in spline.points().iter().zip(points(&fit.found)) {
            let apart = own.distance(other);
            assert!(apart < 1e-9, "{} {options:?}: {apart}", fit.name);
            worst = worst.max(apart);
        }
    }
    assert_eq!(golden.fits.len(), 64);
    println!("farthest from SciPy: {worst:e} m");
}

#[test]
fn spline_agrees_with_scipy() {
    for curve in golden().curves {
        let spline = GroundSpline::uniform(points(&curve.points)).unwrap();
        let path = ArcLengthPath::new(spline.clone()).unwrap();
        let near = |own: DVec2, other: [f64; 2], tolerance: f64| {
            own.distance(DVec2::from(other)) < tolerance
        };
        for (k, &at) in curve.at.iter().enumerate() {
            let jet = spline.jet(at);
            assert!(near(jet.position, curve.position[k], 1e-10), "{} {at}", curve.name);
            assert!(near(jet.first, curve.first[k], 1e-9), "{} {at}", curve.name);
            assert!(near(jet.second, curve.second[k], 1e-7), "{} {at}", curve.name);
            let curvature = curve.curvature[k];
            assert!(
                (jet.curvature() - curvature).abs() < 1e-8 * (1.0 + curvature.abs()),
                "{} {at}",
                curve.name
            );
            let length = curve.length[k];
            assert!(
                (path.length_at(at) - length).abs() < 1e-6 * (1.0 + length),
                "{} {at} {length}",
                curve.name
            );
        }
        let refined = spline.refined(curve.insert_at).unwrap();
        for (own, other) in refined.points().iter().zip(&curve.inserted) {
            assert!(near(*own, *other, 1e-10), "{}", curve.name);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// The residual is orthogonal to the basis functions: no other control points are closer.
    #[test]
    fn fit_residual_is_orthogonal_to_the_basis(
        way in prop::collection::vec((-3.0f64..3.0, -3.0f64..3.0), 12..60),
        control_points in 4usize..9,
    ) {
        let way: Vec<DVec2> = way.into_iter().map(DVec2::from).collect();
        let parameters: Vec<f64> =
            (0..way.len()).map(|k| k as f64 / (way.len() - 1) as f64).collect();
        let spline =
            fit_spline(&way, &parameters, &FitOptions { control_points, ..FitOptions::default() })
                .unwrap();
        let mut sums = vec![DVec2::ZERO; control_points];
        for (&p, &u) in way.iter().zip(&parameters) {
            let (start, shares) = spline.shares(u);
            for (sum, share) in sums[start..].iter_mut().zip(shares) {
                *sum += (p - spline.position(u)) * share;
            }
        }
        prop_assert!(sums.iter().all(|sum| sum.length() < 1e-10), "{sums:?}");
    }

    /// A path is reproduced by its fit, and a straight trajectory gives a straight path however
    /// strong the smoothing is.
    #[test]
    fn fit_of_a_path_reproduces_it(
        way in prop::collection::vec((-3.0f64..3.0, -3.0f64..3.0), 4..9),
        smoothing in 0.0f64..1e4,
        pin_ends: bool,
    ) {
        let control: Vec<DVec2> = way.into_iter().map(DVec2::from).collect();
        let spline = GroundSpline::uniform(control.clone()).unwrap();
        let parameters: Vec<f64> = (0..=100).map(|k| f64::from(k) / 100.0).collect();
        let of = |spline: &GroundSpline| {
            parameters.iter().map(|&u| spline.position(u)).collect::<Vec<_>>()
        };
        let options =
            FitOptions { control_points: control.len(), pin_ends, ..FitOptions::default() };
        let found = fit_spline(&of(&spline), &parameters, &options).unwrap();
        for (a, b) in found.points().iter().zip(&control) {
            prop_assert!(a.distance(*b) < 1e-9);
        }
        let line: Vec<DVec2> = parameters.iter().map(|&u| control[0].lerp(control[3], u)).collect();
        let found = fit_spline(&line, &parameters, &FitOptions { smoothing, ..options }).unwrap();
        for (a, b) in of(&found).iter().zip(&line) {
            prop_assert!(a.distance(*b) < 1e-8);
        }
    }
}

#[test]
fn fit_with_smoothing_is_straighter_and_farther_off() {
    let way = points(&golden().ways["wander"]);
    let (parameters, _) = chord_parameters(&way);
    let mut before = 0.0;
    for smoothing in [0.0, 0.01, 1.0, 100.0] {
        let options =
            FitOptions { control_points: 14, smoothing, pin_ends: true, ..FitOptions::default() };
        let spline = fit_spline(&way, &parameters, &options).unwrap();
        assert_eq!((spline.points()[0], spline.points()[13]), (way[0], way[89]));
        let rest: f64 =
            way.iter().zip(&parameters).map(|(p, &u)| p.distance_squared(spline.position(u))).sum();
        assert!(rest > before, "{smoothing}: {rest}");
        before = rest;
    }
}

/// Three points and fourteen control points; gaps between points; all points in two places.
#[test]
fn fit_with_missing_points_is_straight_there() {
    let options = FitOptions { control_points: 14, ..FitOptions::default() };
    let few = [DVec2::ZERO, DVec2::new(0.0, 1.0), DVec2::new(0.0, 3.0)];
    let spline = drawn_path(&few, &options).unwrap();
    for k in 0..=50 {
        let place = spline.position(f64::from(k) / 50.0);
        assert!(place.x.abs() < 1e-6 && (-1e-3..3.001).contains(&place.y), "{place}");
    }
    let gap: Vec<f64> =
        (0..40).map(|k| if k < 20 { 0.01 } else { 0.8 } + 0.005 * f64::from(k)).collect();
    let way: Vec<DVec2> = gap.iter().map(|&u| DVec2::new(3.0 * u, u * u)).collect();
    let spline = fit_spline(&way, &gap, &options).unwrap();
    for (&u, p) in gap.iter().zip(&way) {
        assert!(spline.position(u).distance(*p) < 1e-3, "{u}");
    }
    assert!(spline.points().iter().all(|p| p.length() < 10.0), "{:?}", spline.points());
}

#[test]
fn impossible_fits_are_refused() {
    let (way, u) = ([DVec2::ZERO, DVec2::ONE], [0.0, 1.0]);
    let with = |control_points, smoothing| {
        let options = FitOptions { control_points, smoothing, ..FitOptions::default() };
        fit_spline(&way, &u, &options)
    };
    assert_eq!(with(3, 0.0), Err(PathEditError::ControlPoints { points: 3 }));
    assert_eq!(with(257, 0.0), Err(PathEditError::ControlPoints { points: 257 }));
    assert_eq!(with(usize::MAX, 0.0), Err(PathEditError::ControlPoints { points: usize::MAX }));
    for smoothing in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(with(4, smoothing), Err(PathEditError::Option { .. })));
    }
    let of = |way: &[DVec2], u: &[f64]| fit_spline(way, u, &FitOptions::default());
    assert_eq!(of(&[], &[]), Err(PathEditError::Frames { frames: 0 }));
    assert_eq!(of(&way, &[0.0]), Err(PathEditError::Parameters));
    assert_eq!(of(&way, &[1.0, 0.0]), Err(PathEditError::Parameters));
    assert_eq!(of(&way, &[0.0, f64::NAN]), Err(PathEditError::Parameters));
    assert_eq!(of(&way, &[0.5, 0.5]), Err(PathEditError::Parameters));
    assert_eq!(of(&[DVec2::ZERO, DVec2::NAN], &u), Err(PathEditError::Point { index: 1 }));
    assert_eq!(
        drawn_path(&[], &FitOptions::default()),
        Err(PathEditError::NoLength { length_m: 0.0 })
    );
    assert_eq!(
        drawn_path(&[DVec2::ZERO, DVec2::NAN], &FitOptions::default()),
        Err(PathEditError::Point { index: 1 })
    );
}

#[test]
fn band_takes_a_number_whose_square_is_0_for_nothing() {
    let solved = |tiny: f64| {
        let mut band = Band::new(4);
        band.add(0, [tiny, 0.0, 0.0, 0.0], DVec2::ONE);
        for index in 0..4 {
            band.add(index, [1.0, 0.0, 0.0, 0.0], DVec2::splat(index as f64));
        }
        band.solve().unwrap()
    };
    assert_eq!(solved(1e-200), solved(0.0));
}
