//! Tests of motions that are dropped while nothing uses them, and of libraries that are known
//! without them.

use super::fixtures::{BVH, older, stored};
use crate::fixtures::*;
use crate::memory::PageMemory;
use crate::reading::{LARGE_BYTES, ReadTask, read};
use crate::saved::Saved;
use segue_formats::bvh;
use segue_motion::synth::{Action, Params as SynthParams, synthesize};

/// Returns a walk of that speed as a file.
fn walk(speed_mps: f64) -> Arc<[u8]> {
    let params = SynthParams { speed_mps: speed_mps as f32, ..SynthParams::new(Action::Walk) };
    let made = synthesize(&params).unwrap();
    bvh::write(&made.clip, &bvh::WriteOptions::default()).into_bytes().into()
}

/// Returns a session that reads elsewhere, with that many walks, and their ids.
fn library_of(count: usize) -> (Session, Vec<String>) {
    let mut session = Session::with_external_reader();
    session.apply(Command::OpenLink("lab=view&a=walk&b=run".into())).unwrap();
    session.open_together(count);
    for index in 0..count {
        session.load(&format!("{index}.bvh"), walk(1.0 + 0.05 * index as f64)).unwrap();
    }
    serve_all(&mut session);
    // The first ones have taken A and B.
    session.apply(Command::OpenLink("lab=view&a=walk&b=run".into())).unwrap();
    let own = session.clip_infos().into_iter().filter(|info| info.sha256.is_some());
    let ids = own.map(|info| info.id).collect();
    (session, ids)
}

/// Returns the files that are requested to be read.
fn requested(session: &mut Session) -> Vec<ReadTask> {
    let reads = session.take_requests().into_iter().filter_map(|request| match request {
        Request::Read(task) => Some(task),
        _ => None,
    });
    reads.collect()
}

/// Reads all requested files. Returns their names.
fn serve_all(session: &mut Session) -> Vec<String> {
    let mut names = Vec::new();
    loop {
        let tasks = requested(session);
        if tasks.is_empty() {
            settle(session);
            return names;
        }
        for task in tasks {
            let Content::Here(bytes) = &task.content else { panic!("{task:?}") };
            let report = read(&task.name, bytes, &task.setup, &mut |_| true).unwrap();
            session.finish_reading(task.id, Ok(report)).unwrap().unwrap();
            names.push(task.name);
        }
    }
}

fn motion(session: &Session, id: &str) -> Option<Arc<Motion>> {
    session.library().get(id).unwrap().motion.clone()
}

/// Returns a letter for each clip: `x` with its motion, `.` without.
fn held(session: &Session, ids: &[String]) -> String {
    ids.iter().map(|id| if motion(session, id).is_some() { 'x' } else { '.' }).collect()
}

fn show(session: &mut Session, id: &str) {
    session.apply(Command::Assign(Slot::A, id.to_owned())).unwrap();
}

#[test]
fn motions_beyond_the_limit_are_dropped_by_last_use() {
    let (mut session, ids) = library_of(6);
    assert_eq!(held(&session, &ids), "xxxxxx", "without a limit");
    let infos = session.clip_infos();
    for id in [&ids[3], &ids[0], &ids[5]] {
        show(&mut session, id);
    }
    let bytes =
        |id: &String| session.library().get(id).unwrap().facts.as_ref().unwrap().motion_bytes();
    // Three quarters of the memory are left: the two that were used last.
    let limit = (bytes(&ids[0]) + bytes(&ids[5])) * 4 / 3 + 2;
    session.limit_idle_motions(limit);
    show(&mut session, "walk");
    show(&mut session, &ids[5]);
    assert_eq!(held(&session, &ids), "x....x", "the two that were used last");
    assert_eq!(session.clip_infos(), infos, "all that lists show stays known");
    assert!(requested(&mut session).is_empty(), "none is read again before it is used");
}

#[test]
fn dropped_motion_is_read_again_with_the_same_result() {
    let (mut session, ids) = library_of(3);
    show(&mut session, &ids[1]);
    settle(&mut session);
    let (before, outcome) =
        (motion(&session, &ids[1]).unwrap(), Arc::clone(session.main_outcome().unwrap()));
    let revision = session.library_revision();
    session.limit_idle_motions(0);
    show(&mut session, &ids[0]);
    settle(&mut session);
    assert_eq!(held(&session, &ids), "x..");
    show(&mut session, &ids[1]);
    let pane = &session.panes()[0];
    assert!(pane.outcome.is_none() && pane.result().is_err(), "no earlier result under its name");
    assert!(pane.problem.as_ref().unwrap().to_string().contains("being read"));
    assert!(session.is_reading_small(), "calls of the page's API wait for it");
    assert_eq!(serve_all(&mut session), ["1.bvh"]);
    assert_eq!(motion(&session, &ids[1]).unwrap(), before);
    let again = session.main_outcome().unwrap();
    assert_eq!(again.metrics, outcome.metrics);
    assert_eq!(session.library_revision(), revision, "nothing has to be stored");
}

#[test]
fn clip_that_is_asked_for_by_itself_is_read() {
    let (mut session, ids) = library_of(2);
    session.limit_idle_motions(0);
    show(&mut session, "walk");
    assert_eq!(held(&session, &ids), "..");
    session.apply(Command::File(FileCommand::Read(ids[1].clone()))).unwrap();
    session.apply(Command::File(FileCommand::Read(ids[1].clone()))).unwrap();
    let tasks = requested(&mut session);
    assert_eq!(tasks.len(), 1, "once is enough");
    session.limit_idle_motions(u64::MAX);
    let Content::Here(bytes) = &tasks[0].content else { panic!() };
    let report = read(&tasks[0].name, bytes, &tasks[0].setup, &mut |_| true).unwrap();
    session.finish_reading(tasks[0].id, Ok(report)).unwrap().unwrap();
    assert_eq!(held(&session, &ids), ".x");
    session.apply(Command::File(FileCommand::Read("nobody".into()))).unwrap_err();
}

#[test]
fn scarce_memory_drops_all_that_is_not_used() {
    let (mut session, ids) = library_of(4);
    show(&mut session, &ids[2]);
    session.limit_idle_motions(u64::MAX - 1);
    session.note_memory(PageMemory { bytes: 900, limit: 1000, coming: 0 });
    assert_eq!(held(&session, &ids), "..x.");
}

#[test]
fn undo_restores_clips_whose_motion_was_dropped() {
    let (mut session, ids) = library_of(2);
    session.apply(Command::Remove(ids[0].clone())).unwrap();
    session.limit_idle_motions(0);
    show(&mut session, "walk");
    assert_eq!(held(&session, &ids[1..]), ".");
    session.apply(Command::Undo).unwrap();
    assert_eq!(held(&session, &ids), "..");
    assert_eq!(session.clip_infos().iter().filter(|info| info.id == ids[0]).count(), 1);
    show(&mut session, &ids[0]);
    serve_all(&mut session);
    assert!(motion(&session, &ids[0]).is_some());
}

#[test]
fn stored_library_is_whole_before_any_motion_is_read() {
    let (mut session, ids) = library_of(5);
    show(&mut session, &ids[4]);
    session.apply(Command::Rename(ids[1].clone(), "mine".into())).unwrap();
    settle(&mut session);
    let json = serde_json::to_string(&session.saved()).unwrap();
    let saved: Saved = serde_json::from_str(&json).unwrap();
    let infos = |session: &mut Session| {
        session.make_all();
        session.clip_infos()
    };
    let before = infos(&mut session);
    for late in [false, true] {
        let mut restored = Session::with_external_reader();
        if late {
            restored.apply(Command::OpenLink(session.query())).unwrap();
            restored.restore_late(&saved, stored(&session));
        } else {
            restored.restore(&saved, stored(&session), None);
        }
        assert_eq!(infos(&mut restored), before, "late: {late}");
        assert_eq!(held(&restored, &ids), ".....");
        let notes = |session: &Session| {
            let entries = session.library().entries().iter();
            entries.map(|entry| (entry.about.clone(), entry.warnings.clone())).collect::<Vec<_>>()
        };
        assert_eq!(notes(&restored), notes(&session));
        assert_eq!(
            serde_json::to_string(&restored.saved()).unwrap(),
            json,
            "it is stored as it is"
        );
        assert_eq!(serve_all(&mut restored), ["4.bvh"], "the one on the stage");
        assert_eq!(held(&restored, &ids), "....x");
        assert_eq!(
            restored.main_outcome().unwrap().metrics,
            session.main_outcome().unwrap().metrics
        );
    }
}

#[test]
fn older_record_without_facts_is_read_as_a_whole() {
    let (mut session, ids) = library_of(3);
    let older = older(&session.saved());
    assert!(older.entries.iter().all(|entry| entry.known.is_none()));
    let mut restored = Session::with_external_reader();
    restored.restore(&older, stored(&session), None);
    assert_eq!(held(&restored, &ids), "...");
    let mut read = serve_all(&mut restored);
    read.sort();
    assert_eq!(read, ["0.bvh", "1.bvh", "2.bvh"]);
    assert_eq!(held(&restored, &ids), "xxx");
    session.make_all();
    restored.make_all();
    assert_eq!(restored.clip_infos(), session.clip_infos());
    assert_eq!(restored.saved(), session.saved(), "the next record has them");
}

#[test]
fn clip_of_a_lost_file_is_named() {
    let (session, ids) = library_of(2);
    let mut restored = Session::with_external_reader();
    let content = stored(&session);
    let gone = session.library().get(&ids[0]).unwrap().sha256().unwrap().to_owned();
    restored.restore(&session.saved(), |key| content(key).filter(|_| key != gone), None);
    assert!(restored.library().get(&ids[0]).is_none() && restored.library().get(&ids[1]).is_some());
    let told: Vec<_> = restored.notices().list().iter().map(|own| own.text.to_string()).collect();
    let lost = told.iter().find(|text| text.contains("Not found in this browser's storage"));
    assert!(lost.is_some_and(|text| text.contains("0.bvh") && !text.contains("1.bvh")), "{told:?}");
}

#[test]
fn calls_wait_for_all_files_of_a_link() {
    let mut session = Session::with_external_reader();
    for index in 0..6 {
        session.begin_reading_fetched(&format!("{index}.bvh"), Content::Here(bytes(BVH)), 1000);
    }
    assert!(session.is_reading_small());
}

#[test]
fn many_files_are_one_job_that_is_stopped_at_once() {
    let mut session = Session::with_external_reader();
    session.open_together(6);
    for index in 0..6 {
        session.begin_reading(&format!("{index}.bvh"), Content::Here(bytes(BVH)), 1000);
    }
    let job = session.jobs().remove(0);
    assert_eq!(session.jobs().len(), 1);
    assert_eq!(job.kind, crate::JobKind::ReadingFiles { done: 0, all: 6 });
    assert_eq!((job.progress, job.size, job.task), (0.0, Some(6000), None));
    assert!(!session.is_reading_small(), "calls of the page's API do not wait for all of them");
    let tasks = requested(&mut session);
    for task in &tasks[..2] {
        let report = read(&task.name, BVH.as_bytes(), &task.setup, &mut |_| true).unwrap();
        session.finish_reading(task.id, Ok(report)).unwrap().unwrap();
    }
    let job = session.jobs().remove(0);
    assert_eq!(job.kind, crate::JobKind::ReadingFiles { done: 2, all: 6 });
    assert!((job.progress - 1.0 / 3.0).abs() < 1e-9);
    assert_eq!(session.task_of("4.bvh"), Some(tasks[4].id));
    session.apply(Command::File(FileCommand::StopReadingNew)).unwrap();
    let stopped = session.take_requests();
    assert!(!session.is_reading_any() && session.jobs().is_empty());
    assert_eq!(stopped.len(), 4);
    assert!(stopped.iter().all(|request| matches!(request, Request::StopReading { .. })));
    // A few later ones have jobs of their own again.
    session.begin_reading("later.bvh", Content::Here(bytes(BVH)), LARGE_BYTES + 1);
    assert_eq!(session.jobs()[0].kind, crate::JobKind::Reading("later.bvh".into()));
}

#[test]
fn held_changes_are_computed_once() {
    let (mut session, _) = library_of(1);
    let before = session.main_outcome().map(Arc::as_ptr);
    session.hold();
    for index in 0..3 {
        session.load(&format!("more {index}.bvh"), walk(1.5 + 0.1 * f64::from(index))).unwrap();
    }
    let tasks = requested(&mut session);
    for task in &tasks {
        let Content::Here(bytes) = &task.content else { panic!() };
        let report = read(&task.name, bytes, &task.setup, &mut |_| true).unwrap();
        session.finish_reading(task.id, Ok(report)).unwrap().unwrap();
    }
    assert_eq!(session.main_outcome().map(Arc::as_ptr), before, "nothing is computed yet");
    let shown = session.params().text(Key::A).to_owned();
    session.release();
    settle(&mut session);
    let outcome = session.main_outcome().unwrap();
    assert!(Arc::ptr_eq(&outcome.motion, &motion(&session, &shown).unwrap()));
}

#[test]
fn skeleton_whose_bytes_moved_outside_serves_motions() {
    let mut session = Session::new();
    let mut ids = session.load("walk.bvh", bytes(BVH)).unwrap().ids;
    ids.extend(session.load("01.asf", bytes(ASF)).unwrap().ids);
    let mut moved = session.move_bytes_outside(&ids);
    moved.sort_by_key(|(_, bytes)| bytes.len());
    for ((id, (key, moved)), text) in ids.iter().zip(moved).zip([BVH, ASF]) {
        assert_eq!(moved, bytes(text));
        let Origin::File(file) = &session.library().get(id).unwrap().origin else { panic!() };
        assert_eq!((&file.sha256, &file.content), (&key, &Content::Outside(key.clone())));
    }
    assert!(session.move_bytes_outside(&ids).is_empty());
    session.load("01_02.amc", bytes(AMC)).unwrap();
    assert!(session.library().entries().iter().any(|entry| entry.name == "01_02" && entry.moves()));
}
