//! The homework: blending, loops, transitions, matching.

use super::*;

#[test]
fn two_gaits_blend_to_one_and_a_half_metres_per_second() {
    let session = opened("lab=speed&a=walk&b=run&speed=1.5");
    let made = outcome(&session, 0);
    let Some(CycleMade::Gait { asked_mps, .. }) = made.cycle.map(|cycle| cycle.made) else {
        panic!("a gait")
    };
    let frames = made.motion.ground_frames();
    let way = frames[0].shift.distance(frames[frames.len() - 1].shift);
    let speed = way / made.duration_secs();
    assert!((asked_mps - 1.5).abs() < 1e-9 && (speed / 1.5 - 1.0).abs() < 0.02);
}

#[test]
fn springs_from_both_ends_leave_a_known_seam() {
    let session = opened(
        "lab=loop&a=walk&loop_from=0.5&loop_to=1.4&half_life=0.2&loop_ratio=0.5&compare=loop_method:exact,both",
    );
    let (before, seam) = (numbers(&session, "loop_before_deg"), numbers(&session, "loop_seam_deg"));
    // A share (1 + yT) exp(-yT) of the difference is left at the other end.
    let left = |secs: f64| {
        let yt = 2.0 * std::f64::consts::LN_2 / 0.2 * secs;
        (1.0 + yt) * (-yt).exp()
    };
    assert!(seam[0] < 0.01 && seam[1] > 0.1 && seam[1] < before[1] * 2.0 * left(0.9));
}

#[test]
fn half_life_leaves_six_tenths() {
    // (1 + y t) exp(-y t) with y = 2 ln 2 / h: the share that a critically damped spring has left
    // at its half-life, and the time at which half is left.
    let left = |t: f64| {
        (1.0 + 2.0 * std::f64::consts::LN_2 * t) * (-2.0 * std::f64::consts::LN_2 * t).exp()
    };
    assert!((left(1.0) - 0.597).abs() < 1e-3 && (left(1.211) - 0.5).abs() < 1e-3);
    assert!((spring::secs_until(0.27, 0.5) - 1.211 * 0.27).abs() < 1e-3);
    let session = opened("lab=transition&a=walk&b=run&compare=half_life:0.1,0.27,0.6");
    let lag = numbers(&session, "lag_s");
    assert!(is_rising(&lag), "{lag:?}");
}

#[test]
fn frame_set_by_hand_slides_and_foot_lock_corrects_it() {
    let link = "lab=transition&a=walk&b=run&half_life=0.27&mix_frame_b=20";
    let [free, held] = ["", "&foot_lock=on"].map(|more| opened(&format!("{link}{more}")));
    let entered = outcome(&free, 0).transition.expect("a transition").enter_b_secs;
    assert!((entered * 60.0 - 20.0).abs() < 1e-6);
    let slides = [&free, &held].map(|session| number(session, 0, "foot_slide_cm"));
    assert!(slides[1] < 0.5 * slides[0], "{slides:?}");
    // The homework weights positions by 0.6 and rotations by 0.4.
    let params = free.params();
    assert_eq!((params.number(Key::MatchPosition), params.number(Key::MatchRotation)), (0.6, 0.4));
}

#[test]
fn velocities_divided_by_the_rate_stop_the_motion() {
    let session =
        opened("lab=transition&a=walk&b=run&half_life=0.27&compare=mistake:none,velocity");
    let seams = numbers(&session, "velocity_jump_dps");
    assert!(seams[1] > 2.0 * seams[0], "{seams:?}");
}

#[test]
fn driven_character_turns_with_the_stick() {
    let link = "lab=match&hysteresis=votes&search_by=tree&scenario=";
    for (scenario, degrees) in [("spin", 180.0), ("left", 90.0), ("right", -90.0)] {
        let session = opened(&format!("{link}{scenario}"));
        let frames = motion(&session, 0).ground_frames();
        let (mut turned, mut farthest) = (0.0_f64, 0.0_f64);
        for pair in frames.windows(2) {
            turned += wrap_angle(pair[1].yaw - pair[0].yaw).to_degrees();
            farthest = if turned.abs() > farthest.abs() { turned } else { farthest };
        }
        // Half a turn may be made in either direction.
        let off = if scenario == "spin" { farthest.abs() - degrees } else { farthest - degrees };
        assert!(off.abs() < 25.0, "{scenario}: {farthest}");
    }
}

#[test]
fn every_search_finds_the_same_frames() {
    let made = ["tree", "boxes", "scan"]
        .map(|by| opened(&format!("lab=match&scenario=left&search_by={by}")));
    let roots = |session: &Session| motion(session, 0).clip().root_translations().to_vec();
    let first: Vec<Vec3> = roots(&made[0]);
    assert!(first.len() > 100 && made[1..].iter().all(|other| roots(other) == first));
}

/// Uses the homework's own files, if they are there.
#[test]
fn files_of_the_homework_are_shown_in_place_and_on_a_path() {
    let Some(data) = common::shared_data() else {
        return;
    };
    for name in ["walk_forward.bvh", "run_forward.bvh"] {
        let Ok(bytes) = std::fs::read(data.join("games105").join(name)) else {
            continue;
        };
        let mut session = Session::new();
        session.load(name, bytes.into()).expect("a file that can be read");
        let id = session.params().text(Key::A).to_owned();
        assert!(id.starts_with(name.trim_end_matches(".bvh")), "{id}");
        session
            .apply(Command::OpenLink(format!("lab=view&a={id}&root_motion=in_place")))
            .expect("a link is never refused");
        while session.work() {}
        let still = motion(&session, 0);
        assert!(still.ground_frames().iter().all(|frame| frame.shift.length() < 1e-3));
        session.apply(Command::Set(vec![(Key::Lab, Value::Choice("path"))])).expect("a lab");
        while session.work() {}
        assert!(number(&session, 0, "fit_rms_cm") < 5.0);
    }
}
