//! `motorlink set-id`: gives the only motor on the bus another ID.

use motorlink_bus::{Command, Event, IdChangeOutcome, SetIdFrames};
use motorlink_driver::{Ender, Entry};
use motorlink_protocol::{AssignableId, MotorId};

use crate::{
    arguments::Global,
    confirm::confirm,
    connection::{Connection, Happened},
    failure::Failure,
    scan::scan,
    words,
};

/// Proves that the motor is alone, asks, changes its ID, and verifies it.
pub fn run(global: &Global, new: AssignableId, yes: bool, ender: &Ender) -> Result<(), Failure> {
    let connection = Connection::open(global, ender)?;
    let from = only_motor(&connection)?;
    if from == new.id() {
        eprintln!("The motor has ID {from} already.");
        return connection.end();
    }
    eprintln!(
        "The only motor on the bus has ID {from}. It keeps the new ID {} without power.",
        new.id()
    );
    if !yes {
        confirm("Change it?")?;
        // A person may have plugged in another motor meanwhile, and the proof has a minute.
        if only_motor(&connection)? != from {
            return Err(Failure::NotDone(
                "another motor is on the bus now".to_owned(),
            ));
        }
    }
    let mut frames = SetIdFrames::default();
    loop {
        let outcome = set_id(&connection, from, new, frames)?;
        match (outcome, frames.more()) {
            (IdChangeOutcome::Changed, _) => {
                println!("Motor {from} has ID {} now, verified.", new.id());
                return connection.end();
            }
            // Some units want more frames in a row.
            (IdChangeOutcome::Kept { .. }, Some(more)) => {
                eprintln!(
                    "It kept its ID after {} frames; trying {}.",
                    frames.count(),
                    more.count()
                );
                frames = more;
                only_motor(&connection)?;
            }
            (outcome, _) => return Err(Failure::NotDone(why_not(outcome, from, new))),
        }
    }
}

/// The only motor on the bus, by a full scan.
fn only_motor(connection: &Connection) -> Result<MotorId, Failure> {
    let report = scan(connection)?;
    match report.found.as_slice() {
        [only] if report.noisy.is_empty() && report.fault.is_none() => Ok(*only),
        [] => Err(Failure::NotDone(
            "no motor answers. Is the supply on? Swap A and B".to_owned(),
        )),
        [_] => Err(Failure::NotDone(
            "the line is noisy, so no motor is proved to be alone: check the wires".to_owned(),
        )),
        several => Err(Failure::NotDone(format!(
            "several motors answer ({}), and all would take the ID: connect one only",
            words::ids(several.iter().copied())
        ))),
    }
}

fn set_id(
    connection: &Connection,
    from: MotorId,
    to: AssignableId,
    frames: SetIdFrames,
) -> Result<IdChangeOutcome, Failure> {
    connection
        .driver
        .command(Command::SetId { from, to, frames });
    loop {
        match connection.next()? {
            Happened::Entry(_, Entry::Event(Event::IdChangeEnded { outcome, .. })) => {
                return Ok(outcome);
            }
            Happened::Entry(_, Entry::Refused { refusal, .. }) => {
                return Err(Failure::NotDone(format!(
                    "the ID was not changed: {refusal}"
                )));
            }
            Happened::Entry(_, Entry::PortLost { .. }) => {
                let text = "the port is gone: scan to see which ID the motor has";
                return Err(Failure::NotDone(text.to_owned()));
            }
            Happened::Entry(..) | Happened::Nothing => {}
        }
    }
}

fn why_not(outcome: IdChangeOutcome, from: MotorId, to: AssignableId) -> String {
    let to = to.id();
    match outcome {
        IdChangeOutcome::Changed => String::new(),
        IdChangeOutcome::Kept { frames } => format!(
            "the motor kept ID {from} after {} frames. It takes one ID for each time it gets power: switch it off and on, then try again",
            frames.count()
        ),
        IdChangeOutcome::Lost => {
            format!("neither {from} nor {to} answers: switch the motor off and on, then scan")
        }
        IdChangeOutcome::Both => format!("{from} and {to} both answer: there are two motors"),
        IdChangeOutcome::NotAlone => "another motor is on the bus: connect one only".to_owned(),
        IdChangeOutcome::NotStopped => "a motor did not confirm its stop".to_owned(),
        IdChangeOutcome::Cancelled { frames_sent: 0 } => {
            "cancelled before the first frame".to_owned()
        }
        IdChangeOutcome::Cancelled { .. } => {
            "cancelled: scan to see which ID the motor has".to_owned()
        }
    }
}
