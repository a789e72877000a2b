//! The gamepads that can drive a vehicle.

use leptos::prelude::window;
use wasm_bindgen::{JsCast, JsValue};
use web_sys::{Gamepad, GamepadButton};

use crate::features::groups::pad::{GAMEPADS_MAX, Stick};

/// The button to hold: the lowest one on the right of a standard gamepad.
const DEAD_MAN: u32 = 0;

/// For each place, whether the button is down, and the left stick; `None` without a gamepad.
pub(crate) fn poll() -> [Option<(bool, Stick)>; GAMEPADS_MAX as usize] {
    let mut seen = [None; GAMEPADS_MAX as usize];
    // A page without the permission has no gamepads.
    let Ok(gamepads) = window().navigator().get_gamepads() else {
        return seen;
    };
    for (place, seen) in (0..).zip(&mut seen) {
        let gamepad = gamepads.get(place).dyn_into::<Gamepad>().ok();
        *seen = gamepad
            .filter(Gamepad::connected)
            .map(|gamepad| of(&gamepad));
    }
    seen
}

fn of(gamepad: &Gamepad) -> (bool, Stick) {
    let button = gamepad.buttons().get(DEAD_MAN);
    let is_down = button
        .dyn_into::<GamepadButton>()
        .is_ok_and(|button| button.pressed());
    let axes = gamepad.axes();
    let part = |place| JsValue::as_f64(&axes.get(place)).unwrap_or(0.0);
    // The second axis grows downwards.
    (is_down, Stick::new(part(0), -part(1)))
}
