//! The state that a robot publishes, as JSON. What is not known is absent.

use motorlink_controller_messages::{Activity, Holder, Motor, State};
use serde::{Deserialize, Serialize};

use super::{
    names::{is_session, page_url},
    words::{activity, why},
};
use crate::{
    drive::Why,
    rover::{Rover, Wheel},
    status::{self, DriveStatus, Level, MotorStatus, Phase},
};

/// The version of the state. Another one is ignored.
const FORMAT: u8 = 1;
/// A state of eight motors has 2 kB.
const BYTES_MAX: usize = 16_384;
/// A name of a joint.
const JOINT_MAX: usize = 64;
/// A speed or current that is older is not known, in µs: as in `joint_states`.
const STALE_US: u32 = 500_000;
/// A temperature changes slowly, and is read less often.
const TEMPERATURE_STALE_US: u32 = 10_000_000;

/// How a robot is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RobotState {
    format: u8,
    /// Of Zenoh.
    pub session: String,
    /// Counts the states of the session, from 1.
    pub number: u64,
    /// The worst of the drive and of the motors, at most an error: a robot that publishes is heard.
    pub level: Level,
    drive: Drive,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    control: Option<Control>,
    link: Link,
    /// Where `motorlink serve` shows its page.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub page: Option<String>,
    motors: Vec<RobotMotor>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Drive {
    is: Phase,
    #[serde(default, skip_serializing_if = "Option::is_none", with = "why")]
    why: Option<Why>,
    must_rest: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Control {
    by: By,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    number: Option<u32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum By {
    Nobody,
    Page,
    Client,
    Ros,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Link {
    connected: bool,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    port_open: Option<bool>,
}

/// A wheel and its motor.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct RobotMotor {
    id: u8,
    joint: String,
    #[serde(default, skip_serializing_if = "Option::is_none", with = "activity")]
    activity: Option<Activity>,
    #[serde(default, skip_serializing_if = "is_false")]
    silent: bool,
    #[serde(default, skip_serializing_if = "is_false")]
    may_turn: bool,
    #[serde(default, skip_serializing_if = "is_false")]
    turns_unasked: bool,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    faults: Option<u8>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    rpm: Option<f32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    current_a: Option<f32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    temperature_c: Option<f32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    reply_age_ms: Option<u32>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
const fn is_false(value: &bool) -> bool {
    !*value
}

/// Whether a terminal shows it and does nothing else.
const fn is_plain(char: char) -> bool {
    char.is_ascii_graphic()
}

/// What the state of a robot is made of.
#[derive(Clone, Copy, Debug)]
pub struct Sources<'a> {
    /// The newest of motorlink.
    pub state: Option<&'a State>,
    /// Its age, in µs.
    pub age_us: u32,
    /// The wheels.
    pub rover: &'a Rover,
    /// What this program does.
    pub drive: DriveStatus,
}

impl RobotState {
    /// The state of now.
    #[must_use]
    pub fn new(session: &str, number: u64, page: Option<String>, sources: Sources<'_>) -> Self {
        let Sources { state, drive, .. } = sources;
        let motors: Vec<_> = sources
            .rover
            .wheels
            .iter()
            .map(|wheel| RobotMotor::new(wheel, sources))
            .collect();
        Self {
            format: FORMAT,
            session: session.to_owned(),
            number,
            level: Level::Ok,
            drive: Drive {
                is: drive.phase,
                why: drive.why,
                must_rest: drive.must_rest,
            },
            control: state.map(|state| Control::new(state.holder)),
            link: Link {
                connected: state.is_some(),
                port_open: state.map(|state| state.is_open),
            },
            page,
            motors,
        }
        .judged()
    }

    /// With the level that its drive and its motors show, unless it says a worse one.
    fn judged(mut self) -> Self {
        let levels = self.motors.iter().map(|motor| motor.status().level());
        let level = levels.fold(self.drive().level(), Ord::max);
        self.level = self.level.max(level).min(Level::Error);
        self
    }

    /// As JSON.
    #[must_use]
    pub fn write(&self) -> Vec<u8> {
        // Numbers and strings always are JSON.
        serde_json::to_vec(self).unwrap_or_default()
    }

    /// Reads what came from the network; `None` if it is no state.
    #[must_use]
    pub fn read(bytes: &[u8]) -> Option<Self> {
        if bytes.len() > BYTES_MAX {
            return None;
        }
        let state: Self = serde_json::from_slice(bytes).ok()?;
        let is_valid = state.format == FORMAT
            && is_session(&state.session)
            && state.page.as_ref().is_none_or(|url| page_url(url).is_ok())
            && state.motors.len() <= motorlink_controller_messages::MOTORS_MAX
            && state.motors.iter().all(RobotMotor::is_valid);
        is_valid.then(|| state.judged())
    }

    /// How the drive is.
    #[must_use]
    pub const fn drive(&self) -> DriveStatus {
        DriveStatus {
            link: match self.link {
                Link {
                    connected: false, ..
                } => status::Link::NoConnection,
                Link {
                    port_open: Some(false),
                    ..
                } => status::Link::NoPort,
                Link { .. } => status::Link::Open,
            },
            phase: self.drive.is,
            why: self.drive.why,
            must_rest: self.drive.must_rest,
        }
    }

    /// Who drives, in words.
    #[must_use]
    pub fn driven_by(&self) -> String {
        let Some(Control { by, number }) = self.control else {
            return "unknown".to_owned();
        };
        let who = match by {
            By::Nobody => return "nobody".to_owned(),
            By::Page => "page",
            By::Client => "client",
            By::Ros => return "ROS".to_owned(),
        };
        number.map_or_else(|| who.to_owned(), |number| format!("{who} {number}"))
    }

    /// The temperature of the hottest motor, in °C.
    #[must_use]
    pub fn hottest(&self) -> Option<f32> {
        let all = self.motors.iter().filter_map(|motor| motor.temperature_c);
        all.reduce(f32::max)
    }

    /// What is wrong with the worst motor, if anything is. Without a connection, nothing is known of any.
    #[must_use]
    pub fn worst_motor(&self) -> Option<(u8, MotorStatus)> {
        if !self.link.connected {
            return None;
        }
        let all = self.motors.iter().map(|motor| (motor.id, motor.status()));
        let worst = all.max_by_key(|(_, status)| status.level().min(Level::Error))?;
        (worst.1.level() > Level::Ok).then_some(worst)
    }
}

impl Control {
    const fn new((holder, number): (Holder, u32)) -> Self {
        let by = match holder {
            Holder::Nobody => By::Nobody,
            Holder::Page => By::Page,
            Holder::OtherClient => By::Client,
            Holder::You => By::Ros,
        };
        let number = match by {
            By::Nobody => None,
            _ => Some(number),
        };
        Self { by, number }
    }
}

impl RobotMotor {
    fn new(wheel: &Wheel, sources: Sources<'_>) -> Self {
        let id = wheel.id.get();
        let joint = wheel.joint.chars().filter(|char| is_plain(*char));
        let joint = joint.take(JOINT_MAX).collect();
        let mut motors = sources.state.into_iter().flat_map(|state| &state.motors);
        let Some(motor) = motors.find(|motor| motor.id == id) else {
            return Self {
                id,
                joint,
                ..Self::default()
            };
        };
        let known = |value: Option<(f32, u32)>, stale_us: u32, steps: f32| {
            let (value, age_us) = value?;
            let is_known = age_us.saturating_add(sources.age_us) <= stale_us && value.is_finite();
            is_known.then(|| (value * steps).round() / steps)
        };
        #[expect(clippy::cast_possible_truncation, reason = "1 or -1")]
        let sign = wheel.sign() as f32;
        let rpm = motor.velocity.map(|(velocity, age)| {
            let rpm = velocity * sign * 60.0 / std::f32::consts::TAU;
            (rpm, age)
        });
        Self {
            id,
            joint,
            activity: Some(motor.activity),
            silent: motor.is_silent,
            may_turn: motor.may_turn,
            turns_unasked: motor.turns_unasked,
            faults: motor.faults,
            rpm: known(rpm, STALE_US, 10.0),
            current_a: known(motor.current, STALE_US, 100.0),
            temperature_c: known(motor.temperature, TEMPERATURE_STALE_US, 10.0),
            reply_age_ms: motor
                .reply_age
                .map(|age| age.saturating_add(sources.age_us) / 1_000),
        }
    }

    fn is_valid(&self) -> bool {
        let numbers = [self.rpm, self.current_a, self.temperature_c];
        self.id != 0
            && self.joint.chars().count() <= JOINT_MAX
            && self.joint.chars().all(is_plain)
            && numbers.iter().flatten().all(|number| number.is_finite())
    }

    fn status(&self) -> MotorStatus {
        // An activity of a later version is not known, and yet the motor has replied.
        let has_replied = self.activity.is_some() || self.reply_age_ms.is_some();
        let motor = has_replied.then(|| Motor {
            activity: self.activity.unwrap_or_default(),
            is_silent: self.silent,
            may_turn: self.may_turn,
            turns_unasked: self.turns_unasked,
            faults: self.faults,
            ..Motor::default()
        });
        MotorStatus::of(motor.as_ref())
    }
}

#[cfg(test)]
#[path = "state_tests.rs"]
pub(super) mod tests;
