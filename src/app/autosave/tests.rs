//! Tests of the autosave, driven by a given clock and without a browser's storage.

use super::{Autosave, Fingerprint, MAX_SAVE_INTERVAL_MS, MAX_STORAGE_WAIT_MS, SAVE_DELAY_MS};
use crate::platform::{FileBytes, LargeFileStore, Storage, StoredWork};
use segue_session::{
    Command, Key, Origin, PlaybackCommand, Saved, SavedEntry, Session, Slot, Value,
};
use std::sync::Arc;

const STANDING: &str = "HIERARCHY ROOT Hips { OFFSET 0 1 0 CHANNELS 1 Yrotation End Site { OFFSET 0 0.7 0 } } MOTION Frames: 2 Frame Time: .1\n1\n2";

fn stored(query: &str) -> StoredWork {
    let saved = Saved { query: query.into(), ..Session::new().saved() };
    StoredWork { saved: Some(saved), ..StoredWork::default() }
}

fn autosave(link: &str) -> (Autosave, Session) {
    (Autosave::new(Some(Storage::default()), link.into(), 1000.0), Session::new())
}

fn set_window(session: &mut Session, frames: f64) {
    session.apply(Command::Set(vec![(Key::BlendWindow, Value::Number(frames))])).unwrap();
}

#[test]
fn stored_work_in_time_is_shown_in_the_first_frame() {
    let (mut autosave, mut session) = autosave("");
    assert!(
        !autosave.begin_if_overdue(&mut session, &mut LargeFileStore::default(), 1100.0)
            && autosave.is_waiting()
    );
    assert!(
        !autosave.on_loaded(
            &mut session,
            &mut LargeFileStore::default(),
            Some(stored("blend_window=24"))
        ),
        "the address does not say what is shown"
    );
    assert!(!autosave.is_waiting());
    assert_eq!(session.query(), "blend_window=24");
}

#[test]
fn link_of_the_page_overrides_stored_parameters() {
    let (mut autosave, mut session) = autosave("blend_window=12");
    assert!(autosave.on_loaded(
        &mut session,
        &mut LargeFileStore::default(),
        Some(stored("blend_window=24"))
    ));
    assert_eq!(session.query(), "blend_window=12");
}

#[test]
fn slow_storage_is_not_waited_for_and_restored_when_it_answers() {
    let (mut autosave, mut session) = autosave("");
    let welcome = session.query();
    assert!(
        autosave.begin_if_overdue(&mut session, &mut LargeFileStore::default(), 1151.0)
            && !autosave.is_waiting()
    );
    assert_eq!(session.query(), welcome);
    assert_eq!(
        autosave.update(&session, &LargeFileStore::default(), 9000.0),
        None,
        "nothing is stored over what has not been read yet"
    );
    autosave.on_loaded(
        &mut session,
        &mut LargeFileStore::default(),
        Some(stored("blend_window=24")),
    );
    assert_eq!(session.query(), "blend_window=24");
}

#[test]
fn slow_storage_after_a_paused_start_restores_the_work() {
    let (mut autosave, mut session) = autosave("");
    autosave.begin_if_overdue(&mut session, &mut LargeFileStore::default(), 1151.0);
    session.apply(Command::Playback(PlaybackCommand::TogglePlay)).unwrap();
    autosave.set_baseline(&session);
    autosave.on_loaded(
        &mut session,
        &mut LargeFileStore::default(),
        Some(stored("blend_window=24")),
    );
    assert_eq!(session.query(), "blend_window=24");
}

#[test]
fn late_work_after_a_change_leaves_the_parameters() {
    let (mut autosave, mut session) = autosave("blend_window=12");
    autosave.begin_if_overdue(&mut session, &mut LargeFileStore::default(), 1151.0);
    set_window(&mut session, 60.0);
    autosave.on_loaded(
        &mut session,
        &mut LargeFileStore::default(),
        Some(stored("blend_window=24")),
    );
    assert_eq!(session.query(), "blend_window=60");
}

#[test]
fn clips_kept_before_a_slow_storage_answers_are_stored() {
    let (mut autosave, mut session) = autosave("");
    autosave.begin_if_overdue(&mut session, &mut LargeFileStore::default(), 1151.0);
    session.apply(Command::OpenLink("lab=make&gait=run".into())).unwrap();
    session.apply(Command::Keep(0)).unwrap();
    autosave.on_loaded(
        &mut session,
        &mut LargeFileStore::default(),
        Some(stored("blend_window=24")),
    );
    assert_eq!(autosave.update(&session, &LargeFileStore::default(), 2000.0), Some(SAVE_DELAY_MS));
}

#[test]
fn late_work_after_a_drop_joins_the_library() {
    let file = |add: &str| -> Arc<[u8]> { [STANDING, add].concat().into_bytes().into() };
    let mut before = Session::new();
    let stored_id = before.load("stored.bvh", file("")).unwrap().ids.remove(0);
    before.apply(Command::Rename(stored_id.clone(), "mine".into())).unwrap();
    before.apply(Command::Remove("idle".into())).unwrap();
    let Origin::File(source) = before.library().get(&stored_id).unwrap().origin.clone() else {
        panic!()
    };
    let late = StoredWork {
        saved: Some(before.saved()),
        files: [(source.sha256, FileBytes::Here(file("")))].into(),
        ..StoredWork::default()
    };
    let (mut autosave, mut session) = autosave("");
    let large_files = &mut LargeFileStore::default();
    autosave.begin_if_overdue(&mut session, large_files, 1151.0);
    let dropped = session.load("dropped.bvh", file(" ")).unwrap().ids.remove(0);
    autosave.save_now(&session, large_files);
    assert_eq!(autosave.known.len(), 0, "nothing is stored over what has not been read yet");
    autosave.on_loaded(&mut session, large_files, Some(late));
    let has = |session: &Session, id: &str| {
        session.library().get(id).is_some_and(|entry| entry.is_known())
    };
    assert!(has(&session, &stored_id) && has(&session, &dropped));
    assert_eq!(session.library().get(&stored_id).unwrap().name, "mine");
    assert!(session.library().get("idle").is_none());
    assert_eq!(session.params().text(Key::A), dropped, "the parameters stay");
    assert_eq!(
        autosave.update(&session, large_files, 2000.0),
        Some(SAVE_DELAY_MS),
        "both are yet to be stored"
    );
    // Undo removes the dropped clip, and never the restored one.
    session.apply(Command::Undo).unwrap();
    assert!(has(&session, &stored_id) && session.library().get(&dropped).is_none());
}

#[test]
fn fingerprint_after_a_change_of_clip_a_keeps_the_library_revision() {
    let (mut autosave, mut session) = autosave("");
    autosave.begin_if_overdue(&mut session, &mut LargeFileStore::default(), 1151.0);
    let begun = Fingerprint::of(&session);
    session.apply(Command::Assign(Slot::A, "idle".into())).unwrap();
    assert_eq!(Fingerprint::of(&session).library, begun.library);
    assert_ne!(Fingerprint::of(&session), begun, "the change is stored");
}

#[test]
fn storage_that_fails_is_no_longer_waited_for() {
    let (mut autosave, mut session) = autosave("");
    autosave.begin_if_overdue(&mut session, &mut LargeFileStore::default(), 1151.0);
    assert!(autosave.is_late(1200.0) && !autosave.is_late(1000.0 + MAX_STORAGE_WAIT_MS));
    set_window(&mut session, 60.0);
    // Storage has failed; from now on, changes are stored.
    autosave.on_loaded(&mut session, &mut LargeFileStore::default(), None);
    assert!(!autosave.is_late(1200.0));
    assert_eq!(autosave.update(&session, &LargeFileStore::default(), 2000.0), Some(SAVE_DELAY_MS));
}

#[test]
fn changed_work_is_stored_after_the_delay() {
    let (mut autosave, mut session) = autosave("");
    autosave.on_loaded(&mut session, &mut LargeFileStore::default(), None);
    assert_eq!(autosave.update(&session, &LargeFileStore::default(), 2000.0), None);
    set_window(&mut session, 60.0);
    assert_eq!(autosave.update(&session, &LargeFileStore::default(), 2100.0), Some(SAVE_DELAY_MS));
    set_window(&mut session, 61.0);
    assert_eq!(autosave.update(&session, &LargeFileStore::default(), 2500.0), Some(SAVE_DELAY_MS));
    assert_eq!(
        autosave.update(&session, &LargeFileStore::default(), 2600.0),
        Some(SAVE_DELAY_MS - 100.0)
    );
    assert_eq!(autosave.update(&session, &LargeFileStore::default(), 2500.0 + SAVE_DELAY_MS), None);
    assert_eq!(autosave.stored, Fingerprint::of(&session));
}

#[test]
fn work_under_constant_change_is_stored_within_the_interval() {
    let (mut autosave, mut session) = autosave("");
    autosave.on_loaded(&mut session, &mut LargeFileStore::default(), None);
    let large_files = LargeFileStore::default();
    let mut longest: f64 = 0.0;
    let mut stored_at = None;
    for step in 0..100 {
        set_window(&mut session, 20.0 + f64::from(step % 50));
        let now_ms = 2000.0 + 100.0 * f64::from(step);
        autosave.update(&session, &large_files, now_ms);
        if autosave.stored == Fingerprint::of(&session) {
            longest = longest.max(now_ms - stored_at.replace(now_ms).unwrap_or(2000.0));
        }
    }
    assert!(longest > 0.0 && longest <= MAX_SAVE_INTERVAL_MS + 200.0, "{longest} ms");
}

#[test]
fn loose_clips_without_a_record_join_the_built_in_ones() {
    let mut session = Session::new();
    let bytes: Arc<[u8]> = Arc::from(STANDING.as_bytes());
    let id = session.load("other.bvh", bytes.clone()).unwrap().ids.remove(0);
    let entry = SavedEntry::from(&**session.library().get(&id).unwrap());
    let sha256 = entry.file.as_ref().unwrap().sha256.clone();
    for wait_ms in [0.0, 500.0] {
        let stored = StoredWork {
            saved: None,
            loose: vec![entry.clone()],
            files: [(sha256.clone(), FileBytes::Here(bytes.clone()))].into(),
        };
        let (mut autosave, mut session) = autosave("");
        let built_in = session.library().entries().len();
        autosave.begin_if_overdue(&mut session, &mut LargeFileStore::default(), 1000.0 + wait_ms);
        autosave.on_loaded(&mut session, &mut LargeFileStore::default(), Some(stored));
        assert_eq!(session.library().entries().len(), built_in + 1, "after {wait_ms} ms");
        assert!(session.library().get(&id).is_some_and(|entry| entry.is_known()));
    }
}

#[test]
fn clips_of_another_window_join_and_are_not_stored_again() {
    let mut session = Session::new();
    let bytes: Arc<[u8]> = Arc::from(STANDING.as_bytes());
    let id = session.load("other.bvh", bytes.clone()).unwrap().ids.remove(0);
    let entry = SavedEntry::from(&**session.library().get(&id).unwrap());
    let joined = StoredWork {
        saved: None,
        files: [(entry.file.as_ref().unwrap().sha256.clone(), FileBytes::Here(bytes))].into(),
        loose: vec![entry],
    };
    let (mut autosave, mut session) = autosave("");
    let large_files = &mut LargeFileStore::default();
    autosave.on_loaded(&mut session, large_files, None);
    let (shown, built_in) = (session.query(), session.library().entries().len());
    autosave.on_fetched_elsewhere(&mut session, large_files, &joined);
    assert_eq!((session.query(), session.library().entries().len()), (shown, built_in + 1));
    assert_eq!(
        autosave.update(&session, large_files, 2000.0),
        None,
        "the other window has stored it"
    );
    // A clip that was removed here is not added again.
    session.apply(Command::Remove(id.clone())).unwrap();
    assert_eq!(autosave.update(&session, large_files, 2000.0), Some(SAVE_DELAY_MS));
    assert!(autosave.known.contains(&id));
}
