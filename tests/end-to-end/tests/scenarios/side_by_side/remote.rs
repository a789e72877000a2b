//! Remote operation: pages that come from `motorlink serve` watch and drive the motors of the server.

use std::{
    io::{BufRead, BufReader},
    process::{Child, Command, Stdio},
    thread,
    time::Duration,
};

use anyhow::{Context, Result, bail, ensure};
use end_to_end::{Adapter, Bench, Line, Page, Usb, artefacts, now_us};

use crate::fixture::{
    assert_ends_braked, assert_quiet_console, number, wait_for_speed, wait_until_enabled,
};

/// A lease (400 ms), the time until the server looks at it, and a busy computer.
const LEASE_ENDS_WITHIN_US: u64 = 600_000;

/// `motorlink serve` on an adapter. It ends when dropped.
struct Remote {
    server: Child,
    address: String,
}

impl Remote {
    fn serve(adapter: &Adapter) -> Result<Self> {
        let mut server = Command::new(artefacts::command()?)
            .arg("--port")
            .arg(adapter.node()?)
            .args(["serve", "--listen", "127.0.0.1:0", "--page"])
            .arg(artefacts::dist()?)
            .stderr(Stdio::piped())
            .spawn()
            .context("motorlink does not start")?;
        let said = server.stderr.take().context("it says nothing")?;
        let mut lines = BufReader::new(said).lines();
        let found = lines.find_map(|line| {
            let line = line.ok()?;
            let (_, rest) = line.split_once("Open ")?;
            Some(rest.split_once(' ')?.0.to_owned())
        });
        // It must be able to say more.
        thread::spawn(move || lines.for_each(drop));
        match found {
            Some(address) => Ok(Self { server, address }),
            None => bail!("the server did not say its address"),
        }
    }

    fn open(&self, bench: &Bench) -> Result<Page> {
        let page = bench.open("/")?;
        page.go(&self.address)?;
        page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
        page.wait_for_text("status", "Operator", |text| text.ends_with("drives."))?;
        Ok(page)
    }
}

impl Drop for Remote {
    fn drop(&mut self) {
        // The wire of this scenario ends with it.
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

fn operator(page: &Page, words: &str) -> Result<()> {
    page.wait_for_text("status", "Operator", |text| text.contains(words))?;
    Ok(())
}

fn spins(page: &Page) -> Result<()> {
    wait_until_enabled(page, "button", "+100", true)?;
    page.click("button", "+100")?;
    wait_for_speed(page, 97..=103)
}

fn release(page: &Page) -> Result<()> {
    page.find("alertdialog", "Stopped")?;
    wait_for_speed(page, 0..=0)?;
    page.click("button", "Release")
}

#[test]
fn a_watcher_sees_the_wheel_and_stops_it_and_control_is_handed_over_both_ways() -> Result<()> {
    let bench = Bench::reuse()?;
    let adapter = bench.plug(Line::default(), Usb::default())?;
    let remote = Remote::serve(&adapter)?;
    let first = remote.open(&bench)?;
    // Both load before the wheel turns: loading a page can delay the operator's beyond its lease.
    let second = remote.open(&bench)?;
    first.show()?;
    operator(&first, "Nobody drives.")?;
    wait_until_enabled(&first, "button", "+100", false)?;
    first.click("button", "Take control")?;
    operator(&first, "You drive.")?;
    spins(&first)?;

    second.show()?;
    operator(&second, "Viewer 1 (127.0.0.1) drives.")?;
    wait_for_speed(&second, 97..=103)?;
    wait_until_enabled(&second, "button", "+100", false)?;
    let stopping = now_us();
    second.click("button", "STOP all motors")?;
    first.show()?;
    wait_for_speed(&first, 0..=0)?;
    assert_ends_braked(&adapter.wire()?.since(stopping));
    release(&first)?;

    // It is asked first, and gives up control.
    second.show()?;
    second.click("button", "Take control")?;
    first.show()?;
    operator(&first, "Viewer 2 (127.0.0.1) asks for control.")?;
    first.click("button", "Give up control")?;
    second.show()?;
    operator(&second, "Nobody drives.")?;
    second.click("button", "Take control")?;
    operator(&second, "You drive.")?;
    release(&second)?;
    spins(&second)?;

    // A second press takes it back, and stops the wheel first.
    first.show()?;
    operator(&first, "Viewer 2 (127.0.0.1) drives.")?;
    first.click("button", "Take control")?;
    // Not by the second click of a double click.
    thread::sleep(Duration::from_millis(1_200));
    let taking = now_us();
    first.click("button", "Take control now")?;
    operator(&first, "You drive.")?;
    wait_for_speed(&first, 0..=0)?;
    assert_ends_braked(&adapter.wire()?.since(taking));
    release(&first)?;
    spins(&first)?;
    assert_quiet_console(&first);
    assert_quiet_console(&second);
    Ok(())
}

#[test]
fn an_operator_that_hangs_or_goes_has_the_wheel_stopped_and_a_watcher_that_goes_has_not()
-> Result<()> {
    let bench = Bench::reuse()?;
    let adapter = bench.plug(Line::default(), Usb::default())?;
    let remote = Remote::serve(&adapter)?;
    let page = remote.open(&bench)?;
    // It loads before the wheel turns, like each watcher here: see above.
    let going = remote.open(&bench)?;
    page.show()?;
    page.click("button", "Take control")?;
    operator(&page, "You drive.")?;
    spins(&page)?;
    bench.close(going)?;
    thread::sleep(Duration::from_millis(700));
    wait_for_speed(&page, 97..=103)?;

    let hanging = now_us();
    page.evaluate("{ const from = performance.now(); while (performance.now() - from < 1500); }")?;
    let wire = adapter.wire()?.since(hanging).from_host();
    let stop = wire.frames.iter().find(|frame| frame.is_stop());
    let after_us = stop.context("no stop")?.at_us - hanging;
    ensure!(
        after_us < LEASE_ENDS_WITHIN_US,
        "stopped after {after_us} us"
    );
    // It answers again, and has to take control again.
    operator(&page, "Nobody drives.")?;
    wait_for_speed(&page, 0..=0)?;
    assert_ends_braked(&adapter.wire()?.since(hanging));
    let watcher = remote.open(&bench)?;
    page.show()?;
    page.click("button", "Take control")?;
    operator(&page, "You drive.")?;
    release(&page)?;
    spins(&page)?;

    let closing = now_us();
    bench.close(page)?;
    watcher.show()?;
    operator(&watcher, "Nobody drives.")?;
    watcher.wait_for_text("output", "Speed", |text| number(text) == Some(0.0))?;
    assert_ends_braked(&adapter.wire()?.since(closing));
    assert_quiet_console(&watcher);
    Ok(())
}
