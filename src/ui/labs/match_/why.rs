//! Why this frame: the candidates of the last search, with their costs by feature block.

use super::present::shown;
use crate::ui::kit::{self, CostBars, CostRow};
use crate::ui::language::{Word, say};
use crate::ui::out::Out;
use crate::ui::rows::{Detail, param_row_ui};
use crate::ui::state::UiState;
use crate::ui::text;
use crate::ui::theme::{Palette, Type, palette_of, space, theme_of};
use eframe::egui::{Color32, RichText, Ui};
use segue_motion::matching::{Block, Candidate, Database};
use segue_session::{Key, Session};
use segue_text::Message;

/// Returns the colours of the feature blocks, in their order.
pub(crate) fn block_colors(palette: &Palette) -> [Color32; Block::COUNT] {
    [palette.a, palette.warning, palette.others[0], palette.others[1], palette.others[2]]
}

/// Returns a frame in words: its clip and its time.
pub(crate) fn place_name(database: &Database, candidate: &Candidate, session: &Session) -> Message {
    let place = candidate.place;
    let Some(motion) = database.motion(place.motion) else {
        return Message::default();
    };
    text::frame_of_clip(
        session.clip_title(motion.clip().name()),
        motion.is_mirrored(),
        motion.clip().time_of(place.frame),
    )
}

/// Draws the rows of the section.
pub(crate) fn why_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    state.labs.match_.hovered = None;
    let palette = palette_of(ui);
    ui.label(RichText::new(say(text::WHY, ui)).font(theme_of(ui).font(Type::Strong)));
    let search =
        shown(session).and_then(|(driven, moment)| Some((driven, moment.search.as_ref()?)));
    let Some((driven, search)) = search else {
        kit::note_ui(text::NO_SEARCH, palette.muted, ui);
        return;
    };
    let database = &driven.database;
    let row = |name: Message, candidate: &Candidate, strong: bool, shown: bool| CostRow {
        name,
        parts: candidate.split.to_vec(),
        strong,
        shown,
    };
    let place = place_name(database, &search.current, session);
    let current = row(text::going_on(place), &search.current, true, false);
    let found = search.candidates.iter().enumerate().map(|(index, candidate)| {
        row(
            place_name(database, candidate, session),
            candidate,
            index == 0 && search.held.is_none(),
            state.labs.match_.chosen == Some(index),
        )
    });
    let rows: Vec<CostRow> = std::iter::once(current).chain(found).collect();
    let colors = block_colors(palette);
    let parts: Vec<(Word, Color32)> =
        Block::ALL.iter().map(|block| text::block(*block)).zip(colors).collect();
    let response = kit::cost_bars_ui(&CostBars { rows: &rows, parts: &parts }, ui);
    // The first row is the frame that was left: it has no ghost.
    state.labs.match_.hovered = response.hovered.and_then(|row| row.checked_sub(1));
    if let Some(clicked) = response.clicked {
        let clicked = clicked.checked_sub(1);
        state.labs.match_.chosen = clicked.filter(|index| state.labs.match_.chosen != Some(*index));
    }
    ui.add_space(space::XS);
    let words = text::searched(search, database.valid().len());
    kit::note_ui(&words, palette.muted, ui);
    kit::note_ui(text::GHOST_HELP, palette.muted, ui);
    param_row_ui(Key::ShownCandidates, &Detail::default(), session, out, ui);
}
