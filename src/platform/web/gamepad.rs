//! Gamepads of the browser.

use super::page::window;
use crate::platform::gamepad::Gamepad;
use wasm_bindgen::JsCast as _;

/// Returns the state of the first gamepad that has two sticks. Browsers hide a gamepad until one of
/// its buttons is pressed. Buttons are numbered as in the [standard
/// layout](https://www.w3.org/TR/gamepad/#remapping).
pub(crate) fn gamepad() -> Option<Gamepad> {
    let pads = window()?.navigator().get_gamepads().ok()?;
    let pads = pads.iter().filter_map(|pad| pad.dyn_into::<web_sys::Gamepad>().ok());
    pads.filter(web_sys::Gamepad::connected).find_map(|pad| {
        let (axes, buttons) = (pad.axes(), pad.buttons());
        let axis = |index: u32| axes.get(index).as_f64().map(|value| value as f32);
        let is_down = |index: u32| {
            let button = buttons.get(index).dyn_into::<web_sys::GamepadButton>();
            button.is_ok_and(|button| button.pressed())
        };
        let right = axis(2).zip(axis(3)).unwrap_or_default();
        Some(Gamepad {
            // The browser's vertical axes point down.
            left: [axis(0)?, -axis(1)?],
            right: [right.0, -right.1],
            run: [0, 5, 7].into_iter().any(is_down),
            strafe: [4, 6].into_iter().any(is_down),
        })
    })
}
