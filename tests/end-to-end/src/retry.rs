//! Retries: bounded, printed and counted.
//!
//! A scenario only retries what a slow machine may have prevented, never a failure of the page.

use std::env;
use std::fs::OpenOptions;
use std::io::Write;
use std::thread;

use anyhow::{Result, bail};

/// Repeats an attempt until one succeeds, at most `attempts_max` times. An attempt returns a value, or the reason why
/// it did not succeed.
///
/// Each further attempt adds a line to the file in `MOTORLINK_RETRIES`, which `cargo xtask test` counts: the output
/// of a passing test is not shown.
///
/// # Errors
///
/// When an attempt fails, or when none succeeds.
pub fn retry<T>(
    what: &str,
    attempts_max: u32,
    mut attempt: impl FnMut() -> Result<Result<T, String>>,
) -> Result<T> {
    let mut reason = String::new();
    for number in 1..=attempts_max {
        if number > 1 {
            note(what, &reason)?;
        }
        match attempt()? {
            Ok(value) => return Ok(value),
            Err(instead) => reason = instead,
        }
    }
    bail!("{what}: none of {attempts_max} attempts succeeded; the last: {reason}")
}

/// Records a retry.
fn note(what: &str, reason: &str) -> Result<()> {
    let thread = thread::current();
    let test = thread.name().unwrap_or_default();
    let reason = reason.lines().next().unwrap_or_default();
    let line = format!("{test}: {what}: {reason}\n");
    eprint!("again: {line}");
    if let Some(path) = env::var_os("MOTORLINK_RETRIES") {
        // A single write, because scenarios run in parallel.
        let mut file = OpenOptions::new().append(true).create(true).open(path)?;
        file.write_all(line.as_bytes())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attempts_end_with_the_first_that_succeeds() {
        let mut count = 0;
        let value = retry("a press", 3, || {
            count += 1;
            Ok((count == 2).then_some(count).ok_or_else(|| "no".to_owned()))
        });
        assert_eq!(value.unwrap(), 2);
    }

    #[test]
    fn attempts_are_bounded_and_the_last_reason_is_named() {
        let mut count = 0;
        let error = retry("a press", 3, || {
            count += 1;
            Ok(Err::<(), _>(format!("reason {count}")))
        })
        .unwrap_err();
        assert_eq!(count, 3);
        assert!(error.to_string().ends_with("reason 3"), "{error}");
    }

    #[test]
    fn an_error_ends_the_attempts() {
        let mut count = 0;
        let failed = retry("a press", 3, || -> Result<Result<(), String>> {
            count += 1;
            bail!("no browser")
        });
        assert_eq!(
            (count, failed.unwrap_err().to_string().as_str()),
            (1, "no browser")
        );
    }
}
