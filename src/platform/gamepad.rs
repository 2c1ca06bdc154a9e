//! The state of a gamepad.

/// The state of a gamepad. Stick positions are from -1 to 1, to the right and up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Gamepad {
    /// The left stick.
    pub(crate) left: [f32; 2],
    /// The right stick.
    pub(crate) right: [f32; 2],
    /// Whether a right shoulder button or the first face button is pressed.
    pub(crate) run: bool,
    /// Whether a left shoulder button is pressed.
    pub(crate) strafe: bool,
}
