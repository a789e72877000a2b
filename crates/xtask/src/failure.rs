//! Failures of commands: one line on stderr and an exit code.

use std::process::ExitCode;

/// Exit code for a wrong command line, as the shell's own commands use it.
pub const BAD_INPUT_CODE: u8 = 2;

/// A wrong argument; the text says what to type instead.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct BadInput(pub String);

/// A program refused the flags that it was given, and has printed why.
#[derive(Debug, thiserror::Error)]
#[error("the program refused its flags")]
pub struct RefusedByChild;

/// A program that was started has failed, and has printed why.
#[derive(Debug, thiserror::Error)]
#[error("`{command}` {}", .code.map_or("was ended by a signal".into(), |code| format!("failed with exit code {code}")))]
pub struct ChildFailed {
    /// The command as a user would type it.
    pub command: String,
    /// Its exit code; none where a signal ended it.
    pub code: Option<i32>,
}

/// Prints the failure in one line and returns the exit code.
pub fn report(error: &anyhow::Error) -> ExitCode {
    // The program has printed the reason already.
    if !error.is::<RefusedByChild>() {
        eprintln!("error: {error:#}");
    }
    code(error)
}

fn code(error: &anyhow::Error) -> ExitCode {
    if error.is::<BadInput>() || error.is::<RefusedByChild>() {
        ExitCode::from(BAD_INPUT_CODE)
    } else {
        ExitCode::FAILURE
    }
}

/// Turns the exit code of a program for wrong flags into [`RefusedByChild`].
pub fn refusal_of_flags(error: anyhow::Error) -> anyhow::Error {
    match error.downcast_ref::<ChildFailed>() {
        Some(child) if child.code == Some(i32::from(BAD_INPUT_CODE)) => RefusedByChild.into(),
        _ => error,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn child(code: Option<i32>) -> anyhow::Error {
        ChildFailed {
            command: "figures --sideways".to_owned(),
            code,
        }
        .into()
    }

    #[test]
    fn bad_input_gives_two_and_all_else_one() {
        let bad = anyhow::Error::from(BadInput("no such directory".to_owned()));
        assert_eq!(code(&bad), ExitCode::from(2));
        assert_eq!(code(&bad.context("step build failed")), ExitCode::from(2));
        assert_eq!(code(&child(Some(2))), ExitCode::FAILURE);
        assert_eq!(code(&child(None)), ExitCode::FAILURE);
    }

    #[test]
    fn flags_that_a_program_refuses_are_bad_input() {
        let code_after = |status| code(&refusal_of_flags(child(status)));
        assert_eq!(code_after(Some(2)), ExitCode::from(2));
        assert_eq!(code_after(Some(101)), ExitCode::FAILURE);
    }
}
