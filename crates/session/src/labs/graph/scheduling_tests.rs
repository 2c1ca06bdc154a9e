//! Tests of the work in slices: caches, cancellation, and refused settings.

use super::fixtures::{SMALL, set, walk};
use crate::JobKind;
use crate::fixtures::*;
use segue_text::ToMessage;

#[test]
fn change_is_computed_in_slices_from_cached_parts_and_can_be_stopped() {
    let mut session = opened("lab=graph&walk_seconds=20");
    let slices = |session: &mut Session, key: Key, value: f64| {
        session.apply(Command::Set(vec![(key, Value::Number(value))])).unwrap();
        let before = Arc::clone(walk(session));
        let (mut count, mut progress) = (0, -1.0);
        while let Some(job) =
            session.jobs().into_iter().find(|job| job.kind == JobKind::BuildingGraph)
        {
            assert!(
                job.progress >= progress && job.progress <= 1.0,
                "{} after {progress}",
                job.progress
            );
            assert!(Arc::ptr_eq(&before, walk(session)));
            progress = job.progress;
            assert!(session.work());
            count += 1;
        }
        while session.work() {}
        assert!(!Arc::ptr_eq(&before, walk(session)));
        count
    };
    let for_seed = slices(&mut session, Key::Seed, 8.0);
    let for_threshold = slices(&mut session, Key::EdgeThreshold, 9.0);
    let for_window = slices(&mut session, Key::BlendWindow, 25.0);
    assert!(
        for_seed > 5 && for_threshold > for_seed / 2 && for_window > 5,
        "{for_seed} {for_threshold} {for_window}"
    );
    // For a window that was used before, only the walk is made again.
    session.apply(Command::Set(vec![(Key::BlendWindow, Value::Number(30.0))])).unwrap();
    assert_eq!(session.graph_field().unwrap().window(), 30);
    assert!(session.graph_built().is_some());
    while session.work() {}

    session.apply(Command::Set(vec![(Key::BlendWindow, Value::Number(40.0))])).unwrap();
    session.work();
    session.apply(Command::StopGraph(true)).unwrap();
    assert!(!session.work() && session.jobs().is_empty() && session.graph_is_stopped());
    assert!(session.panes()[0].problem.as_ref().unwrap().to_string().contains("Stopped"));
    assert!(session.panes()[0].outcome.is_none(), "a walk in another graph is not this one");
    session.apply(Command::StopGraph(false)).unwrap();
    while session.work() {}
    assert_eq!(walk(&session).built.options().blend_window, 40);
    session.apply(Command::StopGraph(true)).unwrap();
    set(&mut session, Key::BlendWindow, Value::Number(12.0));
    assert_eq!(walk(&session).built.options().blend_window, 12, "a change goes on");
    // No work is done for a lab that was left.
    session.apply(Command::Set(vec![(Key::BlendWindow, Value::Number(33.0))])).unwrap();
    session.apply(Command::Set(vec![(Key::Lab, Value::Choice("view"))])).unwrap();
    assert!(session.jobs().is_empty());
}

#[test]
fn clips_are_there_when_options_do_not_fit_them() {
    let link = "lab=graph&clips=walk,walk_left&construction=segments&segment_size=10";
    let session = opened(&format!("{link}&blend_window=30"));
    assert!(session.panes()[0].problem.is_some());
    assert_eq!(session.graph_clips().unwrap().motions().len(), 2);
}

#[test]
fn every_setting_gives_its_own_walk_or_a_reason() {
    let mut session = opened(
        "lab=graph&clips=walk(make_seconds:2),walk(turn_rate:20,make_seconds:2)&walk_seconds=10",
    );
    let (mut made, mut refused) = (0, 0);
    for construction in ["segments", "minima"] {
        for (window, segment) in [
            (1, 1),
            (1, 2),
            (10, 10),
            (10, 11),
            (30, 60),
            (59, 61),
            (118, 119),
            (119, 600),
            (240, 600),
            (5, 120),
            (20, 121),
        ] {
            for threshold in [0.1, 6.0, 60.0] {
                session
                    .apply(Command::Set(vec![
                        (Key::Construction, Key::Construction.param().parse(construction).unwrap()),
                        (Key::BlendWindow, Value::Number(f64::from(window))),
                        (Key::SegmentSize, Value::Number(f64::from(segment))),
                        (Key::EdgeThreshold, Value::Number(threshold)),
                    ]))
                    .unwrap();
                while session.work() {}
                assert!(session.jobs().is_empty());
                let pane = &session.panes()[0];
                match &pane.problem {
                    None => made += 1,
                    Some(problem) => {
                        refused += 1;
                        let problem = problem.to_sentence().to_string();
                        assert!(problem.ends_with('.') && problem.contains(':'), "{problem}");
                        assert!(pane.outcome.is_none());
                    }
                }
            }
        }
    }
    assert!(made > 10 && refused > 10, "{made} {refused}");
    for (key, text) in [(Key::Clips, "walk,nobody"), (Key::Clips, ","), (Key::WalkPath, "0:0")] {
        set(&mut session, key, key.param().parse(text).unwrap());
        assert!(session.panes()[0].problem.is_some(), "{text}");
        session.apply(Command::Reset(key)).unwrap();
    }
}

#[test]
fn clips_with_any_name_are_used() {
    let mut session = opened(SMALL);
    let motion = session.library().find("walk_left").unwrap().motion.clone().unwrap();
    let bytes: Arc<[u8]> =
        segue_formats::bvh::write(motion.clip(), &segue_formats::bvh::WriteOptions::default())
            .into_bytes()
            .into();
    let mut ids = vec!["walk".to_owned()];
    for name in ["slow, then fast.bvh", "turn (left.bvh", "a) b.bvh", "100 %.bvh"] {
        session.load(name, Arc::clone(&bytes)).unwrap();
        ids.push(session.library().entries().last().unwrap().id.clone());
    }
    session.apply(Command::Set(crate::graph_of(&ids))).unwrap();
    while session.work() {}
    assert_eq!(session.graph_clip_ids(), ids);
    assert_eq!(walk(&session).built.clips().names().len(), 5);
    session.apply(Command::Remove(ids[1].clone())).unwrap();
    while session.work() {}
    ids.remove(1);
    assert_eq!((session.graph_clip_ids(), walk(&session).built.clips().names().len()), (ids, 4));
}

#[test]
fn threshold_that_is_dragged_needs_no_new_search() {
    // More frames than the distance matrix is kept for.
    let clips = "walk(make_seconds:30),walk(turn_rate:20,make_seconds:30),run(make_seconds:30),walk(turn_rate:-20,make_seconds:20)";
    let base = format!("lab=graph&clips={clips}&walk_seconds=10&blend_window=12&edge_threshold=6");
    let mut session = opened(&base);
    let field = Arc::clone(session.graph_field().unwrap());
    assert!(matches!(field.distances(), crate::Distances::Overview(_)));
    // Returns the progress at the first moment after a change.
    let starts_at = |session: &mut Session, key: Key, value: Value| {
        session.apply(Command::Set(vec![(key, value)])).unwrap();
        let before = Arc::clone(walk(session));
        let (mut first, mut progress) = (None, 0.0);
        while let Some(job) =
            session.jobs().into_iter().find(|job| job.kind == JobKind::BuildingGraph)
        {
            assert!(job.progress >= progress, "{key:?}: {} after {progress}", job.progress);
            assert!(
                Arc::ptr_eq(&before, walk(session)) && session.graph_built().is_some(),
                "the last one stays"
            );
            progress = job.progress;
            first.get_or_insert(progress);
            assert!(session.work());
        }
        while session.work() {}
        first.unwrap()
    };
    let streamed = starts_at(&mut session, Key::MinJump, Value::Number(0.8));
    assert!(streamed < 0.2, "{streamed}");
    for threshold in [4.0, 9.0, 12.0, 5.0] {
        let known = starts_at(&mut session, Key::EdgeThreshold, Value::Number(threshold));
        assert!(known >= 0.85, "{threshold}: {known}");
        let alone = segue_motion::graph::GraphOptions {
            edge_threshold_cm: threshold,
            ..*walk(&session).built.options()
        };
        assert_eq!(*walk(&session).built.options(), alone);
    }
    let known = starts_at(&mut session, Key::Prune, Value::Switch(false));
    assert!(known >= 0.85, "{known}");
    assert!(
        Arc::ptr_eq(session.graph_field().unwrap(), &field) && !walk(&session).built.is_truncated()
    );
    // The graph is the one that is built when nothing else was requested before.
    let direct =
        opened(&base.replace("edge_threshold=6", "edge_threshold=5&min_jump=0.8&prune=off"));
    assert_eq!(direct_jumps(&session), direct_jumps(&direct));
    assert!(direct_jumps(&session).len() > 10);
}

fn direct_jumps(session: &Session) -> Vec<segue_motion::graph::Jump> {
    walk(session).built.whole().jumps().to_vec()
}
