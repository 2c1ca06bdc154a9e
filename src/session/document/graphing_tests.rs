//! The Graph lab, by commands.

use super::*;
use crate::graph::Place;
use crate::session::{Walk, write_jump, write_path};
use glam::DVec2;

fn opened(link: &str) -> Session {
    let mut session = Session::new();
    session.apply(Command::OpenLink(link.into())).unwrap();
    while session.work() {}
    session
}

/// A graph that is made in a moment.
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
    pane.outcome.as_ref().unwrap().walk.as_ref().unwrap()
}

fn number(session: &Session, pane: usize, id: &str) -> f64 {
    let outcome = session.panes()[pane].outcome.as_ref().unwrap();
    let metric = outcome.metrics.iter().find(|metric| metric.id == id);
    metric.and_then(|metric| metric.value).unwrap_or(f64::NAN)
}

/// Clips, in the order in which they play, with the frame at which each is entered.
fn way(walk: &Walk) -> Vec<(usize, usize)> {
    walk.passed.iter().map(|passed| (passed.stay.clip, passed.stay.from)).collect()
}

#[test]
fn the_result_of_another_lab_does_not_stand_in_for_a_walk() {
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
fn a_walk_goes_through_the_built_in_clips_without_a_jump() {
    let session = opened("lab=graph");
    let walk = walk(&session);
    assert_eq!(walk.motion.clip.frames(), 3600);
    assert_eq!(walk.motion.ground_frames.len(), 3600);
    assert_eq!((number(&session, 0, "spins"), number(&session, 0, "flashes")), (0.0, 0.0));
    assert!(number(&session, 0, "seams_per_min") > 10.0 && number(&session, 0, "variety") > 30.0);
    assert!(number(&session, 0, "walk_skate_cm") < 6.0);
    assert!(walk.built.rings()[0] > 0.6, "one large component: {:?}", walk.built.rings());
    assert!(walk.run_secs.unwrap() > 0.5);
    // What it shows is what it is made of.
    for secs in [0.0, 3.3, 17.0, 59.0] {
        let at = walk.at(secs).unwrap();
        let frame = (secs * 60.0).round() as usize;
        let passed = walk.passed[at.stay];
        assert!((passed.start..passed.end).contains(&frame) && passed.stay.clip == at.place.clip);
        assert_eq!(at.place.frame, passed.stay.from + frame - passed.start);
    }
    // Behind a transition and before the next, the walk is the clip, laid somewhere else.
    let calm = walk
        .passed
        .iter()
        .find(|passed| passed.end > passed.start + 60 && passed.seam.is_some())
        .unwrap();
    let clip = &walk.built.cast().motions()[calm.stay.clip].clip;
    let (frame, place) = (calm.start + 45, calm.stay.from + 45);
    for joint in 1..clip.skeleton().len() {
        let turned = walk.motion.clip.rotations(frame)[joint].angle_between(clip.rotations(place)[joint]);
        assert!(turned < 1e-3, "joint {joint}: {turned}");
    }
}

#[test]
fn the_same_seed_is_the_same_walk_and_it_grows_while_it_plays() {
    let mut session = opened(SMALL);
    let first = Arc::clone(walk(&session));
    assert_eq!(way(&first), way(walk(&opened(SMALL))));
    assert_ne!(way(&first), way(walk(&opened(&format!("{SMALL}&seed=8")))));
    assert!(!session.work() && session.jobs().is_empty());
    let numbers: Vec<f64> = ["spins", "walk_lag_s", "variety"].map(|id| number(&session, 0, id)).to_vec();
    for _ in 0..20 * 30 {
        assert!(session.tick(1.0 / 20.0));
        while session.work() {}
        assert!(session.jobs().is_empty(), "that it gets longer is nothing to wait for");
    }
    let now = walk(&session);
    assert!(
        (session.now_secs() - 30.0).abs() < 0.1,
        "it never came round: {}",
        session.now_secs()
    );
    assert!(now.motion.clip.duration_secs() > 49.0 && now.motion.clip.frames() > first.motion.clip.frames());
    assert_eq!(way(now)[..way(&first).len() - 1], way(&first)[..way(&first).len() - 1]);
    let frames = first.motion.clip.frames();
    assert_eq!(now.motion.ground_frames[..frames], first.motion.ground_frames[..frames]);
    assert_eq!(
        ["spins", "walk_lag_s", "variety"].map(|id| number(&session, 0, id)).to_vec(),
        numbers
    );
    // A link to a time beyond what is measured shows that time.
    let later = opened(&format!("{SMALL}&play=off&t=61"));
    assert!(later.now_secs() == 61.0 && walk(&later).motion.clip.duration_secs() > 80.0);
}

#[test]
fn a_change_is_made_in_slices_from_what_is_known_and_can_be_given_up() {
    let mut session = opened("lab=graph&walk_seconds=20");
    let slices = |session: &mut Session, key: Key, value: f64| {
        session.apply(Command::Set(vec![(key, Value::Number(value))])).unwrap();
        let before = Arc::clone(walk(session));
        let (mut count, mut progress) = (0, -1.0);
        while let Some(job) = session.jobs().into_iter().find(|job| job.name == "graphing") {
            assert!(job.progress >= progress && job.progress <= 1.0, "{} after {progress}", job.progress);
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
    // A window that was there before is there at once, but for the walk.
    session.apply(Command::Set(vec![(Key::BlendWindow, Value::Number(30.0))])).unwrap();
    assert_eq!(session.graph_field().unwrap().window(), 30);
    assert!(session.graph_built().is_some());
    while session.work() {}

    session.apply(Command::Set(vec![(Key::BlendWindow, Value::Number(40.0))])).unwrap();
    session.work();
    session.apply(Command::StopGraph(true)).unwrap();
    assert!(!session.work() && session.jobs().is_empty() && session.graph_is_stopped());
    assert!(session.panes()[0].outcome.is_some(), "the last good one stays");
    session.apply(Command::StopGraph(false)).unwrap();
    while session.work() {}
    assert_eq!(walk(&session).built.options().blend_window, 40);
    session.apply(Command::StopGraph(true)).unwrap();
    set(&mut session, Key::BlendWindow, Value::Number(12.0));
    assert_eq!(walk(&session).built.options().blend_window, 12, "a change goes on");
    // A lab that is left is not worked for.
    session.apply(Command::Set(vec![(Key::BlendWindow, Value::Number(33.0))])).unwrap();
    session.apply(Command::Set(vec![(Key::Lab, Value::Choice("view"))])).unwrap();
    assert!(session.jobs().is_empty());
}

#[test]
fn the_mistakes_spin_on_the_same_walk() {
    let session = opened(&format!("{SMALL}&compare=atan:atan2,atan"));
    assert_eq!(way(walk_of(&session, 0)), way(walk_of(&session, 1)));
    assert!(number(&session, 0, "spins") == 0.0 && number(&session, 1, "spins") > 0.0);
    let session = opened(&format!("{SMALL}&compare=transform:whole,first"));
    assert_eq!(way(walk_of(&session, 0)), way(walk_of(&session, 1)));
    assert!(number(&session, 0, "spins") == 0.0 && number(&session, 1, "spins") > 0.0);
    let both = opened(&format!("{SMALL}&atan=atan&transform=first"));
    assert!(both.panes()[0].problem.as_ref().unwrap().contains("Two mistakes at once"));
}

#[test]
fn other_windows_and_segments_walk_the_same_way_where_they_can() {
    for link in [
        format!("{SMALL}&edge_threshold=10&compare=blend_window:24,12,8"),
        "lab=graph&clips=walk,walk_left,walk_right&walk_seconds=20&blend_window=10&construction=segments&edge_threshold=10&compare=segment_size:40,20"
            .to_owned(),
    ] {
        let session = opened(&link);
        let clips = |pane: usize| -> Vec<usize> { walk_of(&session, pane).passed.iter().map(|passed| passed.stay.clip).collect() };
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
}

#[test]
fn a_clip_is_gone_to_and_a_path_is_followed() {
    let mut session = opened(SMALL);
    let before = Arc::clone(walk(&session));
    for clip in [2, 0, 1] {
        set(&mut session, Key::GoTo, Value::Text(format!("6:{clip}")));
        let now = walk(&session);
        let reached = (60..140).any(|k| now.at(f64::from(k) * 0.1).unwrap().place.clip == clip);
        assert!(reached, "clip {clip}: {:?}", way(now));
        let same = before
            .motion
            .ground_frames
            .iter()
            .zip(&now.motion.ground_frames)
            .take_while(|(a, b)| a == b);
        assert!(same.count() >= 5 * 60, "what has played stays");
    }
    set(&mut session, Key::GoTo, Value::Text("6:9".into()));
    assert!(session.panes()[0].problem.as_ref().unwrap().contains("no clip 9"));
    set(&mut session, Key::GoTo, Value::Text(String::new()));

    let line: Vec<DVec2> = (0..=10).map(|k| DVec2::new(0.1 * f64::from(k), f64::from(k))).collect();
    set(&mut session, Key::WalkPath, Value::Text(write_path(&line)));
    let walk = walk(&session);
    let trace = walk.followed.as_ref().unwrap();
    assert!(trace.along_m > 9.5 && trace.rms_m < 1.0, "{trace:?}");
    let start = walk.motion.ground_frames[0].origin();
    assert!(start.length() < 0.1, "{start}");
    let at = walk.motion.ground_frames[6 * 60].origin();
    assert!(at.z > 5.0 && (at.x - 0.1 * at.z).abs() < 1.5, "{at}");
}

#[test]
fn the_best_way_so_far_is_walked_while_a_path_is_searched() {
    let line: Vec<DVec2> = (0..=10).map(|k| DVec2::new(0.1 * f64::from(k), f64::from(k))).collect();
    let mut patient = opened(SMALL);
    set(&mut patient, Key::WalkPath, Value::Text(write_path(&line)));
    let mut hasty = opened(SMALL);
    hasty
        .apply(Command::Set(vec![(Key::WalkPath, Value::Text(write_path(&line)))]))
        .unwrap();
    let (mut shown, mut along) = (0, 0.0);
    let mut last = Arc::clone(walk(&hasty));
    while hasty.work() {
        // A slow machine.
        hasty.work_took(0.3);
        if !Arc::ptr_eq(&last, walk(&hasty)) {
            last = Arc::clone(walk(&hasty));
            let trace = last.followed.as_ref().unwrap();
            shown += usize::from(trace.is_searching);
            assert!(trace.along_m + 2.0 > along && last.motion.clip.frames() >= 20 * 60);
            along = trace.along_m;
            assert_eq!(hasty.jobs().is_empty(), !trace.is_searching);
        }
    }
    assert!(shown >= 2, "{shown}");
    // How long one had to wait changes nothing in the end.
    let (a, b) = (walk(&patient), walk(&hasty));
    assert_eq!(a.followed, b.followed);
    assert!(!a.followed.as_ref().unwrap().is_searching);
    assert_eq!((&a.passed, &a.motion.clip), (&b.passed, &b.motion.clip));
}

#[test]
fn held_feet_stay_where_they_are_while_the_walk_grows() {
    let mut session = opened(&format!("{SMALL}&foot_lock=on"));
    let before = Arc::clone(walk(&session));
    let free = opened(SMALL);
    assert_eq!(way(&before), way(walk(&free)), "the same walk");
    assert_ne!(before.motion.clip, walk(&free).motion.clip);
    session.apply(Command::Seek(15.0)).unwrap();
    while session.work() {}
    let after = walk(&session);
    assert!(after.motion.clip.frames() > before.motion.clip.frames());
    // What is about to play is what was shown before, but for roundings: the plane in which a leg usually bends is that of the whole walk.
    let mut most = 0.0_f32;
    for frame in 0..18 * 60 {
        let pairs = after.motion.clip.rotations(frame).iter().zip(before.motion.clip.rotations(frame));
        most = pairs.map(|(a, b)| (*a - *b).length()).fold(most, f32::max);
    }
    assert!(most < 1e-5, "{most}");
}

#[test]
fn one_transition_plays_alone() {
    let mut session = opened(SMALL);
    let jump = walk(&session).built.whole().jumps()[3];
    set(&mut session, Key::Jump, Value::Text(write_jump(jump.leave, jump.enter)));
    let outcome = session.main_outcome().unwrap();
    let transition = outcome.transition.unwrap();
    assert!(walk(&session).is_jump && outcome.sources.len() == 2);
    assert!((f64::from(transition.distance_cm) - jump.distance_cm).abs() < 1e-3);
    assert_eq!((transition.leave_a_secs * 60.0).round() as usize, jump.leave.frame);
    // Each source lies on the result where that is the source alone.
    for (source, secs) in outcome.sources.iter().zip([0.0, transition.end_secs + 0.2]) {
        let stands = source
            .world_from_clip
            .after(&source.motion.standing_at(secs - source.starts_at_secs));
        let off = stands.shift.distance(outcome.motion.standing_at(secs).shift);
        assert!(off < 0.25, "{off} m");
    }
    assert!(number(&session, 0, "variety").is_nan());
    let none = write_jump(Place { clip: 0, frame: 1 }, Place { clip: 1, frame: 1 });
    set(&mut session, Key::Jump, Value::Text(none));
    let pane = &session.panes()[0];
    assert!(
        pane.problem.as_ref().unwrap().contains("There is no transition from frame 1"),
        "{:?}",
        pane.problem
    );
    assert!(pane.outcome.is_some());
}

#[test]
fn every_setting_answers_and_the_last_good_walk_stays() {
    let mut session = opened("lab=graph&clips=walk(make_seconds:2),walk(turn_rate:20,make_seconds:2)&walk_seconds=10");
    let mut good = session.main_outcome().cloned();
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
                        assert!(problem.ends_with('.') && problem.contains(':'), "{problem}");
                        assert!(Arc::ptr_eq(pane.outcome.as_ref().unwrap(), good.as_ref().unwrap()));
                    }
                }
                good = pane.outcome.clone();
            }
        }
    }
    assert!(made > 10 && refused > 10, "{made} {refused}");
    for (key, text) in [
        (Key::Clips, "walk,nobody"),
        (Key::Clips, "walk,(run"),
        (Key::Clips, ","),
        (Key::WalkPath, "0:0"),
        (Key::WalkPath, "a"),
        (Key::GoTo, "3"),
        (Key::Jump, "0:1-x"),
    ] {
        set(&mut session, key, Value::Text(text.into()));
        assert!(session.panes()[0].problem.is_some(), "{text}");
        session.apply(Command::Reset(key)).unwrap();
    }
}

#[test]
fn a_walk_is_kept_and_made_again_from_its_link() {
    let mut session = opened(SMALL);
    let kept = session.main_outcome().unwrap().motion.clip.clone();
    session.apply(Command::Keep(0)).unwrap();
    let entry = session.library().entries().last().unwrap();
    let id = entry.id.clone();
    assert!(id.starts_with("graph(") && id.contains("clips:walk%2Cwalk_left"), "{id}");
    let again = opened(&format!("lab=view&a={}", id.replace('%', "%25")));
    let made = again.main_outcome().unwrap();
    assert_eq!(
        (made.motion.clip.rotations(900), made.motion.clip.frames()),
        (kept.rotations(900), kept.frames())
    );
    // A clip that is taken out of the library leaves the graph.
    session.apply(Command::Remove("walk_left".into())).unwrap();
    while session.work() {}
    assert_eq!(session.graph_clip_ids(), ["walk", "walk_right"]);
    assert_eq!(walk(&session).built.cast().names().len(), 2);
    // Not what a guided pane shows: alone it goes another way.
    let mut compared = opened(&format!("{SMALL}&compare=blend_window:20,10"));
    assert!(matches!(compared.apply(Command::Keep(1)), Err(CommandError::NotPossible(_))));
    assert!(compared.apply(Command::Keep(0)).is_ok());
}
