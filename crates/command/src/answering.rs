//! Which motors of a line answer.

use std::time::{Duration, Instant};

use motorlink_bus::{Command, Event, IdQueryOutcome};
use motorlink_driver::{Entry, Status};
use motorlink_protocol::MotorId;

use crate::{
    connection::{Connection, Happened, WIRING},
    failure::Failure,
    signed_id::SignedId,
    words,
};

/// Time for three ID queries.
const ID_QUERY_MIN: Duration = Duration::from_millis(300);
/// How long one may take: it waits for a stop of motors that were left driven.
const ID_QUERY_MAX: Duration = Duration::from_secs(4);

impl Connection {
    /// Waits until the motors have answered. Without `--id`, the motor is the only one that answers the ID query.
    ///
    /// # Errors
    /// One does not answer in time, or none or several answer.
    pub fn wait_for_motors(&mut self) -> Result<(), Failure> {
        if self.motors.is_empty() {
            let id = self.only_motor()?;
            self.driver.command(Command::Watch(id));
            self.motors.push(SignedId::straight(id));
        }
        let asked: Vec<MotorId> = self.motors.iter().map(|motor| motor.id).collect();
        let silent = |status: &Status| -> Vec<MotorId> {
            let answers =
                |id: &MotorId| status.motor(*id).is_some_and(|motor| motor.last.is_some());
            asked.iter().filter(|id| !answers(id)).copied().collect()
        };
        let ready = |status: &Status| {
            let is_known = status.line.is_some_and(|line| line.model_known);
            (is_known && silent(status).is_empty()).then_some(())
        };
        if self.wait_for(self.timeout, ready)?.is_none() {
            let status = self.status()?;
            let missing = words::ids(silent(&status));
            let others = status.motors.iter().filter(|motor| motor.last.is_some());
            let others = others
                .map(|motor| motor.id)
                .filter(|id| !asked.contains(id));
            let others: Vec<MotorId> = others.collect();
            return Err(Failure::NotDone(if others.is_empty() {
                format!("no reply from {missing}. {WIRING}, or find its ID: motorlink scan")
            } else {
                format!(
                    "no reply from {missing}, but from {}: name that one",
                    words::ids(others)
                )
            }));
        }
        // What was said before is not about what is asked for next.
        while let Happened::Entry(..) = self.next_within(Duration::ZERO)? {}
        Ok(())
    }

    /// The only motor that answers the ID query: that of the opened port, or one that is asked now.
    fn only_motor(&self) -> Result<MotorId, Failure> {
        let mut outcome = None;
        while let Happened::Entry(_, entry) = self.next_within(Duration::ZERO)? {
            outcome = id_query_ended(&entry).or(outcome);
        }
        let until = Instant::now() + self.timeout.max(ID_QUERY_MIN);
        loop {
            match outcome {
                Some(IdQueryOutcome::One(id)) => return Ok(id),
                Some(IdQueryOutcome::Garbled) => {
                    let text =
                        "several motors answer, or there is noise: name one, or see motorlink scan";
                    return Err(Failure::NotDone(text.to_owned()));
                }
                // A stop of motors that an earlier program left running cancels it, and one without power may get it.
                Some(IdQueryOutcome::NoReply | IdQueryOutcome::Cancelled) | None => {}
            }
            if Instant::now() >= until {
                let text = format!("no motor answers. {WIRING}, or see motorlink scan");
                return Err(Failure::NotDone(text));
            }
            self.driver.command(Command::IdQuery);
            // It is waited for to its end: the bus refuses what comes meanwhile.
            outcome = None;
            let limit = Instant::now() + ID_QUERY_MAX;
            while outcome.is_none() && Instant::now() < limit {
                if let Happened::Entry(_, entry) = self.next()? {
                    outcome = id_query_ended(&entry);
                }
            }
        }
    }
}

fn id_query_ended(entry: &Entry) -> Option<IdQueryOutcome> {
    match entry {
        Entry::Event(Event::IdQueryEnded(outcome)) => Some(*outcome),
        _ => None,
    }
}
