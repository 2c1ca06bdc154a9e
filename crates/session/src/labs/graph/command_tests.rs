//! Tests of the Graph lab, by commands.

use crate::JobKind;
use crate::fixtures::*;
use crate::{List, Walk};
use glam::DVec2;
use segue_motion::graph::Place;
use segue_text::ToMessage;

fn opened(link: &str) -> Session {
    let mut session = Session::new();
    session.apply(Command::OpenLink(link.into())).unwrap();
    while session.work() {}
    session
}

/// A graph that is built quickly.
const SMALL: &str = "lab=graph&clips=walk,walk_left,walk_right&walk_seconds=20&blend_window=20";

fn set(session: &mut Session, key: Key, value: Value) {
    session.apply(Command::Set(vec![(key, value)])).unwrap();
    while session.work() {}
}

fn walk(session: &Session) -> &Arc<Walk> {
    walk_of(session, 0)
}

fn walk_of(session: &Session, pane: usize) -> &Arc<Walk> {
    let pane = &session.panes()[pane];
    assert_eq!(pane.problem, None);
    pane.outcome.as_ref().unwrap().walk().unwrap()
}

fn number(session: &Session, pane: usize, id: MetricId) -> f64 {
    let outcome = session.panes()[pane].outcome.as_ref().unwrap();
    outcome.metric(id).and_then(|metric| metric.value).unwrap_or(f64::NAN)
}

/// Returns the clips in the order in which they play, with the frame at which each is entered.
fn way(walk: &Walk) -> Vec<(usize, usize)> {
    walk.passed.iter().map(|passed| (passed.stay.clip, passed.stay.from)).collect()
}

#[test]
fn result_of_another_lab_is_not_shown_as_a_walk() {
    let mut session = Session::new();
    session.apply(Command::OpenLink(SMALL.into())).unwrap();
    assert!(session.panes()[0].outcome.is_none());
    while session.work() {}
    let first = walk(&session).clone();
    // A walk stays until there is a newer one.
    session.apply(Command::Set(vec![(Key::BlendWindow, Value::Number(12.0))])).unwrap();
    assert!(Arc::ptr_eq(walk(&session), &first));
}

#[test]
fn walk_through_the_built_in_clips_has_no_jump() {
    let session = opened("lab=graph");
    let walk = walk(&session);
    assert_eq!(walk.motion.clip().frames(), 3600);
    assert_eq!(walk.motion.ground_frames().len(), 3600);
    assert_eq!(
        (number(&session, 0, MetricId::Spins), number(&session, 0, MetricId::Flashes)),
        (0.0, 0.0)
    );
    assert!(
        number(&session, 0, MetricId::SeamsPerMinute) > 10.0
            && number(&session, 0, MetricId::Variety) > 30.0
    );
    let slide = number(&session, 0, MetricId::FootSlide);
    assert!(slide < 15.0, "{slide}");
    assert!(walk.built.rings()[0] > 0.6, "one large component: {:?}", walk.built.rings());
    assert!(walk.run_secs.unwrap() > 0.5);
    // The state at a time is that of the stays, and its ghosts are clips of the walk.
    for secs in [0.0, 3.3, 17.0, 59.0] {
        let at = walk.at(secs).unwrap();
        let frame = (secs * 60.0).round() as usize;
        let passed = walk.passed[at.stay];
        assert!((passed.start..passed.end).contains(&frame) && passed.stay.clip == at.place.clip);
        assert_eq!(at.place.frame, passed.stay.from + frame - passed.start);
    }
    // Between two transitions the walk equals the clip at another place.
    let calm = walk
        .passed
        .iter()
        .find(|passed| passed.end > passed.start + 60 && passed.seam.is_some())
        .unwrap();
    let clip = walk.built.clips().motions()[calm.stay.clip].clip();
    let (frame, place) = (calm.start + 45, calm.stay.from + 45);
    for joint in 1..clip.skeleton().len() {
        let turned =
            walk.motion.clip().rotations(frame)[joint].angle_between(clip.rotations(place)[joint]);
        assert!(turned < 1e-3, "joint {joint}: {turned}");
    }
}

#[test]
fn walk_of_the_same_seed_is_the_same_and_grows_while_it_plays() {
    let mut session = opened(SMALL);
    let first = Arc::clone(walk(&session));
    assert_eq!(way(&first), way(walk(&opened(SMALL))));
    assert_ne!(way(&first), way(walk(&opened(&format!("{SMALL}&seed=8")))));
    assert!(!session.work() && session.jobs().is_empty());
    let numbers: Vec<f64> = [MetricId::Spins, MetricId::Lag, MetricId::Variety]
        .map(|id| number(&session, 0, id))
        .to_vec();
    for _ in 0..20 * 30 {
        assert!(session.tick(1.0 / 20.0));
        while session.work() {}
        assert!(session.jobs().is_empty(), "that it gets longer is nothing to wait for");
    }
    let now = walk(&session);
    assert!((session.now_secs() - 30.0).abs() < 0.1, "it never came round: {}", session.now_secs());
    assert!(
        now.motion.clip().duration_secs() > 49.0
            && now.motion.clip().frames() > first.motion.clip().frames()
    );
    assert_eq!(way(now)[..way(&first).len() - 1], way(&first)[..way(&first).len() - 1]);
    let frames = first.motion.clip().frames();
    assert_eq!(now.motion.ground_frames()[..frames], first.motion.ground_frames()[..frames]);
    assert_eq!(
        [MetricId::Spins, MetricId::Lag, MetricId::Variety]
            .map(|id| number(&session, 0, id))
            .to_vec(),
        numbers
    );
    // A link to a time beyond the measured part shows that time.
    let later = opened(&format!("{SMALL}&play=off&t=61"));
    assert!(later.now_secs() == 61.0 && walk(&later).motion.clip().duration_secs() > 80.0);
}

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
fn mistakes_spin_on_the_same_walk() {
    let session = opened(&format!("{SMALL}&compare=atan:atan2,atan"));
    assert_eq!(way(walk_of(&session, 0)), way(walk_of(&session, 1)));
    assert!(
        number(&session, 0, MetricId::Spins) == 0.0 && number(&session, 1, MetricId::Spins) > 0.0
    );
    let session = opened(&format!("{SMALL}&compare=transform:whole,first"));
    assert_eq!(way(walk_of(&session, 0)), way(walk_of(&session, 1)));
    assert!(
        number(&session, 0, MetricId::Spins) == 0.0 && number(&session, 1, MetricId::Spins) > 0.0
    );
    let both = opened(&format!("{SMALL}&atan=atan&transform=first"));
    assert!(both.panes()[0].problem.as_ref().unwrap().to_string().contains("Two mistakes at once"));
}

#[test]
fn walks_with_other_windows_follow_the_first_where_they_can() {
    let session = opened(&format!("{SMALL}&edge_threshold=10&compare=blend_window:24,12,8"));
    let clips = |pane: usize| -> Vec<usize> {
        walk_of(&session, pane).passed.iter().map(|passed| passed.stay.clip).collect()
    };
    assert!(!walk_of(&session, 0).is_guided && walk_of(&session, 1).is_guided);
    // Most of the time the same clip plays in all panes.
    for pane in 1..session.panes().len() {
        let same = (0..200).filter(|k| {
            let secs = f64::from(*k) * 0.1;
            let clip = |pane| walk_of(&session, pane).at(secs).unwrap().place.clip;
            clip(0) == clip(pane)
        });
        let share = same.count() as f64 / 200.0;
        assert!(share > 0.6, "{share}: {:?} {:?}", clips(0), clips(pane));
    }
}

#[test]
fn walks_with_other_segments_or_thresholds_are_their_own() {
    let segments = "lab=graph&clips=walk,walk_left,walk_right&walk_seconds=20&construction=segments&blend_window=10&edge_threshold=10";
    for link in [
        format!("{segments}&compare=segment_size:40,20"),
        format!("{SMALL}&compare=edge_threshold:2,10"),
    ] {
        let session = opened(&link);
        assert!(!walk_of(&session, 1).is_guided);
        assert_ne!(way(walk_of(&session, 0)), way(walk_of(&session, 1)), "{link}");
        let slides = [0, 1].map(|pane| number(&session, pane, MetricId::FootSlide));
        assert_ne!(slides[0], slides[1], "{link}");
        // Each is the same as alone.
        let alone = opened(
            &link
                .replace("compare=segment_size:40,20", "segment_size=20")
                .replace("compare=edge_threshold:2,10", "edge_threshold=10"),
        );
        assert_eq!(way(walk(&alone)), way(walk_of(&session, 1)), "{link}");
    }
}

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
fn locked_feet_stay_in_place_while_the_walk_grows() {
    let mut session = opened(&format!("{SMALL}&foot_lock=on"));
    let before = Arc::clone(walk(&session));
    let free = opened(SMALL);
    assert_eq!(way(&before), way(walk(&free)), "the same walk");
    assert_ne!(before.motion.clip(), walk(&free).motion.clip());
    session.apply(Command::Playback(PlaybackCommand::Seek(15.0))).unwrap();
    while session.work() {}
    let after = walk(&session);
    assert!(after.motion.clip().frames() > before.motion.clip().frames());
    // The part about to play is the one that was shown before, except for rounding: the plane in
    // which a leg usually bends is that of the whole walk.
    let mut most = 0.0_f32;
    for frame in 0..18 * 60 {
        let pairs =
            after.motion.clip().rotations(frame).iter().zip(before.motion.clip().rotations(frame));
        most = pairs.map(|(a, b)| (*a - *b).length()).fold(most, f32::max);
    }
    assert!(most < 1e-5, "{most}");
}

#[test]
fn chosen_transition_plays_alone() {
    let mut session = opened(SMALL);
    let jump = walk(&session).built.whole().jumps()[3];
    set(&mut session, Key::Jump, List::Jump(Some([jump.leave, jump.enter])).into());
    let outcome = session.main_outcome().unwrap();
    let transition = outcome.transition.unwrap();
    assert!(walk(&session).is_jump && outcome.sources.len() == 2);
    assert!((f64::from(transition.distance_cm) - jump.distance_cm).abs() < 1e-3);
    assert_eq!((transition.leave_a_secs * 60.0).round() as usize, jump.leave.frame);
    // Each source lies on the result where only that source plays.
    for (source, secs) in outcome.sources.iter().zip([0.0, transition.end_secs + 0.2]) {
        let stands =
            source.world_from_clip.after(&source.motion.standing_at(secs - source.starts_at_secs));
        let off = stands.shift.distance(outcome.motion.standing_at(secs).shift);
        assert!(off < 0.25, "{off} m");
    }
    assert!(number(&session, 0, MetricId::Variety).is_nan());
    let none = [0, 1].map(|clip| Place { clip, frame: 1 });
    set(&mut session, Key::Jump, List::Jump(Some(none)).into());
    let pane = &session.panes()[0];
    assert!(
        pane.problem.as_ref().unwrap().to_string().contains("There is no transition from frame 1"),
        "{:?}",
        pane.problem
    );
    assert!(pane.outcome.is_none());
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
fn kept_walk_is_made_again_from_its_link() {
    let mut session = opened(SMALL);
    let kept = session.main_outcome().unwrap().motion.clip().clone();
    session.apply(Command::Keep(0)).unwrap();
    let entry = session.library().entries().last().unwrap();
    let id = entry.id.clone();
    assert!(id.starts_with("graph(") && id.contains("clips:walk%2Cwalk_left"), "{id}");
    let again = opened(&format!("lab=view&a={}", id.replace('%', "%25")));
    let made = again.main_outcome().unwrap();
    assert_eq!(
        (made.motion.clip().rotations(900), made.motion.clip().frames()),
        (kept.rotations(900), kept.frames())
    );
    // A clip that is removed from the library leaves the graph.
    session.apply(Command::Remove("walk_left".into())).unwrap();
    while session.work() {}
    assert_eq!(session.graph_clip_ids(), ["walk", "walk_right"]);
    assert_eq!(walk(&session).built.clips().names().len(), 2);
    // The walk of a guided pane cannot be kept: alone it takes another path.
    let mut compared = opened(&format!("{SMALL}&compare=blend_window:20,10"));
    assert!(matches!(compared.apply(Command::Keep(1)), Err(CommandError::NotPossible(_))));
    assert!(compared.apply(Command::Keep(0)).is_ok());
}

/// Asserts that each stay begins where a transition enters and ends where the next one leaves,
/// along transitions of the graph.
fn assert_connected(walk: &Walk) {
    let jumps = walk.built.graph().jumps();
    for pair in walk.passed.windows(2) {
        let (stay, next) = (&pair[0].stay, &pair[1].stay);
        let jump = &jumps[next.jump.unwrap()];
        assert_eq!((stay.clip, stay.to), (jump.leave.clip, jump.leave.frame));
        assert_eq!((next.clip, next.from), (jump.enter.clip, jump.enter.frame));
        assert!(stay.from < stay.to && pair[0].end == pair[1].start);
        assert_eq!(
            pair[1].seam.map(|seam| [seam.leave, seam.enter]),
            Some([jump.leave, jump.enter])
        );
    }
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
fn guided_walk_does_not_depend_on_what_was_shown_of_its_guide() {
    let small = format!("{SMALL}&edge_threshold=10&play=off");
    let compare = "blend_window:24,12,8";
    let fresh = opened(&format!("{small}&compare={compare}"));
    // The first walk is known already, and is much longer.
    let mut late = opened(&format!("{small}&blend_window=24&t=90"));
    assert!(walk(&late).motion.clip().duration_secs() > 100.0);
    late.apply(Command::Set(vec![
        (Key::Compare, Key::Compare.param().parse(compare).unwrap()),
        (Key::Time, Value::Number(0.0)),
    ]))
    .unwrap();
    while late.work() {}
    // The guiding walk becomes long.
    let mut long = opened(&format!("{small}&compare={compare}"));
    long.apply(Command::Playback(PlaybackCommand::Seek(70.0))).unwrap();
    while long.work() {}
    for pane in 1..3 {
        let wanted = way(walk_of(&fresh, pane));
        let wanted = &wanted[..wanted.len() - 1];
        assert!(walk_of(&fresh, pane).is_guided && wanted.len() > 5);
        for other in [&late, &long] {
            assert_eq!(way(walk_of(other, pane))[..wanted.len()], *wanted, "pane {pane}");
        }
        assert_connected(walk_of(&long, pane));
    }
    // A walk along a line follows the line, whatever the first one does.
    let line: Vec<DVec2> = (0..=10).map(|k| DVec2::new(0.1 * f64::from(k), f64::from(k))).collect();
    let path = List::GroundPath(line).write();
    let both = opened(&format!("{small}&walk_path={path}&compare={compare}"));
    let alone = opened(&format!("{small}&walk_path={path}&blend_window=12"));
    assert!(!walk_of(&both, 1).is_guided);
    assert_eq!(walk_of(&both, 1).followed, walk(&alone).followed);
    let (found, wanted) = (way(walk_of(&both, 1)), way(walk(&alone)));
    assert_eq!(found[..found.len() - 1], wanted[..found.len() - 1]);
}

#[test]
fn guided_walk_makes_its_visits() {
    // From a walk, the only way to rest is by a stop.
    let link = "lab=graph&clips=walk,start,stop,idle,walk_left&walk_seconds=30&play=off&compare=blend_window:24,12,8&edge_threshold=10";
    let mut session = opened(link);
    for secs in (2..16).map(f64::from) {
        set(&mut session, Key::GoTo, List::Visits(vec![(secs, 3)]).into());
        for pane in 0..3 {
            let walk = walk_of(&session, pane);
            assert_eq!(walk.missed, []);
            let due = (secs * 60.0).round() as usize;
            let mut behind = walk.passed.iter().filter(|passed| passed.end > due);
            let transitions = behind.position(|passed| passed.stay.clip == 3);
            assert!(
                transitions.is_some_and(|transitions| transitions <= 4),
                "{secs} s, pane {pane}: {transitions:?}"
            );
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
    assert!(matches!(field.distances(), crate::Distances::FromAfar(_)));
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
        Arc::ptr_eq(session.graph_field().unwrap(), &field) && !walk(&session).built.lacks_some()
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

/// A stay of the golden walk: the clip's id, the frames that play, and the walk's frame at which it
/// begins.
#[derive(Debug, PartialEq, serde::Serialize, serde::Deserialize)]
struct GoldenStay {
    clip: String,
    from: usize,
    to: usize,
    start: usize,
}

#[derive(Debug, PartialEq, serde::Serialize, serde::Deserialize)]
struct GoldenWalk {
    link: String,
    fps: f64,
    window: usize,
    stays: Vec<GoldenStay>,
}

/// The first minute of the walk that this link opens, on every machine and in the browser
/// (`labs.test.mjs`). If a change makes another walk on purpose, copy what the test found.
#[test]
fn golden_walk_is_unchanged() {
    let text = include_str!("../../../tests/golden/walk.json");
    let golden: GoldenWalk = serde_json::from_str(text).unwrap();
    let session = opened(&golden.link);
    let (walk, ids) = (walk(&session), session.graph_clip_ids());
    let stays =
        walk.passed.iter().filter(|passed| passed.start < 60 * 60).map(|passed| GoldenStay {
            clip: ids[passed.stay.clip].clone(),
            from: passed.stay.from,
            to: passed.stay.to,
            start: passed.start,
        });
    let found = GoldenWalk {
        stays: stays.collect(),
        fps: walk.motion.clip().fps(),
        window: walk.built.options().blend_window,
        link: golden.link.clone(),
    };
    assert!(found == golden, "another walk: {}", serde_json::to_string_pretty(&found).unwrap());
}
