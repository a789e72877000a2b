//! STOP: on every screen, over every dialog, never disabled.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::bus::StopReason;

use crate::{model::desk::use_desk, ui::reactive::heard};

#[component]
pub(crate) fn StopButton() -> impl IntoView {
    let desk = use_desk();
    view! {
        <button
            type="button"
            class="stop"
            aria-label=tr!("Stop all motors")
            aria-keyshortcuts="Space Escape"
            title=tr!("Brakes every motor. The power switch is the only emergency stop.")
            // When it is touched, not when the finger is lifted again.
            on:pointerdown=heard(move |_| desk.stop_all(StopReason::Operator))
            on:click=heard(move |click: web_sys::MouseEvent| {
                // By keyboard or a screen reader: no pointer went down before.
                if click.detail() == 0 {
                    desk.stop_all(StopReason::Operator);
                }
            })
        >
            <span class="stop-word">{tr!("STOP")}</span>
            <span class="stop-keys">{tr!("Space · Esc")}</span>
        </button>
    }
}
