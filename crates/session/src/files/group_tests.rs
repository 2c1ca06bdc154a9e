//! Tests of clips that arrive together, and of what is done to several clips at once.

use super::fixtures::{stored, zip};
use crate::ClipGroup;
use crate::fixtures::*;
use crate::params::List;

/// Opens so many files of walks together. Returns the ids of their clips.
fn open_together(session: &mut Session, count: usize, first: usize) -> Vec<String> {
    session.open_together(count);
    let load = |n: usize| {
        let loaded = session.load(&format!("walk_{n}.bvh"), made_bvh(n as f64));
        loaded.unwrap().ids.remove(0)
    };
    (first..first + count).map(load).collect()
}

fn group(session: &Session, id: &str) -> Option<ClipGroup> {
    session.library().get(id).unwrap().group()
}

#[test]
fn files_opened_together_are_a_group_that_survives_a_reload() {
    let mut session = Session::new();
    let first = open_together(&mut session, 3, 1);
    let alone = open_together(&mut session, 1, 10);
    let second = open_together(&mut session, 2, 20);
    let later = session.load("later.bvh", made_bvh(30.0)).unwrap().ids.remove(0);
    assert!(first.iter().all(|id| group(&session, id) == Some(ClipGroup::Batch(1))));
    assert!(second.iter().all(|id| group(&session, id) == Some(ClipGroup::Batch(2))));
    for id in [&alone[0], &later] {
        assert!(matches!(group(&session, id), Some(ClipGroup::File(_))), "{id}");
    }
    let record = serde_json::to_string(&session.saved()).unwrap();
    let mut again = Session::new();
    again.restore(&serde_json::from_str(&record).unwrap(), stored(&session), None);
    for id in first.iter().chain(&second).chain([&later]) {
        assert_eq!(group(&again, id), group(&session, id), "{id}");
    }
    let third = open_together(&mut again, 2, 40);
    assert_eq!(group(&again, &third[0]), Some(ClipGroup::Batch(3)), "a number of its own");
    // Records without the field are read.
    let old = record.replace("\"batch\":1", "\"unknown\":1");
    let mut from_old = Session::new();
    from_old.restore(&serde_json::from_str(&old).unwrap(), stored(&session), None);
    assert!(matches!(group(&from_old, &first[0]), Some(ClipGroup::File(_))));
}

#[test]
fn files_of_an_archive_are_a_group_of_its_name() {
    let walks = [1.0, 2.0].map(|seed| String::from_utf8(made_bvh(seed).to_vec()).unwrap());
    let packed = zip(&[("a/one.bvh", &walks[0]), ("two.bvh", &walks[1])]);
    let mut session = Session::new();
    let ids = session.load("takes.zip", packed.into()).unwrap().ids;
    assert_eq!(ids.len(), 2);
    assert!(
        ids.iter().all(|id| group(&session, id) == Some(ClipGroup::Folder("takes.zip".into())))
    );
}

#[test]
fn first_of_several_files_is_viewed() {
    let mut session = opened("lab=view&a=run");
    let ids = open_together(&mut session, 4, 1);
    assert_eq!(session.params().text(Key::A), ids[0]);
    // A file alone replaces it.
    let alone = session.load("alone.bvh", made_bvh(9.0)).unwrap().ids.remove(0);
    assert_eq!(session.params().text(Key::A), alone);
}

#[test]
fn several_files_have_one_summary() {
    let mut session = Session::new();
    open_together(&mut session, 5, 1);
    let texts: Vec<String> =
        session.notices().list().iter().map(|notice| notice.text.to_string()).collect();
    assert_eq!(texts, ["Added 5 files to the library."]);
    assert_eq!(session.notices().added().map(|added| added.clips), Some(5));
}

#[test]
fn several_clips_are_removed_in_one_step() {
    let mut session = opened("lab=blend&a=walk&b=run");
    let all = session.library().entries().len();
    let ids = ["walk", "run", "walk"].map(str::to_owned).to_vec();
    session.apply(Command::RemoveAll(ids)).unwrap();
    assert_eq!(session.library().entries().len(), all - 2);
    assert!(
        [Key::A, Key::B].iter().all(|key| !["walk", "run"].contains(&session.params().text(*key)))
    );
    let unknown = Command::RemoveAll(vec!["idle".to_owned(), "gone".to_owned()]);
    assert_eq!(session.apply(unknown), Err(CommandError::NoClip("gone".to_owned())));
    assert!(session.library().get("idle").is_some(), "all or none");
    session.apply(Command::Undo).unwrap();
    assert_eq!(session.library().entries().len(), all);
    assert_eq!([Key::A, Key::B].map(|key| session.params().text(key)), ["walk", "run"]);
}

#[test]
fn lab_takes_as_many_clips_as_it_can_use() {
    let ids: Vec<String> = ["walk", "run", "idle", "walk_left"].map(str::to_owned).to_vec();
    let taken = |lab: &str, count: usize| {
        let mut session = opened(&format!("lab={lab}&scenario=straight&walk_seconds=10"));
        let values = session.with_clips(&ids[..count])?;
        session.apply(Command::Set(values)).unwrap();
        let params = session.params().clone();
        Some(params)
    };
    for lab in ["graph", "match"] {
        let key = if lab == "graph" { Key::Clips } else { Key::MatchClips };
        assert_eq!(taken(lab, 3).unwrap().clip_ids(key), &ids[..3], "{lab}");
    }
    let path = taken("path", 3).unwrap();
    assert_eq!((path.text(Key::A), path.clip_ids(Key::Others)), ("walk", &ids[1..3]));
    let register = taken("register", 4).unwrap();
    assert_eq!([Key::A, Key::B].map(|key| register.text(key)), ["walk", "run"]);
    let weighted: Vec<&str> = register.weighted_clips().iter().map(|(id, _)| id.as_str()).collect();
    assert_eq!(weighted, ["idle", "walk_left"]);
    assert_eq!(taken("register", 1), None);
    let blend = taken("blend", 2).unwrap();
    assert_eq!([Key::A, Key::B].map(|key| blend.text(key)), ["walk", "run"]);
    assert_eq!(taken("blend", 3), None);
    let view = taken("view", 3).unwrap();
    assert_eq!(
        view.compare().map(|compare| (compare.key, compare.values.len())),
        Some((Key::A, 3))
    );
    assert_eq!(taken("make", 1), None);
    assert!(matches!(path.get(Key::Others), Value::List(List::ClipIds(_))));
}
