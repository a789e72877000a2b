//! Measures the load of 500 exchanges a second on the page and its worker.
//!
//! No adapter is fast enough, so the built-in bus is used. Its motor is simulated in the worker, which makes the
//! worker's share larger than with a real motor.

use std::{thread, time::Duration};

use anyhow::{Context, Result};
use end_to_end::{
    Bench, Page, View,
    figures::{ratio, row},
    threads_time,
};

use crate::driving::spin;

/// Time before the measurement.
const WARM: Duration = Duration::from_secs(20);
/// Factor by which the heap is observed longer.
const HEAP_TIMES: u32 = 10;
const HEAP_GROWS_BYTES_MAX: u64 = 5_000_000;

pub fn measure(watched: Duration) -> Result<()> {
    let bench = Bench::start()?;
    let page = spinning(&bench)?;
    thread::sleep(WARM);
    page.work()?;
    let (main_before, workers_before) =
        (page.script_and_layout()?, threads_time("DedicatedWorker")?);
    page.evaluate(COUNT_FRAMES)?;
    thread::sleep(watched);
    let frames = page.evaluate(FRAMES)?;
    let (main_after, workers_after) = (page.script_and_layout()?, threads_time("DedicatedWorker")?);
    let work = page.work()?;

    let seconds = watched.as_secs();
    let of_page = |what: &str| format!("page at 500 exchanges a second, {seconds} s: {what}");
    row(
        &of_page("main-thread tasks over 50 ms"),
        "none",
        format!(
            "{}, longest {} ms",
            work.long_tasks.len(),
            work.longest_task().as_millis()
        ),
        work.long_tasks.is_empty(),
    );
    let main = per_cent(main_after.saturating_sub(main_before), watched);
    row(
        &of_page("script and layout"),
        "at most 25 % of a core",
        format!("{main:.1} %"),
        main <= 25.0,
    );
    let frames = frames.as_u64().context("no frames were counted")?;
    let fps = ratio(frames, seconds.max(1));
    row(
        &of_page("frames"),
        "60 a second where the machine can draw them",
        format!("{fps:.1} a second"),
        fps >= 59.0,
    );
    let workers = per_cent(workers_after.saturating_sub(workers_before), watched);
    row(
        &of_page("both workers, with the simulated motor"),
        "at most 25 % of a core",
        format!("{workers:.1} %"),
        workers <= 25.0,
    );
    crate::ensure_quiet(&page)
}

/// Compares the memory of page and workers after the time and after ten times as long.
pub fn measure_heap(watched: Duration) -> Result<()> {
    let bench = Bench::start()?;
    let page = spinning(&bench)?;
    thread::sleep(watched);
    let before = heap(&page)?;
    thread::sleep(watched * (HEAP_TIMES - 1));
    let after = heap(&page)?;
    let grown = after.saturating_sub(before);
    row(
        &format!(
            "heap of page and workers at 500 exchanges a second, after {} s against after {} s",
            (watched * HEAP_TIMES).as_secs(),
            watched.as_secs()
        ),
        "at most 5 MB more",
        format!(
            "{:.2} MB, then {:.2} MB",
            ratio(before, 1_000_000),
            ratio(after, 1_000_000)
        ),
        grown <= HEAP_GROWS_BYTES_MAX,
    );
    crate::ensure_quiet(&page)
}

fn spinning(bench: &Bench) -> Result<Page> {
    let page = bench.open("/?port=virtual")?;
    page.look(View::DESKTOP)?;
    page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    spin(&page, 500)?;
    Ok(page)
}

fn per_cent(time: Duration, of: Duration) -> f64 {
    100.0 * time.as_secs_f64() / of.as_secs_f64()
}

/// Counts frames from now on. The count is read separately, because a minute is longer than the timeout of a call.
const COUNT_FRAMES: &str = "(() => {
    globalThis.framesOfBench = 0;
    const count = () => {
        globalThis.framesOfBench += 1;
        requestAnimationFrame(count);
    };
    requestAnimationFrame(count);
})()";
const FRAMES: &str = "globalThis.framesOfBench";

/// Bytes that page and workers hold.
fn heap(page: &Page) -> Result<u64> {
    let mut bytes = 0;
    for memory in [
        page.memory()?,
        page.memory_of_worker("worker")?,
        page.memory_of_worker("recorder")?,
    ] {
        bytes += memory.script + memory.wasm;
    }
    Ok(bytes)
}
