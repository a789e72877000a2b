//! STOP: on every screen, over every dialog, never disabled.

use leptos::prelude::*;
use motorlink_i18n::tr;

use crate::ui::reactive::handler;

#[component]
pub(crate) fn StopButton(
    /// Stops all motors.
    on_stop: &'static dyn Fn(),
) -> impl IntoView {
    view! {
        <button
            type="button"
            class="stop"
            aria-label=tr!("STOP all motors")
            aria-keyshortcuts="Space Escape"
            title=tr!("Brakes every motor. The power switch is the only emergency stop.")
            // When it is touched, not when the finger is lifted again.
            on:pointerdown=handler(move |_| on_stop())
            on:click=handler(move |click: web_sys::MouseEvent| {
                // By keyboard or a screen reader: no pointer went down before.
                if click.detail() == 0 {
                    on_stop();
                }
            })
        >
            <span class="stop-word">{tr!("STOP")}</span>
            // Drawn by the style sheet: the keys are no part of the name.
            <span class="stop-keys" data-keys=tr!("Space · Esc")></span>
        </button>
    }
}
