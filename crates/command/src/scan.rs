//! `motorlink scan`: which motors are on the bus.

use std::{
    io::{IsTerminal, Write, stderr},
    time::Duration,
};

use motorlink_bus::{Command, Event, JobStatus, ScanFault, ScanReport};
use motorlink_driver::{Ender, Entry};
use motorlink_protocol::family::Model;
use serde_json::{Value, json};

use crate::{
    arguments::Global,
    connection::{Connection, Happened},
    failure::Failure,
    words,
};

/// Scans the bus, and prints the motors that answer.
pub fn run(global: &Global, as_json: bool, ender: &Ender) -> Result<(), Failure> {
    let (report, model) = scan_any(global, ender)?;
    if as_json {
        println!("{}", to_json(&report, model));
    } else {
        print(&report, model);
    }
    if report.found.is_empty() {
        return Err(Failure::NotDone(why_none(&report)));
    }
    Ok(())
}

/// Scans at the baud rate at which motors answer, or at both.
fn scan_any(global: &Global, ender: &Ender) -> Result<(ScanReport, Model), Failure> {
    let connection = Connection::open(global, ender)?;
    let model = connection.driver.model();
    let mut report = scan(&connection)?;
    let is_known = connection
        .status()?
        .line
        .is_some_and(|line| line.model_known);
    connection.end()?;
    if report.found.is_empty()
        && !is_known
        && global.model.is_none()
        && global.virtual_motors.is_none()
    {
        // Motors of the other baud rate hear nothing of this scan.
        let other = if model == Model::Ddsm400 {
            Model::Ddsm115
        } else {
            Model::Ddsm400
        };
        let connection =
            Connection::open_with(global, ender, |options| options.model = Some(other))?;
        let second = scan(&connection)?;
        connection.end()?;
        if !second.found.is_empty() {
            return Ok((second, other));
        }
        report.noisy.extend(second.noisy);
    }
    Ok((report, model))
}

/// Asks every ID.
pub fn scan(connection: &Connection) -> Result<ScanReport, Failure> {
    connection.driver.command(Command::FullScan);
    let shows = stderr().is_terminal();
    loop {
        match connection.next_within(Duration::from_millis(100))? {
            Happened::Entry(_, Entry::Event(Event::ScanEnded(report))) => {
                if shows {
                    eprint!("\r\x1b[K");
                }
                return Ok(report);
            }
            Happened::Entry(_, Entry::Refused { refusal, .. }) => {
                return Err(Failure::NotDone(format!("not scanned: {refusal}")));
            }
            Happened::Entry(_, Entry::PortLost { .. }) => {
                return Err(Failure::NotDone("not scanned: the port is gone".to_owned()));
            }
            Happened::Entry(..) => {}
            Happened::Nothing => {
                if shows
                    && let Some(JobStatus::Scanning { asked, of, .. }) = connection.status()?.job
                {
                    eprint!("\rscanning: {asked} of {of} IDs ");
                    let _ = stderr().flush();
                }
            }
        }
    }
}

fn print(report: &ScanReport, model: Model) {
    if !report.found.is_empty() {
        println!("Found {} motor(s) of model {model}:", report.found.len());
    }
    for id in &report.found {
        println!("  - ID {id} (decimal {})", id.get());
    }
    if !report.noisy.is_empty() {
        eprintln!(
            "noise and no clean reply at {}: two motors may share that ID",
            words::ids(report.noisy.iter().copied())
        );
    }
    eprintln!(
        "{} IDs in {:.1} s",
        report.asked,
        f64::from(report.took_ms) / 1000.0
    );
}

fn why_none(report: &ScanReport) -> String {
    let text = match report.fault {
        Some(ScanFault::Blocks) => "the adapter delivers only blocks of 32 bytes: use another one",
        Some(ScanFault::Floating) => "no motor answers, and A and B float: check the wires",
        None if report.noisy.is_empty() => {
            "no motor answers. Is the supply on? Is the ground joined? Swap A and B"
        }
        None => "no clean reply: check the wires, and connect one motor at a time",
    };
    text.to_owned()
}

fn to_json(report: &ScanReport, model: Model) -> Value {
    let numbers = |ids: &[motorlink_protocol::MotorId]| -> Vec<u8> {
        ids.iter().map(|id| id.get()).collect()
    };
    json!({
        "model": model.spec().key,
        "motors": numbers(&report.found),
        "noisy": numbers(&report.noisy),
        "asked": report.asked,
        "complete": report.complete,
        "took_ms": report.took_ms,
    })
}
