//! Metrics: numbers with their names below, in columns, or in rows with their names beside. Each is
//! a button that explains it.

use super::assistive::describe;
use super::paint::{Run, focus_ring, line_of, put};
use super::words;
use crate::ui::language::{Text, Word, say};
use crate::ui::theme::{Type, palette_of, radius, space, theme_of};
use eframe::egui::{
    Align2, Color32, CursorIcon, Galley, Id, Pos2, Rect, Response, Role, Sense, Ui, WidgetInfo,
    pos2, vec2,
};
use std::sync::Arc;

/// The rank of a number among the same one of all panes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Rank {
    /// In between, or there is nothing to compare with.
    #[default]
    Middle,
    /// The best of all.
    Best,
    /// The worst of all.
    Worst,
}

impl Rank {
    /// Returns the word of the rank; empty in between.
    pub(crate) fn word(self) -> Word {
        match self {
            Self::Middle => Word::default(),
            Self::Best => words::BEST,
            Self::Worst => words::WORST,
        }
    }

    /// Returns the colour of a number of this rank.
    pub(crate) fn ink(self, ui: &Ui) -> Color32 {
        let palette = palette_of(ui);
        match self {
            Self::Middle => palette.text,
            Self::Best => palette.good,
            Self::Worst => palette.bad,
        }
    }
}

/// One measured number.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Metric<'a> {
    /// The number as text, with its sign and degree sign; a dash where there is none.
    pub(crate) value: &'a str,
    /// Its unit; empty for none, and for degrees.
    pub(crate) unit: Word,
    /// Its name.
    pub(crate) name: Word,
    /// Its name where there is little room.
    pub(crate) short: Word,
    /// Its rank.
    pub(crate) rank: Rank,
    /// Whether it is of an earlier result.
    pub(crate) is_faded: bool,
    /// Its meaning in a sentence, for the hint.
    pub(crate) hint: Word,
}

impl Metric<'_> {
    /// Returns the number with its unit, and the word of its rank.
    fn said(&self, ui: &Ui) -> String {
        let parts = [self.name.into(), Text::Data(self.value), self.unit.into()];
        let parts = parts.into_iter().chain([self.rank.word().into()]);
        let parts = parts.filter(|part| !part.is_empty()).map(|part| say(part, ui));
        parts.collect::<Vec<_>>().join(" ")
    }

    fn ink(&self, ui: &Ui) -> Color32 {
        if self.is_faded { palette_of(ui).muted } else { self.rank.ink(ui) }
    }
}

/// The columns of a grid of metrics, which are the same in every pane.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct MetricGrid {
    /// The number of metrics with a place.
    pub(crate) shown: usize,
    /// The number of rows.
    pub(crate) rows: usize,
    widths: Vec<f32>,
    row_height: f32,
}

/// The room for a [`MetricGrid`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct GridRoom {
    /// The width of a pane.
    pub(crate) width: f32,
    /// The greatest number of rows.
    pub(crate) rows: usize,
    /// Whether there are ranks.
    pub(crate) is_ranked: bool,
    /// The least height of a row.
    pub(crate) least_height: f32,
}

/// The widest number for which a column has room: most metrics have no more digits.
const WIDEST: &str = "00.0";

impl MetricGrid {
    /// Places as many metrics, from the first on, as there is room for; at least one in each row.
    /// The places depend on names and units alone, so that changing numbers do not move.
    pub(crate) fn new(metrics: &[(Word, Word)], room: GridRoom, ui: &Ui) -> Self {
        let theme = theme_of(ui);
        let width = |text: Text<'_>, step: Type| {
            line_of(&[Run::new(text, step, Color32::PLACEHOLDER)], f32::INFINITY, ui).size().x
        };
        let number = width(Text::Data(WIDEST), Type::Metric);
        let rank = [words::BEST, words::WORST].map(|word| width(word.into(), Type::Small));
        let rank = if room.is_ranked { rank[0].max(rank[1]) } else { 0.0 };
        let needed: Vec<f32> = (metrics.iter())
            .map(|&(name, unit)| {
                let beside = width(unit.into(), Type::Small).max(rank);
                let number = number + if beside > 0.0 { space::XS + beside } else { 0.0 };
                number.max(width(name.into(), Type::Small)).ceil()
            })
            .collect();
        let columns_of = |columns: usize| -> Vec<f32> {
            let shown = needed.iter().take(columns * room.rows);
            let mut widths = vec![0.0_f32; columns];
            for (index, &needed) in shown.enumerate() {
                widths[index % columns] = widths[index % columns].max(needed);
            }
            widths
        };
        let fits = |columns: &usize| {
            let gaps = (*columns - 1) as f32 * space::M;
            columns_of(*columns).iter().sum::<f32>() + gaps <= room.width
        };
        let most = metrics.len().div_ceil(room.rows.max(1)).max(1);
        let columns = (1..=most).rev().find(fits).unwrap_or(1);
        let shown = metrics.len().min(columns * room.rows);
        let mut widths = columns_of(columns);
        // The columns share what is left, up to a distance at which a row still reads as one.
        let gaps = (columns - 1) as f32 * space::M;
        let left = (room.width - widths.iter().sum::<f32>() - gaps).max(0.0);
        let share = (left / columns as f32).min(1.5 * space::L * theme.scale());
        for width in &mut widths {
            *width += share.floor();
        }
        let height = if room.is_ranked { 44.0 } else { 38.0 } * theme.scale();
        Self {
            shown,
            rows: shown.div_ceil(columns),
            widths,
            row_height: height.round().max(room.least_height),
        }
    }

    /// Returns the height of all rows.
    pub(crate) fn height(&self) -> f32 {
        self.rows as f32 * self.row_height
    }

    /// Returns the place of a metric in a pane whose grid begins at `origin`.
    pub(crate) fn place(&self, index: usize, origin: Pos2) -> Rect {
        let columns = self.widths.len().max(1);
        let column = index % columns;
        let before = self.widths.iter().take(column).sum::<f32>() + column as f32 * space::M;
        let width = self.widths.get(column).copied().unwrap_or_default();
        let top = (index / columns) as f32 * self.row_height;
        Rect::from_min_size(origin + vec2(before, top), vec2(width, self.row_height))
    }
}

/// Draws a metric in its place of a [`MetricGrid`]: the number, its unit behind it, its rank above
/// the unit, its name below. Returns the button.
pub(crate) fn metric_cell_ui(metric: &Metric<'_>, rect: Rect, id: Id, ui: &Ui) -> Response {
    let response = button(metric, rect, id, ui);
    let palette = palette_of(ui);
    let run = |text: Text<'_>, step, color| -> Arc<Galley> {
        line_of(&[Run::new(text, step, color)], f32::INFINITY, ui)
    };
    let ink = metric.ink(ui);
    let name = line_of(&[Run::new(metric.short, Type::Small, palette.muted)], rect.width(), ui);
    let name_top = rect.bottom() - name.size().y - 1.0;
    let number_in = |step: Type, width: f32| {
        let mut runs = vec![Run::new(Text::Data(metric.value), step, ink)];
        if !metric.unit.is_empty() {
            runs.push(Run::new(metric.unit, Type::Small, palette.muted).after(space::XS));
        }
        line_of(&runs, width, ui)
    };
    // A number with more digits than the column and its gap have room for is smaller.
    let room = rect.width() + space::M - space::XS;
    let step = [Type::Metric, Type::Number]
        .into_iter()
        .find(|step| number_in(*step, f32::INFINITY).size().x <= room)
        .unwrap_or(Type::Small);
    let digits = run(Text::Data(metric.value), step, ink).size().x;
    let number = number_in(step, room);
    let at = put(ui.painter(), pos2(rect.left(), name_top), Align2::LEFT_BOTTOM, number);
    if metric.rank != Rank::Middle {
        let word = run(metric.rank.word().into(), Type::Small, ink);
        // Above the unit, and at the same height behind a number without one: the words of a row
        // stand on one line.
        let raised = 0.94 * word.size().y;
        let bottom = pos2(rect.left() + digits + space::XS, at.bottom() - raised);
        put(ui.painter(), bottom, Align2::LEFT_BOTTOM, word);
    }
    put(ui.painter(), pos2(rect.left(), name_top), Align2::LEFT_TOP, name);
    response
}

/// Draws a metric as a row: its full name at the left, the number at the right. Returns the button.
pub(crate) fn metric_row_ui(metric: &Metric<'_>, rect: Rect, id: Id, ui: &Ui) -> Response {
    let response = button(metric, rect, id, ui);
    let palette = palette_of(ui);
    let ink = metric.ink(ui);
    let mut number = vec![Run::new(Text::Data(metric.value), Type::Number, ink)];
    if !metric.unit.is_empty() {
        number.push(Run::new(metric.unit, Type::Small, palette.muted).after(space::XS));
    }
    if metric.rank != Rank::Middle {
        number.push(Run::new(metric.rank.word(), Type::Small, ink).after(space::XS));
    }
    let number = line_of(&number, rect.width(), ui);
    let at = put(ui.painter(), rect.right_center(), Align2::RIGHT_CENTER, number);
    let room = at.left() - space::S - rect.left();
    let name = [metric.name, metric.short]
        .map(|name| line_of(&[Run::new(name, Type::Small, palette.muted)], f32::INFINITY, ui))
        .into_iter()
        .find(|name| name.size().x <= room);
    let name = name.unwrap_or_else(|| {
        line_of(&[Run::new(metric.short, Type::Small, palette.muted)], room, ui)
    });
    put(ui.painter(), rect.left_center(), Align2::LEFT_CENTER, name);
    response
}

/// Makes the place of a metric a button.
fn button(metric: &Metric<'_>, rect: Rect, id: Id, ui: &Ui) -> Response {
    let response = ui.interact(rect, id, Sense::click()).on_hover_cursor(CursorIcon::PointingHand);
    let ground = rect.expand2(vec2(space::XS, 0.0));
    if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(ground, radius::S, palette_of(ui).hover);
    }
    focus_ring(ground.shrink(1.0), radius::S, &response, ui);
    describe(&response, &WidgetInfo::labeled(Role::Button, ui.is_enabled(), metric.said(ui)));
    if metric.hint.is_empty() { response } else { response.on_hover_text(say(metric.hint, ui)) }
}
