//! The Clean lab, driven by links and commands.

use crate::fixtures::opened;
use crate::metrics::MetricId;
use crate::params::{Key, List, Value};
use crate::{Command, JobKind, Session};
use segue_motion::clean::FaultKind;

fn number(session: &Session, pane: usize, id: MetricId) -> f64 {
    let outcome = session.panes()[pane].outcome.as_ref().expect("a result");
    outcome.metric(id).expect("a number").value.expect("a value")
}

#[test]
fn faults_injected_are_listed_and_mended() {
    let session = opened("lab=clean&a=walk&clean_faults=4&compare=clean_mend:off,on");
    let facts = session.main_outcome().and_then(|outcome| outcome.cleaned()).expect("facts");
    assert_eq!(facts.injected, 4);
    assert!(facts.kinds().len() >= 3, "{:?}", facts.kinds());
    let left = number(&session, 0, MetricId::FaultsLeft);
    assert!(left >= 4.0, "{left}: {:#?}", facts.faults);
    assert_eq!(number(&session, 1, MetricId::FaultsLeft), 0.0);
    assert!(
        number(&session, 1, MetricId::PoseJump) < 0.2 * number(&session, 0, MetricId::PoseJump)
    );
}

#[test]
fn cleaned_take_is_that_of_the_lab() {
    let motion = |mend: &str| {
        let session = opened(&format!("lab=clean&a=walk&clean_faults=4&clean_mend={mend}"));
        session.main_outcome().expect("a result").motion.clone()
    };
    let (mended, count) = crate::cleaned(&motion("off")).expect("mended");
    assert!(count >= 4, "{count}");
    assert_eq!(mended.clip(), motion("on").clip());
}

#[test]
fn sound_clip_stays_as_it_is() {
    let session = opened("lab=clean&a=walk");
    let view = opened("lab=view&a=walk");
    let clip = |session: &Session| session.main_outcome().expect("a result").motion.clip().clone();
    assert_eq!(clip(&session), clip(&view));
}

#[test]
fn fault_that_is_left_alone_stays() {
    let mut session = opened("lab=clean&a=walk&clean_faults=1");
    let left = |session: &Session| number(session, 0, MetricId::FaultsLeft);
    assert_eq!(left(&session), 0.0);
    let facts = session.main_outcome().and_then(|outcome| outcome.cleaned()).expect("facts");
    let fault = &facts.faults[0].fault;
    let list = List::FaultPlaces(vec![(fault.kind, fault.frames.start)]);
    session.apply(Command::Set(vec![(Key::CleanSkip, list.into())])).expect("set");
    assert_eq!(left(&session), 1.0);
    assert!(session.query().contains("clean_skip=spike-"), "{}", session.query());
    session.apply(Command::Reset(Key::CleanSkip)).expect("reset");
    session.apply(Command::Set(vec![(Key::CleanSpikes, Value::Switch(false))])).expect("set");
    assert_eq!(left(&session), 1.0);
}

#[test]
fn kept_result_is_a_recipe_that_makes_the_same_again() {
    let mut session = opened("lab=clean&a=walk&clean_faults=3&clean_seed=5");
    let made = session.main_outcome().expect("a result").motion.clip().clone();
    session.apply(Command::Keep(0)).expect("kept");
    let again = opened("lab=view&a=clean(a:walk,clean_faults:3,clean_seed:5)");
    assert_eq!(*again.main_outcome().expect("a result").motion.clip(), made);
}

#[test]
fn long_take_is_searched_in_slices_with_progress() {
    let link = "lab=clean&a=walk(make_seconds:30)&clean_faults=6";
    let mut session = Session::new();
    session.apply(Command::OpenLink(link.to_owned())).expect("opened");
    let is_cleaning =
        |session: &Session| session.jobs().iter().any(|job| job.kind == JobKind::Cleaning);
    assert!(is_cleaning(&session));
    let (mut slices, mut least) = (0, 0.0);
    while let Some(job) = session.jobs().into_iter().find(|job| job.kind == JobKind::Cleaning) {
        assert!(job.progress >= least - 1e-6, "{} after {least}", job.progress);
        least = job.progress;
        assert!(session.work());
        slices += 1;
    }
    assert!(slices > 50, "{slices}");
    while session.work() {}
    let facts = session.main_outcome().and_then(|outcome| outcome.cleaned()).expect("facts");
    assert_eq!(facts.injected, 6);
    assert!(facts.faults.iter().any(|found| found.fault.kind == FaultKind::Spike));
}
