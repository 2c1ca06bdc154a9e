//! Painting that the widgets share: text, the focus ring, gradients.

use crate::ui::language::{Text, say};
use crate::ui::theme::{Theme, Type, palette_of, theme_of};
use eframe::egui::{
    self, Align, Align2, Color32, CornerRadius, FontId, Galley, Id, Mesh, Painter, Pos2, Rect,
    Response, Stroke, StrokeKind, Ui,
    epaint::Vertex,
    pos2,
    text::{LayoutJob, TextFormat, TextWrapping},
    vec2,
};
use std::sync::Arc;

/// One run of text in one font and colour.
#[derive(Clone, Debug)]
pub(crate) struct Run<'a> {
    /// Its text.
    pub(crate) text: Text<'a>,
    /// Its step of the type scale.
    pub(crate) step: Type,
    /// Its colour.
    pub(crate) color: Color32,
    /// Space before it, in points.
    pub(crate) gap: f32,
}

impl<'a> Run<'a> {
    /// Returns a run that follows without a gap.
    pub(crate) fn new(text: impl Into<Text<'a>>, step: Type, color: Color32) -> Self {
        Self { text: text.into(), step, color, gap: 0.0 }
    }

    /// Returns the run with space before it.
    pub(crate) fn after(mut self, gap: f32) -> Self {
        self.gap = gap;
        self
    }
}

/// Lays runs out in one line on one baseline, cut with … where they are wider than `max_width`.
pub(crate) fn line_of(runs: &[Run<'_>], max_width: f32, ui: &Ui) -> Arc<Galley> {
    let theme = theme_of(ui);
    let mut job = LayoutJob {
        wrap: TextWrapping {
            max_width: max_width.max(0.0),
            max_rows: 1,
            break_anywhere: true,
            ..TextWrapping::default()
        },
        break_on_newline: false,
        ..LayoutJob::default()
    };
    let largest = runs.iter().map(|run| theme.font(run.step).size).fold(0.0, f32::max);
    for run in runs {
        let mut format = format(theme, run.step, run.color);
        format.line_height = Some(baseline_height(format.font_id.size, largest));
        job.append(&say(run.text, ui), run.gap, format);
    }
    ui.fonts_mut(|fonts| fonts.layout_job(job))
}

/// Lays a name out in one line. Where it is too wide it is cut in the middle: names of one series
/// differ at their ends.
pub(crate) fn name_line(
    name: Text<'_>,
    step: Type,
    color: Color32,
    max_width: f32,
    ui: &Ui,
) -> Arc<Galley> {
    let line = |text: &str| line_of(&[Run::new(Text::Data(text), step, color)], f32::INFINITY, ui);
    let whole = say(name, ui);
    let galley = line(&whole);
    if galley.size().x <= max_width {
        return galley;
    }
    line(&cut_in_middle(&whole, |text| line(text).size().x <= max_width))
}

/// Returns a text with `…` in the place of as many letters of its middle as it takes to fit.
fn cut_in_middle(text: &str, fits: impl Fn(&str) -> bool) -> String {
    let letters: Vec<char> = text.chars().collect();
    let with = |kept: usize| {
        // A series is told apart by a few letters at the end.
        let tail = kept * 2 / 5;
        let (head, rest) = letters.split_at(kept - tail);
        let end = rest.len().saturating_sub(tail);
        head.iter().copied().chain(['…']).chain(rest.iter().skip(end).copied()).collect::<String>()
    };
    let (mut fitting, mut too_many) = (0, letters.len());
    while too_many - fitting > 1 {
        let middle = fitting.midpoint(too_many);
        if fits(&with(middle)) {
            fitting = middle;
        } else {
            too_many = middle;
        }
    }
    with(fitting)
}

/// Returns the line height that puts text of `size` on one baseline with text of size `largest`, in
/// the format of [`format()`].
///
/// egui aligns the lower edges of line boxes and centres text in a box of given height. With ascent
/// `a` and descent `d` (shares of the size), the baseline lies `(height + (a - d) size) / 2` below
/// the upper edge of its own box; asking for `d · largest` below it for all gives the height.
fn baseline_height(size: f32, largest: f32) -> f32 {
    // Inter's ascender and descender, of 2048 units to the em.
    let (ascent, descent) = (1984.0 / 2048.0, 494.0 / 2048.0);
    (ascent - descent) * size + 2.0 * descent * largest
}

/// Lays text out in as many lines as it needs.
pub(crate) fn paragraph<'a>(
    text: impl Into<Text<'a>>,
    step: Type,
    color: Color32,
    max_width: f32,
    ui: &Ui,
) -> Arc<Galley> {
    let theme = theme_of(ui);
    let mut job = LayoutJob::single_section(say(text, ui), format(theme, step, color));
    job.wrap.max_width = max_width.max(1.0);
    ui.fonts_mut(|fonts| fonts.layout_job(job))
}

fn format(theme: Theme, step: Type, color: Color32) -> TextFormat {
    let font_id: FontId = theme.font(step);
    let size = font_id.size;
    TextFormat {
        // Capitals stand too close at the spacing of small letters.
        extra_letter_spacing: if step == Type::Caps { 0.06 * size } else { 0.0 },
        line_height: (step == Type::Small).then_some((size * 1.36).round()),
        valign: Align::BOTTOM,
        ..TextFormat::simple(font_id, color)
    }
}

/// Draws a galley so that the given corner or edge of it is at `pos`. Returns its rectangle.
pub(crate) fn put(painter: &Painter, pos: Pos2, anchor: Align2, galley: Arc<Galley>) -> Rect {
    let rect = anchor.anchor_size(pos, galley.size());
    painter.galley(rect.min, galley, Color32::PLACEHOLDER);
    rect
}

/// Returns a colour, faded unless `enabled`, as egui does for its own widgets.
pub(crate) fn faded(color: Color32, enabled: bool) -> Color32 {
    if enabled { color } else { color.gamma_multiply(0.5) }
}

/// Returns whether the keyboard was used last. The focus is then shown by a ring; a click needs
/// none.
pub(super) fn keyboard_in_use(ui: &Ui) -> bool {
    let id = Id::unique("segue keyboard in use");
    let (pointer, key) = ui.input(|input| {
        let key = input.events.iter().any(|event| {
            matches!(
                event,
                egui::Event::Key { pressed: true, .. } | egui::Event::AccessKitActionRequest(_)
            )
        });
        (input.pointer.any_pressed(), key)
    });
    ui.ctx().data_mut(|data| {
        let known = data.get_temp::<bool>(id).unwrap_or(false);
        let now = if pointer { false } else { known || key };
        data.insert_temp(id, now);
        now
    })
}

/// The pointer that was used last.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum PointerKind {
    /// There was none yet.
    #[default]
    Unknown,
    /// A mouse, which hovers.
    Mouse,
    /// A finger, which scrolls a list where a mouse drags its rows.
    Finger,
}

/// Returns the pointer that was used last.
pub(crate) fn pointer_in_use(ui: &Ui) -> PointerKind {
    let id = Id::unique("segue pointer in use");
    let now = ui.input(|input| {
        let any = |wanted: fn(&egui::Event) -> bool| input.events.iter().any(wanted);
        if input.any_touches() || any(|event| matches!(event, egui::Event::Touch { .. })) {
            PointerKind::Finger
        } else if any(|event| {
            matches!(event, egui::Event::PointerMoved(_) | egui::Event::PointerButton { .. })
        }) {
            PointerKind::Mouse
        } else {
            PointerKind::Unknown
        }
    });
    ui.ctx().data_mut(|data| {
        let known = data.get_temp_mut_or_default::<PointerKind>(id);
        if now != PointerKind::Unknown {
            *known = now;
        }
        *known
    })
}

/// Draws the ring around the widget with the focus, and scrolls a widget into view that gets it by
/// keyboard.
pub(crate) fn focus_ring(rect: Rect, corner: u8, response: &Response, ui: &Ui) {
    if response.has_focus() && keyboard_in_use(ui) {
        if response.gained_focus() {
            response.scroll_to_me(None);
        }
        let stroke = Stroke::new(2.0, palette_of(ui).accent);
        ui.painter().rect_stroke(
            rect.expand(2.0),
            CornerRadius::same(corner.saturating_add(2)),
            stroke,
            StrokeKind::Middle,
        );
    }
}

/// Draws a bar with round ends, with a gradient from left to right through `stops`: (0..=1,
/// colour), in rising order.
///
/// egui's rectangles have one fill, so the shape is cut into thin columns where it is round and
/// into the stops where it is not.
pub(crate) fn gradient_bar(rect: Rect, corner: f32, stops: &[(f32, Color32)], painter: &Painter) {
    if rect.width() <= 0.0 || stops.is_empty() {
        return;
    }
    let corner = corner.min(rect.height() / 2.0).min(rect.width() / 2.0);
    let cuts = stops.iter().map(|&(at, _)| rect.left() + at.clamp(0.0, 1.0) * rect.width());
    let round = (0..=8_u8).flat_map(|step| {
        let offset = corner * f32::from(step) / 8.0;
        [rect.left() + offset, rect.right() - offset]
    });
    // Sorted by insertion: a browser takes longer to compile a sort for long lists than to run it.
    let mut columns: Vec<f32> = Vec::new();
    for x in cuts.chain(round) {
        columns.insert(columns.partition_point(|&known| known <= x), x);
    }
    let mut mesh = Mesh::default();
    for x in columns {
        // The height that the round corner takes at this column.
        let into = (corner - (x - rect.left()).min(rect.right() - x)).max(0.0);
        let lost = corner - (corner * corner - into * into).max(0.0).sqrt();
        let color = color_at((x - rect.left()) / rect.width(), stops);
        let clear = color.gamma_multiply(0.0);
        // Half a point of fade above and below keeps the edges smooth, as egui's own shapes do.
        let feather = 0.5 / painter.pixels_per_point();
        for (y, color) in [
            (rect.top() + lost - feather, clear),
            (rect.top() + lost + feather, color),
            (rect.bottom() - lost - feather, color),
            (rect.bottom() - lost + feather, clear),
        ] {
            mesh.vertices.push(Vertex::untextured(pos2(x, y), color));
        }
    }
    let columns = mesh.vertices.len() as u32 / 4;
    for column in 1..columns {
        for row in 0..3 {
            let (left, right) = ((column - 1) * 4 + row, column * 4 + row);
            mesh.add_triangle(left, right, left + 1);
            mesh.add_triangle(left + 1, right, right + 1);
        }
    }
    painter.add(egui::Shape::mesh(mesh));
}

fn color_at(at: f32, stops: &[(f32, Color32)]) -> Color32 {
    let mut previous = stops[0];
    for &stop in stops {
        if at <= stop.0 {
            let span = stop.0 - previous.0;
            let t = if span > 0.0 { (at - previous.0) / span } else { 1.0 };
            return previous.1.lerp_to_gamma(stop.1, t.clamp(0.0, 1.0));
        }
        previous = stop;
    }
    previous.1
}

/// Allocates `height` points across the available width.
pub(crate) fn full_width(height: f32, ui: &mut Ui) -> Rect {
    let (_, rect) = ui.allocate_space(vec2(ui.available_width(), height));
    rect
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stops_meet_and_hold_outside() {
        let (red, blue) = (Color32::from_rgb(200, 0, 0), Color32::from_rgb(0, 0, 200));
        let stops = [(0.25, red), (0.75, blue)];
        assert_eq!(color_at(0.0, &stops), red);
        assert_eq!(color_at(1.0, &stops), blue);
        assert_eq!(color_at(0.5, &stops), Color32::from_rgb(100, 0, 100));
    }
}
