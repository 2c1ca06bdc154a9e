//! Tests of results that loop: place, phase and speed continue from the result before.

use crate::Span;
use crate::fixtures::*;
use crate::{Cycle, CycleMade};
use glam::Quat;
use segue_motion::clip::Interpolation;
use segue_motion::math::{Planar, quat};

fn open(link: &str) -> Session {
    let mut session = Session::new();
    session.apply(Command::OpenLink(link.into())).unwrap();
    assert_eq!(session.panes()[0].problem, None, "{link}");
    session
}

fn set(session: &mut Session, key: Key, value: f64) {
    session.apply(Command::Set(vec![(key, Value::Number(value))])).unwrap();
}

fn metric(session: &Session, pane: usize, id: MetricId) -> f64 {
    let outcome = session.panes()[pane].outcome.as_ref().unwrap();
    outcome.metric(id).unwrap().value.unwrap()
}

fn cycle(session: &Session) -> Cycle {
    session.main_outcome().unwrap().cycle.unwrap()
}

/// Returns what the stage shows: rotations relative to the character, the root's height, and the
/// placement of the character.
fn shown(session: &Session) -> (Vec<Quat>, f32, Planar) {
    shown_at(session, session.now_secs())
}

fn shown_at(session: &Session, secs: f64) -> (Vec<Quat>, f32, Planar) {
    let PaneContent { outcome, secs, place } = session.panes()[0].shown_at(secs).unwrap();
    let motion = &outcome.motion;
    let pose = motion.clip().sample(secs, Interpolation::Linear).unwrap();
    let here = motion.standing_at(secs);
    let mut rotations = pose.rotations;
    rotations[0] = here.inverse().rotation() * rotations[0];
    (rotations, pose.root_translation.y, place.after(&here))
}

/// Returns the largest angle between the same joint of two poses, degrees.
fn turned(a: &[Quat], b: &[Quat]) -> f32 {
    let angles = a.iter().zip(b).map(|(&a, &b)| quat::angle_between(a, b).to_degrees());
    angles.fold(0.0, f32::max)
}

fn distance(a: &Planar, b: &Planar) -> f64 {
    a.shift.distance(b.shift)
}

#[test]
fn requested_speed_is_measured_over_the_whole_range() {
    let mut session = open("lab=speed");
    let CycleMade::Gait { clips_mps: [a, b], .. } = cycle(&session).made else { panic!() };
    assert!((a - 1.4).abs() < 0.02 && (b - 3.5).abs() < 0.02);
    assert_eq!(session.automatic_value(Key::Speed), Some(2.45));
    for lock in [false, true] {
        session.apply(Command::Set(vec![(Key::FootLock, Value::Switch(lock))])).unwrap();
        for step in 0..=14 {
            let speed = 1.4 + 0.15 * f64::from(step);
            set(&mut session, Key::Speed, speed);
            assert_eq!(session.panes()[0].problem, None);
            let measured = metric(&session, 0, MetricId::Speed);
            assert!((measured / speed - 1.0).abs() < 0.02, "{speed}: {measured}");
            let (stride, cadence) =
                (metric(&session, 0, MetricId::Stride), metric(&session, 0, MetricId::Cadence));
            assert!((stride * cadence / 120.0 / speed - 1.0).abs() < 0.02, "{stride} {cadence}");
            let CycleMade::Gait { facts, .. } = cycle(&session).made else { panic!() };
            assert!(!facts.limited && !facts.extrapolated, "{speed} {facts:?}");
        }
    }
    let (before, after) =
        (metric(&session, 0, MetricId::FootSlideBefore), metric(&session, 0, MetricId::FootSlide));
    assert!(after < 0.5 * before && after < 1.0, "{before} {after}");
    set(&mut session, Key::Speed, 3.9);
    assert!(
        matches!(cycle(&session).made, CycleMade::Gait { facts, .. } if facts.extrapolated && !facts.limited)
    );
    set(&mut session, Key::Speed, 9.0);
    assert!(matches!(cycle(&session).made, CycleMade::Gait { facts, .. } if facts.limited));
}

#[test]
fn speeds_are_compared_side_by_side() {
    let mut session = open("lab=speed&compare=speed:1.4,2.2,3.5");
    assert_eq!(session.panes().len(), 3);
    for (pane, speed) in [1.4, 2.2, 3.5].into_iter().enumerate() {
        assert!((metric(&session, pane, MetricId::Speed) / speed - 1.0).abs() < 0.02);
    }
    // The shorter ones repeat until the longest has ended.
    let duration = session.duration_secs();
    for pane in session.panes() {
        let own = pane.outcome.as_ref().unwrap().duration_secs();
        let PaneContent { secs, place, .. } = pane.shown_at(duration - 1e-3).unwrap();
        assert!(secs <= own && (own >= duration || place.shift.length() > 5.0), "{secs} {place:?}");
    }
    session.tick(duration + 0.3);
    assert!(session.panes().iter().all(|pane| pane.place == Planar::IDENTITY));
}

#[test]
fn speed_that_is_dragged_changes_the_gait_without_a_jump() {
    for lock in ["off", "on"] {
        let mut session = open(&format!("lab=speed&speed=1.4&foot_lock={lock}"));
        let dt = 1.0 / 60.0;
        session.tick(1.3);
        let (mut largest, mut in_a_frame) = ((0.0f32, 0.0f64), 0.0f32);
        for step in 0..=100 {
            let speed = 1.4 + 0.021 * f64::from(step);
            let earlier = shown(&session).0;
            session.tick(dt);
            let phase = session.now_secs() / cycle(&session).secs;
            let (before, height, at) = shown(&session);
            set(&mut session, Key::Speed, speed);
            in_a_frame = in_a_frame.max(turned(&earlier, &before));
            let (after, height_after, at_after) = shown(&session);
            let phase_after = session.now_secs() / cycle(&session).secs;
            let off = (phase_after - phase).rem_euclid(1.0);
            assert!(off.min(1.0 - off) < 2e-3, "{phase} {phase_after}");
            largest.0 = largest.0.max(turned(&before, &after));
            largest.1 = largest
                .1
                .max(distance(&at, &at_after))
                .max(f64::from((height - height_after).abs()));
        }
        // A step of the slider turns no joint by half as much as a frame of the gait itself, and
        // the character keeps its place.
        assert!(
            largest.0 < 0.5 * in_a_frame && largest.1 < 5e-3,
            "{lock}: {largest:?} {in_a_frame}"
        );
        assert!(session.params().number(Key::Speed) >= 3.5);
    }
}

#[test]
fn speed_that_is_set_at_once_is_approached_gradually() {
    for (from, to) in [(1.4, 3.5), (3.5, 1.4)] {
        let mut session = open(&format!("lab=speed&speed={from}"));
        let dt = 1.0 / 60.0;
        let usual = |session: &mut Session| {
            let mut most = 0.0f32;
            for _ in 0..120 {
                let (before, ..) = shown(session);
                session.tick(dt);
                most = most.max(turned(&before, &shown(session).0));
            }
            most
        };
        let own = usual(&mut session);
        let (before, height, at) = shown(&session);
        set(&mut session, Key::Speed, to);
        // The numbers are those of the requested speed, and nothing has moved on the stage.
        assert!((metric(&session, 0, MetricId::Speed) / to - 1.0).abs() < 0.02);
        let (after, height_after, at_after) = shown(&session);
        assert!(
            turned(&before, &after) < 0.5
                && distance(&at, &at_after) < 1e-3
                && (height - height_after).abs() < 1e-3
        );
        assert!(session.panes()[0].ramp.is_some());
        let (mut last, mut most, mut fastest) = (after, 0.0f32, 0.0f64);
        let mut here = at_after;
        for _ in 0..90 {
            session.tick(dt);
            let (pose, _, place) = shown(&session);
            most = most.max(turned(&last, &pose));
            fastest = fastest.max(distance(&here, &place) / dt);
            (last, here) = (pose, place);
        }
        assert!(session.panes()[0].ramp.is_none(), "it has arrived");
        let most_of_both = own.max(usual(&mut session));
        assert!(
            most < 1.5 * most_of_both && fastest < 1.5 * 3.5,
            "{from} to {to}: {most} {own} {fastest}"
        );
        // While paused, the requested speed is shown at once.
        set(&mut session, Key::Speed, from);
        session.apply(Command::Playback(PlaybackCommand::TogglePlay)).unwrap();
        assert!(session.tick(dt) && !session.tick(dt) && session.panes()[0].ramp.is_none());
    }
}

#[test]
fn gait_at_another_phase_jumps() {
    // Half a cycle later the legs have changed places: the tests above would notice.
    let mut session = open("lab=speed&speed=1.4");
    session.tick(1.3);
    let (before, ..) = shown(&session);
    let half = session.now_secs() + 0.5 * cycle(&session).secs;
    session.apply(Command::Playback(PlaybackCommand::Seek(half))).unwrap();
    let (after, ..) = shown(&session);
    assert!(turned(&before, &after) > 20.0);
}

#[test]
fn playhead_that_is_moved_stays_there() {
    let mut session = open("lab=speed&speed=1.4&play=off");
    session
        .apply(Command::Set(vec![
            (Key::Speed, Value::Number(3.0)),
            (Key::Time, Value::Number(2.0)),
        ]))
        .unwrap();
    assert_eq!(session.now_secs(), 2.0);
    session.apply(Command::OpenLink("lab=speed&speed=2&t=1.5&play=off".into())).unwrap();
    assert_eq!((session.now_secs(), session.panes()[0].place), (1.5, Planar::IDENTITY));
}

#[test]
fn loop_repeats_a_hundred_times_without_drift() {
    for link in
        ["lab=loop&a=walk", "lab=loop&a=walk_left&foot_lock=on", "lab=loop&a=run&loop_method=cubic"]
    {
        let mut session = open(link);
        let Cycle { secs, .. } = cycle(&session);
        let duration = session.duration_secs();
        let cycles = (duration / secs).round() as usize;
        assert!((duration - cycles as f64 * secs).abs() < 1e-9 && cycles >= 2);
        // A hundred cycles have the same phase, however often the timeline begins again.
        let begin = 0.3 * secs;
        session.apply(Command::Playback(PlaybackCommand::Seek(begin))).unwrap();
        let (first, height, mut at) = shown_at(&session, begin);
        let mut steps: Vec<Planar> = Vec::new();
        for round in 1..=100 {
            session.tick(secs);
            // The playhead counts in milliseconds; poses are compared at the same time of the
            // cycle.
            let now = begin + (round % cycles) as f64 * secs;
            assert!((session.now_secs() - now).abs() < 0.1, "{round}");
            session.apply(Command::Playback(PlaybackCommand::Seek(now))).unwrap();
            let (pose, height_now, here) = shown_at(&session, now);
            assert!(
                turned(&first, &pose).to_radians() < 1e-4 && (height_now - height).abs() < 1e-4,
                "{link} {round}"
            );
            steps.push(at.inverse().after(&here));
            at = here;
        }
        for step in &steps {
            assert!(
                distance(step, &steps[0]) < 1e-3 && (step.yaw - steps[0].yaw).abs() < 1e-3,
                "{link}: {step:?} {:?}",
                steps[0]
            );
        }
        assert!(at.shift.length() > 3.0 || link.contains("left"), "{link}: {at:?}");
    }
}

#[test]
fn frames_of_every_cycle_are_those_of_the_first() {
    let mut session = open("lab=loop&a=walk_left");
    let outcome = Arc::clone(session.main_outcome().unwrap());
    let clip = outcome.motion.clip();
    let frames = (cycle(&session).secs * clip.fps()).round() as usize;
    let own = |frame: usize| {
        let mut rotations = clip.rotations(frame).to_vec();
        rotations[0] = outcome.motion.ground_frames()[frame].inverse().rotation() * rotations[0];
        rotations
    };
    for frame in 0..clip.frames() - frames {
        assert!(turned(&own(frame), &own(frame + frames)).to_radians() < 1e-4, "{frame}");
        let stands = outcome.motion.ground_frames();
        let step = |frame: usize| stands[frame].inverse().after(&stands[frame + frames]);
        if frame + 2 * frames < clip.frames() {
            assert!(distance(&step(frame), &step(frame + frames)) < 1e-3, "{frame}");
        }
    }
    // At the end of the timeline the character continues from where it is, also where the curve has
    // led it.
    session.tick(session.duration_secs() - 0.01);
    let (before, _, at) = shown(&session);
    session.tick(0.02);
    let (after, _, on) = shown(&session);
    assert!(session.now_secs() < 0.1);
    assert!(turned(&before, &after) < 15.0 && distance(&at, &on) < 0.05, "{at:?} {on:?}");
    // With a fixed camera it returns to the start.
    session.apply(Command::Set(vec![(Key::Follow, Value::Choice("off"))])).unwrap();
    session.tick(session.duration_secs());
    assert_eq!(session.panes()[0].place, Planar::IDENTITY);
}

#[test]
fn classic_loop_methods_leave_a_seam_and_the_exact_one_does_not() {
    let session = open("lab=loop&compare=loop_method:exact,end,both");
    let [exact, end, both] = [0, 1, 2].map(|pane| metric(&session, pane, MetricId::LoopSeam));
    assert!(exact < 1e-2 && end > 10.0 * exact && both > 10.0 * exact, "{exact} {end} {both}");
    let before = metric(&session, 0, MetricId::GapBeforeClosing);
    assert!(
        (0..3).all(|pane| metric(&session, pane, MetricId::GapBeforeClosing) == before)
            && before > end.max(both)
    );
    assert!(metric(&session, 0, MetricId::LoopVelocitySeam) < 1.0);
    let place = |pane: usize| session.panes()[pane].outcome.as_ref().unwrap().cycle.unwrap().made;
    assert_eq!(place(0), place(2));
    let (secs, frames) =
        (metric(&session, 0, MetricId::CycleTime), metric(&session, 0, MetricId::CycleFrames));
    assert!((secs * session.main_outcome().unwrap().motion.clip().fps() - frames).abs() < 1e-9);
    assert!((metric(&session, 0, MetricId::CycleLength) / secs / 1.4 - 1.0).abs() < 0.05);
    // The half-life is a parameter of loops, too.
    assert_eq!(open("lab=loop&compare=half_life:0.1,0.4").panes().len(), 2);
}

#[test]
fn ends_of_a_loop_are_found_or_set_by_hand() {
    let mut session = open("lab=loop");
    let CycleMade::Cut { from_secs, to_secs, .. } = cycle(&session).made else { panic!() };
    assert_eq!(session.automatic_value(Key::LoopFrom), Some(from_secs));
    assert_eq!(session.automatic_value(Key::LoopTo), Some(to_secs));
    let now = |session: &Session| match cycle(session).made {
        CycleMade::Cut { from_secs, to_secs, .. } => (from_secs, to_secs),
        CycleMade::Gait { .. } => panic!(),
    };
    set(&mut session, Key::LoopFrom, 0.5);
    let (from, to) = now(&session);
    assert!((from - 0.5).abs() < 0.01 && to > from + 0.5);
    set(&mut session, Key::LoopTo, 0.2);
    let (from, to) = now(&session);
    assert!(
        (from - 0.2).abs() < 0.01 && (to - 0.5).abs() < 0.01,
        "the other way round: {from} {to}"
    );
    // An impossible part is refused, and no earlier loop is shown.
    set(&mut session, Key::LoopTo, 0.5);
    assert!(
        session.panes()[0].problem.as_ref().is_some_and(|text| text.to_string().contains("cycle"))
    );
    assert!(session.main_outcome().is_none());
    session.apply(Command::Reset(Key::LoopFrom)).unwrap();
    session.apply(Command::Reset(Key::LoopTo)).unwrap();
    assert_eq!(now(&session), (from_secs, to_secs));
}

#[test]
fn clips_without_a_gait_are_refused() {
    let mut session = Session::new();
    session.apply(Command::OpenLink("lab=speed&a=idle".into())).unwrap();
    let problem = session.panes()[0].problem.clone().unwrap();
    assert!(problem.to_string().contains("does not contain a gait cycle"), "{problem}");
    session.apply(Command::OpenLink("lab=speed&a=walk&b=walk".into())).unwrap();
    let problem = session.panes()[0].problem.clone().unwrap();
    assert!(problem.to_string().contains("differ"), "{problem}");
}

#[test]
fn playhead_repeats_the_span_between_the_marks() {
    let mut session = Session::new();
    session
        .apply(Command::Set(vec![(Key::In, Value::Number(1.0)), (Key::Out, Value::Number(2.0))]))
        .unwrap();
    assert_eq!(session.span(), Span { start: 1.0, end: 2.0 });
    for _ in 0..100 {
        assert!(session.tick(0.03));
        assert!((1.0..=2.0).contains(&session.now_secs()));
    }
    session.apply(Command::Playback(PlaybackCommand::TogglePlay)).unwrap();
    let now = session.now_secs();
    assert!(!session.tick(0.5));
    assert_eq!(session.now_secs(), now);
    session.apply(Command::Playback(PlaybackCommand::Step(1))).unwrap();
    assert!((session.now_secs() - now - 1.0 / 60.0).abs() < 0.02);
}
