//! Waiting for a condition, always with a timeout.

use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Result, bail};

/// Default timeout. Chromium starts in about a second and does the rest in milliseconds; a loaded machine can take
/// ten times as long.
pub const WAIT_MAX: Duration = Duration::from_secs(20);

/// Minimal time between two looks: short for a test, long for the machine.
const PAUSE: Duration = Duration::from_millis(20);
/// Maximal time between two looks. Some of them wait for something themselves.
const PAUSE_MAX: Duration = Duration::from_millis(200);

/// Calls `look` until it returns a value, at most for `wait_max`. Looking takes the time of the page that is to change, so
/// the pause between two looks is twice as long as the look, within bounds.
///
/// # Errors
///
/// When `look` fails, or at the timeout: the message contains `what` was awaited, and the last reason that `look`
/// returned.
pub fn wait_until<T>(
    what: &str,
    wait_max: Duration,
    mut look: impl FnMut() -> Result<Result<T, String>>,
) -> Result<T> {
    let deadline = Instant::now() + wait_max;
    loop {
        let looked = Instant::now();
        match look()? {
            Ok(value) => return Ok(value),
            Err(instead) if Instant::now() >= deadline => {
                bail!("waited {wait_max:?} for {what}; instead: {instead}")
            }
            Err(_) => {
                let pause = (2 * looked.elapsed()).clamp(PAUSE, PAUSE_MAX);
                thread::sleep(pause.min(deadline.saturating_duration_since(Instant::now())));
            }
        }
    }
}
