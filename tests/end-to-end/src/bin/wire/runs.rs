//! Measures when the setpoints of an experiment are on the wire.

use std::{thread, time::Duration};

use anyhow::{Context, Result, bail, ensure};
use end_to_end::{
    Bench, Line, Page, WireLog,
    figures::{ms, percentile, row},
    now_us,
};

use crate::driving::{SETTLES, connected};

const PERIOD_US: u64 = 5_000;
const HERTZ: usize = 200;
/// The sequence that the panel begins with takes 80 s.
const WATCHED_MAX: Duration = Duration::from_secs(60);
/// Where nothing delays it, a setpoint follows its time within this.
const ON_TIME_US: u64 = 1_000;

pub fn measure(watched: Duration) -> Result<()> {
    let watched = watched.min(WATCHED_MAX);
    let bench = Bench::start()?;
    let (adapter, page) = connected(&bench, Line::default())?;
    page.open_panel("Experiments")?;
    thread::sleep(SETTLES);

    let pressed = run(&page)?;
    thread::sleep(watched + Duration::from_secs(1));
    let state = page.find("status", "Run")?.text()?;
    ensure!(state.contains("Running"), "the run ended early: {state}");
    rows("visible", &adapter.wire()?.since(pressed), watched)?;
    page.click("button", "Abort")?;
    page.wait_for_text("status", "Result of the run", |text| !text.is_empty())?;
    thread::sleep(Duration::from_secs(2));

    let pressed = run(&page)?;
    bench.hide(&page)?;
    thread::sleep(watched + Duration::from_secs(1));
    rows("hidden", &adapter.wire()?.since(pressed), watched)?;
    crate::ensure_quiet(&page)
}

/// Starts the sequence of the panel. Returns when Run was pressed.
pub fn run(page: &Page) -> Result<u64> {
    page.click("button", "Arm")?;
    page.wait_for_text("status", "Run", |text| text.contains("Armed"))?;
    let pressed = now_us();
    page.click("button", "Run")?;
    let running = page.wait_for_text("status", "Run", |text| text.contains("Running"));
    if let Err(error) = running {
        let said = page.find("status", "Result of the run")?.text()?;
        bail!("{error:#}; the page says: {said}");
    }
    Ok(pressed)
}

fn rows(page_is: &str, wire: &WireLog, watched: Duration) -> Result<()> {
    let drives = wire.drives();
    let times: Vec<u64> = drives.frames.iter().map(|frame| frame.at_us).collect();
    let planned = usize::try_from(watched.as_secs())? * HERTZ;
    let mut late = lateness(&times)?;
    ensure!(late.len() >= planned, "only {} setpoints", late.len());
    late.truncate(planned);
    let median = |part: &[u64]| {
        let mut sorted = part.to_vec();
        sorted.sort_unstable();
        percentile(&sorted, 50).context("too few setpoints")
    };
    let part = planned.min(10 * HERTZ);
    let part_of = |range| late.get(range).context("too few setpoints");
    let begins = median(part_of(0..part)?)?;
    let ends = median(part_of(planned - part..planned)?)?;

    late.sort_unstable();
    let at = |percent| percentile(&late, percent).context("no setpoint");
    let (p50, p99) = (at(50)?, at(99)?);
    let seconds = watched.as_secs();
    row(
        &format!(
            "setpoint times of a run against its plan, 200 Hz, {seconds} s, p99, page {page_is}"
        ),
        "at most 2 ms",
        format!("{}, median {}", ms(p99), ms(p50)),
        p99 <= 2_000,
    );
    let drift = ends.abs_diff(begins);
    row(
        &format!("the same, page {page_is}: median of the last ten seconds less that of the first"),
        "no drift: at most 0.5 ms",
        ms(drift),
        drift <= 500,
    );
    Ok(())
}

/// How late each setpoint of the plan is: the time to the first frame from then on. A frame between, which repeats a
/// setpoint, is none of the plan.
///
/// The plan is an even grid over the whole time, so that a drift is lateness. Its origin is not on the wire: the grid
/// lies where the most frames follow one of its times within [`ON_TIME_US`].
fn lateness(times: &[u64]) -> Result<Vec<u64>> {
    let first = *times.first().context("no setpoint")?;
    let last = *times.last().context("no setpoint")?;
    let phases: Vec<u64> = times.iter().map(|at| (at - first) % PERIOD_US).collect();
    let on_time = |origin: u64| {
        let follows = |phase: &&u64| (*phase + PERIOD_US - origin) % PERIOD_US <= ON_TIME_US;
        phases.iter().filter(follows).count()
    };
    let origins = (0..PERIOD_US).step_by(20);
    let origin = origins.max_by_key(|origin| on_time(*origin)).unwrap_or(0);
    // The first frame may be on time, or late for the time before.
    let begins = first + origin - if origin > 0 { PERIOD_US } else { 0 };
    let mut frames = times.iter().peekable();
    let planned = (begins..=last).step_by(usize::try_from(PERIOD_US)?);
    Ok(planned
        .filter_map(|planned| {
            while frames.next_if(|at| **at < planned).is_some() {}
            frames.peek().map(|at| **at - planned)
        })
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn even() -> Vec<u64> {
        (0..400).map(|n| 1_000_000 + n * PERIOD_US).collect()
    }

    #[test]
    fn a_late_setpoint_and_a_drift_are_seen() {
        let mut times = even();
        let base = lateness(&times).unwrap();
        assert_eq!(base.len(), 400);
        assert!(
            base.iter()
                .all(|late| *late == base[0] && *late <= ON_TIME_US)
        );
        times[100] += 700;
        let late = lateness(&times).unwrap();
        assert_eq!(late[100] - late[101], 700);
        let slow: Vec<u64> = (0..400).map(|n| 1_000_000 + n * 5_003).collect();
        let late = lateness(&slow).unwrap();
        assert!(late.iter().max().unwrap() - late.iter().min().unwrap() > 1_000);
    }

    #[test]
    fn a_repeated_setpoint_between_two_times_is_not_early() {
        let mut times = even();
        times.insert(101, times[100] + 2_600);
        let late = lateness(&times).unwrap();
        assert!(late.iter().all(|it| *it == late[0]), "{late:?}");
    }
}
