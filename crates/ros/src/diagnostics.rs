//! `/diagnostics`: how the drive and each motor are, and what is wrong.

use motorlink_controller_messages::{Holder, Motor, State};

use crate::{
    drive::Why,
    node::messages::{DiagnosticArray, DiagnosticStatus, Header, KeyValue, Time},
    rover::{Rover, Wheel},
    status::{DriveStatus, Level, MotorStatus},
};

/// What the node itself has to say.
#[derive(Debug)]
pub struct NodeStatus {
    /// With its namespace.
    pub name: String,
    /// Whether it drives, and if not, why.
    pub drives: Result<(), Why>,
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
    let drive = DriveStatus::of(state, of_node.drives, of_node.must_rest);
    let control = state.map_or_else(String::new, |state| match state.holder {
        (Holder::Nobody, _) => "nobody".to_owned(),
        (Holder::Page, number) => format!("page {number}"),
        (Holder::OtherClient, number) => format!("another client of the socket ({number})"),
        (Holder::You, _) => "this node".to_owned(),
    });
    DiagnosticStatus {
        level: number(drive.level()),
        name: format!("{}: drive", of_node.name),
        message: drive.to_string(),
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
    let status = MotorStatus::of(motor);
    let told = |value: Option<String>| value.unwrap_or_else(|| "unknown".to_owned());
    let value = |value: Option<(f32, u32)>, unit: &str| {
        told(value.map(|(value, _)| format!("{value:.2} {unit}")))
    };
    DiagnosticStatus {
        level: number(status.level()),
        name: format!("{node}: motor {id}"),
        message: status.to_string(),
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

/// As `diagnostic_msgs/DiagnosticStatus` has it.
const fn number(level: Level) -> u8 {
    level as u8
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
    use motorlink_controller_messages::{DriveState, EndReason, NotArmed};

    use super::*;
    use crate::{
        rover::tests::rover,
        telemetry::tests::{motor, state},
    };

    fn levels(state: Option<&State>, drives: Result<(), Why>) -> Vec<(u8, String)> {
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
        assert_eq!(told[0], (0, "drives".to_owned()));
        assert_eq!(told[1], (3, "no reply for 2 s".to_owned()));
        assert_eq!(told[2], (2, "faults 0x10".to_owned()));
        let unconfirmed = Motor {
            may_turn: true,
            ..motor(1)
        };
        let told = levels(
            Some(&state(vec![unconfirmed])),
            Err(Why::Refused(NotArmed::PageHasControl)),
        );
        assert_eq!(
            told[0],
            (
                1,
                "stopped: a page has control. Drives again after cmd_vel has rested for 2 s"
                    .to_owned()
            )
        );
        assert_eq!(told[1].0, 2);
        assert_eq!(told[2], (3, "no reply yet".to_owned()));
        let stopped = State {
            drive: DriveState::NotConfirmed,
            ..state(vec![])
        };
        let told = levels(Some(&stopped), Err(Why::Ended(EndReason::Disarmed)));
        assert_eq!(told[0].0, 2);
        assert_eq!(levels(None, Ok(()))[0].0, 2);
    }
}
