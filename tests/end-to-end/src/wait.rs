//! Waiting for a condition, always for a bounded time.

use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Result, bail};

/// Longest time for anything on the bench that the test itself does not time. Chromium starts in about
/// a second and does the rest in milliseconds; a loaded machine may need ten times as long.
pub const WAIT_MAX: Duration = Duration::from_secs(20);

/// Between two looks: short for a test, long for the machine.
const PAUSE: Duration = Duration::from_millis(20);

/// Looks until `look` gives a value, at most for `wait_max`.
///
/// # Errors
///
/// When `look` fails, or when time is up: the message then says `what` was awaited, and what
/// `look` said instead the last time.
pub fn wait_until<T>(
    what: &str,
    wait_max: Duration,
    mut look: impl FnMut() -> Result<Result<T, String>>,
) -> Result<T> {
    let deadline = Instant::now() + wait_max;
    loop {
        match look()? {
            Ok(value) => return Ok(value),
            Err(instead) if Instant::now() >= deadline => {
                bail!("waited {wait_max:?} for {what}; instead: {instead}")
            }
            Err(_) => thread::sleep(PAUSE),
        }
    }
}
