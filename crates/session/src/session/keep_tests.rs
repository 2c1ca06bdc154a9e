//! Results that are kept, and what is made of them.

use crate::fixtures::*;
use segue_motion::math::wrap_angle;

fn opened(link: &str) -> Session {
    let mut session = Session::new();
    session.apply(Command::OpenLink(link.into())).unwrap();
    settle(&mut session);
    assert_eq!(session.panes()[0].problem, None, "{link}");
    session
}

/// Joins a clip to what was kept last, where Segue finds it best, and keeps that.
fn join(session: &mut Session, a: &str, b: &str) -> String {
    let values = vec![(Key::A, Value::Text(a.into())), (Key::B, Value::Text(b.into()))];
    session.apply(Command::Set(values)).unwrap();
    settle(session);
    assert_eq!(session.panes()[0].problem, None, "{}", session.query());
    session.apply(Command::Keep(0)).unwrap();
    session.library().entries().last().unwrap().id.clone()
}

fn motion(session: &Session, id: &str) -> Arc<Motion> {
    session.library().find(id).unwrap().motion.clone().unwrap()
}

/// How far the character has turned at the end, to the left, degrees.
fn turned(motion: &Motion) -> f64 {
    let frames = motion.ground_frames();
    let steps = frames.windows(2).map(|pair| wrap_angle(pair[1].yaw - pair[0].yaw));
    steps.sum::<f64>().to_degrees()
}

#[test]
fn a_sequence_of_kept_results_keeps_its_middle() {
    for lab in [
        "lab=transition",
        "lab=transition&match_by=pose&method=smooth",
        "lab=blend",
        "lab=register&warp_mode=join&end_slack=30",
    ] {
        let mut session = opened(lab);
        let one = join(&mut session, "start", "walk");
        let two = join(&mut session, &one, "walk_left");
        let (first, second) = (motion(&session, &one), motion(&session, &two));
        assert_eq!((first.seams().len(), second.seams().len()), (1, 2), "{lab}");
        let three = join(&mut session, &two, "stop");
        let third = motion(&session, &three);
        let left = session.main_outcome().unwrap().transition.unwrap().leave_a_secs;
        let seam = second.behind_seams() as f64 / second.clip().fps();
        assert!(left + 1e-6 >= seam, "{lab}: {left} s lies before the seam at {seam} s");
        assert_eq!(third.seams()[..2], second.seams()[..], "{lab}");
        let turns = [turned(&first), turned(&second), turned(&third)];
        // What a registered join goes over in is a mixture of both, in which the turn is less.
        let is_mixed = lab.contains("register");
        assert!(
            is_mixed || (turns[1] > turns[0] + 30.0 && turns[2] > turns[0] + 25.0),
            "{lab}: {turns:?}"
        );

        // In front of another clip, too: what was kept is entered before its first seam.
        let after = join(&mut session, "walk", &two);
        let place = session.main_outcome().unwrap().transition.unwrap();
        let first_seam = second.before_seams() as f64 / second.clip().fps();
        assert!(
            place.enter_b_secs <= first_seam + 1e-6,
            "{lab}: {} {first_seam}",
            place.enter_b_secs
        );
        assert_eq!(motion(&session, &after).seams().len(), 3, "{lab}");

        // The link alone brings the same motion back, seams and all.
        let again = opened(&format!("lab=view&a={three}"));
        let again = &again.main_outcome().unwrap().motion;
        assert_eq!(
            (again.clip().root_translations(), again.seams()),
            (third.clip().root_translations(), third.seams()),
            "{lab}"
        );
    }
}

#[test]
fn results_with_a_further_clip_of_a_file_are_kept() {
    let mut session = opened("lab=view&a=walk");
    let bytes = segue_formats::bvh::write(
        motion(&session, "walk").clip(),
        &segue_formats::bvh::WriteOptions::default(),
    );
    let id = session.load("two.bvh", bytes.into_bytes().into()).unwrap().ids.remove(0);
    // As a file with several motions has them.
    let first = Arc::clone(session.library().find(&id).unwrap());
    let Origin::File(file) = &first.origin else { panic!() };
    let second = Entry {
        id: format!("{id}.2"),
        origin: Origin::File(crate::SourceFile { index: 1, ..file.clone() }),
        ..(*first).clone()
    };
    session.document.library.put(second);
    session.apply(Command::Set(vec![(Key::Lab, Value::Choice("blend"))])).unwrap();
    let kept = join(&mut session, "run", &format!("{id}.2"));
    assert!(kept.starts_with("blend(a:run,b:two~"), "{kept}");
    assert!(session.library().get(&kept).is_some());
    // What says that something is here already is true.
    let again = session.apply(Command::Keep(0)).unwrap_err().to_string();
    assert!(again.contains("in the library already"), "{again}");
    session.apply(Command::OpenLink(format!("lab=view&a={id}"))).unwrap();
    settle(&mut session);
    assert_eq!(session.apply(Command::Keep(0)).unwrap_err().to_string(), again);
}

#[test]
fn what_no_link_can_hold_is_not_kept() {
    let mut session = opened("lab=blend&blend_window=8");
    let mut id = "walk".to_owned();
    let refused = (0..10).find_map(|_| {
        let values = vec![(Key::A, Value::Text(id.clone())), (Key::B, Value::Text("walk".into()))];
        session.apply(Command::Set(values)).unwrap();
        settle(&mut session);
        let kept = session.apply(Command::Keep(0));
        id = session.library().entries().last().unwrap().id.clone();
        kept.err()
    });
    assert!(refused.is_some_and(|error| error.to_string().contains("save it as a file")));
    // All that was kept can be made again.
    let last = opened(&format!("lab=view&a={id}"));
    assert_eq!(
        motion(&session, &id).clip().frames(),
        last.main_outcome().unwrap().motion.clip().frames()
    );
}
