//! The alert of wheels that turn, and of currents that flow, though this page drives nothing there.
//!
//! Many motors keep their last command for ever: that of another page, of another program, or of this one before a
//! crash.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{
    bus::{Command, MotorStatus},
    protocol::{MotorId, Rpm},
};

use crate::{
    model::{page::use_page, place::Place, snapshot::Session},
    ui::{
        button::PressButton,
        format,
        reactive::{dynamic, memo},
    },
};

/// A wheel that a raw frame turns slower is not reported: a person may turn it by hand.
const RAW_RPM: u16 = 10;

/// One alert for all of them, with button `Stop it`. It is over everything but STOP.
#[component]
pub(crate) fn TurningAlert() -> impl IntoView {
    let page = use_page();
    // The place Diagnose has the raw editor with a `Stop it` of its own.
    let moving = move |session: &Session| moving(session, page.place() != Place::Diagnose);
    let motors = memo(move || page.shown.with(moving));
    let title = memo(move || motors.with(|motors| title(motors)));
    let stop = move || {
        for id in page
            .latest
            .with_value(moving)
            .iter()
            .map(|moving| moving.id)
        {
            page.command(Command::Stop(id));
        }
    };
    view! {
        <div
            class="turns-unasked"
            role="alert"
            aria-atomic="false"
            hidden=dynamic(move || motors.with(Vec::is_empty))
        >
            <p class="notice-title">
                {dynamic(move || title.get())}
                // Ten times a second: it is not announced each time.
                <output aria-label=tr!("Speed unasked for") aria-live="off">
                    {dynamic(move || motors.with(|motors| figures(motors)))}
                </output>
            </p>
            <p class="notice-advice">
                {tr!("If it does not stop, switch off the power of the motor.")}
            </p>
            <PressButton label=tr!("Stop it") class="button halt" on_press=stop />
        </div>
    }
}

/// A motor that moves though nothing here drives it.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Moving {
    id: MotorId,
    /// Speed, or current where it stands.
    figure: String,
    turns: bool,
}

/// The motors that move. `with_raw`: those that a raw frame has left running, too.
fn moving(session: &Session, with_raw: bool) -> Vec<Moving> {
    let of = |motor: &MotorStatus| {
        let speed = motor.speed.map(|(_, speed)| speed);
        let turning = speed.filter(|speed| *speed != Rpm::new(0));
        let turns = turning.is_some();
        let figure = match (turning, motor.current) {
            (Some(speed), _) => format::speed_in_rpm(speed),
            (None, Some((_, current))) => {
                let (value, unit) = format::current_in(current, session.is_current_certain());
                format!("{value} {unit}")
            }
            (None, None) => String::new(),
        };
        Some(Moving {
            id: motor.id,
            figure,
            turns,
        })
    };
    let turns = |motor: &&MotorStatus| {
        let speed = motor.speed.filter(|_| with_raw && !motor.turns_unasked);
        speed.is_some_and(|(_, speed)| speed.magnitude() >= RAW_RPM)
    };
    let left_by_raw_frame = session.left_by_raw_frame().filter(turns);
    let motors = session.turning_unasked().chain(left_by_raw_frame);
    motors.filter_map(of).collect()
}

fn title(motors: &[Moving]) -> String {
    match motors {
        [] => String::new(),
        [
            Moving {
                id, turns: true, ..
            },
        ] => tr!("Motor {id} is turning, and nothing here drives it:", id),
        [Moving { id, .. }] => tr!(
            "A current flows in motor {id}, and nothing here drives it:",
            id
        ),
        motors => {
            let ids: Vec<String> = motors.iter().map(|motor| motor.id.to_string()).collect();
            tr!(
                "Motors {ids} are turning, and nothing here drives them:",
                ids = ids.join(", ")
            )
        }
    }
}

fn figures(motors: &[Moving]) -> String {
    let figures: Vec<&str> = motors.iter().map(|motor| motor.figure.as_str()).collect();
    figures.join(", ")
}

#[cfg(test)]
mod tests {
    use motorlink_messages::{Adapter, Connection, protocol::Mode};

    use super::*;
    use crate::model::snapshot::tests::{session, status};

    fn said(session: &Session) -> String {
        let motors = moving(session, true);
        format!("{} {}", title(&motors), figures(&motors))
    }

    fn unasked(rpm: i16) -> Session {
        let mut motor = status(1_000, Mode::Velocity, rpm);
        motor.turns_unasked = true;
        session(1_000, motor)
    }

    #[test]
    fn a_wheel_that_turns_unasked_is_named_with_its_speed() {
        let expected = "Motor 0x01 is turning, and nothing here drives it: +100 rpm";
        assert_eq!(said(&unasked(100)), expected);
        let mut two = unasked(100);
        let mut other = two.motors[0];
        other.id = MotorId::new(2).unwrap();
        two.motors.push(other);
        let said = said(&two);
        assert!(said.starts_with("Motors 0x01, 0x02 are turning"), "{said}");
    }

    #[test]
    fn a_current_without_motion_is_named_as_one() {
        let said = said(&unasked(0));
        assert!(said.starts_with("A current flows in motor 0x01"), "{said}");
        assert!(said.ends_with(" A"), "{said}");
    }

    #[test]
    fn nothing_is_said_of_a_recording_nor_of_a_wheel_that_is_driven_here() {
        let mut recorded = unasked(100);
        recorded.connection = Connection::Connected(Adapter::Recording);
        assert_eq!(moving(&recorded, true), []);
        let driven = session(1_000, status(1_000, Mode::Velocity, 100));
        assert_eq!(moving(&driven, true), []);
    }
}
