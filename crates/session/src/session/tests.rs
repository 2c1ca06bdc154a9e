//! Tests of the session by commands: contents of the stage, results and comparisons.

use crate::fixtures::*;

#[test]
fn first_visit_blends_a_walk_into_a_run_in_three_panes() {
    let session = Session::new();
    assert_eq!(session.panes().len(), 3);
    assert_eq!(session.query(), "compare=blend_window:30,15,10");
    for pane in session.panes() {
        assert_eq!(pane.problem, None);
        let outcome = pane.outcome.as_ref().unwrap();
        let Some((Key::BlendWindow, Value::Number(window))) = pane.variant else { panic!() };
        let window = window as usize;
        assert_eq!(outcome.transition.unwrap().window_frames, window);
        assert_eq!(outcome.sources.len(), 2);
        assert!(outcome.metrics.iter().any(|metric| metric.value.is_some()));
    }
    // The panes differ in the window alone.
    let places: Vec<_> = session
        .panes()
        .iter()
        .map(|pane| pane.outcome.as_ref().unwrap().transition.unwrap())
        .collect();
    assert!(places.windows(2).all(|pair| pair[0].leave_a_secs == pair[1].leave_a_secs
        && pair[0].enter_b_secs == pair[1].enter_b_secs));
    assert!(session.params().is_on(Key::Play));
}

#[test]
fn unchanged_results_are_not_computed_again() {
    let mut session = Session::new();
    settle(&mut session);
    let before = Arc::clone(session.main_outcome().unwrap());
    session.apply(Command::Set(vec![(Key::CameraYaw, Value::Number(10.0))])).unwrap();
    assert!(Arc::ptr_eq(&before, session.main_outcome().unwrap()));
    session.apply(Command::Set(vec![(Key::WeightLaw, Value::Choice("linear"))])).unwrap();
    assert!(!Arc::ptr_eq(&before, session.main_outcome().unwrap()));
}

#[test]
fn invalid_value_changes_nothing() {
    let mut session = Session::new();
    let query = session.query();
    let both = vec![(Key::BlendWindow, Value::Number(20.0)), (Key::TurnRate, Value::Number(1e9))];
    let error = session.apply(Command::Set(both)).unwrap_err();
    assert!(error.to_string().contains("turn_rate"), "{error}");
    assert_eq!(session.query(), query);
    assert!(!session.can_undo());
}

#[test]
fn synthesised_motion_clamps_values_set_for_another() {
    let mut session = Session::new();
    let make = [
        (Key::Lab, Value::Choice("make")),
        (Key::Gait, Value::Choice("run")),
        (Key::GaitSpeed, Value::Number(6.0)),
        (Key::MakeSeconds, Value::Number(1.0)),
        (Key::Compare, Value::Compare(None)),
    ];
    session.apply(Command::Set(make.to_vec())).unwrap();
    for gait in ["run", "walk", "idle", "start", "stop", "spin", "jump"] {
        session.apply(Command::Set(vec![(Key::Gait, Value::Choice(gait))])).unwrap();
        assert_eq!(session.panes()[0].problem, None, "{gait}");
        // Compared side by side, each pane shows something, and no two the same.
        if session.range_of(Key::GaitSpeed).is_some() {
            session.apply(Command::Compare(Key::GaitSpeed)).unwrap();
            let values = session.compare().unwrap().values.clone();
            assert!(values[0] != values[1] && values[1] != values[2], "{gait}: {values:?}");
            assert!(
                session.panes().iter().all(|pane| pane.problem.is_none()),
                "{gait}: {values:?}"
            );
            session.apply(Command::Set(vec![(Key::Compare, Value::Compare(None))])).unwrap();
        }
    }
}

#[test]
fn removed_clip_is_replaced_and_restored_by_undo() {
    let mut session = Session::new();
    settle(&mut session);
    session.apply(Command::Remove("walk".into())).unwrap();
    assert!(session.slot(Slot::A).is_some_and(|entry| entry.id != "walk" && entry.id != "run"));
    assert_eq!(session.panes()[0].problem, None);
    session.apply(Command::Undo).unwrap();
    assert_eq!(session.slot(Slot::A).unwrap().id, "walk");
}

#[test]
fn methods_are_compared_on_one_transition() {
    let mut session = Session::new();
    session
        .apply(Command::OpenLink(
            "lab=transition&compare=method:inertialize,smooth,dead,cut".into(),
        ))
        .unwrap();
    settle(&mut session);
    let outcomes: Vec<_> =
        session.panes().iter().map(|pane| pane.outcome.clone().unwrap()).collect();
    assert!(session.panes().iter().all(|pane| pane.problem.is_none()));
    let places: Vec<_> = outcomes.iter().map(|outcome| outcome.transition.unwrap()).collect();
    assert!(places.windows(2).all(|pair| (pair[0].leave_a_secs, pair[0].enter_b_secs)
        == (pair[1].leave_a_secs, pair[1].enter_b_secs)));
    let seam = |outcome: &Arc<Outcome>| outcome.metric(MetricId::PoseJump).unwrap().value.unwrap();
    assert!(seam(&outcomes[3]) > 4.0 * seam(&outcomes[0]), "a cut jumps, inertialization does not");
    // A change by the slider shows at once, and the match stays.
    session.apply(Command::OpenLink("lab=transition".into())).unwrap();
    settle(&mut session);
    let before = Arc::clone(session.main_outcome().unwrap());
    session.apply(Command::Set(vec![(Key::HalfLife, Value::Number(0.6))])).unwrap();
    let after = session.main_outcome().unwrap();
    assert!(after.transition.unwrap().end_secs > before.transition.unwrap().end_secs + 0.5);
    assert_eq!(after.transition.unwrap().leave_a_secs, before.transition.unwrap().leave_a_secs);
}

#[test]
fn mix_frames_are_frames_of_each_clip() {
    let mut session = Session::new();
    session
        .apply(Command::OpenLink(
            "lab=transition&mix_frame_a=90&mix_frame_b=12&method=cubic".into(),
        ))
        .unwrap();
    settle(&mut session);
    let outcome = session.main_outcome().unwrap();
    let fps = outcome.motion.clip().fps();
    let place = outcome.transition.unwrap();
    assert_eq!(
        ((place.leave_a_secs * fps).round(), (place.enter_b_secs * fps).round()),
        (90.0, 12.0)
    );
}

#[test]
fn mistakes_are_compared_with_the_correct_transition() {
    let right = opened_without_problems("lab=transition");
    let both = opened_without_problems("lab=transition&compare=mistake:none,euler,hemisphere");
    let outcome = |session: &Session, pane: usize| {
        Arc::clone(session.panes()[pane].outcome.as_ref().unwrap())
    };
    // Without a mistake, the result is the transition itself, bit for bit.
    assert_eq!(outcome(&right, 0).motion, outcome(&both, 0).motion);
    assert_eq!(outcome(&right, 0).metrics, outcome(&both, 0).metrics);
    let seam = |pane| number_of(&outcome(&both, pane), MetricId::VelocityJump);
    assert!(
        seam(1) > 10.0 * seam(0) && seam(2) > 3.0 * seam(0),
        "{} {} {}",
        seam(0),
        seam(1),
        seam(2)
    );
    let others = opened_without_problems("lab=transition&compare=mistake:none,degrees,atan");
    let of = |pane, id| number_of(&outcome(&others, pane), id);
    let jumps = [0, 1].map(|pane| of(pane, MetricId::VelocityJump));
    assert!(jumps[1] > 10.0 * jumps[0], "{jumps:?}");
    let spins = [0, 2].map(|pane| of(pane, MetricId::Spin));
    assert!(spins[0] < 5.0 && spins[1] > 60.0, "{spins:?}");
    // Other labs ignore mistakes.
    let [plain, spoiled] = ["lab=blend&compare=", "lab=blend&mistake=degrees"]
        .map(|link| outcome(&opened_without_problems(link), 0));
    assert_eq!(plain.motion, spoiled.motion);
    // Every mistake has a picture and the same numbers, by every method.
    for mistake in ["hemisphere", "euler", "degrees", "atan", "alignment", "velocity", "world_root"]
    {
        for method in ["inertialize", "cubic", "quintic", "dead", "smooth", "linear", "cut"] {
            let session = opened_without_problems(&format!(
                "lab=transition&method={method}&mistake={mistake}"
            ));
            let good = opened_without_problems(&format!("lab=transition&method={method}"));
            let differs = outcome(&session, 0).motion != outcome(&good, 0).motion;
            let told = |session: &Session| {
                outcome(session, 0).metrics.iter().map(|metric| metric.id).collect::<Vec<_>>()
            };
            assert_eq!(told(&session), told(&good));
            assert_eq!(differs, crate::mistake_shows(session.params()), "{mistake} {method}");
        }
    }
}

#[test]
fn comparison_of_a_choice_begins_with_the_one_that_is_set() {
    let mut session = Session::new();
    session.apply(Command::OpenLink("lab=transition&method=dead".into())).unwrap();
    session.apply(Command::Compare(Key::Method)).unwrap();
    let compare = session.compare().unwrap();
    assert_eq!(compare.values.first(), Some(&Value::Choice("dead")));
}

#[test]
fn long_values_of_a_link_are_shortened_and_its_problems_counted() {
    let long = "x".repeat(100_000);
    let nested = format!("{}walk{}", "blend(a:".repeat(2000), ")".repeat(2000));
    let keys: Vec<String> = (0..500).map(|n| format!("key{n}=1")).collect();
    let links = [
        format!("lab={long}"),
        format!("{long}=1"),
        format!("blend_window={long}"),
        format!("compare={long}"),
        format!("compare=blend_window:{long},2"),
        format!("a={nested}"),
        format!("a=x~{}", "0".repeat(10_000)),
        format!("lab=graph&clips={long}:"),
        format!("lab=graph&clips=walk&go_to={long}"),
        format!("lab=graph&clips=walk&jump={long}"),
        format!("lab=match&tags={long}"),
        format!("lab=register&also={long}"),
        format!("lab=register&pins={long}"),
        format!("src=ftp://{long}"),
        format!("lesson={long}"),
        keys.join("&"),
    ];
    for link in links {
        let mut session = Session::new();
        session.apply(Command::OpenLink(link.clone())).unwrap();
        while session.work() {}
        let said = session.notices().list().iter().map(|notice| notice.text.to_string());
        let problems = session
            .panes()
            .iter()
            .filter_map(|pane| pane.problem.as_ref().map(ToString::to_string));
        let lesson = session.lesson().and_then(|lesson| match lesson {
            Lesson::Failed(reason) => Some(reason.to_string()),
            _ => None,
        });
        let texts: Vec<String> = said.chain(problems).chain(lesson).collect();
        assert!(!texts.is_empty(), "{}", link.get(..40).unwrap_or(&link));
        for text in texts {
            assert!(
                text.chars().count() < 600,
                "{} letters: {}…",
                text.len(),
                text.get(..200).unwrap_or(&text)
            );
        }
    }
    let error = Command::Assign(Slot::A, long);
    assert!(Session::new().apply(error).unwrap_err().to_string().len() < 200);
}

#[test]
fn query_for_others_leaves_type_size_and_language_to_them() {
    let mut session = Session::new();
    let link = "blend_window=24&theme=light&lang=zh-Hant&projector=on";
    session.apply(Command::OpenLink(link.into())).unwrap();
    assert_eq!(session.query(), link);
    assert_eq!(session.query_for_others(), "blend_window=24&theme=light");
}
