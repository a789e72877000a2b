//! Asks before what moves a wheel or changes a motor.

use std::io::{BufRead, IsTerminal, Write, stderr, stdin};

use crate::failure::Failure;

/// Asks on the terminal.
///
/// # Errors
/// The answer is not yes, or there is no terminal.
pub fn confirm(question: &str) -> Result<(), Failure> {
    if !stdin().is_terminal() {
        let text = "there is no terminal to ask on: use --yes";
        return Err(Failure::Usage(text.to_owned()));
    }
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
