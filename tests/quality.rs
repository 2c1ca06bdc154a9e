//! Every lab on randomly drawn motions: synthesised ones everywhere, captured ones if this machine
//! has them. `cargo xtask quality` does the same for any folder, and prints the numbers.

#[path = "../crates/formats/tests/common/mod.rs"]
mod common;
#[path = "../tools/quality/trials/mod.rs"]
mod trials;

use segue_session::{Command, write_ids};
use trials::folder::{Motions, encoded};
use trials::session::try_all;
use trials::trial::{Draw, Numbers, Trial, TrialResult};

/// Labs whose results on close pairs, and on sets of takes, have no artefact of their own.
const SMOOTH: [&str; 7] = ["blend", "transition", "speed", "loop", "layers", "register", "match"];

/// Asserts what holds for all results; returns their number.
fn assert_invariants(trials: &[Trial]) -> usize {
    let mut made = 0;
    for trial in trials {
        let faults = trial.faults();
        let asked: &[&str] = if SMOOTH.contains(&trial.lab) {
            &["panic", "not finite", "refused without a message", "spin", "flash", "root jump"]
        } else {
            &["panic", "not finite", "refused without a message"]
        };
        assert!(!faults.iter().any(|fault| asked.contains(fault)), "{faults:?}: {trial:#?}");
        made += usize::from(matches!(trial.result, TrialResult::Made(_)));
    }
    made
}

/// Returns the mean foot skating of a lab's results, without and with the foot lock, cm/s.
fn skating(trials: &[Trial], lab: &str) -> [f64; 2] {
    [false, true].map(|locked| {
        let own = trials.iter().filter(|trial| trial.lab == lab && trial.locked == locked);
        let values: Vec<f64> = own
            .filter_map(|trial| match &trial.result {
                TrialResult::Made(numbers) => numbers.skating,
                _ => None,
            })
            .collect();
        assert!(!values.is_empty(), "no result of {lab}");
        values.iter().sum::<f64>() / values.len() as f64
    })
}

#[test]
fn skating_below_visibility_is_no_fault() {
    let faults = |skating: f64, source_skating: f64| {
        let numbers = Numbers {
            skating: Some(skating),
            source_skating: Some(source_skating),
            ..Numbers::default()
        };
        let trial = Trial {
            lab: "blend",
            method: String::new(),
            draw: Draw::SameRig,
            takes: Vec::new(),
            link: String::new(),
            locked: true,
            bound: true,
            secs: 0.0,
            result: TrialResult::Made(Box::new(numbers)),
        };
        trial.faults()
    };
    // Feet that stand still: the ratio of two tiny numbers has no meaning.
    assert!(faults(0.07, 0.06).is_empty() && faults(0.01, 0.0).is_empty());
    assert_eq!(faults(0.64, 0.05), ["skating"]);
    assert!(faults(10.4, 10.0).is_empty());
    assert_eq!(faults(10.6, 10.0), ["skating"]);
}

#[test]
fn labs_on_synthesised_motions_have_no_artefacts() {
    let motions = Motions::synthesised(20, 3);
    assert!(motions.refused.is_empty() && motions.panics.is_empty(), "{motions:?}");
    let trials = try_all(&motions, 2, 5);
    let made = assert_invariants(&trials);
    assert!(made > 200 && made * 10 > trials.len() * 8, "{made} of {}", trials.len());
    let [free, locked] = skating(&trials, "match");
    assert!(locked < free, "{free} {locked}");
}

#[test]
fn labs_on_captured_motions_have_no_artefacts() {
    let Some(folder) = common::subject_16() else {
        return;
    };
    let motions = Motions::of_folder(&folder).expect("the folder can be read");
    assert!(motions.takes.len() >= 15 && motions.refused.is_empty(), "{:?}", motions.refused);
    let trials = try_all(&motions, 3, 2);
    assert!(assert_invariants(&trials) > 150);
    for lab in ["blend", "transition", "match"] {
        let [free, locked] = skating(&trials, lab);
        assert!(locked < 0.9 * free, "{lab}: {free} {locked}");
    }
}

#[test]
fn walk_through_captured_motion_has_no_spins_and_flashes() {
    let Some(folder) = common::subject_16() else {
        return;
    };
    let motions = Motions::of_folder(&folder).expect("the folder can be read");
    let all: Vec<usize> = (0..motions.takes.len()).collect();
    let (mut session, ids) = motions.open(&all).expect("the takes are read");
    let link = format!("lab=graph&walk_seconds=600&clips={}", encoded(&write_ids(&ids)));
    session.apply(Command::OpenLink(link)).expect("the link is good");
    while session.work() {}
    let outcome = session.main_outcome().expect("there is a walk");
    let walk = outcome.walk().expect("it is a walk");
    assert!(walk.passed.len() > 60, "{} stays", walk.passed.len());
    for id in ["spins", "flashes"] {
        let metric =
            outcome.metrics.iter().find(|metric| metric.id.name() == id).expect("it is measured");
        assert_eq!(metric.value, Some(0.0), "{metric:?}");
    }
}
