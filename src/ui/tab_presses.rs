//! The Tab key while frames are slow: several presses before one frame are as many stops.
//!
//! egui moves the focus once in a frame, so that all presses but the last of it would be lost.

use eframe::egui::{Context, Event, Key, Plugin, RawInput};

/// Hands on one press of Tab in a frame, and keeps all that came after it for the next ones.
#[derive(Debug, Default)]
pub(crate) struct TabPresses {
    waiting: Vec<Event>,
}

impl Plugin for TabPresses {
    fn debug_name(&self) -> &'static str {
        "segue tab presses"
    }

    fn input_hook(&mut self, ctx: &Context, input: &mut RawInput) {
        let mut events = std::mem::take(&mut self.waiting);
        events.append(&mut input.events);
        if let Some(at) = events.iter().position(is_tab) {
            // Keys typed after Tab belong to the widget that it focuses.
            self.waiting = events.split_off(at + 1);
        }
        input.events = events;
        if !self.waiting.is_empty() {
            ctx.request_repaint();
        }
    }
}

fn is_tab(event: &Event) -> bool {
    matches!(event, Event::Key { key: Key::Tab, pressed: true, .. })
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{Id, Memory, Modifiers, Ui};

    fn key(key: Key, pressed: bool) -> Event {
        Event::Key { key, physical_key: None, pressed, repeat: false, modifiers: Modifiers::NONE }
    }

    /// Runs a frame with eight buttons. Returns the number of the focused one, and of clicks.
    fn frame(ctx: &Context, events: Vec<Event>) -> (Option<usize>, Vec<usize>) {
        let (mut ids, mut clicked): (Vec<Id>, Vec<usize>) = (Vec::new(), Vec::new());
        let input = RawInput { events, focused: true, ..RawInput::default() };
        let output = ctx.run_ui(input, |ui: &mut Ui| {
            (ids, clicked) = (Vec::new(), Vec::new());
            for number in 0..8 {
                let response = ui.button(format!("{number}"));
                ids.push(response.id);
                if response.clicked() {
                    clicked.push(number);
                }
            }
        });
        output.drop_without_applying_deltas();
        let focus = ctx.memory(Memory::focused);
        (ids.iter().position(|id| Some(*id) == focus), clicked)
    }

    #[test]
    fn five_presses_of_tab_in_one_frame_are_five_stops() {
        let ctx = Context::default();
        ctx.add_plugin(TabPresses::default());
        frame(&ctx, Vec::new());
        let presses = [true, false].map(|pressed| key(Key::Tab, pressed));
        frame(&ctx, presses.iter().cycle().take(10).cloned().collect());
        // The last releases take a frame of their own.
        let stops: Vec<Option<usize>> = (0..6).map(|_| frame(&ctx, Vec::new()).0).collect();
        assert_eq!(stops.last(), Some(&Some(4)), "{stops:?}");
    }

    #[test]
    fn key_behind_tab_reaches_the_widget_that_tab_leads_to() {
        let ctx = Context::default();
        ctx.add_plugin(TabPresses::default());
        frame(&ctx, Vec::new());
        frame(&ctx, vec![key(Key::Tab, true), key(Key::Tab, true), key(Key::Enter, true)]);
        let clicked: Vec<usize> = (0..4).flat_map(|_| frame(&ctx, Vec::new()).1).collect();
        assert_eq!(clicked, [1]);
    }
}
