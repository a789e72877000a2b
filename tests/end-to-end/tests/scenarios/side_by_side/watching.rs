//! Reading the instruments: the log, the graph, the faults.

use std::time::Duration;

use crate::fixture::{
    Scenario, assert_quiet_console, number, spin, tick, wait_for_speed, wait_until_enabled,
};
use anyhow::Result;
use end_to_end::{Line, Page, WAIT_MAX, wait_until};

/// A stall takes the motor 5 s to notice and as long to forget.
const STALL_MAX: Duration = Duration::from_secs(40);

/// Waits until the rows in sight are as they should be, and gives them.
fn wait_for_packets(page: &Page, wanted: impl Fn(&str) -> bool) -> Result<String> {
    page.wait_for_text("log", "Packets", wanted)
}

#[test]
fn the_log_shows_both_directions_in_hex_and_in_words() -> Result<()> {
    let scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    tick(page, "Collapse status polls", false)?;
    spin(page, "+100", 97..=103)?;
    let rows = wait_for_packets(page, |rows| {
        rows.contains("TX") && rows.contains("RX") && rows.contains("01 64 00 64")
    })?;
    assert!(rows.contains("100 rpm"), "{rows}");
    // Polls are routine and can be hidden; they are counted.
    page.click("button", "Stop")?;
    wait_for_speed(page, 0..=0)?;
    let polled = |rows: &str| rows.matches("01 74 00").count() > 2;
    wait_for_packets(page, polled)?;
    tick(page, "Collapse status polls", true)?;
    wait_for_packets(page, |rows| !polled(rows))?;
    page.wait_for_text("output", "Entries", |text| text.contains("collapsed"))?;
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn the_log_is_filtered_by_text_by_motor_and_by_direction() -> Result<()> {
    let scenario = Scenario::connected(Line::with_motors(&[1, 2]))?;
    let page = &scenario.page;
    tick(page, "Collapse status polls", false)?;
    page.choose("Motor", "0x02 · 2")?;
    wait_for_packets(page, |rows| {
        rows.contains("02 74 00") && rows.contains("RX")
    })?;

    page.find("searchbox", "Filter")?.type_over("02 74")?;
    wait_for_packets(page, |rows| {
        rows.contains("02 74 00") && !rows.contains("RX") && !rows.contains("01 74 00")
    })?;
    page.find("searchbox", "Filter")?
        .type_over("nothing reads like this")?;
    wait_for_packets(page, |rows| !rows.contains("TX") && !rows.contains("RX"))?;
    // Letters in a text field drive nothing, and what is hidden is kept.
    page.wait_for_text("output", "Entries", |text| {
        number(text).is_some_and(|kept| kept > 10.0)
    })?;
    scenario.stays_undriven(Duration::from_secs(1))?;
    page.find("searchbox", "Filter")?.type_over(" ")?;
    assert!(page.find_all("alertdialog", "Stopped")?.is_empty());
    page.find("searchbox", "Filter")?.type_over("")?;

    page.choose("Log direction", "RX")?;
    wait_for_packets(page, |rows| rows.contains("RX") && !rows.contains("TX"))?;
    page.choose("Log direction", "All")?;
    page.choose("Log ID", "0x02")?;
    wait_for_packets(page, |rows| {
        rows.contains("02 74 00") && !rows.contains("01 74 00")
    })?;
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn the_log_lets_go_of_the_newest_when_a_person_scrolls_up() -> Result<()> {
    let scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    tick(page, "Collapse status polls", false)?;
    // More than there is room for.
    page.wait_for_text("output", "Entries", |text| {
        number(text).is_some_and(|kept| kept > 150.0)
    })?;
    assert!(page.find("checkbox", "Auto-scroll")?.on);
    page.find("log", "Packets")?.turn_wheel(-300.0)?;
    wait_until("the log to let go", WAIT_MAX, || {
        let on = page.find("checkbox", "Auto-scroll")?.on;
        Ok(if on {
            Err("it follows".to_owned())
        } else {
            Ok(())
        })
    })?;
    // What is read stays where it is while more comes. The page draws the rows of a new place a few frames after the
    // wheel was turned, on a busy machine later.
    let come = || -> Result<f64> {
        let text = page.wait_for_text("button", "Jump to newest", |text| number(text).is_some())?;
        Ok(number(&text).unwrap_or_default())
    };
    let mut rows = String::new();
    let mut rows_since = 0.0;
    wait_until("the rows to stay while 20 more come", WAIT_MAX, || {
        let shown = page.text("log", "Packets")?;
        let come = come()?;
        if shown != rows {
            rows = shown;
            rows_since = come;
        }
        let stayed_for = come - rows_since;
        Ok(if stayed_for > 20.0 {
            Ok(())
        } else {
            Err(format!("they stayed while {stayed_for} came"))
        })
    })?;
    page.click("button", "Jump to newest")?;
    wait_until("the log to follow", WAIT_MAX, || {
        let on = page.find("checkbox", "Auto-scroll")?.on;
        Ok(if on {
            Ok(())
        } else {
            Err("it does not".to_owned())
        })
    })?;
    wait_for_packets(page, |now| now != rows)?;
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn the_graph_draws_what_the_motor_does_and_gives_its_picture() -> Result<()> {
    let scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    spin(page, "+100", 97..=103)?;
    let graph = |page: &Page| page.find_like("img", "Speed and current");
    let drawn = wait_until("a trace", WAIT_MAX, || {
        let pixels = graph(page)?.coloured_pixels()?;
        Ok(if pixels > 300 {
            Ok(pixels)
        } else {
            Err(format!("{pixels} pixels"))
        })
    })?;
    // Without its traces there is less to see, and with them it is back.
    for trace in ["Show speed", "Show current", "Show target"] {
        page.click("checkbox", trace)?;
    }
    wait_until("an empty graph", WAIT_MAX, || {
        let pixels = graph(page)?.coloured_pixels()?;
        Ok(if pixels < drawn / 2 {
            Ok(())
        } else {
            Err(format!("{pixels} of {drawn}"))
        })
    })?;
    for trace in ["Show speed", "Show current", "Show target"] {
        page.click("checkbox", trace)?;
    }
    wait_until("the traces again", WAIT_MAX, || {
        let pixels = graph(page)?.coloured_pixels()?;
        Ok(if pixels * 2 > drawn {
            Ok(())
        } else {
            Err(format!("{pixels} of {drawn}"))
        })
    })?;
    page.click("radio", "10 s")?;
    page.find("img", "Speed and current, last 10 s")?;

    let picture = page.download("PNG")?;
    assert_eq!(picture.extension(), "png");
    let bytes = picture.bytes()?;
    assert_eq!(bytes[..8], *b"\x89PNG\r\n\x1a\n");
    let width = u32::from_be_bytes(bytes[16..20].try_into()?);
    assert!(width > 300, "{width} pixels wide");
    assert!(bytes.ends_with(b"IEND\xaeB\x60\x82"), "a whole picture");
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn a_stall_is_named_and_stays_on_record_until_it_was_seen() -> Result<()> {
    let mut scenario = Scenario::spinning()?;
    // The limit of half a second would be crossed first.
    scenario.page.open_panel("Settings")?;
    scenario.page.fill("spinbutton", "Current limit", "8")?;
    scenario.page.open_panel("Telemetry")?;
    scenario.adapter.act("block 1 on")?;
    let page = &scenario.page;
    let faults = page.wait_for_text_within(STALL_MAX, "output", "Faults", |text| {
        text.to_lowercase().contains("stall")
    })?;
    assert!(faults.contains("0x08"), "{faults}");
    wait_until_enabled(page, "button", "Acknowledge", true)?;
    scenario.adapter.act("block 1 off")?;
    let page = &scenario.page;
    page.wait_for_text_within(STALL_MAX, "output", "Faults", |text| text.contains("OK"))?;
    // It has gone, and nothing drives by that; the person has not seen it.
    let record = page.text("output", "Fault record")?;
    assert!(record.contains("stall"), "{record}");
    let times = record
        .split_whitespace()
        .filter(|word| word.matches(':').count() == 2);
    assert_eq!(times.count(), 2, "when it came and went: {record}");
    scenario.stays_undriven(Duration::from_secs(1))?;
    wait_until_enabled(page, "button", "Acknowledge", true)?;
    page.click("button", "Acknowledge")?;
    wait_until_enabled(page, "button", "Acknowledge", false)?;
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn a_hot_winding_is_named_before_and_when_it_trips() -> Result<()> {
    let mut scenario = Scenario::connected(Line::default())?;
    scenario.adapter.act("temperature 1 74")?;
    let warm = |text: &str| text.contains("74") && text.contains("warm");
    scenario.page.wait_for_text("output", "Temperature", warm)?;
    scenario.adapter.act("temperature 1 84")?;
    let hot = |text: &str| text.to_lowercase().contains("temperature");
    scenario.page.wait_for_text("output", "Faults", hot)?;
    scenario.adapter.act("temperature 1 30")?;
    scenario
        .page
        .wait_for_text("output", "Faults", |text| text.contains("OK"))?;
    assert!(hot(&scenario.page.text("output", "Fault record")?));
    assert_quiet_console(&scenario.page);
    Ok(())
}

/// The port is open all the time; the motor cannot be used.
#[test]
fn the_header_says_what_is_wrong_with_the_motor() -> Result<()> {
    let mut scenario = Scenario::connected(Line::default())?;
    let wait_for = |page: &Page, state: &'static str| {
        page.wait_for_text("status", "Connection", |text| text.starts_with(state))
    };
    wait_for(&scenario.page, "Connected")?;
    scenario.adapter.act("mute 1 on")?;
    let text = wait_for(&scenario.page, "No reply")?;
    assert!(text.contains("0x01"), "{text}");
    assert!(!text.contains("Connected"), "{text}");
    scenario.adapter.act("mute 1 off")?;
    wait_for(&scenario.page, "Connected")?;
    scenario.adapter.act("temperature 1 84")?;
    wait_for(&scenario.page, "Motor fault")?;
    scenario.adapter.act("temperature 1 30")?;
    wait_for(&scenario.page, "Connected")?;
    assert_quiet_console(&scenario.page);
    Ok(())
}
