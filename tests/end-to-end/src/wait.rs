//! Waiting, always bounded.

use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Result, bail};

/// How long anything on the bench may take that is not timed by the test itself. Chromium starts
/// in about a second and does the rest in milliseconds; a loaded machine may need ten times that.
pub const PATIENCE: Duration = Duration::from_secs(20);

/// Between two looks: well under what a test would notice, well over what a look costs.
const PAUSE: Duration = Duration::from_millis(20);

/// Looks until `look` gives a value, at most for `patience`.
///
/// # Errors
///
/// When `look` fails, or when time is up: the message then says `what` was awaited, and what
/// `look` said instead the last time.
pub fn wait_until<T>(
    what: &str,
    patience: Duration,
    mut look: impl FnMut() -> Result<Result<T, String>>,
) -> Result<T> {
    let deadline = Instant::now() + patience;
    loop {
        match look()? {
            Ok(value) => return Ok(value),
            Err(instead) if Instant::now() >= deadline => {
                bail!("waited {patience:?} for {what}; instead: {instead}")
            }
            Err(_) => thread::sleep(PAUSE),
        }
    }
}
