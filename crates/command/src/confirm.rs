//! Asks before what moves a wheel or changes a motor.

use std::{
    io::{BufRead, IsTerminal, Write, stderr, stdin},
    sync::mpsc::{TryRecvError, channel},
    thread::{self, sleep},
    time::Duration,
};

use motorlink_driver::Ender;

use crate::{connection::Connection, failure::Failure, output::say};

/// How often it looks for the answer, and for the end of the program.
const LOOK: Duration = Duration::from_millis(20);

/// Asks for agreement while the line goes on, so that it is up to date when the answer comes.
///
/// # Errors
/// As [`confirm`].
pub fn confirm_on(connection: &Connection, question: &str) -> Result<(), Failure> {
    can_ask()?;
    agreed(ask_on(connection, &yes_or_no(question))?)
}

/// Asks for agreement where no line is open.
///
/// # Errors
/// The answer is not yes, there is no terminal, or the program ends meanwhile.
pub fn confirm(ender: &Ender, question: &str) -> Result<(), Failure> {
    can_ask()?;
    agreed(ask(ender, &yes_or_no(question))?)
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

/// Asks on the terminal while the line goes on. Returns the answer, or `None` at the end of the input.
///
/// # Errors
/// The program ends meanwhile.
pub fn ask_on(connection: &Connection, question: &str) -> Result<Option<String>, Failure> {
    wait_for_answer(question, || connection.next().map(|_| ()))
}

/// The same where no line is open.
///
/// # Errors
/// The program ends meanwhile.
pub fn ask(ender: &Ender, question: &str) -> Result<Option<String>, Failure> {
    wait_for_answer(question, || {
        sleep(LOOK);
        if ender.is_asked() {
            return Err(Failure::Interrupted);
        }
        Ok(())
    })
}

fn wait_for_answer(
    question: &str,
    mut wait: impl FnMut() -> Result<(), Failure>,
) -> Result<Option<String>, Failure> {
    // A terminal that is gone ends the program by a signal.
    let _ = write!(stderr(), "{question}");
    let (answer, answered) = channel();
    thread::spawn(move || {
        let mut line = String::new();
        // An answer that cannot be read is none.
        let read = stdin().lock().read_line(&mut line).unwrap_or_default();
        // Without a receiver the program ends.
        let _ = answer.send((read > 0).then(|| line.trim().to_owned()));
    });
    let answer = loop {
        if let Err(failure) = wait() {
            break Err(failure);
        }
        match answered.try_recv() {
            Ok(answer) => break Ok(answer),
            Err(TryRecvError::Empty) => {}
            Err(TryRecvError::Disconnected) => break Err(Failure::Interrupted),
        }
    };
    if !matches!(answer, Ok(Some(_))) {
        // Nobody has ended the line of the question.
        say("");
    }
    answer
}

fn yes_or_no(question: &str) -> String {
    format!("{question} [y/N] ")
}

/// Whether an answer is a yes.
pub fn is_yes(answer: &str) -> bool {
    matches!(answer, "y" | "Y" | "yes")
}

fn agreed(answer: Option<String>) -> Result<(), Failure> {
    if answer.is_some_and(|answer| is_yes(&answer)) {
        Ok(())
    } else {
        Err(Failure::NotDone("nothing was changed".to_owned()))
    }
}
