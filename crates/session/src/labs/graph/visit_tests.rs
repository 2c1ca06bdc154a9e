//! Tests of walks that visit clips and follow paths.

use super::fixtures::{SMALL, assert_connected, number, set, walk, way};
use crate::List;
use crate::fixtures::*;
use glam::DVec2;
use segue_motion::graph::Place;

#[test]
fn walk_visits_a_clip_and_follows_a_path() {
    let mut session = opened(SMALL);
    let before = Arc::clone(walk(&session));
    for clip in [2, 0, 1] {
        set(&mut session, Key::GoTo, List::Visits(vec![(6.0, clip)]).into());
        let now = walk(&session);
        let reached = (60..140).any(|k| now.at(f64::from(k) * 0.1).unwrap().place.clip == clip);
        assert!(reached, "clip {clip}: {:?}", way(now));
        let same = before
            .motion
            .ground_frames()
            .iter()
            .zip(now.motion.ground_frames())
            .take_while(|(a, b)| a == b);
        assert!(same.count() >= 5 * 60, "what has played stays");
    }
    set(&mut session, Key::GoTo, List::Visits(vec![(6.0, 9)]).into());
    assert!(session.panes()[0].problem.as_ref().unwrap().to_string().contains("no clip 9"));
    session.apply(Command::Reset(Key::GoTo)).unwrap();

    let line: Vec<DVec2> = (0..=10).map(|k| DVec2::new(0.1 * f64::from(k), f64::from(k))).collect();
    set(&mut session, Key::WalkPath, List::GroundPath(line.clone()).into());
    let walk = walk(&session);
    let trace = walk.followed.as_ref().unwrap();
    assert!(trace.along_m > 9.5 && trace.rms_m < 1.0, "{trace:?}");
    let start = walk.motion.ground_frames()[0].origin();
    assert!(start.length() < 0.1, "{start}");
    let at = walk.motion.ground_frames()[6 * 60].origin();
    assert!(at.z > 5.0 && (at.x - 0.1 * at.z).abs() < 1.5, "{at}");
}

#[test]
fn walk_follows_the_best_path_so_far_during_the_search() {
    let line: Vec<DVec2> = (0..=10).map(|k| DVec2::new(0.1 * f64::from(k), f64::from(k))).collect();
    let mut patient = opened(SMALL);
    set(&mut patient, Key::WalkPath, List::GroundPath(line.clone()).into());
    let mut hasty = opened(SMALL);
    hasty
        .apply(Command::Set(vec![(Key::WalkPath, List::GroundPath(line.clone()).into())]))
        .unwrap();
    let (mut shown, mut along) = (0, 0.0);
    let mut last = Arc::clone(walk(&hasty));
    while hasty.work() {
        // On a slow machine.
        hasty.work_took(0.3);
        if !Arc::ptr_eq(&last, walk(&hasty)) {
            last = Arc::clone(walk(&hasty));
            let trace = last.followed.as_ref().unwrap();
            shown += usize::from(trace.is_searching);
            assert!(trace.along_m + 2.0 > along && last.motion.clip().frames() >= 20 * 60);
            along = trace.along_m;
            assert_eq!(hasty.jobs().is_empty(), !trace.is_searching);
        }
    }
    assert!(shown >= 2, "{shown}");
    // The duration of the search does not change the final walk.
    let (a, b) = (walk(&patient), walk(&hasty));
    assert_eq!(a.followed, b.followed);
    assert!(!a.followed.as_ref().unwrap().is_searching);
    assert_eq!((&a.passed, a.motion.clip()), (&b.passed, b.motion.clip()));
}

#[test]
fn visit_begins_at_any_time() {
    let segments = "lab=graph&clips=walk,walk_left,walk_right&walk_seconds=20&blend_window=15&construction=segments&segment_size=40&edge_threshold=10";
    for link in [SMALL, segments] {
        let mut session = opened(link);
        let before = Arc::clone(walk(&session));
        let (mut first, mut off_the_way) = (0, 0);
        let mut known = std::collections::BTreeMap::new();
        for tenth in (0..180).step_by(4) {
            let (secs, clip) = (f64::from(tenth) * 0.1, tenth as usize / 4 % 3);
            set(&mut session, Key::GoTo, List::Visits(vec![(secs, clip)]).into());
            let now = &Arc::clone(walk(&session));
            assert_eq!(now.missed, []);
            assert_connected(now);
            let due = (secs * 60.0).round() as usize;
            for frame in 0..due {
                let same = now.motion.clip().rotations(frame)
                    == before.motion.clip().rotations(frame)
                    && now.motion.clip().root_translations()[frame]
                        == before.motion.clip().root_translations()[frame]
                    && now.motion.ground_frames()[frame] == before.motion.ground_frames()[frame];
                assert!(same, "{link}: set off at {due}, frame {frame} is another one");
            }
            // Reached as soon as there is a path, not by chance later.
            let there = now
                .passed
                .iter()
                .find(|passed| passed.stay.clip == clip && passed.end > due)
                .unwrap();
            assert!(there.start < due + 9 * 60, "{link}: {due} {there:?}");
            assert_eq!(number(&session, 0, MetricId::Spins), 0.0, "{link}: {secs}");
            // Spins and flashes that a transition always has are not caused by the visit.
            let flashes = number(&session, 0, MetricId::Flashes);
            let mut alone = 0.0;
            for seam in now.passed.iter().filter_map(|passed| passed.seam) {
                let jump = List::Jump(Some([seam.leave, seam.enter]));
                let text = jump.write();
                if !known.contains_key(&text) {
                    set(&mut session, Key::Jump, jump.into());
                    known.insert(text.clone(), number(&session, 0, MetricId::Flashes));
                }
                alone += known[&text];
            }
            session.apply(Command::Reset(Key::Jump)).unwrap();
            assert!(flashes <= alone, "{link}: {secs}: {flashes}, {alone} of them by themselves");
            off_the_way += usize::from(way(now) != way(&before));
            first += usize::from(now.passed[0].stay == before.passed[0].stay);
        }
        assert!(off_the_way > 20 && first > 20, "{off_the_way} {first}");
    }
    // One visit after another, and a second one before the first is reached.
    let mut session = opened(SMALL);
    for visits in ["3:2,9:0,14:1", "6:2,6.1:0,6.2:1"] {
        set(&mut session, Key::GoTo, Key::GoTo.param().parse(visits).unwrap());
        assert_connected(walk(&session));
    }
    let reached = (62..150).any(|k| walk(&session).at(f64::from(k) * 0.1).unwrap().place.clip == 1);
    assert!(reached, "{:?}", way(walk(&session)));
}

#[test]
fn visit_of_an_unreachable_clip_is_reported() {
    // Without clips that start and stop, no path leads to rest.
    let mut session =
        opened("lab=graph&clips=walk,walk_left,walk_right,idle&walk_seconds=20&blend_window=20");
    let built = Arc::clone(&walk(&session).built);
    let walked: Vec<bool> = (0..5).map(|clip| built.is_walked(clip)).collect();
    assert_eq!(walked, [true, true, true, false, false]);
    assert_eq!(built.clips_from(Place { clip: 0, frame: 50 }), walked[..4]);
    let before = way(walk(&session));
    set(&mut session, Key::GoTo, List::Visits(vec![(5.0, 3), (8.0, 1)]).into());
    assert_eq!(walk(&session).missed, [(5.0, 3)]);
    assert_ne!(way(walk(&session)), before, "the other visit is made");
    session.apply(Command::Reset(Key::GoTo)).unwrap();
    assert_eq!(walk(&session).missed, []);
    // In the unpruned graph, some parts do not reach each other, or one way only.
    set(&mut session, Key::Prune, Value::Switch(false));
    let built = &walk(&session).built;
    for clip in 0..4 {
        for frame in (0..built.clips().set().frames_of(clip)).step_by(37) {
            let place = Place { clip, frame };
            let reached = built.clips_from(place);
            let graph = built.graph();
            let start = graph.node_at(place).unwrap();
            for (other, reached) in reached.iter().enumerate() {
                let mut nodes = graph.graph().node_indices();
                let wanted = nodes.any(|node| {
                    graph.graph()[node].clip == other
                        && petgraph::algo::has_path_connecting(graph.graph(), start, node, None)
                });
                assert_eq!(*reached, wanted, "{place:?} {other}");
            }
        }
    }
}

#[test]
fn clip_removed_from_the_list_resets_parameters_with_clip_indices() {
    let mut session = opened(&format!("{SMALL}&go_to=6:2&jump=0:1-2:3"));
    session.apply(Command::Remove("walk".into())).unwrap();
    while session.work() {}
    assert_eq!(session.graph_clip_ids(), ["walk_left", "walk_right"]);
    let text = |session: &Session, key: Key| key.param().format(session.params().get(key));
    assert_eq!(
        (text(&session, Key::GoTo), text(&session, Key::Jump)),
        (String::new(), String::new())
    );
    assert_eq!(session.panes()[0].problem, None);
    session.apply(Command::Undo).unwrap();
    assert_eq!(
        (text(&session, Key::GoTo), text(&session, Key::Jump)),
        ("6:2".into(), "0:1-2:3".into())
    );
}
