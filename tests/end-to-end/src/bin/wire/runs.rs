//! Measures when the setpoints of an experiment are on the wire.

use std::{thread, time::Duration};

use anyhow::{Context, Result, ensure};
use end_to_end::{
    Bench, Line, WireLog,
    figures::{ms, percentile, row},
};

use crate::driving::{SETTLES, connected};

const PERIOD_US: u64 = 5_000;
const HERTZ: usize = 200;
/// The sequence that the panel begins with takes 80 s.
const WATCHED_MAX: Duration = Duration::from_secs(60);

pub fn measure(watched: Duration) -> Result<()> {
    let watched = watched.min(WATCHED_MAX);
    let bench = Bench::start()?;
    let (adapter, page) = connected(&bench, Line::default())?;
    page.click("button", "Experiments")?;
    thread::sleep(SETTLES);
    page.click("button", "Arm")?;
    page.click("button", "Run")?;
    thread::sleep(watched + Duration::from_secs(1));
    page.click("button", "Abort")?;
    page.wait_for_text("status", "Result of the run", |text| !text.is_empty())?;
    rows(&adapter.wire()?, watched)?;
    crate::ensure_quiet(&page)
}

fn rows(wire: &WireLog, watched: Duration) -> Result<()> {
    let drives = wire.drives();
    let times: Vec<u64> = drives.frames.iter().map(|frame| frame.at_us).collect();
    let first = *times.first().context("no setpoint")?;
    let until = first + u64::try_from(watched.as_micros())?;
    let times: Vec<u64> = times.into_iter().filter(|at| *at < until).collect();
    let late = lateness(&times)?;
    let planned = usize::try_from(watched.as_secs())? * HERTZ;
    ensure!(late.len() > planned / 2, "{} setpoints", late.len());
    let mut sorted = late.clone();
    sorted.sort_unstable();
    let p99 = percentile(&sorted, 99).context("no setpoint")?;
    let seconds = watched.as_secs();
    row(
        &format!(
            "setpoint times on the wire against the plan, 200 Hz, {seconds} s, page visible, p99"
        ),
        "at most 2 ms",
        format!(
            "{}, {} of {planned} setpoints sent at their time",
            ms(p99),
            late.len()
        ),
        p99 <= 2_000,
    );
    let part = late.len().min(10 * HERTZ);
    let middle = |part: &[u64]| {
        let mut sorted = part.to_vec();
        sorted.sort_unstable();
        percentile(&sorted, 50)
    };
    let begins = middle(late.get(..part).context("too few")?).context("too few")?;
    let ends = middle(late.get(late.len() - part..).context("too few")?).context("too few")?;
    let drift = ends.abs_diff(begins);
    row(
        "the same: median lateness of the last ten seconds less that of the first",
        "no drift: at most 0.5 ms",
        ms(drift),
        drift <= 500,
    );
    Ok(())
}

/// The lateness of each setpoint of the plan that was sent, in order. The plan is an even grid over the whole time: it
/// begins so that no frame is early. If two frames are nearest to one time, the second one is late for it by its
/// distance.
fn lateness(times: &[u64]) -> Result<Vec<u64>> {
    let first = *times.first().context("no setpoint")?;
    // The first frame may be late itself; the others tell by how much.
    let phase = |at: u64| {
        let offset = (at - first) % PERIOD_US;
        // More than half a period behind one time is early for the next one.
        if offset > PERIOD_US / 2 {
            i64::try_from(offset).unwrap_or(0) - i64::try_from(PERIOD_US).unwrap_or(0)
        } else {
            i64::try_from(offset).unwrap_or(0)
        }
    };
    let earliest = times.iter().map(|at| phase(*at)).min().unwrap_or(0);
    Ok(times
        .iter()
        .map(|at| phase(*at).abs_diff(earliest))
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_late_setpoint_and_a_drift_are_seen() {
        let mut times: Vec<u64> = (0..400).map(|n| 1_000_000 + n * PERIOD_US).collect();
        assert!(lateness(&times).unwrap().iter().all(|late| *late == 0));
        times[0] += 300;
        times[100] += 700;
        let late = lateness(&times).unwrap();
        assert_eq!((late[0], late[100], late[101]), (300, 700, 0));
        let slow: Vec<u64> = (0..400).map(|n| 1_000_000 + n * 5_003).collect();
        assert!(lateness(&slow).unwrap()[399] > 1_000);
    }
}
