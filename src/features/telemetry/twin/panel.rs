//! The panel with the twin.

use leptos::prelude::*;
use motorlink_i18n::{terms, tr};
use motorlink_messages::bus::Activity;

use crate::{
    features::telemetry::{
        readings::Readings,
        twin::{DigitalTwin, texts::no_motor},
    },
    model::terms::loop_name,
    ui::{format, reactive::dynamic},
};

#[component]
pub(crate) fn WheelPanel(readings: Readings) -> impl IntoView {
    let page = readings.page;
    let chip = page.of_motor(|session, id| {
        let activity = session
            .motor(id)
            .map_or(Activity::Idle, |motor| motor.activity);
        let words = match activity {
            Activity::Driven { setpoint } => tr!("Target {goal}", goal = format::goal(setpoint)),
            Activity::Stopping { .. } => tr!("Braking to a standstill").to_owned(),
            Activity::DrivenRaw => tr!("Driven by raw frames").to_owned(),
            Activity::Switching { to } => tr!("Switching to the {mode}", mode = terms::mode(to)),
            Activity::Idle => match session.mode(id) {
                Some(mode) => loop_name(mode.value).to_owned(),
                None => return no_motor(session.connection).to_owned(),
            },
        };
        // The figures below the wheel describe the wheel as the user sees it.
        if session.mirror(id).is_mirrored() {
            tr!("{words} · mirrored", words)
        } else {
            words
        }
    });
    let driven = page.of_motor(|session, id| {
        let activity = session.motor(id).map(|motor| motor.activity);
        matches!(activity, Some(Activity::Driven { .. }))
    });
    view! {
        <section class="panel wheel-panel" aria-label=tr!("Wheel")>
            <p class="chip wheel-chip" class:active=driven>
                <span class="motor-title"></span>
                {dynamic(move || chip.get())}
            </p>
            <DigitalTwin feed=readings.twin model=page.model clock=page.worker.clock />
        </section>
    }
}
