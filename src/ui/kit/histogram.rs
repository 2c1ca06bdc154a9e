//! A histogram with a line that can be dragged: the values before it count.

use super::assistive::{Adjustable, requested};
use super::paint::{Run, focus_ring, full_width, line_of, put};
use crate::ui::language::{Text, Word, say};
use crate::ui::theme::{Type, palette_of, radius, space, theme_of};
use eframe::egui::{Align2, CursorIcon, EventFilter, Key, Rect, Sense, Stroke, Ui, pos2};

/// The content of the histogram.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Histogram<'a> {
    /// The accessible name.
    pub(crate) label: Word,
    /// The number of values in each bin.
    pub(crate) counts: &'a [u32],
    /// The width of a bin, in the unit of the value.
    pub(crate) bin: f64,
    /// The value at the line.
    pub(crate) value: f64,
    /// The smallest value of the line, and its step.
    pub(crate) step: f64,
    /// The unit.
    pub(crate) unit: Word,
}

/// The user's input to the histogram.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct HistogramResponse {
    /// The new value of the line.
    pub(crate) changed: Option<f64>,
    /// The line was released.
    pub(crate) settled: bool,
}

/// Draws the histogram. Drag or press to move the line; the arrow keys move it by a step.
pub(crate) fn histogram_ui(histogram: &Histogram<'_>, ui: &mut Ui) -> HistogramResponse {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let scale = theme.scale();
    let (height, foot) = ((54.0 * scale).round(), (14.0 * scale).round());
    let row = full_width(height + foot, ui);
    let plot = Rect::from_min_size(row.min, eframe::egui::vec2(row.width(), height));
    // Values far beyond the line are cut off, so that the line is not at the edge.
    let bins = shown_bins(histogram);
    let end = bins as f64 * histogram.bin;
    let x_of = |value: f64| plot.left() + (value / end).clamp(0.0, 1.0) as f32 * plot.width();

    let id = ui.make_persistent_id(histogram.label.english());
    let response = ui
        .interact(plot, id, Sense::click_and_drag())
        .on_hover_cursor(CursorIcon::ResizeHorizontal);
    let range = histogram.step..=end;
    let asked = requested(id, histogram.value, &range, histogram.step, ui);
    let mut out = HistogramResponse { changed: asked, settled: asked.is_some() };
    if let Some(pos) =
        response.interact_pointer_pos().filter(|_| response.dragged() || response.clicked())
    {
        let share = f64::from((pos.x - plot.left()) / plot.width().max(1.0)).clamp(0.0, 1.0);
        let wanted = ((share * end / histogram.step).round() * histogram.step).max(histogram.step);
        out.changed =
            Some(wanted).filter(|wanted| (wanted - histogram.value).abs() > 0.25 * histogram.step);
    }
    out.settled |= response.drag_stopped() || response.clicked();
    if response.has_focus() {
        let filter = EventFilter { horizontal_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(id, filter));
        let steps = ui.input(|input| {
            f64::from(i8::from(input.key_pressed(Key::ArrowRight)))
                - f64::from(i8::from(input.key_pressed(Key::ArrowLeft)))
        });
        if steps != 0.0 {
            out.changed = Some((histogram.value + steps * histogram.step).max(histogram.step));
            out.settled = true;
        }
    }
    let value = out.changed.unwrap_or(histogram.value);
    let adjustable = Adjustable {
        name: say(histogram.label, ui),
        value,
        range,
        step: histogram.step,
        said: format!("{value:.1} {}", say(histogram.unit, ui)).trim_end().to_owned(),
        help: String::new(),
    };
    adjustable.describe(&response, ui);

    let most = f64::from(histogram.counts.iter().take(bins).copied().max().unwrap_or(0).max(1));
    let wide = plot.width() / bins as f32;
    for (bin, &count) in
        histogram.counts.iter().take(bins).enumerate().filter(|(_, count)| **count > 0)
    {
        // Heights are square roots: there are few near pairs and very many far ones.
        let high = (f64::from(count) / most).sqrt() as f32 * (height - 4.0);
        let left = plot.left() + bin as f32 * wide;
        let inside = (bin as f64 + 0.5) * histogram.bin <= value;
        let color = if inside { palette.accent } else { palette.track };
        let bar = Rect::from_min_max(
            pos2(left, plot.bottom() - high.max(1.0)),
            pos2(left + (wide - 1.0).max(1.0), plot.bottom()),
        );
        ui.painter().rect_filled(bar, 0.0, color);
    }
    let line = x_of(value);
    ui.painter().vline(line, plot.y_range(), Stroke::new(2.0 * scale, palette.handle));
    ui.painter().circle(
        pos2(line, plot.top() + 4.0 * scale),
        4.0 * scale,
        palette.handle,
        Stroke::new(1.0, palette.on_handle),
    );
    ui.painter().hline(
        plot.x_range(),
        plot.bottom(),
        Stroke::new(theme.hairline(), palette.line_strong),
    );
    for (share, anchor) in
        [(0.0, Align2::LEFT_TOP), (0.5, Align2::CENTER_TOP), (1.0, Align2::RIGHT_TOP)]
    {
        let number = format!("{:.0}", share * end);
        let mut runs = vec![Run::new(Text::Data(&number), Type::Small, palette.muted)];
        if share == 1.0 {
            runs.push(Run::new(histogram.unit, Type::Small, palette.muted).after(space::XS));
        }
        let galley = line_of(&runs, plot.width(), ui);
        put(
            ui.painter(),
            pos2(plot.left() + share as f32 * plot.width(), plot.bottom() + 1.0),
            anchor,
            galley,
        );
    }
    focus_ring(plot, radius::S, &response, ui);
    out
}

/// Returns the number of bins that are shown: the line lies in the left two thirds, and most of the
/// values are in sight.
fn shown_bins(histogram: &Histogram<'_>) -> usize {
    let counts = histogram.counts;
    let all: u64 = counts.iter().map(|&count| u64::from(count)).sum();
    let mut before = 0;
    let most = counts.iter().position(|&count| {
        before += u64::from(count);
        before * 10 >= all * 9
    });
    let needed = (1.4 * histogram.value / histogram.bin.max(1e-9)).ceil() as usize;
    most.unwrap_or(0).max(needed).clamp(8, counts.len().max(8))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn histogram_line_is_never_at_the_edge() {
        let counts = [1, 2, 3, 9, 40, 30, 20, 10, 5, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1];
        let of = |value| {
            shown_bins(&Histogram {
                label: Word::default(),
                counts: &counts,
                bin: 0.5,
                value,
                step: 0.1,
                unit: Word::default(),
            })
        };
        assert_eq!(of(1.0), 8);
        assert_eq!(of(5.0), 14);
        assert_eq!(of(60.0), counts.len());
    }
}
