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
    connection::{Connection, Happened, WIRING, is_not_done, on_line},
    failure::Failure,
    output::{print, say},
    words,
};

/// Scans the bus, and prints the motors that answer.
pub fn run(global: &Global, as_json: bool, ender: &Ender) -> Result<(), Failure> {
    let (report, model) = scan_any(global, ender)?;
    if as_json {
        print(to_json(&report, model))?;
    } else {
        describe(&report, model)?;
    }
    if report.found.is_empty() {
        return Err(Failure::NotDone(why_none(&report)));
    }
    Ok(())
}

/// Scans at the baud rate at which motors answer, or at both.
fn scan_any(global: &Global, ender: &Ender) -> Result<(ScanReport, Model), Failure> {
    let (first, model, is_known) = scan_for(global, global.model, ender)?;
    let is_chosen = global.model.is_some() || global.virtual_motors.is_some();
    if !first.found.is_empty() || is_known || is_chosen {
        return Ok((first, model));
    }
    // Motors of the other baud rate hear nothing of this scan.
    let other = match model {
        Model::Ddsm400 => Model::Ddsm115,
        _ => Model::Ddsm400,
    };
    let (second, answered_as, _) = scan_for(global, Some(other), ender)?;
    Ok(if second.found.is_empty() {
        (first, model)
    } else {
        (second, answered_as)
    })
}

/// Scans for this model, or for the one that answers. Returns the model, and whether a motor has answered as it.
fn scan_for(
    global: &Global,
    model: Option<Model>,
    ender: &Ender,
) -> Result<(ScanReport, Model, bool), Failure> {
    let mut scanned = Err(Failure::Interrupted);
    on_line(
        global,
        ender,
        |options| options.model = model,
        |connection| {
            let report = scan(connection)?;
            let line = connection.status()?.line;
            let is_known = line.is_some_and(|line| line.model_known);
            scanned = Ok((report, connection.driver.model(), is_known));
            Ok(())
        },
    )?;
    scanned
}

/// Asks every ID.
///
/// # Errors
/// Not every ID was asked.
pub fn scan(connection: &Connection) -> Result<ScanReport, Failure> {
    connection.is_scanning.set(true);
    let scanned = scan_all(connection);
    connection.is_scanning.set(false);
    scanned
}

fn scan_all(connection: &Connection) -> Result<ScanReport, Failure> {
    connection.driver.command(Command::FullScan);
    let shows = connection.shows_progress() && stderr().is_terminal();
    let report = loop {
        match connection.next_within(Duration::from_millis(100))? {
            Happened::Entry(_, Entry::Event(Event::ScanEnded(report))) => break report,
            Happened::Entry(_, Entry::Event(Event::OtherModel { found, .. })) => {
                return Err(Failure::OtherModel(found));
            }
            Happened::Entry(_, Entry::PortLost { .. }) => return Err(not_scanned()),
            Happened::Entry(_, entry) if is_not_done(&entry) => return Err(not_scanned()),
            Happened::Entry(..) => {}
            Happened::Nothing => {
                if shows
                    && let Some(JobStatus::Scanning { asked, of, .. }) = connection.status()?.job
                {
                    let _ = write!(stderr(), "\rscanning: {asked} of {of} IDs ");
                }
            }
        }
    };
    if shows {
        let _ = write!(stderr(), "\r\x1b[K");
    }
    // One that was cancelled proves nothing.
    if report.complete {
        Ok(report)
    } else {
        Err(not_scanned())
    }
}

fn not_scanned() -> Failure {
    Failure::NotDone("the bus was not scanned to the end".to_owned())
}

fn describe(report: &ScanReport, model: Model) -> Result<(), Failure> {
    if !report.found.is_empty() {
        print(format_args!(
            "Found {} motor(s) of model {model}:",
            report.found.len()
        ))?;
    }
    for id in &report.found {
        print(format_args!("  - ID {id} (decimal {})", id.get()))?;
    }
    if !report.noisy.is_empty() {
        say(format_args!(
            "noise and no clean reply at {}: two motors may share that ID",
            words::ids(report.noisy.iter().copied())
        ));
    }
    say(format_args!(
        "{} IDs in {:.1} s",
        report.asked,
        f64::from(report.took_ms) / 1000.0
    ));
    Ok(())
}

fn why_none(report: &ScanReport) -> String {
    let text = match report.fault {
        Some(ScanFault::Blocks) => "the adapter delivers only blocks of 32 bytes: use another one",
        Some(ScanFault::Floating) => "no motor answers, and A and B float: check the wires",
        None if report.noisy.is_empty() => return format!("no motor answers. {WIRING}"),
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
