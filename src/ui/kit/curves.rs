//! Curves under the timeline, on the same axis of time.

use super::assistive::readable_ui;
use super::long_line::paint_long_line;
use super::paint::{Run, line_of, put};
use super::time_axis::{TimeAxis, hovered_time, nice_step};
use crate::ui::language::{Text, Word, say};
use crate::ui::theme::{Type, palette_of, radius, space, theme_of};
use eframe::egui::{
    Align2, Color32, Galley, Rect, Response, Stroke, StrokeKind, Ui, Vec2, pos2, vec2,
};
use std::fmt;
use std::sync::Arc;

/// One curve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Series<'a> {
    /// Its name, short: `A`, `result`.
    pub(crate) name: Text<'a>,
    /// Its colour as a line.
    pub(crate) color: Color32,
    /// Its colour as text.
    pub(crate) ink: Color32,
    /// Whether it is drawn thick, and last.
    pub(crate) strong: bool,
    /// Whether it is a clip's that the others were made from: its name stands behind theirs.
    pub(crate) is_source: bool,
    /// Times in seconds and values, in rising time. A value that is not finite makes a gap.
    pub(crate) points: &'a [[f64; 2]],
    /// All of its values, where the points are only some of them.
    pub(crate) values: Option<&'a dyn SeriesValues>,
}

/// All values of a curve; a trait, because the kit knows no motions.
pub(crate) trait SeriesValues: fmt::Debug {
    /// Returns the value at a time, seconds; `None` outside the curve or in a gap.
    fn value_at(&self, secs: f64) -> Option<f64>;
}

impl Series<'_> {
    /// Returns the value at a time, seconds; `None` outside the curve or in a gap.
    fn value_at(&self, secs: f64) -> Option<f64> {
        match self.values {
            Some(values) => values.value_at(secs),
            None => value_at(self.points, secs),
        }
    }
}

/// The least range of values that is shown, in units of the last digit of a value.
const LEAST_DIGITS: f64 = 5.0;

/// Curves over one axis of values.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Curves<'a> {
    /// The thing whose quantity it is, for the value under the pointer: `right foot`.
    pub(crate) of: Text<'a>,
    /// The quantity, for the space before them: `speed`.
    pub(crate) title: Word,
    /// The unit of their values.
    pub(crate) unit: Word,
    /// Digits after the point of a value under the pointer.
    pub(crate) decimals: usize,
    /// A value that is always in sight, such as 0 for speeds.
    pub(crate) include: Option<f64>,
    /// The curves.
    pub(crate) series: &'a [Series<'a>],
}

impl Curves<'_> {
    /// Returns a value as text.
    fn written(&self, value: f64) -> String {
        let digits = format!("{value:.*}", self.decimals);
        // A number that rounds to zero has no sign.
        let is_zero = digits.bytes().all(|byte| matches!(byte, b'-' | b'0' | b'.'));
        let digits = if is_zero { digits.trim_start_matches('-') } else { &digits };
        digits.replace('-', "−")
    }

    /// Returns a text of the width that the values of a series need at most, so that what stands
    /// beside them is at rest while they change. Empty for a series without values.
    fn widest(&self, series: &Series<'_>) -> String {
        let values = series.points.iter().map(|point| point[1]).filter(|value| value.is_finite());
        let ends = values.fold(None, |ends: Option<(f64, f64)>, value| {
            let (low, high) = ends.unwrap_or((value, value));
            Some((low.min(value), high.max(value)))
        });
        let Some((low, high)) = ends else {
            return String::new();
        };
        let [low, high] = [low, high].map(|end| self.written(end));
        let longer = if low.chars().count() > high.chars().count() { low } else { high };
        // No digit is wider than a zero.
        longer.replace(|c: char| c.is_ascii_digit(), "0")
    }

    /// Returns the range of values that is shown: that of the curves, with a margin.
    fn bounds(&self) -> (f64, f64) {
        let values = self
            .series
            .iter()
            .flat_map(|series| series.points.iter().map(|point| point[1]))
            .chain(self.include);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.filter(|value| value.is_finite()) {
            low = low.min(value);
            high = high.max(value);
        }
        if low > high {
            return (0.0, 1.0);
        }
        // Values that differ by less than a few of the last digits shown make a level line.
        // Otherwise the noise of a planted foot would fill the plot.
        let missing = LEAST_DIGITS * 0.1_f64.powi(self.decimals as i32) - (high - low);
        if missing > 0.0 {
            if self.include == Some(low) {
                high += missing;
            } else if self.include == Some(high) {
                low -= missing;
            } else {
                (low, high) = (low - 0.5 * missing, high + 0.5 * missing);
            }
        }
        let margin = 0.08 * (high - low);
        // A limit, such as the speed 0, needs no margin beyond it.
        let floor =
            if self.include == Some(low) { low - 0.02 * (high - low) } else { low - margin };
        (floor, high + margin)
    }
}

/// Draws the curves into `plot`, whose width is the axis of time. With `scale_labels`, the values
/// of its lines are written before it.
pub(super) fn curves_ui(
    curves: &Curves<'_>,
    axis: TimeAxis,
    plot: Rect,
    scale_labels: bool,
    ui: &Ui,
) {
    if plot.width() < 2.0 || plot.height() < 2.0 || axis.duration <= 0.0 {
        return;
    }
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let (low, high) = curves.bounds();
    let step = nice_step(high - low, f64::from(plot.height() / (24.0 * theme.scale())));
    let first = (low / step).ceil();
    let marks = move || {
        (0..).map(move |i| (first + f64::from(i)) * step).take_while(move |&value| value <= high)
    };
    let y_of = |value: f64| plot.bottom() - ((value - low) / (high - low)) as f32 * plot.height();
    let painter = ui.painter_at(plot);
    for value in marks() {
        let y = painter.round_to_pixel_center(y_of(value));
        painter.hline(plot.x_range(), y, Stroke::new(theme.hairline(), palette.line));
    }
    for strong in [false, true] {
        let stroke_width = theme.scale() * if strong { 2.2 } else { 1.4 };
        for series in curves.series.iter().filter(|series| series.strong == strong) {
            let runs = series.points.split(|point| !point.iter().all(|number| number.is_finite()));
            for run in runs.filter(|run| run.len() > 1) {
                let points = run.iter().map(|&[time, value]| pos2(axis.x_of(time), y_of(value)));
                let points: Vec<_> = points.collect();
                paint_long_line(&points, Stroke::new(stroke_width, series.color), &painter);
            }
        }
    }
    if !scale_labels {
        return;
    }
    let decimals = usize::from(step < 1.0) + usize::from(step < 0.1) + usize::from(step < 0.01);
    // A label at the upper edge would cover the lowest one of the plot above.
    let places = marks().map(|value| (value, y_of(value)));
    for (value, y) in places.filter(|(_, y)| *y >= plot.top() + 5.0) {
        let text = format!("{value:.decimals$}").replace('-', "−");
        let label =
            line_of(&[Run::new(Text::Data(&text), Type::Small, palette.muted)], f32::INFINITY, ui);
        put(ui.painter(), pos2(plot.left() - space::S, y), Align2::RIGHT_CENTER, label);
    }
}

/// Returns the places of plots under each other.
pub(super) fn plots_in(place: Rect, count: usize) -> impl Iterator<Item = Rect> {
    let pitch = place.height() / count.max(1) as f32;
    let gap = if count > 1 { space::XS } else { 0.0 };
    (0..count).map(move |index| {
        let top = place.top() + pitch * index as f32;
        Rect::from_x_y_ranges(place.x_range(), top + gap..=top + pitch)
    })
}

/// Returns the quantity, and the names of the curves with their values at `now`, each with its
/// place from the upper left corner of a space of that width. The places do not depend on `now`.
fn key_parts(curves: &Curves<'_>, width: f32, now: f64, ui: &Ui) -> Vec<(Vec2, Arc<Galley>)> {
    let palette = palette_of(ui);
    let title = format!("{} {}", say(curves.title, ui), say(curves.unit, ui));
    let title = Run::new(Text::Data(title.trim()), Type::Small, palette.muted);
    let title = line_of(&[title], width, ui);
    let mut corner = vec2(0.0, space::XS + title.size().y);
    let mut parts = vec![(vec2(0.0, space::XS), title)];
    // The results first: where room is scarce, the others are left out.
    let mut sorted: Vec<_> = curves.series.iter().collect();
    sorted.sort_by_key(|series| (!series.strong, series.is_source));
    let entries: Vec<_> = (sorted.into_iter())
        .map(|series| {
            let with_value = |value: &str, ui: &Ui| {
                let runs = [
                    Run::new(series.name, Type::Small, series.ink),
                    Run::new(Text::Data(value), Type::SmallStrong, palette.text).after(space::XS),
                ];
                line_of(&runs, f32::INFINITY, ui)
            };
            let room = with_value(&curves.widest(series), ui).size().x;
            // A number that is cut says nothing: a long name stands alone.
            if room > width {
                let name = [Run::new(series.name, Type::Small, series.ink)];
                let name = line_of(&name, width, ui);
                return (name.size().x, name);
            }
            let value = series.value_at(now).map(|value| curves.written(value));
            (room, with_value(&value.unwrap_or_default(), ui))
        })
        .collect();
    let mut left: f32 = entries.iter().map(|(room, _)| room + space::S).sum();
    for (room, entry) in entries {
        // Names that have a line of their own are not spread over two.
        let rest = left - space::S;
        let is_split = rest <= width && corner.x + rest > width;
        if corner.x > 0.0 && (is_split || corner.x + room > width) {
            corner = vec2(0.0, corner.y + entry.size().y);
        }
        left -= room + space::S;
        let right = corner.x + room;
        parts.push((corner, entry));
        corner.x = right + space::S;
    }
    parts
}

/// Returns the height in which [`key_ui`] draws all names, at any time.
pub(super) fn key_height(curves: &Curves<'_>, width: f32, ui: &Ui) -> f32 {
    let bottoms = key_parts(curves, width, 0.0, ui).into_iter();
    // The last line may overlap the height of the time's axis, which begins beside it.
    bottoms.map(|(corner, part)| corner.y + part.size().y).fold(0.0, f32::max) - space::S
}

/// Draws the quantity, and the names of the curves in their colours with their values at the
/// playhead, in the space before them.
pub(super) fn key_ui(curves: &Curves<'_>, area: Rect, now: f64, ui: &Ui) {
    for (corner, part) in key_parts(curves, area.width(), now, ui) {
        if corner.y + part.size().y > area.height() + space::S {
            break;
        }
        put(ui.painter(), area.min + corner, Align2::LEFT_TOP, part);
    }
}

/// Draws a line at the pointer through all plots, a dot on each curve there, and their values with
/// time and unit.
pub(super) fn hover_ui(
    plots: &[(&Curves<'_>, Rect)],
    axis: TimeAxis,
    response: &Response,
    ui: &Ui,
) {
    let all = plots.iter().map(|(_, plot)| *plot).reduce(Rect::union).unwrap_or(Rect::NOTHING);
    let Some(time) = hovered_time(axis, all, response) else {
        return;
    };
    let painter = ui.painter();
    let x = axis.x_of(time);
    let line = Stroke::new(1.0, palette_of(ui).line_strong);
    painter.vline(painter.round_to_pixel_center(x), all.y_range(), line);
    for (index, (curves, plot)) in plots.iter().enumerate() {
        values_ui(curves, *plot, x, (time, index == 0), ui);
    }
}

/// Draws the values of the curves of one plot at a time, whose place is `x`; of the first plot with
/// the time.
fn values_ui(curves: &Curves<'_>, plot: Rect, x: f32, (time, is_first): (f64, bool), ui: &Ui) {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let (low, high) = curves.bounds();
    let painter = ui.painter();
    let written: Vec<(String, &Series<'_>)> = curves
        .series
        .iter()
        .filter_map(|series| {
            let value = series.value_at(time)?;
            let y = plot.bottom() - ((value - low) / (high - low)) as f32 * plot.height();
            painter.circle(
                pos2(x, y),
                3.0 * theme.scale(),
                series.color,
                Stroke::new(1.5, palette.panel),
            );
            Some((curves.written(value), series))
        })
        .collect();
    if written.is_empty() {
        return;
    }
    let seconds = format!("{time:.2} s");
    let mut runs = Vec::new();
    if is_first {
        runs.push(Run::new(Text::Data(&seconds), Type::Small, palette.muted));
        runs.push(Run::new(Text::Data("·"), Type::Small, palette.muted).after(space::XS));
    }
    if !curves.of.is_empty() {
        runs.push(Run::new(curves.of, Type::Small, palette.muted).after(space::XS));
        runs.push(Run::new(curves.title, Type::Small, palette.muted).after(space::XS));
    }
    for (value, series) in &written {
        // A single curve needs no name.
        if written.len() > 1 {
            runs.push(Run::new(series.name, Type::Small, series.ink).after(space::M));
        }
        runs.push(Run::new(Text::Data(value), Type::SmallStrong, palette.text).after(space::XS));
    }
    runs.push(Run::new(curves.unit, Type::Small, palette.muted).after(space::XS));
    let said: Vec<_> = runs.iter().map(|run| say(run.text, ui)).collect();
    let galley = line_of(&runs, f32::INFINITY, ui);
    let size = galley.size() + vec2(2.0 * space::S, space::S);
    // The values stand beside the pointer, on the side that has room.
    let left = if x + 12.0 + size.x < plot.right() {
        x + 12.0
    } else {
        (x - 12.0 - size.x).max(plot.left())
    };
    let rect = Rect::from_min_size(pos2(left, plot.top() + 2.0), size);
    let line = Stroke::new(theme.hairline(), palette.line);
    painter.rect(rect, radius::M, palette.panel_raised, line, StrokeKind::Inside);
    put(painter, rect.center(), Align2::CENTER_CENTER, galley);
    let id = ui.scope_id().with(("values", plot.top().to_bits()));
    readable_ui(&said.join(" "), rect, id, ui);
}

/// Returns the value between two points of a curve; `None` outside it or in a gap.
fn value_at(points: &[[f64; 2]], time: f64) -> Option<f64> {
    let after = points.partition_point(|point| point[0] < time);
    let right = points.get(after)?;
    if right[0] == time {
        return Some(right[1]).filter(|value| value.is_finite());
    }
    let left = points.get(after.checked_sub(1)?)?;
    let t = (time - left[0]) / (right[0] - left[0]);
    Some(left[1] + t * (right[1] - left[1])).filter(|value| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_between_points_are_on_the_line_between_them() {
        let points = [[0.0, 1.0], [1.0, 3.0], [2.0, f64::NAN], [3.0, 0.0]];
        assert_eq!(value_at(&points, 0.5), Some(2.0));
        assert_eq!(value_at(&points, 1.0), Some(3.0));
        assert_eq!(value_at(&points, 1.5), None);
        assert_eq!(value_at(&points, -0.1), None);
        assert_eq!(value_at(&points, 3.1), None);
        assert_eq!(value_at(&[], 0.0), None);
    }

    #[test]
    fn names_of_results_stand_before_those_of_the_clips_which_share_a_line() {
        let series = ["A", "B", "inertialize", "dissolve"].map(|name| Series {
            name: Text::Data(name),
            color: Color32::RED,
            ink: Color32::RED,
            strong: name == "inertialize",
            is_source: name.len() == 1,
            points: &[],
            values: None,
        });
        let curves = Curves { title: Word::new("speed"), series: &series, ..Curves::default() };
        let mut placed = Vec::new();
        let builder = egui_kittest::Harness::builder()
            .with_context_setup(|ctx| crate::ui::theme::Theme::default().install(ctx));
        let harness = builder.build_ui(|ui| {
            let parts = key_parts(&curves, 80.0, 0.0, ui);
            placed = parts.iter().map(|(at, part)| (part.text().to_owned(), *at)).collect();
        });
        drop(harness);
        let names: Vec<_> = placed.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["speed", "inertialize", "dissolve", "A", "B"]);
        let tops: Vec<_> = placed.iter().map(|(_, at)| at.y).collect();
        assert!(tops[1] < tops[2] && tops[2] < tops[3], "{placed:?}");
        assert_eq!(tops[3], tops[4], "{placed:?}");
    }

    #[test]
    fn names_stay_in_their_places_while_the_values_change() {
        let all = [[0.0, 0.5], [1.0, 11.11], [2.0, -40.0], [3.0, 9.0]];
        let window = [[1.0, 3.0], [2.0, 100.0]];
        let series = [("result", &all[..], false), ("A", &window, true), ("B", &window, true)];
        let series = series.map(|(name, points, is_source)| Series {
            name: Text::Data(name),
            color: Color32::RED,
            ink: Color32::RED,
            strong: false,
            is_source,
            points,
            values: None,
        });
        let curves = Curves { decimals: 2, series: &series, ..Curves::default() };
        let mut at_times = Vec::new();
        let builder = egui_kittest::Harness::builder()
            .with_context_setup(|ctx| crate::ui::theme::Theme::default().install(ctx));
        let harness = builder.build_ui(|ui| {
            at_times = [0.0, 1.0, 1.5, 2.0, 3.0]
                .map(|now| key_parts(&curves, 80.0, now, ui))
                .map(|parts| parts.into_iter().map(|(at, part)| (at, part.size().x)).collect())
                .to_vec();
        });
        drop(harness);
        let at_times: Vec<Vec<(Vec2, f32)>> = at_times;
        let places = |parts: &[(Vec2, f32)]| parts.iter().map(|part| part.0).collect::<Vec<_>>();
        for parts in &at_times {
            assert_eq!(places(parts), places(&at_times[0]));
            assert!(parts.iter().all(|(at, width)| at.x + width <= 80.0), "{parts:?}");
        }
    }

    #[test]
    fn bounds_hold_all_that_is_finite() {
        let points = [[0.0, 1.0], [1.0, f64::INFINITY], [2.0, 5.0]];
        let series = [Series {
            name: Text::Data("A"),
            color: Color32::RED,
            ink: Color32::RED,
            strong: true,
            is_source: false,
            points: &points,
            values: None,
        }];
        let curves = Curves { include: Some(0.0), series: &series, ..Curves::default() };
        let (low, high) = curves.bounds();
        assert!(low <= 0.0 && low > -0.5 && high > 5.0 && high < 6.0);
        // A foot that stands, with the noise of its numbers.
        let points = [[0.0, 0.0001], [1.0, 0.0003], [2.0, 0.0]];
        let series = [Series { points: &points, ..series[0] }];
        let still = Curves { decimals: 2, include: Some(0.0), series: &series, ..curves };
        let (low, high) = still.bounds();
        assert!(low < 0.0 && low > -0.01 && high > 0.05 && high < 0.06, "{low} {high}");
        let flat = [[0.0, 2.0], [1.0, 2.0]];
        let series = [Series { points: &flat, ..series[0] }];
        let (low, high) = Curves { series: &series, ..Curves::default() }.bounds();
        assert!(low < 2.0 && high > 2.0);
        assert_eq!(Curves::default().bounds(), (0.0, 1.0));
    }
}
