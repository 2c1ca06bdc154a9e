//! The bottom panel: the walk in time, and the graph as bars and arcs.

use super::jump::{jump_words, named, no_way, open_jump, point_at};
use super::rows;
use crate::ui::kit::{self, Moment, Strip, Timeline, TimelineEvent};
use crate::ui::out::Out;
use crate::ui::state::{Layout, UiState};
use crate::ui::text;
use crate::ui::theme::{palette_of, space};
use crate::ui::transport_row::{Playhead, transport_row_ui};
use eframe::egui::Ui;
use segue_motion::graph::Place;
use segue_session::{Command, Key, PlaybackCommand, Session, Value, Walk, frame_at};
use segue_text::Message;
use std::sync::Arc;

/// The greatest number of marks: more could not be told apart.
const MAX_SEAMS: usize = 160;

/// The time for which a visit that failed is explained, seconds of the walk.
const TOLD_SECS: f64 = 5.0;

/// Draws the panel of a walk.
pub(crate) fn walk_panel_ui(
    session: &Session,
    walk: &Arc<Walk>,
    layout: Layout,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    let caption = caption(session, walk, state);
    let playhead = Playhead {
        secs: session.now_secs(),
        frame: frame_at(&walk.motion, session.now_secs()),
        frames: walk.motion.clip().frames(),
    };
    transport_row_ui(playhead, &caption, layout, session, out, ui);
    if layout != Layout::Phone {
        time_ui(session, walk, out, ui);
    }
    strip_ui(session, walk, state, out, ui);
}

/// Draws the timeline, with a mark where the walk changes clips.
fn time_ui(session: &Session, walk: &Walk, out: &mut Out, ui: &mut Ui) {
    let palette = palette_of(ui);
    let fps = walk.motion.clip().fps();
    let mut seams: Vec<Moment> = (walk.passed.iter())
        .filter(|passed| passed.seam.is_some())
        .map(|passed| Moment {
            time: passed.start as f64 / fps,
            color: palette.accent,
            name: text::SEAM,
        })
        .filter(|moment| moment.time < walk.motion.clip().duration_secs())
        .collect();
    if seams.len() > MAX_SEAMS {
        seams.clear();
    }
    let timeline = Timeline {
        duration: session.duration_secs(),
        now: session.now_secs(),
        fps,
        in_point: session.params().optional(Key::In),
        out_point: session.params().optional(Key::Out),
        moments: &seams,
        ..Timeline::default()
    };
    for event in kit::timeline_ui(&timeline, ui).events {
        match event {
            TimelineEvent::Seek(secs) => {
                out.commands.push(Command::Playback(PlaybackCommand::Seek(secs)));
            }
            TimelineEvent::ScrubStarted => out.set(Key::Play, Value::Switch(false)),
            TimelineEvent::SetIn(secs) => out.set(Key::In, Value::Number(secs)),
            TimelineEvent::SetOut(secs) => out.set(Key::Out, Value::Number(secs)),
            TimelineEvent::EditEnded => out.commands.push(Command::Settle),
            _ => {}
        }
    }
}

fn strip_ui(session: &Session, walk: &Arc<Walk>, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    let Some(built) = session.graph_built() else {
        return;
    };
    let drawn = state.labs.graph.drawing.of(session);
    let (clips, set) = (built.clips(), built.clips().set());
    let bars: Vec<(Message, usize)> = clips
        .names()
        .iter()
        .enumerate()
        .map(|(clip, name)| (session.clip_title(name), set.frames_of(clip)))
        .collect();
    let at = walk.at(session.now_secs()).filter(|_| Arc::ptr_eq(&walk.built, built));
    let lit_stretch = at.and_then(|at| {
        let graph = built.graph();
        let stretch = graph.graph().node_weight(graph.node_at(at.place)?)?;
        let from = set.number(Place { clip: stretch.clip, frame: stretch.start })?;
        Some([from, from + stretch.end - stretch.start])
    });
    let strip = Strip {
        label: text::GRAPH_STRIP,
        bars: &bars,
        stretches: drawn.as_ref().map_or(&[], |drawn| &drawn.stretches),
        arcs: drawn.as_ref().map_or(&[], |drawn| &drawn.arcs),
        drawn: drawn.as_ref().map_or(&[], |drawn| &drawn.drawn_arcs),
        now: at.and_then(|at| set.number(at.place)),
        lit_stretch,
        lit_arc: drawn.as_ref().and_then(|drawn| {
            drawn.pointed_or_lit(state.labs.graph.last_jump, Some(walk), session.now_secs())
        }),
    };
    let height = (ui.available_height() - space::XS).max(40.0);
    let response = kit::strip_ui(&strip, height, ui);
    let ends = |arc| drawn.as_ref()?.ends_in(built, arc);
    if let Some(ends) = response.hovered_arc.and_then(ends) {
        point_at(ends, Some(walk), state);
    }
    if let Some(ends) = response.clicked_arc.and_then(ends) {
        open_jump(ends, session, state, out);
    }
    if let Some(clip) = response.clicked_bar {
        rows::go_to(clip, session, out);
    }
}

/// Returns the transition under the pointer, else why a visit failed, else the transition that
/// plays, else the present frame.
fn caption(session: &Session, walk: &Walk, state: &UiState) -> Message {
    let built = session.graph_built();
    let pointed =
        state.labs.graph.last_jump.and_then(|ends| jump_words(built?, Some(walk), ends, session));
    if let Some(words) = pointed {
        return words;
    }
    let now = session.now_secs();
    let told = |(secs, _): &&(f64, usize)| (0.0..TOLD_SECS).contains(&(now + 0.05 - secs));
    if let Some(&missed) = walk.missed.iter().rev().find(told) {
        return no_way(&walk.built, missed, session);
    }
    let Some(at) = walk.at(now) else {
        return Message::default();
    };
    let seam =
        walk.passed.get(at.stay).and_then(|passed| passed.seam).filter(|_| at.left.is_some());
    if let Some(seam) = seam {
        let ends = [seam.leave, seam.enter];
        return jump_words(&walk.built, Some(walk), ends, session).unwrap_or_default();
    }
    named(&walk.built, at.place, session)
}
