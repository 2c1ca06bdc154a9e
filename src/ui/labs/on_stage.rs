//! The parts of single labs on the stage: handles, lines that are drawn over the ground, controls,
//! notes and highlights.

use super::path::ground_line::{GroundLine, ground_line};
use super::path::hand::path_of;
use super::{match_, of, path};
use crate::ui::language::Word;
use crate::ui::out::Out;
use crate::ui::state::{Layout, UiState};
use crate::ui::text;
use eframe::egui::{Rect, Response, Ui};
use segue_scene::{Highlights, PathMarks};
use segue_session::{CycleMade, Pane, Session};
use segue_text::Message;

/// Returns the hint over the stage.
pub(crate) fn hint(session: &Session) -> Option<Word> {
    (of(session.params().lab()).hint)(session)
}

/// Clears the items under the pointer of the last frame.
pub(crate) fn begin_frame(session: &Session, state: &mut UiState) {
    state.labs.register.hovered_pair = None;
    state.labs.graph.last_jump = state.labs.graph.hovered_jump.take();
    if of(session.params().lab()).take_line.is_none() {
        state.drawing = None;
    }
}

/// Moves the camera when a lab that needs another view opens or closes.
pub(crate) fn frame_once(session: &Session, state: &mut UiState, out: &mut Out) {
    path::stage::frame_once(session, state, out);
}

/// Returns whether a drag over the stage belongs to a lab and not to the camera. Hands a line that
/// was drawn over the ground to the lab that is open.
pub(crate) fn takes_drag(
    session: &Session,
    shown: &[(usize, Rect)],
    response: &Response,
    state: &mut UiState,
    out: &mut Out,
    ui: &Ui,
) -> bool {
    let line = ground_line(shown, response, state, ui);
    let takes_drag = !matches!(line, GroundLine::None)
        || state.labs.path.held.is_some()
        || state.labs.match_.is_held();
    if let (GroundLine::Done(points), Some(take_line)) =
        (line, of(session.params().lab()).take_line)
    {
        take_line(&points, session, state, out);
    }
    takes_drag
}

/// Shows the handles in the panes.
pub(crate) fn handles_ui(
    session: &Session,
    shown: &[(usize, Rect)],
    response: &Response,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    (state.labs.path.hovered, state.labs.path.place) = (None, None);
    for &(index, rect) in shown {
        path::stage::handles_ui(session, index, rect, response, state, out, ui);
    }
}

/// Shows the controls that a lab has at the lower left of `free`. Returns their place.
pub(crate) fn controls_ui(
    session: &Session,
    free: Rect,
    layout: Layout,
    state: &mut UiState,
    ui: &mut Ui,
) -> Rect {
    match_::stick_on_stage_ui(session, free, layout, state, ui)
}

/// Returns a lab's note on the last action on the stage.
pub(crate) fn note(session: &Session, state: &UiState) -> Option<Message> {
    path::is_open(session).then(|| path::stage::note(state)).flatten()
}

/// Returns a warning about the result of a pane, in a word.
pub(crate) fn warning(session: &Session, pane: &Pane) -> Option<Word> {
    let cycle = pane.outcome.as_ref().and_then(|outcome| outcome.cycle);
    // The requested speed lies outside the speeds of both clips.
    let is_beyond = matches!(
        cycle.map(|cycle| cycle.made),
        Some(CycleMade::Gait { facts, .. }) if facts.extrapolated || facts.limited
    );
    let turns_hard = || path_of(session, pane).is_some_and(|path| !path.hard_turns.is_empty());
    if is_beyond {
        Some(text::BEYOND)
    } else if turns_hard() {
        Some(text::TOO_HARD)
    } else {
        None
    }
}

/// Returns the highlights under the pointer on the stage.
pub(crate) fn highlights(session: &Session, state: &UiState) -> Highlights {
    Highlights {
        joint: state.joints_open || state.joint_marked,
        pair: state.labs.register.hovered_pair,
        jump: state.labs.graph.hovered_jump,
        candidate: match_::candidate(session, state),
        path: path_marks(session, state),
    }
}

/// Returns the parts of a path that are hovered, held and drawn.
fn path_marks(session: &Session, state: &UiState) -> PathMarks {
    let is_open = path::is_open(session);
    let drawn = state.drawing.clone().unwrap_or_default();
    let hand = &state.labs.path;
    PathMarks {
        handles: is_open && drawn.is_empty(),
        chosen: hand.chosen,
        hovered: hand.hovered,
        place: hand.place.map(|(place, _)| place),
        is_held: is_open && (hand.held.is_some() || !drawn.is_empty()),
        drawn,
    }
}
