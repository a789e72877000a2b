//! `/motors/<id>/telemetry`: telemetry for programs that plot it.
//!
//! All of it is derived from `/wire`: one message for each reply that says something of the wheel.

use std::{collections::BTreeMap, fmt::Write};

use motorlink_bus::{
    CommandedValue, LineEvent, LineEventKind, LineSamples, TurnCounter, Turns, commanded,
    reported_current,
};
use motorlink_protocol::{
    Angle, Faults, Instant, Mode, MotorId, Reply, Scaled,
    family::{Current, Model},
};
use motorlink_recorder::digits::push_decimal;

use super::{push_text, wire::mode_name};

/// The state of every motor.
#[derive(Debug, Default)]
pub(crate) struct Motors {
    samples: LineSamples,
    motors: BTreeMap<MotorId, Motor>,
}

#[derive(Debug, Default)]
struct Motor {
    setpoint: Option<Setpoint>,
    replied: Option<Reply>,
    turns: TurnCounter,
}

/// What the last drive frame says, in the loop that it is read in.
#[derive(Clone, Copy, Debug)]
struct Setpoint {
    value: CommandedValue,
    brakes: bool,
}

/// A reply with the state that a plot needs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reported {
    pub(crate) reply: Reply,
    current: Option<Current>,
    setpoint: Option<Setpoint>,
    turns: Option<Turns>,
    /// The previous faults, if they have changed.
    pub(crate) faults_changed: Option<Faults>,
}

impl Motors {
    pub(crate) const fn model(&self) -> Model {
        self.samples.model()
    }

    /// Takes an event of the bus. Returns the telemetry if it is a reply that says something of the wheel.
    pub(crate) fn add_event(&mut self, event: &LineEvent) -> Option<Reported> {
        let sample = self.samples.add_event(event);
        let model = self.samples.model();
        if let Some((id, told)) = commanded(model, &event.kind) {
            self.motors.entry(id).or_default().setpoint = told.map(|(drive, mode)| Setpoint {
                value: CommandedValue::of(model, drive, mode),
                brakes: mode == Mode::Velocity && drive.brakes(),
            });
        }
        let LineEventKind::Received { frame, .. } = event.kind else {
            return None;
        };
        let reply = sample?.reply;
        let current = reported_current(model, &frame);
        let motor = self.motors.entry(reply.id).or_default();
        Some(motor.reported(event.at, reply, current))
    }
}

/// Telemetry as JSON, from the events of a line: the messages of `/motors/<id>/telemetry`.
#[derive(Debug, Default)]
pub struct TelemetryJson {
    motors: Motors,
}

impl TelemetryJson {
    /// Takes an event of the bus. Returns the motor and its message, if it is a reply that says something of the wheel.
    pub fn add_event(&mut self, event: &LineEvent) -> Option<(MotorId, String)> {
        let reported = self.motors.add_event(event)?;
        let mut json = String::new();
        reported.write(&mut json, event.at);
        Some((reported.reply.id, json))
    }
}

impl Motor {
    fn reported(&mut self, at: Instant, reply: Reply, current: Option<Current>) -> Reported {
        let before = self.replied.replace(reply);
        let faults_before = before.map_or(Faults::NONE, |before| before.faults);
        let changed = faults_before.byte() != reply.faults.byte();
        self.turns.record(at, &reply);
        Reported {
            reply,
            current,
            setpoint: self.setpoint,
            turns: self
                .turns
                .turns()
                .filter(|_| reply.detail.angle().is_some()),
            faults_changed: changed.then_some(faults_before),
        }
    }
}

impl Reported {
    /// Writes the message. A value that the reply does not contain is left out, never repeated.
    pub(crate) fn write(&self, out: &mut String, at: Instant) {
        let Reply {
            mode,
            speed,
            detail,
            faults,
            ..
        } = self.reply;
        out.clear();
        out.push_str("{\"mono_us\":");
        push_decimal(out, at.as_micros());
        if let Some(speed) = speed {
            out.push_str(",\"speed_rpm\":");
            push_signed(out, speed.rpm());
        }
        if let Some(current) = self.current {
            if current.scale().is_certain() {
                out.push_str(",\"current_a\":");
                push_amps(out, current);
            } else {
                out.push_str(",\"current_raw\":");
                push_signed(out, current.raw());
            }
        }
        if let Some(angle) = detail.angle() {
            out.push_str(",\"position_deg\":");
            match angle {
                Angle::Fine(position) => push_scaled(out, false, position.scaled()),
                Angle::Coarse(position) => push_scaled(out, false, position.scaled()),
            }
        }
        if let Some(temperature) = detail.temperature() {
            out.push_str(",\"temperature_c\":");
            push_decimal(out, temperature.degrees().into());
        }
        if let Some(turns) = self.turns {
            // Writing to a string cannot fail.
            let _ = write!(out, ",\"turns\":{:.3}", turns.number());
        }
        out.push_str(",\"mode\":\"");
        out.push_str(mode_name(mode));
        out.push_str("\",\"fault_code\":");
        push_decimal(out, faults.byte().into());
        out.push_str(",\"faults\":[");
        push_faults(out, faults);
        out.push(']');
        if let Some(setpoint) = self.setpoint {
            setpoint.write(out);
        }
        out.push('}');
    }
}

impl Setpoint {
    fn write(self, out: &mut String) {
        out.push_str(",\"setpoint\":");
        match self.value {
            CommandedValue::Speed(speed) => push_signed(out, speed.rpm()),
            CommandedValue::Current(current) => push_amps(out, current),
            CommandedValue::Position(position) => push_scaled(out, false, position.scaled()),
            CommandedValue::OpenLoop(target) => push_signed(out, target.raw()),
        }
        out.push_str(if self.brakes {
            ",\"brake\":true"
        } else {
            ",\"brake\":false"
        });
    }
}

fn push_signed(out: &mut String, value: i16) {
    if value < 0 {
        out.push('-');
    }
    push_decimal(out, value.unsigned_abs().into());
}

fn push_amps(out: &mut String, current: Current) {
    push_scaled(out, current.raw() < 0, current.scaled());
}

fn push_scaled<const DECIMALS: usize>(out: &mut String, negative: bool, value: Scaled<DECIMALS>) {
    if negative {
        out.push('-');
    }
    // Writing to a string cannot fail.
    let _ = write!(out, "{value}");
}

fn push_faults(out: &mut String, faults: Faults) {
    let mut separator = "";
    for fault in faults.iter() {
        out.push_str(separator);
        push_text(out, fault.name());
        separator = ",";
    }
}

#[cfg(test)]
mod tests {
    use motorlink_protocol::{Detail, Layout};

    use super::*;

    fn event(at_ms: u64, kind: LineEventKind) -> LineEvent {
        let at = Instant::from_millis(at_ms);
        LineEvent { at, kind }
    }

    fn reply(position: u16, rpm: i16, asked: Layout) -> LineEventKind {
        let mut reply =
            Reply::decode(&"01 02 02 CD 00 64 17 CF 00 8F".parse().unwrap(), None).unwrap();
        reply.speed = Some(motorlink_protocol::Rpm::new(rpm));
        reply.detail = Detail::Undetermined(position.to_be_bytes());
        let frame = reply.frame();
        LineEventKind::Received {
            frame,
            asked: Some(asked),
        }
    }

    fn text(reported: &Reported) -> String {
        let mut out = String::new();
        reported.write(&mut out, Instant::from_millis(5));
        out
    }

    #[test]
    fn a_message_has_what_the_reply_says_and_what_was_asked_for() {
        let mut motors = Motors::default();
        let frame = "01 64 00 64 00 00 00 00 00 4F".parse().unwrap();
        let mode = Some(Mode::Velocity);
        assert!(
            motors
                .add_event(&event(0, LineEventKind::Sent { frame, mode }))
                .is_none()
        );
        let reported = motors
            .add_event(&event(2, reply(6095, 100, Layout::Drive)))
            .unwrap();
        assert!(reported.faults_changed.is_none());
        assert_eq!(
            text(&reported),
            r#"{"mono_us":5000,"speed_rpm":100,"current_a":0.175,"position_deg":66.96,"turns":0.000,"mode":"velocity","fault_code":0,"faults":[],"setpoint":100,"brake":false}"#
        );
        let reported = motors
            .add_event(&event(4, reply(0x1C00, -7, Layout::Query)))
            .unwrap();
        assert!(text(&reported).contains(
            r#""speed_rpm":-7,"current_a":0.175,"position_deg":0.0,"temperature_c":28,"#
        ));
    }

    #[test]
    fn a_change_of_faults_is_noticed() {
        let mut motors = Motors::default();
        let good = motorlink_protocol::Frame::with_crc([1, 2, 0, 0, 0, 0, 0, 0, 0]);
        let stalled = motorlink_protocol::Frame::with_crc([1, 2, 0, 0, 0, 0, 0, 0, 8]);
        let mut pass = |at, frame| {
            let asked = Some(Layout::Drive);
            let kind = LineEventKind::Received { frame, asked };
            motors.add_event(&event(at, kind)).unwrap()
        };
        assert!(pass(0, good).faults_changed.is_none());
        let reported = pass(1, stalled);
        assert_eq!(reported.faults_changed, Some(Faults::NONE));
        assert!(text(&reported).contains(r#""fault_code":8,"faults":["stall"]"#));
        assert!(pass(2, stalled).faults_changed.is_none());
        assert!(pass(3, good).faults_changed.is_some());
    }
}
