//! A CSV file for PlotJuggler and other programs that plot columns of numbers.
//!
//! | column | content |
//! |---|---|
//! | `time` | seconds since the first record, to the microsecond |
//! | `motor_<id>_speed_rpm` | speed |
//! | `motor_<id>_current_a` | torque current |
//! | `motor_<id>_position_deg` | angle of the wheel |
//! | `motor_<id>_temperature_c` | winding; replies to feedback queries only |
//! | `motor_<id>_mode` | 1 current, 2 velocity, 3 position |
//! | `motor_<id>_fault_code` | byte 8 of the reply |
//! | `motor_<id>_setpoint` | of the last drive frame: rpm, A or degrees, by its loop |
//!
//! Each line is a reply or a drive frame. Values that it does not contain are empty.

use std::fmt::Write;

use motorlink_bus::LineEventKind;
use motorlink_protocol::{Current, Detail, Instant, Mode, MotorId, Position, Reply, Request};

use crate::{
    overview::Overview,
    record::{Record, What},
};

/// The quantities of a motor, in the order of their columns.
const QUANTITIES: [&str; 7] = [
    "speed_rpm",
    "current_a",
    "position_deg",
    "temperature_c",
    "mode",
    "fault_code",
    "setpoint",
];

/// One motor's cells in a line.
type Cells = [String; QUANTITIES.len()];

/// Writes such a file line by line.
#[derive(Debug)]
pub struct PlotTable {
    motors: Vec<MotorId>,
    first: Option<Instant>,
}

impl PlotTable {
    /// A table with the columns of these motors.
    #[must_use]
    pub fn new(overview: &Overview) -> Self {
        Self {
            motors: overview.motors().map(|(id, _)| id).collect(),
            first: None,
        }
    }

    /// Adds the names of the columns.
    pub fn head(&self, out: &mut String) {
        out.push_str("time");
        for (motor, quantity) in self
            .motors
            .iter()
            .flat_map(|id| QUANTITIES.map(|q| (id, q)))
        {
            // Writing to a string cannot fail.
            let _ = write!(out, ",motor_{}_{quantity}", motor.get());
        }
        out.push_str("\r\n");
    }

    /// Adds the line of a record, if it has one.
    pub fn record(&mut self, out: &mut String, record: &Record) {
        let first = *self.first.get_or_insert(record.at);
        let What::Line(kind) = &record.what else {
            return;
        };
        let Some((id, cells)) = cells_of(kind) else {
            return;
        };
        let after = record.at.since(first);
        let _ = write!(out, "{}.{:06}", after.as_secs(), after.subsec_micros());
        for motor in &self.motors {
            if *motor == id {
                for cell in &cells {
                    out.push(',');
                    out.push_str(cell);
                }
            } else {
                out.extend([','; QUANTITIES.len()]);
            }
        }
        out.push_str("\r\n");
    }
}

fn cells_of(kind: &LineEventKind) -> Option<(MotorId, Cells)> {
    match kind {
        LineEventKind::Received { frame, asked } => {
            let reply = Reply::decode(frame, *asked).ok()?;
            Some((reply.id, cells_of_reply(&reply)))
        }
        LineEventKind::Sent { frame, mode } => {
            let Request::Drive { id, drive } = Request::parse(frame).ok()? else {
                return None;
            };
            let setpoint = match (*mode)? {
                Mode::Velocity => drive.signed().to_string(),
                Mode::Current => amps(Current::from_raw(drive.signed())),
                Mode::Position => Position::from_raw(drive.unsigned()).scaled().to_string(),
            };
            let mut cells = Cells::default();
            let [.., last] = &mut cells;
            *last = setpoint;
            Some((id, cells))
        }
        LineEventKind::Junk(_) | LineEventKind::Silence { .. } | LineEventKind::NotSent { .. } => {
            None
        }
    }
}

fn cells_of_reply(reply: &Reply) -> Cells {
    let (position, temperature) = match reply.detail {
        Detail::Drive { position } => (position.scaled().to_string(), String::new()),
        Detail::Query {
            temperature,
            position,
        } => (
            position.scaled().to_string(),
            temperature.degrees().to_string(),
        ),
        Detail::Undetermined(_) => Default::default(),
    };
    [
        reply.speed.rpm().to_string(),
        amps(reply.current),
        position,
        temperature,
        reply.mode.byte().to_string(),
        reply.faults.byte().to_string(),
        String::new(),
    ]
}

fn amps(current: Current) -> String {
    let sign = if current.raw() < 0 { "-" } else { "" };
    format!("{sign}{}", current.scaled())
}
