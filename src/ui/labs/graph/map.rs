//! The distances of all windows as a picture, with the transitions on it.

use super::jump::{jump_words, named, open_jump, point_at};
use super::{clips, table};
use crate::ui::clip_drag::clip_dropped_on;
use crate::ui::kit::{self, Matrix, TILE, Tile};
use crate::ui::out::Out;
use crate::ui::state::UiState;
use crate::ui::text;
use crate::ui::theme::{palette_of, space, theme_of};
use eframe::egui::{Color32, ColorImage, ScrollArea, TextureHandle, TextureOptions, Ui};
use segue_motion::graph::{DistanceDetail, Place};
use segue_session::LabId;
use segue_session::{DistanceField, Distances, Session};
use segue_text::Message;
use std::sync::Arc;

/// Returns the map's share of the room beside the parameters.
pub(crate) fn map_share(session: &Session) -> f32 {
    if session.panes().len() > 1 { 0.38 } else { 0.52 }
}

/// Draws the map beside the stage, and the numbers of several panes below it.
pub(crate) fn map_panel_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    let several = session.panes().len() > 1;
    let (room, below) = (ui.available_height(), 60.0 * theme_of(ui).scale());
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        map_ui(session, if several { 0.6 * room } else { room - below }, state, out, ui);
        if several {
            ui.add_space(space::S);
            table::table_ui(session, out, ui);
        }
    });
}

/// Draws the map, the legend, and the transition or the windows under the pointer in words.
pub(crate) fn map_ui(
    session: &Session,
    most_height: f32,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    let palette = palette_of(ui);
    let Some(graph_clips) = session.graph_clips() else {
        kit::note_ui(text::EMPTY_PANE, palette.muted, ui);
        return;
    };
    // A pane keeps its last graph while the next one is built, which may be that of other clips.
    let built = session.graph_built().filter(|built| Arc::ptr_eq(built.clips(), graph_clips));
    let walk = session.graph_walk().filter(|_| built.is_some());
    let Some(field) = session.graph_field() else {
        return;
    };
    let drawn = built.and_then(|_| state.labs.graph.drawing.of(session));
    let set = graph_clips.set();
    let parts: Vec<(usize, Message)> = (graph_clips.names().iter().enumerate())
        .filter_map(|(clip, name)| {
            Some((set.number(Place { clip, frame: 0 })?, session.clip_title(name)))
        })
        .collect();
    let lit = drawn.as_ref().and_then(|drawn| {
        drawn.pointed_or_lit(
            state.labs.graph.last_jump,
            walk.map(|walk| &**walk),
            session.now_secs(),
        )
    });
    let now = walk.and_then(|walk| walk.at(session.now_secs())).and_then(|at| set.number(at.place));
    let matrix = Matrix {
        label: text::ALL_DISTANCES,
        size: set.frames(),
        known: match field.distances() {
            Distances::Held(_) => 1,
            Distances::Overview(overview) => overview.block(),
        },
        parts: &parts,
        marks: drawn.as_ref().map_or(&[], |drawn| &drawn.marks),
        lit,
        now: now.map(|number| number as f32),
    };
    let mut tiles = Tiles::of(field, ui);
    let ctx = ui.ctx().clone();
    let mut texture = |tile| tiles.texture(tile, &ctx);
    let shown = ui.scope(|ui| kit::matrix_ui(&matrix, most_height, &mut texture, ui));
    let (response, place) = (shown.inner, shown.response.rect);
    if let Some(id) = clip_dropped_on(place, session, text::add_to_list, ui) {
        clips::add_clip(id, session, out);
    }
    let high_cm = tiles.high_cm;
    tiles.keep(ui);
    kit::heat_legend_ui(&text::heat_ends(high_cm), ui);
    let mut words = Message::from(text::MATRIX_HELP);
    if let Some(built) = built {
        let ends = |mark| drawn.as_ref()?.ends_in(built, mark);
        if let Some(ends) = response.hovered.and_then(ends) {
            point_at(ends, walk.map(|walk| &**walk), state);
            words = jump_words(built, walk.map(|walk| &**walk), ends, session).unwrap_or_default();
        } else if let Some([row, column]) = response.at {
            let place = |at: f32| set.place(at.max(0.0) as usize);
            if let (Some(leave), Some(enter)) = (place(row), place(column)) {
                words = text::windows_apart(
                    [leave, enter].map(|place| named(built, place, session)),
                    field.cm(leave, enter),
                );
            }
        }
        if let Some(ends) = response.clicked.and_then(ends) {
            open_jump(ends, session, state, out);
        }
    }
    kit::note_ui(&words, palette.muted, ui);
}

/// The tiles that were made of a field in the colours of a theme.
#[derive(Clone)]
struct Tiles {
    field: Arc<DistanceField>,
    heat: [Color32; 5],
    made: Vec<(Tile, TextureHandle)>,
    /// A tile that is computed over several frames, and whether it is still in sight.
    begun: Option<(Tile, Arc<DistanceDetail>, bool)>,
    /// The distance at the upper end of the colours, centimetres.
    high_cm: f64,
    /// Cells that may still be read in this frame.
    budget: usize,
}

/// Tiles on the graphics card at once, 256 KB each.
const MAX_TILES: usize = 128;
/// Cells that may be read in a frame.
const PER_FRAME: usize = 500_000;
/// The cost of computing 256 × 256 cells, in cells that are read.
const COMPUTED: usize = 250_000;

impl Tiles {
    fn of(field: &Arc<DistanceField>, ui: &Ui) -> Self {
        let heat = palette_of(ui).heat;
        let known: Option<Self> = ui.data(|data| data.get_temp(kit::tiles_id()));
        if let Some(mut known) = known
            && Arc::ptr_eq(&known.field, field)
            && known.heat == heat
        {
            known.budget = PER_FRAME;
            return known;
        }
        let counts = field.histogram();
        let all: u64 = counts.iter().map(|&count| u64::from(count)).sum();
        let mut before = 0;
        // The few worst pairs would leave no contrast for the others.
        let bin = counts.iter().position(|&count| {
            before += u64::from(count);
            before * 100 >= all * 95
        });
        Self {
            field: Arc::clone(field),
            heat,
            made: Vec::new(),
            begun: None,
            high_cm: (bin.unwrap_or(0) + 1) as f64 * field.bin_cm(),
            budget: PER_FRAME,
        }
    }

    fn texture(
        &mut self,
        tile: Tile,
        ctx: &eframe::egui::Context,
    ) -> Option<eframe::egui::TextureId> {
        if let Some(at) = self.made.iter().position(|(known, _)| *known == tile) {
            // The tile that was used last is removed last.
            let used = self.made.remove(at);
            let id = used.1.id();
            self.made.push(used);
            return Some(id);
        }
        if self.budget == 0 {
            ctx.request_repaint();
        }
        let cells = TILE * tile.factor;
        let field = Arc::clone(&self.field);
        let frames = match field.distances() {
            Distances::Held(distances) => distances.set().frames(),
            Distances::Overview(overview) => overview.set().frames(),
        };
        let range = |at: usize| (at * cells).min(frames)..((at + 1) * cells).min(frames);
        let (rows, columns) = (range(tile.row), range(tile.column));
        if rows.is_empty() || columns.is_empty() {
            return None;
        }
        let size = [columns.len().div_ceil(tile.factor), rows.len().div_ceil(tile.factor)];
        let cm = match field.distances() {
            Distances::Overview(overview) if tile.factor < overview.block() => {
                let detail = || overview.detail(rows, columns, tile.factor);
                self.computed(tile, detail, ctx)?
            }
            _ if self.budget == 0 => return None,
            Distances::Overview(overview) => {
                let blocks = tile.factor / overview.block();
                self.budget = self.budget.saturating_sub(TILE * TILE * blocks.pow(2));
                overview.picture(rows, columns, tile.factor)
            }
            Distances::Held(distances) => {
                self.budget = self.budget.saturating_sub(TILE * TILE * tile.factor.min(4).pow(2));
                distances.picture(rows, columns, tile.factor)
            }
        };
        let (per_cm, shades) = ((self.high_cm as f32).recip(), kit::Shades::new(&self.heat));
        let colors = cm
            .into_iter()
            .map(|cm| if cm.is_nan() { Color32::TRANSPARENT } else { shades.at(cm * per_cm) });
        let image = ColorImage::new(size, colors.collect());
        let options =
            if tile.factor == 1 { TextureOptions::NEAREST } else { TextureOptions::LINEAR };
        let texture = ctx.load_texture("distances", image, options);
        let id = texture.id();
        if self.made.len() >= MAX_TILES {
            drop(self.made.remove(0));
        }
        self.made.push((tile, texture));
        Some(id)
    }

    /// Computes a part of a new tile in this frame; returns its distances when it is complete. One
    /// tile follows the other, so that the first is soon in sight.
    fn computed(
        &mut self,
        tile: Tile,
        detail: impl FnOnce() -> DistanceDetail,
        ctx: &eframe::egui::Context,
    ) -> Option<Vec<f32>> {
        ctx.request_repaint();
        if self.begun.as_ref().is_some_and(|(known, ..)| *known != tile) {
            return None;
        }
        let (_, mut detail, _) =
            self.begun.take().unwrap_or_else(|| (tile, Arc::new(detail()), true));
        let mut is_complete = false;
        while self.budget > 0 && !is_complete {
            self.budget = self.budget.saturating_sub(COMPUTED);
            is_complete = Arc::make_mut(&mut detail).advance(1).is_complete();
        }
        if !is_complete {
            self.begun = Some((tile, detail, true));
            return None;
        }
        Some(detail.picture().to_vec())
    }

    fn keep(mut self, ui: &Ui) {
        // A tile out of sight makes room for another.
        self.begun =
            self.begun.filter(|(.., seen)| *seen).map(|(tile, detail, _)| (tile, detail, false));
        ui.data_mut(|data| data.insert_temp(kit::tiles_id(), self));
    }
}

/// Returns whether the lab is open.
pub(crate) fn is_open(session: &Session) -> bool {
    session.params().lab() == LabId::Graph
}
