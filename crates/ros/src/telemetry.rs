//! The messages that tell the state of the motors and of the robot.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

use motorlink_controller_messages::{Activity, DriveState, Holder, Motor, State};

use crate::{
    node::messages::{
        Covariance, DiagnosticArray, DiagnosticStatus, Header, JointState, KeyValue, Odometry,
        Pose, Quaternion, Temperature, TfMessage, Time, TransformStamped, Vector3,
    },
    odometry::Moved,
    rover::{Rover, Wheel},
};

/// A value that is older is not the state any more, in µs.
const STALE_US: u32 = 500_000;

const OK: u8 = 0;
const WARNING: u8 = 1;
const ERROR: u8 = 2;
const STALE: u8 = 3;

/// A variance where nothing is measured: height, and the rotations about x and y.
const UNKNOWN: f64 = 1e6;

/// The time of something that happened `age` ago.
#[must_use]
pub fn time(now: SystemTime, age: Duration) -> Time {
    let at = now.checked_sub(age).unwrap_or(now);
    let since = at.duration_since(UNIX_EPOCH).unwrap_or_default();
    Time {
        // Until 2038, as in ROS.
        sec: i32::try_from(since.as_secs()).unwrap_or(i32::MAX),
        nanosec: since.subsec_nanos(),
    }
}

fn header(stamp: Time, frame_id: String) -> Header {
    Header { stamp, frame_id }
}

fn micros(age: u32) -> Duration {
    Duration::from_micros(age.into())
}

/// The wheels whose motors the state names.
fn known<'a>(rover: &'a Rover, state: &'a State) -> impl Iterator<Item = (&'a Wheel, &'a Motor)> {
    rover.wheels.iter().filter_map(|wheel| {
        let motor = state
            .motors
            .iter()
            .find(|motor| motor.id == wheel.id.get())?;
        Some((wheel, motor))
    })
}

/// The joints whose position and speed are known and new; `None` if there is none.
#[must_use]
pub fn joint_states(
    now: SystemTime,
    state: &State,
    rover: &Rover,
    torque_constant: Option<f64>,
) -> Option<JointState> {
    let mut joints = JointState::default();
    let mut youngest = u32::MAX;
    for (wheel, motor) in known(rover, state) {
        let Some(((position, _), (velocity, age))) = motor.position.zip(motor.velocity) else {
            continue;
        };
        let effort = torque_constant.map(|constant| {
            let current = motor
                .current
                .map_or(f64::NAN, |(current, _)| current.into());
            wheel.sign() * constant * current
        });
        if age > STALE_US {
            continue;
        }
        youngest = youngest.min(age);
        joints.name.push(wheel.joint.clone());
        joints.position.push(wheel.sign() * position);
        joints.velocity.push(wheel.sign() * f64::from(velocity));
        joints.effort.extend(effort);
    }
    joints.header = header(time(now, micros(youngest)), String::new());
    (!joints.name.is_empty()).then_some(joints)
}

/// Where the robot is.
#[must_use]
pub fn odometry(stamp: Time, moved: &Moved, prefix: &str) -> Odometry {
    Odometry {
        header: header(stamp, format!("{prefix}odom")),
        child_frame_id: format!("{prefix}base_link"),
        pose: Pose {
            position: place(moved),
            orientation: direction(moved),
        },
        // 3 cm and 6 degrees: the usual ones of diff_drive_controller. They do not grow with the way.
        pose_covariance: covariance(0.001, 0.01),
        twist: moved.twist,
        twist_covariance: covariance(0.001, 0.01),
    }
}

fn covariance(place: f64, heading: f64) -> Covariance {
    let mut all = [[0.0; 6]; 6];
    let variances = [place, place, UNKNOWN, UNKNOWN, UNKNOWN, heading];
    for (index, (row, variance)) in all.iter_mut().zip(variances).enumerate() {
        if let Some(own) = row.get_mut(index) {
            *own = variance;
        }
    }
    all
}

fn place(moved: &Moved) -> Vector3 {
    Vector3 {
        x: moved.x,
        y: moved.y,
        z: 0.0,
    }
}

fn direction(moved: &Moved) -> Quaternion {
    let (z, w) = (moved.heading / 2.0).sin_cos();
    Quaternion {
        x: 0.0,
        y: 0.0,
        z,
        w,
    }
}

/// The transform from `odom` to `base_link`.
#[must_use]
pub fn transform(stamp: Time, moved: &Moved, prefix: &str) -> TfMessage {
    TfMessage {
        transforms: vec![TransformStamped {
            header: header(stamp, format!("{prefix}odom")),
            child_frame_id: format!("{prefix}base_link"),
            translation: place(moved),
            rotation: direction(moved),
        }],
    }
}

/// The temperature of a motor; `None` if it is not known.
#[must_use]
pub fn temperature(
    now: SystemTime,
    wheel: &Wheel,
    state: &State,
    prefix: &str,
) -> Option<Temperature> {
    let motor = state
        .motors
        .iter()
        .find(|motor| motor.id == wheel.id.get())?;
    let (degrees, age) = motor.temperature?;
    let frame = format!("{prefix}{}", wheel.joint.trim_end_matches("_joint"));
    Some(Temperature {
        header: header(time(now, micros(age)), frame),
        temperature: degrees.into(),
        variance: 0.0,
    })
}

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
pub fn diagnostics(
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
        header: header(stamp, String::new()),
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
    use crate::rover::tests::rover;

    fn state(motors: Vec<Motor>) -> State {
        State {
            is_open: true,
            motors,
            ..State::default()
        }
    }

    fn motor(id: u8) -> Motor {
        Motor {
            id,
            faults: Some(0),
            reply_age: Some(4_000),
            position: Some((2.0, 4_000)),
            velocity: Some((1.0, 4_000)),
            current: Some((0.5, 4_000)),
            ..Motor::default()
        }
    }

    fn at(ms: u64) -> SystemTime {
        UNIX_EPOCH + Duration::from_millis(ms)
    }

    #[test]
    fn joints_have_the_sign_of_the_wheel_and_the_time_of_their_reply() {
        let both = state(vec![motor(1), motor(2)]);
        let joints = joint_states(at(10_000), &both, &rover(), Some(0.8)).unwrap();
        assert_eq!(joints.name, ["wheel_1_joint", "wheel_2_joint"]);
        assert_eq!(joints.position, [2.0, -2.0]);
        assert_eq!(joints.velocity, [1.0, -1.0]);
        assert_eq!(joints.effort, [0.4, -0.4]);
        assert_eq!(
            (joints.header.stamp.sec, joints.header.stamp.nanosec),
            (9, 996_000_000)
        );
        let without = joint_states(at(0), &both, &rover(), None).unwrap();
        assert!(without.effort.is_empty());
    }

    #[test]
    fn a_joint_that_is_not_known_is_left_out() {
        let mut old = motor(2);
        old.velocity = Some((1.0, 600_000));
        let joints = joint_states(at(0), &state(vec![motor(1), old]), &rover(), None).unwrap();
        assert_eq!(joints.name, ["wheel_1_joint"]);
        assert_eq!(joint_states(at(0), &state(vec![]), &rover(), None), None);
    }

    fn levels(state: Option<&State>, drives: Result<(), String>) -> Vec<(u8, String)> {
        let of_node = NodeStatus {
            name: "/motorlink".to_owned(),
            must_rest: drives.is_err(),
            drives,
            gaps: 0,
            late: 0,
        };
        let array = diagnostics(Time::default(), state, &rover(), &of_node);
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
