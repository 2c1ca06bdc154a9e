//! The program for path editing.

use super::*;

#[test]
fn motion_without_its_path_stays_in_place_with_constant_facing() {
    let mut session = opened("lab=view&a=walk_left&compare=root_motion:world,in_place,residual");
    let own = clip(&mut session, "walk_left");
    assert!(Arc::ptr_eq(motion(&session, 0).clip(), own.clip()));
    let still = motion(&session, 1);
    let facing = segue_motion::clip::character_frames(still.clip(), still.roles());
    for (frame, told) in facing.iter().zip(still.ground_frames()) {
        for stands in [frame, told] {
            assert!(stands.shift.length() < 1e-3 && stands.yaw.abs() < 1e-3, "{stands:?}");
        }
    }
    // Relative to the path the hips sway by a few centimetres.
    let residual = motion(&session, 2).ground_frames();
    let far =
        residual.iter().map(|frame| (frame.shift - residual[0].shift).length()).fold(0.0, f64::max);
    let turned = residual
        .iter()
        .map(|frame| wrap_angle(frame.yaw - residual[0].yaw).abs())
        .fold(0.0, f64::max);
    assert!(far > 0.005 && far < 0.25 && turned < 0.6);
    // Heights and the pose relative to the character are unchanged.
    for pane in [1, 2] {
        let there = motion(&session, pane).clip();
        for frame in (0..there.frames()).step_by(13) {
            assert!(
                (there.root_translations()[frame].y - own.clip().root_translations()[frame].y)
                    .abs()
                    < 1e-5
            );
            assert_eq!(there.rotations(frame)[1..], own.clip().rotations(frame)[1..]);
        }
    }
}

#[test]
fn path_with_four_control_points_carries_its_residual() {
    let session = opened("lab=path&a=walk_left&control_points=4");
    let own = outcome(&session, 0).path().expect("a path");
    assert_eq!(own.curve.spline().points().len(), 4);
    let error = number(&session, 0, "fit_rms_cm");
    let finer = number(&opened("lab=path&a=walk_left&control_points=16"), 0, "fit_rms_cm");
    assert!(finer < error);
    // Without edits, the result is the recording.
    let recorded = outcome(&session, 0).sources[0].motion.clip();
    let made = motion(&session, 0).clip();
    let off = made
        .root_translations()
        .iter()
        .zip(recorded.root_translations())
        .map(|(p, q)| p.distance(*q));
    assert!(off.fold(0.0, f32::max) < 1e-3);
}

#[test]
fn time_warp_compares_five_frames_with_a_slope_limit_of_two() {
    let session = opened("lab=register&a=walk&b=slow_walk");
    let params = session.params();
    assert_eq!(
        (
            params.number(Key::RegistrationWindow),
            params.number(Key::SlopeLimit),
            params.number(Key::WarpWeight)
        ),
        (5.0, 2.0, 0.5)
    );
    let registered = outcome(&session, 0).registered().expect("a registration");
    let path: Vec<(usize, usize)> = registered.registration.path().cells.clone();
    let (mut across, mut along) = (0, 0);
    for step in path.windows(2) {
        let (da, db) = (step[1].0 - step[0].0, step[1].1 - step[0].1);
        assert!((da, db) == (1, 1) || (da, db) == (1, 0) || (da, db) == (0, 1));
        across = if db == 0 { across + 1 } else { 0 };
        along = if da == 0 { along + 1 } else { 0 };
        assert!(across <= 2 && along <= 2);
    }
    // The average of the pair.
    assert!(
        registered.frame_pairs.iter().all(|frame_pair| (frame_pair.weights[1] - 0.5).abs() < 1e-9)
    );
}

#[test]
fn join_has_a_linear_weight_over_the_requested_part() {
    let of = |law: &str| {
        let session = opened(&format!("lab=register&a=walk&b=run&warp_mode=join&weight_law={law}"));
        let made = outcome(&session, 0).clone();
        let transition = made.transition.expect("a transition");
        let from = (transition.start_secs * made.motion.clip().fps()).round() as usize;
        let frame_pairs = &made.registered().expect("a registration").frame_pairs;
        // The frames of A in the transition, with B's weight in each.
        frame_pairs[from..from + transition.window_frames]
            .iter()
            .map(|frame_pair| (frame_pair.frames[0], frame_pair.weights[1]))
            .collect::<Vec<(f64, f64)>>()
    };
    let (linear, smooth) = (of("linear"), of("smooth"));
    assert!(linear.len() > 10 && linear.len() == smooth.len());
    let (first, last) = (linear[0], linear[linear.len() - 1]);
    assert!(first.1 < 0.05 && last.1 > 0.95);
    let slope = (last.1 - first.1) / (last.0 - first.0);
    let share = |frame: f64| first.1 + slope * (frame - first.0);
    for (frame, weight) in linear {
        assert!((weight - share(frame)).abs() < 1e-6, "{frame}: {weight}");
    }
    // The other law over the same part of the registration.
    for (frame, weight) in smooth {
        assert!(
            (weight - (1.0 - WeightLaw::Smooth.alpha(share(frame)))).abs() < 1e-6,
            "{frame}: {weight}"
        );
    }
}

#[test]
fn camera_follows_any_extra_character() {
    let link = "lab=path&a=walk&others=walk_left,walk_right&play=off&t=2&follow=";
    for (follow, other) in [
        ("other&follow_other=1", Some(0)),
        ("other&follow_other=2", Some(1)),
        ("result", None),
        ("other&follow_other=3", None),
    ] {
        let session = opened(&format!("{link}{follow}"));
        let followed = match other {
            Some(other) => session.extra_characters()[other].motion.clone().expect("it is there"),
            None => outcome(&session, 0).motion.clone(),
        };
        let panes = [(0, Viewport::default())];
        let options = StageOptions { panes: &panes, ..StageOptions::default() };
        let stage = Director::default().stage(&session, &options, 0.0);
        let (focus, stands) = (stage.panes[0].focus, followed.standing_at(2.0).origin());
        assert!(focus.distance(stands) < 0.2, "{follow}: {focus} {stands}");
    }
}
