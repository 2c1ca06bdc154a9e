//! The Graph lab: the clips and the parameters of graph and walk, the picture of all distances, the
//! graph as bars and arcs, and the table of numbers.

mod clips;
mod drawing;
mod jump;
mod map;
mod rows;
mod strip;
mod table;

pub(crate) use drawing::DrawingCache;
pub(crate) use map::{is_open, map_panel_ui, map_share, map_ui};
pub(crate) use rows::{compare_windows, graph_ui, seed_detail};
pub(crate) use strip::walk_panel_ui;

use self::jump::clip_title;
use crate::ui::labs::lab_ui::{Compares, LabUi, Shown, Title};
use crate::ui::out::Out;
use crate::ui::rows::KeepOffer;
use crate::ui::state::UiState;
use crate::ui::text;
use glam::DVec2;
use segue_session::{Command, Key, List, PlaybackCommand, Session, Walk};
use segue_text::msg;

/// The lab's part of the page.
pub(super) const LAB: LabUi = LabUi {
    panel_ui: graph_ui,
    about: [text::GRAPH_ABOUT, text::GRAPH_DETAILS],
    kept: |_, pane| KeepOffer::result(pane),
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

/// Lets the walk follow the line that was drawn, from its beginning.
fn take_line(points: &[DVec2], _: &Session, _: &mut UiState, out: &mut Out) {
    if points.len() > 1 {
        // Rounded to the centimetre, as in the link.
        let points = points.iter().map(|point| (point * 100.0).round() / 100.0).collect();
        out.set_once(Key::WalkPath, List::GroundPath(points).into());
        out.commands.push(Command::Playback(PlaybackCommand::Seek(0.0)));
    }
}
