//! The values of a motor as text.

use std::{fmt::Display, time::Duration};

use motorlink_bus::{Activity, Answer, FRESH_FOR, Mirror, MotorStatus};
use motorlink_protocol::{Celsius, Current, Detail, Faults, Instant, family::Model};

use crate::signed_id::SignedId;

/// The bus stops a motor whose temperature it has not known for so long.
const TEMPERATURE_FRESH_FOR: Duration = Duration::from_secs(2);

/// What a motor reports, with the sign of its side. A value that no fresh reply has is absent.
pub struct Values {
    pub id: SignedId,
    pub mode: Option<&'static str>,
    pub speed_rpm: Option<i16>,
    pub current: Option<String>,
    pub angle: Option<String>,
    pub temperature: Option<String>,
    pub faults: Option<Faults>,
    pub does: String,
}

impl Values {
    pub fn of(model: Model, motor: &MotorStatus, now: Instant, id: SignedId) -> Self {
        let is_fresh = |at: Instant| now.since(at) <= FRESH_FOR;
        let last = motor.last.filter(|sample| is_fresh(sample.at));
        let speed = motor.speed.filter(|(at, _)| is_fresh(*at));
        let current = motor.current.filter(|(at, _)| is_fresh(*at));
        let fine = motor.position.filter(|(at, _)| is_fresh(*at));
        let coarse = last.and_then(|sample| match sample.reply.detail {
            Detail::Query { position, .. } => Some(position.to_string()),
            _ => None,
        });
        let amps = |current: Current| {
            let amps = id.mirror.current(current);
            if model.spec().current.is_certain() {
                amps.to_string()
            } else {
                format!("at most {amps}")
            }
        };
        Self {
            id,
            mode: last.map(|sample| mode_name(sample.reply.mode)),
            speed_rpm: speed.map(|(_, speed)| id.mirror.speed(speed).rpm()),
            current: current.map(|(_, current)| amps(current)),
            angle: fine.map(|(_, angle)| angle.to_string()).or(coarse),
            temperature: fresh_temperature(motor, now).map(|celsius| celsius.to_string()),
            faults: last.map(|sample| sample.reply.faults),
            does: does(motor, id.mirror),
        }
    }

    /// One line of a table.
    pub fn line(&self) -> String {
        let speed = self.speed_rpm.map(|rpm| format!("{rpm:+} rpm"));
        let faults = self.faults.map(|faults| faults.to_string());
        format!(
            "{:>5}  {:<9} {:>9} {:>10} {:>9} {:>6}  {:<12} {}",
            self.id.to_string(),
            self.mode.unwrap_or("-"),
            or_dash(speed),
            or_dash(self.current.as_ref()),
            or_dash(self.angle.as_ref()),
            or_dash(self.temperature.as_ref()),
            self.does,
            or_dash(faults),
        )
    }

    /// The names over [`Values::line`].
    pub const HEAD: &str =
        "motor  loop          speed    current     angle   temp  state        faults";
}

/// Its temperature, if it is known. It is asked less often than the speed, and changes slowly.
pub fn fresh_temperature(motor: &MotorStatus, now: Instant) -> Option<Celsius> {
    let (at, celsius) = motor.temperature?;
    (now.since(at) <= TEMPERATURE_FRESH_FOR).then_some(celsius)
}

/// Its angle in degrees, if a fresh reply has it.
pub fn present_angle(motor: &MotorStatus, now: Instant) -> Option<f32> {
    let is_fresh = |at: Instant| now.since(at) <= FRESH_FOR;
    let fine = motor.position.filter(|(at, _)| is_fresh(*at));
    let coarse = || match motor.last.filter(|last| is_fresh(last.at))?.reply.detail {
        Detail::Query { position, .. } => Some(position.degrees()),
        _ => None,
    };
    fine.map(|(_, angle)| angle.degrees()).or_else(coarse)
}

pub fn or_dash(value: Option<impl Display>) -> String {
    value.map_or_else(|| "-".to_owned(), |value| value.to_string())
}

const fn mode_name(mode: motorlink_protocol::Mode) -> &'static str {
    use motorlink_protocol::Mode;
    match mode {
        Mode::OpenLoop => "open loop",
        Mode::Current => "current",
        Mode::Velocity => "velocity",
        Mode::Position => "position",
    }
}

fn does(motor: &MotorStatus, mirror: Mirror) -> String {
    let text = match mirror.activity(motor.activity) {
        _ if motor.answer == Answer::Missing => "no reply",
        _ if motor.answer == Answer::Corrupted => "bad replies",
        Activity::Idle | Activity::Switching { .. } if motor.waiting.is_some() => "starting",
        Activity::Idle if motor.turns_unasked => "TURNS UNASKED",
        Activity::Idle => "idle",
        Activity::Switching { .. } => "switching",
        Activity::Driven { setpoint } => return setpoint.to_string(),
        Activity::DrivenRaw => "raw frame",
        Activity::Stopping { .. } => "stopping",
    };
    text.to_owned()
}
