//! The strip below the stage: the numbers of every pane, in the same places below each, or the
//! reason why a pane has none.

use super::columns::shown_panes;
use super::explanation::{Explained, explanation_ui};
use super::pane::{problem_below, problem_height, problem_ui};
use crate::ui::kit::{self, Button, GridRoom, Icon, Metric, MetricGrid, Rank};
use crate::ui::language::Word;
use crate::ui::out::Out;
use crate::ui::state::{Layout, StripState, UiState};
use crate::ui::text;
use crate::ui::theme::{HIT, palette_of, space, theme_of};
use eframe::egui::accesskit::Role;
use eframe::egui::{Pos2, Rect, ScrollArea, Stroke, Ui, UiBuilder, pos2, vec2};
use segue_session::metrics::{MetricId, MetricRow, Unit};
use segue_session::{Key, Pane, Session, listed_metrics};

/// The least height of a row that is touched by a finger, points.
const TOUCHED: f32 = 44.0;
/// The least width of a row with a full name and a number, points at a desk.
const LIST_WIDTH: f32 = 230.0;
/// The least number that is written as a power of ten.
const MAX_IN_FULL: f64 = 1e5;
/// The largest share of the stage that the list of all numbers takes; beyond, it scrolls.
const MAX_SHARE: f32 = 0.5;

/// The strip of one frame, before it is drawn: the stage above it needs its height.
pub(super) struct Strip {
    place: Rect,
    panes: Vec<(usize, Rect)>,
    listed: Vec<MetricId>,
    grid: MetricGrid,
    has_more: bool,
}

impl Strip {
    /// Lays the strip out in the lower part of `whole`.
    pub(super) fn new(
        session: &Session,
        whole: Rect,
        layout: Layout,
        state: &mut UiState,
        ui: &Ui,
    ) -> Self {
        let panes = session.panes();
        let shown = shown_panes(session, whole, layout, state);
        let width = shown.first().map_or(0.0, |(_, rect)| rect.width());
        let of = (Some(session.params().lab()), shown.len(), width);
        if state.strip.of != of {
            let is_open = state.strip.is_open;
            state.strip = StripState { is_open, of, ..StripState::default() };
        }
        let listed = listed_metrics(panes.iter().filter_map(|pane| pane.outcome.as_deref()));
        // While results are made again or refused, the places of their numbers stay.
        if !listed.is_empty() {
            state.strip.listed = listed;
        }
        let listed = state.strip.listed.clone();
        let (grid, has_more) = grid_of(session, &listed, width, shown.len(), layout, ui);
        let is_open = state.strip.is_open && has_more;
        let numbers = match (listed.is_empty(), is_open) {
            (true, _) => 0.0,
            (false, false) => grid.height(),
            (false, true) => {
                let all = List::new(listed.len(), width, layout, ui).height();
                all.min(MAX_SHARE * whole.height())
            }
        };
        let room = width - 2.0 * margin().x - if has_more { more_width(ui) } else { 0.0 };
        let problems = shown.iter().filter_map(|(index, _)| problem_below(panes.get(*index)?));
        let problems = problems.map(|problem| problem_height(problem, room, ui));
        let content = numbers.max(problems.fold(state.strip.problems, f32::max));
        let mut height = if content > 0.0 { content + 2.0 * space::S } else { 0.0 };
        // A figure must not move under the hand because a number comes or goes.
        if ui.input(|input| input.pointer.any_down()) {
            height = height.max(state.strip.height);
        }
        height = height.ceil().min(MAX_SHARE * whole.height() + 2.0 * space::S);
        state.strip.height = height;
        let place = whole.with_min_y(whole.bottom() - height);
        Self { place, panes: shown, listed, grid, has_more }
    }

    /// Returns the height.
    pub(super) fn height(&self) -> f32 {
        self.place.height()
    }

    /// Draws the strip.
    pub(super) fn show(
        &self,
        session: &Session,
        layout: Layout,
        state: &mut UiState,
        out: &mut Out,
        ui: &mut Ui,
    ) {
        if self.place.height() <= 0.0 {
            return;
        }
        let palette = palette_of(ui);
        let line = Stroke::new(theme_of(ui).hairline(), palette.line);
        ui.painter().hline(self.place.x_range(), self.place.top(), line);
        for (_, pane) in self.panes.iter().skip(1) {
            ui.painter().vline(pane.left(), self.place.y_range(), line);
        }
        let builder = UiBuilder::new().id_salt("numbers").max_rect(self.place);
        ui.scope_builder(builder, |ui| {
            kit::set_role(Role::Group, text::NUMBERS, ui);
            ui.set_clip_rect(self.place.intersect(ui.clip_rect()));
            self.problems_ui(session, state, out, ui);
            if state.strip.is_open && self.has_more {
                self.list_ui(session, layout, out, ui);
            } else {
                self.grid_ui(session, out, ui);
            }
            if self.has_more {
                self.more_ui(state, ui);
            }
        });
    }

    /// Returns the part of the strip below a pane.
    fn below(&self, pane: Rect) -> Rect {
        Rect::from_x_y_ranges(pane.x_range(), self.place.y_range()).shrink2(margin())
    }

    /// Draws the reasons of panes without a result in the places of their numbers.
    fn problems_ui(&self, session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
        let mut height = 0.0_f32;
        for &(index, rect) in &self.panes {
            let pane = session.panes().get(index);
            let Some((pane, problem)) = pane.and_then(|pane| Some((pane, problem_below(pane)?)))
            else {
                continue;
            };
            let mut place = self.below(rect);
            place.max.x -= if self.has_more { more_width(ui) } else { 0.0 };
            let builder = UiBuilder::new().id_salt(("problem", index)).max_rect(place);
            let shown = ui.scope_builder(builder, |ui| problem_ui(problem, pane, session, out, ui));
            height = height.max(shown.response.rect.height());
        }
        if (state.strip.problems - height).abs() > 0.5 {
            state.strip.problems = height;
            ui.request_repaint();
        }
    }

    /// Returns the panes whose numbers are shown, and the parts of the strip below them.
    fn measured<'a>(
        &'a self,
        session: &'a Session,
    ) -> impl Iterator<Item = (usize, &'a Pane, Rect)> {
        self.panes.iter().filter_map(|&(index, rect)| {
            let pane = session.panes().get(index)?;
            problem_below(pane).is_none().then(|| (index, pane, self.below(rect)))
        })
    }

    fn grid_ui(&self, session: &Session, out: &mut Out, ui: &mut Ui) {
        for (index, pane, place) in self.measured(session) {
            for (at, &id) in self.listed.iter().take(self.grid.shown).enumerate() {
                let rect = self.grid.place(at, place.min);
                number_ui(kit::metric_cell_ui, id, index, pane, rect, session, out, ui);
            }
        }
    }

    fn list_ui(&self, session: &Session, layout: Layout, out: &mut Out, ui: &mut Ui) {
        let inner = self.place.shrink2(vec2(0.0, space::S));
        let width = self.panes.first().map_or(0.0, |(_, rect)| rect.width());
        let list = List::new(self.listed.len(), width, layout, ui);
        let builder = UiBuilder::new().id_salt("all numbers").max_rect(inner);
        ui.scope_builder(builder, |ui| {
            let scrolled = ScrollArea::vertical().auto_shrink(false).max_height(inner.height());
            scrolled.show(ui, |ui| {
                let (_, space) = ui.allocate_space(vec2(ui.available_width(), list.height()));
                for (index, pane, place) in self.measured(session) {
                    for (at, &id) in self.listed.iter().enumerate() {
                        let rect = list.place(at, pos2(place.left(), space.top()));
                        number_ui(kit::metric_row_ui, id, index, pane, rect, session, out, ui);
                    }
                }
            });
        });
    }

    /// Draws the button that opens and closes the list of all numbers.
    fn more_ui(&self, state: &mut UiState, ui: &mut Ui) {
        let side = more_width(ui);
        let rect = Rect::from_min_size(
            pos2(self.place.right() - side - 2.0, self.place.top() + space::S),
            vec2(side, side),
        );
        let (icon, name) = if state.strip.is_open {
            (Icon::ChevronDown, text::FEWER_NUMBERS)
        } else {
            (Icon::ChevronUp, text::ALL_NUMBERS)
        };
        ui.scope_builder(UiBuilder::new().id_salt("more").max_rect(rect), |ui| {
            if kit::button_ui(Button::icon_only(icon, name).selected(state.strip.is_open), ui)
                .clicked()
            {
                state.strip.is_open = !state.strip.is_open;
            }
        });
    }
}

/// Returns the margin of the numbers below a pane.
fn margin() -> eframe::egui::Vec2 {
    vec2(space::M, space::S)
}

/// Returns the width of the button for all numbers.
fn more_width(ui: &Ui) -> f32 {
    theme_of(ui).row_height()
}

/// Returns the grid of the numbers, and whether there are more than it shows.
fn grid_of(
    session: &Session,
    listed: &[MetricId],
    width: f32,
    panes: usize,
    layout: Layout,
    ui: &Ui,
) -> (MetricGrid, bool) {
    let is_narrow = panes > 1 || layout == Layout::Phone;
    let names: Vec<(Word, Word)> =
        listed.iter().map(|id| (Word::new(id.row().short), unit_of(id.row()))).collect();
    let room = GridRoom {
        width: width - 2.0 * margin().x,
        rows: if is_narrow && !session.params().is_on(Key::Embed) { 2 } else { 1 },
        is_ranked: session.panes().len() > 1,
        least_height: if layout == Layout::Phone { TOUCHED } else { HIT },
    };
    let grid = MetricGrid::new(&names, room, ui);
    if grid.shown >= listed.len() {
        return (grid, false);
    }
    let beside = GridRoom { width: room.width - more_width(ui), ..room };
    (MetricGrid::new(&names, beside, ui), true)
}

/// The list of all numbers of a pane: rows in one column or several.
struct List {
    rows: usize,
    width: f32,
    row_height: f32,
}

impl List {
    fn new(count: usize, pane_width: f32, layout: Layout, ui: &Ui) -> Self {
        let theme = theme_of(ui);
        let width = pane_width - 2.0 * margin().x - more_width(ui);
        let columns = ((width + space::L) / (LIST_WIDTH * theme.scale() + space::L)).floor();
        let columns = columns.clamp(1.0, 4.0);
        let gaps = (columns - 1.0) * space::L * 2.0;
        let least = if layout == Layout::Phone { TOUCHED } else { 0.0 };
        Self {
            rows: count.div_ceil(columns as usize),
            width: ((width - gaps) / columns).floor(),
            row_height: (HIT * theme.scale()).round().max(least),
        }
    }

    fn height(&self) -> f32 {
        self.rows as f32 * self.row_height
    }

    /// Returns the place of a number: the list goes down, and then on at the right.
    fn place(&self, index: usize, origin: Pos2) -> Rect {
        let (column, row) = (index / self.rows.max(1), index % self.rows.max(1));
        let at = vec2(column as f32 * (self.width + 2.0 * space::L), row as f32 * self.row_height);
        Rect::from_min_size(origin + at, vec2(self.width, self.row_height))
    }
}

/// A way to draw a metric.
type DrawMetric = fn(&Metric<'_>, Rect, eframe::egui::Id, &Ui) -> eframe::egui::Response;

/// Draws a number of a pane, and its explanation while that is open.
#[expect(clippy::too_many_arguments, reason = "one place draws numbers in both forms")]
fn number_ui(
    draw: DrawMetric,
    id: MetricId,
    index: usize,
    pane: &Pane,
    rect: Rect,
    session: &Session,
    out: &mut Out,
    ui: &mut Ui,
) {
    let row = id.row();
    let measured = pane.outcome.as_deref().and_then(|outcome| outcome.metric(id));
    let number = measured.and_then(|metric| metric.value);
    let value = written(row, number);
    // The dash of a number that there is not has no unit.
    let unit = if number.is_some() { unit_of(row) } else { Word::default() };
    let rank = rank_of(session.panes(), row, index);
    let metric = Metric {
        value: &value,
        unit,
        name: Word::new(row.label),
        short: Word::new(row.short),
        rank,
        is_faded: pane.is_outdated(),
        hint: Word::new(row.help),
    };
    let response = draw(&metric, rect, ui.make_persistent_id(("metric", index, id)), ui);
    let at_secs = measured.and_then(|metric| metric.at_secs);
    let explained = Explained { row, value: &value, unit, rank, at_secs, pane };
    explanation_ui(&response, &explained, session, out, ui);
}

/// Returns the rank of a pane's number among those of all panes.
fn rank_of(panes: &[Pane], row: &MetricRow, index: usize) -> Rank {
    let ends = super::verdicts::ends(panes, row);
    if ends.best == Some(index) {
        Rank::Best
    } else if ends.worst == Some(index) {
        Rank::Worst
    } else {
        Rank::Middle
    }
}

/// Returns the unit that is written behind a number: degrees have their sign in it, and the name of
/// a number of frames says what is counted.
fn unit_of(row: &MetricRow) -> Word {
    match row.unit {
        Unit::Degrees | Unit::Count => Word::default(),
        Unit::Frames if row.label.starts_with("Frames") => Word::default(),
        unit => Word::new(unit.text()),
    }
}

/// Returns the value of a metric as short text.
fn written(row: &MetricRow, value: Option<f64>) -> String {
    let Some(value) = value else {
        return "–".to_owned();
    };
    let decimals = row.unit.decimals(value);
    let degree = if row.unit == Unit::Degrees { "°" } else { "" };
    let digits = if value.abs() < MAX_IN_FULL {
        format!("{value:.decimals$}")
    } else {
        format!("{value:.1e}")
    };
    // A number that rounds to zero has no sign.
    let is_zero = digits.bytes().all(|byte| matches!(byte, b'-' | b'0' | b'.'));
    let digits = if is_zero { digits.trim_start_matches('-') } else { &digits };
    format!("{}{degree}", digits.replace('-', "−"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn number_too_large_for_its_place_is_a_power_of_ten() {
        let row = MetricId::FootSlide.row();
        let cases =
            [(9.24, "9.2"), (-0.01, "0.0"), (-3.0, "−3.0"), (1e6, "1.0e6"), (-2e18, "−2.0e18")];
        for (value, text) in cases {
            assert_eq!(written(row, Some(value)), text);
        }
        assert_eq!(written(row, None), "–");
    }
}
