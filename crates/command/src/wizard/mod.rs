//! `motorlink wizard`: gives the motors of a rover their IDs, one after the other, and finds out which wheel each is.
//!
//! Each step opens the port again: the next motor may be of another model, and wires are plugged between the steps.

pub mod arguments;
mod check;
mod giving;
mod wheels;

use std::io::{IsTerminal, stdin};

use motorlink_driver::{Ender, Place, VirtualLine};
use motorlink_protocol::MotorId;

use crate::{
    arguments::Global,
    confirm,
    connection::{Connection, on_line},
    failure::Failure,
    output::say,
    words,
};
use arguments::Wizard;
use giving::Giving;

/// The answer that ends a step.
const DONE: &str = "done";

/// Guides a person through the steps.
pub fn run(global: &Global, how: &Wizard, ender: &Ender) -> Result<(), Failure> {
    let refusal = if !stdin().is_terminal() {
        "the wizard asks at each step and there is no terminal: use set-id in scripts"
    } else if !global.id.is_empty() {
        "the wizard finds the motors itself: leave out --id"
    } else {
        let line = Line { global, ender };
        let mut giving = Giving::new(line, how);
        return match giving.run().and_then(|()| finish(line, &giving.given)) {
            Err(Failure::Interrupted) => {
                giving.say_how_to_continue();
                Err(Failure::Interrupted)
            }
            done => done,
        };
    };
    Err(Failure::Usage(refusal.to_owned()))
}

/// Checks that all motors answer on one bus, and finds out which wheel each of them turns.
fn finish(line: Line<'_>, given: &[MotorId]) -> Result<(), Failure> {
    let found = check::all_on_one_bus(line, given)?;
    let missing: Vec<_> = given.iter().filter(|id| !found.contains(id)).collect();
    wheels::find_out(line, &found)?;
    if missing.is_empty() {
        return Ok(());
    }
    let missing = words::ids(missing.into_iter().copied());
    Err(Failure::NotDone(format!("{missing} did not answer")))
}

/// The line, and the person at the terminal.
#[derive(Clone, Copy)]
struct Line<'a> {
    global: &'a Global,
    ender: &'a Ender,
}

impl Line<'_> {
    /// Opens the line for one step. The motors are stopped at its end. Virtual motors with these IDs are plugged in, if
    /// there are any.
    fn open(
        self,
        plugged_in: &[MotorId],
        mut work: impl FnMut(&mut Connection) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        on_line(
            self.global,
            self.ender,
            |options| {
                // The ID query of the opening is for a motor alone: several would answer at once.
                options.watch.clear();
                if plugged_in.len() > 1 {
                    options.watch.extend(plugged_in);
                }
                if let Place::Virtual(line) = &mut options.place
                    && !plugged_in.is_empty()
                {
                    let model = self.global.model.unwrap_or_default();
                    *line = VirtualLine::of(model, plugged_in.iter().copied());
                }
            },
            |connection| {
                connection.motors.clear();
                work(connection)
            },
        )
    }

    /// Asks while no line is open. The end of the input is an interruption.
    fn ask(self, question: &str) -> Result<String, Failure> {
        confirm::ask(self.ender, question)?.ok_or(Failure::Interrupted)
    }
}

/// Says what a step has failed for, so that it can be tried again.
///
/// # Errors
/// Trying again does not help.
fn try_again<T: Default>(done: Result<T, Failure>) -> Result<T, Failure> {
    match done {
        Err(failure @ (Failure::NotDone(_) | Failure::OtherModel(_))) => {
            say(format_args!("motorlink: {failure}"));
            Ok(T::default())
        }
        done => done,
    }
}
