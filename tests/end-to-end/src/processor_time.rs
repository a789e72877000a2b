//! Measures the processor time of the browser's threads.

use std::{fs, time::Duration};

use anyhow::{Context, Result};
use serde_json::json;

use crate::{cdp::at, page::Page};

/// Ticks of `/proc` per second (`sysconf(_SC_CLK_TCK)`), on every Linux that Chromium supports.
const TICKS_A_SECOND: u64 = 100;

impl Page {
    /// Time of scripts, style computation and layout on the main thread since the page was loaded.
    ///
    /// # Errors
    ///
    /// When Chromium does not answer.
    pub fn script_and_layout(&self) -> Result<Duration> {
        let told = self.session.call("Performance.getMetrics", json!({}))?;
        let metrics = at(&told, "/metrics").as_array().context("no metrics")?;
        let seconds = |name: &str| {
            let metric = metrics
                .iter()
                .find(|metric| metric.get("name").is_some_and(|of| of == name));
            let value = metric.and_then(|metric| metric.get("value")?.as_f64());
            value.with_context(|| format!("no metric {name}"))
        };
        let sum = seconds("ScriptDuration")?
            + seconds("LayoutDuration")?
            + seconds("RecalcStyleDuration")?;
        Duration::try_from_secs_f64(sum).context("a time that is none")
    }
}

/// User and system time of all threads of this machine whose names start with `name`.
///
/// # Errors
///
/// When `/proc` cannot be read.
pub fn threads_time(name: &str) -> Result<Duration> {
    let mut ticks = 0;
    for process in fs::read_dir("/proc")?.flatten() {
        // Processes and threads may end meanwhile.
        let Ok(threads) = fs::read_dir(process.path().join("task")) else {
            continue;
        };
        for thread in threads.flatten() {
            let Ok(stat) = fs::read_to_string(thread.path().join("stat")) else {
                continue;
            };
            ticks += ticks_of(&stat, name).unwrap_or(0);
        }
    }
    Ok(Duration::from_millis(1_000 * ticks / TICKS_A_SECOND))
}

/// User and system time of a thread with this name: fields 14 and 15 of its `stat`.
fn ticks_of(stat: &str, name: &str) -> Option<u64> {
    let (head, rest) = stat.rsplit_once(") ")?;
    let (_, own) = head.split_once('(')?;
    if !own.starts_with(name) {
        return None;
    }
    let mut fields = rest.split(' ').skip(11);
    let (user, system): (u64, u64) = (fields.next()?.parse().ok()?, fields.next()?.parse().ok()?);
    Some(user + system)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_times_of_a_thread_are_found_whatever_its_name() {
        let stat = "12 (Dedicated) wor) S 1 2 3 4 5 6 7 8 9 10 40 2 0 0 20 0";
        assert_eq!(ticks_of(stat, "Dedicated"), Some(42));
        assert_eq!(ticks_of(stat, "Viz"), None);
    }
}
