//! The bar of a whole clip with the part of it that is used, between two handles.

use super::assistive::{Adjustable, requested};
use super::chip::Part;
use super::keys::keys_pressed;
use super::paint::{Run, focus_ring, full_width, line_of, put};
use super::time_axis::TimeAxis;
use super::words;
use crate::ui::language::{Text, Word, say};
use crate::ui::theme::{HIT, Type, palette_of, radius, space, theme_of};
use eframe::egui::{
    Align2, CursorIcon, EventFilter, Id, Key, Rangef, Rect, Response, Sense, Stroke, StrokeKind,
    Ui, pos2, vec2,
};

/// The content of the bar.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PartBar<'a> {
    /// The label before it.
    pub(crate) label: Word,
    /// The name of the clip.
    pub(crate) name: Text<'a>,
    /// The duration of the clip, seconds.
    pub(crate) duration: f64,
    /// The time between its frames, seconds.
    pub(crate) step: f64,
    /// The beginning and the end of the part, seconds.
    pub(crate) ends: [f64; 2],
}

/// The user's input to the bar.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PartBarResponse {
    /// The end that was moved, 0 or 1, and its new time.
    pub(crate) moved: Option<(usize, f64)>,
    /// Whether the gesture is over.
    pub(crate) is_done: bool,
}

/// Draws the bar. Each end of the part is a slider for the pointer, the arrow keys and assistive
/// technology; neither passes the other.
pub(crate) fn part_bar_ui(bar: &PartBar<'_>, ui: &mut Ui) -> PartBarResponse {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let scale = theme.scale();
    let row = full_width((HIT * scale).max(theme.hit()).round(), ui);
    let gutter = if row.width() < 560.0 * scale { 0.0 } else { (112.0 * scale).round() };
    let axis =
        TimeAxis { x: Rangef::new(row.left() + gutter, row.right()), duration: bar.duration };
    if gutter > 0.0 {
        let run = Run::new(bar.label, Type::Small, palette.muted);
        let label = line_of(&[run], gutter - space::S, ui);
        put(ui.painter(), pos2(row.left(), row.center().y), Align2::LEFT_CENTER, label);
    }
    let (fill, ink) = Part::A.fill(palette);
    let height = (16.0 * scale).round();
    let whole = Rect::from_x_y_ranges(
        axis.x,
        Rangef::new(row.center().y - height / 2.0, row.center().y + height / 2.0),
    );
    let part =
        Rect::from_x_y_ranges(axis.x_of(bar.ends[0])..=axis.x_of(bar.ends[1]), whole.y_range());
    ui.painter().rect_filled(whole, f32::from(radius::S), palette.track);
    ui.painter().rect_filled(part, f32::from(radius::S), fill);
    let run = Run::new(bar.name, Type::SmallStrong, ink);
    let name = line_of(&[run], (part.width() - 2.0 * space::S).max(0.0), ui);
    if part.width() > 6.0 * space::S {
        put(ui.painter(), pos2(part.left() + space::S, part.center().y), Align2::LEFT_CENTER, name);
    }
    let mut found = PartBarResponse::default();
    for (end, name) in [words::PART_START, words::PART_END].into_iter().enumerate() {
        let range = if end == 0 { 0.0..=bar.ends[1] } else { bar.ends[0]..=bar.duration };
        let handle = Handle { name, time: bar.ends[end], range, step: bar.step, axis, row };
        let response = handle.show_ui(end, &mut found, ui);
        let hot = response.hovered() || response.dragged() || response.has_focus();
        let hot = ui.ctx().animate_bool(response.id, hot);
        let x = ui.painter().round_to_pixel_center(axis.x_of(bar.ends[end]));
        let grip = Rect::from_center_size(
            pos2(x, row.center().y),
            vec2((4.0 + 2.0 * hot) * scale, height + 4.0 * scale),
        );
        let tone = palette.handle.lerp_to_gamma(palette.accent, hot);
        ui.painter().rect(
            grip,
            f32::from(radius::S),
            tone,
            Stroke::new(theme.hairline(), palette.panel),
            StrokeKind::Outside,
        );
    }
    found
}

/// One end of the part.
struct Handle {
    name: Word,
    time: f64,
    range: std::ops::RangeInclusive<f64>,
    step: f64,
    axis: TimeAxis,
    row: Rect,
}

impl Handle {
    fn show_ui(self, end: usize, found: &mut PartBarResponse, ui: &Ui) -> Response {
        let x = self.axis.x_of(self.time);
        let theme = theme_of(ui);
        let width = (HIT * theme.scale()).max(theme.hit());
        // The handles of a short part lie beside each other, not on each other.
        let (left, right) = if end == 0 { (0.75, 0.25) } else { (0.25, 0.75) };
        let hit = Rect::from_x_y_ranges(x - left * width..=x + right * width, self.row.y_range());
        let id: Id = ui.make_persistent_id(self.name.english());
        let response = ui
            .interact(hit, id, Sense::drag())
            .on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
        let within = |secs: f64| secs.max(*self.range.start()).min(*self.range.end());
        if response.drag_started() {
            response.request_focus();
        }
        if let Some(pointer) = response
            .interact_pointer_pos()
            .filter(|_| response.dragged() && ui.input(|input| input.pointer.delta().x != 0.0))
        {
            found.moved = Some((end, within(self.axis.time_at(pointer.x))));
        }
        found.is_done |= response.drag_stopped();
        let mut step_to = |secs: f64| {
            found.moved = Some((end, within(secs)));
            found.is_done = true;
        };
        if let Some(asked) = requested(id, self.time, &self.range, self.step, ui) {
            step_to(asked);
        }
        if response.has_focus() {
            let filter = EventFilter { horizontal_arrows: true, ..EventFilter::default() };
            ui.memory_mut(|memory| memory.set_focus_lock_filter(id, filter));
            let frames: f64 = keys_pressed(ui)
                .into_iter()
                .map(|(key, modifiers)| {
                    let sign = match key {
                        Key::ArrowRight => 1.0,
                        Key::ArrowLeft => -1.0,
                        _ => 0.0,
                    };
                    if modifiers.shift { 10.0 * sign } else { sign }
                })
                .sum();
            if frames != 0.0 {
                step_to(self.time + frames * self.step);
            }
        }
        let adjustable = Adjustable {
            name: say(self.name, ui),
            value: self.time,
            range: self.range,
            step: self.step,
            said: format!("{:.2} s", self.time),
            help: String::new(),
        };
        adjustable.describe(&response, ui);
        focus_ring(hit, radius::S, &response, ui);
        response
    }
}
