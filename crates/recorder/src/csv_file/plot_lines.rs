//! A sample of telemetry as a line for programs that plot columns of numbers.
//!
//! | column | content |
//! |---|---|
//! | `time` | seconds since the first line, to the microsecond |
//! | `motor_<id>_unmirrored_speed_rpm` | signed |
//! | `motor_<id>_unmirrored_current_a` | as in `telemetry_lines` |
//! | `motor_<id>_unmirrored_position_deg` | as in `telemetry_lines` |
//! | `motor_<id>_temperature_c` | as in `telemetry_lines` |
//! | `motor_<id>_mode` | 0 open loop, 1 current, 2 velocity, 3 position |
//! | `motor_<id>_fault_code` | byte 8 of the reply, as a decimal number |
//! | `motor_<id>_unmirrored_setpoint` | what the motor was told: rpm, A, degrees or the raw share of the supply, by its loop; empty without a command |
//! | `motor_<id>_setpoint_mode` | the loop of that command, as in `mode` |
//! | `motor_<id>_unmirrored_current_raw` | the current as the motor reports it |
//!
//! The cells of all other motors are empty. `unmirrored` is the sign of the motor itself: the page shows that of a mirrored
//! motor reversed.

use motorlink_bus::CommandedValue;
use motorlink_protocol::{Instant, Reply};

use super::{
    cells::Cells,
    telemetry_lines::{push_amps, push_angle, push_celsius, push_rpm, push_scaled, push_signed},
};
use crate::{digits::push_decimal, recording::Sample, wall_clock::push_seconds_to_us};

/// The quantities of a motor, in the order of their columns.
const QUANTITIES: [&str; 9] = [
    "unmirrored_speed_rpm",
    "unmirrored_current_a",
    "unmirrored_position_deg",
    "temperature_c",
    "mode",
    "fault_code",
    "unmirrored_setpoint",
    "setpoint_mode",
    "unmirrored_current_raw",
];

#[derive(Debug, Default)]
pub(super) struct PlotLines {
    /// The IDs of the motors with columns, ascending.
    motors: Vec<u8>,
    first_at: Option<Instant>,
}

impl PlotLines {
    /// Adds columns for a motor, unless it has some.
    pub(super) fn add_motor(&mut self, address: u8) {
        let place = self.motors.iter().take_while(|id| **id < address).count();
        if self.motors.get(place) != Some(&address) {
            self.motors.insert(place, address);
        }
    }

    /// Adds the names of the columns.
    pub(super) fn push_head(&self, cells: &mut Cells, out: &mut Vec<u8>) {
        cells.plain("time");
        for motor in &self.motors {
            for quantity in QUANTITIES {
                cells.value(|out| {
                    out.push_str("motor_");
                    push_decimal(out, u64::from(*motor));
                    out.push('_');
                    out.push_str(quantity);
                });
            }
        }
        cells.end_line(out);
    }

    #[inline(never)]
    pub(super) fn write(&mut self, cells: &mut Cells, sample: &Sample, reply: &Reply) {
        let first_at = *self.first_at.get_or_insert(sample.at);
        let elapsed = sample.at.as_micros().saturating_sub(first_at.as_micros());
        cells.value(|out| push_seconds_to_us(out, elapsed));
        for motor in &self.motors {
            if *motor == sample.address() {
                write_reply(cells, sample, reply);
                write_command(cells, sample);
                cells.known(sample.current(), |out, current| {
                    push_signed(out, current.raw());
                });
            } else {
                for _ in QUANTITIES {
                    cells.unknown();
                }
            }
        }
    }
}

fn write_reply(cells: &mut Cells, sample: &Sample, reply: &Reply) {
    cells.known(reply.speed, push_rpm);
    cells.known(sample.certain_current(), push_amps);
    cells.known(reply.detail.angle(), push_angle);
    cells.known(reply.detail.temperature(), push_celsius);
    cells.value(|out| push_decimal(out, reply.mode.byte().into()));
    cells.value(|out| push_decimal(out, reply.faults.byte().into()));
}

fn write_command(cells: &mut Cells, sample: &Sample) {
    let Some(commanded) = sample.commanded else {
        cells.unknown();
        cells.unknown();
        return;
    };
    cells.value(|out| match commanded.value(sample.model) {
        CommandedValue::Speed(speed) => push_rpm(out, speed),
        CommandedValue::Current(current) => push_amps(out, current),
        CommandedValue::Position(position) => push_scaled(out, position.scaled()),
        // The raw value.
        CommandedValue::OpenLoop(target) => push_signed(out, target.raw()),
    });
    cells.value(|out| push_decimal(out, commanded.mode.byte().into()));
}
