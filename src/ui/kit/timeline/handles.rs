//! The handles of a timeline: the edges of the transition, and the ends of the loop.

use super::super::assistive::{Adjustable, requested};
use super::super::keys::keys_pressed;
use super::super::paint::focus_ring;
use super::super::time_axis::TimeAxis;
use super::content::{Timeline, TimelineEvent};
use crate::ui::language::{Word, say};
use crate::ui::theme::{palette_of, radius, theme_of};
use eframe::egui::{
    CursorIcon, EventFilter, Id, Key, Rangef, Rect, Response, Sense, Shape, Stroke, Ui, pos2, vec2,
};

/// The handles of a timeline.
pub(super) struct Handles {
    /// The axis of time.
    pub(super) axis: TimeAxis,
    /// The upper end of their lines.
    pub(super) top: f32,
    /// The lower end of their lines.
    pub(super) bottom: f32,
    /// The timeline they belong to.
    pub(super) id: Id,
}

impl Handles {
    /// Draws an edge of the transition: a line, with a grip while the pointer is on it.
    pub(super) fn edge_ui(
        &self,
        name: Word,
        time: f64,
        event: fn(f64) -> TimelineEvent,
        timeline: &Timeline<'_>,
        events: &mut Vec<TimelineEvent>,
        ui: &Ui,
    ) {
        let response = self.handle(
            name,
            time,
            Rangef::new(self.top, self.bottom),
            theme_of(ui).hit() / 2.0,
            event,
            timeline,
            events,
            ui,
        );
        let palette = palette_of(ui);
        let hot = ui.ctx().animate_bool(
            response.id,
            response.hovered() || response.dragged() || response.has_focus(),
        );
        let x = ui.painter().round_to_pixel_center(self.axis.x_of(time));
        let tone = palette.accent.gamma_multiply(0.35 + 0.65 * hot);
        ui.painter().vline(
            x,
            self.top..=self.bottom,
            Stroke::new(theme_of(ui).hairline() + hot, tone),
        );
        if hot > 0.0 {
            let grip = Rect::from_center_size(
                pos2(x, f32::midpoint(self.top, self.bottom)),
                vec2(5.0, 22.0),
            );
            ui.painter().rect_filled(grip, 2.5, palette.accent.gamma_multiply(hot));
        }
    }

    /// Draws an end of the loop: a flag that hangs into the loop.
    #[expect(
        clippy::too_many_arguments,
        reason = "the two ends differ in three of them, and a struct would only be taken apart again"
    )]
    pub(super) fn flag_ui(
        &self,
        name: Word,
        time: f64,
        rightward: bool,
        event: fn(f64) -> TimelineEvent,
        timeline: &Timeline<'_>,
        events: &mut Vec<TimelineEvent>,
        ui: &Ui,
    ) {
        let response = self.handle(
            name,
            time,
            Rangef::new(self.top - 6.0, self.top - 6.0 + theme_of(ui).hit()),
            theme_of(ui).hit(),
            event,
            timeline,
            events,
            ui,
        );
        let palette = palette_of(ui);
        let hot = ui.ctx().animate_bool(
            response.id,
            response.hovered() || response.dragged() || response.has_focus(),
        );
        let x = ui.painter().round_to_pixel_center(self.axis.x_of(time));
        let tone = palette.muted.lerp_to_gamma(palette.text, hot);
        ui.painter().vline(
            x,
            self.top..=self.bottom,
            Stroke::new(theme_of(ui).hairline(), tone.gamma_multiply(0.7)),
        );
        let reach = if rightward { 7.0 } else { -7.0 };
        let flag = vec![pos2(x, self.top), pos2(x + reach, self.top), pos2(x, self.top + 9.0)];
        ui.painter().add(Shape::convex_polygon(flag, tone, Stroke::NONE));
    }

    #[expect(clippy::too_many_arguments, reason = "private, and each is one plain thing")]
    fn handle(
        &self,
        name: Word,
        time: f64,
        y: Rangef,
        width: f32,
        event: fn(f64) -> TimelineEvent,
        timeline: &Timeline<'_>,
        events: &mut Vec<TimelineEvent>,
        ui: &Ui,
    ) -> Response {
        let x = self.axis.x_of(time);
        let hit = Rect::from_x_y_ranges(x - width / 2.0..=x + width / 2.0, y);
        let response = ui
            .interact(hit, self.id.with(name.english()), Sense::drag())
            .on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
        if response.drag_started() {
            response.request_focus();
            events.push(TimelineEvent::EditStarted);
        }
        if let Some(pointer) = response
            .interact_pointer_pos()
            .filter(|_| response.dragged() && ui.input(|i| i.pointer.delta().x != 0.0))
        {
            events.push(event(self.axis.time_at(pointer.x)));
        }
        if response.drag_stopped() {
            events.push(TimelineEvent::EditEnded);
        }
        let frame = if timeline.fps > 0.0 { 1.0 / timeline.fps } else { timeline.duration / 100.0 };
        let range = 0.0..=timeline.duration.max(0.0);
        if let Some(asked) = requested(response.id, time, &range, frame, ui) {
            events.push(event(asked));
        }
        if response.has_focus() {
            let filter = EventFilter { horizontal_arrows: true, ..EventFilter::default() };
            ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
            let frames = keys_pressed(ui).into_iter().map(|(key, modifiers)| {
                let frames = if modifiers.shift { 10.0 } else { 1.0 };
                frames
                    * (f64::from(u8::from(key == Key::ArrowRight))
                        - f64::from(u8::from(key == Key::ArrowLeft)))
            });
            let presses: f64 = frames.sum();
            if presses != 0.0 {
                events.push(event((time + presses * frame).clamp(0.0, timeline.duration)));
            }
        }
        let (said, help) = (format!("{time:.2} s"), String::new());
        let adjustable =
            Adjustable { name: say(name, ui), value: time, range, step: frame, said, help };
        adjustable.describe(&response, ui);
        focus_ring(hit, radius::S, &response, ui);
        response
    }
}
