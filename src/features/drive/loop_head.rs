//! The head of a tab: its loop, what the motor reports, and the switch.

use leptos::prelude::*;
use motorlink_i18n::{terms, tr};
use motorlink_messages::protocol::Mode;

use crate::{
    features::drive::actions::Drive,
    model::{guards::switch_blocked_by, snapshot::Reading, terms::loop_name},
    ui::{button::PressButton, reactive::dynamic},
};

#[component]
pub(crate) fn LoopHead(drive: Drive, mode: Mode) -> impl IntoView {
    let page = drive.page;
    let reported = page.of_motor(|session, id| {
        let reported = session.mode(id).filter(Reading::is_fresh);
        reported.map(|reading| reading.value)
    });
    let active = move || reported.get() == Some(mode);
    let words = move || {
        let words = reported.get().map_or_else(
            || tr!("Loop unknown.").to_owned(),
            |reported| tr!("The motor is in the {mode}.", mode = terms::mode(reported)),
        );
        if page.model.get().spec().needs_enable {
            format!("{words} {}", tr!("Start enables it."))
        } else {
            words
        }
    };
    let disabled_reason = page.of_motor(move |session, id| switch_blocked_by(session, id, mode));
    view! {
        <div class="loop-head">
            <h2>{loop_name(mode)}</h2>
            <span class="chip good" class:absent=dynamic(move || !active())>
                {tr!("active")}
            </span>
            <PressButton
                label=tr!("Switch to {mode}", mode = terms::mode(mode))
                class="button small"
                disabled_reason=disabled_reason
                on_press=move || drive.switch(mode)
            />
            <p class="quiet">{dynamic(words)}</p>
        </div>
    }
}
