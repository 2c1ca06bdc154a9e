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
use segue_session::{Built, Command, Key, List, PlaybackCommand, Session, Value, Walk};
use segue_text::{Message, msg};

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
    let name = |walk: &Walk, clip: usize| clip_title(&walk.built, clip, shown.session);
    let next = at.and_then(|(walk, at)| Some(name(walk, walk.passed.get(at.stay + 1)?.stay.clip)));
    Title {
        strong: at.map(|(walk, at)| name(walk, at.place.clip)).unwrap_or_default(),
        text: next.map(|clip| msg!("→ {clip}", clip)).unwrap_or_default(),
        secondary: msg!("seed {seed}", seed = shown.params.number(Key::Seed)),
    }
}

/// The walk follows what was drawn, from its beginning.
fn take_line(points: &[DVec2], _: &Session, _: &mut UiState, out: &mut Out) {
    if points.len() > 1 {
        // To the centimetre: what the link says is what is followed.
        let points = points.iter().map(|point| (point * 100.0).round() / 100.0).collect();
        out.set_once(Key::WalkPath, List::GroundPath(points).into());
        out.commands.push(Command::Playback(PlaybackCommand::Seek(0.0)));
    }
}

/// Whether the lab shows one transition in place of the walk.
fn shows_jump(session: &Session) -> bool {
    session.params().jump().is_some()
}

/// Plays one transition, also where all stands still: whoever asks for it wants to see it. The walk
/// is kept where it is.
fn open_jump(jump: [Place; 2], session: &Session, state: &mut UiState, out: &mut Out) {
    if !shows_jump(session) {
        state.walk_secs = session.now_secs();
    }
    out.set_once(Key::Jump, List::Jump(Some(jump)).into());
    out.commands.push(Command::Playback(PlaybackCommand::Seek(0.0)));
    out.set(Key::Play, Value::Switch(true));
}

/// Goes back to the walk, where it was.
fn close_jump(state: &UiState, out: &mut Out) {
    out.reset(Key::Jump);
    out.set(Key::Time, Value::Number(state.walk_secs.clamp(0.0, 3600.0)));
}

/// Returns what a clip of a graph is called.
fn clip_title(built: &Built, clip: usize, session: &Session) -> Message {
    let name = built.cast().names().get(clip);
    name.map(|name| session.clip_title(name)).unwrap_or_default()
}

/// Returns a clip's name and the frame.
fn named(built: &Built, place: Place, session: &Session) -> Message {
    text::frame_in_words(clip_title(built, place.clip, session), place.frame)
}

/// A transition in words, with its probability where it is walked.
fn jump_words(
    built: &Built,
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
fn no_way(built: &Built, (secs, clip): (f64, usize), session: &Session) -> Message {
    text::no_way(clip_title(built, clip, session), secs)
}
