//! Pointer, keys and screen readers on the playhead.

use super::super::assistive::{Adjustable, requested};
use super::super::keys::keys_pressed;
use super::super::time_axis::TimeAxis;
use super::super::words;
use super::content::{Timeline, TimelineEvent};
use crate::ui::language::say;
use eframe::egui::{EventFilter, Key, Pos2, Response, Ui};

/// Moves `now` by the user's input, and adds the events.
pub(super) fn scrub_ui(
    timeline: &Timeline<'_>,
    axis: TimeAxis,
    scrub: &Response,
    now: &mut f64,
    events: &mut Vec<TimelineEvent>,
    ui: &Ui,
) {
    let held_id = scrub.id.with("held");
    let was_held = ui.data(|data| data.get_temp::<bool>(held_id)).unwrap_or(false);
    let pointer = scrub.interact_pointer_pos().filter(|_| scrub.is_pointer_button_down_on());
    if let Some(Pos2 { x, .. }) = pointer {
        if !was_held {
            scrub.request_focus();
            ui.data_mut(|data| data.insert_temp(held_id, true));
            events.push(TimelineEvent::ScrubStarted);
        }
        let asked = axis.time_at(x);
        if asked != *now {
            events.push(TimelineEvent::Seek(asked));
            *now = asked;
        }
    } else if was_held {
        ui.data_mut(|data| data.remove::<bool>(held_id));
        events.push(TimelineEvent::ScrubEnded);
    }

    let mut asked = *now;
    let frame = if timeline.fps > 0.0 { 1.0 / timeline.fps } else { timeline.duration / 100.0 };
    if scrub.has_focus() {
        let filter = EventFilter { horizontal_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(scrub.id, filter));
        for (key, modifiers) in keys_pressed(ui) {
            let frames = if modifiers.shift { 10.0 } else { 1.0 };
            // Steps go from one whole frame to the next, also from between two.
            asked = match key {
                Key::ArrowRight => ((asked / frame).round() + frames) * frame,
                Key::ArrowLeft => ((asked / frame).round() - frames) * frame,
                Key::Home => 0.0,
                Key::End => timeline.duration,
                _ => asked,
            };
        }
    }
    let range = 0.0..=timeline.duration.max(0.0);
    asked = requested(scrub.id, asked, &range, frame, ui).unwrap_or(asked);
    asked = asked.clamp(0.0, timeline.duration.max(0.0));
    if asked != *now {
        events.push(TimelineEvent::Seek(asked));
        *now = asked;
    }
    let adjustable = Adjustable {
        name: say(words::TIMELINE, ui),
        value: *now,
        range,
        step: frame,
        said: format!("{now:.2} s"),
        help: String::new(),
    };
    adjustable.describe(scrub, ui);
}
