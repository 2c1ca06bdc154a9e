//! Tests of the Layers lab, by commands.

use crate::fixtures::*;
use segue_motion::metrics::foot_slide_cm;

#[test]
fn layers_lab_opens_with_a_run_on_walking_legs() {
    let session = opened_without_problems("lab=layers");
    let outcome = session.main_outcome().unwrap();
    let layer = outcome.layer().unwrap();
    assert_eq!((layer.fit, layer.has_no_steps), (crate::LayerFit::InStep, false));
    assert!(layer.shares[0] == 0.0 && layer.shares.contains(&1.0));
    let walk = session.slot(Slot::A).unwrap().motion.clone().unwrap();
    // The legs are the walk's, bit for bit, with the same contacts.
    assert_eq!(outcome.motion.clip().root_translations(), walk.clip().root_translations());
    assert_eq!(outcome.motion.contacts(), walk.contacts());
    let slide = foot_slide_cm(walk.clip(), walk.roles(), walk.contacts());
    assert_eq!(
        (number_of(outcome, MetricId::FootSlide), number_of(outcome, MetricId::LegsOffA)),
        (slide.unwrap(), 0.0)
    );
    let jump = number_of(outcome, MetricId::VelocityJump);
    assert!(jump < 60.0, "{jump}");
    assert!(number_of(outcome, MetricId::ArmsOffA) > 10.0);
    // B's track and A's have the length of A.
    assert!(
        outcome.sources.iter().all(|source| source.motion.clip().frames() == walk.clip().frames())
    );
}

#[test]
fn arms_of_a_run_in_step_swing_with_the_legs() {
    // The forearm has the same rotation at each strike of the left foot.
    let session = opened_without_problems("lab=layers&mask=arms&keep_orientation=off");
    let outcome = session.main_outcome().unwrap();
    let hand = outcome.motion.roles().get(segue_motion::skeleton::Role::LeftForearm).unwrap();
    let strikes = outcome.motion.contacts().intervals(segue_motion::skeleton::Side::Left);
    let at: Vec<_> = strikes
        .iter()
        .skip(1)
        .map(|stance| outcome.motion.clip().rotations(stance.start)[hand])
        .collect();
    assert!(at.len() >= 2);
    for pair in at.windows(2) {
        assert!(segue_motion::math::quat::angle_between(pair[0], pair[1]) < 0.02, "{at:?}");
    }
}

#[test]
fn layers_update_at_once_and_report_how_their_time_fits() {
    use crate::LayerFit;
    for (link, fit, has_no_steps) in [
        ("lab=layers&b=run(make_seconds:2)&layer_fit=loop", LayerFit::Looped, false),
        ("lab=layers&layer_fit=hold", LayerFit::Held, false),
        ("lab=layers&a=run(make_seconds:2)&b=walk&layer_fit=loop", LayerFit::Once, false),
        ("lab=layers&b=idle(make_seconds:2)", LayerFit::Looped, true),
        ("lab=layers&a=idle(make_seconds:2)&b=walk", LayerFit::Once, true),
    ] {
        let session = opened_without_problems(link);
        let layer = session.main_outcome().unwrap().layer().cloned().unwrap();
        assert_eq!((layer.fit, layer.has_no_steps), (fit, has_no_steps), "{link}");
        assert!(
            number_of(session.main_outcome().unwrap(), MetricId::VelocityJump) < 400.0,
            "{link}"
        );
    }
    let mut session = opened_without_problems("lab=layers&compare=layer_weight:0,0.5,1");
    let arms: Vec<f64> = session
        .panes()
        .iter()
        .map(|pane| number_of(pane.outcome.as_ref().unwrap(), MetricId::ArmsOffA))
        .collect();
    assert!(arms[0] == 0.0 && arms[1] > 0.3 * arms[2] && arms[1] < 0.7 * arms[2], "{arms:?}");
    // Unchanged results are not computed again in any pane, whichever parameter is compared.
    for compare in [
        "layer_weight:0,0.5",
        "layer_start:0,0.2,0.4",
        "layer_fit:step,loop",
        "mask:upper,head,legs,whole",
    ] {
        session.apply(Command::OpenLink(format!("lab=layers&compare={compare}"))).unwrap();
        let outcomes = |session: &Session| {
            session.panes().iter().map(|pane| pane.outcome.clone().unwrap()).collect::<Vec<_>>()
        };
        let before = outcomes(&session);
        session.apply(Command::Set(vec![(Key::CameraYaw, Value::Number(12.0))])).unwrap();
        assert!(
            before.iter().zip(outcomes(&session)).all(|(a, b)| Arc::ptr_eq(a, &b)),
            "{compare}"
        );
        assert!(before.windows(2).all(|pair| pair[0].motion != pair[1].motion), "{compare}");
    }
    // Relative to the mean, an additive layer keeps the posture; relative to the rest pose, it adds
    // all of it.
    let off = |reference: &str| {
        let session = opened_without_problems(&format!(
            "lab=layers&layer_mode=additive&layer_reference={reference}"
        ));
        number_of(session.main_outcome().unwrap(), MetricId::ArmsOffA)
    };
    assert!(
        off("mean") > 1.0 && off("mean") < 0.5 * off("rest"),
        "{} {}",
        off("mean"),
        off("rest")
    );
}

#[test]
fn layer_on_a_long_clip_is_prepared_between_frames() {
    let mut session = Session::new();
    let link = "lab=layers&a=walk(make_seconds:30)".to_owned();
    session.apply(Command::OpenLink(link)).unwrap();
    let is_prepared =
        |session: &Session| session.main_outcome().is_some_and(|outcome| outcome.layer().is_some());
    assert!(!is_prepared(&session));
    assert!(session.jobs().iter().any(|job| job.kind == crate::JobKind::Analyzing));
    while session.work() {}
    assert!(is_prepared(&session) && session.jobs().is_empty());
    let outcome = session.main_outcome().unwrap();
    assert_eq!(outcome.layer().unwrap().fit, crate::LayerFit::InStep);
    // Another weight, and another time for the same clips, show at once.
    let shown = Arc::clone(&outcome.sources[1].motion);
    session.apply(Command::Set(vec![(Key::LayerWeight, Value::Number(0.5))])).unwrap();
    let outcome = session.main_outcome().unwrap();
    assert_eq!(outcome.layer().unwrap().shares.iter().copied().fold(0.0, f32::max), 0.5);
    assert!(Arc::ptr_eq(&outcome.sources[1].motion, &shown));
    session.apply(Command::Set(vec![(Key::LayerStart, Value::Number(0.3))])).unwrap();
    let outcome = session.main_outcome().unwrap();
    assert_ne!(outcome.sources[1].motion.clip(), shown.clip());
    assert!(session.jobs().iter().all(|job| job.kind != crate::JobKind::Analyzing));
}
