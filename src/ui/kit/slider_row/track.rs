//! The track of a slider: pointer and keys on it, and its painting.

use super::super::keys::keys_pressed;
use super::super::paint::{PointerKind, faded, focus_ring, pointer_in_use};
use super::row::{SliderResponse, SliderRow, Source};
use crate::ui::theme::{palette_of, theme_of};
use eframe::egui::style::ScrollAnimation;
use eframe::egui::{EventFilter, Key, Pos2, Rect, Response, Stroke, Ui, Vec2, pos2, vec2};

/// The state of the pointer on the track between frames.
#[derive(Clone, Copy, Debug)]
enum Hold {
    /// A finger that has not moved yet: it may set the value or scroll the panel.
    Undecided(Pos2),
    /// A finger that scrolls the panel, with its last y coordinate, points.
    Scrolls(f32),
    /// The pointer has the handle.
    Grabbed(PointerGrab),
}

/// The position of the handle under the pointer. It is not clamped, so that moving back from beyond
/// an end takes as long a way as moving there.
#[derive(Clone, Copy, Debug)]
struct PointerGrab {
    position: f64,
    pointer_x: f32,
}

/// The distance after which a finger is known to slide or scroll, points.
const DECIDED: f32 = 6.0;

pub(super) fn drag(value: f64, row: &SliderRow<'_>, hit: Rect, out: &mut SliderResponse, ui: &Ui) {
    let response = out.response.clone();
    let hold_id = response.id.with("held");
    let hold = ui.data(|data| data.get_temp::<Hold>(hold_id));
    let rail = rail(hit, ui);
    let pointer = response.interact_pointer_pos().filter(|_| response.is_pointer_button_down_on());
    let Some(pointer) = pointer else {
        match hold {
            None => return,
            Some(Hold::Undecided(at)) => {
                let held = taken(value, row, rail, at.x, ui);
                out.changed = Some(row.value_at(held.position, row.step));
                (out.drag_started, out.drag_ended) = (true, true);
                response.request_focus();
            }
            Some(Hold::Scrolls(_)) => {}
            Some(Hold::Grabbed(_)) => out.drag_ended = true,
        }
        ui.data_mut(|data| data.remove::<Hold>(hold_id));
        return;
    };
    let hold = match hold {
        None if pointer_in_use(ui) == PointerKind::Finger => Hold::Undecided(pointer),
        None => {
            out.drag_started = true;
            Hold::Grabbed(taken(value, row, rail, pointer.x, ui))
        }
        Some(Hold::Undecided(from)) => {
            let way = pointer - from;
            if way.length() < DECIDED {
                Hold::Undecided(from)
            } else if way.y.abs() > way.x.abs() {
                Hold::Scrolls(from.y)
            } else {
                out.drag_started = true;
                Hold::Grabbed(moved_on(taken(value, row, rail, from.x, ui), pointer.x, rail, ui))
            }
        }
        Some(Hold::Grabbed(held)) => Hold::Grabbed(moved_on(held, pointer.x, rail, ui)),
        Some(scrolls @ Hold::Scrolls(_)) => scrolls,
    };
    let hold = match hold {
        Hold::Scrolls(y) => {
            let way = vec2(0.0, pointer.y - y);
            ui.scroll_with_delta_animation(way, ScrollAnimation::none());
            Hold::Scrolls(pointer.y)
        }
        other => other,
    };
    ui.data_mut(|data| data.insert_temp(hold_id, hold));
    let Hold::Grabbed(held) = hold else { return };
    if out.drag_started {
        response.request_focus();
    }
    let fine = ui.input(|input| input.modifiers.shift);
    let moved = !out.drag_started || (held.position - row.position(value)).abs() > f64::EPSILON;
    if moved && ui.input(|input| out.drag_started || input.pointer.delta() != Vec2::ZERO) {
        out.changed = Some(row.value_at(held.position, if fine { row.fine } else { row.step }));
    }
}

/// Returns the grab of the handle by a press at `x`. A press on the handle keeps the value; a press
/// elsewhere on the track moves it to the pointer.
fn taken(value: f64, row: &SliderRow<'_>, rail: Rect, x: f32, ui: &Ui) -> PointerGrab {
    let width = f64::from(rail.width().max(1.0));
    let position = row.position(value);
    let handle_x = f64::from(rail.left()) + position * width;
    let grabbed = (f64::from(x) - handle_x).abs() <= f64::from(theme_of(ui).hit()) / 2.0;
    let position = if grabbed { position } else { f64::from(x - rail.left()) / width };
    PointerGrab { position, pointer_x: x }
}

/// Returns the grab after the pointer has moved to `x`.
fn moved_on(held: PointerGrab, x: f32, rail: Rect, ui: &Ui) -> PointerGrab {
    let speed = if ui.input(|input| input.modifiers.shift) { 0.1 } else { 1.0 };
    let way = f64::from(x - held.pointer_x) / f64::from(rail.width().max(1.0));
    PointerGrab { position: held.position + speed * way, pointer_x: x }
}

pub(super) fn keys(value: f64, row: &SliderRow<'_>, out: &mut SliderResponse, ui: &Ui) {
    if !out.response.has_focus() {
        return;
    }
    let filter =
        EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
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
            // A step of a logarithmic track is a fiftieth of its length: linear steps would miss
            // the small values.
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

/// Returns the line along which the middle of the handle moves.
fn rail(area: Rect, ui: &Ui) -> Rect {
    area.shrink2(vec2(handle_radius(ui), 0.0))
}

fn handle_radius(ui: &Ui) -> f32 {
    let theme = theme_of(ui);
    if theme.touch { 11.0 } else { 7.0 * theme.scale() }
}

pub(super) fn paint_track(
    value: f64,
    row: &SliderRow<'_>,
    area: Rect,
    response: &Response,
    ui: &Ui,
) {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let enabled = ui.is_enabled();
    let thickness = 4.0 * theme.scale();
    let rail = rail(area, ui);
    let bar = Rect::from_center_size(area.center(), vec2(area.width(), thickness));
    let x_of = |value: f64| rail.left() + row.position(value) as f32 * rail.width();
    let painter = ui.painter();
    painter.rect_filled(bar, thickness / 2.0, palette.track);
    let auto = row.source == Source::Auto;
    // The bar of an automatic value is quieter.
    let fill =
        faded(if auto { palette.accent.gamma_multiply(0.45) } else { palette.accent }, enabled);
    let handle = pos2(x_of(value), bar.center().y);
    painter.rect_filled(
        Rect::from_min_max(bar.min, pos2(handle.x, bar.bottom())),
        thickness / 2.0,
        fill,
    );
    for mark in row.marks {
        let x = x_of(mark.value);
        let tick = Rect::from_center_size(
            pos2(x, bar.center().y),
            vec2(2.0 * theme.scale(), thickness + 6.0),
        );
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
    // The default is a nick below the track, where a double click goes, while the track is used.
    let default_x = x_of(row.default);
    if !auto && grown > 0.0 && (default_x - handle.x).abs() > radius + 2.0 {
        let nick = Rect::from_center_size(pos2(default_x, bar.bottom() + 4.0), vec2(2.0, 4.0));
        painter.rect_filled(nick, 1.0, palette.muted.gamma_multiply(grown));
    }
}
