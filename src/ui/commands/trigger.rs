//! The keyboard shortcut of a command, as a type.

use eframe::egui::{Key as Keyboard, Modifiers};

/// A shortcut of a command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Trigger {
    Keys(Modifiers, Keyboard),
    /// The system's shortcut for copying, on any keyboard.
    Copy,
    /// A character, wherever it is on the keyboard.
    Typed(&'static str),
}

/// The cases in which a key goes to the focused widget instead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Focus {
    /// No widget uses the key.
    Ignored,
    /// The key goes to any focused widget.
    Respected,
    /// The key goes to a widget that was focused by the keyboard: after dragging a slider, Space
    /// still plays the motion.
    RespectedByKeyboard,
    /// The key goes to an open menu, which closes itself.
    MenuRespected,
}

pub(super) const NONE: Modifiers = Modifiers::NONE;
pub(super) const SHIFT: Modifiers = Modifiers::SHIFT;
pub(super) const COMMAND: Modifiers = Modifiers::COMMAND;
pub(super) const COMMAND_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);
