//! Tests of results that are kept, and of results made from them.

use crate::fixtures::*;
use segue_motion::math::wrap_angle;
use segue_motion::skeleton::Role;

/// Joins a clip to the last kept one, at the place that Segue finds, and keeps the result. Returns
/// its id.
fn join(session: &mut Session, a: &str, b: &str) -> String {
    let values = vec![(Key::A, Value::Text(a.into())), (Key::B, Value::Text(b.into()))];
    session.apply(Command::Set(values)).unwrap();
    settle(session);
    assert_eq!(session.panes()[0].problem, None, "{}", session.query());
    let id = session.result_id(0).unwrap();
    session.apply(Command::Keep(0)).unwrap();
    assert_eq!(session.library().entries().last().unwrap().id, id);
    id
}

fn motion(session: &Session, id: &str) -> Arc<Motion> {
    session.library().find(id).unwrap().motion.clone().unwrap()
}

/// Returns how far the character has turned to the left at the end, degrees.
fn turned(motion: &Motion) -> f64 {
    let frames = motion.ground_frames();
    let steps = frames.windows(2).map(|pair| wrap_angle(pair[1].yaw - pair[0].yaw));
    steps.sum::<f64>().to_degrees()
}

#[test]
fn sequence_of_kept_results_keeps_its_middle() {
    for lab in [
        "lab=transition",
        "lab=transition&match_by=pose&method=smooth",
        "lab=blend",
        "lab=register&warp_mode=join&end_slack=30",
    ] {
        let mut session = opened_without_problems(lab);
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
        // In a registered join both clips are mixed, which turns less.
        let is_mixed = lab.contains("register");
        assert!(
            is_mixed || (turns[1] > turns[0] + 30.0 && turns[2] > turns[0] + 25.0),
            "{lab}: {turns:?}"
        );

        // Before another clip, too: the kept clip is entered before its first seam.
        let after = join(&mut session, "walk", &two);
        let place = session.main_outcome().unwrap().transition.unwrap();
        let first_seam = second.before_seams() as f64 / second.clip().fps();
        assert!(
            place.enter_b_secs <= first_seam + 1e-6,
            "{lab}: {} {first_seam}",
            place.enter_b_secs
        );
        assert_eq!(motion(&session, &after).seams().len(), 3, "{lab}");

        // The link alone restores the same motion, including its seams.
        let again = opened_without_problems(&format!("lab=view&a={three}"));
        let again = &again.main_outcome().unwrap().motion;
        assert_eq!(
            (again.clip().root_translations(), again.seams()),
            (third.clip().root_translations(), third.seams()),
            "{lab}"
        );
    }
}

#[test]
fn role_corrected_by_hand_keeps_the_seams_of_a_kept_result() {
    let mut session = opened_without_problems("lab=blend");
    let id = join(&mut session, "start", "walk");
    let seams = motion(&session, &id).seams().to_vec();
    assert_eq!(seams.len(), 1);
    let correction = FileCommand::SetRoles(id.clone(), vec![(Role::Head, None)]);
    session.apply(Command::File(correction)).unwrap();
    // After a reload, the result is made again from its recipe.
    let mut restored = Session::new();
    restored.restore(&session.saved(), |_| None, Some(&format!("lab=view&a={id}")));
    settle(&mut restored);
    for session in [&session, &restored] {
        let corrected = motion(session, &id);
        assert_eq!((corrected.roles().get(Role::Head), corrected.seams()), (None, &*seams));
    }
}

#[test]
fn results_with_a_further_clip_of_a_file_are_kept() {
    let mut session = opened_without_problems("lab=view&a=walk");
    let bytes = segue_formats::bvh::write(
        motion(&session, "walk").clip(),
        &segue_formats::bvh::WriteOptions::default(),
    );
    let id = session.load("two.bvh", bytes.into_bytes().into()).unwrap().ids.remove(0);
    // The same name as in a file with several motions.
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
    // The message that a clip is already in the library is true.
    let again = session.apply(Command::Keep(0)).unwrap_err().to_string();
    assert!(again.contains("in the library already"), "{again}");
    session.apply(Command::OpenLink(format!("lab=view&a={id}"))).unwrap();
    settle(&mut session);
    assert_eq!(session.apply(Command::Keep(0)).unwrap_err().to_string(), again);
}

#[test]
fn result_that_no_link_can_contain_is_not_kept() {
    let mut session = opened_without_problems("lab=blend&blend_window=8");
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
    // Everything that was kept can be made again.
    let last = opened_without_problems(&format!("lab=view&a={id}"));
    assert_eq!(
        motion(&session, &id).clip().frames(),
        last.main_outcome().unwrap().motion.clip().frames()
    );
}

#[test]
fn synthesised_clips_are_kept_and_contained_in_links() {
    let mut session = Session::new();
    session.apply(Command::OpenLink("lab=make&gait=run&turn_rate=20".into())).unwrap();
    session.apply(Command::Keep(0)).unwrap();
    let id = "run(turn_rate:20)";
    assert!(session.library().find(id).is_some());
    let mut other = Session::new();
    other.apply(Command::OpenLink(format!("lab=view&a={id}"))).unwrap();
    assert_eq!(other.panes()[0].problem, None);
    assert_eq!(
        other.main_outcome().unwrap().motion.clip().rotations(9),
        session.main_outcome().unwrap().motion.clip().rotations(9)
    );
}

#[test]
fn results_of_every_lab_are_kept_as_recipes() {
    for (link, id) in [
        (
            "lab=blend&blend_window=12&leave_a=1.5&enter_b=0.5",
            "blend(a:walk,b:run,blend_window:12,leave_a:1.5,enter_b:0.5)",
        ),
        (
            "lab=loop&a=run&loop_method=linear&loop_from=0.5&loop_to=1.5",
            "loop(a:run,loop_from:0.5,loop_to:1.5,loop_method:linear)",
        ),
        (
            "lab=layers&mask=arms&foot_lock=on&lock_reach=12&lock_clearance=0",
            "layers(a:walk,b:run,foot_lock:on,lock_reach:12,lock_clearance:0,mask:arms)",
        ),
        // Nothing is locked.
        ("lab=layers&mask=arms&lock_reach=12", "layers(a:walk,b:run,mask:arms)"),
        ("lab=view&root_motion=in_place", "view(a:walk,root_motion:in_place)"),
        ("lab=register&warp_weight=0.3", "register(a:walk,b:run,warp_weight:0.3)"),
        ("lab=speed&speed=2", "speed(a:walk,b:run,speed:2)"),
        ("lab=in_place&root_way_turn=off", "in_place(a:walk,root_way_turn:off)"),
        ("lab=edit&mirror=on&turn=45", "edit(a:walk,mirror:on,turn:45)"),
        (
            "lab=transition&method=cubic&mix_frame_a=70&mix_frame_b=20",
            "transition(a:walk,b:run,method:cubic,mix_frame_a:70,mix_frame_b:20)",
        ),
    ] {
        let mut session = Session::new();
        session.apply(Command::OpenLink(link.into())).unwrap();
        settle(&mut session);
        session.apply(Command::Keep(0)).unwrap();
        assert!(
            session.library().find(id).is_some(),
            "{link}: {:?}",
            session.library().entries().last().map(|entry| &entry.id)
        );
        assert!(session.apply(Command::Keep(0)).is_err(), "a second one of the same");
        // A session that opens a link to it has none of the data, and makes the same motion.
        let mut other = Session::new();
        other.apply(Command::OpenLink(format!("lab=view&a={id}"))).unwrap();
        settle(&mut other);
        assert_eq!(other.panes()[0].problem, None, "{id}");
        let clip = |session: &Session| Arc::clone(session.main_outcome().unwrap().motion.clip());
        assert_eq!(clip(&other).frames(), clip(&session).frames(), "{id}");
        assert_eq!(clip(&other).rotations(40), clip(&session).rotations(40), "{id}");
    }
}

#[test]
fn automatic_values_are_part_of_the_recipe() {
    for (lab, named) in [
        ("blend", "leave_a"),
        ("transition", "mix_frame_b"),
        ("loop", "loop_to"),
        ("speed", "speed"),
    ] {
        let mut session = Session::new();
        session.apply(Command::OpenLink(format!("lab={lab}"))).unwrap();
        settle(&mut session);
        session.apply(Command::Keep(0)).unwrap();
        let kept = Arc::clone(session.library().entries().last().unwrap());
        assert!(kept.id.contains(&format!("{named}:")), "{}", kept.id);
        // Kept from a kept result, the link still contains everything.
        session
            .apply(Command::OpenLink(format!(
                "lab=transition&a={}&b=run&mix_frame_a=9&mix_frame_b=9",
                kept.id
            )))
            .unwrap();
        settle(&mut session);
        session.apply(Command::Keep(0)).unwrap();
        let twice = session.library().entries().last().unwrap().id.clone();
        assert!(twice.contains(&kept.id), "{twice}");
        let mut other = Session::new();
        other.apply(Command::OpenLink(format!("lab=view&a={twice}"))).unwrap();
        settle(&mut other);
        assert_eq!(other.panes()[0].problem, None, "{twice}");
        assert_eq!(
            other.main_outcome().unwrap().motion.clip().root_translations().last(),
            session.main_outcome().unwrap().motion.clip().root_translations().last(),
            "{twice}"
        );
    }
}
