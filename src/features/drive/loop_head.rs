//! The head of a tab: its loop, what the motor reports, and what a start waits for.

use leptos::prelude::*;
use motorlink_i18n::{terms, tr};
use motorlink_messages::{
    bus::{Activity, MotorStatus},
    protocol::Mode,
};

use crate::{
    features::drive::actions::Drive,
    model::terms::loop_name,
    ui::{format, reactive::dynamic},
};

#[component]
pub(crate) fn LoopHead(drive: Drive, mode: Mode) -> impl IntoView {
    let page = drive.page;
    let reported = page.of_motor(|session, id| {
        let reported = session.mode(id);
        reported.map(|reading| (reading.value, reading.is_fresh()))
    });
    let start = page.of_motor(|session, id| session.motor(id).and_then(stage_of_start));
    let active = move || reported.get() == Some((mode, true));
    let words = move || {
        if let Some(stage) = start.get() {
            return stage;
        }
        let words = reported.get().map_or_else(
            || tr!("Control mode unknown.").to_owned(),
            |(reported, is_fresh)| {
                let mode = terms::mode(reported);
                if is_fresh {
                    tr!("The motor is in the {mode}.", mode)
                } else {
                    tr!("Last reported: {mode}.", mode)
                }
            },
        );
        if page.model.get().spec().needs_enable {
            format!("{words} {}", tr!("Start enables it."))
        } else {
            words
        }
    };
    view! {
        <div class="loop-head">
            <h2>{loop_name(mode)}</h2>
            <span class="chip good" class:absent=dynamic(move || !active())>
                {tr!("active")}
            </span>
            <p class="quiet" role="status">{dynamic(words)}</p>
        </div>
    }
}

/// What a start waits for.
fn stage_of_start(motor: &MotorStatus) -> Option<String> {
    let setpoint = motor.waiting?;
    let goal = format::goal(setpoint);
    Some(if let Activity::Switching { to } = motor.activity {
        tr!(
            "Switching to the {mode}, then {goal}.",
            mode = terms::mode(to),
            goal
        )
    } else {
        tr!("Stopping the wheel, then {goal}.", goal)
    })
}
