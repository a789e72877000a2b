//! `/motors/<id>/telemetry`: telemetry for programs that plot it.
//!
//! All of it is derived from `/wire`, which has every reply. At 500 replies a second these messages would take more
//! space than the frames: each has 31 bytes and an index entry. So a file has at most [`PER_SECOND`] messages per
//! second, motor and kind of reply, and one for every change of mode or faults.

use std::{collections::BTreeMap, fmt::Write, time::Duration};

use motorlink_bus::{LineEvent, LineEventKind};
use motorlink_protocol::{
    Detail, Drive, Faults, Instant, Layout, Mode, MotorId, Position, Reply, Request, Scaled,
};
use motorlink_recorder::digits::push_decimal;

use super::{push_text, wire::mode_name};

/// Maximal messages per second and motor, counted separately for replies to drive frames and to queries.
pub const PER_SECOND: u32 = 50;

const PERIOD: Duration = Duration::from_micros(1_000_000 / PER_SECOND as u64);

/// Tolerance of the period: replies that come at exactly this rate with jitter are all written.
const EARLY: Duration = Duration::from_micros(2_500);

/// The state of every motor.
#[derive(Debug, Default)]
pub(crate) struct Motors(BTreeMap<MotorId, Motor>);

#[derive(Debug, Default)]
struct Motor {
    drive: Option<(Drive, Option<Mode>)>,
    replied: Option<(Instant, Reply)>,
    /// The time of the last angle, and its degrees.
    angle: Option<(Instant, f64)>,
    turned_deg: f64,
    /// The time of the last message, by layout of the reply.
    written: [Option<Instant>; 3],
}

/// A reply with the state that a plot needs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reported {
    pub(crate) reply: Reply,
    /// The last drive frame, and the loop that it was read in.
    drive: Option<(Drive, Option<Mode>)>,
    turns: Option<f64>,
    /// Whether a message is due: see [`PER_SECOND`].
    pub(crate) is_due: bool,
    /// The previous faults, if they have changed.
    pub(crate) faults_changed: Option<Faults>,
}

impl Motors {
    /// Takes an event of the bus. Returns the telemetry if it is a valid reply.
    pub(crate) fn add_event(&mut self, event: &LineEvent) -> Option<Reported> {
        match event.kind {
            LineEventKind::Sent { frame, mode }
            | LineEventKind::SentByHand { frame, mode }
            | LineEventKind::RepeatedByHand { frame, mode }
            | LineEventKind::Commanded { frame, mode } => {
                if let Ok(Request::Drive { id, drive }) = Request::parse(&frame) {
                    self.0.entry(id).or_default().drive = Some((drive, mode));
                }
                None
            }
            LineEventKind::Received { frame, asked } | LineEventKind::Reading { frame, asked } => {
                let reply = Reply::decode(&frame, asked).ok()?;
                let motor = self.0.entry(reply.id).or_default();
                Some(motor.reported(event.at, reply, asked))
            }
            LineEventKind::Junk(_)
            | LineEventKind::Silence { .. }
            | LineEventKind::NotSent { .. }
            | LineEventKind::ModelSelected(_) => None,
        }
    }
}

impl Motor {
    fn reported(&mut self, at: Instant, reply: Reply, asked: Option<Layout>) -> Reported {
        let before = self.replied.replace((at, reply)).map(|(_, reply)| reply);
        if let Some(degrees) = degrees_of(&reply) {
            // Without a speed it turned by the least of all rotations.
            self.turn_to(
                at,
                degrees,
                reply.speed.map_or(0.0, |speed| f64::from(speed.rpm())),
            );
        }
        let changed =
            before.is_none_or(|before| (before.mode, before.faults) != (reply.mode, reply.faults));
        let [drive, query, unknown] = &mut self.written;
        let written = match asked {
            Some(Layout::Drive | Layout::Temperature) => drive,
            Some(Layout::Query) => query,
            None => unknown,
        };
        let waited =
            written.is_none_or(|written| at < written || at.since(written) + EARLY >= PERIOD);
        let is_due = waited || changed;
        if is_due {
            *written = Some(at);
        }
        let faults_before = before.map_or(Faults::NONE, |before| before.faults);
        Reported {
            reply,
            drive: self.drive,
            turns: self.angle.map(|_| self.turned_deg / 360.0),
            is_due,
            faults_changed: (faults_before != reply.faults).then_some(faults_before),
        }
    }

    /// Counts turns: of all rotations to the new angle, it selects the one that fits the speed. The reported angle
    /// falls at positive speed; turns count up.
    fn turn_to(&mut self, at: Instant, degrees: f64, rpm: f64) {
        if let Some((before_at, before)) = self.angle {
            let expected = 6.0 * rpm * at.since(before_at).as_secs_f64();
            let turned = before - degrees;
            let turns = ((expected - turned) / 360.0).round();
            self.turned_deg += turned + 360.0 * turns;
        }
        self.angle = Some((at, degrees));
    }
}

fn degrees_of(reply: &Reply) -> Option<f64> {
    match reply.detail {
        Detail::Drive { position } | Detail::Odometry { position, .. } => {
            Some(position.degrees().into())
        }
        Detail::Query { position, .. } => Some(position.degrees().into()),
        Detail::Temperature(_) | Detail::Undetermined(_) => None,
    }
}

impl Reported {
    /// Writes the message. A value that the reply does not contain is left out, never repeated.
    pub(crate) fn write(&self, out: &mut String, at: Instant) {
        let Reply {
            mode,
            current,
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
        if let Some(current) = current {
            out.push_str(",\"current_a\":");
            push_scaled(out, current.raw() < 0, current.scaled());
        }
        match detail {
            Detail::Drive { position } | Detail::Odometry { position, .. } => {
                out.push_str(",\"position_deg\":");
                push_scaled(out, false, position.scaled());
            }
            Detail::Query {
                temperature,
                position,
            } => {
                out.push_str(",\"position_deg\":");
                push_scaled(out, false, position.scaled());
                out.push_str(",\"temperature_c\":");
                push_decimal(out, temperature.degrees().into());
            }
            Detail::Temperature(temperature) => {
                out.push_str(",\"temperature_c\":");
                push_decimal(out, temperature.degrees().into());
            }
            Detail::Undetermined(_) => {}
        }
        if let Some(turns) = self.turns {
            // Writing to a string cannot fail.
            let _ = write!(out, ",\"turns\":{turns:.4}");
        }
        out.push_str(",\"mode\":\"");
        out.push_str(mode_name(mode));
        out.push_str("\",\"fault_code\":");
        push_decimal(out, faults.byte().into());
        out.push_str(",\"faults\":[");
        push_faults(out, faults);
        out.push(']');
        self.write_setpoint(out);
        out.push('}');
    }

    /// The setpoint, where the loop is known in which the motor reads it.
    fn write_setpoint(&self, out: &mut String) {
        let Some((drive, Some(mode))) = self.drive else {
            return;
        };
        out.push_str(",\"setpoint\":");
        match mode {
            Mode::Velocity | Mode::OpenLoop => push_signed(out, drive.signed()),
            Mode::Current => {
                let current = motorlink_protocol::Current::from_raw(drive.signed());
                push_scaled(out, current.raw() < 0, current.scaled());
            }
            Mode::Position => {
                let position = Position::from_raw(drive.unsigned());
                push_scaled(out, false, position.scaled());
            }
        }
        let brakes = mode == Mode::Velocity && drive.brakes();
        out.push_str(if brakes {
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
        assert!(reported.is_due && reported.faults_changed.is_none());
        assert_eq!(
            text(&reported),
            r#"{"mono_us":5000,"speed_rpm":100,"current_a":0.175,"position_deg":66.96,"turns":0.0000,"mode":"velocity","fault_code":0,"faults":[],"setpoint":100,"brake":false}"#
        );
        let reported = motors
            .add_event(&event(4, reply(0x1C00, -7, Layout::Query)))
            .unwrap();
        assert!(text(&reported).contains(
            r#""speed_rpm":-7,"current_a":0.175,"position_deg":0.0,"temperature_c":28,"#
        ));
    }

    #[test]
    fn fifty_of_five_hundred_replies_a_second_are_written() {
        let mut motors = Motors::default();
        let due = |motors: &mut Motors, n: u64| {
            let reported = motors.add_event(&event(2 * n, reply(0, 1, Layout::Drive)));
            reported.unwrap().is_due
        };
        let written = (0..500).filter(|n| due(&mut motors, *n)).count();
        assert!((50..=56).contains(&written), "{written}");
        let mut motors = Motors::default();
        let at_fifty = (0..50).filter(|n| due(&mut motors, 10 * n)).count();
        assert_eq!(at_fifty, 50, "a slow motor's replies are all written");
    }

    #[test]
    fn turns_are_counted_by_angle_and_speed() {
        let mut motors = Motors::default();
        let mut last = None;
        // 300 rpm are five turns a second; a reply each 150 ms is three quarters of a turn behind the one before.
        for n in 0..=40_u64 {
            // Quarters of a turn: full scale is 32,767.
            let raw = [0, 8_192, 16_384, 24_575][usize::try_from(n % 4).unwrap()];
            last = motors.add_event(&event(150 * n, reply(raw, 300, Layout::Drive)));
        }
        let turns = last.unwrap().turns.unwrap();
        assert!((turns - 30.0).abs() < 0.01, "{turns}");
    }

    #[test]
    fn a_change_of_faults_is_always_written() {
        let mut motors = Motors::default();
        let good = motorlink_protocol::Frame::with_crc([1, 2, 0, 0, 0, 0, 0, 0, 0]);
        let stalled = motorlink_protocol::Frame::with_crc([1, 2, 0, 0, 0, 0, 0, 0, 8]);
        let mut pass = |at, frame| {
            let asked = Some(Layout::Drive);
            let kind = LineEventKind::Received { frame, asked };
            motors.add_event(&event(at, kind)).unwrap()
        };
        assert!(pass(0, good).is_due);
        let reported = pass(1, stalled);
        assert!(reported.is_due && reported.faults_changed == Some(Faults::NONE));
        assert!(text(&reported).contains(r#""fault_code":8,"faults":["stall"]"#));
        assert!(!pass(2, stalled).is_due);
        assert!(pass(3, good).faults_changed.is_some());
    }
}
