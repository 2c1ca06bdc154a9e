//! Tests of bundled takes, alone and as a set: requested, loaded, failed, removed by undo, stored.

use crate::List;
use crate::clip_sets::ClipSet;
use crate::fixtures::*;
use crate::samples::{Sample, SampleSet};

fn set() -> &'static SampleSet {
    &Session::sample_sets()[0]
}

fn ids() -> Vec<&'static str> {
    set().samples.iter().map(|sample| sample.id).collect()
}

fn packed(sample: &Sample) -> Vec<u8> {
    std::fs::read(format!("{}/../../assets/samples/{}", env!("CARGO_MANIFEST_DIR"), sample.file))
        .unwrap()
}

/// Returns the requested takes.
fn asked(session: &mut Session) -> Vec<&'static Sample> {
    let requests = session.take_requests().into_iter();
    let sample = |request| {
        if let Request::Sample(sample) = request { Some(sample) } else { None }
    };
    requests.filter_map(sample).collect()
}

/// Returns the message about the first pane.
fn problem(session: &Session) -> Option<String> {
    session.panes()[0].problem.as_ref().map(ToString::to_string)
}

/// Hands over all requested takes, and does all work.
fn serve(session: &mut Session) {
    loop {
        settle(session);
        let asked = asked(session);
        if asked.is_empty() {
            return;
        }
        for sample in asked {
            session.load_sample(sample, &packed(sample)).unwrap();
        }
    }
}

/// Returns the number of the set's takes in the library, and of those that can be played.
fn here(session: &Session) -> (usize, usize) {
    let entries = ids().into_iter().filter_map(|id| session.library().get(id)).collect::<Vec<_>>();
    (entries.len(), entries.iter().filter(|entry| entry.motion.is_some()).count())
}

fn load() -> Command {
    Command::File(FileCommand::LoadSamples(set()))
}

#[test]
fn set_of_takes_is_loaded_and_taken_back_in_one_step() {
    let mut session = Session::new();
    let all = set().samples.len();
    assert_eq!(here(&session), (0, 0), "it was not requested");
    session.apply(load()).unwrap();
    assert_eq!((session.samples_progress(), here(&session)), (Some((0, all)), (all, 0)));
    let wanted = asked(&mut session);
    assert_eq!(wanted.iter().map(|sample| sample.id).collect::<Vec<_>>(), ids());
    for (come, sample) in wanted.into_iter().enumerate() {
        assert_eq!(session.samples_progress(), Some((come, all)));
        session.load_sample(sample, &packed(sample)).unwrap();
    }
    settle(&mut session);
    assert_eq!((session.samples_progress(), here(&session)), (None, (all, all)));
    assert_eq!(
        [Key::A, Key::B].map(|key| session.params().text(key).to_owned()),
        ["cmu16_walk", "cmu16_run"]
    );
    assert!(session.notices().list().is_empty() && session.panes()[0].problem.is_none());

    session.apply(Command::Undo).unwrap();
    assert_eq!(here(&session), (0, 0));
    assert_eq!([Key::A, Key::B].map(|key| session.params().text(key).to_owned()), ["walk", "run"]);
    session.apply(Command::Redo).unwrap();
    assert_eq!(here(&session), (all, all), "they are not fetched again");
    assert_eq!(asked(&mut session).len(), 0);
    session.apply(load()).unwrap();
    assert_eq!(session.notices().list().len(), 1, "it is there already, and that is said");
    session.apply(Command::Undo).unwrap();
    assert_eq!(here(&session), (0, 0), "what changed nothing is no step");
}

#[test]
fn set_taken_back_while_loading_stays_away_until_redo() {
    let mut session = Session::new();
    session.apply(load()).unwrap();
    let wanted = asked(&mut session);
    session.apply(Command::Undo).unwrap();
    for &sample in &wanted[1..] {
        session.load_sample(sample, &packed(sample)).unwrap();
    }
    assert_eq!(here(&session), (0, 0));
    session.apply(Command::Redo).unwrap();
    serve(&mut session);
    // The first one is still in transfer since the first request.
    session.load_sample(wanted[0], &packed(wanted[0])).unwrap();
    let all = set().samples.len();
    assert_eq!((here(&session), session.samples_progress()), ((all, all), None));
}

#[test]
fn set_loaded_in_view_shows_its_first_take_and_leaves_own_clips() {
    let mut session = Session::new();
    session.apply(Command::OpenLink("lab=view".into())).unwrap();
    session.apply(load()).unwrap();
    assert_eq!(session.params().text(Key::A), "cmu16_walk");
    let mut session = Session::new();
    let own = session.load("x.bvh", made_bvh(1.0)).unwrap().ids.remove(0);
    session.apply(load()).unwrap();
    assert_eq!(
        [Key::A, Key::B].map(|key| session.params().text(key).to_owned()),
        [own.as_str(), "cmu16_walk"]
    );
}

#[test]
fn link_that_names_a_take_loads_that_take_only() {
    let mut session = Session::new();
    session.apply(Command::OpenLink("lab=loop&a=cmu16_walk".into())).unwrap();
    let wanted: Vec<_> = asked(&mut session).iter().map(|sample| sample.id).collect();
    assert_eq!(wanted, ["cmu16_walk"]);
    for (link, count) in [
        ("lab=view&compare=a:walk,cmu16_stop", 1),
        ("lab=register&a=walk&b=run&warp_also=0.5:cmu16_fast_walk", 1),
        ("lab=graph&clips=walk,cmu16_walk,cmu16_stop", 2),
        ("lab=match&scenario=straight&match_clips=cmu16_walk,cmu16_run,cmu16_stop", 3),
        ("lab=path&a=walk&others=cmu16_walk", 1),
        ("lab=view&a=loop(a:cmu16_walk)", 1),
    ] {
        let mut session = Session::new();
        session.apply(Command::OpenLink(link.into())).unwrap();
        settle(&mut session);
        let wanted = asked(&mut session);
        assert_eq!(wanted.len(), count, "{link}: all at once, and no more than that");
        for sample in wanted {
            session.load_sample(sample, &packed(sample)).unwrap();
        }
        serve(&mut session);
        assert_eq!(session.panes()[0].problem, None, "{link}");
        assert!(session.panes()[0].outcome.is_some(), "{link}");
    }
}

#[test]
fn take_that_fails_is_reported_and_requested_by_the_next_command() {
    let mut session = Session::new();
    session.apply(Command::OpenLink("lab=loop&a=cmu16_walk".into())).unwrap();
    let sample = asked(&mut session)[0];
    session.fail_sample(sample, "its server answered 404");
    assert_eq!(asked(&mut session).len(), 0, "not over and over");
    let said = "CMU 16 · walk could not be loaded: its server answered 404.";
    assert_eq!(problem(&session).as_deref(), Some(said));
    assert_eq!(session.notices().list()[0].text.to_string(), said);
    assert_eq!(session.samples_progress(), None);
    session.apply(Command::Set(vec![(Key::LoopRatio, Value::Number(0.25))])).unwrap();
    assert_eq!(asked(&mut session), [sample]);
    assert!(problem(&session).is_some_and(|text| text.contains("is being loaded")));
    session.load_sample(sample, b"no file").unwrap_err();
    assert!(problem(&session).is_some_and(|text| text.contains("could not be loaded")));
    session.apply(Command::Set(vec![(Key::LoopRatio, Value::Number(0.5))])).unwrap();
    serve(&mut session);
    assert_eq!(session.panes()[0].problem, None);
}

#[test]
fn takes_in_the_library_survive_a_reload_without_others() {
    let mut session = Session::new();
    session.apply(load()).unwrap();
    serve(&mut session);
    session.apply(Command::Remove("cmu16_stop".into())).unwrap();
    let saved = session.saved();
    let all = set().samples.len();
    for late in [false, true] {
        let mut restored = Session::new();
        if late {
            restored.restore_late(&saved, |_| None);
        } else {
            restored.restore(&saved, |_| None, None);
        }
        serve(&mut restored);
        assert_eq!(here(&restored), (all - 1, all - 1), "late: {late}");
        assert!(restored.library().get("cmu_climb").is_none());
    }
    // A clip that was loaded before the stored work arrived is not taken for one that was removed
    // on an earlier visit.
    let mut waiting = Session::new();
    waiting.apply(load()).unwrap();
    waiting.restore_late(&Session::new().saved(), |_| None);
    serve(&mut waiting);
    assert_eq!(here(&waiting), (all, all));
    // Earlier versions stored all takes, requested or not.
    let mut text = serde_json::to_value(&saved).unwrap();
    for entry in text["entries"].as_array_mut().unwrap() {
        entry.as_object_mut().unwrap().remove("is_sample");
    }
    let mut restored = Session::new();
    restored.restore(
        &serde_json::from_value(text).unwrap(),
        |_| None,
        Some("lab=view&a=cmu16_turn_left"),
    );
    serve(&mut restored);
    assert_eq!(here(&restored), (1, 1));
}

#[test]
fn set_of_clips_of_each_lab_changes_in_one_step() {
    for lab in ["speed", "loop", "register", "path", "graph", "match"] {
        let mut session = Session::new();
        session.apply(Command::OpenLink(format!("lab={lab}&scenario=straight"))).unwrap();
        settle(&mut session);
        let before = session.query();
        assert!(
            session.uses_clip_set(ClipSet::Made) && !session.uses_clip_set(ClipSet::Captured),
            "{lab}"
        );
        assert_eq!(session.clip_set(ClipSet::Own), None, "{lab}: there are none");
        session.apply(Command::Set(session.clip_set(ClipSet::Captured).unwrap())).unwrap();
        serve(&mut session);
        assert!(
            session.uses_clip_set(ClipSet::Captured) && !session.uses_clip_set(ClipSet::Made),
            "{lab}"
        );
        assert_eq!(session.panes()[0].problem, None, "{lab}");
        assert!(session.panes()[0].outcome.is_some(), "{lab}");
        session.apply(Command::Settle).unwrap();
        session.apply(Command::Set(session.clip_set(ClipSet::Made).unwrap())).unwrap();
        assert_eq!(session.query(), before, "{lab}");
        session.apply(Command::Undo).unwrap();
        assert!(session.uses_clip_set(ClipSet::Captured), "{lab}");
    }
    for lab in ["view", "make", "blend", "transition", "layers"] {
        let mut session = Session::new();
        session.apply(Command::OpenLink(format!("lab={lab}"))).unwrap();
        assert_eq!(session.clip_set(ClipSet::Captured), None, "{lab}");
    }
}

#[test]
fn own_clips_replace_the_set_in_graph_and_match() {
    for (lab, key) in [("graph", Key::Clips), ("match", Key::MatchClips)] {
        let mut session = Session::new();
        session.apply(Command::OpenLink(format!("lab={lab}&scenario=straight"))).unwrap();
        let own: Vec<String> = [1.0, 2.0]
            .map(|seed| {
                session.load(&format!("own {seed}.bvh"), made_bvh(seed)).unwrap().ids.remove(0)
            })
            .into();
        session.apply(load()).unwrap();
        serve(&mut session);
        let values = session.clip_set(ClipSet::Own).unwrap();
        assert_eq!(
            values[0],
            (key, List::ClipIds(own.clone()).into()),
            "{lab}: no bundled take among them"
        );
        session.apply(Command::Set(values)).unwrap();
        assert!(session.uses_clip_set(ClipSet::Own), "{lab}");
    }
}

#[test]
fn bundled_take_is_requested_and_takes_its_slot() {
    let mut session = Session::new();
    let sample = &Session::samples()[2];
    session.apply(Command::Assign(Slot::A, sample.id.into())).unwrap();
    assert!(session.take_requests().contains(&Request::Sample(sample)));
    let packed = std::fs::read(format!(
        "{}/../../assets/samples/{}",
        env!("CARGO_MANIFEST_DIR"),
        sample.file
    ))
    .unwrap();
    session.load_sample(sample, &packed).unwrap();
    settle(&mut session);
    assert_eq!(session.panes()[0].problem, None);
    assert!(session.main_outcome().unwrap().motion.clip().frames() > 30);
}
