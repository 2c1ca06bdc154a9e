//! The article on Gleicher's motion path editing.

use super::*;

const CURVE: &str = "lab=path&a=walk&path=AAgAABB-MHRKZmJQdDZ8Fn4J";

#[test]
fn offset_in_the_world_leaves_its_side_of_the_path() {
    let session = opened(&format!("{CURVE}&compare=path_offset:path,world"));
    let mut most: f64 = 0.0;
    for (pane, is_local) in [(0, true), (1, false)] {
        let made = outcome(&session, pane);
        let path = made.path().expect("a path");
        assert!(path.is_edited);
        let old = path.fitted.places().iter().zip(path.fitted.motion().ground_frames());
        for ((old, stood), (place, stands)) in
            old.zip(path.places.iter().zip(made.motion.ground_frames()))
        {
            let local =
                |place: &Planar, stands: &Planar| place.inverse().apply_ground(stands.shift);
            let found = local(&place.frame, stands).distance(local(&old.frame, stood));
            let world = (stands.shift - place.frame.shift).distance(stood.shift - old.frame.shift);
            assert!((if is_local { found } else { world }) < 1e-4);
            most = if is_local { most } else { most.max(found) };
        }
    }
    // The sway of the hips is a few centimetres.
    assert!(most > 0.01);
}

#[test]
fn path_of_an_unclamped_basis_begins_beside_its_first_control_point() {
    let link = "lab=path&a=walk_left&control_points=4&compare=path_spline:clamped,uniform";
    let session = opened(link);
    let [clamped, uniform] =
        [0, 1].map(|pane| outcome(&session, pane).path().expect("a path").curve.spline().clone());
    assert_eq!(uniform.ends(), SplineEnds::Uniform);
    assert_eq!(clamped.position(0.0), clamped.points()[0]);
    let p = uniform.points();
    // The matrix of the article: (1, 4, 1, 0)/6 at 0 and (0, 1, 4, 1)/6 at 1.
    let ends = [(p[0] + p[1] * 4.0 + p[2]) / 6.0, (p[1] + p[2] * 4.0 + p[3]) / 6.0];
    for (u, place) in [(0.0, ends[0]), (1.0, ends[1])] {
        assert!(
            uniform.position(u).distance(place) < 1e-9
                && uniform.position(u).distance(clamped.position(u)) < 1e-9
        );
    }
    assert!(uniform.position(0.0).distance(p[0]) > 0.1);
}

#[test]
fn body_faces_along_an_edited_path_or_as_recorded() {
    let session = opened(&format!("{CURVE}&compare=path_facing:path,world"));
    let turned = |pane: usize| {
        let frames = motion(&session, pane).ground_frames();
        frames.iter().map(|frame| wrap_angle(frame.yaw - frames[0].yaw).abs()).fold(0.0, f64::max)
    };
    assert!(turned(0) > 0.4 && turned(1) < 0.3);
}
