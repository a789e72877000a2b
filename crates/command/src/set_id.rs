//! `motorlink set-id`: gives the only motor on the bus another ID.

use motorlink_bus::{Command, Event, IdChangeOutcome, SetIdFrames};
use motorlink_driver::{Ender, Entry};
use motorlink_protocol::{AssignableId, MotorId};

use crate::{
    arguments::Global,
    confirm::confirm_on,
    connection::{Connection, Happened, WIRING, is_not_done, on_line},
    failure::Failure,
    output::{print, say},
    scan::scan,
    words,
};

/// Proves that the motor is alone, asks, changes its ID, and verifies it.
pub fn run(global: &Global, new: AssignableId, yes: bool, ender: &Ender) -> Result<(), Failure> {
    on_line(
        global,
        ender,
        |_| (),
        |connection| {
            let from = only_motor(connection)?;
            let to = new.id();
            if from == to {
                say(format_args!("The motor has ID {from} already."));
                return Ok(());
            }
            say(format_args!(
                "The only motor on the bus has ID {from}. It keeps the new ID {to} without power."
            ));
            if !yes {
                confirm_on(connection, "Change it?")?;
                prove_again(connection, from)?;
            }
            change(connection, from, new)?;
            print(format_args!("Motor {from} has ID {to} now, verified."))
        },
    )
}

/// Proves after a question that this motor is still the only one.
///
/// A person may have plugged in another motor meanwhile, and the proof has a minute.
///
/// # Errors
/// It is not.
pub fn prove_again(connection: &Connection, only: MotorId) -> Result<(), Failure> {
    if only_motor(connection)? == only {
        return Ok(());
    }
    let text = "another motor is on the bus now";
    Err(Failure::NotDone(text.to_owned()))
}

/// Changes the ID of the only motor on the bus, and verifies it.
///
/// # Errors
/// It has not taken the ID, or that is not known.
pub fn change(connection: &Connection, from: MotorId, new: AssignableId) -> Result<(), Failure> {
    let mut frames = SetIdFrames::default();
    loop {
        let outcome = set_id(connection, from, new, frames)?;
        match (outcome, frames.more()) {
            (IdChangeOutcome::Changed, _) => return Ok(()),
            // Some units want more frames in a row.
            (IdChangeOutcome::Kept { .. }, Some(more)) => {
                let (sent, next) = (frames.count(), more.count());
                connection.note(format!(
                    "It kept its ID after {sent} frames; trying {next}."
                ));
                frames = more;
                only_motor(connection)?;
            }
            (outcome, _) => return Err(Failure::NotDone(why_not(outcome, from, new))),
        }
    }
}

/// The only motor on the bus, by a full scan.
///
/// # Errors
/// None answers, several answer, or noise leaves it open.
pub fn only_motor(connection: &Connection) -> Result<MotorId, Failure> {
    let report = scan(connection)?;
    match report.found.as_slice() {
        [only] if report.noisy.is_empty() && report.fault.is_none() => Ok(*only),
        [] => Err(Failure::NotDone(format!("no motor answers. {WIRING}"))),
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
            Happened::Entry(_, entry) if is_not_done(&entry) => {
                return Err(Failure::NotDone("the ID was not changed".to_owned()));
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
        IdChangeOutcome::NotAlone => format!(
            "{from} did not answer alone, so nothing was sent: another motor is on the bus, or replies are lost"
        ),
        IdChangeOutcome::NotStopped => "a motor did not confirm its stop".to_owned(),
        IdChangeOutcome::Cancelled { frames_sent: 0 } => {
            "cancelled before the first frame".to_owned()
        }
        IdChangeOutcome::Cancelled { .. } => {
            "cancelled: scan to see which ID the motor has".to_owned()
        }
    }
}
