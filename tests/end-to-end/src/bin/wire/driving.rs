//! Helpers of all measurements: a page that drives, and a recorded wire.

use std::{thread, time::Duration};

use anyhow::Result;
use end_to_end::{Adapter, Bench, Line, Page, Usb, View, WireLog, now_us, retry};

/// Time in which a visible page finds the frame rate that keeps the wire on time: three steps of three seconds, and
/// one judgement more.
pub const SETTLES: Duration = Duration::from_secs(12);

/// A wheel turns within a tenth of a second; a busy page shows it a little later.
const STARTS_WITHIN: Duration = Duration::from_secs(3);
const PRESSES_MAX: u32 = 3;

/// A page that is connected to motors.
pub fn connected(bench: &Bench, line: Line) -> Result<(Adapter, Page)> {
    let adapter = bench.plug(line, Usb::default())?;
    let page = bench.open("/")?;
    page.look(View::DESKTOP)?;
    page.click("button", "Connect motor")?;
    page.wait_for_text("output", "Speed", has_digits)?;
    Ok((adapter, page))
}

/// Drives the chosen motor at +100 rpm.
pub fn spin(page: &Page, hertz: u16) -> Result<()> {
    page.fill("spinbutton", "Command rate", &hertz.to_string())?;
    page.press("Enter")?;
    press_plus_100(page)?;
    page.wait_for_text("output", "Speed", |text| text.contains("100"))?;
    Ok(())
}

/// Presses `+100`. Behind Connect a DDSM400 is enabled and switched to the velocity loop: the button is disabled for
/// that tenth of a second, so it is pressed again.
pub fn press_plus_100(page: &Page) -> Result<()> {
    retry("press +100", PRESSES_MAX, || {
        page.click("button", "+100")?;
        let moves = page.wait_for_text_within(STARTS_WITHIN, "output", "Speed", |text| {
            text.contains(|c: char| ('1'..='9').contains(&c))
        });
        Ok(moves.map(drop).map_err(|error| error.to_string()))
    })
}

/// Records the wire for a time, after a second to settle.
pub fn watch(adapter: &Adapter, watched: Duration) -> Result<WireLog> {
    thread::sleep(Duration::from_secs(1));
    let from_us = now_us();
    thread::sleep(watched);
    let until_us = now_us();
    Ok(adapter.wire()?.since(from_us).until(until_us))
}

/// The same for a visible page and then for a hidden one. On a machine with few cores and no GPU, drawing is the main
/// cause of the worker's delays.
pub fn watch_both(
    bench: &Bench,
    adapter: &Adapter,
    page: &Page,
    watched: Duration,
) -> Result<[(&'static str, WireLog); 2]> {
    thread::sleep(SETTLES);
    let visible = watch(adapter, watched)?;
    bench.hide(page)?;
    let hidden = watch(adapter, watched)?;
    Ok([("visible", visible), ("hidden", hidden)])
}

pub fn has_digits(text: &str) -> bool {
    text.contains(|c: char| c.is_ascii_digit())
}
