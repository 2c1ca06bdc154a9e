//! The Clean lab: the list of faults, its switches, and the marks on the timeline.

use super::*;

fn left(harness: &Harness<'_, Page>) -> f64 {
    let outcome = outcome(harness.state());
    outcome
        .metric(segue_session::metrics::MetricId::FaultsLeft)
        .and_then(|m| m.value)
        .expect("a number")
}

#[test]
fn clean_lab_lists_faults_and_mends_each() {
    let link = "lab=clean&a=walk&clean_faults=4&play=off&t=1";
    for (name, size, theme) in [
        ("clean-desk-dark", DESK, DARK),
        ("clean-desk-light", DESK, LIGHT),
        ("clean-projector", vec2(1280.0, 720.0), HALL),
        ("clean-phone-dark", PHONE, DARK),
    ] {
        let mut harness = harness(size, theme, page(link));
        picture(name, &mut harness);
    }
    let compare = "lab=clean&a=walk&clean_faults=4&compare=clean_mend:off,on&play=off&t=1";
    let mut compared = harness(DESK, DARK, page(compare));
    picture("clean-compare-dark", &mut compared);

    let mut harness = harness(DESK, DARK, page(link));
    assert_eq!(left(&harness), 0.0);
    let first = |harness: &Harness<'_, Page>| {
        let facts = outcome(harness.state()).cleaned().expect("facts");
        let found = &facts.faults[0];
        (found.fault.frames.start, found.is_chosen)
    };
    let (start, _) = first(&harness);
    let press_first = |harness: &mut Harness<'_, Page>| {
        let all: Vec<_> = harness.query_all_by_label_contains("Mend this fault").collect();
        all[0].scroll_to_me();
        drop(all);
        harness.run();
        let all: Vec<_> = harness.query_all_by_label_contains("Mend this fault").collect();
        all[0].click();
        drop(all);
        harness.run();
    };
    press_first(&mut harness);
    assert_eq!((first(&harness), left(&harness)), ((start, false), 1.0));
    assert_eq!(harness.state().session.params().faults_left_alone().len(), 1);
    press("Clean all", &mut harness);
    assert_eq!((first(&harness), left(&harness)), ((start, true), 0.0));
    // A click on the line shows the fault.
    let secs = start as f64 / outcome(harness.state()).motion.clip().fps();
    let line = format!("{secs:.2} s · ");
    // The button that mends it stands before it.
    harness.get_all_by_label_contains(&line).last().expect("a line").click();
    harness.run();
    assert!((harness.state().session.now_secs() - secs).abs() < 1e-3);
}

#[test]
fn clip_without_faults_says_so() {
    let harness = harness(DESK, DARK, page("lab=clean&a=walk&play=off"));
    harness.get_by_label(text::NO_FAULTS.english());
}
