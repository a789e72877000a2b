//! Drives motors, and stops them.

use std::{
    collections::BTreeMap,
    time::{Duration, Instant},
};

use motorlink_bus::{Activity, Command, Consent, StopReason, needs_consent};
use motorlink_command::library::{Connection, Failure, GroupSwitch, SignedId, adjust, start};
use motorlink_protocol::{MotorId, Setpoint};
use pyo3::prelude::*;

use crate::{
    errors::{InvalidInput, NotDone},
    shared::{STEP, Shared, locked, take_all},
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
    let ids: Vec<MotorId> = motors.iter().map(|motor| motor.id).collect();
    let adjusts = line.on(py, |connection| {
        take_all(connection, Duration::ZERO)?;
        is_driven(connection)
    })?;
    // What ended the drive before is told first.
    line.check(&ids)?;
    let switch = GroupSwitch::of(motors, setpoint).filter(|_| !adjusts);
    if let Some(mut switch) = switch {
        let switched = loop {
            match line.on(py, |connection| switch.step(connection, STEP)) {
                Ok(false) => py.check_signals()?,
                other => break other,
            }
        };
        if switched.is_err() {
            // It is told once.
            let _ = locked(&line.news).take_trouble(&ids);
            return switched.map(drop);
        }
        // What was heard meanwhile starts nothing.
        line.check(&ids)?;
    }
    line.on(py, |connection| {
        let command = if adjusts && consent == Consent::None {
            adjust(motors.iter().copied(), setpoint, consent)
        } else {
            start(motors.iter().copied(), setpoint, consent)
        };
        let command = command.map_err(|error| Failure::Usage(error.to_string()))?;
        connection.driver.command(command);
        // Its refusal is there when the status is.
        connection.status().map(drop)
    })?;
    let started = line
        .pump(py, Duration::ZERO)
        .and_then(|()| line.check(&ids))
        .and_then(|()| {
            if adjusts {
                return Ok(());
            }
            until_driven(line, py, &ids, is_driven)
        });
    // A refused change of the setpoint leaves the drive as it was.
    if started.is_err() && !adjusts {
        // What was asked for is not started later.
        for id in &ids {
            line.commander.command(Command::Stop(*id));
        }
    }
    started
}

fn until_driven(
    line: &Shared,
    py: Python<'_>,
    ids: &[MotorId],
    is_driven: impl Fn(&Connection) -> Result<bool, Failure> + Sync,
) -> PyResult<()> {
    let begun = Instant::now();
    loop {
        line.pump(py, STEP)?;
        line.check(ids)?;
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
    // First: another call may have the connection.
    match ids {
        Some(ids) => {
            for id in ids {
                line.commander.command(Command::Stop(*id));
            }
        }
        None => line
            .commander
            .command(Command::StopAll(StopReason::Operator)),
    }
    let since = locked(&line.news).next_stop();
    let begun = Instant::now();
    loop {
        line.pump(py, STEP)?;
        let mut news = locked(&line.news);
        let mut confirmed = BTreeMap::new();
        for report in news.stops_since(since) {
            if ids.is_some() || report.reason == StopReason::Operator {
                confirmed.extend(
                    report
                        .motors
                        .iter()
                        .map(|motor| (motor.id, motor.confirmed)),
                );
            }
        }
        let mut all = news.stops_since(since);
        let is_over = match ids {
            Some(ids) => ids.iter().all(|id| confirmed.contains_key(id)),
            None => all.any(|report| report.reason == StopReason::Operator),
        };
        drop(all);
        if !is_over && begun.elapsed() <= STOP_MAX {
            continue;
        }
        if let Some(ids) = ids {
            // Its result is returned.
            let _ = news.take_trouble(ids);
        }
        drop(news);
        if !is_over {
            // The port is lost, or so: nothing is known of any.
            let asked = match ids {
                Some(ids) => ids.to_vec(),
                None => line.on(py, |connection| {
                    let motors = connection.motors.iter();
                    Ok(motors.map(|motor| motor.id).collect())
                })?,
            };
            for id in asked {
                confirmed.entry(id).or_insert(false);
            }
        }
        let told = confirmed.into_iter();
        return Ok(told.map(|(id, stands)| (id.get(), stands)).collect());
    }
}
