//! Tests of files that are read outside the session, and of changes meanwhile.

use super::fixtures::{BVH, count_notices, older, person, stored, zip};
use crate::fixtures::*;
use std::io::Write as _;

/// Names and bytes of dropped files.
type Dropped<'a> = &'a [(&'a str, Arc<[u8]>)];

/// Returns the clips of files in the library, and the clips in A and B.
fn shown(session: &Session) -> (Vec<(String, &'static str, usize)>, [String; 2]) {
    (files(session), [Key::A, Key::B].map(|key| session.params().text(key).to_owned()))
}

#[test]
fn files_read_elsewhere_give_the_same_as_files_read_at_once() {
    let packed = {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        encoder.write_all(BVH.as_bytes()).unwrap();
        Arc::<[u8]>::from(encoder.finish().unwrap())
    };
    let archive = Arc::<[u8]>::from(zip(&[("01_03.amc", AMC)]));
    let dropped: [Dropped<'_>; 6] = [
        &[("walk.bvh", bytes(BVH))],
        &[("01_02.amc", bytes(AMC)), ("01.asf", bytes(ASF))],
        &[("01.asf", bytes(ASF)), ("01_02.amc", bytes(AMC))],
        &[("01.asf", bytes(ASF)), ("takes.zip", archive)],
        &[("person.glb", person(60))],
        &[("walk.bvh.gz", packed), ("broken.bvh", bytes("HIERARCHY ROOT"))],
    ];
    for files in dropped {
        let (mut at_once, mut elsewhere) = (Session::new(), Session::with_external_reader());
        for (name, bytes) in files {
            at_once.load(name, Arc::clone(bytes)).ok();
            assert_eq!(
                elsewhere.load(name, Arc::clone(bytes)),
                Ok(LoadedFile::default()),
                "it is asked for"
            );
        }
        assert!(elsewhere.clip_infos().iter().all(|info| info.sha256.is_none()));
        serve(&mut elsewhere);
        assert_eq!(shown(&elsewhere), shown(&at_once));
        assert_eq!(count_notices(&elsewhere, Level::Error), count_notices(&at_once, Level::Error));
        assert!(elsewhere.jobs().iter().all(|job| job.task.is_none()));

        // After a reload, and read with other options.
        let mut restored = Session::with_external_reader();
        restored.restore(&elsewhere.saved(), stored(&at_once), None);
        serve(&mut restored);
        assert_eq!(shown(&restored), shown(&at_once));
        let id = restored.clip_infos().into_iter().find(|info| info.sha256.is_some()).unwrap().id;
        let options = segue_formats::ImportOptions { fps: Some(60.0), ..Default::default() };
        restored.apply(Command::File(FileCommand::Reimport(id.clone(), options))).unwrap();
        serve(&mut restored);
        assert_eq!(restored.clip_infos().into_iter().find(|info| info.id == id).unwrap().fps, 60.0);
    }
}

#[test]
fn bundled_take_that_cannot_be_read_is_requested_by_the_next_command_only() {
    let sample = &Session::samples()[2];
    let mut session = Session::with_external_reader();
    session.apply(Command::Assign(Slot::A, sample.id.into())).unwrap();
    assert!(session.take_requests().contains(&Request::Sample(sample)));
    session.load_sample(sample, b"").unwrap();
    let Some(Request::Read(task)) = session.take_requests().pop() else { panic!() };
    session
        .finish_reading(task.id, Err("the worker could not be started".into()))
        .unwrap()
        .unwrap_err();
    assert!(session.take_requests().is_empty() && !session.is_reading_small());
    session.load_sample(sample, b"").unwrap();
    serve(&mut session);
    assert!(
        session.take_requests().is_empty() && !session.is_reading_small(),
        "nor where it is damaged"
    );
    session.apply(Command::Set(vec![(Key::BlendTime, Value::Number(0.6))])).unwrap();
    assert!(session.take_requests().contains(&Request::Sample(sample)));
}

#[test]
fn clips_that_were_read_stay_read_after_undo() {
    let mut session = Session::with_external_reader();
    session.load("walk.bvh", bytes(BVH)).unwrap();
    session.load("01.asf", bytes(ASF)).unwrap();
    session.load("01_02.amc", bytes(AMC)).unwrap();
    serve(&mut session);
    let unread =
        |session: &Session| files(session).iter().filter(|(.., frames)| *frames == 0).count();
    let (mut before, mut late) = (Session::with_external_reader(), Session::with_external_reader());
    // Nothing is known of clips that an earlier version has stored.
    let saved = older(&session.saved());
    before.restore(&saved, stored(&session), None);
    // Something changes while they are read, or before they arrive.
    let change = |session: &mut Session| {
        session.apply(Command::Set(vec![(Key::BlendWindow, Value::Number(9.0))])).unwrap();
    };
    change(&mut before);
    change(&mut late);
    late.restore_late(&saved, stored(&session));
    for mut session in [before, late] {
        assert_eq!(unread(&session), 2);
        serve(&mut session);
        assert_eq!(unread(&session), 0);
        session.apply(Command::Undo).unwrap();
        assert_eq!(unread(&session), 0);
        session.apply(Command::Redo).unwrap();
        assert_eq!(unread(&session), 0);
    }
}

#[test]
fn options_changed_while_a_file_is_read_take_effect() {
    let mut session = Session::with_external_reader();
    session.load("walk.bvh", bytes(BVH)).unwrap();
    serve(&mut session);
    let id = session.clip_infos().into_iter().find(|info| info.sha256.is_some()).unwrap().id;
    let fps_of = |session: &Session| {
        session.clip_infos().into_iter().find(|info| info.id == id).unwrap().fps
    };
    let options_of = |session: &Session| match &session.library().get(&id).unwrap().origin {
        Origin::File(file) => file.options,
        _ => panic!(),
    };
    let reimport = |session: &mut Session, fps: Option<f64>, metres_per_unit: Option<f64>| {
        let options = segue_formats::ImportOptions { metres_per_unit, fps, ..options_of(session) };
        session.apply(Command::File(FileCommand::Reimport(id.clone(), options))).unwrap();
    };
    reimport(&mut session, Some(60.0), None);
    reimport(&mut session, Some(60.0), Some(0.5));
    serve(&mut session);
    assert_eq!((fps_of(&session), options_of(&session).metres_per_unit), (60.0, Some(0.5)));
    // Taken back before its report has arrived, the report is ignored.
    reimport(&mut session, Some(90.0), Some(0.5));
    session.apply(Command::Undo).unwrap();
    serve(&mut session);
    assert_eq!(fps_of(&session), 60.0);
    session.apply(Command::Undo).unwrap();
    session.apply(Command::Undo).unwrap();
    serve(&mut session);
    assert_eq!(
        (fps_of(&session), options_of(&session)),
        (10.0, segue_formats::ImportOptions::default())
    );
}

#[test]
fn bundled_take_is_read_elsewhere_without_a_notice() {
    let sample = &Session::samples()[2];
    let packed = std::fs::read(format!(
        "{}/../../assets/samples/{}",
        env!("CARGO_MANIFEST_DIR"),
        sample.file
    ))
    .unwrap();
    let mut session = Session::with_external_reader();
    session.apply(Command::Assign(Slot::A, sample.id.into())).unwrap();
    let asks = |session: &mut Session| session.take_requests().contains(&Request::Sample(sample));
    assert!(asks(&mut session));
    session.load_sample(sample, &packed).unwrap();
    assert!(session.is_reading_small() && session.jobs().is_empty());
    session.apply(Command::Set(vec![(Key::BlendTime, Value::Number(0.6))])).unwrap();
    let told = session.notices().list().len();
    let reads: Vec<_> = session.take_requests();
    assert!(!reads.contains(&Request::Sample(sample)), "it has come");
    let Some(Request::Read(task)) =
        reads.into_iter().find(|request| matches!(request, Request::Read(_)))
    else {
        panic!()
    };
    let report = crate::reading::read(&task.name, &packed, &task.setup, &mut |_| true).unwrap();
    session.finish_reading(task.id, Ok(report)).unwrap().unwrap();
    assert!(session.library().get(sample.id).unwrap().motion.is_some());
    assert_eq!(session.notices().list().len(), told);
    assert!(!session.is_reading_small());
}
