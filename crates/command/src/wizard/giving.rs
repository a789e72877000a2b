//! The first step: each motor alone gets its ID.

use motorlink_bus::GroupSetpoints;
use motorlink_protocol::{AssignableId, MotorId};

use crate::{
    confirm::ask_on,
    connection::Connection,
    failure::Failure,
    output::say,
    parsers::assignable,
    set_id::{change, only_motor, prove_again},
    words,
};

use super::{DONE, Line, arguments::Wizard, try_again};

/// The motors that have their ID so far.
pub struct Giving<'a> {
    line: Line<'a>,
    first: AssignableId,
    count: Option<u8>,
    pub given: Vec<MotorId>,
}

impl<'a> Giving<'a> {
    pub fn new(line: Line<'a>, how: &Wizard) -> Self {
        Self {
            line,
            first: how.first,
            count: how.count.or(line.global.virtual_motors),
            given: Vec::new(),
        }
    }

    /// Asks for one motor after the other.
    pub fn run(&mut self) -> Result<(), Failure> {
        let count = self.count.map_or(GroupSetpoints::MAX, usize::from);
        while self.given.len() < count {
            let number = self.given.len() + 1;
            let of = self
                .count
                .map_or_else(String::new, |of| format!(" of {of}"));
            let Some(next) = self.next_free() else {
                say("No ID is free any more.");
                return Ok(());
            };
            let answer = self.line.ask(&format!(
                "\nMotor {number}{of}: switch the power off, connect this motor alone, and switch the power on.\n\
                 Press Enter then, or type {DONE} if no motor is left: "
            ))?;
            if answer == DONE {
                break;
            }
            if let Some(id) = try_again(self.give(next))? {
                say(format_args!(
                    "Motor {number} has ID {id}, verified. Label it."
                ));
                self.given.push(id);
            }
        }
        Ok(())
    }

    /// Gives the only motor on the bus this ID, or another one that the person wants. Returns its ID; `None` if the person
    /// leaves the motor as it is.
    fn give(&self, next: AssignableId) -> Result<Option<MotorId>, Failure> {
        let mut given = None;
        // A new motor has the first ID.
        self.line.open(&[MotorId::FIRST], |connection| {
            let from = only_motor(connection)?;
            let Some(new) = self.choose(connection, from, next)? else {
                return Ok(());
            };
            prove_again(connection, from)?;
            if new.id() != from {
                change(connection, from, new)?;
            }
            given = Some(new.id());
            Ok(())
        })?;
        Ok(given)
    }

    /// Asks which ID the motor gets. `None` leaves it as it is.
    fn choose(
        &self,
        connection: &Connection,
        from: MotorId,
        next: AssignableId,
    ) -> Result<Option<AssignableId>, Failure> {
        let same = match self.number_of(from) {
            Some(number) => {
                format!(" Motor {number} has it too: answer n if this is motor {number}.")
            }
            None => String::new(),
        };
        say(format_args!(
            "The only motor on the bus has ID {from}.{same}"
        ));
        let question = format!("New ID (Enter: {}, n: leave it as it is): ", next.id());
        loop {
            let answer = ask_on(connection, &question)?.ok_or(Failure::Interrupted)?;
            let new = match answer.as_str() {
                "" => return Ok(Some(next)),
                "n" | "no" => return Ok(None),
                answer => assignable(answer),
            };
            match new.map(|new| (new, self.number_of(new.id()))) {
                Ok((new, None)) => return Ok(Some(new)),
                Ok((new, Some(number))) => {
                    say(format_args!("Motor {number} has ID {} already.", new.id()));
                }
                Err(why) => say(why),
            }
        }
    }

    /// Which motor got this ID, from 1.
    fn number_of(&self, id: MotorId) -> Option<usize> {
        let place = self.given.iter().position(|given| *given == id)?;
        Some(place + 1)
    }

    /// The next ID that no motor got.
    fn next_free(&self) -> Option<AssignableId> {
        let ids = (self.first.id().get()..=u8::MAX).flat_map(MotorId::new);
        let mut free = ids.filter(|id| !self.given.contains(id));
        free.find_map(|id| AssignableId::new(id).ok())
    }

    /// What was reached before an interruption.
    pub fn say_how_to_continue(&self) {
        if self.given.is_empty() {
            return;
        }
        let ids = words::ids(self.given.iter().copied());
        let next = self.next_free().map_or(1, |id| id.id().get());
        let left = self.count.map_or_else(String::new, |count| {
            format!(
                " --count {}",
                usize::from(count).saturating_sub(self.given.len())
            )
        });
        say(format_args!(
            "These motors have their ID: {ids}. To continue: motorlink wizard --first {next}{left}"
        ));
    }
}
