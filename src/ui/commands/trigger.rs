//! The keyboard shortcut of a command, as a type.

use eframe::egui::{Key as Keyboard, Modifiers};

/// A way in which the keyboard gives a command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Trigger {
    Keys(Modifiers, Keyboard),
    /// The keys with which the system copies, whatever the keyboard.
    Copy,
    /// A character, wherever it stands on the keyboard.
    Typed(&'static str),
}

/// The cases in which a key is left to the widget that has the focus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Focus {
    /// No widget uses the key.
    Ignored,
    /// The key is left to any widget that has the focus.
    Respected,
    /// As [`Self::Respected`], but for widgets that were focused by the pointer: after a drag of a
    /// slider the key plays the motion.
    RespectedByKeyboard,
    /// The key is left to a menu that is open, which closes itself.
    MenuRespected,
}

pub(super) const NONE: Modifiers = Modifiers::NONE;
pub(super) const SHIFT: Modifiers = Modifiers::SHIFT;
pub(super) const COMMAND: Modifiers = Modifiers::COMMAND;
pub(super) const COMMAND_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);
