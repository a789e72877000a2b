//! Asks before what moves a wheel or changes a motor.

use std::{
    io::{BufRead, IsTerminal, Write, stderr, stdin},
    sync::mpsc::{TryRecvError, channel},
    thread,
};

use crate::{connection::Connection, failure::Failure};

/// Asks on the terminal while the line goes on, so that it is up to date when the answer comes.
///
/// # Errors
/// As [`confirm`], or the program ends meanwhile.
pub fn confirm_on(connection: &Connection, question: String) -> Result<(), Failure> {
    let (answer, answered) = channel();
    thread::spawn(move || {
        // Without a receiver the program ends.
        let _ = answer.send(confirm(&question));
    });
    loop {
        connection.next()?;
        match answered.try_recv() {
            Ok(answer) => return answer,
            Err(TryRecvError::Empty) => {}
            Err(TryRecvError::Disconnected) => return Err(Failure::Interrupted),
        }
    }
}

/// Whether there is a terminal to ask on.
///
/// # Errors
/// There is none.
pub fn can_ask() -> Result<(), Failure> {
    if stdin().is_terminal() {
        return Ok(());
    }
    let text = "there is no terminal to ask on: use --yes";
    Err(Failure::Usage(text.to_owned()))
}

/// Asks on the terminal.
///
/// # Errors
/// The answer is not yes, or there is no terminal.
pub fn confirm(question: &str) -> Result<(), Failure> {
    can_ask()?;
    eprint!("{question} [y/N] ");
    let _ = stderr().flush();
    let mut answer = String::new();
    // An answer that cannot be read is none.
    let _ = stdin().lock().read_line(&mut answer);
    if matches!(answer.trim(), "y" | "Y" | "yes") {
        Ok(())
    } else {
        Err(Failure::NotDone("nothing was changed".to_owned()))
    }
}
