//! Gamepads of a desktop window: none.

use crate::platform::gamepad::Gamepad;

/// Returns `None`: gamepads would need a crate of their own for each operating system.
pub(crate) fn gamepad() -> Option<Gamepad> {
    None
}
