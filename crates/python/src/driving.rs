//! Drives motors, and stops them.

use std::time::{Duration, Instant};

use motorlink_bus::{Activity, Command, Consent, StopReason, needs_consent};
use motorlink_command::library::{Connection, Failure, Happened, SignedId, adjust, start};
use motorlink_protocol::{MotorId, Setpoint};
use pyo3::prelude::*;

use crate::{
    errors::{InvalidInput, NotDone},
    shared::{STEP, Shared, locked},
};

/// How long a start may take: a stop, a switch of the loop, and the first setpoint.
const START_MAX: Duration = Duration::from_secs(8);
/// How long a stop may take: its window is a little shorter.
pub const STOP_MAX: Duration = Duration::from_secs(5);

/// Drives motors, or changes what is driven. Returns when all of them are driven.
pub fn drive(
    line: &Shared,
    py: Python<'_>,
    motors: &[SignedId],
    setpoint: Setpoint,
    high_current: bool,
) -> PyResult<()> {
    let consent = needs_consent(setpoint);
    if consent != Consent::None && !high_current {
        let text = format!("{setpoint} is above 6.1 A: add high_current=True to allow it");
        return Err(InvalidInput::new_err(text));
    }
    let is_driven = |connection: &Connection| -> Result<bool, Failure> {
        let status = connection.status()?;
        Ok(motors.iter().all(|motor| {
            let activity = status.motor(motor.id).map(|motor| motor.activity);
            matches!(activity, Some(Activity::Driven { setpoint: now }) if now.mode() == setpoint.mode())
        }))
    };
    let adjusts = line.on(py, |connection| {
        while let Happened::Entry(..) = connection.next_within(Duration::ZERO)? {}
        is_driven(connection)
    })?;
    // What ended the drive before is told first.
    line.check()?;
    line.on(py, |connection| {
        let command = if adjusts && consent == Consent::None {
            adjust(motors.iter().copied(), setpoint)
        } else {
            start(motors.iter().copied(), setpoint, consent)
        };
        let command = command.map_err(|error| Failure::Usage(error.to_string()))?;
        connection.driver.command(command);
        Ok(())
    })?;
    if adjusts {
        return Ok(());
    }
    let begun = Instant::now();
    loop {
        line.pump(py, STEP)?;
        line.check()?;
        if line.on(py, |connection| is_driven(connection))? {
            return Ok(());
        }
        if begun.elapsed() > START_MAX {
            return Err(NotDone::new_err("the motors did not start in time"));
        }
    }
}

/// Stops these motors, or all. Returns which of them confirmed their standstill.
pub fn stop(line: &Shared, py: Python<'_>, ids: Option<&[MotorId]>) -> PyResult<Vec<(u8, bool)>> {
    locked(&line.news).stops.clear();
    line.on(py, |connection| {
        match &ids {
            Some(ids) => {
                for id in *ids {
                    connection.driver.command(Command::Stop(*id));
                }
            }
            None => connection
                .driver
                .command(Command::StopAll(StopReason::Operator)),
        }
        Ok(())
    })?;
    let begun = Instant::now();
    loop {
        line.pump(py, STEP)?;
        let reported = line.stopped();
        let is_over = match &ids {
            Some(ids) => {
                let is_told = |id: &MotorId| reported.iter().any(|(of, _)| *of == id.get());
                ids.iter().all(is_told)
            }
            None => !locked(&line.news).stops.is_empty(),
        };
        if is_over || begun.elapsed() > STOP_MAX {
            locked(&line.news).trouble = None;
            return Ok(reported);
        }
    }
}
