//! Tests of clips on other bodies: at once and in slices, their weights, and the Edit lab's body.

use crate::fixtures::*;
use crate::labs::{JobKind, RetargetReport};
use segue_formats::bvh;
use segue_motion::clip::{Clip, Interpolation};
use segue_motion::retarget::{RetargetOptions, TargetBody, retarget_motion};
use segue_motion::skeleton::{Joint, Role, Roles, Side, Skeleton};
use segue_motion::synth::{Action, Params, synthesize};

/// Returns a walk of a body with its thighs or shins shortened.
fn walk(duration_secs: f32, fps: f32, short: fn(Side) -> Role) -> Clip {
    let params = Params { duration_secs, fps, ..Params::new(Action::Walk) };
    let made = synthesize(&params).unwrap().clip;
    let skeleton = made.skeleton();
    let roles = Roles::detect(skeleton);
    let ends = Side::BOTH.map(|side| roles.get(short(side)));
    let joints = skeleton.joints().iter().enumerate().map(|(index, joint)| {
        let factor = if ends.contains(&Some(index)) { 0.85 } else { 1.0 };
        Joint { offset: joint.offset * factor, ..joint.clone() }
    });
    let shorter = Arc::new(Skeleton::new(joints.collect()).unwrap());
    let body = TargetBody::at_rest(&shorter, &roles);
    retarget_motion(&Motion::analyze(made), &body, &RetargetOptions::default()).unwrap().clip
}

/// Returns a session with two walks, A's body with short thighs and B's with short shins, and
/// their ids.
fn two_bodies(secs: [f32; 2], fps: [f32; 2]) -> (Session, [String; 2]) {
    let mut session = Session::new();
    let clips = [walk(secs[0], fps[0], Role::shin), walk(secs[1], fps[1], Role::foot)];
    let ids = ["a.bvh", "b.bvh"].into_iter().zip(clips).map(|(name, clip)| {
        let bytes = bvh::write(&clip, &bvh::WriteOptions::default()).into_bytes();
        session.load(name, bytes.into()).unwrap().ids.remove(0)
    });
    let ids: Vec<String> = ids.collect();
    (session, ids.try_into().unwrap())
}

fn open(session: &mut Session, link: &str) {
    session.apply(Command::OpenLink(format!("{link}&play=off"))).unwrap();
}

fn made(session: &Session) -> Arc<Outcome> {
    Arc::clone(session.panes()[0].result().expect("a result").outcome)
}

fn report(session: &Session) -> Arc<RetargetReport> {
    made(session).retargeted.clone().expect("a report")
}

fn clip_of(session: &Session, id: &str) -> Arc<Motion> {
    session.library().find(id).unwrap().motion.clone().unwrap()
}

#[test]
fn long_clip_of_another_body_is_retargeted_in_slices() {
    let (mut session, [a, b]) = two_bodies([3.0, 20.0], [60.0, 30.0]);
    open(&mut session, &format!("lab=layers&a={a}&b={b}"));
    assert!(session.panes()[0].outcome.is_none(), "it takes longer than a frame");
    let (mut slices, mut before) = (0, 0.0);
    while let Some(job) = session.jobs().into_iter().find(|job| job.kind == JobKind::Retargeting) {
        assert!((before..1.0).contains(&job.progress), "{before} {}", job.progress);
        before = job.progress;
        session.work();
        slices += 1;
    }
    assert!(slices > 10, "{slices}");
    settle(&mut session);
    let errors = report(&session).errors.unwrap();
    assert!(errors.skating.result.stances > 20 && errors.skating.result.worst_cm < 0.1);
    // The same bits as at once, at the rate of A.
    let [a, b] = [&a, &b].map(|id| clip_of(&session, id));
    let resampled = b.resampled(60.0, Interpolation::Cubic).unwrap().with_ground_m(b.ground_m());
    let whole =
        retarget_motion(&resampled, &TargetBody::of(&a), &RetargetOptions::default()).unwrap();
    assert_eq!(whole.report, errors);
}

#[test]
fn retargeted_clip_is_kept_while_other_parameters_change() {
    let (mut session, [a, b]) = two_bodies([3.0, 3.0], [60.0, 60.0]);
    open(&mut session, &format!("lab=blend&a={a}&b={b}"));
    settle(&mut session);
    let first = report(&session);
    session.apply(Command::Set(vec![(Key::BlendWindow, Value::Number(12.0))])).unwrap();
    settle(&mut session);
    assert!(Arc::ptr_eq(&first, &report(&session)), "nothing of it depends on the window");
    // Its weights do change it.
    let mut worst_cm = Vec::new();
    for weight in [1.0, 0.5, 0.0] {
        let values =
            [Key::RetargetFeet, Key::RetargetHands].map(|key| (key, Value::Number(weight)));
        session.apply(Command::Set(values.into())).unwrap();
        settle(&mut session);
        let report = report(&session);
        assert_eq!(report.options, RetargetOptions::weights(weight as f32, weight as f32));
        worst_cm.push(report.errors.unwrap().feet[0].unwrap().result.mean_cm);
    }
    assert!(worst_cm[0] < 0.01 && worst_cm[0] < worst_cm[1] && worst_cm[1] < worst_cm[2]);
    let directions = report(&session).errors.unwrap();
    assert_eq!(directions.feet[0].unwrap().result, directions.feet[0].unwrap().directions);
    // The right foot may have a weight of its own.
    let right = vec![(Key::RetargetRightFoot, Value::Number(1.0))];
    session.apply(Command::Set(right)).unwrap();
    settle(&mut session);
    assert_eq!(report(&session).options, RetargetOptions { feet: [0.0, 1.0], hands: [0.0; 2] });
    let feet = report(&session).errors.unwrap().feet.map(|foot| foot.unwrap().result.mean_cm);
    assert!(feet[1] < 0.01 && feet[0] > 10.0 * feet[1], "{feet:?}");
    assert!(session.query().contains("&retarget_right_foot=1"), "{}", session.query());
    session.apply(Command::Reset(Key::RetargetRightFoot)).unwrap();
    settle(&mut session);
    // A link has them.
    assert!(session.query().contains("retarget_feet=0&retarget_hands=0"), "{}", session.query());
}

#[test]
fn edit_body_puts_a_clip_on_another_body() {
    let (mut session, [a, b]) = two_bodies([3.0, 3.0], [60.0, 30.0]);
    open(&mut session, &format!("lab=edit&a={b}&edit_body={a}&edit_to=2"));
    settle(&mut session);
    let outcome = made(&session);
    let (body, own) = (clip_of(&session, &a), clip_of(&session, &b));
    assert_eq!(outcome.motion.clip().skeleton(), body.clip().skeleton());
    assert_eq!(outcome.motion.clip().fps(), 30.0, "it keeps its own rate");
    assert_eq!(outcome.motion.clip().frames(), 61, "and is trimmed");
    let plain = retarget_motion(&own, &TargetBody::of(&body), &RetargetOptions::default()).unwrap();
    assert_eq!(**outcome.motion.clip(), plain.clip.crop(0..61).unwrap());
    assert!(report(&session).errors.unwrap().feet[0].is_some());
    // Kept, it is made again from its recipe, and taken apart into its parameters.
    session.apply(Command::Keep(0)).unwrap();
    settle(&mut session);
    let kept = session.library().entries().last().unwrap().clone();
    assert!(kept.id.contains(&format!("edit_body:{a}")), "{}", kept.id);
    assert_eq!(kept.motion.as_ref().unwrap().clip(), outcome.motion.clip());
    // Weights without a body change nothing.
    open(&mut session, &format!("lab=edit&a={a}&retarget_feet=0.5"));
    settle(&mut session);
    assert_eq!(made(&session).motion.clip(), body.clip());
    assert!(session.apply(Command::Keep(0)).is_err(), "it is a clip as it is");
}
