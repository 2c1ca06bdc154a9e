//! The parts of single labs in the bottom panel: strips in place of the timeline, and the
//! parameters that its handles set.

use super::lab_ui::Edge;
use super::{blend, clean, edit, graph, loop_, make, match_, register, transition};
use crate::ui::kit;
use crate::ui::out::Out;
use crate::ui::state::{Layout, UiState};
use crate::ui::text;
use eframe::egui::{Color32, Context, Ui};
use segue_session::{Command, Key, Kind, Outcome, Params, Session, Slot, Value, Walk};
use segue_text::Message;
use std::sync::Arc;

/// Steers the driven character by keys, stick and gamepad.
pub(crate) fn steer(session: &Session, state: &mut UiState, out: &mut Out, ctx: &Context) {
    match_::steer(session, state, out, ctx);
}

/// Draws the strip of a walk or of a driven character. Returns `false`, and draws nothing, where
/// the timeline shows the result.
pub(crate) fn strip_ui(
    session: &Session,
    layout: Layout,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) -> bool {
    if let Some(walk) = whole_walk(session) {
        graph::walk_panel_ui(session, walk, layout, state, out, ui);
        return true;
    }
    let Some(outcome) = session.main_outcome() else {
        return false;
    };
    let Some(driven) = outcome.driven() else {
        return false;
    };
    match_::drive_panel_ui(session, outcome, driven, layout, state, out, ui);
    true
}

/// Returns whether a strip is drawn in place of the timeline.
pub(crate) fn has_strip(session: &Session) -> bool {
    let is_driven = session.main_outcome().is_some_and(|outcome| outcome.driven().is_some());
    is_driven || whole_walk(session).is_some()
}

/// Returns the walk of the first pane, where it is not a single transition.
fn whole_walk(session: &Session) -> Option<&Arc<Walk>> {
    session.graph_walk().filter(|walk| !walk.is_jump)
}

/// Draws the bar of the clip in A with the part that the lab uses, where it uses a part. Its
/// handles set the ends of the part; an end of the clip is no end of its own.
pub(crate) fn part_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    let Some(keys) = edit::part_keys(session).or_else(|| loop_::part_keys(session)) else {
        return;
    };
    let Some(entry) = session.slot(Slot::A) else {
        return;
    };
    let Some(clip) = entry.motion.as_ref().map(|motion| motion.clip()) else {
        return;
    };
    let (name, duration) = (entry.title(), clip.duration_secs());
    let end_of = |key: Key, missing: f64| {
        let given = session.params().optional(key).or_else(|| session.automatic_value(key));
        given.unwrap_or(missing).clamp(0.0, duration)
    };
    let (a, b) = (end_of(keys[0], 0.0), end_of(keys[1], duration));
    let bar = kit::PartBar {
        label: text::PART_OF_A,
        name: (&name).into(),
        duration,
        step: clip.fps().recip(),
        ends: [a.min(b), a.max(b)],
    };
    let kit::PartBarResponse { moved, is_done } = kit::part_bar_ui(&bar, ui);
    if let Some((end, secs)) = moved {
        let at_end = (secs - [0.0, duration][end]).abs() < 0.5 * bar.step;
        let is_auto = at_end && edit::part_keys(session).is_some();
        out.set(keys[end], if is_auto { Value::Auto } else { Value::Number(secs) });
    }
    if is_done {
        out.commands.push(Command::Settle);
    }
}

/// Returns the marks of a lab's own on the timeline, in the colours of what is mended and of what
/// is wrong.
pub(crate) fn moments(session: &Session, colors: [Color32; 2]) -> Vec<kit::Moment> {
    clean::moments(session, colors)
}

/// Returns the name of a motion that was made from these parameters alone; `None` for results of
/// clips.
pub(crate) fn made_name(params: &Params) -> Option<Message> {
    make::made_name(params)
}

/// Returns the value that dragging the start of the transition to a time sets.
pub(crate) fn start_value(secs: f64, session: &Session, outcome: &Outcome) -> Option<(Key, f64)> {
    edge_value(Edge::Start, secs, session, outcome)
}

/// Returns the value that dragging the end of the transition to a time sets, within its limits.
pub(crate) fn end_value(secs: f64, session: &Session, outcome: &Outcome) -> Option<(Key, f64)> {
    let (key, value) = edge_value(Edge::End, secs, session, outcome)?;
    match key.param().kind {
        Kind::Number { min, max, .. } => Some((key, value.clamp(min, max))),
        _ => Some((key, value)),
    }
}

fn edge_value(edge: Edge, secs: f64, session: &Session, outcome: &Outcome) -> Option<(Key, f64)> {
    if let Some(registered) = outcome.registered() {
        return register::edge_value(edge, secs, registered, outcome.motion.clip().fps());
    }
    if transition::is_open(session) {
        return transition::edge_value(edge, secs, session, outcome);
    }
    Some(blend::edge_value(edge, secs, outcome))
}
