//! The dialog after "Stop all motors": the progress of every motor, until Release.

use leptos::{html::Div, prelude::*};
use motorlink_i18n::tr;
use motorlink_messages::{
    bus::{Activity, Command, Refusal},
    protocol::MotorId,
};

use crate::{
    model::{
        notice_texts,
        page::use_page,
        snapshot::{Reading, Session},
        terms,
    },
    ui::{
        button::PressButton,
        focus::focus_when,
        format::{self, UNKNOWN},
        reactive::{dynamic, memo},
    },
};

/// Alertdialog `Stopped`. It covers neither STOP nor the wheel, and nothing drives until Release.
#[component]
pub(crate) fn StoppedDialog() -> impl IntoView {
    let page = use_page();
    let dialog = NodeRef::<Div>::new();
    let halted = memo(move || page.shown.with(Session::is_halted));
    focus_when(halted, dialog);
    let reason = move || {
        page.shown.with(|session| {
            let reason = session.stop.as_ref().map(|stop| stop.reason);
            reason.map_or(
                tr!("STOP is active. Press Release to drive again."),
                notice_texts::of_stop_reason,
            )
        })
    };
    let rows = move || page.shown.with(table_rows);
    view! {
        <div
            class="stopped"
            role="alertdialog"
            aria-label=tr!("Stopped")
            aria-describedby="stopped-why"
            tabindex="-1"
            hidden=dynamic(move || !halted.get())
            node_ref=dialog
        >
            <h2>{tr!("Stopped")}</h2>
            <p id="stopped-why">{dynamic(reason)}</p>
            <table class="stopped-motors">
                <tbody inner_html=dynamic(rows)></tbody>
            </table>
            <div class="stopped-foot">
                <p class="quiet">
                    {tr!(
                        "Press Release to drive again. The power switch is the only emergency stop."
                    )}
                </p>
                <PressButton
                    label=tr!("Release")
                    class="button primary"
                    on_press=move || {
                        page.command(Command::Release);
                        let reason = terms::refusal(Refusal::Halted);
                        page.notices.update(|board| board.withdraw_refusal(&reason));
                    }
                />
            </div>
        </div>
    }
}

/// The rows of the table as HTML.
fn table_rows(session: &Session) -> String {
    let rows: String = stop_lines(session).map(table_row).collect();
    if !rows.is_empty() {
        return rows;
    }
    // A port that is closed during a stop leaves no outcome.
    let none = match &session.stop {
        Some(stop) if stop.ended => tr!("No motor was running."),
        _ => tr!("Stop not confirmed."),
    };
    format!("<tr><td class=\"quiet\">{none}</td></tr>")
}

fn table_row(line: StopLine) -> String {
    let (class, words) = match line.state {
        Standstill::Confirmed => ("good", tr!("stopped, confirmed")),
        Standstill::Braking => ("", tr!("braking")),
        Standstill::NotConfirmed => ("bad", tr!("not confirmed")),
        Standstill::NotDriven => ("good", tr!("not running")),
        Standstill::Turning => ("", tr!("turning")),
    };
    let speed = line
        .speed_rpm
        .map_or_else(|| UNKNOWN.to_owned(), |rpm| format::signed(rpm.into()));
    let motor = tr!("Motor {id}", id = line.id);
    let rpm = format::rpm();
    format!(
        "<tr><th scope=\"row\">{motor}</th><td class=\"stop-speed\">{speed} {rpm}</td>\
         <td class=\"stop-state {class}\">{words}</td></tr>"
    )
}

/// The progress of a motor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Standstill {
    Braking,
    Confirmed,
    NotConfirmed,
    NotDriven,
    /// It stood, or did not have to be stopped, but its wheel turns now: pushed by hand, for example.
    Turning,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct StopLine {
    id: MotorId,
    /// By a recent reply; `None` is unknown, not zero.
    speed_rpm: Option<i16>,
    state: Standstill,
}

/// Every motor that has answered or had to be stopped. The worker reports no motors while a port is on trial or
/// closed; then the outcomes remain.
fn stop_lines(session: &Session) -> impl Iterator<Item = StopLine> {
    let stop = session.stop.as_ref();
    let outcomes = stop.map_or(&[][..], |stop| &stop.outcomes);
    let mut ids = session.found();
    for outcome in outcomes {
        if !ids.contains(&outcome.id) {
            ids.push(outcome.id);
        }
    }
    ids.into_iter().map(move |id| {
        let speed = session.speed(id).filter(Reading::is_fresh);
        let speed_rpm = speed.map(|speed| speed.value.rpm());
        let activity = session.motor(id).map(|motor| motor.activity);
        let outcome = outcomes.iter().find(|outcome| outcome.id == id);
        let state = match (activity, outcome) {
            (Some(Activity::Stopping { confirmed: false }), _) => Standstill::Braking,
            (Some(Activity::Stopping { confirmed: true }), _) => Standstill::Confirmed,
            (_, Some(outcome)) if !outcome.confirmed => Standstill::NotConfirmed,
            _ if speed_rpm.unwrap_or(0) != 0 => Standstill::Turning,
            (_, Some(_)) => Standstill::Confirmed,
            (_, None) => Standstill::NotDriven,
        };
        StopLine {
            id,
            speed_rpm,
            state,
        }
    })
}

#[cfg(test)]
mod tests {
    use motorlink_messages::{
        bus::{StopOutcome, StopReason},
        protocol::Mode,
    };

    use super::*;
    use crate::model::snapshot::{
        StopRecord,
        tests::{ID, session, status},
    };

    fn line(activity: Activity, confirmed: Option<bool>, now_ms: u64) -> StopLine {
        line_at(40, activity, confirmed, now_ms)
    }

    fn line_at(rpm: i16, activity: Activity, confirmed: Option<bool>, now_ms: u64) -> StopLine {
        let mut session = session(now_ms, status(1_000, Mode::Velocity, rpm));
        session.motors[0].activity = activity;
        session.stop = Some(StopRecord {
            reason: StopReason::Operator,
            outcomes: Vec::from_iter(confirmed.map(outcome)),
            ended: true,
        });
        stop_lines(&session).next().unwrap()
    }

    fn outcome(confirmed: bool) -> StopOutcome {
        StopOutcome {
            id: ID,
            confirmed,
            speed: None,
        }
    }

    #[test]
    fn the_dialog_says_which_motor_stands_and_which_did_not_confirm() {
        let braking = Activity::Stopping { confirmed: false };
        let standing = Activity::Stopping { confirmed: true };
        for (activity, confirmed, state) in [
            (braking, None, Standstill::Braking),
            (standing, None, Standstill::Confirmed),
            (Activity::Idle, Some(true), Standstill::Confirmed),
            (Activity::Idle, Some(false), Standstill::NotConfirmed),
            (Activity::Idle, None, Standstill::NotDriven),
        ] {
            assert_eq!(line_at(0, activity, confirmed, 1_000).state, state);
        }
    }

    /// A wheel that is pushed by hand turns, but no stop is needed and none failed.
    #[test]
    fn a_wheel_that_turns_after_its_stop_is_not_called_stopped() {
        for confirmed in [Some(true), None] {
            let row = table_row(line(Activity::Idle, confirmed, 1_000));
            assert!(row.contains("turning"), "{row}");
            // An old speed says nothing about now.
            let row = table_row(line(Activity::Idle, confirmed, 1_600));
            assert!(!row.contains("turning"), "{row}");
        }
        let failed = line(Activity::Idle, Some(false), 1_000);
        assert_eq!(failed.state, Standstill::NotConfirmed);
    }

    /// The port is on trial or closed: the worker reports no motors.
    #[test]
    fn an_outcome_is_shown_without_its_motor() {
        let mut session = Session {
            stop: Some(StopRecord {
                reason: StopReason::Operator,
                outcomes: vec![outcome(false)],
                ended: true,
            }),
            ..Session::default()
        };
        let unconfirmed = StopLine {
            id: ID,
            speed_rpm: None,
            state: Standstill::NotConfirmed,
        };
        assert_eq!(stop_lines(&session).collect::<Vec<_>>(), [unconfirmed]);
        session.stop.as_mut().unwrap().outcomes = vec![outcome(true)];
        let line = stop_lines(&session).next().unwrap();
        assert_eq!(line.state, Standstill::Confirmed);
    }

    #[test]
    fn a_stop_that_has_not_ended_does_not_say_that_nothing_was_running() {
        let mut session = Session::default();
        let rows = |ended| {
            session.stop = Some(StopRecord {
                reason: StopReason::Operator,
                outcomes: vec![],
                ended,
            });
            table_rows(&session)
        };
        let [ended, unplugged] = [true, false].map(rows);
        assert!(ended.contains("No motor was running."), "{ended}");
        assert!(unplugged.contains("Stop not confirmed."), "{unplugged}");
    }

    #[test]
    fn a_row_says_speed_and_state() {
        let line = line(Activity::Stopping { confirmed: false }, None, 1_000);
        assert_eq!(
            table_row(line),
            "<tr><th scope=\"row\">Motor 0x01</th><td class=\"stop-speed\">+40 rpm</td>\
             <td class=\"stop-state \">braking</td></tr>"
        );
    }

    #[test]
    fn an_old_speed_is_unknown() {
        assert_eq!(line(Activity::Idle, None, 1_000).speed_rpm, Some(40));
        assert_eq!(line(Activity::Idle, None, 1_600).speed_rpm, None);
    }
}
