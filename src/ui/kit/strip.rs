//! Clips end to end, as bars, with an arc for every transition.

use super::assistive::describe;
use super::paint::{Run, focus_ring, line_of, put};
use crate::ui::language::{Word, say};
use crate::ui::theme::{Type, palette_of, radius, theme_of};
use eframe::egui::epaint::CubicBezierShape;
use eframe::egui::{
    Align2, Color32, CursorIcon, Pos2, Rangef, Rect, Role, Sense, Stroke, Ui, WidgetInfo, pos2,
    vec2,
};
use segue_motion::math::sort::sort_by;
use segue_text::Message;

/// The reachability of a stretch in the graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fate {
    /// In the main component: every stretch of it can be reached again, without end.
    Main,
    /// In another component, by its number.
    Apart(usize),
    /// In no component: the way from here ends, or none leads here.
    Astray,
    /// A dead end.
    End,
}

/// A part of a bar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stretch {
    /// Its first frame, counted through all bars.
    pub(crate) from: usize,
    /// One past its end.
    pub(crate) to: usize,
    /// The reachability of a stretch in the graph.
    pub(crate) fate: Fate,
}

/// An arc from one frame to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Arc {
    /// The frames where it leaves and enters, counted through all bars.
    pub(crate) ends: [usize; 2],
    /// Its probability, 0 to 1.
    pub(crate) weight: f32,
    /// Whether it is not used.
    pub(crate) faint: bool,
}

/// Returns the indices of the arcs that are drawn: of too many the most probable ones.
pub(crate) fn drawn_arcs(arcs: &[Arc]) -> Vec<usize> {
    let mut drawn: Vec<usize> = (0..arcs.len()).collect();
    if drawn.len() > MAX_ARCS {
        let order =
            |a: &usize, b: &usize| arcs[*b].weight.total_cmp(&arcs[*a].weight).then(a.cmp(b));
        drawn.select_nth_unstable_by(MAX_ARCS, order);
        drawn.truncate(MAX_ARCS);
        sort_by(&mut drawn, order);
    }
    drawn
}

/// The content of the strip.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Strip<'a> {
    /// The accessible name.
    pub(crate) label: Word,
    /// The bars: the name and the number of frames of each.
    pub(crate) bars: &'a [(Message, usize)],
    /// Their parts.
    pub(crate) stretches: &'a [Stretch],
    /// The arcs.
    pub(crate) arcs: &'a [Arc],
    /// The indices of those that are drawn ([`drawn_arcs`]).
    pub(crate) drawn: &'a [usize],
    /// The current frame.
    pub(crate) now: Option<usize>,
    /// The highlighted part.
    pub(crate) lit_stretch: Option<[usize; 2]>,
    /// The highlighted arc.
    pub(crate) lit_arc: Option<usize>,
}

/// The user's input to the strip.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct StripResponse {
    /// The arc under the pointer.
    pub(crate) hovered_arc: Option<usize>,
    /// The arc that was clicked.
    pub(crate) clicked_arc: Option<usize>,
    /// The bar that was clicked.
    pub(crate) clicked_bar: Option<usize>,
}

/// The gap between two bars, points.
const GAP: f32 = 4.0;
/// The distance within which the pointer reaches an arc, points.
const REACH: f32 = 5.0;
/// The greatest number of arcs: the most probable ones are drawn.
const MAX_ARCS: usize = 500;
/// Straight pieces by which the distance to an arc is measured.
const PIECES: usize = 20;

/// Draws the strip at a height.
pub(crate) fn strip_ui(strip: &Strip<'_>, height: f32, ui: &mut Ui) -> StripResponse {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let scale = theme.scale();
    let (_, whole) = ui.allocate_space(vec2(ui.available_width(), height));
    let (bar_height, names) = ((7.0 * scale).round(), (16.0 * scale).round());
    let bars = Rangef::new(whole.bottom() - names - bar_height, whole.bottom() - names);
    let frames: usize = strip.bars.iter().map(|bar| bar.1).sum();
    let per_frame =
        (whole.width() - GAP * strip.bars.len().saturating_sub(1) as f32) / frames.max(1) as f32;
    let mut starts = Vec::with_capacity(strip.bars.len());
    let mut first = 0;
    for (index, bar) in strip.bars.iter().enumerate() {
        starts.push((first, whole.left() + first as f32 * per_frame + index as f32 * GAP));
        first += bar.1;
    }
    let x_of = |frame: f32| {
        let bar = starts.partition_point(|start| start.0 as f32 <= frame).saturating_sub(1);
        starts.get(bar).map_or(whole.left(), |start| start.1 + (frame - start.0 as f32) * per_frame)
    };

    let id = ui.make_persistent_id(strip.label.english());
    let response = ui.interact(whole, id, Sense::click());
    describe(&response, &WidgetInfo::labeled(Role::Image, true, say(strip.label, ui)));
    let top = whole.top() + 3.0;
    let room = (bars.min - top).max(8.0);
    let curve = |arc: &Arc| {
        let [from, to] = arc.ends.map(|frame| x_of(frame as f32));
        // The apex of the arc lies at three quarters of its control points.
        let high = (room * 1.3).min(18.0 * scale + 0.34 * (to - from).abs());
        [
            pos2(from, bars.min),
            pos2(from, bars.min - high),
            pos2(to, bars.min - high),
            pos2(to, bars.min),
        ]
    };
    let drawn = || strip.drawn.iter().filter_map(|&index| Some((index, strip.arcs.get(index)?)));
    let pointer = response.hover_pos();
    let hovered_arc = pointer.filter(|pos| pos.y < bars.min - 1.0).and_then(|pos| {
        let off = drawn().map(|(index, arc)| (index, distance(&curve(arc), pos)));
        let nearest = off.min_by(|a, b| a.1.total_cmp(&b.1));
        nearest.filter(|(_, off)| *off <= REACH).map(|(index, _)| index)
    });
    let painter = ui.painter_at(whole.expand(2.0));
    let draw = |arc: &Arc, stroke: Stroke| {
        let points = curve(arc);
        painter.add(CubicBezierShape::from_points_stroke(
            points,
            false,
            Color32::TRANSPARENT,
            stroke,
        ));
    };
    for (_, arc) in drawn() {
        let clear = if arc.faint { 0.10 } else { 0.16 + 0.7 * arc.weight.sqrt() };
        draw(
            arc,
            Stroke::new((0.7 + 2.6 * arc.weight) * scale, palette.muted.gamma_multiply(clear)),
        );
    }
    for (index, color) in [(hovered_arc, palette.text), (strip.lit_arc, palette.accent)] {
        if let Some(arc) = index.and_then(|index| strip.arcs.get(index)) {
            draw(arc, Stroke::new(2.4 * scale, color));
        }
    }
    // The first of the other colours is as blue as the main component.
    let [_, second, third, fourth] = palette.others;
    let apart = [palette.a, second, third, fourth];
    let bar_of = |from: f32, to: f32| Rect::from_x_y_ranges(x_of(from)..=x_of(to), bars);
    for stretch in strip.stretches {
        let color = match stretch.fate {
            Fate::Main => palette.b,
            Fate::Apart(part) => apart[part % apart.len()],
            Fate::Astray | Fate::End => palette.line_strong,
        };
        // The end of one bar is not the beginning of the next.
        let mut rect = bar_of(stretch.from as f32, stretch.to as f32 - 0.01);
        // A hairline divides it from the next one, unless that would take most of it.
        if rect.width() >= 4.0 * theme.hairline() {
            rect.max.x -= theme.hairline();
        }
        painter.rect_filled(
            rect,
            0.0,
            color.gamma_multiply(if stretch.fate == Fate::Main { 0.75 } else { 1.0 }),
        );
        if stretch.fate == Fate::End {
            let end = Rect::from_min_max(
                pos2((rect.right() - 3.0).max(rect.left()), rect.top()),
                rect.max,
            );
            painter.rect_filled(end, 0.0, palette.bad);
        }
    }
    if let Some([from, to]) = strip.lit_stretch {
        let rect = bar_of(from as f32, to as f32 - 0.01);
        painter.rect_filled(rect.expand2(vec2(0.0, 1.0)), 0.0, palette.accent);
    }
    for ((name, frames), &(_, left)) in strip.bars.iter().zip(&starts) {
        let width = *frames as f32 * per_frame;
        let galley =
            line_of(&[Run::new(name, Type::Small, palette.muted)], (width - 2.0).max(0.0), ui);
        if width > 14.0 {
            put(&painter, pos2(left, bars.max + 1.0), Align2::LEFT_TOP, galley);
        }
    }
    if let Some(now) = strip.now {
        let at = pos2(x_of(now as f32), 0.5 * (bars.min + bars.max));
        painter.circle(at, 5.5 * scale, palette.handle, Stroke::new(1.5, palette.on_handle));
    }
    focus_ring(whole, radius::S, &response, ui);
    let under_bar = pointer.filter(|pos| pos.y >= bars.min - 1.0).and_then(|pos| {
        let bar = starts.partition_point(|start| start.1 <= pos.x);
        bar.checked_sub(1)
    });
    if response.hovered() && (hovered_arc.is_some() || under_bar.is_some()) {
        ui.ctx().set_cursor_icon(CursorIcon::PointingHand);
    }
    StripResponse {
        hovered_arc,
        clicked_arc: hovered_arc.filter(|_| response.clicked()),
        clicked_bar: under_bar.filter(|_| response.clicked()),
    }
}

/// Returns the distance of a point from an arc.
fn distance(points: &[Pos2; 4], pos: Pos2) -> f32 {
    let at = |t: f32| {
        let u = 1.0 - t;
        let weights = [u * u * u, 3.0 * u * u * t, 3.0 * u * t * t, t * t * t];
        let sum = points
            .iter()
            .zip(weights)
            .fold(vec2(0.0, 0.0), |sum, (point, w)| sum + point.to_vec2() * w);
        sum.to_pos2()
    };
    let mut least = f32::INFINITY;
    for piece in 0..PIECES {
        let (from, to) = (at(piece as f32 / PIECES as f32), at((piece + 1) as f32 / PIECES as f32));
        let along = to - from;
        let share = ((pos - from).dot(along) / along.length_sq().max(1e-6)).clamp(0.0, 1.0);
        least = least.min((from + along * share).distance(pos));
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arc_distance_is_measured_to_its_line() {
        let points = [pos2(0.0, 100.0), pos2(0.0, 20.0), pos2(90.0, 20.0), pos2(90.0, 100.0)];
        assert!(distance(&points, pos2(45.0, 40.0)) < 0.5);
        assert!(distance(&points, pos2(45.0, 90.0)) > 30.0);
    }

    #[test]
    fn of_too_many_arcs_the_most_probable_are_drawn() {
        let arc = |weight: f32| Arc { ends: [0, 1], weight, faint: false };
        let few: Vec<Arc> = [0.2, 0.9, 0.1].map(arc).into();
        assert_eq!(drawn_arcs(&few), [0, 1, 2]);
        let many: Vec<Arc> = (0..MAX_ARCS + 40).map(|index| arc(index as f32)).collect();
        let drawn = drawn_arcs(&many);
        assert_eq!((drawn.len(), drawn[0]), (MAX_ARCS, MAX_ARCS + 39));
        assert!(drawn.iter().all(|&index| index >= 40));
    }
}
