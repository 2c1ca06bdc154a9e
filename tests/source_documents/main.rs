//! The experiments of the four documents that Segue reproduces, each as one link, with the results
//! that the document reports: a course report on motion graphs, a program for motion path editing,
//! homework on blending and motion matching, and an article on Gleicher's motion path editing.
//!
//! Motions are synthesised. The homework's own files are used as well, if they are beside the
//! project.

#[path = "../../crates/formats/tests/common/mod.rs"]
mod common;
mod course_report;
mod homework;
mod path_article;
mod path_program;

use glam::{DVec2, Vec3};
use petgraph::visit::EdgeRef;
use segue_motion::blend::WeightLaw;
use segue_motion::clip::Motion;
use segue_motion::graph::{Construction, MotionGraph};
use segue_motion::math::{Planar, quat, spring};
use segue_motion::path::SplineEnds;
use segue_scene::{Director, StageOptions, Viewport};
use segue_session::{Command, CycleMade, Key, Level, Outcome, Pane, Session, Slot, Value, Walk};
use std::sync::Arc;

/// Returns an angle in the range from -π to π.
fn wrap_angle(angle: f64) -> f64 {
    angle.sin().atan2(angle.cos())
}

/// Returns a session with an opened link and all its work done.
fn opened(link: &str) -> Session {
    let mut session = Session::new();
    session.apply(Command::OpenLink(link.to_owned())).expect("a link is never refused");
    while session.work() {}
    let said: Vec<_> =
        session.notices().list().iter().filter(|notice| notice.level != Level::Info).collect();
    assert!(said.is_empty(), "{link}: {said:?}");
    session
}

fn outcome(session: &Session, pane: usize) -> &Arc<Outcome> {
    let pane: &Pane = &session.panes()[pane];
    assert_eq!(pane.problem, None);
    pane.outcome.as_ref().expect("a result")
}

fn motion(session: &Session, pane: usize) -> &Motion {
    &outcome(session, pane).motion
}

fn walk(session: &Session, pane: usize) -> &Walk {
    outcome(session, pane).walk().expect("a walk")
}

fn graph(session: &Session, pane: usize) -> &MotionGraph {
    walk(session, pane).built.graph()
}

fn number(session: &Session, pane: usize, id: &str) -> f64 {
    let metrics = &outcome(session, pane).metrics;
    let metric = metrics.iter().find(|metric| metric.id.name() == id);
    metric.and_then(|metric| metric.value).unwrap_or_else(|| panic!("no {id}"))
}

/// Returns a metric in every pane.
fn numbers(session: &Session, id: &str) -> Vec<f64> {
    (0..session.panes().len()).map(|pane| number(session, pane, id)).collect()
}

fn clip(session: &mut Session, id: &str) -> Arc<Motion> {
    session.make_all();
    session.library().find(id).and_then(|entry| entry.motion.clone()).expect("a clip")
}

fn is_rising(values: &[f64]) -> bool {
    values.windows(2).all(|pair| pair[0] < pair[1])
}
