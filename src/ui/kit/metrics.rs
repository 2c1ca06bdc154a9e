//! Measured numbers in a row: large, with what they measure below.

use super::chip::Mood;
use super::paint::{Run, line_of, put};
use super::words::Words;
use crate::ui::theme::{Type, palette_of, space, theme_of};
use eframe::egui::{Align2, Rect, Role, Sense, Ui, WidgetInfo, pos2, vec2};

/// How a number compares to the same one in the other panes.
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
    /// The number as it is written, sign and degree included.
    pub(crate) value: &'a str,
    /// What it measures and in which unit: `skate cm`.
    pub(crate) label: &'a str,
    /// How it compares.
    pub(crate) rank: Rank,
    /// What it means, in a sentence, for the hint.
    pub(crate) hint: &'a str,
}

/// Numbers side by side, in further rows where there is no room. The best and the worst are marked in colour and in words.
pub(crate) fn metric_strip_ui(metrics: &[Metric<'_>], ui: &mut Ui) {
    let (theme, palette, words) = (theme_of(ui), palette_of(ui), Words::of(ui));
    let scale = theme.scale();
    let gap = space::L;
    let height = (36.0 * scale).round();
    let width = ui.available_width();
    let origin = ui.cursor().min;
    let mut at = vec2(0.0, 0.0);
    let mut bottom = 0.0_f32;
    for (index, metric) in metrics.iter().enumerate() {
        let (mood, word) = match metric.rank {
            Rank::Middle => (Mood::Plain, ""),
            Rank::Best => (Mood::Good, words.best),
            Rank::Worst => (Mood::Bad, words.worst),
        };
        let ink = if mood == Mood::Plain {
            palette.text
        } else {
            mood.colors(palette).0
        };
        let mut number = vec![Run::new(metric.value, Type::Metric, ink)];
        if !word.is_empty() {
            number.push(Run::new(word, Type::Small, ink).after(space::XS + 1.0));
        }
        let number = line_of(&number, f32::INFINITY, ui);
        let label = line_of(&[Run::new(metric.label, Type::Small, palette.muted)], f32::INFINITY, ui);
        let size = vec2(number.size().x.max(label.size().x).ceil(), height);
        if at.x > 0.0 && at.x + size.x > width {
            at = vec2(0.0, at.y + height + space::S);
        }
        let rect = Rect::from_min_size(origin + at, size);
        put(
            ui.painter(),
            pos2(rect.left(), rect.top() + 0.52 * height),
            Align2::LEFT_BOTTOM,
            number,
        );
        put(ui.painter(), pos2(rect.left(), rect.top() + 0.56 * height), Align2::LEFT_TOP, label);
        let response = ui.interact(rect, ui.make_persistent_id(("metric", index)), Sense::hover());
        response.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("{} {} {word}", metric.value, metric.label)));
        if !metric.hint.is_empty() {
            response.on_hover_text(metric.hint);
        }
        at.x += size.x + gap;
        bottom = bottom.max(rect.bottom() - origin.y);
    }
    ui.allocate_space(vec2(width, bottom));
}
