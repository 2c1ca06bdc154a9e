//! Gamepads of a desktop window: none.

use crate::platform::Gamepad;

/// A gamepad that is there. Windows have none: that would be a crate of its own for each system.
pub(crate) fn gamepad() -> Option<Gamepad> {
    None
}
