//! Tests of walks: made, extended, kept, and the golden walk.

use super::fixtures::{SMALL, number, set, walk, way};
use crate::List;
use crate::fixtures::*;
use segue_motion::graph::Place;

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
    assert!(
        walk.built.component_shares()[0] > 0.6,
        "one large component: {:?}",
        walk.built.component_shares()
    );
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
