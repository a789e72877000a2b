//! From STOP in a page to the first stop frame, and leases that end although their page answers.

use std::{thread, time::Duration};

use anyhow::{Context, Result, bail, ensure};
use end_to_end::{
    Line,
    figures::{ms, percentile, row, row_without_bound},
    now_us,
};
use motorlink_bus::{Command, StopReason};

use crate::{
    network::{Network, Quality},
    page::{Page, start},
    server::Server,
};

const ROUNDS: usize = 100;
/// Starts until one is not late.
const TRIES: u32 = 20;
/// From a message of the server's computer to the first stop frame.
const BOUND_US: u64 = 10_000;

/// Receives for this long, and returns whether the page has held the lease all the time.
pub fn live(page: &mut Page, lasts: Duration) -> Result<bool> {
    let until = now_us() + u64::try_from(lasts.as_micros())?;
    let mut held = page.epoch.is_some();
    while now_us() < until {
        ensure!(page.receive(), "the server has closed the connection");
        held &= page.epoch.is_some();
    }
    Ok(held)
}

/// Takes control, and drives. An act that a bad network delays has no effect: then it is done again.
pub fn take_and_drive(page: &mut Page, command: Command) -> Result<()> {
    for _ in 0..TRIES {
        if page.epoch.is_none() {
            page.take_control();
        }
        // What an earlier lease has stopped.
        page.act(Command::Release);
        live(page, Duration::from_millis(200))?;
        page.act(command);
        live(page, Duration::from_secs(1))?;
        if page.turns() && page.epoch.is_some() {
            return Ok(());
        }
    }
    bail!("no wheel turns after {TRIES} starts")
}

/// One press of STOP.
struct Press {
    /// When.
    at_us: u64,
    /// When the server's computer had the message, if a network was between.
    arrived_us: Option<u64>,
}

fn press_often(page: &mut Page, arrived: impl Fn(usize) -> Option<u64>) -> Result<Vec<Press>> {
    let mut presses = Vec::new();
    while presses.len() < ROUNDS {
        if page.epoch.is_none() || !page.turns() {
            take_and_drive(page, start())?;
        }
        if !live(page, Duration::from_millis(300))? {
            continue;
        }
        let at_us = now_us();
        page.act(Command::StopAll(StopReason::Operator));
        let sent = page.sent;
        live(page, Duration::from_secs(1))?;
        presses.push(Press {
            at_us,
            arrived_us: arrived(sent),
        });
        page.act(Command::Release);
        live(page, Duration::from_millis(300))?;
        page.act(start());
        live(page, Duration::from_millis(500))?;
    }
    Ok(presses)
}

/// The times from each press to its first stop frame, and the same from the arrival of its message, both sorted.
fn latencies(server: &Server, presses: &[Press]) -> Result<(Vec<u64>, Vec<u64>)> {
    let wire = server.wire()?;
    let (mut whole, mut own) = (Vec::new(), Vec::new());
    for press in presses {
        let frames = wire.since(press.at_us);
        let stop = frames.frames.iter().find(|frame| frame.is_stop());
        let at_us = stop.context("no stop frame after a press")?.at_us;
        whole.push(at_us - press.at_us);
        if let Some(arrived_us) = press.arrived_us {
            own.push(at_us.saturating_sub(arrived_us));
        }
    }
    whole.sort_unstable();
    own.sort_unstable();
    Ok((whole, own))
}

pub fn loopback() -> Result<()> {
    let mut server = Server::start(&Line::default(), None)?;
    let mut page = server.page()?;
    let presses = press_often(&mut page, |_| None)?;
    let (whole, _) = latencies(&server, &presses)?;
    let (p99, most) = (
        percentile(&whole, 99).unwrap_or(0),
        whole.last().copied().unwrap_or(0),
    );
    row(
        "STOP in a remote page to the first stop frame, loopback, 99 of 100",
        "10 ms",
        format!("{}, longest {}", ms(p99), ms(most)),
        p99 <= BOUND_US,
    );
    Ok(())
}

/// What was seen on one network.
struct Seen {
    /// How often the lease ended although the page answered.
    false_stops: u32,
    presses: Option<(Vec<u64>, Vec<u64>)>,
}

/// Drives on three networks at the same time.
pub fn over_networks(lasts: Duration) -> Result<()> {
    let qualities = [(20, 0), (50, 1), (50, 5)];
    let runs: Vec<_> = (0_u8..)
        .zip(qualities)
        .map(|(number, (delay, loss_percent))| {
            let quality = Quality {
                delay: Duration::from_millis(delay) / 2,
                loss_percent,
            };
            thread::spawn(move || drive(number, quality, lasts))
        })
        .collect();
    for (run, (delay, loss)) in runs.into_iter().zip(qualities) {
        let seen = run.join().ok().context("a page has failed")??;
        let network = format!("{delay} ms there and back, {loss} % of the packets lost each way");
        let figure = format!(
            "stops by the lease although the page answers, {network}, {} s",
            lasts.as_secs()
        );
        if loss < 5 {
            row(&figure, "0", seen.false_stops, seen.false_stops == 0);
        } else {
            row_without_bound(&figure, seen.false_stops);
        }
        let Some((whole, own)) = seen.presses else {
            continue;
        };
        let p99 = percentile(&own, 99).context("no message has arrived")?;
        row(
            &format!(
                "the last packet of STOP in the server's computer to the first stop frame, {network}, 99 of {}",
                own.len()
            ),
            "10 ms",
            ms(p99),
            p99 <= BOUND_US && own.len() == ROUNDS,
        );
        row_without_bound(
            &format!("STOP in a remote page to the first stop frame, {network}"),
            format!(
                "median {}, 99 of 100 {}, longest {}",
                ms(percentile(&whole, 50).unwrap_or(0)),
                ms(percentile(&whole, 99).unwrap_or(0)),
                ms(whole.last().copied().unwrap_or(0))
            ),
        );
    }
    Ok(())
}

/// Drives for this long, and on the worst network presses STOP.
fn drive(number: u8, quality: Quality, lasts: Duration) -> Result<Seen> {
    let network = Network::start(number, quality)?;
    let mut server = Server::start(&Line::default(), Some(&network))?;
    network.enter_as_viewer()?;
    let mut page = server.page()?;
    let handshake = network.arrived().context("nothing has arrived")?;
    let mut seen = Seen {
        false_stops: 0,
        presses: None,
    };
    take_and_drive(&mut page, start())?;
    let until = now_us() + u64::try_from(lasts.as_micros())?;
    while now_us() < until {
        if !live(&mut page, Duration::from_millis(500))? {
            seen.false_stops += 1;
            take_and_drive(&mut page, start())?;
        }
    }
    if quality.loss_percent == 5 {
        let presses = press_often(&mut page, |sent| {
            let sent = u32::try_from(sent).ok()?;
            network.arrived_at(handshake.checked_add(sent)?)
        })?;
        seen.presses = Some(latencies(&server, &presses)?);
    }
    Ok(seen)
}
