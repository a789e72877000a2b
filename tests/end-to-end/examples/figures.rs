//! Measures the promised figures of the product on the bench, and prints them as a table.
//!
//! `cargo xtask bench` builds what is needed and runs this. `--seconds N` shortens the long runs.

use std::{env, process::ExitCode, thread, time::Duration};

use anyhow::{Context, Result, bail, ensure};
use end_to_end::{
    Adapter, Bench, Line, Page, Usb, View, WireLog,
    figures::{Table, ms, ratio, row},
    now_us,
};

/// Duration of a measurement of a drive, visible and hidden.
const WATCHED_S: u64 = 60;
/// Number of stops from 100 rpm.
const STOPS: usize = 20;

fn main() -> ExitCode {
    match seconds().and_then(measure) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("figures: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn seconds() -> Result<u64> {
    let mut arguments = env::args().skip(1);
    match (
        arguments.next().as_deref(),
        arguments.next(),
        arguments.next(),
    ) {
        (None, ..) => Ok(WATCHED_S),
        (Some("--seconds"), Some(number), None) => {
            number.parse().context("--seconds takes a whole number")
        }
        _ => bail!("usage: figures [--seconds N]"),
    }
}

fn measure(seconds: u64) -> Result<()> {
    let table = Table::begin()?;
    driving(seconds)?;
    stopping()?;
    first_visit()?;
    table.end()
}

fn connected(bench: &Bench) -> Result<(Adapter, Page)> {
    let adapter = bench.plug(Line::default(), Usb::default())?;
    let page = bench.open("/")?;
    page.look(View::DESKTOP)?;
    page.click("button", "Connect motor")?;
    page.wait_for_text("output", "Speed", |text| {
        text.contains(|c: char| c.is_ascii_digit())
    })?;
    Ok((adapter, page))
}

fn spin(page: &Page) -> Result<()> {
    page.click("button", "+100")?;
    page.wait_for_text("output", "Speed", |text| text.contains("100"))?;
    Ok(())
}

fn driving(seconds: u64) -> Result<()> {
    let bench = Bench::start()?;
    let (adapter, page) = connected(&bench)?;
    spin(&page)?;
    for hidden in [false, true] {
        if hidden {
            bench.hide(&page)?;
        }
        let from = now_us();
        thread::sleep(Duration::from_secs(seconds));
        let until = now_us();
        let wire = adapter.wire()?.since(from).until(until);
        let drives = wire.drives();
        let gaps = drives.gaps().context("no drive frames")?;
        let hertz = ratio(1_000_000 * gaps.count as u64, span_us(&drives)?);
        let page_is = if hidden { "hidden" } else { "visible" };
        let figure = |what: &str| format!("{what}, page {page_is}, {seconds} s");
        row(
            &figure("drive frames at the 50 Hz setting"),
            "49.5 a second or more",
            format!("{hertz:.2} a second"),
            hertz >= 49.5,
        );
        row(
            &figure("gap p99"),
            "at most 21 ms",
            ms(gaps.p99_us),
            gaps.p99_us <= 21_000,
        );
        row(
            &figure("longest gap"),
            "at most 30 ms",
            ms(gaps.max_us),
            gaps.max_us <= 30_000,
        );
        let answered = ratio(1_000_000 * answered_queries(&wire), until - from);
        row(
            &figure("temperature while driving"),
            "5 or more fresh readings a second",
            format!("{answered:.2} a second"),
            answered >= 5.0,
        );
    }
    ensure_quiet(&page)
}

fn span_us(log: &WireLog) -> Result<u64> {
    let (first, last) = (
        log.first().context("empty log")?,
        log.last().context("empty log")?,
    );
    Ok(last.at_us - first.at_us)
}

/// Feedback queries with a reply before the next request.
fn answered_queries(wire: &WireLog) -> u64 {
    let pairs = wire.frames.windows(2);
    let is_query = |bytes: &[u8]| bytes.get(1) == Some(&0x74);
    let answered = pairs.filter(|pair| match pair {
        [asked, reply] => is_query(&asked.bytes) && reply.side == end_to_end::Side::Motor,
        _ => false,
    });
    answered.count() as u64
}

/// One stop as seen on the wire, in microseconds after the page received the key.
struct Stop {
    to_brake: u64,
    to_zero: u64,
    to_standstill: u64,
    braked_until_then: bool,
    confirmed: bool,
}

fn stopping() -> Result<()> {
    let bench = Bench::start()?;
    let (adapter, page) = connected(&bench)?;
    let mut stops = Vec::new();
    for _ in 0..STOPS {
        spin(&page)?;
        thread::sleep(Duration::from_millis(700));
        stops.push(stop(&adapter, &page)?);
        page.click("button", "Release")?;
        thread::sleep(Duration::from_millis(300));
    }
    let longest = |of: fn(&Stop) -> u64| stops.iter().map(of).max().unwrap_or(u64::MAX);
    let first_stop = longest(|stop| stop.to_brake);
    let first_zero = longest(|stop| stop.to_zero);
    let standing = longest(|stop| stop.to_standstill);
    let of_stops = |what: &str| format!("{what}, longest of {STOPS}");
    row(
        &of_stops("stop key to first stop frame"),
        "at most 5 ms",
        ms(first_stop),
        first_stop <= 5_000,
    );
    row(
        &of_stops("stop key to first zero setpoint"),
        "at most 10 ms",
        ms(first_zero),
        first_zero <= 10_000,
    );
    let braked = stops.iter().all(|stop| stop.braked_until_then);
    let confirmed = stops.iter().all(|stop| stop.confirmed);
    row(
        &of_stops("wheel standing after a stop from 100 rpm"),
        "at most 300 ms, confirmed, braked until then",
        format!(
            "{}, {}, {}",
            ms(standing),
            if confirmed {
                "confirmed"
            } else {
                "NOT confirmed"
            },
            if braked {
                "braked until then"
            } else {
                "NOT braked"
            }
        ),
        standing <= 300_000 && braked && confirmed,
    );
    ensure_quiet(&page)
}

fn stop(adapter: &Adapter, page: &Page) -> Result<Stop> {
    let pressed = page.press_timed("Escape")?;
    page.wait_for_text("alertdialog", "Stopped", |text| !text.is_empty())?;
    thread::sleep(Duration::from_millis(700));
    let dialog = page.text("alertdialog", "Stopped")?.to_lowercase();
    let wire = adapter.wire()?.since(pressed.received_us);
    let drives = wire.drives();
    let after = |at_us: u64| at_us - pressed.received_us;
    let first_stop = drives
        .frames
        .iter()
        .find(|frame| frame.brakes())
        .context("no stop frame")?;
    let first_zero = drives
        .frames
        .iter()
        .find(|frame| frame.is_stop())
        .context("no zero")?;
    let replies = wire.from_motors();
    let standing = replies
        .frames
        .iter()
        .find(|frame| frame.bytes.get(4..6) == Some(&[0, 0]))
        .context("the wheel never stood")?;
    let until_then = drives.until(standing.at_us);
    Ok(Stop {
        to_brake: after(first_stop.at_us),
        to_zero: after(first_zero.at_us),
        to_standstill: after(standing.at_us),
        // A frame that was already being sent does not belong to the stop.
        braked_until_then: until_then
            .frames
            .iter()
            .skip(1)
            .all(end_to_end::Frame::brakes),
        confirmed: dialog.contains("confirmed") && !dialog.contains("not confirm"),
    })
}

/// Checks that all requests of a first visit go to the host of the page.
fn first_visit() -> Result<()> {
    let bench = Bench::start()?;
    let page = bench.open("/")?;
    page.find("button", "Connect motor")?;
    let urls = page.evaluate(
        "performance.getEntriesByType('resource').map((entry) => entry.name).join(' ')",
    )?;
    let urls = urls.as_str().context("no list of requests")?;
    let requests: Vec<&str> = urls.split(' ').filter(|url| !url.is_empty()).collect();
    ensure!(
        !requests.is_empty(),
        "the page requested nothing, not even its own program"
    );
    let foreign = requests
        .iter()
        .filter(|url| !url.starts_with(&bench.origin()))
        .count();
    row(
        "foreign hosts asked on a first visit",
        "none",
        format!("{foreign} of {} requests", requests.len()),
        foreign == 0,
    );
    ensure_quiet(&page)
}

fn ensure_quiet(page: &Page) -> Result<()> {
    let errors = page.console_errors();
    ensure!(errors.is_empty(), "the console is not empty: {errors:?}");
    Ok(())
}
