//! Tests of files that are read at once, elsewhere, or from an address.

use crate::fixtures::*;
use crate::reading::{LARGE_BYTES, read};

#[test]
fn dropped_files_take_a_then_b_and_keep_their_bytes() {
    let mut session = Session::new();
    let first = session.load("first.bvh", made_bvh(1.0)).unwrap();
    let second = session.load("dir/second.bvh", made_bvh(2.0)).unwrap();
    assert_eq!(session.slot(Slot::A).unwrap().id, first.ids[0]);
    assert_eq!(session.slot(Slot::B).unwrap().id, second.ids[0]);
    assert!(first.ids[0].starts_with("first~") && first.ids[0].len() == "first~".len() + 8);
    settle(&mut session);
    assert!(session.panes().iter().all(|pane| pane.problem.is_none()));
    // A third one joins the library and leaves the rest unchanged.
    session.load("third.bvh", made_bvh(3.0)).unwrap();
    assert_eq!(session.slot(Slot::B).unwrap().id, second.ids[0]);
}

#[test]
fn broken_file_is_named_and_changes_nothing() {
    let mut session = Session::new();
    let (query, clips) = (session.query(), session.clip_infos());
    let error = session
        .load("broken.bvh", Arc::from(&b"HIERARCHY\nROOT Hips\n{\n  OFFSET 0 zero 0\n"[..]))
        .unwrap_err();
    assert!(error.to_string().starts_with("broken.bvh:4:12: found "), "{error}");
    assert_eq!((session.query(), session.clip_infos()), (query, clips));
    assert_eq!(session.notices().list().last().unwrap().level, Level::Error);
}

#[test]
fn link_to_a_dropped_file_waits_for_it() {
    let bytes = made_bvh(4.0);
    let mut sender = Session::new();
    sender.load("mine.bvh", Arc::clone(&bytes)).unwrap();
    blend_window(&mut sender, 24.0);
    let query = sender.query();

    let mut receiver = Session::new();
    receiver.apply(Command::OpenLink(query.clone())).unwrap();
    let notice = receiver.notices().list().last().unwrap();
    assert!(
        notice.text.to_string().contains("mine")
            && notice.text.to_string().contains("drop that file"),
        "{}",
        notice.text
    );
    assert!(receiver.panes()[0].problem.is_some());
    receiver.load("renamed.bvh", bytes).unwrap();
    settle(&mut receiver);
    assert_eq!(
        receiver.slot(Slot::A).map(|entry| entry.sha256().map(str::to_owned)),
        sender.slot(Slot::A).map(|entry| entry.sha256().map(str::to_owned))
    );
    assert_eq!(receiver.panes()[0].problem, None);
    let said: Vec<String> =
        receiver.notices().list().iter().map(|notice| notice.text.to_string()).collect();
    assert!(!said.iter().any(|text| text.contains("drop that file")), "{said:?}");
    assert_eq!(receiver.params().number(Key::BlendWindow), 24.0);
}

#[test]
fn addresses_of_files_are_requested_and_others_refused() {
    let mut session = Session::new();
    session
        .apply(Command::OpenLink("src=https://example.org/a.bvh%20ftp://x/b.bvh".into()))
        .unwrap();
    assert_eq!(session.take_requests(), [Request::Fetch("https://example.org/a.bvh".into())]);
    assert!(
        session
            .notices()
            .list()
            .iter()
            .any(|notice| notice.text.to_string().contains("ftp://x/b.bvh"))
    );
}

#[test]
fn addresses_beyond_the_limit_are_left_out_and_reported() {
    let mut session = Session::new();
    let addresses: Vec<String> =
        (0..300).map(|number| format!("https://example.org/{number}.bvh")).collect();
    session.apply(Command::OpenLink(format!("src={}", addresses.join("%20")))).unwrap();
    let fetched = addresses[..16].iter().cloned().map(Request::Fetch);
    assert_eq!(session.take_requests(), fetched.collect::<Vec<_>>());
    let notices = session.notices().list();
    let told = "The link names 300 files; the first 16 are loaded.";
    assert!(notices.iter().any(|notice| notice.text.to_string() == told));
}

/// Returns the task that the session has just requested.
fn asked(session: &mut Session) -> crate::reading::ReadTask {
    let requests = session.take_requests();
    let task = requests.into_iter().find_map(|request| match request {
        Request::Read(task) => Some(task),
        _ => None,
    });
    task.unwrap()
}

#[test]
fn large_file_is_read_elsewhere_and_joins_the_library() {
    let bytes = made_bvh(6.0);
    let mut session = Session::new();
    let task =
        session.begin_reading("long.bvh", Content::Outside("file 1".into()), LARGE_BYTES + 1);
    let asked_for = asked(&mut session);
    assert_eq!((asked_for.id, asked_for.name.as_str()), (task, "long.bvh"));
    session.progress_reading(task, LARGE_BYTES / 2);
    let job = &session.jobs()[0];
    assert_eq!(
        (job.task, job.kind.name(), job.size),
        (Some(task), "long.bvh", Some(LARGE_BYTES + 1))
    );
    assert!((job.progress - 0.5).abs() < 1e-3);
    let mut report = read("long.bvh", &bytes, &asked_for.setup, &mut |_| true).unwrap();
    report.files[0].size = LARGE_BYTES + 1;
    let sha256 = report.files[0].sha256.clone();
    let loaded = session.finish_reading(task, Ok(report.clone())).unwrap().unwrap();
    assert_eq!(session.slot(Slot::A).unwrap().id, loaded.ids[0]);
    assert!(session.jobs().iter().all(|job| job.task.is_none()));
    let Origin::File(file) = &session.slot(Slot::A).unwrap().origin else { panic!() };
    assert_eq!(
        file.content,
        Content::Outside(sha256.clone()),
        "its bytes are where the platform keeps them"
    );
    assert!(session.finish_reading(task, Ok(report.clone())).is_none(), "once is enough");

    // Correcting its roles reads it again, also elsewhere.
    session
        .apply(Command::File(FileCommand::SetRoles(
            loaded.ids[0].clone(),
            vec![(segue_motion::skeleton::Role::Head, Some(1))],
        )))
        .unwrap();
    let again = asked(&mut session);
    assert_eq!(again.content, Content::Outside(sha256));
    let report = read("long.bvh", &bytes, &again.setup, &mut |_| true).unwrap();
    session.finish_reading(again.id, Ok(report)).unwrap().unwrap();
    let motion = session.slot(Slot::A).unwrap().motion.clone().unwrap();
    assert_eq!(motion.roles().get(segue_motion::skeleton::Role::Head), Some(1));

    // After a reload it is requested again, and available when it was read.
    let mut restored = Session::new();
    restored.restore(&session.saved(), |key| Some(Content::Outside(key.into())), None);
    assert!(
        restored.panes()[0]
            .problem
            .as_ref()
            .is_some_and(|text| text.to_string().contains("being read"))
    );
    let again = asked(&mut restored);
    assert!(
        restored.take_requests().iter().all(|request| !matches!(request, Request::Read(_))),
        "asked once"
    );
    let report = read("long.bvh", &bytes, &again.setup, &mut |_| true).unwrap();
    restored.finish_reading(again.id, Ok(report)).unwrap().unwrap();
    settle(&mut restored);
    assert_eq!(restored.panes()[0].problem, None);
}

#[test]
fn reading_that_is_stopped_changes_nothing() {
    let mut session = Session::new();
    let clips = session.clip_infos();
    let task =
        session.begin_reading("long.bvh", Content::Outside("file 1".into()), LARGE_BYTES + 1);
    session.apply(Command::File(FileCommand::StopReading(task))).unwrap();
    let stop = Request::StopReading { task, forget: Some("file 1".into()) };
    assert!(session.take_requests().contains(&stop));
    assert!(session.finish_reading(task, Err("stopped".into())).is_none());
    assert_eq!(session.clip_infos(), clips);
}

/// Returns a session whose slot A holds a large file from storage that is being read, and the task.
fn with_stored_large_file() -> (Session, crate::reading::ReadTask) {
    let bytes = made_bvh(6.0);
    let mut session = Session::new();
    let task =
        session.begin_reading("long.bvh", Content::Outside("file 1".into()), LARGE_BYTES + 1);
    let setup = asked(&mut session).setup;
    session
        .finish_reading(task, Ok(read("long.bvh", &bytes, &setup, &mut |_| true).unwrap()))
        .unwrap()
        .unwrap();
    let mut restored = Session::new();
    restored.restore(&session.saved(), |key| Some(Content::Outside(key.into())), None);
    let task = asked(&mut restored);
    (restored, task)
}

#[test]
fn stored_file_that_cannot_be_read_is_tried_once() {
    let reads = |session: &mut Session| {
        session.take_requests().iter().filter(|request| matches!(request, Request::Read(_))).count()
    };
    let (mut session, task) = with_stored_large_file();
    session.finish_reading(task.id, Err("it is gone".into())).unwrap().unwrap_err();
    blend_window(&mut session, 20.0);
    assert_eq!(reads(&mut session), 0);
    assert!(
        session.panes()[0]
            .problem
            .as_ref()
            .is_some_and(|text| text.to_string().contains("it is gone")),
        "{:?}",
        session.panes()[0].problem
    );

    let (mut session, task) = with_stored_large_file();
    session.apply(Command::File(FileCommand::StopReading(task.id))).unwrap();
    blend_window(&mut session, 20.0);
    assert_eq!(reads(&mut session), 0);
    assert!(
        session.panes()[0]
            .problem
            .as_ref()
            .is_some_and(|text| text.to_string().contains("stopped"))
    );
    // By hand it can be requested once more.
    let id = session.slot(Slot::A).unwrap().id.clone();
    session
        .apply(Command::File(FileCommand::Reimport(id, segue_formats::ImportOptions::default())))
        .unwrap();
    assert_eq!(reads(&mut session), 1);
}
