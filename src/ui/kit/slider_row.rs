//! One number of a lab: what it is called, what it is now and in which unit, and a track to drag.

use super::keys::keys_pressed;
use super::paint::{Run, faded, focus_ring, full_width, line_of, paragraph, put};
use super::words::Words;
use crate::ui::theme::{self, Type, palette_of, space, theme_of};
use eframe::egui::{
    self, Align2, Color32, CursorIcon, EventFilter, Id, Key, Pos2, Rect, Response, Role, Sense, Stroke, Ui, WidgetInfo,
    accesskit::{Action, ActionData},
    emath, pos2, vec2,
};
use std::ops::RangeInclusive;

/// Who decides the value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Source {
    /// Always the user.
    #[default]
    Manual,
    /// The user now; the app could be asked to (a reset asks it).
    ManualOverAuto,
    /// The app found the value. Dragging takes it over.
    Auto,
}

/// A small mark on the track, such as the value of a neighbouring pane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mark {
    /// Where, in the unit of the value.
    pub(crate) value: f64,
    /// In which colour.
    pub(crate) color: Color32,
}

/// A parameter as the row shows it.
#[derive(Clone, Debug)]
pub(crate) struct SliderRow<'a> {
    label: &'a str,
    unit: &'a str,
    secondary: &'a str,
    help: &'a str,
    range: RangeInclusive<f64>,
    step: f64,
    fine: f64,
    default: f64,
    decimals: usize,
    log: bool,
    source: Source,
    marks: &'a [Mark],
}

impl<'a> SliderRow<'a> {
    /// A row for values of `range`, which must rise. One step is a hundredth of it until [`Self::step`] says otherwise.
    pub(crate) fn new(label: &'a str, range: RangeInclusive<f64>, default: f64) -> Self {
        let step = (range.end() - range.start()).abs() / 100.0;
        Self {
            label,
            unit: "",
            secondary: "",
            help: "",
            range,
            step,
            fine: step / 10.0,
            default,
            decimals: 2,
            log: false,
            source: Source::Manual,
            marks: &[],
        }
    }

    /// The unit behind the number, in the quiet colour.
    pub(crate) fn unit(mut self, unit: &'a str) -> Self {
        self.unit = unit;
        self
    }

    /// The same value said in another way, behind a dot: `0.50 s` after `30 frames`.
    pub(crate) fn secondary(mut self, secondary: &'a str) -> Self {
        self.secondary = secondary;
        self
    }

    /// One sentence below the track.
    pub(crate) fn help(mut self, help: &'a str) -> Self {
        self.help = help;
        self
    }

    /// How much an arrow key changes the value; dragging lands on multiples of it too. The fine step (shift) is a tenth.
    pub(crate) fn step(mut self, step: f64) -> Self {
        self.step = step;
        self.fine = step / 10.0;
        self
    }

    /// Only whole numbers: no decimals, steps of one, shift included.
    pub(crate) fn whole(mut self) -> Self {
        self.step = 1.0;
        self.fine = 1.0;
        self.decimals = 0;
        self
    }

    /// How many digits stand after the point. Two until said.
    pub(crate) fn decimals(mut self, decimals: usize) -> Self {
        self.decimals = decimals;
        self
    }

    /// Every tenfold takes the same length of track. Both ends of the range must be positive.
    pub(crate) fn log(mut self) -> Self {
        self.log = *self.range.start() > 0.0 && *self.range.end() > 0.0;
        self
    }

    /// Who decides the value now.
    pub(crate) fn source(mut self, source: Source) -> Self {
        self.source = source;
        self
    }

    /// Marks on the track.
    pub(crate) fn marks(mut self, marks: &'a [Mark]) -> Self {
        self.marks = marks;
        self
    }

    /// Where on the track a value lies, 0..=1.
    fn position(&self, value: f64) -> f64 {
        let (low, high) = (*self.range.start(), *self.range.end());
        let position = if self.log {
            (value.max(low).ln() - low.ln()) / (high.ln() - low.ln())
        } else {
            (value - low) / (high - low)
        };
        if position.is_finite() { position.clamp(0.0, 1.0) } else { 0.0 }
    }

    /// The value at a position on the track, on a multiple of `step`.
    fn value_at(&self, position: f64, step: f64) -> f64 {
        let (low, high) = (*self.range.start(), *self.range.end());
        let position = position.clamp(0.0, 1.0);
        // The ends are the ends, whether or not they are multiples of the step.
        if position <= 0.0 {
            return low;
        }
        if position >= 1.0 {
            return high;
        }
        let value = if self.log {
            (low.ln() + position * (high.ln() - low.ln())).exp()
        } else {
            low + position * (high - low)
        };
        self.snapped(value, step)
    }

    fn snapped(&self, value: f64, step: f64) -> f64 {
        // Where the steps of a logarithmic track are wide compared to the value they would swallow it.
        let step = if self.log {
            step.min(value.abs() / 50.0).max(f64::MIN_POSITIVE)
        } else {
            step
        };
        let value = if step > 0.0 { (value / step).round() * step } else { value };
        value.clamp(*self.range.start(), *self.range.end())
    }

    fn written(&self, value: f64) -> String {
        format!("{value:.*}", self.decimals).replace('-', "−")
    }
}

/// What was done to a [`SliderRow`].
#[derive(Debug)]
pub(crate) struct SliderResponse {
    /// The value asked for, if it differs from the one shown. In the row's range.
    pub(crate) changed: Option<f64>,
    /// The default was asked for; for a value the app can find, that it find it. `changed` has the default as well.
    pub(crate) reset: bool,
    /// A drag began: what follows until [`Self::drag_ended`] is one thing to undo.
    pub(crate) drag_started: bool,
    /// The drag is over.
    pub(crate) drag_ended: bool,
    /// The track.
    pub(crate) response: Response,
}

/// A parameter: label, value and unit on one line, the track below, and a sentence of help where there is one.
///
/// Drag the track, hold shift for a tenth of the speed. Arrow keys step (shift: finely), page keys step tenfold, home and end
/// go to the ends. Click the number to type one; Enter takes it, Esc does not. A double click on label or track resets.
pub(crate) fn slider_row_ui(value: f64, row: &SliderRow<'_>, ui: &mut Ui) -> SliderResponse {
    let theme = theme_of(ui);
    let scale = theme.scale();
    let enabled = ui.is_enabled();
    let id = ui.make_persistent_id(row.label);
    let previous_spacing = std::mem::replace(&mut ui.spacing_mut().item_spacing.y, 0.0);

    let head = full_width((20.0 * scale).round(), ui);
    // The hit target is taller than what is seen, and reaches up under the label.
    let track_area = full_width((18.0 * scale).round(), ui);
    let track_hit = Rect::from_min_max(
        pos2(track_area.left(), track_area.bottom() - (theme::HIT * scale).round()),
        track_area.max,
    );

    let mut out = SliderResponse {
        changed: None,
        reset: false,
        drag_started: false,
        drag_ended: false,
        response: ui.interact(track_hit, id, Sense::click_and_drag()),
    };
    drag(value, row, track_hit, &mut out, ui);
    keys(value, row, &mut out, ui);
    assistive(value, row, &mut out, ui);
    let label = head_ui(value, row, head, id, &mut out, ui);
    if label.double_clicked() || out.response.double_clicked() {
        out.reset = true;
    }
    if out.reset {
        out.changed = Some(row.default.clamp(*row.range.start(), *row.range.end()));
    }
    out.changed = out
        .changed
        .filter(|&changed| changed != value || row.source == Source::Auto || out.reset);

    let shown = out.changed.unwrap_or(value);
    paint_track(shown, row, track_area, &out.response, ui);
    out.response.widget_info(|| WidgetInfo::slider(enabled, shown, row.label));
    out.response.ctx.accesskit_node_builder(id, |node| {
        node.set_min_numeric_value(*row.range.start());
        node.set_max_numeric_value(*row.range.end());
        node.set_numeric_value_step(row.step);
        node.set_value(spoken(shown, row));
        node.add_action(Action::SetValue);
        node.add_action(Action::Increment);
        node.add_action(Action::Decrement);
    });

    if !row.help.is_empty() {
        let galley = paragraph(
            row.help,
            Type::Small,
            faded(palette_of(ui).muted, enabled),
            ui.available_width(),
            ui,
        );
        let rect = full_width(galley.size().y + space::XS, ui);
        put(ui.painter(), rect.left_top(), Align2::LEFT_TOP, galley);
    }
    ui.spacing_mut().item_spacing.y = previous_spacing;
    ui.add_space(space::XS);
    out
}

fn spoken(value: f64, row: &SliderRow<'_>) -> String {
    let mut said = row.written(value);
    for part in [row.unit, row.secondary] {
        if !part.is_empty() {
            said.push(' ');
            said.push_str(part);
        }
    }
    said
}

/// Where the pointer holds the handle, kept between frames: unclamped, so that the way back from beyond an end is as long as
/// the way there.
#[derive(Clone, Copy, Debug)]
struct Held {
    position: f64,
    pointer_x: f32,
}

fn drag(value: f64, row: &SliderRow<'_>, hit: Rect, out: &mut SliderResponse, ui: &Ui) {
    let response = &out.response;
    let held_id = response.id.with("held");
    let held = ui.data(|data| data.get_temp::<Held>(held_id));
    let pointer = response.interact_pointer_pos().filter(|_| response.is_pointer_button_down_on());
    let Some(Pos2 { x, .. }) = pointer else {
        if held.is_some() {
            ui.data_mut(|data| data.remove::<Held>(held_id));
            out.drag_ended = true;
        }
        return;
    };
    let rail = rail(hit, ui);
    let width = f64::from(rail.width().max(1.0));
    let held = if let Some(held) = held {
        let speed = if ui.input(|input| input.modifiers.shift) { 0.1 } else { 1.0 };
        Held {
            position: held.position + speed * f64::from(x - held.pointer_x) / width,
            pointer_x: x,
        }
    } else {
        response.request_focus();
        out.drag_started = true;
        let position = row.position(value);
        let handle_x = f64::from(rail.left()) + position * width;
        // Taken by the handle, the value stays; elsewhere on the track it jumps to the pointer.
        let grabbed = (f64::from(x) - handle_x).abs() <= 12.0;
        let position = if grabbed { position } else { (f64::from(x - rail.left())) / width };
        Held { position, pointer_x: x }
    };
    ui.data_mut(|data| data.insert_temp(held_id, held));
    let fine = ui.input(|input| input.modifiers.shift);
    let moved = !out.drag_started || (held.position - row.position(value)).abs() > f64::EPSILON;
    if moved && ui.input(|input| out.drag_started || input.pointer.delta() != emath::Vec2::ZERO) {
        out.changed = Some(row.value_at(held.position, if fine { row.fine } else { row.step }));
    }
}

fn keys(value: f64, row: &SliderRow<'_>, out: &mut SliderResponse, ui: &Ui) {
    if !out.response.has_focus() {
        return;
    }
    let filter = EventFilter {
        horizontal_arrows: true,
        vertical_arrows: true,
        ..EventFilter::default()
    };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(out.response.id, filter));
    let mut next = value;
    for (key, modifiers) in keys_pressed(ui) {
        let steps = match key {
            Key::ArrowRight | Key::ArrowUp => 1.0,
            Key::ArrowLeft | Key::ArrowDown => -1.0,
            Key::PageUp => 10.0,
            Key::PageDown => -10.0,
            Key::Home => {
                next = *row.range.start();
                continue;
            }
            Key::End => {
                next = *row.range.end();
                continue;
            }
            _ => continue,
        };
        let step = if modifiers.shift { row.fine } else { row.step };
        next = if row.log {
            // On a logarithmic track a step is a fiftieth of the way, or the small values could not be reached.
            let share = if modifiers.shift { 0.002 } else { 0.02 };
            row.value_at(row.position(next) + steps * share, row.fine)
        } else {
            row.snapped(next + steps * step, step)
        };
    }
    if next != value {
        out.changed = Some(next);
    }
}

/// What screen readers ask for.
fn assistive(value: f64, row: &SliderRow<'_>, out: &mut SliderResponse, ui: &Ui) {
    let id = out.response.id;
    ui.input(|input| {
        let up = input.num_accesskit_action_requests(id, Action::Increment) as f64;
        let down = input.num_accesskit_action_requests(id, Action::Decrement) as f64;
        if up != down {
            out.changed = Some(row.snapped(value + (up - down) * row.step, row.step));
        }
        for request in input.accesskit_action_requests(id, Action::SetValue) {
            if let Some(ActionData::NumericValue(asked)) = request.data
                && asked.is_finite()
            {
                out.changed = Some(asked.clamp(*row.range.start(), *row.range.end()));
            }
        }
    });
}

/// The line with label and value; returns the label, which may be double-clicked.
fn head_ui(value: f64, row: &SliderRow<'_>, head: Rect, id: Id, out: &mut SliderResponse, ui: &mut Ui) -> Response {
    let (theme, palette, words) = (theme_of(ui), palette_of(ui), Words::of(ui));
    let enabled = ui.is_enabled();
    let (text, muted) = (faded(palette.text, enabled), faded(palette.muted, enabled));
    let shown = out.changed.unwrap_or(value);

    let number = line_of(&[Run::new(&row.written(shown), Type::Number, text)], f32::INFINITY, ui);
    let mut tail = Vec::new();
    if !row.unit.is_empty() {
        tail.push(Run::new(row.unit, Type::Label, muted).after(space::XS));
    }
    if !row.secondary.is_empty() {
        tail.push(Run::new("·", Type::Label, muted).after(space::XS));
        tail.push(Run::new(row.secondary, Type::Label, muted).after(space::XS));
    }
    let tail = line_of(&tail, f32::INFINITY, ui);
    let mut right = head.right();
    put(ui.painter(), pos2(right, head.center().y), Align2::RIGHT_CENTER, tail.clone());
    right -= tail.size().x;

    let pad = space::XS;
    let number_rect = Align2::RIGHT_CENTER
        .anchor_size(pos2(right, head.center().y), number.size())
        .expand2(vec2(pad, 2.0));
    let edit_id = id.with("typed");
    let typed = ui.data(|data| data.get_temp::<String>(edit_id));
    if let Some(mut typed) = typed {
        let wide = number_rect.width().max(64.0 * theme.scale());
        let field = Rect::from_min_max(
            pos2(number_rect.right() - wide, head.top() - 1.0),
            pos2(number_rect.right(), head.bottom() + 1.0),
        );
        edit_ui(&mut typed, edit_id, field, row, out, ui);
        right = field.left();
    } else {
        let mut value_hit = number_rect;
        value_hit.set_left(value_hit.left().min(value_hit.right() - theme::HIT));
        let number_response = ui
            .interact(value_hit, id.with("value"), Sense::click())
            .on_hover_cursor(CursorIcon::Text);
        if number_response.hovered() && enabled {
            ui.painter().rect_filled(number_rect, theme::radius::S, palette.hover);
        }
        put(ui.painter(), number_rect.center(), Align2::CENTER_CENTER, number);
        focus_ring(number_rect, theme::radius::S, &number_response, ui);
        number_response.widget_info(|| WidgetInfo::labeled(Role::Button, enabled, format!("{}: {}", row.label, words.type_value)));
        if number_response.clicked() {
            let start = row.written(value).replace('−', "-");
            ui.data_mut(|data| data.insert_temp(edit_id, start));
            ui.data_mut(|data| data.insert_temp(edit_id.with("fresh"), true));
        }
        number_response.on_hover_text(words.type_value);
        right = value_hit.left();
    }

    if row.source == Source::Auto {
        let tag = line_of(&[Run::new(words.auto, Type::SmallStrong, palette.accent_ink)], f32::INFINITY, ui);
        let at = Align2::RIGHT_CENTER.anchor_size(pos2(right - space::XS, head.center().y), tag.size() + vec2(12.0, 4.0));
        ui.painter().rect_filled(at, at.height() / 2.0, palette.accent_wash);
        put(ui.painter(), at.center(), Align2::CENTER_CENTER, tag);
        right = at.left();
    }

    let label = line_of(&[Run::new(row.label, Type::Label, text)], right - head.left() - space::S, ui);
    let rect = put(ui.painter(), head.left_center(), Align2::LEFT_CENTER, label);
    ui.interact(rect, id.with("label"), Sense::CLICK).on_hover_text(words.reset_hint)
}

fn edit_ui(typed: &mut String, edit_id: Id, field: Rect, row: &SliderRow<'_>, out: &mut SliderResponse, ui: &mut Ui) {
    let fresh_id = edit_id.with("fresh");
    let fresh = ui.data_mut(|data| data.remove_temp::<bool>(fresh_id)).unwrap_or(false);
    let font = theme_of(ui).font(Type::Number);
    // Asked before the field sees the keys: Esc also takes the focus away, and that must not commit.
    let escape = ui.input(|input| input.key_pressed(Key::Escape));
    let edit = egui::TextEdit::singleline(typed)
        .id(edit_id.with("field"))
        .font(font)
        .align(egui::Align2::RIGHT_CENTER);
    let edit = edit.desired_width(field.width()).margin(egui::Margin::symmetric(4, 1));
    let response = ui.put(field, edit).accessible_name(row.label);
    if fresh {
        response.request_focus();
        if let Some(mut state) = egui::TextEdit::load_state(ui.ctx(), response.id) {
            let all = egui::text::CCursorRange::two(
                egui::text::CCursor::default(),
                egui::text::CCursor {
                    index: typed.chars().count().into(),
                    ..Default::default()
                },
            );
            state.cursor.set_char_range(Some(all));
            state.store(ui.ctx(), response.id);
        }
    }
    if response.lost_focus() || (escape && !fresh) {
        if !escape && let Some(value) = parsed(typed) {
            out.changed = Some(value.clamp(*row.range.start(), *row.range.end()));
        }
        ui.data_mut(|data| data.remove::<String>(edit_id));
        out.response.request_focus();
    } else {
        ui.data_mut(|data| data.insert_temp(edit_id, typed.clone()));
    }
}

/// The number that someone typed: a decimal comma, a true minus sign and a unit behind it are fine.
fn parsed(typed: &str) -> Option<f64> {
    let plain = typed.trim().replace(',', ".").replace('−', "-");
    let end = plain
        .find(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | '-' | '+')))
        .unwrap_or(plain.len());
    plain.get(..end)?.parse::<f64>().ok().filter(|value| value.is_finite())
}

/// The line along which the middle of the handle moves.
fn rail(area: Rect, ui: &Ui) -> Rect {
    area.shrink2(vec2(handle_radius(ui), 0.0))
}

fn handle_radius(ui: &Ui) -> f32 {
    7.0 * theme_of(ui).scale()
}

fn paint_track(value: f64, row: &SliderRow<'_>, area: Rect, response: &Response, ui: &Ui) {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let enabled = ui.is_enabled();
    let thickness = 4.0 * theme.scale();
    let rail = rail(area, ui);
    let bar = Rect::from_center_size(area.center(), vec2(area.width(), thickness));
    let x_of = |value: f64| rail.left() + row.position(value) as f32 * rail.width();
    let painter = ui.painter();
    painter.rect_filled(bar, thickness / 2.0, palette.track);
    let auto = row.source == Source::Auto;
    // A value the app found is there but not asserted: its bar is quieter.
    let fill = faded(
        if auto {
            palette.accent.gamma_multiply(0.45)
        } else {
            palette.accent
        },
        enabled,
    );
    let handle = pos2(x_of(value), bar.center().y);
    painter.rect_filled(Rect::from_min_max(bar.min, pos2(handle.x, bar.bottom())), thickness / 2.0, fill);
    for mark in row.marks {
        let x = x_of(mark.value);
        let tick = Rect::from_center_size(pos2(x, bar.center().y), vec2(2.0 * theme.scale(), thickness + 6.0));
        painter.rect_filled(tick, 1.0, mark.color);
    }
    let radius = handle_radius(ui);
    focus_ring(
        Rect::from_center_size(handle, vec2(2.0, 2.0) * (radius + 1.0)),
        radius as u8 + 2,
        response,
        ui,
    );
    let hot = response.hovered() || response.is_pointer_button_down_on() || response.has_focus();
    let grown = ui.ctx().animate_bool(response.id.with("hot"), hot && enabled);
    if grown > 0.0 {
        painter.circle_filled(handle, radius + 5.0 * grown, palette.accent_wash);
    }
    painter.circle_filled(handle + vec2(0.0, 1.0), radius + 0.5, palette.shadow);
    if auto {
        painter.circle(
            handle,
            radius - 1.0,
            palette.panel,
            Stroke::new(2.0 * theme.scale(), faded(palette.handle, enabled)),
        );
    } else {
        let tone = if enabled { palette.handle } else { palette.muted };
        painter.circle_filled(handle, radius, tone);
    }
    // The default, as a nick below the track: where a double click would go. Only for whoever is at this track.
    let default_x = x_of(row.default);
    if !auto && grown > 0.0 && (default_x - handle.x).abs() > radius + 2.0 {
        let nick = Rect::from_center_size(pos2(default_x, bar.bottom() + 4.0), vec2(2.0, 4.0));
        painter.rect_filled(nick, 1.0, palette.muted.gamma_multiply(grown));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row() -> SliderRow<'static> {
        SliderRow::new("Half-life", 0.01..=10.0, 0.25).step(0.01)
    }

    #[test]
    fn positions_and_values_are_inverse() {
        for row in [row(), row().log()] {
            for value in [0.01, 0.1, 0.5, 3.0, 10.0] {
                let back = row.value_at(row.position(value), 0.0);
                assert!((back - value).abs() < 1e-9 * value.max(1.0), "{value} came back as {back}");
            }
        }
        // A logarithmic track gives every tenfold a third of its length.
        assert!((row().log().position(0.1) - 1.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn values_land_on_steps_and_stay_in_range() {
        let row = SliderRow::new("Window", 1.0..=60.0, 15.0).whole();
        assert_eq!(row.value_at(0.5, row.step), 31.0);
        assert_eq!(row.value_at(-3.0, row.step), 1.0);
        assert_eq!(row.value_at(7.0, row.step), 60.0);
        // The ends can be reached although they are no multiples of the step.
        let uneven = SliderRow::new("x", 0.05..=1.97, 0.5).step(0.1);
        assert_eq!((uneven.value_at(0.0, 0.1), uneven.value_at(1.0, 0.1)), (0.05, 1.97));
    }

    #[test]
    fn typed_numbers_may_carry_units_and_commas() {
        assert_eq!(parsed(" 30 frames"), Some(30.0));
        assert_eq!(parsed("0,25 s"), Some(0.25));
        assert_eq!(parsed("−12.5°"), Some(-12.5));
        assert_eq!(parsed("frames"), None);
        assert_eq!(parsed(""), None);
        assert_eq!(parsed("inf"), None);
    }

    #[test]
    fn a_range_of_no_width_is_no_trap() {
        let row = SliderRow::new("x", 2.0..=2.0, 2.0);
        assert_eq!(row.position(2.0), 0.0);
        assert_eq!(row.value_at(0.5, row.step), 2.0);
    }
}
