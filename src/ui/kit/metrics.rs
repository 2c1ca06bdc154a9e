//! Metrics in a row: large numbers with their labels below.

use super::assistive::describe;
use super::paint::{Run, line_of, put};
use super::words;
use crate::ui::language::{Text, Word, say};
use crate::ui::theme::{Type, palette_of, space, theme_of};
use eframe::egui::{Align2, Galley, Rect, Role, Sense, Ui, WidgetInfo, pos2, vec2};
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

/// One measured number.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Metric<'a> {
    /// The number as text, with its sign and degree sign.
    pub(crate) value: &'a str,
    /// Its name and unit: `slide cm`.
    pub(crate) label: Word,
    /// Its rank.
    pub(crate) rank: Rank,
    /// Its meaning in a sentence, for the hint.
    pub(crate) hint: Word,
}

/// Draws metrics side by side, in further rows where there is no room. The best and the worst are
/// marked in colour and in words.
pub(crate) fn metric_strip_ui(metrics: &[Metric<'_>], ui: &mut Ui) {
    let (rects, total) = places(metrics, ui.available_width(), ui);
    let (_, space) = ui.allocate_space(vec2(ui.available_width(), total));
    let height = row_height(ui);
    for (index, (metric, rect)) in metrics.iter().zip(rects).enumerate() {
        let rect = rect.translate(space.min.to_vec2());
        let (number, label, word) = galleys(metric, ui);
        put(
            ui.painter(),
            pos2(rect.left(), rect.top() + 0.54 * height),
            Align2::LEFT_BOTTOM,
            number,
        );
        put(ui.painter(), pos2(rect.left(), rect.top() + 0.56 * height), Align2::LEFT_TOP, label);
        let response = ui.interact(rect, ui.make_persistent_id(("metric", index)), Sense::hover());
        let said = format!("{} {} {}", metric.value, say(metric.label, ui), say(word, ui));
        describe(&response, &WidgetInfo::labeled(Role::Label, true, said));
        if !metric.hint.is_empty() {
            response.on_hover_text(say(metric.hint, ui));
        }
    }
}

/// Returns the height of [`metric_strip_ui`] at a width.
pub(crate) fn metric_strip_height(metrics: &[Metric<'_>], width: f32, ui: &Ui) -> f32 {
    places(metrics, width, ui).1
}

fn row_height(ui: &Ui) -> f32 {
    (36.0 * theme_of(ui).scale()).round()
}

/// Returns the number with its verdict, the label, and the word of the verdict.
fn galleys(metric: &Metric<'_>, ui: &Ui) -> (Arc<Galley>, Arc<Galley>, Word) {
    let palette = palette_of(ui);
    let (ink, word) = match metric.rank {
        Rank::Middle => (palette.text, Word::default()),
        Rank::Best => (palette.good, words::BEST),
        Rank::Worst => (palette.bad, words::WORST),
    };
    let mut number = vec![Run::new(Text::Data(metric.value), Type::Metric, ink)];
    if !word.is_empty() {
        number.push(Run::new(word, Type::Small, ink).after(space::XS + 1.0));
    }
    let number = line_of(&number, f32::INFINITY, ui);
    let label = line_of(&[Run::new(metric.label, Type::Small, palette.muted)], f32::INFINITY, ui);
    (number, label, word)
}

/// Returns the place of each metric, from the origin, and the height of all.
fn places(metrics: &[Metric<'_>], width: f32, ui: &Ui) -> (Vec<Rect>, f32) {
    let height = row_height(ui);
    let mut at = pos2(0.0, 0.0);
    let mut rects = Vec::with_capacity(metrics.len());
    for metric in metrics {
        let (number, label, _) = galleys(metric, ui);
        let size = vec2(number.size().x.max(label.size().x).ceil(), height);
        if at.x > 0.0 && at.x + size.x > width {
            at = pos2(0.0, at.y + height + space::XS);
        }
        rects.push(Rect::from_min_size(at, size));
        at.x += size.x + space::L;
    }
    let bottom = rects.last().map_or(0.0, Rect::bottom);
    (rects, bottom)
}
