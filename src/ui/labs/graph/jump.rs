//! A single transition of the graph: played, under the pointer, and in words.

use crate::ui::out::Out;
use crate::ui::state::UiState;
use crate::ui::text;
use segue_motion::graph::Place;
use segue_session::{BuiltGraph, Command, Key, List, PlaybackCommand, Session, Value, Walk};
use segue_text::Message;

/// Returns whether the lab shows one transition in place of the walk.
pub(super) fn shows_jump(session: &Session) -> bool {
    session.params().jump().is_some()
}

/// Plays one transition, also while playback is paused. The walk keeps its place.
pub(super) fn open_jump(jump: [Place; 2], session: &Session, state: &mut UiState, out: &mut Out) {
    if !shows_jump(session) {
        state.labs.graph.walk_secs = session.now_secs();
    }
    out.set_once(Key::Jump, List::Jump(Some(jump)).into());
    out.commands.push(Command::Playback(PlaybackCommand::Seek(0.0)));
    out.set(Key::Play, Value::Switch(true));
}

/// Goes back to the walk, where it was.
pub(super) fn close_jump(state: &UiState, out: &mut Out) {
    out.reset(Key::Jump);
    out.set(Key::Time, Value::Number(state.labs.graph.walk_secs.clamp(0.0, 3600.0)));
}

/// Returns the name of a clip of a graph.
pub(super) fn clip_title(built: &BuiltGraph, clip: usize, session: &Session) -> Message {
    let name = built.clips().names().get(clip);
    name.map(|name| session.clip_title(name)).unwrap_or_default()
}

/// Returns a clip's name and the frame.
pub(super) fn named(built: &BuiltGraph, place: Place, session: &Session) -> Message {
    text::frame_in_words(clip_title(built, place.clip, session), place.frame)
}

/// Describes a transition, with its probability where it is walked.
pub(super) fn jump_words(
    built: &BuiltGraph,
    walk: Option<&Walk>,
    ends: [Place; 2],
    session: &Session,
) -> Option<Message> {
    let jump = built.whole().jumps().get(built.jump_of(ends[0], ends[1])?)?;
    let walk = walk.filter(|walk| std::ptr::eq(&raw const *walk.built, built));
    let probability = walk.and_then(|walk| {
        let graph = built.graph();
        let edge = graph.graph().edge_indices().find(|&edge| {
            let of = graph.jump(edge);
            of.is_some_and(|of| of.leave == ends[0] && of.enter == ends[1])
        })?;
        let (from, _) = graph.graph().edge_endpoints(edge)?;
        let mut ways = walk.choices.probabilities(from);
        ways.find(|(way, _)| *way == edge).map(|(_, p)| p)
    });
    let ends = ends.map(|place| named(built, place, session));
    Some(text::jump_in_words(ends, jump.distance_cm, probability))
}

/// Shows both poses of a transition under the pointer, unless it is the one that plays.
pub(super) fn point_at(ends: [Place; 2], walk: Option<&Walk>, state: &mut UiState) {
    let jump = walk.filter(|walk| walk.is_jump);
    let seam = jump.and_then(|walk| walk.passed.get(1)?.seam);
    if seam.is_none_or(|seam| [seam.leave, seam.enter] != ends) {
        state.labs.graph.hovered_jump = Some(ends);
    }
}

/// Describes why a visit was not possible.
pub(super) fn no_way(built: &BuiltGraph, (secs, clip): (f64, usize), session: &Session) -> Message {
    text::no_way(clip_title(built, clip, session), secs)
}
