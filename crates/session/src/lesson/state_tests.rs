//! Tests of lessons, by commands.

use crate::choices;
use crate::fixtures::*;
use crate::lesson::Source;

const PAGE: &str = "# One\n\n[Begin](?lab=blend&a=walk&b=run&blend_window=30)\n\n## Try\n\n- [Ten](?blend_window=10) Short.\n- [Loop](?lab=loop&a=walk_left) A loop.\n\n# Two\n\n[Next](?lab=make&gait=run)\n";
const ADDRESS: &str = "https://example.org/steps.md";

fn set(session: &mut Session, values: &[(Key, &str)]) {
    let values =
        values.iter().map(|(key, text)| (*key, key.param().parse(text).unwrap())).collect();
    session.apply(Command::Set(values)).unwrap();
    session.apply(Command::Settle).unwrap();
}

/// Answers the requests for texts, and returns them.
fn deliver(session: &mut Session) -> Vec<Source> {
    let mut asked = Vec::new();
    for request in session.take_requests() {
        if let Request::Lesson(source) = request {
            session.finish_lesson(&source, Ok(PAGE.as_bytes()));
            asked.push(source);
        }
    }
    asked
}

fn opened() -> Session {
    let mut session = Session::new();
    set(&mut session, &[(Key::Lesson, ADDRESS)]);
    deliver(&mut session);
    session
}

fn number_of(session: &Session) -> usize {
    match session.lesson() {
        Some(Lesson::Page(page)) => page.number,
        other => panic!("{other:?}"),
    }
}

#[test]
fn lesson_that_is_chosen_sets_up_the_document_in_one_step() {
    let mut session = Session::new();
    let before = session.query();
    set(&mut session, &[(Key::Lesson, ADDRESS)]);
    assert!(matches!(session.lesson(), Some(Lesson::Waiting)));
    assert_eq!(deliver(&mut session), [Source::Web(ADDRESS.to_owned())]);
    assert_eq!(
        session.query(),
        format!("lesson={ADDRESS}&lab=blend"),
        "the state of the page is that of the table"
    );
    // The second page is in the same file.
    let Some(Lesson::Page(page)) = session.lesson() else { panic!() };
    assert_eq!((page.number, page.of, page.previous), (1, 2, None));
    let next = page.next.unwrap();
    set(&mut session, &[(Key::Lesson, &next)]);
    assert_eq!(session.take_requests(), []);
    assert_eq!(number_of(&session), 2);
    assert_eq!(session.params().lab().word(), "make");
    session.apply(Command::Undo).unwrap();
    assert_eq!((number_of(&session), session.params().lab().word()), (1, "blend"));
    session.apply(Command::Undo).unwrap();
    assert_eq!(session.query(), before);
    assert!(session.lesson().is_none());
}

#[test]
fn link_with_a_state_keeps_it_beside_the_lesson() {
    for (link, window) in [
        (format!("lesson={ADDRESS}&blend_window=77"), 77.0),
        (format!("lesson={ADDRESS}&theme=dark&lang=en"), 30.0),
    ] {
        let mut session = Session::new();
        session.apply(Command::OpenLink(link.clone())).unwrap();
        deliver(&mut session);
        assert_eq!(session.params().number(Key::BlendWindow), window, "{link}");
        assert_eq!(number_of(&session), 1);
        let again = session.query();
        session.apply(Command::OpenLink(again.clone())).unwrap();
        assert_eq!(session.query(), again, "a link reproduces itself");
    }
}

#[test]
fn link_of_the_default_state_does_not_set_up_the_page() {
    let mut session = Session::new();
    set(&mut session, &[(Key::Lesson, &format!("{ADDRESS}#2"))]);
    deliver(&mut session);
    assert_eq!(session.params().lab().word(), "make");
    // All values are the defaults, except that of the lesson.
    set(&mut session, &[(Key::Lab, "blend"), (Key::Gait, "walk")]);
    let link = session.query();
    let mut other = Session::new();
    other.apply(Command::OpenLink(link.clone())).unwrap();
    deliver(&mut other);
    assert_eq!((other.query(), number_of(&other), other.params().lab().word()), (link, 2, "blend"));
}

#[test]
fn link_of_default_state_beside_a_lesson_at_a_later_time_keeps_that_state() {
    let mut session = Session::new();
    session.apply(Command::OpenLink("lesson=2&lab=blend&t=1.25".into())).unwrap();
    let link = session.query();
    assert_eq!(link, "lesson=2&lab=blend");
    session.apply(Command::OpenLink(link.clone())).unwrap();
    assert_eq!(session.query(), link);
}

#[test]
fn link_of_a_lesson_with_playback_and_camera_sets_up_the_page_below_them() {
    let mut session = Session::new();
    session
        .apply(Command::OpenLink(format!("lesson={ADDRESS}%232&play=off&camera_yaw=45&t=0.5")))
        .unwrap();
    deliver(&mut session);
    let params = session.params();
    assert_eq!(params.lab().word(), "make");
    assert_eq!(params.word(Key::Gait), "run");
    assert!(!params.is_on(Key::Play));
    assert_eq!((params.number(Key::CameraYaw), params.number(Key::Time)), (45.0, 0.5));
    let again = session.query();
    session.apply(Command::OpenLink(again.clone())).unwrap();
    assert_eq!(session.query(), again, "a link reproduces itself");
}

#[test]
fn try_applies_its_link_to_the_page_in_one_step() {
    let mut session = opened();
    set(&mut session, &[(Key::Theme, "light"), (Key::Align, "off"), (Key::Look, "bones")]);
    let before = session.query();
    assert!(!session.is_tried("blend_window=10") && !session.is_tried(""));
    session.apply(Command::Try("blend_window=10".into())).unwrap();
    assert!(session.is_tried("blend_window=10") && !session.is_tried(""));
    let params = session.params();
    assert_eq!(params.number(Key::BlendWindow), 10.0);
    assert!(params.is_on(Key::Align), "what no link names is as on the page");
    assert_eq!(
        (params.choice::<choices::PageTheme>().word(), params.choice::<choices::Look>().word()),
        ("light", "bones")
    );
    assert_eq!(params.text(Key::Lesson), ADDRESS);
    session.apply(Command::Try("lab=loop&a=walk_left".into())).unwrap();
    assert_eq!(
        (session.params().lab().word(), session.params().number(Key::BlendWindow)),
        ("loop", 30.0)
    );
    session.apply(Command::Try(String::new())).unwrap();
    assert!(session.is_tried(""));
    for _ in 0..3 {
        session.apply(Command::Undo).unwrap();
    }
    assert_eq!(session.query(), before);
}

#[test]
fn clips_of_the_user_stay_if_no_link_names_others() {
    let bare = "# Any\n\n[Begin](?lab=blend&blend_window=12)\n\n## Try\n\n- [Long](?blend_window=50) Long.\n";
    let mut session = Session::new();
    set(&mut session, &[(Key::A, "jump"), (Key::B, "spin")]);
    set(&mut session, &[(Key::Lesson, ADDRESS)]);
    session.finish_lesson(&Source::Web(ADDRESS.to_owned()), Ok(bare.as_bytes()));
    session.apply(Command::Try("blend_window=50".into())).unwrap();
    let params = session.params();
    assert_eq!((params.text(Key::A), params.text(Key::B)), ("jump", "spin"));
    assert_eq!(params.number(Key::BlendWindow), 50.0);
}

#[test]
fn link_to_another_lesson_opens_it() {
    let mut session = opened();
    session.apply(Command::Try("lesson=half_life".into())).unwrap();
    assert_eq!(session.params().text(Key::Lesson), "half_life");
    assert_eq!(deliver(&mut session), [Source::BuiltIn("en/04-half_life.md".to_owned())]);
    session.set_lesson_language("zh-Hant");
    assert!(matches!(session.lesson(), Some(Lesson::Waiting)));
    assert_eq!(deliver(&mut session), [Source::BuiltIn("zh-Hant/04-half_life.md".to_owned())]);
    let Some(Lesson::Page(page)) = session.lesson() else { panic!() };
    assert_eq!(
        (page.number, page.previous.as_deref(), page.next.as_deref()),
        (4, Some("blend_window"), Some("loops"))
    );
}

#[test]
fn text_that_fails_is_reported_and_requested_again() {
    let mut session = Session::new();
    assert!(session.apply(Command::Try("blend_window=10".into())).is_err(), "no lesson is open");
    let source = Source::Web(ADDRESS.to_owned());
    set(&mut session, &[(Key::Lesson, ADDRESS)]);
    session.take_requests();
    session.finish_lesson(&source, Err("The host cannot be reached.".into()));
    assert!(
        matches!(session.lesson(), Some(Lesson::Failed(reason)) if reason.to_string().contains("reached"))
    );
    set(&mut session, &[(Key::Lesson, "")]);
    set(&mut session, &[(Key::Lesson, ADDRESS)]);
    assert_eq!(session.take_requests(), [Request::Lesson(source.clone())]);
    session.finish_lesson(&source, Ok(b"nothing"));
    assert!(
        matches!(session.lesson(), Some(Lesson::Failed(reason)) if reason.to_string().contains("begins with its title"))
    );
    for (lesson, said) in [("cooking", "expected contents"), (&format!("{ADDRESS}#9"), "page 9")] {
        set(&mut session, &[(Key::Lesson, lesson)]);
        deliver(&mut session);
        assert!(
            matches!(session.lesson(), Some(Lesson::Failed(reason)) if reason.to_string().contains(said)),
            "{lesson}"
        );
    }
    // Invalid values in a link of a lesson are reported, and the others are used.
    let mut session = opened();
    session.apply(Command::Try("blend_window=10&weight_law=steep".into())).unwrap();
    assert_eq!(session.params().number(Key::BlendWindow), 10.0);
    assert!(
        session.notices().list().iter().any(|notice| notice.text.to_string().contains("steep"))
    );
}
