//! Keys as they were pressed, each with the modifiers that were down then.

use eframe::egui::{Event, Key, Modifiers, Ui};

/// The keys pressed in this frame, in order, repeats included. A quick tap of shift and an arrow
/// may fall into one frame: the modifiers at the end of the frame would no longer know of it.
pub(super) fn keys_pressed(ui: &Ui) -> Vec<(Key, Modifiers)> {
    ui.input(|input| {
        let pressed = input.events.iter().filter_map(|event| match event {
            Event::Key { key, pressed: true, modifiers, .. } => Some((*key, *modifiers)),
            _ => None,
        });
        pressed.collect()
    })
}
