//! The notices, and the next steps for the user.

mod quality;

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{
    Adapter, Connection,
    bus::{Activity, MotorStatus},
    experiments::analysis::WhenSilent,
    protocol::{Mode, MotorId},
};

use crate::{
    features::notices::quality::watch_quality,
    model::{
        guards::{blocked_by_silence, drive_blocked_by},
        help_topic::HelpTopic,
        notice_board::{NoticeBoard, Posted, Remedy, Tone, Topic},
        page::use_page,
        replay,
        snapshot::{Reading, Session},
        terms,
    },
    ui::{
        format,
        reactive::{dynamic, handler},
    },
};

/// The action of a notice's button, which other features carry out.
pub(crate) type OnRemedy = &'static dyn Fn(Remedy);

/// The place of the notices, which is reserved so that nothing moves. Without a notice it shows the next steps, or
/// the tour at a first visit.
#[component]
pub(crate) fn Notices(
    /// Whether nothing else needs the place.
    is_alone: Signal<bool>,
    /// Whether the tour is shown instead of the next steps.
    is_tour_shown: Signal<bool>,
    on_remedy: OnRemedy,
    saved_session: impl IntoView + 'static,
    tour: impl IntoView + 'static,
) -> impl IntoView {
    let page = use_page();
    watch_quality();
    let none = move || page.notices.with(|board| board.posted().next().is_none());
    let next = page.of_motor(move |session, id| {
        let when_silent = page
            .motors
            .names
            .with(|names| names.member(id)?.when_silent);
        next_steps(session, id, when_silent).join("\n")
    });
    let slots: Vec<_> = (0..NoticeBoard::SLOTS)
        .map(|place| view! { <Slot place on_remedy /> })
        .collect();
    view! {
        <section
            class="panel notices"
            aria-label=tr!("Notices")
            class:empty=dynamic(move || none() && is_alone.get())
        >
            {saved_session}
            {tour}
            <div hidden=dynamic(move || !none() || is_tour_shown.get())>
                <h2>{tr!("Next steps")}</h2>
                <p class="next-steps">
                    {dynamic(move || if none() { next.get() } else { String::new() })}
                </p>
            </div>
            <div class="notice-list">{slots}</div>
        </section>
    }
}

/// A place for one notice.
#[component]
fn Slot(place: usize, on_remedy: OnRemedy) -> impl IntoView {
    let page = use_page();
    let notice = move |read: fn(&Posted) -> String| {
        dynamic(move || {
            page.notices
                .with(|board| board.slot(place).map(read).unwrap_or_default())
        })
    };
    let remedy = move || {
        page.notices
            .with(|board| board.slot(place).and_then(|posted| posted.words.remedy))
    };
    let topic = move || {
        page.notices
            .with(|board| board.slot(place).and_then(|posted| posted.words.help))
    };
    view! {
        <div
            class=notice(|posted| {
                let tone = match posted.words.tone {
                    Tone::Calm => "notice calm",
                    Tone::Warning => "notice warning",
                    Tone::Error => "notice error",
                };
                // Its advice is in Link health too.
                let is_of_link = matches!(posted.words.topic, Topic::Quality | Topic::Silence);
                [tone, if is_of_link { " of-link" } else { "" }].concat()
            })
            role=notice(|posted| {
                let role = if posted.words.tone == Tone::Calm { "status" } else { "alert" };
                role.to_owned()
            })
            // The newest on top.
            style=("order", notice(|posted| format!("-{}", posted.number)))
            hidden=dynamic(move || page.notices.with(|board| board.slot(place).is_none()))
        >
            <p class="notice-title">{notice(|posted| posted.words.title.clone())}</p>
            <p class="notice-advice">{notice(|posted| posted.words.advice.join("\n"))}</p>
            <button
                type="button"
                class="button small"
                hidden=dynamic(move || remedy().is_none())
                on:click=handler(move |_| {
                    if let Some(remedy) = remedy() {
                        on_remedy(remedy);
                    }
                })
            >
                {dynamic(move || remedy().map_or("", |remedy| remedy.label()))}
            </button>
            <button
                type="button"
                class="help-link"
                hidden=dynamic(move || topic().is_none())
                data-help=dynamic(move || topic().map(HelpTopic::id))
            >
                {dynamic(move || topic().map(HelpTopic::link))}
            </button>
            <button
                type="button"
                class="dismiss"
                aria-label=tr!("Dismiss")
                title=tr!("Dismiss")
                on:click=handler(move |_| {
                    page.notices
                        .update(|board| {
                            let number = board.slot(place).map(|posted| posted.number);
                            board.dismiss(number.unwrap_or_default());
                        });
                })
            ></button>
        </div>
    }
}

/// The next steps for the user, in order.
fn next_steps(session: &Session, id: MotorId, when_silent: Option<WhenSilent>) -> Vec<String> {
    let power_switch = power_switch(id, when_silent);
    let steps: &[&str] = match session.connection {
        // The first screen says how to begin.
        Connection::Disconnected | Connection::Failed(_) => &[],
        Connection::Connecting => &[tr!("Opening the port.")],
        Connection::Reconnecting(_) => &[
            tr!("Plug the adapter back in. No motor starts until you press Start."),
            &power_switch,
        ],
        Connection::Connected(Adapter::Recording) => &[replay::blocked()],
        Connection::Connected(_) if session.halted => {
            &[tr!("STOP is active. Press Release to drive again.")]
        }
        Connection::Connected(_) => {
            let mut steps = vec![next_with_motor(session, id)];
            // Beside Disconnect, while it matters.
            if session.active_motors().next().is_some() {
                steps.push(power_switch);
            }
            return steps;
        }
    };
    steps.iter().map(|step| (*step).to_owned()).collect()
}

/// What nothing on this page can do: said before anything is driven. Of a tested motor it is a fact; a time-out of its
/// firmware is no safety measure.
fn power_switch(id: MotorId, when_silent: Option<WhenSilent>) -> String {
    match when_silent {
        None => tr!(
            "If the cable or the computer fails, the wheel may keep turning. Only the power switch \
             stops it then."
        )
        .to_owned(),
        Some(WhenSilent::Keeps) => tr!(
            "If the cable or the computer fails, motor {id} keeps its last command: that was \
             tested. Only the power switch stops it then.",
            id
        ),
        Some(tested) => tr!(
            "Tested: when frames cease, motor {id} {behaviour}. Do not rely on it: use the power \
             switch.",
            id,
            behaviour = terms::when_silent(tested)
        ),
    }
}

fn next_with_motor(session: &Session, id: MotorId) -> String {
    let of = session.motor(id);
    let idle = |motor: &&MotorStatus| motor.activity == Activity::Idle;
    if let Some(motor) = of.filter(idle).filter(|of| of.turns_unasked || of.may_turn) {
        return if motor.turns_unasked {
            tr!(
                "Motor {id} moves, and nothing here drives it. Press Stop it.",
                id
            )
        } else {
            tr!(
                "Motor {id} has not confirmed standstill: its wheel may turn. Press STOP, or switch off its \
                 power.",
                id
            )
        };
    }
    let Some(mode) = session.mode(id).filter(Reading::is_fresh) else {
        return blocked_by_silence(session, id)
            .unwrap_or_else(|| tr!("Waiting for a reply from motor {id}.", id));
    };
    let activity = of.map(|motor| motor.activity);
    match (activity, mode.value) {
        (Some(Activity::Driven { setpoint }), _) => {
            tr!(
                "Motor {id} is running: {goal}. Space or Escape stops all motors.",
                id,
                goal = format::goal(setpoint)
            )
        }
        (Some(Activity::DrivenRaw), _) => {
            tr!(
                "Raw frames are driving motor {id}. Space or Escape stops all motors.",
                id
            )
        }
        (Some(Activity::Stopping { .. }), _) => tr!("Braking motor {id}.", id),
        (_, mode)
            if session
                .faults(id)
                .is_some_and(|faults| !faults.value.is_none()) =>
        {
            drive_blocked_by(session, id, mode).unwrap_or_default()
        }
        (_, Mode::Velocity) => {
            tr!("Keep fingers clear of the wheel and press +50, or set a speed and press Start.")
                .to_owned()
        }
        (_, Mode::Current | Mode::OpenLoop) => {
            tr!("Set a current and press Start. An unloaded wheel accelerates to full speed.")
                .to_owned()
        }
        (_, Mode::Position) => tr!("Set a target angle and press Go.").to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use motorlink_messages::protocol::{Setpoint, SpeedTarget};

    use super::*;
    use crate::model::snapshot::tests::{ID, session, status};

    #[test]
    fn on_an_open_port_there_is_always_a_next_step() {
        let mut session = session(1_000, status(1_000, Mode::Velocity, 0));
        assert!(next_steps(&session, ID, None)[0].contains("press +50"));
        session.motors[0].activity = Activity::Driven {
            setpoint: Setpoint::velocity(SpeedTarget::clamped(100)),
        };
        let driven = next_steps(&session, ID, None);
        assert!(driven[0].contains("+100 rpm"));
        assert!(driven[1].contains("Only the power switch"), "{driven:?}");
        session.motors[0].activity = Activity::Idle;
        session.motors[0].may_turn = true;
        assert!(next_steps(&session, ID, None)[0].contains("may turn"));
        session.motors[0].turns_unasked = true;
        assert!(next_steps(&session, ID, None)[0].contains("Press Stop it"));
        session.halted = true;
        assert!(next_steps(&session, ID, None)[0].contains("Release"));
        session.halted = false;
        session.motors.clear();
        assert!(next_steps(&session, ID, None)[0].contains("Waiting"));
        session.connection = Connection::Reconnecting(Adapter::VIRTUAL);
        let replug = next_steps(&session, ID, None);
        assert!(replug[1].contains("may keep turning"), "{replug:?}");
        let tested = |it| next_steps(&session, ID, Some(it))[1].clone();
        assert!(tested(WhenSilent::Keeps).contains("keeps its last command"));
        for it in [WhenSilent::Coasts, WhenSilent::Brakes] {
            assert!(tested(it).contains("Do not rely on it"));
        }
    }
}
