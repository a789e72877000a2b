//! `motorlink stop`: stops motors, also those that another program has left turning.

use std::time::{Duration, Instant};

use motorlink_bus::{Activity, Command, Event, MotorStatus};
use motorlink_driver::{Ender, Entry, forget_left_driven};
use motorlink_protocol::MotorId;

use crate::{
    arguments::Global,
    connection::{Connection, Happened, on_line},
    failure::Failure,
    output::print,
    scan::scan,
    words,
};

/// How long a stop may take: its window is a little shorter.
const STOP_MAX: Duration = Duration::from_secs(5);

/// Stops the motors of `--id`, or all that answer.
pub fn run(global: &Global, ender: &Ender) -> Result<(), Failure> {
    let asked: Vec<MotorId> = global.id.iter().map(|motor| motor.id).collect();
    on_line(
        global,
        ender,
        |_| (),
        |connection| stop(connection, asked.clone()),
    )
}

/// Forgets what an earlier program left driven: the motors of `--id`, or all. It opens no line.
pub fn forget(global: &Global) -> Result<(), Failure> {
    if global.virtual_motors.is_some() {
        let text = "--virtual leaves no motor driven: leave out one of --forget and --virtual";
        return Err(Failure::Usage(text.to_owned()));
    }
    let these: Vec<MotorId> = global.id.iter().map(|motor| motor.id).collect();
    let forgotten = forget_left_driven(global.port.as_deref(), &these)?;
    print(if forgotten.is_empty() {
        "no motor was left driven".to_owned()
    } else {
        format!("forgotten: {}", words::ids(forgotten))
    })
}

fn stop(connection: &Connection, mut ids: Vec<MotorId>) -> Result<(), Failure> {
    if ids.is_empty() {
        ids = scan(connection)?.found;
        if ids.is_empty() {
            let text = "no motor answers, so none can be stopped: cut the power";
            return Err(Failure::NotDone(text.to_owned()));
        }
    }
    for id in &ids {
        connection.driver.command(Command::Watch(*id));
        connection.driver.command(Command::Stop(*id));
    }
    let until = Instant::now() + STOP_MAX;
    while !ids.is_empty() && Instant::now() < until {
        if let Happened::Entry(_, Entry::Event(Event::StopEnded(report))) = connection.next()? {
            print(words::of_stop(&report))?;
            let stands = |id: &MotorId| {
                report
                    .motors
                    .iter()
                    .any(|motor| motor.id == *id && motor.confirmed)
            };
            ids.retain(|id| !stands(id));
            if !connection.status()?.motors.iter().any(is_stopping) {
                break;
            }
        }
    }
    if ids.is_empty() {
        return Ok(());
    }
    let ids = words::ids(ids);
    Err(Failure::NotDone(format!(
        "not confirmed to stand: {ids}. Cut their power"
    )))
}

fn is_stopping(motor: &MotorStatus) -> bool {
    matches!(motor.activity, Activity::Stopping { .. })
}
