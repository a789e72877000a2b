//! `/diagnostics`: how the drive and each motor are, and what is wrong.

use motorlink_controller_messages::{Activity, DriveState, Holder, Motor, State};

use crate::{
    node::messages::{DiagnosticArray, DiagnosticStatus, Header, KeyValue, Time},
    rover::{Rover, Wheel},
};

const OK: u8 = 0;
const WARNING: u8 = 1;
const ERROR: u8 = 2;
const STALE: u8 = 3;

/// What the node itself has to say.
#[derive(Debug)]
pub struct NodeStatus {
    /// With its namespace.
    pub name: String,
    /// Whether it drives, and if not, why.
    pub drives: Result<(), String>,
    /// It drives only after nobody has asked for a while.
    pub must_rest: bool,
    /// Gaps in the odometry.
    pub gaps: u32,
    /// Commands that came too late since the last time.
    pub late: u32,
}

/// The state of the drive and of each motor; without a state, there is no connection.
#[must_use]
pub fn of(
    stamp: Time,
    state: Option<&State>,
    rover: &Rover,
    of_node: &NodeStatus,
) -> DiagnosticArray {
    let mut status = vec![of_drive(state, of_node)];
    for wheel in &rover.wheels {
        let motor = state.and_then(|state| {
            let mut motors = state.motors.iter();
            motors.find(|motor| motor.id == wheel.id.get())
        });
        status.push(of_motor(wheel, motor, &of_node.name));
    }
    DiagnosticArray {
        header: Header {
            stamp,
            frame_id: String::new(),
        },
        status,
    }
}

fn of_drive(state: Option<&State>, of_node: &NodeStatus) -> DiagnosticStatus {
    let (level, message) = match (&of_node.drives, state) {
        (_, None) => (ERROR, "no connection to motorlink".to_owned()),
        (_, Some(state)) if !state.is_open => (ERROR, "motorlink has no serial port".to_owned()),
        (Ok(()), _) => (OK, "drives".to_owned()),
        (_, Some(state)) if state.drive == DriveState::Starting => (OK, "starting".to_owned()),
        (_, Some(state)) if state.drive == DriveState::Stopping => {
            (OK, "the motors are being stopped".to_owned())
        }
        (Err(why), Some(state)) if state.drive == DriveState::NotConfirmed => (
            ERROR,
            format!("NOT CONFIRMED THAT THE MOTORS STAND. Stopped: {why}"),
        ),
        (Err(why), _) if of_node.must_rest => (
            WARNING,
            format!("stopped: {why}. Drives again after cmd_vel has rested for 2 s"),
        ),
        (Err(why), _) => (OK, format!("stopped: {why}")),
    };
    let control = state.map_or_else(String::new, |state| match state.holder {
        (Holder::Nobody, _) => "nobody".to_owned(),
        (Holder::Page, number) => format!("page {number}"),
        (Holder::OtherClient, number) => format!("another client of the socket ({number})"),
        (Holder::You, _) => "this node".to_owned(),
    });
    DiagnosticStatus {
        level,
        name: format!("{}: drive", of_node.name),
        message,
        hardware_id: of_node.name.clone(),
        values: values([
            ("control", control),
            ("gaps in the odometry", of_node.gaps.to_string()),
            ("commands that came too late", of_node.late.to_string()),
        ]),
    }
}

fn of_motor(wheel: &Wheel, motor: Option<&Motor>, node: &str) -> DiagnosticStatus {
    let id = wheel.id.get();
    let (level, message) = match motor {
        None => (STALE, "no reply yet".to_owned()),
        Some(motor) if motor.is_silent => (STALE, "no reply for 2 s".to_owned()),
        Some(motor) if motor.faults.is_some_and(|faults| faults != 0) => (
            ERROR,
            format!("faults {:#04x}", motor.faults.unwrap_or_default()),
        ),
        Some(motor) if motor.may_turn && motor.activity == Activity::Idle => {
            (ERROR, "has not confirmed that it stands".to_owned())
        }
        Some(motor) if motor.turns_unasked => {
            (WARNING, "turns though nothing drives it".to_owned())
        }
        Some(motor) => {
            let activity = match motor.activity {
                Activity::Idle => "idle",
                Activity::Driven => "driven",
                Activity::Stopping => "is being stopped",
                Activity::Switching => "is switched to another loop",
                Activity::DrivenRaw => "driven by a raw frame",
            };
            (OK, activity.to_owned())
        }
    };
    let told = |value: Option<String>| value.unwrap_or_else(|| "unknown".to_owned());
    let value = |value: Option<(f32, u32)>, unit: &str| {
        told(value.map(|(value, _)| format!("{value:.2} {unit}")))
    };
    DiagnosticStatus {
        level,
        name: format!("{node}: motor {id}"),
        message,
        hardware_id: format!("motor {id} ({})", wheel.joint),
        values: motor.map_or_else(Vec::new, |motor| {
            values([
                ("temperature", value(motor.temperature, "degC")),
                ("current", value(motor.current, "A")),
                ("speed", value(motor.velocity, "rad/s")),
                (
                    "faults",
                    told(motor.faults.map(|faults| format!("{faults:#04x}"))),
                ),
                (
                    "age of the newest reply",
                    told(motor.reply_age.map(|age| format!("{} ms", age / 1_000))),
                ),
            ])
        }),
    }
}

fn values<const N: usize>(values: [(&str, String); N]) -> Vec<KeyValue> {
    let value = |(key, value): (&str, String)| KeyValue {
        key: key.to_owned(),
        value,
    };
    values.into_iter().map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        rover::tests::rover,
        telemetry::tests::{motor, state},
    };

    fn levels(state: Option<&State>, drives: Result<(), String>) -> Vec<(u8, String)> {
        let of_node = NodeStatus {
            name: "/motorlink".to_owned(),
            must_rest: drives.is_err(),
            drives,
            gaps: 0,
            late: 0,
        };
        let array = of(Time::default(), state, &rover(), &of_node);
        let each = array.status.into_iter();
        each.map(|status| (status.level, status.message)).collect()
    }

    #[test]
    fn diagnostics_name_what_is_wrong() {
        let silent = Motor {
            is_silent: true,
            ..motor(1)
        };
        let faulty = Motor {
            faults: Some(0x10),
            ..motor(2)
        };
        let told = levels(Some(&state(vec![silent, faulty])), Ok(()));
        assert_eq!(told[0], (OK, "drives".to_owned()));
        assert_eq!(told[1], (STALE, "no reply for 2 s".to_owned()));
        assert_eq!(told[2], (ERROR, "faults 0x10".to_owned()));
        let unconfirmed = Motor {
            may_turn: true,
            ..motor(1)
        };
        let told = levels(
            Some(&state(vec![unconfirmed])),
            Err("a page has control".to_owned()),
        );
        assert_eq!(
            told[0],
            (
                WARNING,
                "stopped: a page has control. Drives again after cmd_vel has rested for 2 s"
                    .to_owned()
            )
        );
        assert_eq!(told[1].0, ERROR);
        assert_eq!(told[2], (STALE, "no reply yet".to_owned()));
        let stopped = State {
            drive: DriveState::NotConfirmed,
            ..state(vec![])
        };
        let told = levels(Some(&stopped), Err("disarmed".to_owned()));
        assert_eq!(told[0].0, ERROR);
        assert_eq!(levels(None, Ok(()))[0].0, ERROR);
    }
}
