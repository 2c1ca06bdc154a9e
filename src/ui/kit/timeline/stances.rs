//! Stances on the timeline that can be corrected: each is a widget for pointer, keys and screen
//! readers, and its ends can be dragged.

use super::super::assistive::{Adjustable, describe, requested};
use super::super::icon::{Icon, paint_icon};
use super::super::keys::keys_pressed;
use super::super::menu::{MenuItem, context_menu_ui, menu_item_ui, menu_line_ui, menu_ui};
use super::super::paint::{Run, focus_ring, line_of, put};
use super::super::time_axis::TimeAxis;
use super::super::words;
use super::content::{StanceEdit, StanceEvent, Stripe, Timeline, TimelineEvent};
use crate::ui::language::{Word, say};
use crate::ui::theme::{Type, palette_of, radius, theme_of};
use eframe::egui::{
    Align2, CursorIcon, EventFilter, Id, Key, Rangef, Rect, RectAlign, Response, Role, Sense,
    Stroke, Ui, WidgetInfo, pos2, vec2,
};
use segue_motion::clip::StanceEnd;
use segue_text::{Message, msg};
use std::ops::Range;

/// Width of the place where an end is taken hold of, points; a narrow stance leaves less.
const GRIP: f32 = 12.0;
/// Stances narrower than this are drawn, but are no widgets, points.
const MIN_WIDTH: f32 = 3.0;

/// The stances of one motion on the screen.
pub(super) struct Lanes<'a> {
    pub(super) index: usize,
    pub(super) stripe: &'a Stripe<'a>,
    pub(super) edit: &'a StanceEdit,
    /// The line of each foot.
    pub(super) rows: Vec<Rangef>,
    pub(super) axis: TimeAxis,
    pub(super) id: Id,
}

impl Lanes<'_> {
    /// Handles the input to the stances and to the gaps between them, and draws their marks.
    pub(super) fn stances_ui(
        &self,
        timeline: &Timeline<'_>,
        events: &mut Vec<TimelineEvent>,
        ui: &mut Ui,
    ) {
        for (foot, (&lane, stances)) in self.rows.iter().zip(&self.stripe.feet).enumerate() {
            self.gaps_ui(foot, lane, timeline, events, ui);
            for (stance, span) in stances.iter().enumerate() {
                let rect = Rect::from_x_y_ranges(
                    self.axis.x_of(span.start)..=self.axis.x_of(span.end.min(timeline.duration)),
                    lane,
                );
                if rect.width() >= MIN_WIDTH {
                    self.stance_ui([foot, stance], span, rect, timeline, events, ui);
                }
            }
            for span in self.edit.corrected.get(foot).into_iter().flatten() {
                let x =
                    self.axis.x_of(span.start)..=self.axis.x_of(span.end.min(timeline.duration));
                let stroke = Stroke::new(1.5 * theme_of(ui).scale(), palette_of(ui).text);
                ui.painter().hline(x, lane.max - 1.0, stroke);
            }
        }
    }

    /// Returns the words for the feet.
    fn words(&self) -> &'static [words::FootWords] {
        words::feet(self.stripe.feet.len())
    }

    fn event(&self, event: StanceEvent) -> TimelineEvent {
        TimelineEvent::Stance { stripe: self.index, event }
    }

    /// Returns a correction that is a step for undo of its own.
    fn once(&self, event: StanceEvent) -> [TimelineEvent; 3] {
        [TimelineEvent::EditEnded, self.event(event), TimelineEvent::EditEnded]
    }

    /// Adds a stance at a double click, or by the menu.
    fn gaps_ui(
        &self,
        foot: usize,
        lane: Rangef,
        timeline: &Timeline<'_>,
        events: &mut Vec<TimelineEvent>,
        ui: &mut Ui,
    ) {
        let rect = Rect::from_x_y_ranges(self.axis.x, lane);
        // Without focus: a stance can be added by the keyboard in the menu of the stripe.
        let response = ui.interact(rect, self.id.with(("gap", foot)), Sense::CLICK);
        let asked_id = response.id.with("asked");
        let pointer = response.interact_pointer_pos();
        if let Some(pos) = pointer.filter(|_| response.secondary_clicked()) {
            ui.data_mut(|data| data.insert_temp(asked_id, self.axis.time_at(pos.x)));
        }
        let mut added =
            pointer.filter(|_| response.double_clicked()).map(|pos| self.axis.time_at(pos.x));
        context_menu_ui(&response, |ui| {
            if item_ui(words::ADD_CONTACT, true, ui) {
                let asked = ui.data(|data| data.get_temp(asked_id));
                added = Some(asked.unwrap_or(timeline.now));
            }
            self.reset_item_ui(events, ui);
        });
        if let Some(time) = added {
            events.extend(self.once(StanceEvent::Add { foot, time }));
        }
    }

    fn reset_item_ui(&self, events: &mut Vec<TimelineEvent>, ui: &mut Ui) {
        menu_line_ui(ui);
        if item_ui(words::RESET_CONTACTS, self.edit.is_corrected(), ui) {
            events.extend(self.once(StanceEvent::Reset));
        }
    }

    fn stance_ui(
        &self,
        [foot, stance]: [usize; 2],
        span: &Range<f64>,
        rect: Rect,
        timeline: &Timeline<'_>,
        events: &mut Vec<TimelineEvent>,
        ui: &mut Ui,
    ) {
        let id = self.id.with((foot, stance));
        // Clicks alone: a drag over a stance moves the playhead, as anywhere on the timeline.
        let response = ui.interact(rect, id, Sense::click());
        if response.clicked() {
            response.request_focus();
        }
        let moved = |end, time| self.event(StanceEvent::Move { foot, stance, end, time });
        let removed = StanceEvent::Remove { foot, stance };
        let hot = [StanceEnd::Strike, StanceEnd::Lift].map(|end| {
            let (x, inward) = match end {
                StanceEnd::Strike => (rect.left(), 1.0),
                StanceEnd::Lift => (rect.right(), -1.0),
            };
            let inside = (GRIP / 2.0).min(rect.width() / 3.0) * inward;
            let outside = -GRIP / 2.0 * inward;
            let x = Rangef::new((x + inside).min(x + outside), (x + inside).max(x + outside));
            let grip = ui
                .interact(
                    Rect::from_x_y_ranges(x, rect.y_range()),
                    id.with(("grip", end)),
                    Sense::DRAG,
                )
                .on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
            if grip.drag_started() {
                response.request_focus();
                events.extend([TimelineEvent::EditEnded, TimelineEvent::EditStarted]);
            }
            let is_moving = grip.dragged() && ui.input(|input| input.pointer.delta().x != 0.0);
            if let Some(pointer) = grip.interact_pointer_pos().filter(|_| is_moving) {
                events.push(moved(end, self.axis.time_at(pointer.x)));
            }
            if grip.drag_stopped() {
                events.push(TimelineEvent::EditEnded);
            }
            grip.hovered() || grip.dragged()
        });
        let frame = if timeline.fps > 0.0 { timeline.fps.recip() } else { 0.0 };
        let range = 0.0..=span.end;
        if let Some(time) = requested(id, span.start, &range, frame, ui) {
            events.extend([moved(StanceEnd::Strike, time), TimelineEvent::EditEnded]);
        }
        if response.has_focus() {
            let filter = EventFilter { horizontal_arrows: true, ..EventFilter::default() };
            ui.memory_mut(|memory| memory.set_focus_lock_filter(id, filter));
            // Strike and lift, frames.
            let mut steps = [0.0; 2];
            for (key, modifiers) in keys_pressed(ui) {
                match key {
                    Key::ArrowLeft => steps[usize::from(modifiers.shift)] -= 1.0,
                    Key::ArrowRight => steps[usize::from(modifiers.shift)] += 1.0,
                    Key::Delete | Key::Backspace => events.extend(self.once(removed)),
                    _ => {}
                }
            }
            let ends = [(StanceEnd::Strike, span.start), (StanceEnd::Lift, span.end)];
            for ((end, at), frames) in
                ends.into_iter().zip(steps).filter(|(_, steps)| *steps != 0.0)
            {
                events.push(moved(end, (at + frames * frame).max(0.0)));
            }
        }
        if response.lost_focus() {
            events.push(TimelineEvent::EditEnded);
        }
        context_menu_ui(&response, |ui| {
            if item_ui(words::REMOVE_CONTACT, true, ui) {
                events.extend(self.once(removed));
            }
            self.reset_item_ui(events, ui);
        });
        paint_ends(hot, rect, &response, ui);
        let said = msg!("{from:.2} to {to:.2} s", from = span.start, to = span.end);
        let foot = self.words().get(foot).map_or(Word::default(), |words| words.name);
        let name = msg!("{foot}, contact {number}", foot, number = stance + 1);
        let adjustable = Adjustable {
            name: say(&name, ui),
            value: span.start,
            range,
            step: frame,
            said: say(&said, ui),
            help: say(words::STANCE_HELP, ui),
        };
        adjustable.describe(&response, ui);
        focus_ring(rect, radius::S, &response, ui);
        let hint = msg!("{foot}: {said}. {help}", foot, said, help = words::STANCE_HELP);
        response.on_hover_text(say(&hint, ui));
    }

    /// Draws the signs of the feet at the right edge of `place`.
    fn letters_ui(&self, place: Rect, ui: &Ui) {
        for (words, lane) in self.words().iter().zip(&self.rows) {
            let run = Run::new(words.sign, Type::Small, palette_of(ui).muted);
            let at = pos2(place.right(), lane.center());
            put(ui.painter(), at, Align2::RIGHT_CENTER, line_of(&[run], f32::INFINITY, ui));
        }
    }

    /// Draws the label with the menu of the stripe, and a dot where contacts are corrected.
    pub(super) fn label_ui(
        &self,
        place: Rect,
        now: f64,
        events: &mut Vec<TimelineEvent>,
        ui: &mut Ui,
    ) {
        let (theme, palette) = (theme_of(ui), palette_of(ui));
        self.letters_ui(place, ui);
        // The signs of four feet are wider.
        let signs = if self.rows.len() > 2 { 34.0 } else { 18.0 };
        let place = place.with_max_x(place.right() - signs * theme.scale());
        let response = ui
            .interact(place, self.id.with("menu"), Sense::click())
            .on_hover_cursor(CursorIcon::PointingHand);
        let hot = response.hovered() || response.has_focus();
        let ink = if hot { palette.text } else { palette.muted };
        let dot = if self.edit.is_corrected() { 10.0 * theme.scale() } else { 0.0 };
        if dot > 0.0 {
            let center = pos2(place.left() + 0.3 * dot, place.center().y);
            ui.painter().circle_filled(center, 0.3 * dot, palette.accent);
        }
        let mark = (12.0 * theme.scale()).round();
        let run = Run::new(self.stripe.label, Type::Small, ink);
        let label = line_of(&[run], place.width() - dot - mark - 2.0, ui);
        let at = place.left_center() + vec2(dot, 0.0);
        let label = put(ui.painter(), at, Align2::LEFT_CENTER, label);
        let at = pos2(label.right() + 2.0 + 0.5 * mark, place.center().y);
        let mark = Rect::from_center_size(at, vec2(mark, mark));
        paint_icon(Icon::ChevronDown, mark, ink, ui.painter());
        focus_ring(place, radius::S, &response, ui);
        let name = say(self.stripe.label, ui);
        describe(&response, &WidgetInfo::labeled(Role::ComboBox, ui.is_enabled(), name));
        let response = match &self.edit.hint {
            Some(hint) => response.on_hover_text(say(hint, ui)),
            None => response,
        };
        menu_ui(&response, RectAlign::TOP_START, |ui| {
            for (foot, (words, stances)) in self.words().iter().zip(&self.stripe.feet).enumerate() {
                let planted = stances.iter().any(|span| span.contains(&now));
                if item_ui(words.add, !planted, ui) {
                    events.extend(self.once(StanceEvent::Add { foot, time: now }));
                }
            }
            self.reset_item_ui(events, ui);
        });
    }
}

fn item_ui(text: Word, is_enabled: bool, ui: &mut Ui) -> bool {
    let item = MenuItem { text: text.into(), ..MenuItem::default() };
    ui.add_enabled_ui(is_enabled, |ui| menu_item_ui(item, ui).clicked()).inner
}

/// Draws the ends that the pointer is on, and both of a stance that has the focus.
fn paint_ends(hot: [bool; 2], rect: Rect, response: &Response, ui: &Ui) {
    let stroke = Stroke::new(2.0 * theme_of(ui).scale(), palette_of(ui).handle);
    for (is_hot, x) in hot.into_iter().zip([rect.left(), rect.right()]) {
        if is_hot || response.has_focus() {
            ui.painter().vline(x, rect.y_range(), stroke);
        }
    }
}

/// Returns the hint on a clip whose contacts are corrected.
pub(crate) fn corrected_hint(clip: &Message, count: usize) -> Message {
    msg!(
        "The contacts of {clip} are corrected by hand in {count, plural, one {# place} other {# places}}.",
        clip,
        count
    )
}
