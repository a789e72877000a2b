//! `motorlink stop`: stops motors that turn, whoever drives them.

use std::time::Duration;

use motorlink_bus::{Activity, Command, Event, MotorStatus};
use motorlink_driver::{Ender, Entry};
use motorlink_protocol::MotorId;

use crate::{
    arguments::Global,
    connection::{Connection, Happened},
    failure::Failure,
    scan::scan,
    words,
};

/// How long a stop may take: its window is a little shorter.
const STOP_MAX: Duration = Duration::from_secs(5);

/// Stops the motors of `--id`, or all that answer.
pub fn run(global: &Global, ender: &Ender) -> Result<(), Failure> {
    let connection = Connection::open(global, ender)?;
    let mut ids: Vec<MotorId> = global.id.iter().map(|motor| motor.id).collect();
    if ids.is_empty() {
        ids = scan(&connection)?.found;
        if ids.is_empty() {
            return Err(Failure::NotDone(
                "no motor answers, so none can be stopped: cut the power".to_owned(),
            ));
        }
    }
    for id in &ids {
        connection.driver.command(Command::Watch(*id));
        connection.driver.command(Command::Stop(*id));
    }
    let mut confirmed = Vec::new();
    let begun = std::time::Instant::now();
    while begun.elapsed() < STOP_MAX {
        if let Happened::Entry(_, Entry::Event(Event::StopEnded(report))) = connection.next()? {
            println!("{}", words::of_stop(&report));
            let stands = report.motors.iter().filter(|motor| motor.confirmed);
            confirmed.extend(stands.map(|motor| motor.id));
            let stops = |motor: &MotorStatus| matches!(motor.activity, Activity::Stopping { .. });
            if !connection.status()?.motors.iter().any(stops) {
                break;
            }
        }
    }
    ids.retain(|id| !confirmed.contains(id));
    connection.end()?;
    if ids.is_empty() {
        return Ok(());
    }
    Err(Failure::NotDone(format!(
        "not confirmed to stand: {}",
        words::ids(ids)
    )))
}
