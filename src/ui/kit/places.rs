//! All clips in a row, with the current frame: it runs along its clip and jumps to another.

use super::assistive::describe;
use super::paint::{Run, line_of, put};
use crate::ui::language::{Word, say};
use crate::ui::theme::{Type, palette_of, space, theme_of};
use eframe::egui::{
    Align2, Color32, Rangef, Rect, Role, Sense, Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2,
};
use segue_text::Message;
use std::ops::Range;

/// A clip.
#[derive(Clone, Debug)]
pub(crate) struct PlaceBar {
    /// Its name.
    pub(crate) name: Message,
    /// Its number of frames.
    pub(crate) frames: usize,
    /// Its stretches with their colours.
    pub(crate) stretches: Vec<(Range<usize>, Color32)>,
}

/// A frame in the strip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct StripPlace {
    /// The clip.
    pub(crate) bar: usize,
    /// The row: 0, or 1 for its mirror image.
    pub(crate) row: usize,
    /// The frame.
    pub(crate) frame: usize,
}

/// Frames of one clip in the strip.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Chosen {
    /// The clip.
    pub(crate) bar: usize,
    /// The frames.
    pub(crate) frames: Range<usize>,
}

/// The content of the strip.
#[derive(Clone, Debug)]
pub(crate) struct Places<'a> {
    /// The accessible name.
    pub(crate) label: Word,
    /// The words before the name of a clip.
    pub(crate) title: Word,
    /// The clips.
    pub(crate) bars: &'a [PlaceBar],
    /// 2 where there are mirror images.
    pub(crate) rows: usize,
    /// The current frame.
    pub(crate) now: Option<StripPlace>,
    /// The last jumps, from and to, each with its opacity, 0 to 1.
    pub(crate) jumps: &'a [(StripPlace, StripPlace, f32)],
    /// The frames that were chosen by hand.
    pub(crate) chosen: Option<&'a Chosen>,
    /// Candidates of the search.
    pub(crate) marks: &'a [StripPlace],
    /// The names of the colours.
    pub(crate) legend: &'a [(Word, Color32)],
}

/// Draws the strip, `height` points high. Returns the stretch that is being chosen by dragging
/// along a clip.
pub(crate) fn places_ui(places: &Places<'_>, height: f32, ui: &mut Ui) -> Option<Chosen> {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let scale = theme.scale();
    let (_, whole) = ui.allocate_space(vec2(ui.available_width(), height));
    let response = ui.interact(whole, ui.make_persistent_id(places.label.english()), Sense::drag());
    describe(&response, &WidgetInfo::labeled(Role::Image, true, say(places.label, ui)));
    let legend = (16.0 * scale).round();
    let rows = places.rows.max(1);
    let pitch = ((whole.height() - legend) / rows as f32).floor();
    let y_of = |row: usize| {
        Rangef::new(
            whole.top() + row as f32 * pitch + 3.0,
            whole.top() + (row + 1) as f32 * pitch - 3.0,
        )
    };
    let gap = if places.bars.len() > 60 { 1.0 } else { 2.0 };
    let frames: usize = places.bars.iter().map(|bar| bar.frames).sum();
    let per_frame = (whole.width() - gap * places.bars.len().saturating_sub(1) as f32).max(1.0)
        / frames.max(1) as f32;
    let mut starts = Vec::with_capacity(places.bars.len());
    let mut left = whole.left();
    for bar in places.bars {
        starts.push(left);
        left += bar.frames as f32 * per_frame + gap;
    }
    let x_of = |bar: usize, frame: usize| {
        starts.get(bar).map_or(whole.left(), |start| start + frame as f32 * per_frame)
    };
    let at = |place: &StripPlace| pos2(x_of(place.bar, place.frame), y_of(place.row).center());
    let painter = ui.painter_at(whole.expand(3.0));
    for (index, bar) in places.bars.iter().enumerate() {
        for row in 0..rows {
            let rect = |from: usize, to: usize| {
                Rect::from_x_y_ranges(x_of(index, from)..=x_of(index, to), y_of(row))
            };
            painter.rect_filled(rect(0, bar.frames), 2, palette.track);
            for (stretch, color) in &bar.stretches {
                painter.rect_filled(
                    rect(stretch.start, stretch.end.min(bar.frames)),
                    2,
                    color.gamma_multiply(0.55),
                );
            }
        }
    }
    for mark in places.marks {
        painter.vline(at(mark).x, y_of(mark.row).expand(1.0), Stroke::new(2.0 * scale, palette.b));
    }
    for (from, to, clear) in places.jumps {
        let stroke = Stroke::new(1.5 * scale, palette.text.gamma_multiply(0.8 * clear));
        painter.line_segment([at(from), at(to)], stroke);
    }
    if let Some(now) = &places.now {
        painter.circle(at(now), 5.5 * scale, palette.handle, Stroke::new(1.5, palette.on_handle));
    }
    if let Some(chosen) = places.chosen {
        for row in 0..rows {
            let span = x_of(chosen.bar, chosen.frames.start)..=x_of(chosen.bar, chosen.frames.end);
            let rect = Rect::from_x_y_ranges(span, y_of(row).expand(1.5));
            painter.rect(
                rect,
                2,
                palette.accent.gamma_multiply(0.25),
                Stroke::new(1.5 * scale, palette.accent),
                StrokeKind::Middle,
            );
        }
    }
    let bar_at = |x: f32| starts.partition_point(|start| *start <= x).checked_sub(1);
    let frame_at = |bar: usize, x: f32| ((x - starts[bar]).max(0.0) / per_frame.max(1e-6)) as usize;
    let hovered = response.hover_pos().and_then(|pos| bar_at(pos.x));
    let pulled =
        ui.input(|input| input.pointer.press_origin()).zip(response.interact_pointer_pos());
    let dragged = pulled.filter(|_| response.dragged()).and_then(|(from, to)| {
        let bar = bar_at(from.x)?;
        let frames = places.bars.get(bar)?.frames;
        let [a, b] = [from, to].map(|pos| frame_at(bar, pos.x).min(frames));
        (a != b).then(|| Chosen { bar, frames: a.min(b)..a.max(b) })
    });
    // The name of the clip under the pointer, else of the current one, and the legend.
    let named = hovered.or(places.now.map(|now| now.bar)).and_then(|bar| places.bars.get(bar));
    let base = whole.bottom() - 0.5 * legend;
    let mut x = whole.right();
    for (name, color) in places.legend.iter().rev() {
        let galley = line_of(&[Run::new(*name, Type::Small, palette.muted)], f32::INFINITY, ui);
        let rect = put(&painter, pos2(x, base), Align2::RIGHT_CENTER, galley);
        let square = Rect::from_center_size(pos2(rect.left() - 8.0, base), vec2(8.0, 8.0));
        painter.rect_filled(square, 2, color.gamma_multiply(0.75));
        x = square.left() - 12.0;
    }
    let title = Run::new(places.title, Type::Small, palette.muted);
    let name = named.map(|bar| Run::new(&bar.name, Type::Small, palette.text).after(space::S));
    let runs: Vec<Run<'_>> = std::iter::once(title).chain(name).collect();
    let galley = line_of(&runs, x - whole.left(), ui);
    put(&painter, pos2(whole.left(), base), Align2::LEFT_CENTER, galley);
    dragged
}
