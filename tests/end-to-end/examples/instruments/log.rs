//! Measures a full packet log at 1,000 frames a second: lost frames, stalls, growth, and its export.

use std::{
    fmt, thread,
    time::{Duration, Instant},
};

use anyhow::{Context, Result, ensure};
use end_to_end::{
    Bench, Download, Memory, Page, View, WAIT_MAX,
    figures::{ratio, row},
    wait_until,
};

use crate::{
    tap::{Taker, TappedPage},
    traffic::{at_once, in_time, newest_without_gap},
};

/// Maximal entries of a log.
const KEPT: u32 = 1_000_000;
/// Frames before the measurement: more than fit, so that the log drops old ones already.
const FILLED: u32 = 1_010_000;
/// Frames per buffer while the log is filled.
const FILL_BUFFER: u32 = 2_000;
/// Time between two frames.
const SPACING_US: u64 = 1_000;
/// Frames that are sent to the page at a time.
const GIVEN: u32 = 2_000;
/// Timeout of filling the log with a million entries.
const FILL_PATIENCE: Duration = Duration::from_secs(120);
/// Timeout of an export.
const EXPORT_PATIENCE: Duration = Duration::from_secs(120);
/// Maximal growth of the JavaScript heap: garbage that is not collected yet.
const GROWTH_MAX: u64 = 1_000_000;

pub fn measure(seconds: u64) -> Result<()> {
    let bench = Bench::start()?;
    let tapped = TappedPage::open(&bench, View::DESKTOP)?;
    let page = &tapped.page;
    if page.find("checkbox", "Collapse status polls")?.on {
        page.click("checkbox", "Collapse status polls")?;
    }
    fill(&tapped)?;
    let before = Held::by(page)?;
    page.work()?;
    let fed = feed(&tapped, seconds)?;
    let work = page.work()?;
    let after = Held::by(page)?;

    let began = Instant::now();
    let file = page.download_within(EXPORT_PATIENCE, "Export CSV")?;
    let took = began.elapsed();
    let exporting = page.work()?;
    let rows = check(&file, fed);

    let of_log = |what: &str| format!("log at 1,000 frames a second for {seconds} s: {what}");
    row(
        &of_log("frames lost"),
        "none",
        match &rows {
            Ok(_) => format!("none of {}", fed - FILLED),
            Err(error) => format!("{error:#}"),
        },
        rows.is_ok(),
    );
    row(
        &of_log("longest main-thread task"),
        "at most 50 ms",
        in_words(work.longest_task(), work.long_tasks.len()),
        work.long_tasks.is_empty(),
    );
    let grown = after.bytes().saturating_sub(before.bytes());
    row(
        &of_log("heap of page and recorder once it is full"),
        "flat",
        format!("{before} before, {after} after"),
        grown <= GROWTH_MAX,
    );
    let rows = rows.unwrap_or_default();
    row(
        "export of 1,000,000 log entries",
        "at most 4 s",
        format!("{:.2} s, {rows} rows", took.as_secs_f64()),
        took <= Duration::from_secs(4) && rows == u64::from(KEPT),
    );
    row(
        "longest main-thread task of that export",
        "at most 100 ms",
        in_words(exporting.longest_task(), exporting.long_tasks.len()),
        exporting.longest_task() <= Duration::from_millis(100),
    );
    crate::ensure_quiet(page)
}

/// Fills the log.
fn fill(tapped: &TappedPage) -> Result<()> {
    // Times must be in the past, so they are close together and the page must be old enough.
    let last_us = loop {
        let now_us = tapped.now_us()?;
        if now_us > u64::from(FILLED) {
            break now_us;
        }
        thread::sleep(Duration::from_millis(100));
    };
    for from in (0..FILLED).step_by(50_000) {
        let until = FILLED.min(from + 50_000);
        let last_us = last_us - u64::from(FILLED - until);
        tapped.give(
            Taker::Recorder,
            &at_once(from, until, FILL_BUFFER, 1, last_us),
        )?;
    }
    wait_until("a full log", FILL_PATIENCE, || {
        let entries = entries(&tapped.page)?;
        let full = entries.contains(&u64::from(KEPT)) && tapped.waiting()? == 0;
        Ok(if full {
            Ok(())
        } else {
            Err(format!("{entries:?}"))
        })
    })
}

/// Sends frames for a number of seconds. Returns the number after the last frame.
fn feed(tapped: &TappedPage, seconds: u64) -> Result<u32> {
    let until = FILLED + u32::try_from(seconds * 1_000_000 / SPACING_US)?;
    let began = Instant::now();
    let from_us = tapped.now_us()? + 1_000_000;
    for from in (FILLED..until).step_by(usize::try_from(GIVEN)?) {
        let behind = until.min(from + GIVEN);
        let at_us = from_us + u64::from(from - FILLED) * SPACING_US;
        // Half a second ahead. The page is not asked for its time, because that grows its memory too.
        let ahead = Duration::from_micros(at_us - from_us) + Duration::from_millis(500);
        thread::sleep(ahead.saturating_sub(began.elapsed()));
        tapped.give(Taker::Recorder, &in_time(from, behind, SPACING_US, at_us))?;
    }
    wait_until("everything to be given", WAIT_MAX, || {
        let waiting = tapped.waiting()?;
        Ok(if waiting == 0 {
            Ok(())
        } else {
            Err(waiting.to_string())
        })
    })?;
    // The counts are complete when the last rows have arrived.
    let shown = wait_until("the log to stand still", WAIT_MAX, || {
        let before = entries(&tapped.page)?;
        thread::sleep(Duration::from_millis(500));
        let after = entries(&tapped.page)?;
        Ok(if before == after {
            Ok(after)
        } else {
            Err(format!("{after:?}"))
        })
    })?;
    ensure!(!shown.is_empty(), "the page does not count its entries");
    Ok(until)
}

/// The numbers in the output `Entries`.
fn entries(page: &Page) -> Result<Vec<u64>> {
    let text = page.text("output", "Entries")?;
    // A space separates thousands, and words separate numbers.
    let text: String = text.split_whitespace().collect();
    let numbers = text.split(|c: char| !c.is_ascii_digit());
    Ok(numbers.filter_map(|digits| digits.parse().ok()).collect())
}

/// Memory of the page and the recorder.
struct Held {
    page: Memory,
    recorder: Memory,
}

impl Held {
    fn by(page: &Page) -> Result<Self> {
        Ok(Self {
            page: page.memory()?,
            recorder: page.memory_of_worker("recorder")?,
        })
    }

    const fn bytes(&self) -> u64 {
        let Self { page, recorder } = self;
        page.script + page.wasm + recorder.script + recorder.wasm
    }
}

impl fmt::Display for Held {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { page, recorder } = self;
        let parts = [page.script, page.wasm, recorder.script, recorder.wasm].map(megabytes);
        write!(
            f,
            "{} (page {} + {}, recorder {} + {})",
            megabytes(self.bytes()),
            parts[0],
            parts[1],
            parts[2],
            parts[3]
        )
    }
}

/// Reads the file. Returns the number of rows if no frame is missing up to the last one.
fn check(file: &Download, fed: u32) -> Result<u64> {
    let bytes = file.bytes()?;
    let mut reader = csv::Reader::from_reader(bytes.as_slice());
    let records: Vec<csv::StringRecord> = reader.records().collect::<Result<_, _>>()?;
    let cell = |record: &csv::StringRecord, place| record.get(place).unwrap_or_default().to_owned();
    let cells: Vec<(String, String)> = records
        .iter()
        .map(|record| (cell(record, 2), cell(record, 4)))
        .collect();
    let newest = newest_without_gap(cells.iter().map(|(a, b)| (a.as_str(), b.as_str())))?;
    let last = fed.checked_sub(1).context("no frames")?;
    ensure!(newest == last, "the newest frame is {newest}, not {last}");
    Ok(records.len() as u64)
}

fn in_words(longest: Duration, long: usize) -> String {
    match long {
        0 => "none over 50 ms".to_owned(),
        _ => format!("{} ms, {long} over 50 ms", longest.as_millis()),
    }
}

fn megabytes(bytes: u64) -> String {
    format!("{:.2} MB", ratio(bytes, 1_000_000))
}
