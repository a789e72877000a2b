//! The dialog after "Stop all motors": the progress of every motor, until Release.

use leptos::{html::Div, prelude::*};
use motorlink_i18n::tr;
use motorlink_messages::bus::Command;
use motorlink_messages::{bus::Activity, protocol::MotorId};

use crate::{
    model::{
        notice_texts,
        page::use_page,
        snapshot::{Reading, Session},
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
    let halted = memo(move || page.shown.with(|session| session.halted));
    focus_when(halted, dialog);
    let reason = move || {
        page.shown.with(|session| {
            let reason = session.stop.as_ref().map(|stop| stop.reason);
            reason.map_or(tr!("All motors are stopped."), notice_texts::of_stop_reason)
        })
    };
    let rows = move || page.shown.with(|session| table_rows(&stop_lines(session)));
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
                    on_press=move || page.command(Command::Release)
                />
            </div>
        </div>
    }
}

/// The rows of the table as HTML.
fn table_rows(lines: &[StopLine]) -> String {
    if lines.is_empty() {
        let none = tr!("No motor was running.");
        return format!("<tr><td class=\"quiet\">{none}</td></tr>");
    }
    lines.iter().copied().map(table_row).collect()
}

fn table_row(line: StopLine) -> String {
    let (class, words) = match line.state {
        Standstill::Confirmed => ("good", tr!("stopped, confirmed")),
        Standstill::Braking => ("", tr!("braking")),
        Standstill::NotConfirmed => ("bad", tr!("not confirmed")),
        Standstill::NotDriven => ("good", tr!("not running")),
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
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct StopLine {
    id: MotorId,
    /// By a recent reply; `None` is unknown, not zero.
    speed_rpm: Option<i16>,
    state: Standstill,
}

/// Every motor that has answered or had to be stopped.
fn stop_lines(session: &Session) -> Vec<StopLine> {
    let outcome = |id| {
        let outcomes = &session.stop.as_ref()?.outcomes;
        outcomes.iter().find(|outcome| outcome.id == id)
    };
    let state = |id, activity| match (activity, outcome(id)) {
        (Activity::Stopping { confirmed: false }, _) => Standstill::Braking,
        (Activity::Stopping { confirmed: true }, _) => Standstill::Confirmed,
        (_, Some(outcome)) if outcome.confirmed => Standstill::Confirmed,
        (_, Some(_)) => Standstill::NotConfirmed,
        (_, None) => Standstill::NotDriven,
    };
    let motors = session.motors.iter();
    motors
        .filter(|motor| motor.last.is_some() || outcome(motor.id).is_some())
        .map(|motor| StopLine {
            id: motor.id,
            speed_rpm: session
                .speed(motor.id)
                .filter(Reading::is_fresh)
                .map(|speed| speed.value.rpm()),
            state: state(motor.id, motor.activity),
        })
        .collect()
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
        let mut session = session(now_ms, status(1_000, Mode::Velocity, 40));
        session.motors[0].activity = activity;
        session.stop = Some(StopRecord {
            reason: StopReason::Operator,
            outcomes: Vec::from_iter(confirmed.map(|confirmed| StopOutcome {
                id: ID,
                confirmed,
                speed: None,
            })),
        });
        stop_lines(&session)[0]
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
            assert_eq!(line(activity, confirmed, 1_000).state, state);
        }
    }

    #[test]
    fn a_row_says_speed_and_state() {
        let line = line(Activity::Stopping { confirmed: false }, None, 1_000);
        assert_eq!(
            table_rows(&[line]),
            "<tr><th scope=\"row\">Motor 0x01</th><td class=\"stop-speed\">+40 rpm</td>\
             <td class=\"stop-state \">braking</td></tr>"
        );
        assert!(table_rows(&[]).contains("No motor was running."));
    }

    #[test]
    fn an_old_speed_is_unknown() {
        assert_eq!(line(Activity::Idle, None, 1_000).speed_rpm, Some(40));
        assert_eq!(line(Activity::Idle, None, 1_600).speed_rpm, None);
    }
}
