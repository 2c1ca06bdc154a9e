//! Tests of the Path lab, by commands.

use crate::JobKind;
use crate::List;
use crate::fixtures::*;
use crate::{ExtraCharacterCommand, PathFacts};
use glam::DVec2;
use segue_motion::path::{GroundSpline, PathEdit, Pins};

fn path(session: &Session) -> &PathFacts {
    assert_eq!(session.panes()[0].problem, None);
    session.main_outcome().unwrap().path().map(|fact| &**fact).unwrap()
}

fn metric(session: &Session, id: MetricId) -> f64 {
    let outcome = session.main_outcome().unwrap();
    outcome.metric(id).unwrap().value.unwrap()
}

/// Returns the present path with one point moved.
fn moved(session: &Session, index: usize, by: DVec2) -> Value {
    let spline = path(session).curve.spline();
    let to = spline.points()[index] + by;
    List::EditedPath(spline.edited(&PathEdit::Move { index, to }, Pins::default()).ok()).into()
}

/// Returns the edited path as the link contains it.
fn code(session: &Session) -> String {
    session.params().edited_path().unwrap().to_code()
}

fn set(session: &mut Session, key: Key, value: Value) {
    session.apply(Command::Set(vec![(key, value)])).unwrap();
}

#[test]
fn path_without_edits_gives_the_clip() {
    for keep in ["speed", "duration", "whole"] {
        let session = opened(&format!("lab=path&a=walk_left&keep={keep}"));
        let made = &session.main_outcome().unwrap().motion;
        let original = path(&session).fitted.motion();
        assert_eq!(made.clip().frames(), original.clip().frames());
        for frame in 0..made.clip().frames() {
            let apart = made.clip().root_translations()[frame]
                .distance(original.clip().root_translations()[frame]);
            assert!(apart < 1e-4, "{keep}, frame {frame}: {apart} m");
            let stands =
                made.ground_frames()[frame].shift.distance(original.ground_frames()[frame].shift);
            assert!(stands < 1e-4, "{keep}, frame {frame}: {stands} m");
        }
        assert!(
            (metric(&session, MetricId::FootSlide) - metric(&session, MetricId::FootSlideOriginal))
                .abs()
                < 0.05
        );
    }
}

#[test]
fn point_that_is_dragged_moves_the_character_in_one_step() {
    let mut session = opened("lab=path&a=walk");
    let before = session.query();
    let fitted = Arc::clone(&path(&session).fitted);
    for step in 1..=5 {
        let value = {
            let spline = fitted.curve().spline();
            let to = spline.points()[4] + DVec2::new(0.2 * f64::from(step), 0.0);
            let edited = spline.edited(&PathEdit::Move { index: 4, to }, Pins::default());
            List::EditedPath(edited.ok()).into()
        };
        set(&mut session, Key::Path, value);
        assert!(Arc::ptr_eq(&path(&session).fitted, &fitted), "the fit stays while a point moves");
    }
    session.apply(Command::Settle).unwrap();
    let middle = |session: &Session| {
        let frames = session.main_outcome().unwrap().motion.ground_frames();
        frames[frames.len() / 2].shift.x
    };
    assert!(middle(&session) > 0.3, "{}", middle(&session));
    assert!(path(&session).is_edited);
    // The link alone restores it.
    let other = opened(&session.query());
    let clip = |session: &Session| Arc::clone(session.main_outcome().unwrap().motion.clip());
    assert_eq!(clip(&other).root_translations(), clip(&session).root_translations());
    session.apply(Command::Undo).unwrap();
    assert_eq!(session.query(), before);
    assert!(middle(&session).abs() < 0.1);
    session.apply(Command::Redo).unwrap();
    assert!(middle(&session) > 0.3);
}

#[test]
fn ground_frames_on_a_path_equal_the_measured_ones() {
    for link in ["keep=speed", "keep=duration", "keep=whole", "path_facing=world", "foot_lock=on"] {
        let mut session = opened(&format!("lab=path&a=walk_left&{link}"));
        let value = moved(&session, 3, DVec2::new(0.4, -0.3));
        set(&mut session, Key::Path, value);
        let made = &session.main_outcome().unwrap().motion;
        let measured = segue_motion::clip::character_frames(made.clip(), made.roles());
        for (frame, (told, measured)) in made.ground_frames().iter().zip(&measured).enumerate() {
            let apart = told.shift.distance(measured.shift);
            let turned = segue_motion::math::wrap_angle(told.yaw - measured.yaw).abs();
            // Locked feet move the hips a little.
            let tolerance = if link == "foot_lock=on" { 0.05 } else { 0.003 };
            assert!(
                apart < tolerance && turned < 0.02,
                "{link}, frame {frame}: {apart} m, {turned} rad"
            );
        }
    }
}

#[test]
fn invalid_path_is_refused_and_nothing_is_lost() {
    let session = opened("lab=path&a=idle");
    assert!(
        session.panes()[0].problem.as_ref().unwrap().to_string().contains("stays within"),
        "{:?}",
        session.panes()[0].problem
    );
    // All points in one place: no direction.
    let code = GroundSpline::uniform(vec![DVec2::ONE; 6]).unwrap().to_code();
    let mut session = opened(&format!("lab=path&a=walk&path={code}"));
    assert!(session.panes()[0].problem.as_ref().unwrap().to_string().contains("no direction"));
    session.apply(Command::Reset(Key::Path)).unwrap();
    assert!(!path(&session).is_edited);
    // A closed path that crosses itself is valid.
    let eight =
        [(0.0, 0.0), (2.0, 1.0), (2.0, -1.0), (-2.0, 1.0), (-2.0, -1.0), (-1.0, 0.5), (0.0, 0.0)];
    let eight = GroundSpline::uniform(eight.map(DVec2::from).to_vec()).unwrap();
    let closed = eight.edited(&PathEdit::Close, Pins::default()).unwrap();
    set(&mut session, Key::Path, List::EditedPath(Some(closed)).into());
    assert!(path(&session).curve.spline().is_closed());
    assert!(metric(&session, MetricId::PathLength) > 5.0);
}

#[test]
fn more_control_points_fit_better() {
    let session = opened("lab=path&a=walk_left&compare=control_points:4,8,16");
    let errors: Vec<f64> = session
        .panes()
        .iter()
        .map(|pane| pane.outcome.as_ref().unwrap().path().unwrap().fitted.error().rms_cm)
        .collect();
    assert!(errors[0] > errors[1] && errors[1] > errors[2], "{errors:?}");
}

#[test]
fn hairpin_is_reported_with_place_and_time() {
    let mut session = opened("lab=path&a=walk&keep=duration");
    assert!(path(&session).hard_turns.is_empty());
    let value = moved(&session, 4, DVec2::new(0.2, -2.5));
    set(&mut session, Key::Path, value);
    assert!(!path(&session).hard_turns.is_empty());
    assert!(metric(&session, MetricId::HardTurns) >= 1.0);
    assert!(path(&session).hard_turns[0].turn_dps > path(&session).hard_turns[0].limit_dps);
}

#[test]
fn extra_characters_on_their_own_paths_play_from_a_link() {
    let mut session = opened("lab=path&a=walk&play=off");
    let alone = session.query();
    let value = moved(&session, 4, DVec2::new(1.0, 0.0));
    set(&mut session, Key::Path, value);
    session.apply(Command::Settle).unwrap();
    let first = code(&session);
    session.apply(Command::ExtraCharacters(ExtraCharacterCommand::AddResult(0))).unwrap();
    let id = format!("path(a:walk,path:{first})");
    assert_eq!(session.extra_characters()[0].id, id);
    assert!(session.library().find(&id).is_some(), "kept, too");
    session.apply(Command::ExtraCharacters(ExtraCharacterCommand::Add("run".into()))).unwrap();
    let value = moved(&session, 2, DVec2::new(-0.8, 0.0));
    set(&mut session, Key::Path, value);
    session.apply(Command::Settle).unwrap();

    let other = opened(&session.query());
    let names = |session: &Session| {
        session.extra_characters().iter().map(|one| one.id.clone()).collect::<Vec<_>>()
    };
    assert_eq!(names(&other), [id.clone(), "run".to_owned()]);
    for (one, two) in session.extra_characters().iter().zip(other.extra_characters()) {
        let [one, two] =
            [one, two].map(|companion| Arc::clone(companion.motion.as_ref().unwrap().clip()));
        assert_eq!(one.root_translations(), two.root_translations());
    }
    assert!(other.duration_secs() >= other.extra_characters()[1].duration_secs().unwrap());

    // The first one is edited again, and the present one takes its place in the list.
    let second = code(&session);
    session.apply(Command::ExtraCharacters(ExtraCharacterCommand::Edit(0))).unwrap();
    assert_eq!(code(&session), first);
    assert_eq!(names(&session), [format!("path(a:walk,path:{second})"), "run".to_owned()]);
    session.apply(Command::ExtraCharacters(ExtraCharacterCommand::Remove(1))).unwrap();
    assert_eq!(session.extra_characters().len(), 1);
    // A clip that is removed from the library leaves the stage, and returns with undo.
    session.apply(Command::Remove(names(&session)[0].clone())).unwrap();
    assert!(session.extra_characters().is_empty());
    session.apply(Command::Undo).unwrap();
    assert_eq!(session.extra_characters().len(), 1);
    for _ in 0..6 {
        session.apply(Command::Undo).unwrap();
    }
    assert_eq!(session.query(), alone);
    // In other labs there are no extra characters.
    let elsewhere = opened(&format!("lab=view&others={id}"));
    assert!(elsewhere.extra_characters().is_empty());
}

#[test]
fn missing_extra_character_is_named() {
    let session = opened("lab=path&a=walk&others=somebody~0123456789ab,walk");
    assert!(
        session.extra_characters()[0].motion.as_ref().unwrap_err().to_string().contains("somebody")
    );
    assert!(session.extra_characters()[1].motion.is_ok());
}

#[test]
fn kept_path_is_a_clip_for_every_other_lab() {
    let mut session = opened("lab=path&a=run&foot_lock=on&keep=whole");
    let value = moved(&session, 3, DVec2::new(0.5, 0.0));
    set(&mut session, Key::Path, value);
    session.apply(Command::Keep(0)).unwrap();
    let word = code(&session);
    let id = format!("path(a:run,foot_lock:on,keep:whole,path:{word})");
    assert!(session.library().find(&id).is_some(), "{:?}", session.library().entries().last());
    let other = opened(&format!("lab=path&a={id}&control_points=6"));
    assert_eq!(
        path(&other).fitted.motion().clip().root_translations(),
        session.main_outcome().unwrap().motion.clip().root_translations()
    );
}

#[test]
fn feet_of_a_short_clip_are_locked_on_its_own_ground() {
    let session = opened("lab=path&a=run&foot_lock=on&ground=4");
    let free = opened("lab=path&a=run&ground=4");
    let carried = &free.main_outcome().unwrap().motion;
    let options =
        segue_motion::transition::FootLockOptions { ground_m: Some(0.04), ..Default::default() };
    let locked = segue_motion::transition::foot_lock(
        carried.clip(),
        carried.roles(),
        carried.contacts(),
        &options,
    )
    .unwrap();
    let clip = session.main_outcome().unwrap().motion.clip();
    assert!((0..clip.frames()).all(|frame| clip.rotations(frame) == locked.rotations(frame)));
    assert!(!path(&session).awaits_feet);
}

/// A walk with more frames than are locked during dragging.
const LONG: &str = "walk(make_seconds:12)";

#[test]
fn feet_of_a_long_walk_are_locked_when_dragging_ends() {
    let mut session = Session::new();
    let open = |session: &mut Session, query: &str| {
        session.apply(Command::OpenLink(query.to_owned())).unwrap();
    };
    open(&mut session, &format!("lab=path&a={LONG}&foot_lock=on"));
    assert!(path(&session).awaits_feet);
    assert!(session.jobs().iter().any(|job| job.kind == JobKind::HoldingFeet));
    let value = moved(&session, 3, DVec2::new(0.8, 0.0));
    set(&mut session, Key::Path, value);
    assert!(path(&session).awaits_feet, "at once, without");
    let free = metric(&session, MetricId::FootSlide);
    while session.work() {}
    assert!(!path(&session).awaits_feet);
    assert!((metric(&session, MetricId::FootSlideBefore) - free).abs() < 1e-9);
    assert!(
        metric(&session, MetricId::FootSlide) < 0.5 * free,
        "{} of {free}",
        metric(&session, MetricId::FootSlide)
    );
    assert!(session.jobs().is_empty());
    // The result is the same as when it is locked at once.
    let known = path(&session).fitted.motion();
    let roles = known.roles();
    let now = Arc::clone(session.main_outcome().unwrap());
    let mut free = Session::new();
    open(&mut free, &session.query().replace("foot_lock=on&", ""));
    let carried = &free.main_outcome().unwrap().motion;
    let frames = carried.ground_frames().iter().zip(known.ground_frames());
    let turns: Vec<f64> = frames.map(|(new, old)| new.yaw - old.yaw).collect();
    let options = segue_motion::transition::FootLockOptions::default();
    let locking = segue_motion::transition::FootLocking::new(
        Arc::clone(carried.clip()),
        roles,
        carried.contacts(),
        &options,
    )
    .unwrap();
    let locked = locking.with_body_yaws(&turns).finish().unwrap();
    let apart = locked.rotations(300).iter().zip(now.motion.clip().rotations(300));
    assert!(apart.map(|(a, b)| a.angle_between(*b)).all(|angle| angle < 1e-3));

    // If it is kept before that, the finished result is kept.
    let value = moved(&session, 3, DVec2::new(0.8, 0.3));
    set(&mut session, Key::Path, value);
    session.apply(Command::ExtraCharacters(ExtraCharacterCommand::AddResult(0))).unwrap();
    assert!(session.extra_characters()[0].motion.is_err());
    while session.work() {}
    let kept = session.extra_characters()[0].motion.as_ref().unwrap();
    assert_eq!(
        kept.clip().rotations(300),
        session.main_outcome().unwrap().motion.clip().rotations(300)
    );
}

#[test]
fn path_of_a_long_clip_is_fitted_between_frames() {
    let mut session = Session::new();
    let link = "lab=path&a=walk(make_seconds:30)".to_owned();
    session.apply(Command::OpenLink(link)).unwrap();
    assert!(session.main_outcome().is_none_or(|outcome| outcome.path().is_none()));
    assert!(session.jobs().iter().any(|job| job.kind == JobKind::Analyzing));
    while session.work() {}
    assert!(session.jobs().is_empty());
    let fitted = Arc::clone(&path(&session).fitted);
    // The fit stays while points move, and another number of them shows at once.
    let value = moved(&session, 3, DVec2::new(0.3, 0.0));
    set(&mut session, Key::Path, value);
    assert!(Arc::ptr_eq(&path(&session).fitted, &fitted) && path(&session).is_edited);
    set(&mut session, Key::ControlPoints, Value::Number(6.0));
    assert!(session.jobs().iter().all(|job| job.kind != JobKind::Analyzing));
    assert!(!Arc::ptr_eq(&path(&session).fitted, &fitted));
}
