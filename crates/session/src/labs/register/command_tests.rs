//! Tests of the Register lab, by commands.

use crate::JobKind;
use crate::RegistrationFacts;
use crate::fixtures::*;
use segue_motion::clip::{Clip, ground_speed};
use segue_motion::math::Planar;
use segue_motion::skeleton::Side;
use segue_text::ToMessage;

fn registered(session: &Session) -> &RegistrationFacts {
    session.main_outcome().unwrap().registered().unwrap()
}

/// Returns the largest distance of any joint, metres, between a frame of one clip and a frame of
/// another that is moved.
fn apart(one: &Clip, frame: usize, other: &Clip, in_other: usize, moved: &Planar) -> f32 {
    let (a, b) =
        (one.world_positions(frame..frame + 1), other.world_positions(in_other..in_other + 1));
    a.iter().zip(&b).map(|(a, b)| a.distance(moved.apply(*b))).fold(0.0, f32::max)
}

/// Returns the times of the strikes inside the result, seconds.
fn strikes(session: &Session, of: Option<Slot>, side: Side) -> Vec<f64> {
    let stances = registered(session).stances(of, side);
    stances.into_iter().map(|stance| stance.start).filter(|&at| at > 0.0).collect()
}

#[test]
fn walk_is_registered_to_a_run_at_once() {
    let session = opened("lab=register");
    assert_eq!(session.panes()[0].problem, None);
    let plain = opened("lab=register&warp_with=plain");
    let skate = |session: &Session| number_of(session.main_outcome().unwrap(), MetricId::FootSlide);
    assert!(skate(&session) < 0.5 * skate(&plain), "{} {}", skate(&session), skate(&plain));
    let cm =
        |session: &Session| number_of(session.main_outcome().unwrap(), MetricId::FrameDistance);
    assert!(cm(&session) < 0.7 * cm(&plain), "{} {}", cm(&session), cm(&plain));
    // Every strike of the result is one of A and one of B. Without the time warp they come apart.
    let worst = |session: &Session| {
        let sides = Side::BOTH.into_iter();
        let off = sides.flat_map(|side| {
            let of_b = strikes(session, Some(Slot::B), side);
            let of_a = strikes(session, Some(Slot::A), side);
            of_a.into_iter()
                .map(move |a| of_b.iter().map(|b| (a - b).abs()).fold(f64::INFINITY, f64::min))
        });
        off.fold(0.0, f64::max)
    };
    assert!(worst(&session) < 0.16 && worst(&plain) > 0.2, "{} {}", worst(&session), worst(&plain));
    let registered = registered(&session);
    assert!(registered.frame_pairs.windows(2).all(|pair| pair[1].frames[0] > pair[0].frames[0]));
    // From a pair to the time that shows it, and back.
    let at = registered.frame_pair_at(1.0).unwrap();
    assert!((registered.secs_near(at.frames).unwrap() - 1.0).abs() < 0.02);
    assert_eq!(registered.frame_pair_at(f64::NAN), registered.frame_pairs.first().copied());
}

#[test]
fn weight_of_none_gives_a_and_of_all_gives_b() {
    for (link, slot) in [
        ("lab=register&ends=corner&b=walk(gait_speed:1.6)&warp_weight=0", Slot::A),
        ("lab=register&ends=corner&b=walk(gait_speed:1.6)&warp_weight=1", Slot::B),
        ("lab=register&warp_weight=0", Slot::A),
        ("lab=register&warp_weight=1", Slot::B),
    ] {
        let session = opened(link);
        let outcome = session.main_outcome().unwrap();
        let of = &session.slot(slot).unwrap().motion.as_ref().unwrap();
        let clip = usize::from(slot == Slot::B);
        let first = registered(&session).frame_pairs[0].frames[clip];
        assert!((first - first.round()).abs() < 1e-5, "{first}");
        let first = first.round() as usize;
        if link.contains("corner") {
            assert_eq!((first, outcome.motion.clip().frames()), (0, of.clip().frames()));
        }
        let stands = |motion: &Motion, frame: usize| motion.ground_frames()[frame];
        let moved = stands(&outcome.motion, 0).after(&stands(of, first).inverse());
        for frame in 0..outcome.motion.clip().frames() {
            let off = apart(outcome.motion.clip(), frame, of.clip(), first + frame, &moved);
            assert!(off < 1e-4, "{link}, frame {frame}: {off} m");
        }
    }
}

#[test]
fn join_slides_less_than_a_dissolve() {
    let session = opened("lab=register&warp_mode=join&compare=warp_with:registered,plain");
    let outcomes: Vec<_> =
        session.panes().iter().map(|pane| pane.outcome.clone().unwrap()).collect();
    let skate = |pane: usize| number_of(&outcomes[pane], MetricId::FootSlide);
    assert!(skate(0) < 0.5 * skate(1), "{} {}", skate(0), skate(1));
    for outcome in &outcomes {
        let (registered, transition) = (outcome.registered().unwrap(), outcome.transition.unwrap());
        assert_eq!(registered.frame_pairs.len(), outcome.motion.clip().frames());
        assert_eq!(outcome.motion.ground_frames().len(), outcome.motion.clip().frames());
        let at = |secs: f64| registered.frame_pair_at(secs).unwrap();
        assert_eq!(
            (at(0.0).weights, at(outcome.duration_secs()).weights),
            ([1.0, 0.0], [0.0, 1.0])
        );
        assert_eq!(at(0.0).frames[0], 0.0);
        assert!(
            (at(transition.start_secs).frames[0] / 60.0 - registered.part_secs[0]).abs() < 1e-6
        );
        let walk = session.slot(Slot::A).unwrap().motion.clone().unwrap();
        for frame in 0..(transition.start_secs * 60.0) as usize {
            assert!(
                apart(outcome.motion.clip(), frame, walk.clip(), frame, &Planar::IDENTITY) < 1e-5
            );
        }
    }
    // Found by Segue, and set by hand.
    assert!(
        session.automatic_value(Key::WarpFrom).unwrap()
            < session.automatic_value(Key::WarpTo).unwrap()
    );
    let by_hand = opened("lab=register&warp_mode=join&warp_from=1&warp_to=2");
    assert_eq!(registered(&by_hand).part_secs, [1.0, 2.0]);
    let back = opened("lab=register&warp_mode=join&warp_from=2&warp_to=1");
    let problem = back.panes()[0].problem.clone().unwrap();
    assert!(problem.to_string().contains("move its end after its beginning"), "{problem}");
}

#[test]
fn pins_of_a_link_are_on_the_curve() {
    let session = opened("lab=register&pins=100-92,40-60");
    assert_eq!(session.params().pins(), [(100, 92), (40, 60)]);
    let warp = registered(&session).registration.warp();
    assert!((warp.at(100.0) - 92.0).abs() < 1e-6 && (warp.at(40.0) - 60.0).abs() < 1e-6);
    let query = session.query();
    assert!(query.contains("pins=100-92,40-60"), "{query}");
    let again = opened(&query);
    assert_eq!(registered(&again).frame_pairs, registered(&session).frame_pairs);
}

#[test]
fn impossible_registration_is_refused_and_shows_no_earlier_result() {
    let mut session = opened("lab=register");
    for (key, value, sentence) in [
        (Key::Pins, "100-90,120-80", "The pins at frames 100 | 90 and 120 | 80 exclude each other"),
        (Key::Pins, "5-9999", "The pin at frames 5 | 9999 lies beyond the clips"),
        (Key::Pins, "100-90,110-170", "raise the slope limit to"),
        (Key::B, "idle(make_seconds:1)", "No path with a slope limit of 1"),
    ] {
        assert!(session.panes()[0].result().is_ok());
        let mut values = vec![(key, key.param().parse(value).unwrap())];
        if key == Key::B {
            values.extend([
                (Key::SlopeLimit, Value::Number(1.0)),
                (Key::Ends, Value::Choice("corner")),
            ]);
            session.document.ensure_clip(value);
        }
        session.apply(Command::Set(values)).unwrap();
        while session.work() {}
        let pane = &session.panes()[0];
        let problem = pane.problem.as_ref().map(|problem| problem.to_sentence().to_string());
        let problem = problem.unwrap_or_default();
        assert!(problem.contains(sentence), "{value}: {problem}");
        assert!(pane.outcome.is_none());
        let map = session.distance_map().unwrap();
        assert!(!map.make_picture(), "the session has made it, so that no frame has to");
        session.apply(Command::Reset(key)).unwrap();
        while session.work() {}
    }
    // Too short for the window.
    let short = opened("lab=register&b=walk(make_seconds:1)&registration_window=121");
    let problem = short.panes()[0].problem.clone().unwrap();
    assert!(problem.to_string().contains("shorter than the window of 121 frames"), "{problem}");
}

#[test]
fn long_clips_are_registered_in_slices() {
    let mut session = Session::new();
    let link = "lab=register&a=walk(make_seconds:9)&b=walk(make_seconds:9,gait_speed:1.6)";
    session.apply(Command::OpenLink(link.into())).unwrap();
    while session.work() {}
    let first = session.main_outcome().cloned().unwrap();
    // Another window reuses the products of frames; the old result stays until the new one is
    // available.
    let slices = |session: &mut Session, key, value| {
        session.apply(Command::Set(vec![(key, Value::Number(value))])).unwrap();
        let before = session.main_outcome().cloned().unwrap();
        let (mut count, mut progress) = (0, -1.0);
        while let Some(job) =
            session.jobs().into_iter().find(|job| job.kind == JobKind::Registering)
        {
            assert!(job.progress >= progress && session.panes()[0].problem.is_none());
            assert!(Arc::ptr_eq(&before, session.main_outcome().unwrap()));
            progress = job.progress;
            assert!(session.work());
            count += 1;
        }
        while session.work() {}
        assert!(!Arc::ptr_eq(&before, session.main_outcome().unwrap()));
        count
    };
    let for_window = slices(&mut session, Key::RegistrationWindow, 9.0);
    let for_path = slices(&mut session, Key::SlopeLimit, 3.0);
    assert!(for_path > 3 && for_window > for_path + 3, "{for_window} {for_path}");
    // Computed all at once, the result is the same.
    session.apply(Command::OpenLink(link.into())).unwrap();
    while session.work() {}
    assert_eq!(session.main_outcome().unwrap().motion, first.motion);
    // No work is done for a lab that was left.
    session.apply(Command::Set(vec![(Key::RegistrationWindow, Value::Number(15.0))])).unwrap();
    session.apply(Command::Set(vec![(Key::Lab, Value::Choice("view"))])).unwrap();
    assert!(session.jobs().is_empty());
}

#[test]
fn weight_curve_changes_the_weight_over_the_blend() {
    let session = opened("lab=register&warp_curve=0-0,50-100,100-20");
    let weights: Vec<f64> =
        registered(&session).frame_pairs.iter().map(|frame_pair| frame_pair.weights[1]).collect();
    let last = weights.len() - 1;
    assert!(
        weights[0] < 1e-9 && weights[last / 2] > 0.99 && (weights[last] - 0.2).abs() < 0.01,
        "{weights:?}"
    );
}

#[test]
fn further_clips_are_blended_with_two() {
    let three = "lab=register&a=walk&b=run&warp_weight=0.25&warp_also=0.5:fast_walk";
    let session = opened(three);
    let of = |session: &Session| registered(session).frame_pairs[0].weights;
    assert_eq!(of(&session), [0.25, 0.25]);
    // With all of the weight the third clip plays alone, at its own speed.
    let speed = |session: &Session| {
        let motion = &session.main_outcome().unwrap().motion;
        ground_speed(motion.ground_frames(), motion.clip().fps())
    };
    let alone = opened("lab=register&a=walk&b=run&warp_weight=0&warp_also=1:fast_walk");
    let fast = opened("lab=view&a=fast_walk");
    assert!((speed(&alone) - speed(&fast)).abs() < 0.03, "{} {}", speed(&alone), speed(&fast));
    assert!(session.main_outcome().unwrap().motion.clip().name().contains(" + "), "both are named");
    // A kept result is restored from its id.
    let mut session = session;
    session.apply(Command::Keep(0)).unwrap();
    let id = session.library().entries().last().unwrap().id.clone();
    assert!(id.contains("warp_also:"), "{id}");
    let before = session.main_outcome().unwrap().motion.clip().clone();
    let again = opened(&format!(
        "lab=view&a={}",
        percent_encoding::utf8_percent_encode(&id, percent_encoding::NON_ALPHANUMERIC)
    ));
    assert_eq!(again.main_outcome().unwrap().motion.clip().rotations(20), before.rotations(20));
    let missing = opened("lab=register&warp_also=0.5:nobody").panes()[0].problem.clone().unwrap();
    assert!(missing.to_string().contains("nobody"), "{missing}");
}
