//! Input while frames are slow: what egui looks at once in a frame happens in frames of its own.
//!
//! egui moves the focus once in a frame, so that of several presses of Tab all but the last would
//! be lost. And it sees a drag only between a press and a release that lie in different frames, so
//! that a quick swipe would be none.

use eframe::egui::{Context, Event, Key, Plugin, Pos2, RawInput};

/// Hands on one press of Tab, and one of press, drag and release, in a frame, and keeps all that
/// came after it for the next ones.
#[derive(Debug, Default)]
pub(crate) struct Pacing {
    waiting: Vec<Event>,
    /// Where the last button went down.
    pressed_at: Option<Pos2>,
}

impl Plugin for Pacing {
    fn debug_name(&self) -> &'static str {
        "segue pacing"
    }

    fn input_hook(&mut self, ctx: &Context, input: &mut RawInput) {
        let mut events = std::mem::take(&mut self.waiting);
        events.append(&mut input.events);
        let click_distance = ctx.options(|options| options.input_options.max_click_dist);
        if let Some(end) = self.end_of_frame(&events, click_distance) {
            self.waiting = events.split_off(end);
        }
        input.events = events;
        if !self.waiting.is_empty() {
            ctx.request_repaint();
        }
    }
}

impl Pacing {
    /// Returns the number of the events that are one frame's, or `None` where all of them are.
    fn end_of_frame(&mut self, events: &[Event], click_distance: f32) -> Option<usize> {
        let (mut is_pressed, mut is_dragged) = (false, false);
        for (index, event) in events.iter().enumerate() {
            match event {
                // Keys typed after Tab belong to the widget that it focuses.
                Event::Key { key: Key::Tab, pressed: true, .. } => {
                    return (index + 1 < events.len()).then_some(index + 1);
                }
                Event::PointerButton { pos, pressed: true, .. } => {
                    (is_pressed, self.pressed_at) = (true, Some(*pos));
                }
                Event::PointerMoved(pos) | Event::PointerButton { pos, pressed: false, .. } => {
                    let is_far =
                        self.pressed_at.is_some_and(|from| from.distance(*pos) > click_distance);
                    let is_release = matches!(event, Event::PointerButton { .. });
                    if (is_far && is_pressed) || (is_release && is_dragged) {
                        return Some(index);
                    }
                    is_dragged |= is_far;
                    if is_release {
                        self.pressed_at = None;
                    }
                }
                _ => {}
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{Id, Memory, Modifiers, PointerButton, Sense, Ui, Vec2, pos2, vec2};

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
        ctx.add_plugin(Pacing::default());
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
        ctx.add_plugin(Pacing::default());
        frame(&ctx, Vec::new());
        frame(&ctx, vec![key(Key::Tab, true), key(Key::Tab, true), key(Key::Enter, true)]);
        let clicked: Vec<usize> = (0..4).flat_map(|_| frame(&ctx, Vec::new()).1).collect();
        assert_eq!(clicked, [1]);
    }

    fn button(pos: Pos2, pressed: bool) -> Event {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        Event::PointerButton { pos, button, pressed, modifiers }
    }

    /// Runs a frame with an area of 200 by 100 points. Returns how far it was dragged, and whether
    /// it was clicked.
    fn area_frame(ctx: &Context, events: Vec<Event>) -> (Vec2, bool) {
        let mut result = (Vec2::ZERO, false);
        let input = RawInput { events, focused: true, ..RawInput::default() };
        let output = ctx.run_ui(input, |ui: &mut Ui| {
            let (_, response) = ui.allocate_exact_size(vec2(200.0, 100.0), Sense::click_and_drag());
            result = (response.drag_delta(), response.clicked());
        });
        output.drop_without_applying_deltas();
        result
    }

    /// Returns how far an area was dragged by events that arrive in these frames, and how often it
    /// was clicked.
    fn dragged(frames: Vec<Vec<Event>>) -> (Vec2, usize) {
        let ctx = Context::default();
        ctx.add_plugin(Pacing::default());
        area_frame(&ctx, Vec::new());
        let empty = std::iter::repeat_with(Vec::new).take(4);
        let seen: Vec<(Vec2, bool)> =
            frames.into_iter().chain(empty).map(|events| area_frame(&ctx, events)).collect();
        let way = seen.iter().fold(Vec2::ZERO, |way, (delta, _)| way + *delta);
        (way, seen.iter().filter(|(_, clicked)| *clicked).count())
    }

    #[test]
    fn drag_of_one_frame_is_as_long_as_one_of_many() {
        let (from, to) = (pos2(30.0, 50.0), pos2(150.0, 60.0));
        let events = [
            Event::PointerMoved(from),
            button(from, true),
            Event::PointerMoved(pos2(90.0, 55.0)),
            Event::PointerMoved(to),
            button(to, false),
            Event::PointerGone,
        ];
        for cuts in 0..1 << (events.len() - 1) {
            let mut frames = vec![Vec::new()];
            for (index, event) in events.iter().enumerate() {
                frames.last_mut().expect("one at least").push(event.clone());
                if cuts >> index & 1 == 1 {
                    frames.push(Vec::new());
                }
            }
            let (way, clicks) = dragged(frames);
            assert!(
                (way - (to - from)).length() < 6.1 && clicks == 0,
                "{cuts:b}: {way:?} {clicks}"
            );
        }
    }

    #[test]
    fn two_clicks_in_one_frame_stay_there() {
        let at = pos2(30.0, 50.0);
        let click = [button(at, true), Event::PointerMoved(at + vec2(2.0, 0.0)), button(at, false)];
        let ctx = Context::default();
        ctx.add_plugin(Pacing::default());
        area_frame(&ctx, vec![Event::PointerMoved(at)]);
        assert!(area_frame(&ctx, click.iter().chain(&click).cloned().collect()).1);
        assert!(!area_frame(&ctx, Vec::new()).1);
    }
}
