//! Input of the time in which only the first part of the program is there.

use eframe::egui::{DroppedFileHandle, Event, RawInput};

/// Input that waits until the whole program is there. The page draws its first frames with a part
/// of it (`web/rest.txt`); to answer a click, they would have to stop until the rest has come.
///
/// Of several clicks only the last counts: users click again where nothing happens.
#[derive(Debug, Default)]
pub(crate) struct HeldInput {
    is_holding: bool,
    /// Whether what was held is not handed out yet.
    is_late: bool,
    events: Vec<Event>,
    dropped: Vec<DroppedFileHandle>,
}

impl HeldInput {
    /// Begins to hold input back.
    pub(crate) fn begin(&mut self) {
        self.is_holding = true;
    }

    /// Lets the next frames have the input.
    pub(crate) fn end(&mut self) {
        self.is_holding = false;
        self.is_late = true;
        // A button that was released outside of the window is not reported.
        if self.events.iter().rev().find_map(press_of) == Some(true) {
            self.events.retain(|event| press_of(event).is_none());
        }
    }

    /// Returns whether input is held back.
    pub(crate) fn is_holding(&self) -> bool {
        self.is_holding
    }

    /// Takes a frame's input away while input is held back. Afterwards gives frames what was held,
    /// up to a press or release of a button in each, because a frame has one position of the
    /// pointer. Returns whether there is more.
    pub(crate) fn pass(&mut self, input: &mut RawInput) -> bool {
        for event in input.events.drain(..) {
            if self.is_holding && press_of(&event) == Some(true) {
                self.events.retain(|event| press_of(event).is_none());
            }
            self.events.push(event);
        }
        self.dropped.append(&mut input.dropped_files);
        if self.is_holding {
            input.hovered_files.clear();
            return false;
        }
        input.dropped_files = std::mem::take(&mut self.dropped);
        let until = if self.is_late {
            let button = self.events.iter().position(|event| press_of(event).is_some());
            button.map_or(self.events.len(), |at| at + 1)
        } else {
            self.events.len()
        };
        input.events = self.events.drain(..until).collect();
        self.is_late &= !self.events.is_empty();
        self.is_late
    }
}

/// Returns whether a button of the pointer is pressed or released; `None` for other events.
fn press_of(event: &Event) -> Option<bool> {
    if let Event::PointerButton { pressed, .. } = event { Some(*pressed) } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{DroppedFile, HoveredFile, Modifiers, PointerButton, Pos2};
    use std::path::Path;
    use std::sync::Arc;

    #[derive(Debug)]
    struct Dropped(&'static str);

    impl DroppedFile for Dropped {
        fn path(&self) -> &Path {
            Path::new(self.0)
        }

        fn bytes(&self) -> Result<Vec<u8>, String> {
            Ok(Vec::new())
        }
    }

    fn input(text: &'static str) -> RawInput {
        RawInput {
            events: vec![Event::Text(text.to_owned())],
            dropped_files: vec![Arc::new(Dropped(text))],
            hovered_files: vec![HoveredFile::default()],
            ..RawInput::default()
        }
    }

    fn button(x: f32, pressed: bool) -> Event {
        Event::PointerButton {
            pos: Pos2::new(x, 0.0),
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        }
    }

    fn frame(held: &mut HeldInput, events: &[Event]) -> (Vec<Event>, bool) {
        let mut input = RawInput { events: events.to_vec(), ..RawInput::default() };
        let more = held.pass(&mut input);
        (input.events, more)
    }

    #[test]
    fn held_click_is_given_to_frames_one_by_one() {
        let mut held = HeldInput::default();
        held.begin();
        let to = |x| Event::PointerMoved(Pos2::new(x, 0.0));
        let first = [to(1.0), button(1.0, true), button(1.0, false)];
        let last = [to(2.0), button(2.0, true), button(2.0, false), to(3.0)];
        assert_eq!(frame(&mut held, &first), (vec![], false));
        assert_eq!(frame(&mut held, &last), (vec![], false));
        held.end();
        assert_eq!(frame(&mut held, &[to(4.0)]), (vec![to(1.0), to(2.0), button(2.0, true)], true));
        assert_eq!(frame(&mut held, &[to(5.0)]), (vec![button(2.0, false)], true));
        assert_eq!(frame(&mut held, &[]), (vec![to(3.0), to(4.0), to(5.0)], false));
        let click = [button(6.0, true), button(6.0, false)];
        assert_eq!(frame(&mut held, &click), (click.to_vec(), false), "as it came");
    }

    #[test]
    fn held_press_without_a_release_is_dropped() {
        let mut held = HeldInput::default();
        held.begin();
        assert_eq!(frame(&mut held, &[button(1.0, true)]), (vec![], false));
        held.end();
        assert_eq!(frame(&mut held, &[]), (vec![], false));
    }

    /// Passes one frame's input; returns the texts and the files that the frame gets.
    fn passed(held: &mut HeldInput, text: &'static str) -> [Vec<String>; 2] {
        let mut input = input(text);
        held.pass(&mut input);
        assert_eq!(input.hovered_files.is_empty(), held.is_holding());
        let texts = input.events.iter().map(|event| match event {
            Event::Text(text) => text.clone(),
            other => panic!("{other:?}"),
        });
        let files = input.dropped_files.iter().map(|file| file.path().display().to_string());
        [texts.collect(), files.collect()]
    }

    #[test]
    fn pass_without_begin_changes_nothing() {
        assert_eq!(passed(&mut HeldInput::default(), "a"), [["a"], ["a"]]);
    }

    #[test]
    fn held_input_comes_first_and_once() {
        let mut held = HeldInput::default();
        held.begin();
        for text in ["a", "b"] {
            assert_eq!(passed(&mut held, text), [Vec::<String>::new(), Vec::new()]);
        }
        held.end();
        assert_eq!(passed(&mut held, "c"), [["a", "b", "c"], ["a", "b", "c"]]);
        assert_eq!(passed(&mut held, "d"), [["d"], ["d"]]);
    }
}
