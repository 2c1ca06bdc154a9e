//! Tests of the clips that take A and B, and of the places in the clips before them.

use crate::fixtures::*;
use crate::reading::Content;
use segue_formats::ImportOptions;
use segue_motion::skeleton::Role;

fn opened(link: &str) -> Session {
    let mut session = Session::new();
    session.apply(Command::OpenLink(link.into())).unwrap();
    session
}

fn ids(session: &Session) -> [&str; 2] {
    [session.params().text(Key::A), session.params().text(Key::B)]
}

fn said(session: &Session) -> String {
    let texts: Vec<String> =
        session.notices().list().iter().map(|notice| notice.text.to_string()).collect();
    texts.join("\n")
}

fn set(session: &mut Session, link: &str) {
    session.apply(Command::Set(link::read(link).values)).unwrap();
}

#[test]
fn fetched_file_takes_slots_that_the_link_does_not_name() {
    let mut session = opened("src=https://example.org/x.bvh&a=walk");
    let id = session.load_fetched("x.bvh", made_bvh(1.0)).unwrap().ids.remove(0);
    assert_eq!(ids(&session), ["walk", &id], "A is named, though it is what it would be anyway");
    // Chosen while the file is being fetched.
    let mut session = opened("src=https://example.org/x.bvh");
    session.apply(Command::Assign(Slot::A, "idle".into())).unwrap();
    let id = session.load_fetched("x.bvh", made_bvh(1.0)).unwrap().ids.remove(0);
    assert_eq!(ids(&session), ["idle", &id]);
    let mut session = opened("lab=view&src=https://example.org/x.bvh%20https://example.org/y.bvh");
    let [x, y] =
        [1.0, 2.0].map(|seed| session.load_fetched("x.bvh", made_bvh(seed)).unwrap().ids.remove(0));
    assert_eq!(ids(&session), [x, y]);
    // A dropped file takes the slot of a built-in clip, named or not.
    let mut session = opened("a=walk&b=run");
    let id = session.load("x.bvh", made_bvh(1.0)).unwrap().ids.remove(0);
    assert_eq!(ids(&session), [&id, "run"]);
    // A fetched file that is read elsewhere leaves named slots alone, too.
    let mut session = Session::with_external_reader();
    session.apply(Command::OpenLink("src=https://example.org/x.bvh&a=walk&b=run".into())).unwrap();
    session.load_fetched("x.bvh", made_bvh(1.0)).unwrap();
    serve(&mut session);
    assert!(files(&session).len() == 1 && ids(&session) == ["walk", "run"]);
    // So does a motion whose skeleton arrives after it.
    for (link, wanted) in [("a=walk", ["walk", "01_02"]), ("lab=view&a=walk", ["walk", "01_02"])] {
        for mut session in [Session::new(), Session::with_external_reader()] {
            session.apply(Command::OpenLink(format!("src=https://example.org/x&{link}"))).unwrap();
            for (name, text) in [("01_02.amc", AMC), ("01.asf", ASF)] {
                session.load_fetched(name, bytes(text)).unwrap();
                serve(&mut session);
            }
            assert_eq!(
                ids(&session).map(|id| id.split('~').next().unwrap_or_default()),
                wanted,
                "{link}"
            );
        }
    }
}

#[test]
fn address_removed_from_a_link_leaves_the_others_as_they_are() {
    let mut session =
        opened("src=https://example.org/x.bvh%20https://example.org/y.bvh&a=walk&b=run");
    session.take_requests();
    set(&mut session, "src=https://example.org/y.bvh");
    assert!(
        session.take_requests().iter().all(|request| !matches!(request, Request::Fetch(_))),
        "y is fetched once"
    );
    session.load_fetched("y.bvh", made_bvh(1.0)).unwrap();
    assert_eq!(ids(&session), ["walk", "run"]);
    set(&mut session, "src=https://example.org/y.bvh%20https://example.org/z.bvh");
    let fetched = session.take_requests().into_iter().filter_map(|request| match request {
        Request::Fetch(address) => Some(address),
        _ => None,
    });
    assert_eq!(fetched.collect::<Vec<_>>(), ["https://example.org/z.bvh"]);
}

#[test]
fn slot_that_waits_for_a_clip_takes_no_other() {
    let mut sender = Session::new();
    let awaited = sender.load("mine.bvh", made_bvh(4.0)).unwrap().ids.remove(0);
    for lab in ["blend", "view"] {
        let mut session = opened(&format!("lab={lab}&a={awaited}"));
        let other = session.load("other.bvh", made_bvh(5.0)).unwrap().ids.remove(0);
        assert_eq!(ids(&session), [&awaited, &other], "{lab}");
        assert!(said(&session).contains("drop that file to complete the link"));
        session.load_fetched("x.bvh", made_bvh(6.0)).unwrap();
        session.load("mine.bvh", made_bvh(4.0)).unwrap();
        assert_eq!(ids(&session), [&awaited, &other], "{lab}");
        assert!(!said(&session).contains("drop that file"));
    }
}

#[test]
fn file_fetched_again_after_a_reload_takes_no_slot() {
    let link = "src=https://example.org/x.bvh";
    let mut session = opened(link);
    let id = session.load_fetched("x.bvh", made_bvh(1.0)).unwrap().ids.remove(0);
    session.apply(Command::Assign(Slot::A, "walk".into())).unwrap();
    let mut restored = Session::new();
    restored.restore(&session.saved(), |_| Some(Content::Here(made_bvh(1.0))), None);
    restored.load_fetched("x.bvh", made_bvh(1.0)).unwrap();
    assert_eq!(ids(&restored), ["walk", "run"]);
    assert!(restored.library().get(&id).is_some());
}

#[test]
fn file_loaded_again_keeps_what_was_set_by_hand() {
    let mut session = Session::new();
    let bytes = made_bvh(1.0);
    let id = session.load("x.bvh", Arc::clone(&bytes)).unwrap().ids.remove(0);
    let options = ImportOptions { fps: Some(60.0), ..ImportOptions::default() };
    session.apply(Command::File(FileCommand::Reimport(id.clone(), options))).unwrap();
    session
        .apply(Command::File(FileCommand::SetRoles(id.clone(), vec![(Role::Head, Some(1))])))
        .unwrap();
    session.apply(Command::Rename(id.clone(), "my walk".into())).unwrap();
    let before = Arc::clone(session.library().get(&id).unwrap());
    session.load("x.bvh", Arc::clone(&bytes)).unwrap();
    session.load_fetched("x.bvh", Arc::clone(&bytes)).unwrap();
    let told = |entry: &Entry| {
        (
            entry.name.clone(),
            entry.roles_by_hand.clone(),
            entry.origin.clone(),
            entry.motion.clone(),
        )
    };
    assert_eq!(told(session.library().get(&id).unwrap()), told(&before));

    // A clip that could not be read is read with these roles and this name.
    session.document.library.change(&id, |entry| entry.motion = None);
    session.load("x.bvh", bytes).unwrap();
    assert_eq!(told(session.library().get(&id).unwrap()), told(&before));
}

#[test]
fn slot_with_another_clip_resets_the_places_in_the_last_one() {
    let places = "leave_a=1&enter_b=0.5&mix_frame_a=70&mix_frame_b=20&loop_from=0.5&loop_to=1.5&warp_from=0.5&warp_to=1&pins=12-30\
                  &path=AAUAAADIAfAByAF3yAF3rAI";
    let of_b = "blend_window=12&enter_b=0.5&mix_frame_b=20";
    let mut session = opened(&format!("blend_window=12&{places}"));
    let before = session.query();
    session.apply(Command::Assign(Slot::A, "idle".into())).unwrap();
    assert_eq!(link::read(&session.query()), link::read(&format!("a=idle&{of_b}")));
    session.apply(Command::Undo).unwrap();
    assert_eq!(session.query(), before, "one step");
    session.apply(Command::Assign(Slot::B, "idle".into())).unwrap();
    let left = session.query();
    assert!(!["enter_b", "mix_frame_b", "pins"].iter().any(|key| left.contains(key)), "{left}");
    assert!(
        ["leave_a", "mix_frame_a", "loop_from", "warp_to", "path"]
            .iter()
            .all(|key| left.contains(key)),
        "{left}"
    );
    // Places that are set together with the clip are in that clip.
    set(&mut session, "a=run&leave_a=0.75");
    assert_eq!(session.params().optional(Key::LeaveA), Some(0.75));
    assert_eq!(session.params().optional(Key::LoopFrom), None);
    // The same clip again keeps the places; a file's clip resets them.
    session.apply(Command::Assign(Slot::A, "run".into())).unwrap();
    assert_eq!(session.params().optional(Key::LeaveA), Some(0.75));
    set(&mut session, "pins=1-2");
    session.load("x.bvh", made_bvh(1.0)).unwrap();
    assert_eq!(session.params().optional(Key::LeaveA), None);
    assert_eq!(session.params().pins(), []);
}

#[test]
fn built_in_clip_that_was_removed_returns_when_named() {
    let sample = Session::samples()[2].id;
    let mut session = Session::new();
    // A take is not in the library until it is named.
    for id in ["run", "idle"] {
        session.apply(Command::Remove(id.into())).unwrap();
    }
    let has = |session: &Session, id: &str| session.library().get(id).is_some();
    session.apply(Command::Assign(Slot::A, sample.into())).unwrap();
    assert!(has(&session, sample) && session.params().text(Key::A) == sample);
    session.apply(Command::Undo).unwrap();
    assert!(!has(&session, sample), "the way back is one step");
    session.apply(Command::Redo).unwrap();
    assert!(has(&session, sample));

    session.apply(Command::OpenLink("a=walk&b=run".into())).unwrap();
    settle(&mut session);
    assert!(has(&session, "run") && session.panes()[0].problem.is_none());
    session.apply(Command::OpenLink("lab=graph&clips=walk,idle".into())).unwrap();
    assert!(has(&session, "idle"));

    // Without a link that names it, a removed clip stays removed after a reload.
    session.apply(Command::OpenLink("lab=blend".into())).unwrap();
    session.apply(Command::Remove("idle".into())).unwrap();
    let mut restored = Session::new();
    restored.restore(&session.saved(), |_| None, None);
    settle(&mut restored);
    assert!(!has(&restored, "idle"));
}
