//! The messages that tell where the wheels and the robot are.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

use motorlink_controller_messages::{Motor, State};

use crate::{
    node::messages::{
        Covariance, Header, JointState, Odometry, Pose, Quaternion, Temperature, TfMessage, Time,
        TransformStamped, Vector3,
    },
    odometry::Moved,
    rover::{Rover, Wheel},
};

/// A value that is older is not the state any more, in µs.
const STALE_US: u32 = 500_000;

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

/// Other tests use its motors.
#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::rover::tests::rover;

    pub(crate) fn state(motors: Vec<Motor>) -> State {
        State {
            is_open: true,
            motors,
            ..State::default()
        }
    }

    pub(crate) fn motor(id: u8) -> Motor {
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
}
