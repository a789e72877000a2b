//! What the stop at the end of a command has shown.

use motorlink_driver::Ending;

use crate::{failure::Failure, output::say, words};

/// The failure of a stop, if it has failed: then the other one is only printed.
pub fn most_serious(
    worked: Result<(), Failure>,
    stopped: Result<(), Failure>,
) -> Result<(), Failure> {
    match (worked, stopped) {
        (Err(worked), Err(stopped)) => {
            say(worked);
            Err(stopped)
        }
        (worked, stopped) => stopped.and(worked),
    }
}

/// Prints what a stop has shown.
///
/// # Errors
/// A standstill is not confirmed, or the driver has failed.
pub fn report(ending: &Ending) -> Result<(), Failure> {
    if let Some(stop) = &ending.last_stop
        && !stop.motors.is_empty()
    {
        say(words::of_stop(stop));
    }
    let failed = "motorlink itself has failed: please report it";
    if !ending.may_turn.is_empty() {
        let ids = words::ids(ending.may_turn.iter().copied());
        let failed = if ending.has_failed {
            format!(" ({failed})")
        } else {
            String::new()
        };
        return Err(Failure::NotDone(format!(
            "motors {ids} may turn: cut their power{failed}"
        )));
    }
    if ending.has_failed {
        return Err(Failure::NotDone(failed.to_owned()));
    }
    Ok(())
}
