//! Tests of work that survives a reload, and of work that is restored late.

use crate::choices;
use crate::fixtures::*;
use crate::reading::Content;
use crate::saved::Saved;
use segue_motion::skeleton::Role;

/// Returns the same work in a new session, as after a reload. `bytes` are those of its only file.
fn reloaded(session: &Session, bytes: &Arc<[u8]>) -> Session {
    let mut restored = Session::new();
    restored.restore(&session.saved(), |_| Some(Content::Here(Arc::clone(bytes))), None);
    restored
}

#[test]
fn roles_corrected_by_hand_survive_a_reload_for_every_kind_of_clip() {
    let bytes = made_bvh(1.0);
    let sample = &Session::samples()[2];
    let packed = std::fs::read(format!(
        "{}/../../assets/samples/{}",
        env!("CARGO_MANIFEST_DIR"),
        sample.file
    ))
    .unwrap();
    let mut session = Session::new();
    let file = session.load("x.bvh", Arc::clone(&bytes)).unwrap().ids.remove(0);
    session.apply(Command::OpenLink("lab=make&gait=run&turn_rate=20".into())).unwrap();
    session.apply(Command::Keep(0)).unwrap();
    session.apply(Command::OpenLink(format!("a=idle&b={}", sample.id))).unwrap();
    session.load_sample(sample, &packed).unwrap();
    settle(&mut session);
    let ids = [file.as_str(), "run(turn_rate:20)", "idle", sample.id];
    for id in ids {
        session
            .apply(Command::File(FileCommand::SetRoles(id.into(), vec![(Role::Head, Some(1))])))
            .unwrap();
    }
    let mut restored = reloaded(&session, &bytes);
    restored.load_sample(sample, &packed).unwrap();
    settle(&mut restored);
    let mut again = reloaded(&restored, &bytes);
    again.load_sample(sample, &packed).unwrap();
    settle(&mut again);
    for session in [&mut restored, &mut again] {
        read_clip(session, &file);
    }
    for id in ids {
        for session in [&restored, &again] {
            let motion = session.library().get(id).unwrap().motion.clone().unwrap();
            assert_eq!(motion.roles().get(Role::Head), Some(1), "{id}");
        }
    }
}

#[test]
fn work_restored_late_leaves_the_clips_in_use() {
    let mut earlier = Session::new();
    earlier.apply(Command::Remove("idle".into())).unwrap();
    for link in ["lab=graph", "lab=view&compare=a:walk,idle", "a=idle"] {
        let mut session = Session::new();
        session.apply(Command::OpenLink(link.into())).unwrap();
        assert!(session.library().get("idle").is_some());
        session.restore_late(&earlier.saved(), |_| None);
        let uses = link != "lab=graph" || session.graph_clip_ids().contains(&"idle".to_owned());
        assert_eq!(session.library().get("idle").is_some(), uses, "{link}");
        assert!(session.panes().iter().all(|pane| pane.problem.is_none()), "{link}");
    }
}

#[test]
fn roles_of_missing_joints_are_ignored() {
    let mut session = Session::new();
    settle(&mut session);
    session
        .apply(Command::File(FileCommand::SetRoles("idle".into(), vec![(Role::Head, Some(1))])))
        .unwrap();
    let mut saved = session.saved();
    let entry = saved.entries.iter_mut().find(|entry| entry.id == "idle").unwrap();
    entry.roles.as_mut().unwrap().set(Role::Head, Some(10_000));
    let mut restored = Session::new();
    restored.restore(&saved, |_| None, None);
    settle(&mut restored);
    let motion = restored.library().get("idle").unwrap().motion.clone().unwrap();
    assert!(
        motion.roles().get(Role::Head).is_some_and(|joint| joint < motion.clip().skeleton().len())
    );
}

#[test]
fn work_restored_late_completes_waiting_clips() {
    let bytes = made_bvh(1.0);
    let mut before = Session::new();
    let id = before.load("x.bvh", Arc::clone(&bytes)).unwrap().ids.remove(0);
    before.apply(Command::Rename(id.clone(), "mine".into())).unwrap();
    before.apply(Command::Set(link::read("lang=zh-Hant&blend_window=12").values)).unwrap();
    let late = before.saved();
    let content = |_: &str| Some(Content::Here(Arc::clone(&bytes)));

    let mut session = Session::new();
    session.restore(&Saved::default(), |_| None, Some(&format!("a={id}&blend_window=24")));
    assert!(session.panes()[0].problem.is_some());
    session.restore_late(&late, content);
    settle(&mut session);
    assert_eq!(session.panes()[0].problem, None);
    assert!(session.notices().list().is_empty(), "{:?}", session.notices().list());
    assert_eq!(session.params().number(Key::BlendWindow), 24.0);
    assert_eq!(
        session.params().choice::<choices::PageLanguage>().word(),
        "zh-Hant",
        "as for every link"
    );

    // The same file was loaded meanwhile: what was set on the last visit stays, unless it was set
    // again.
    for (renamed, name) in [(false, "mine"), (true, "yours")] {
        let mut session = Session::new();
        session.load("x.bvh", Arc::clone(&bytes)).unwrap();
        if renamed {
            session.apply(Command::Rename(id.clone(), name.into())).unwrap();
        }
        session.restore_late(&late, content);
        assert_eq!(session.library().get(&id).unwrap().name, name);
        assert_eq!(session.library().entries().iter().filter(|entry| entry.id == id).count(), 1);
    }
    // With an empty storage, the built-in clips stay.
    let mut session = Session::new();
    let clips = session.library().entries().len();
    session.restore_late(&Saved::default(), |_| None);
    assert_eq!(session.library().entries().len(), clips);
}

#[test]
fn work_survives_storage() {
    let bytes = made_bvh(5.0);
    let mut session = Session::new();
    let id = session.load("kept.bvh", Arc::clone(&bytes)).unwrap().ids.remove(0);
    session.apply(Command::Rename(id.clone(), "my walk".into())).unwrap();
    session.apply(Command::Remove("idle".into())).unwrap();
    blend_window(&mut session, 17.0);
    let saved = session.saved();

    let mut restored = Session::new();
    restored.restore(&saved, |_| Some(Content::Here(Arc::clone(&bytes))), None);
    settle(&mut restored);
    settle(&mut session);
    assert_eq!(restored.clip_infos(), session.clip_infos());
    assert_eq!(restored.query(), session.query());

    let mut without = Session::new();
    without.restore(&saved, |_| None, None);
    assert!(
        without.notices().list().iter().any(|notice| notice.text.to_string().contains("kept.bvh"))
    );
}
