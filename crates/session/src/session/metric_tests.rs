//! Tests of the metrics of every lab.

use crate::NumberTable;
use crate::fixtures::*;
use crate::jobs::JobBoard;
use crate::labs::sliced::Sliced as _;
use crate::labs::{ArtefactMeter, MeasuredMotion};
use crate::metrics::{Better, METRICS, Metric, of_result};
use crate::params::{Kind, List};
use glam::{DVec2, Quat};
use segue_motion::clip::Clip;
use segue_motion::metrics::ResultMetrics;
use segue_motion::path::{PathEdit, Pins};
use std::collections::BTreeSet;
use std::f32::consts::PI;

/// A clean result of every lab.
const LABS: [&str; 16] = [
    "lab=view",
    "lab=make",
    "lab=blend",
    "lab=transition",
    "lab=speed",
    "lab=loop",
    "lab=layers",
    "lab=register",
    "lab=path&a=walk_left",
    "lab=graph&clips=walk,walk_left,walk_right&walk_seconds=20",
    "lab=match&scenario=straight&mirrored=off&match_clips=idle,walk,walk_left,walk_right",
    "lab=match&mirrored=off&match_clips=idle,walk,walk_left,walk_right",
    "lab=clean",
    "lab=in_place",
    "lab=in_place&root_way=put_back",
    "lab=edit&edit_from=0.5&as_loop=on&mirror=on",
];

/// The names of the metrics that results of every lab have.
const METRICS_OF_ALL: [&str; 4] =
    ["pose_jump_deg", "velocity_jump_dps", "spin_deg", "skating_cmps"];

/// Returns the metrics of every lab in the first pane.
fn common(session: &Session) -> Vec<Metric> {
    session.panes()[0].result().unwrap().outcome.metrics.iter().take(4).copied().collect()
}

#[test]
fn metrics_of_every_lab_come_first_and_are_clean_for_clean_results() {
    let labs: BTreeSet<&str> =
        LABS.iter().map(|link| link[4..].split('&').next().unwrap()).collect();
    let Kind::Choice(all) = Key::Lab.param().kind else { panic!() };
    assert_eq!(labs, all.iter().map(|choice| choice.key).collect());
    let expected = of_result(&ResultMetrics::default(), 60.0);
    assert_eq!(expected.map(|metric| metric.id.name()), METRICS_OF_ALL);
    assert!(expected.iter().all(|metric| metric.id.row().better == Better::Lower));
    let mut seen = BTreeSet::new();
    for link in LABS {
        let mut session = opened_without_problems(link);
        if session.is_driven() {
            session
                .apply(Command::Drive(DriveCommand::Steer(segue_motion::matching::Control::new(
                    glam::DVec2::new(0.0, 1.2),
                    None,
                ))))
                .unwrap();
            for _ in 0..90 {
                session.tick(1.0 / 60.0);
            }
        }
        let found = common(&session);
        for (found, expected) in found.iter().zip(expected) {
            assert_eq!(Metric::new(found.id, None), expected, "{link}");
        }
        // Every time of a metric lies within the result.
        let outcome = session.main_outcome().unwrap();
        for Metric { id, at_secs, .. } in &outcome.metrics {
            let is_inside = |secs: f64| (0.0..=outcome.duration_secs() + 1e-9).contains(&secs);
            assert!(at_secs.is_none_or(is_inside), "{link}: {id:?} at {at_secs:?}");
        }
        let values: Vec<f64> = found.iter().map(|metric| metric.value.unwrap()).collect();
        let [jump, _, spin, skating] = values[..] else { panic!("{values:?}") };
        assert!(jump < 6.0 && spin < 4.0 && skating < 15.0, "{link}: {values:?}");
        // Foot slide has one name and one measure in every lab, and each metric is listed once.
        let metrics = &session.main_outcome().unwrap().metrics;
        let ids: BTreeSet<MetricId> = metrics.iter().map(|metric| metric.id).collect();
        assert_eq!(ids.len(), metrics.len(), "{link}");
        let slides = metrics.iter().filter(|metric| metric.id.row().label == "Foot slide");
        assert_eq!(
            slides.map(|metric| metric.id).collect::<Vec<_>>(),
            [MetricId::FootSlide],
            "{link}"
        );
        seen.extend(ids);
        seen.extend(NumberTable::of(&session).rows.iter().map(|row| row.metric));
    }
    let locked = opened_without_problems("lab=make&foot_lock=on");
    let mut edited = opened_without_problems("lab=path&a=walk_left");
    let spline = edited.main_outcome().unwrap().path().unwrap().fitted.curve().spline().clone();
    let step = PathEdit::Move { index: 1, to: spline.points()[1] + DVec2::X };
    let path = List::EditedPath(spline.edited(&step, Pins::default()).ok());
    edited.apply(Command::Set(vec![(Key::Path, path.into())])).unwrap();
    settle(&mut edited);
    for session in [locked, edited] {
        seen.extend(session.main_outcome().unwrap().metrics.iter().map(|metric| metric.id));
    }
    let unused: Vec<&str> =
        METRICS.iter().filter(|row| !seen.contains(&row.id)).map(|row| row.name).collect();
    assert!(unused.is_empty(), "no lab has {unused:?}");
}

/// Returns a result with changed frames.
fn spoiled(outcome: &Outcome, change: impl Fn(usize, &mut [Quat])) -> Outcome {
    let clip = outcome.motion.clip();
    let mut rotations = Vec::new();
    for frame in 0..clip.frames() {
        let mut pose = clip.rotations(frame).to_vec();
        change(frame, &mut pose);
        rotations.extend(pose);
    }
    let roots = clip.root_translations().to_vec();
    let clip =
        Clip::new("spoiled", Arc::clone(clip.skeleton()), clip.fps(), rotations, roots).unwrap();
    Outcome {
        motion: Arc::new(outcome.motion.with_clip(clip, outcome.motion.ground_frames().to_vec())),
        measured: MeasuredMotion::Motion,
        ..outcome.clone()
    }
}

fn measured(outcome: &Outcome) -> ResultMetrics {
    let mut meter = ArtefactMeter::default();
    loop {
        meter.clear_requests();
        if let Some(found) = meter.numbers(outcome) {
            return found;
        }
        while meter.work(&mut JobBoard::default()) {}
        assert!(meter.is_ready());
    }
}

#[test]
fn fault_in_the_result_of_any_lab_is_measured() {
    for link in LABS {
        let session = opened_without_problems(link);
        let outcome = session.main_outcome().unwrap();
        let clip = outcome.motion.clip();
        if clip.frames() < 60 {
            assert!(session.is_driven(), "{link}");
            continue;
        }
        let half = clip.frames() / 2;
        let joint = clip.skeleton().len() / 2;
        let flash = measured(&spoiled(outcome, |frame, pose| {
            if frame == half {
                pose[joint] *= Quat::from_rotation_x(1.0);
            }
        }));
        assert!(flash.pose_jump_deg.unwrap() > 30.0, "{link}: {flash:?}");
        let at = flash.pose_jump_at.unwrap();
        assert!(
            at.joint == joint && (at.frame == half || at.frame + 1 == half),
            "{link}: {flash:?}"
        );
        assert!(flash.velocity_jump_dps.unwrap() > 900.0, "{link}: {flash:?}");
        // The time that is shown is that of the frame: the next one, where the joint turns back.
        let mut shown = outcome.as_ref().clone();
        shown.take_numbers(Some(flash));
        let at_secs = shown.metric(MetricId::PoseJump).unwrap().at_secs.unwrap();
        let frame = (at_secs * clip.fps()).round() as usize;
        assert!((half..=half + 1).contains(&frame), "{link}: {frame}, not {half}");
        let at_secs = shown.metric(MetricId::VelocityJump).unwrap().at_secs.unwrap();
        assert!(((at_secs * clip.fps()) - half as f64).abs() < 4.0, "{link}: {at_secs}");
        assert_eq!(shown.metric(MetricId::Skating).unwrap().at_secs, None, "it is a mean");
        let turn = 0.2 * clip.fps();
        let spin = measured(&spoiled(outcome, |frame, pose| {
            let share = ((frame as f64 - half as f64) / turn).clamp(0.0, 1.0);
            pose[0] = Quat::from_rotation_y(share as f32 * PI) * pose[0];
        }));
        assert!(spin.spin_deg.unwrap() > 120.0, "{link}: {spin:?}");
        assert!(spin.spin_at.unwrap().abs_diff(half) < 10, "{link}: {spin:?}");
    }
}

#[test]
fn long_results_are_shown_at_once_and_measured_in_slices() {
    let mut session = opened_without_problems(
        "lab=blend&a=walk(make_seconds:25)&b=walk(make_seconds:25)&leave_a=20&enter_b=1",
    );
    let shorter = Command::Set(vec![(Key::BlendWindow, Value::Number(20.0))]);
    session.apply(shorter).unwrap();
    let outcome = Arc::clone(session.main_outcome().unwrap());
    assert!(outcome.motion.clip().frames() > 2_000);
    assert_eq!(outcome.metrics[0], of_result(&ResultMetrics::default(), 60.0)[0]);
    assert!(session.panes()[0].result().is_err() && session.jobs().is_empty());
    let mut slices = 0;
    while session.panes()[0].result().is_err() {
        assert!(session.work());
        slices += 1;
    }
    assert!(slices > 5, "{slices}");
    assert!(common(&session).iter().all(|metric| metric.value.is_some()));
    assert!(
        Arc::ptr_eq(&session.main_outcome().unwrap().motion, &outcome.motion),
        "the same motion"
    );
    // A kept result needs no numbers.
    session.apply(Command::Keep(0)).unwrap();
    let id = session.library().entries().last().unwrap().id.clone();
    let mut other = Session::new();
    other.apply(Command::OpenLink(format!("lab=view&a={id}"))).unwrap();
    assert_eq!(
        other.main_outcome().unwrap().motion.clip().frames(),
        outcome.motion.clip().frames()
    );
}

#[test]
fn metrics_of_a_clip_are_those_of_the_view_lab() {
    // The second one is long enough to be measured in slices.
    for a in ["walk_left", "walk(make_seconds:30)", "run"] {
        let session = opened_without_problems(&format!("lab=view&a={a}"));
        let motion = session.library().find(a).and_then(|entry| entry.motion.clone()).unwrap();
        assert_eq!(motion.clip().frames() > 1_200, a.contains("30"), "{a}");
        let shown = &session.panes()[0].result().unwrap().outcome.metrics;
        assert_eq!(&crate::metrics_of_clip(&motion), shown, "{a}");
        assert!(shown.len() > 5, "{shown:?}");
    }
}
