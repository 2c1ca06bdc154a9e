//! Tests of path edits.

use super::*;
use proptest::prelude::*;
use std::f64::consts::PI;

const FREE: Pins = Pins { start: false, end: false };
const START: Pins = Pins { start: true, end: false };
const BOTH: Pins = Pins { start: true, end: true };

fn path(points: &[(f64, f64)]) -> GroundSpline {
    GroundSpline::uniform(points.iter().map(|&p| DVec2::from(p)).collect()).unwrap()
}

/// Returns a path ahead with bends.
fn winding() -> impl Strategy<Value = GroundSpline> {
    prop::collection::vec(-1.0f64..1.0, 6..12).prop_map(|sides| {
        let points = sides.iter().enumerate().map(|(k, &x)| (x, 0.8 * k as f64));
        path(&points.collect::<Vec<_>>())
    })
}

fn line(points: usize) -> GroundSpline {
    let spline = path(&vec![(0.0, 0.0); points]);
    let way = spline.greville().into_iter().map(|g| DVec2::new(0.0, 6.0 * g)).collect();
    GroundSpline::uniform(way).unwrap()
}

fn length(spline: &GroundSpline) -> f64 {
    ArcLengthPath::new(spline.clone()).unwrap().length_m()
}

/// Returns the largest distance between two paths at the same parameter.
fn apart(a: &GroundSpline, b: &GroundSpline) -> f64 {
    (0..=200)
        .map(|k| f64::from(k) / 200.0)
        .map(|u| a.position(u).distance(b.position(u)))
        .fold(0.0, f64::max)
}

fn ends(spline: &GroundSpline) -> [DVec2; 2] {
    [spline.position(0.0), spline.position(1.0)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn inserted_point_keeps_the_curve_and_is_removed_again(path in winding(), at in 0.01f64..0.99) {
        prop_assume!(path.inner_knots().iter().all(|knot| (knot - at).abs() > 0.01));
        let more = path.edited(&PathEdit::Insert { at }, BOTH).unwrap();
        prop_assert_eq!(more.points().len(), path.points().len() + 1);
        prop_assert!(apart(&path, &more) < 1e-12);
        let index = (0..more.points().len())
            .min_by(|&a, &b| {
                (more.greville()[a] - at).abs().total_cmp(&(more.greville()[b] - at).abs())
            })
            .unwrap();
        if let Ok(back) = more.edited(&PathEdit::Remove { index }, BOTH) {
            prop_assert_eq!(back.points().len(), path.points().len());
            if back.inner_knots() == path.inner_knots() {
                prop_assert!(apart(&path, &back) < 1e-8);
            }
        }
    }

    /// A moved point changes only the pieces that depend on it, and no point of these moves farther
    /// than it does.
    #[test]
    fn moved_point_changes_its_own_pieces_alone(
        path in winding(),
        index in 0usize..6,
        x in -2.0f64..2.0,
    ) {
        let to = path.points()[index] + DVec2::new(x, 0.3);
        let moved = path.edited(&PathEdit::Move { index, to }, FREE).unwrap();
        let pieces = (path.points().len() - 3) as f64;
        for k in 0..=200 {
            let u = f64::from(k) / 200.0;
            let by = moved.position(u).distance(path.position(u));
            prop_assert!(by <= to.distance(path.points()[index]) + 1e-12);
            let outside = u * pieces > (index + 1) as f64 || u * pieces < index as f64 - 3.0;
            prop_assert!(!outside || by == 0.0, "{u} {by}");
        }
    }

    #[test]
    fn rotation_and_shift_are_rigid_and_scaling_is_not(
        path in winding(),
        radians in -3.0f64..3.0,
        factor in 0.2f64..4.0,
    ) {
        for pins in [FREE, START, Pins { start: false, end: true }] {
            let turned = path.edited(&PathEdit::Rotate { radians }, pins).unwrap();
            prop_assert!((length(&turned) - length(&path)).abs() < 1e-9);
            let yaw = crate::math::wrap_angle(turned.heading(0.3) - path.heading(0.3) - radians);
            prop_assert!(yaw.abs() < 1e-9);
            let grown = path.edited(&PathEdit::Scale { factor }, pins).unwrap();
            prop_assert!((length(&grown) - factor * length(&path)).abs() < 1e-9 * (1.0 + factor));
            for (edited, held) in [(&turned, pins), (&grown, pins)] {
                prop_assert!(!held.start || ends(edited)[0].distance(ends(&path)[0]) < 1e-12);
                prop_assert!(!held.end || ends(edited)[1].distance(ends(&path)[1]) < 1e-12);
            }
        }
        let mirrored = path.edited(&PathEdit::Mirror, BOTH).unwrap();
        prop_assert!(ends(&mirrored)[1].distance(ends(&path)[1]) < 1e-9);
        prop_assert!(apart(&mirrored.edited(&PathEdit::Mirror, FREE).unwrap(), &path) < 1e-9);
        let [a, b] = [&mirrored, &path].map(|path| path.jet(0.4).curvature());
        prop_assert!((a + b).abs() < 1e-9 * (1.0 + b.abs()));
    }

    #[test]
    fn straightened_path_keeps_its_length_and_its_pins(path in winding()) {
        let straight = path.edited(&PathEdit::Straighten { share: 1.0 }, START).unwrap();
        prop_assert!(
            (length(&straight) - length(&path)).abs() < 0.02 * length(&path),
            "{} {}",
            length(&straight),
            length(&path)
        );
        prop_assert!(
            (ends(&straight)[1].distance(ends(&straight)[0]) - length(&straight)).abs() < 1e-3
        );
        let between = path.edited(&PathEdit::Straighten { share: 1.0 }, BOTH).unwrap();
        prop_assert!(
            ends(&between)[0].distance(ends(&path)[0]) < 1e-9
                && ends(&between)[1].distance(ends(&path)[1]) < 1e-9
        );
        let half = path.edited(&PathEdit::Straighten { share: 0.5 }, START).unwrap();
        let direct = |spline: &GroundSpline| ends(spline)[0].distance(ends(spline)[1]);
        prop_assert!(
            direct(&half) >= direct(&path) - 0.02 && direct(&half) <= direct(&straight) + 0.02
        );
    }

    #[test]
    fn closed_path_is_smooth_at_its_start(
        path in winding(),
        index in 0usize..6,
        x in -1.0f64..1.0,
    ) {
        let closed = path.edited(&PathEdit::Close, START).unwrap();
        prop_assert!(ends(&closed)[0].distance(ends(&path)[0]) < 1e-9);
        let smooth = |closed: &GroundSpline| {
            let (a, b) = (closed.jet(0.0), closed.jet(1.0));
            closed.is_closed()
                && a.position.distance(b.position) < 1e-9
                && a.first.distance(b.first) < 1e-8
        };
        prop_assert!(smooth(&closed));
        for edit in [
            PathEdit::Move { index, to: closed.points()[index] + DVec2::new(x, 0.1) },
            PathEdit::Move { index: closed.points().len() - 2, to: DVec2::new(x, 0.1) },
            PathEdit::Insert { at: 0.05 },
            PathEdit::Smooth { share: 0.5 },
            PathEdit::Snap { grid_m: 0.25 },
            PathEdit::Mirror,
            PathEdit::Rotate { radians: 1.0 },
        ] {
            prop_assert!(smooth(&closed.edited(&edit, FREE).unwrap()), "{edit:?}");
        }
        let to = closed.points()[1] + DVec2::new(x, 0.2);
        let held = closed.edited(&PathEdit::Move { index: 1, to }, START).unwrap();
        prop_assert!(
            smooth(&held)
                && held.points()[1].distance(to) < 1e-9
                && ends(&held)[0].distance(ends(&closed)[0]) < 1e-9
        );
        prop_assert!(!closed.edited(&PathEdit::Open, FREE).unwrap().is_closed());
    }

    #[test]
    fn edits_by_any_numbers_do_not_panic(
        path in winding(),
        value in prop::num::f64::ANY,
        index: usize,
    ) {
        let point = DVec2::new(value, 1.0);
        for edit in [
            PathEdit::Move { index, to: point },
            PathEdit::Move { index: index % 8, to: point },
            PathEdit::Insert { at: value },
            PathEdit::Remove { index },
            PathEdit::Smooth { share: value },
            PathEdit::Snap { grid_m: value },
            PathEdit::Shift { by: point },
            PathEdit::Rotate { radians: value },
            PathEdit::Scale { factor: value },
            PathEdit::Straighten { share: value },
        ] {
            if let Ok(edited) = path.edited(&edit, FREE) {
                prop_assert!(edited.points().iter().all(|p| p.is_finite()), "{edit:?}");
            }
        }
    }
}

#[test]
fn closed_straight_line_is_a_circle() {
    let closed = line(12).edited(&PathEdit::Close, START).unwrap();
    let radius = 6.0 / (2.0 * PI);
    for k in 0..=60 {
        let jet = closed.jet(f64::from(k) / 60.0);
        // To the left of a walk along +Z.
        let from_centre = jet.position.distance(DVec2::new(radius, 0.0));
        assert!((from_centre - radius).abs() < 0.02, "{k}: {from_centre}");
    }
    assert!((length(&closed) - 6.0).abs() < 0.1);
}

/// Ends that are near each other are joined in place.
#[test]
fn closed_figure_eight_keeps_its_shape() {
    let points: Vec<(f64, f64)> = (0..=20)
        .map(|k| f64::from(k) / 20.0 * 1.95 * PI)
        .map(|a| (2.0 * a.sin(), (2.0 * a).sin()))
        .collect();
    let eight = path(&points);
    let closed = eight.edited(&PathEdit::Close, FREE).unwrap();
    assert!(apart(&eight, &closed) < 0.6, "{}", apart(&eight, &closed));
    assert!(ArcLengthPath::new(closed).unwrap().total_turn().abs() < 0.5);
}

#[test]
fn smoothed_and_snapped_points_are_as_documented() {
    let zigzag = path(&[(0.0, 0.0), (1.0, 1.0), (-1.0, 2.0), (1.0, 3.0), (-1.0, 4.0), (0.0, 5.0)]);
    let smooth = zigzag.edited(&PathEdit::Smooth { share: 0.7 }, BOTH).unwrap();
    assert!(length(&smooth) < length(&zigzag) && ends(&smooth) == ends(&zigzag));
    assert_eq!(zigzag.edited(&PathEdit::Smooth { share: 0.0 }, FREE).unwrap(), zigzag);
    let off = path(&[(0.1, 0.2), (1.1, 1.4), (-0.9, 2.4), (1.0, 2.6)]);
    let snapped = off.edited(&PathEdit::Snap { grid_m: 0.5 }, FREE).unwrap();
    assert_eq!(snapped, path(&[(0.0, 0.0), (1.0, 1.5), (-1.0, 2.5), (1.0, 2.5)]));
    let held = off.edited(&PathEdit::Snap { grid_m: 0.5 }, START).unwrap();
    assert_eq!(held.points()[0], DVec2::new(0.1, 0.2));
}

#[test]
fn impossible_edits_are_refused() {
    let path = path(&[(0.0, 0.0), (0.0, 1.0), (1.0, 2.0), (0.0, 3.0)]);
    let edited = |edit, pins| path.edited(&edit, pins).unwrap_err();
    let to = DVec2::ONE;
    assert_eq!(edited(PathEdit::Move { index: 0, to }, START), PathEditError::Pinned);
    assert_eq!(
        edited(PathEdit::Move { index: 4, to }, FREE),
        PathEditError::NoSuchPoint { index: 4, points: 4 }
    );
    assert_eq!(edited(PathEdit::Rotate { radians: 1.0 }, BOTH), PathEditError::Pinned);
    assert_eq!(edited(PathEdit::Shift { by: to }, START), PathEditError::Pinned);
    assert_eq!(
        edited(PathEdit::Remove { index: 1 }, FREE),
        PathEditError::NotRemoved { index: 1, least: 4 }
    );
    assert_eq!(edited(PathEdit::Close, FREE), PathEditError::TooFewToClose { points: 4, least: 6 });
    assert_eq!(edited(PathEdit::Insert { at: 1.0 }, FREE), PathEditError::Knots);
    assert_eq!(edited(PathEdit::Insert { at: f64::NAN }, FREE), PathEditError::Knots);
    assert_eq!(
        edited(PathEdit::Move { index: 1, to: DVec2::NAN }, FREE),
        PathEditError::Point { index: 1 }
    );
    assert!(matches!(edited(PathEdit::Scale { factor: 0.0 }, FREE), PathEditError::Option { .. }));
    assert_eq!(line(8).edited(&PathEdit::Close, BOTH), Err(PathEditError::Pinned));
    assert!(PathEditError::Pinned.to_string().contains("free it first"));
}
