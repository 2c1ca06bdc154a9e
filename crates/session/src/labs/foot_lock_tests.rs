//! Tests of the foot lock in all labs, by commands.

use crate::JobKind;
use crate::fixtures::*;
use glam::Quat;
use segue_motion::clip::Clip;
use segue_motion::metrics::foot_slide_cm;
use segue_motion::transition::{FootLockOptions, foot_lock};

/// Every lab with a foot lock, with feet that slide.
const LOCKING_LABS: [&str; 9] = [
    "lab=make&gait=stop",
    "lab=view&a=stop",
    "lab=blend",
    "lab=transition",
    "lab=speed",
    "lab=loop",
    "lab=layers&mask=whole",
    "lab=register&b=walk_left",
    "lab=graph&clips=walk,walk_left,walk_right&walk_seconds=20&blend_window=20",
];

#[test]
fn foot_lock_stops_slides_and_reports_them() {
    let mut session = Session::new();
    session.apply(Command::OpenLink("lab=transition&half_life=0.3&foot_lock=on".into())).unwrap();
    settle(&mut session);
    let outcome = session.main_outcome().unwrap();
    let value = |id: MetricId| outcome.metric(id).unwrap().value.unwrap();
    let (before, after) = (value(MetricId::FootSlideBefore), value(MetricId::FootSlide));
    assert!(before > 3.0 && after < 0.1 * before, "{before} cm, {after} cm");
    session.apply(Command::Set(vec![(Key::FootLock, Value::Switch(false))])).unwrap();
    let skate = session.main_outcome().unwrap().metric(MetricId::FootSlide);
    assert_eq!(skate.unwrap().value, Some(before));
}

/// Returns all local rotations of a clip, frame by frame.
fn rotations_of(clip: &Clip) -> Vec<Quat> {
    (0..clip.frames()).flat_map(|frame| clip.rotations(frame).to_vec()).collect()
}

/// Returns those of the first pane's result.
fn rotations(session: &Session) -> Vec<Quat> {
    rotations_of(session.main_outcome().unwrap().motion.clip())
}

#[test]
fn lock_settings_change_a_locked_result_in_every_lab() {
    // A short path is locked at once, a long one in slices.
    let paths = ["lab=path&a=run", "lab=path&a=walk(make_seconds:12)"];
    for lab in LOCKING_LABS.into_iter().chain(paths) {
        let mut session = opened_without_problems(&format!("{lab}&foot_lock=on"));
        let usual = rotations(&session);
        let settings = [(Key::LockBlend, 0.6), (Key::LockReach, 1.0), (Key::LockClearance, 10.0)];
        let settings = settings.map(|(key, value)| (key, Value::Number(value)));
        session.apply(Command::Set(settings.to_vec())).unwrap();
        settle(&mut session);
        assert_ne!(rotations(&session), usual, "{lab}");
        for (key, _) in settings {
            session.apply(Command::Reset(key)).unwrap();
        }
        settle(&mut session);
        assert_eq!(rotations(&session), usual, "{lab}");
    }
}

#[test]
fn each_lock_setting_changes_a_locked_result_and_no_other() {
    let [held, free] =
        ["on", "off"].map(|lock| format!("lab=transition&half_life=0.3&foot_lock={lock}"));
    let (usual_held, usual_free) =
        (rotations(&opened_without_problems(&held)), rotations(&opened_without_problems(&free)));
    for setting in ["lock_blend=0.6", "lock_reach=3", "lock_clearance=8"] {
        assert_ne!(
            rotations(&opened_without_problems(&format!("{held}&{setting}"))),
            usual_held,
            "{setting}"
        );
        assert_eq!(
            rotations(&opened_without_problems(&format!("{free}&{setting}"))),
            usual_free,
            "{setting}"
        );
        // A setting without effect does not make the clip a changed one that can be kept.
        let mut view = opened_without_problems(&format!("lab=view&a=walk&{setting}"));
        assert!(!view.view_is_changed() && view.apply(Command::Keep(0)).is_err(), "{setting}");
        assert!(
            opened_without_problems(&format!("lab=view&a=walk&foot_lock=on&{setting}"))
                .view_is_changed()
        );
    }
}

#[test]
fn clearance_of_zero_leaves_the_swing_as_it_is() {
    let free = opened_without_problems("lab=blend");
    let motion = &free.main_outcome().unwrap().motion;
    let held = |clearance_m| {
        let options = FootLockOptions {
            ground_m: Some(motion.ground_m()),
            clearance_m,
            ..FootLockOptions::default()
        };
        rotations_of(
            &foot_lock(motion.clip(), motion.roles(), motion.contacts(), &options).unwrap(),
        )
    };
    assert_eq!(
        rotations(&opened_without_problems("lab=blend&foot_lock=on&lock_clearance=0")),
        held(None)
    );
    assert_eq!(
        rotations(&opened_without_problems("lab=blend&foot_lock=on&lock_clearance=8")),
        held(Some(0.08))
    );
    assert_ne!(held(None), held(Some(0.08)));
}

#[test]
fn lock_settings_are_restored_from_a_link() {
    let link = "lab=transition&foot_lock=on&lock_blend=0.5&lock_reach=12&lock_clearance=0";
    let session = opened_without_problems(link);
    let query = session.query();
    for setting in ["lock_blend=0.5", "lock_reach=12", "lock_clearance=0"] {
        assert!(query.split('&').any(|pair| pair == setting), "{setting} in {query}");
    }
    let again = opened_without_problems(&query);
    assert_eq!(again.query(), query);
    assert_eq!(rotations(&again), rotations(&session));
    let panes = opened_without_problems("lab=transition&foot_lock=on&compare=lock_reach:30,3");
    let of_pane =
        |pane: usize| rotations_of(panes.panes()[pane].outcome.as_ref().unwrap().motion.clip());
    assert_ne!(of_pane(0), of_pane(1));
}

#[test]
fn foot_lock_switch_applies_to_every_lab() {
    for lab in LOCKING_LABS {
        let mut session = Session::new();
        session.apply(Command::OpenLink(format!("{lab}&foot_lock=on"))).unwrap();
        settle(&mut session);
        let outcome = session.main_outcome().unwrap();
        let value = |id: MetricId| outcome.metric(id).unwrap().value.unwrap();
        let before = value(MetricId::FootSlideBefore);
        let after = value(MetricId::FootSlide);
        assert!(after <= before && after < 1.0, "{lab}: {before} cm, {after} cm");
    }
}

#[test]
fn locked_view_is_kept_under_its_recipe() {
    let mut session = Session::new();
    session.apply(Command::OpenLink("lab=view&a=stop&foot_lock=on".into())).unwrap();
    let held = session.main_outcome().unwrap().motion.clip().clone();
    session.apply(Command::Keep(0)).unwrap();
    session
        .apply(Command::OpenLink(
            "lab=blend&a=view(a:stop,foot_lock:on)&b=walk(foot_lock:on)".into(),
        ))
        .unwrap();
    settle(&mut session);
    let mut other = Session::new();
    other.apply(Command::OpenLink(session.query())).unwrap();
    settle(&mut other);
    for session in [&session, &other] {
        let of_slot = |slot| session.slot(slot).unwrap().motion.as_ref().unwrap();
        assert_eq!(*of_slot(Slot::A).clip(), held);
        assert_eq!(of_slot(Slot::B).clip().name(), "walk(foot_lock:on)");
    }
}

#[test]
fn long_clip_is_locked_in_slices_while_the_free_one_stays() {
    let mut session = Session::new();
    let long = "walk(make_seconds:25)";
    session.apply(Command::OpenLink(format!("lab=view&a={long}"))).unwrap();
    let free = session.main_outcome().unwrap().clone();
    assert!(
        free.motion.clip().frames() > 1_000
            && free.metrics.iter().all(|metric| metric.value.is_none())
    );
    session.apply(Command::Set(vec![(Key::FootLock, Value::Switch(true))])).unwrap();
    assert!(Arc::ptr_eq(session.main_outcome().unwrap(), &free));
    let mut last = 0.0;
    while let Some(job) = session.jobs().into_iter().find(|job| job.kind == JobKind::HoldingFeet) {
        assert!(job.progress >= last);
        last = job.progress;
        session.work();
    }
    assert!(last > 0.9, "{last}");
    settle(&mut session);
    let held = session.main_outcome().unwrap();
    let motion = &free.motion;
    let whole =
        foot_lock(motion.clip(), motion.roles(), motion.contacts(), &FootLockOptions::default())
            .unwrap();
    assert_eq!(**held.motion.clip(), whole);
    let before = held.metric(MetricId::FootSlideBefore);
    assert_eq!(
        before.unwrap().value,
        foot_slide_cm(motion.clip(), motion.roles(), motion.contacts())
    );
}
