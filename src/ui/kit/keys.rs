//! Pressed keys, each with its modifiers.

use eframe::egui::{Event, Key, Modifiers, Ui};

/// Returns the keys pressed in this frame, in order, with repeats. A quick tap of Shift and an
/// arrow may fall into one frame, so that Shift is released at its end.
pub(super) fn keys_pressed(ui: &Ui) -> Vec<(Key, Modifiers)> {
    ui.input(|input| {
        let pressed = input.events.iter().filter_map(|event| match event {
            Event::Key { key, pressed: true, modifiers, .. } => Some((*key, *modifiers)),
            _ => None,
        });
        pressed.collect()
    })
}
