//! A sample of telemetry as a line, in the columns of the article's monitor script.
//!
//! | column | content |
//! |---|---|
//! | `timestamp` | ISO 8601, UTC, to the millisecond |
//! | `motor_id` | 1-254 |
//! | `mode` | `Open loop`, `Current`, `Velocity` or `Position` |
//! | `speed_rpm` | signed |
//! | `current_a` | signed, three decimals; empty if it is uncertain how many amps the reported number is |
//! | `temp_c` | only in replies to a feedback query; of a DDSM210 and a DDSM400 in replies to a drive frame |
//! | `position_deg` | two decimals in replies to a drive frame, one decimal in replies to a query, by their resolution; empty if the request is uncertain. Of a DDSM210 and a DDSM400 two decimals, in replies to a query |
//! | `error_code` | byte 8, `0x00` |
//! | `error_str` | `OK`, or names with <code> &#124; </code> between |
//! | `raw_hex` | the ten bytes |

use motorlink_protocol::{Angle, Celsius, Faults, Mode, Reply, Rpm, Scaled, family::Current};

use super::cells::Cells;
use crate::{
    digits::{push_0x, push_decimal, push_hex, push_padded},
    recording::Sample,
    wall_clock::{IsoWriter, WallClock},
};

const HEAD: [&str; 10] = [
    "timestamp",
    "motor_id",
    "mode",
    "speed_rpm",
    "current_a",
    "temp_c",
    "position_deg",
    "error_code",
    "error_str",
    "raw_hex",
];

/// Adds the names of the columns.
pub(super) fn push_head(cells: &mut Cells, out: &mut Vec<u8>) {
    cells.names(&HEAD);
    cells.end_line(out);
}

/// A loop in the column `mode`.
#[must_use]
pub const fn mode_cell(mode: Mode) -> &'static str {
    match mode {
        Mode::OpenLoop => "Open loop",
        Mode::Current => "Current",
        Mode::Velocity => "Velocity",
        Mode::Position => "Position",
    }
}

#[derive(Debug, Default)]
pub(super) struct TelemetryLines {
    times: IsoWriter,
}

impl TelemetryLines {
    pub(super) fn write(
        &mut self,
        cells: &mut Cells,
        sample: &Sample,
        reply: &Reply,
        clock: WallClock,
    ) {
        cells.value(|out| self.times.push(out, clock.utc(sample.at)));
        cells.value(|out| push_decimal(out, reply.id.get().into()));
        cells.plain(mode_cell(reply.mode));
        cells.known(reply.speed, push_rpm);
        cells.known(sample.certain_current(), push_amps);
        cells.known(reply.detail.temperature(), push_celsius);
        cells.known(reply.detail.angle(), push_angle);
        cells.value(|out| push_0x(out, reply.faults.byte()));
        cells.value(|out| push_faults(out, reply.faults));
        cells.value(|out| push_hex(out, sample.frame.bytes()));
    }
}

#[inline(never)]
pub(super) fn push_rpm(out: &mut String, speed: Rpm) {
    push_signed(out, speed.rpm());
}

#[inline(never)]
pub(super) fn push_amps(out: &mut String, current: Current) {
    push_minus(out, current.raw());
    push_scaled(out, current.scaled());
}

pub(super) fn push_celsius(out: &mut String, temperature: Celsius) {
    push_decimal(out, temperature.degrees().into());
}

#[inline(never)]
pub(super) fn push_angle(out: &mut String, angle: Angle) {
    match angle {
        Angle::Fine(position) => push_scaled(out, position.scaled()),
        Angle::Coarse(position) => push_scaled(out, position.scaled()),
    }
}

pub(super) fn push_signed(out: &mut String, value: i16) {
    push_minus(out, value);
    push_decimal(out, value.unsigned_abs().into());
}

/// The ASCII minus, which spreadsheets accept.
fn push_minus(out: &mut String, value: i16) {
    if value < 0 {
        out.push('-');
    }
}

#[inline(never)]
pub(super) fn push_scaled<const DECIMALS: usize>(out: &mut String, value: Scaled<DECIMALS>) {
    push_decimal(out, value.whole.into());
    out.push('.');
    push_padded(out, value.fraction.into(), DECIMALS);
}

fn push_faults(out: &mut String, faults: Faults) {
    if faults.is_none() {
        out.push_str("OK");
        return;
    }
    let mut separator = "";
    for fault in faults.iter() {
        out.push_str(separator);
        out.push_str(fault.name());
        separator = " | ";
    }
    if faults.unknown_bits() != 0 {
        out.push_str(separator);
        out.push_str("unknown bits ");
        push_0x(out, faults.unknown_bits());
    }
}
