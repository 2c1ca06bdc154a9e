//! Input of the time in which only the first part of the program is there.

use eframe::egui::{DroppedFileHandle, Event, RawInput};

/// Input that waits until the whole program is there. The page draws its first frames with a part
/// of it (`web/rest.txt`); to answer a click, they would have to stop until the rest has come.
#[derive(Debug, Default)]
pub(crate) struct HeldInput {
    is_holding: bool,
    events: Vec<Event>,
    dropped: Vec<DroppedFileHandle>,
}

impl HeldInput {
    /// Begins to hold input back.
    pub(crate) fn begin(&mut self) {
        self.is_holding = true;
    }

    /// Lets the next frame have all input.
    pub(crate) fn end(&mut self) {
        self.is_holding = false;
    }

    /// Returns whether input is held back.
    pub(crate) fn is_holding(&self) -> bool {
        self.is_holding
    }

    /// Takes the input of a frame while it is held back; later puts what was held before it.
    pub(crate) fn pass(&mut self, input: &mut RawInput) {
        self.events.append(&mut input.events);
        self.dropped.append(&mut input.dropped_files);
        if self.is_holding {
            input.hovered_files.clear();
        } else {
            input.events = std::mem::take(&mut self.events);
            input.dropped_files = std::mem::take(&mut self.dropped);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{DroppedFile, HoveredFile};
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
