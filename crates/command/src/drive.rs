//! `motorlink drive`: holds a setpoint, then stops the motors and confirms their standstill.

use std::{
    io::{IsTerminal, Write, stdout},
    time::{Duration, Instant},
};

use motorlink_bus::{Activity, BusSettings, Consent, Event, StopReason, needs_consent};
use motorlink_driver::{Ender, Entry, Status};
use motorlink_protocol::{
    Acceleration, CurrentTarget, PositionTarget, Setpoint, SpeedTarget, family::Model,
};

use crate::{
    arguments::{Drive, Global, How},
    connection::{Connection, Happened, is_not_done},
    failure::Failure,
    group_switch::GroupSwitch,
    signed_id::SignedId,
    starting,
    stop_report::most_serious,
    values::Values,
};

/// How long an entry is waited for.
const STEP: Duration = Duration::from_millis(20);
/// How often the line of a terminal is drawn.
const DRAW: Duration = Duration::from_millis(100);

/// Drives the motors until the time is over, Ctrl-C, or one of them ends it.
pub fn run(global: &Global, drive: Drive, ender: &Ender) -> Result<(), Failure> {
    let (setpoint, how, settings, consent) = asked(drive)?;
    let mut connection = Connection::open_with(global, ender, |options| {
        options.settings = settings;
        options.tells_traffic = how.record.is_some();
    })?;
    let driven = connection.wait_for_motors().and_then(|()| {
        if let Some(file) = &how.record {
            connection.record(Some(file))?;
        }
        if let Some(mut switch) = GroupSwitch::of(&connection.motors, setpoint) {
            while !switch.step(&connection, STEP)? {}
        }
        let motors = connection.motors.iter().copied();
        let command = starting::start(motors, setpoint, consent).map_err(usage)?;
        connection.driver.command(command);
        hold(&connection, how.secs)
    });
    let stopped = connection.end_with(|_| ());
    // Ctrl-C is the usual end of a drive.
    let driven = match driven {
        Err(Failure::Interrupted) => Ok(()),
        driven => driven,
    };
    most_serious(driven, stopped)
}

/// Reads the setpoint, of a wheel that is not mirrored.
fn asked(drive: Drive) -> Result<(Setpoint, How, BusSettings, Consent), Failure> {
    let mut settings = BusSettings::default();
    let (setpoint, how, consent) = match drive {
        Drive::Velocity {
            value,
            rpm,
            accel,
            ramp,
            how,
        } => {
            settings.ramp = ramp;
            let setpoint = rpm_setpoint(value.or(rpm).unwrap_or_default(), accel)?;
            (setpoint, how, Consent::None)
        }
        Drive::Current {
            value,
            amps,
            high_current,
            how,
        } => {
            let setpoint = amps_setpoint(value.or(amps).unwrap_or_default())?;
            (setpoint, how, consent_for(setpoint, high_current)?)
        }
        Drive::Position { value, deg, how } => {
            let setpoint = degrees_setpoint(value.or(deg).unwrap_or_default())?;
            (setpoint, how, Consent::None)
        }
    };
    settings.rate = how.rate;
    Ok((setpoint, how, settings, consent))
}

/// A speed, and how gently the motor itself speeds up.
///
/// # Errors
/// It is out of range.
pub fn rpm_setpoint(rpm: i32, acceleration: u8) -> Result<Setpoint, Failure> {
    Ok(Setpoint::Velocity {
        speed: SpeedTarget::new(rpm).map_err(usage)?,
        acceleration: Acceleration::new(acceleration),
    })
}

/// A torque current.
///
/// # Errors
/// It is out of range.
pub fn amps_setpoint(amps: f32) -> Result<Setpoint, Failure> {
    if !(-8.0..=8.0).contains(&amps) {
        return Err(Failure::Usage("current: expected -8 to 8 A".to_owned()));
    }
    Ok(Setpoint::Current(CurrentTarget::from_amps(amps)))
}

/// What a setpoint needs, if `high_current` allows it.
///
/// # Errors
/// It is not allowed.
pub fn consent_for(setpoint: Setpoint, high_current: bool) -> Result<Consent, Failure> {
    let consent = needs_consent(setpoint);
    if consent == Consent::HighCurrent && !high_current {
        let text = format!("{setpoint} is above 6.1 A: add --high-current to allow it");
        return Err(Failure::Usage(text));
    }
    Ok(consent)
}

/// An angle.
///
/// # Errors
/// It is out of range.
pub fn degrees_setpoint(degrees: f32) -> Result<Setpoint, Failure> {
    if !(0.0..=360.0).contains(&degrees) {
        let text = "angle: expected 0 to 360 degrees";
        return Err(Failure::Usage(text.to_owned()));
    }
    Ok(Setpoint::Position(PositionTarget::from_degrees(degrees)))
}

fn usage(error: impl std::fmt::Display) -> Failure {
    Failure::Usage(error.to_string())
}

/// Holds what was started until the time is over, which counts from the moment at which all motors are driven.
///
/// # Errors
/// A motor, the line or Ctrl-C has ended the drive.
pub fn hold(connection: &Connection, secs: Option<Duration>) -> Result<(), Failure> {
    let shows = stdout().is_terminal();
    let held = hold_showing(connection, secs, shows);
    if shows {
        // What follows is below the line that was drawn. A terminal that is gone ends the program by a signal.
        let _ = writeln!(stdout());
    }
    held
}

fn hold_showing(
    connection: &Connection,
    secs: Option<Duration>,
    shows: bool,
) -> Result<(), Failure> {
    let model = connection.driver.model();
    let mut all_driven = false;
    let mut until = None;
    let mut was_lost = false;
    let mut draw_at = Instant::now();
    loop {
        // Once all are driven, it sleeps until it draws, ends, or something happens.
        let next = until.map_or(draw_at, |until: Instant| until.min(draw_at));
        let wait = if all_driven {
            next.saturating_duration_since(Instant::now())
        } else {
            STEP
        };
        if let Happened::Entry(_, entry) = connection.next_within(wait)? {
            was_lost |= matches!(entry, Entry::PortLost { .. });
            if ends_drive(&entry, was_lost) {
                return Err(Failure::NotDone("the drive has ended".to_owned()));
            }
        }
        let now = Instant::now();
        if until.is_some_and(|until| now >= until) {
            return Ok(());
        }
        let draws = now >= draw_at;
        if draws {
            draw_at = now + DRAW;
        }
        if all_driven && !(draws && shows) {
            continue;
        }
        let status = connection.status()?;
        let of = |signed: &SignedId| status.motor(signed.id);
        let is_driven = |signed: &SignedId| {
            of(signed).is_some_and(|motor| matches!(motor.activity, Activity::Driven { .. }))
        };
        if !all_driven && connection.motors.iter().all(is_driven) {
            all_driven = true;
            until = secs.map(|secs| now + secs);
        }
        if draws && shows {
            draw(&status, &connection.motors, model);
        }
    }
}

fn draw(status: &Status, motors: &[SignedId], model: Model) {
    let of = |signed: &SignedId| {
        let motor = status.motor(signed.id)?;
        let values = Values::of(model, motor, status.now, *signed);
        let speed = values
            .speed_rpm
            .map_or_else(|| "-".to_owned(), |rpm| format!("{rpm:+}"));
        let current = values.current.unwrap_or_else(|| "-".to_owned());
        Some(format!(
            "{signed} {speed:>4} rpm {current} ({})",
            values.does
        ))
    };
    let motors: Vec<_> = motors.iter().filter_map(of).collect();
    let mut out = stdout().lock();
    // A terminal that is gone ends the program by a signal.
    let _ = write!(out, "\r\x1b[K{}  Ctrl-C stops", motors.join("  "));
    let _ = out.flush();
}

/// Whether an entry ends the drive. What was driven when the port was lost is stopped when it is back, which ends it too.
#[must_use]
pub fn ends_drive(entry: &Entry, was_lost: bool) -> bool {
    match entry {
        Entry::Event(Event::StopEnded(report)) => {
            was_lost && report.reason == StopReason::LeftDriven
        }
        Entry::Event(Event::StopBegan(reason)) => matches!(
            reason,
            StopReason::PageSilent | StopReason::ComputerSlept | StopReason::LoopDelayed
        ),
        Entry::Event(event) => matches!(
            event,
            Event::NotStarted { .. }
                | Event::Withdrawn { .. }
                | Event::ModeSwitchFailed { .. }
                | Event::OtherModel { .. }
        ),
        entry => is_not_done(entry),
    }
}
