//! Buttons `Stop` and `Start` of a loop. The tab Velocity has its own: it is loaded first, and a call into this file adds
//! 400 bytes to what a browser fetches before the page can be used.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::protocol::Mode;

use crate::{
    features::drive::actions::Drive, model::guards::stop_blocked_by, ui::button::PressButton,
};

/// Two cells of a row of buttons. The hint says what `Stop` does in this loop.
pub(crate) fn stop_and_start(
    drive: Drive,
    mode: Mode,
    hint: &'static str,
    start_blocked_by: Signal<Option<String>>,
) -> impl IntoView {
    let stop_blocked_by = drive.page.of_motor(|session, _| stop_blocked_by(session));
    let start = if mode == Mode::Position {
        tr!("Go")
    } else {
        tr!("Start")
    };
    view! {
        <PressButton
            label=tr!("Stop")
            class="button halt"
            hint=hint
            disabled_reason=stop_blocked_by
            on_press=move || drive.stop_motor()
        />
        <PressButton
            label=start
            class="button primary"
            disabled_reason=start_blocked_by
            on_press=move || drive.start(mode)
        />
    }
}
