//! The second step: all motors on one bus, each with its ID.

use motorlink_bus::ScanReport;
use motorlink_protocol::MotorId;

use crate::{connection::WIRING, failure::Failure, output::say, scan::scan, words};

use super::{DONE, Line, try_again};

/// Asks for all motors and scans, until each of the given ones answers or the person goes on without. Returns all that
/// answer.
///
/// # Errors
/// None answers, or the program ends.
pub fn all_on_one_bus(line: Line<'_>, given: &[MotorId]) -> Result<Vec<MotorId>, Failure> {
    let mut question =
        "\nSwitch the power off, connect all motors, and switch the power on. Press Enter then: "
            .to_owned();
    loop {
        let is_done = line.ask(&question)? == DONE;
        let mut report = None;
        let scanned = line.open(given, |connection| {
            report = Some(scan(connection)?);
            Ok(())
        });
        try_again(scanned)?;
        if let Some(report) = report {
            let is_complete = describe(&report, given);
            if is_complete || (is_done && !report.found.is_empty()) {
                return Ok(report.found);
            }
        }
        question =
            format!("Press Enter to scan again, or type {DONE} to go on with those that answer: ");
    }
}

/// Says which motors answer. Returns whether all is as it should be.
fn describe(report: &ScanReport, given: &[MotorId]) -> bool {
    let ids = |ids: &[MotorId]| words::ids(ids.iter().copied());
    let is_given = |id: &&MotorId| given.contains(id);
    let missing: Vec<MotorId> = given
        .iter()
        .filter(|id| !report.found.contains(id))
        .copied()
        .collect();
    let others: Vec<MotorId> = report
        .found
        .iter()
        .filter(|id| !is_given(id))
        .copied()
        .collect();
    if report.found.is_empty() {
        say(format_args!("No motor answers. {WIRING}"));
    } else {
        say(format_args!("Found {}.", ids(&report.found)));
    }
    if !missing.is_empty() {
        say(format_args!(
            "No reply from {}: check the power and the plugs.",
            ids(&missing)
        ));
    }
    if !given.is_empty() && !others.is_empty() {
        say(format_args!("{} got no ID here.", ids(&others)));
    }
    if !report.noisy.is_empty() {
        say(format_args!(
            "Noise and no clean reply at {}: two motors may share that ID.",
            ids(&report.noisy)
        ));
    }
    missing.is_empty() && report.noisy.is_empty() && !report.found.is_empty()
}
