//! The Graph lab: the clips and what is set of graph and walk, the picture of all distances, the
//! graph as bars and arcs, and the table of numbers.

mod map;
mod rows;
mod strip;
mod table;

pub(crate) use map::{is_open, map_panel_ui, map_share};
pub(crate) use rows::{compare_windows, graph_ui, seed_detail};
pub(crate) use strip::walk_panel_ui;

use crate::ui::labs::{Compares, LabUi, Shown, Title};
use crate::ui::out::Out;
use crate::ui::state::UiState;
use crate::ui::text;
use glam::DVec2;
use segue_motion::graph::Place;
use segue_session::{
    Built, Command, Key, PlaybackCommand, Session, Value, Walk, write_jump, write_path,
};

/// The lab's part of the page.
pub(super) const LAB: LabUi = LabUi {
    panel_ui: graph_ui,
    compares: Compares::Own(|_, out| compare_windows(out)),
    title,
    hint: |_| Some(text::GRAPH_HINT),
    take_line: Some(take_line),
};

fn title(shown: &Shown<'_>) -> Title {
    let walk = shown.pane.outcome.as_ref().and_then(|outcome| outcome.walk());
    let at = walk.and_then(|walk| Some((walk, walk.at(shown.session.now_secs())?)));
    let name =
        |walk: &Walk, clip: usize| walk.built.cast().names().get(clip).cloned().unwrap_or_default();
    let next = at.and_then(|(walk, at)| Some(name(walk, walk.passed.get(at.stay + 1)?.stay.clip)));
    Title {
        strong: at.map(|(walk, at)| name(walk, at.place.clip)).unwrap_or_default(),
        text: next.map(|next| format!("→ {next}")).unwrap_or_default(),
        secondary: format!("seed {}", shown.params.number(Key::Seed)),
    }
}

/// The walk follows what was drawn, from its beginning.
fn take_line(points: &[DVec2], _: &Session, _: &mut UiState, out: &mut Out) {
    if points.len() > 1 {
        out.set_once(Key::WalkPath, Value::Text(write_path(points)));
        out.commands.push(Command::Playback(PlaybackCommand::Seek(0.0)));
    }
}

/// Whether the lab shows one transition in place of the walk.
fn shows_jump(session: &Session) -> bool {
    !session.params().text(Key::Jump).is_empty()
}

/// Plays one transition, also where all stands still: whoever asks for it wants to see it. The walk
/// is kept where it is.
fn open_jump([leave, enter]: [Place; 2], session: &Session, state: &mut UiState, out: &mut Out) {
    if !shows_jump(session) {
        state.walk_secs = session.now_secs();
    }
    out.set_once(Key::Jump, Value::Text(write_jump(leave, enter)));
    out.commands.push(Command::Playback(PlaybackCommand::Seek(0.0)));
    out.set(Key::Play, Value::Switch(true));
}

/// Goes back to the walk, where it was.
fn close_jump(state: &UiState, out: &mut Out) {
    out.set_once(Key::Jump, Value::Text(String::new()));
    out.set(Key::Time, Value::Number(state.walk_secs.clamp(0.0, 3600.0)));
}

/// A clip's name and the frame.
fn named(built: &Built, place: Place) -> (&str, usize) {
    let name = built.cast().names().get(place.clip).map_or("", String::as_str);
    (name, place.frame)
}

/// A transition in words, with its probability where it is walked.
fn jump_words(built: &Built, walk: Option<&Walk>, ends: [Place; 2]) -> Option<String> {
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
    Some(text::jump_in_words(
        [named(built, ends[0]), named(built, ends[1])],
        jump.distance_cm,
        probability,
    ))
}

/// Shows both poses of a transition that is pointed at, unless it is the one that plays: then it is
/// looked at itself.
fn point_at(ends: [Place; 2], walk: Option<&Walk>, state: &mut UiState) {
    let jump = walk.filter(|walk| walk.is_jump);
    let seam = jump.and_then(|walk| walk.passed.get(1)?.seam);
    if seam.is_none_or(|seam| [seam.leave, seam.enter] != ends) {
        state.hovered_jump = Some(ends);
    }
}

/// Why a visit came to nothing.
fn no_way(built: &Built, (secs, clip): (f64, usize)) -> String {
    let name = built.cast().names().get(clip).map_or("", String::as_str);
    text::no_way(name, secs)
}
