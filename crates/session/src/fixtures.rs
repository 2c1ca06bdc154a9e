//! Fixtures of the tests that drive a session by commands: the names that they use, small files,
//! and the work around a session.

pub(crate) use crate::command::{
    Command, CommandError, DriveCommand, FileCommand, PlaybackCommand, Request,
};

pub(crate) use crate::labs::{Outcome, Slot};
pub(crate) use crate::library::{Entry, Origin};
pub(crate) use crate::link;
pub(crate) use crate::metrics::MetricId;
pub(crate) use crate::notice::Level;
pub(crate) use crate::params::{Key, Value};
pub(crate) use crate::reading::Content;
pub(crate) use crate::{Lesson, LoadedFile, NoResult, Pane, PaneContent, Session};
pub(crate) use segue_motion::clip::Motion;
pub(crate) use std::sync::Arc;

use crate::params::{Kind, PARAMS};
use proptest::prelude::{BoxedStrategy, Strategy, any};

/// A skeleton with two bones.
pub(crate) const ASF: &str = include_str!("fixtures/toy.asf");
/// A motion of [`ASF`] with two frames.
pub(crate) const AMC: &str = include_str!("fixtures/toy.amc");

/// Does all remaining work.
pub(crate) fn settle(session: &mut Session) {
    while session.work() {}
}

/// Returns a session with an opened link and all its work done.
pub(crate) fn opened(link: &str) -> Session {
    let mut session = Session::new();
    session.apply(Command::OpenLink(link.into())).unwrap();
    settle(&mut session);
    session
}

/// Returns a session as [`opened`] does, and asserts that every pane has a result.
pub(crate) fn opened_without_problems(link: &str) -> Session {
    let session = opened(link);
    assert!(session.panes().iter().all(|pane| pane.problem.is_none()), "{link}");
    session
}

/// Returns a metric of a result; NaN if it has no value.
pub(crate) fn number_of(outcome: &Outcome, id: MetricId) -> f64 {
    outcome.metric(id).and_then(|metric| metric.value).unwrap_or(f64::NAN)
}

/// Returns a synthesised motion as a BVH file.
pub(crate) fn made_bvh(seed: f64) -> Arc<[u8]> {
    let mut session = Session::new();
    session
        .apply(Command::Set(vec![
            (Key::Lab, Value::Choice("make")),
            (Key::Seed, Value::Number(seed)),
        ]))
        .unwrap();
    let clip = Arc::clone(session.main_outcome().unwrap().motion.clip());
    segue_formats::bvh::write(&clip, &segue_formats::bvh::WriteOptions::default())
        .into_bytes()
        .into()
}

/// Returns the bytes of a text.
pub(crate) fn bytes(text: &str) -> Arc<[u8]> {
    Arc::from(text.as_bytes())
}

/// Returns name, format and frames of the clips that files brought.
pub(crate) fn files(session: &Session) -> Vec<(String, &'static str, usize)> {
    let infos = session.clip_infos().into_iter().filter(|info| info.sha256.is_some());
    infos.map(|info| (info.name, info.format, info.frames)).collect()
}

/// Reads the requested files as a worker does: in order, with the setup of the request.
pub(crate) fn serve(session: &mut Session) {
    loop {
        let asked: Vec<_> = (session.take_requests().into_iter())
            .filter_map(|request| match request {
                Request::Read(task) => Some(task),
                _ => None,
            })
            .collect();
        if asked.is_empty() {
            return;
        }
        for task in asked {
            let Content::Here(bytes) = &task.content else { panic!("{task:?}") };
            let report =
                crate::reading::read(&task.name, bytes, &task.setup, &mut |_| true).unwrap();
            assert!(
                session.is_reading(task.id)
                    && session.is_reading_small()
                    && session.jobs().iter().all(|job| job.task.is_none())
            );
            session.finish_reading(task.id, Ok(report));
        }
    }
}

/// Has the motion of a clip read if it is not in memory.
pub(crate) fn read_clip(session: &mut Session, id: &str) {
    session.apply(Command::File(FileCommand::Read(id.to_owned()))).unwrap();
}

/// Sets the blend window, in frames.
pub(crate) fn blend_window(session: &mut Session, frames: f64) {
    session.apply(Command::Set(vec![(Key::BlendWindow, Value::Number(frames))])).unwrap();
}

/// Returns any valid value of a parameter, by its row in the table.
pub(crate) fn any_value(row: usize) -> BoxedStrategy<(Key, Value)> {
    let param = &PARAMS[row];
    let key = param.key;
    match param.kind {
        Kind::Number { min, max, auto, .. } => (any::<bool>(), min..=max)
            .prop_map(move |(left_to_segue, number)| {
                (
                    key,
                    if auto && left_to_segue {
                        Value::Auto
                    } else {
                        key.param().check(Value::Number(number)).unwrap()
                    },
                )
            })
            .boxed(),
        Kind::Switch => any::<bool>().prop_map(move |on| (key, Value::Switch(on))).boxed(),
        Kind::Choice(choices) => {
            (0..choices.len()).prop_map(move |i| (key, Value::Choice(choices[i].key))).boxed()
        }
        Kind::Clip | Kind::Joint | Kind::Character | Kind::Text => {
            "[^\\pC]{0,12}".prop_map(move |text| (key, Value::Text(text))).boxed()
        }
        Kind::List(kind) => "[0-9:,.\\-a-z() ]{0,12}"
            .prop_map(move |text| (key, kind.read(&text).unwrap_or(kind.empty()).into()))
            .boxed(),
        Kind::Compare => (1.0f64..120.0, 1.0f64..120.0)
            .prop_map(move |(x, y)| {
                (key, key.param().parse(&format!("blend_window:{x},{y}")).unwrap())
            })
            .boxed(),
    }
}
