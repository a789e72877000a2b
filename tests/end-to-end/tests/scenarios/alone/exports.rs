//! What the page writes into files is what was on the wire.

use std::{thread, time::Duration};

use crate::fixture::{
    Scenario, assert_quiet_console,
    exports::{LOG_HEAD, Reply, TELEMETRY_HEAD, Table, hex, ms_of_day, undisturbed_replies},
    number, spin, stop_and_release, wait_for_speed, wait_until_enabled,
};
use anyhow::{Context, Result};
use end_to_end::{Frame, Line, WireLog, figures::percentile, now_us};
use motorlink_messages::protocol::{Frame as ProtocolFrame, Reply as ProtocolReply};

/// Something of everything: a drive, a stop, a loop that is switched, silence.
fn a_busy_minute(scenario: &Scenario) -> Result<()> {
    let page = &scenario.page;
    spin(page, "+100", 97..=103)?;
    page.click("button", "-50")?;
    wait_for_speed(page, -53..=-47)?;
    stop_and_release(page)?;
    page.click("tab", "Current")?;
    page.click("button", "0 A")?;
    page.wait_for_text("output", "Mode", |text| {
        text.to_lowercase().contains("current")
    })?;
    page.open_panel("ID Manager")?;
    page.click("button", "Scan")?;
    // A delayed machine may hear no motor.
    page.wait_for_text("status", "Scan result", |text| {
        text.contains("found") || text.contains("replied")
    })?;
    disconnect(scenario)
}

/// Nothing is on the wire after this.
fn disconnect(scenario: &Scenario) -> Result<()> {
    scenario.page.click("button", "Disconnect")?;
    scenario
        .page
        .wait_for_text("status", "Connection", |text| text.contains("Disconnected"))?;
    Ok(())
}

/// Compares the frames of an exported log with the wire's own log, line by line.
fn assert_same(table: &Table, wire: &WireLog) -> Result<()> {
    let directions = table.column("direction")?;
    let hexes = table.column("hex")?;
    let lines: Vec<(&str, &str)> = directions.into_iter().zip(hexes).collect();
    // What a reply spoilt stands there as noise, and behind which frame is the wire's business.
    let of_wire = |direction: &str, hex: &str| direction != "RX" || is_reply(hex);
    let exported = |wanted: &str| -> Vec<&str> {
        let of_direction = lines.iter().filter(|(direction, _)| *direction == wanted);
        let whole = of_direction.filter(|(direction, hex)| of_wire(direction, hex));
        whole.map(|(_, hex)| *hex).collect()
    };
    let sent: Vec<String> = wire.from_host().frames.iter().map(hex).collect();
    assert_equal(&exported("TX"), &sent);
    let replies = undisturbed_replies(wire);
    let heard: Vec<String> = replies.iter().map(|reply| hex(&reply.frame)).collect();
    assert_equal(&exported("RX"), &heard);
    let noise = lines
        .iter()
        .filter(|(direction, hex)| !of_wire(direction, hex));
    let spoilt = wire.from_motors().frames.len() - replies.len();
    // Each in pieces of ten bytes, with the request that spoilt it or its echo.
    assert!(
        noise.clone().count() <= 4 * spoilt,
        "{noise:?}, {spoilt} spoilt"
    );
    // Each reply stands behind the request that had asked for it.
    let mut sent_before = 0;
    let mut replies = replies.iter();
    for (place, (direction, _)) in lines.iter().enumerate() {
        match *direction {
            "TX" => sent_before += 1,
            "RX" if is_reply(lines[place].1) => assert!(
                sent_before >= replies.next().unwrap().behind,
                "line {place}"
            ),
            _ => {}
        }
    }
    Ok(())
}

fn is_reply(hex: &str) -> bool {
    let frame = hex.parse::<ProtocolFrame>();
    frame.is_ok_and(|frame| ProtocolReply::decode(&frame, None).is_ok())
}

fn assert_equal(exported: &[&str], wire: &[String]) {
    let differs = |(exported, wire): (&&str, &String)| exported != wire;
    let place = exported.iter().zip(wire).position(differs);
    let from = place.unwrap_or_default().saturating_sub(1);
    let near: Vec<_> = exported.iter().zip(wire).skip(from).take(6).collect();
    assert!(place.is_none(), "exported, and of the wire: {near:?}");
    // An exchange may pass between the press and the end of the wire's log, and a port that closes may discard a frame.
    let ends = [exported.last().copied(), wire.last().map(String::as_str)];
    assert!(
        exported.len().abs_diff(wire.len()) <= 1,
        "{} frames exported, {} on the wire; the last ones: {ends:?}",
        exported.len(),
        wire.len()
    );
}

fn the_log_is_the_wire(line: Line) -> Result<()> {
    let scenario = Scenario::connected(line)?;
    let page = &scenario.page;
    a_busy_minute(&scenario)?;
    let file = page.download("Export CSV")?;
    // No program can mistake its character set.
    assert!(file.bytes()?.is_ascii());
    let table = Table::read(&file)?;
    assert_eq!(table.head, LOG_HEAD);
    let wire = scenario.adapter.wire()?;
    assert!(wire.len() > 150, "{} frames", wire.len());
    assert_same(&table, &wire)?;

    // Time goes on, and elapsed is the same time counted from the first line.
    let times = table.column("time")?;
    let times: Vec<u64> = times.into_iter().map(ms_of_day).collect::<Result<_>>()?;
    assert!(times.is_sorted(), "{times:?}");
    for (time, elapsed) in times.iter().zip(table.column("elapsed_s")?) {
        let (seconds, ms) = elapsed.split_once('.').unwrap();
        let elapsed: u64 = seconds.parse::<u64>()? * 1000 + ms.parse::<u64>()?;
        assert!((time - times[0]).abs_diff(elapsed) <= 1, "{time} {elapsed}");
    }
    // A frame of the wire's log is as old as in the page's, to what a serial line takes.
    let said = table.column("direction")?;
    let frames = said.iter().zip(&times).filter(|(said, _)| **said == "TX");
    let host = wire.from_host();
    let mut offsets: Vec<i64> = frames
        .zip(&host.frames)
        .map(|((_, ms), frame)| (frame.at_us / 1000).cast_signed() - ms.cast_signed())
        .collect();
    offsets.sort_unstable();
    // Some frames wait on a busy machine.
    let spread = percentile(&offsets, 90).unwrap() - percentile(&offsets, 10).unwrap();
    assert!(
        spread <= 50,
        "the log's times are {spread} ms off the wire's"
    );
    // A spreadsheet runs nothing of it.
    for cell in table.rows.iter().flatten() {
        assert!(
            !cell.starts_with(['=', '+', '-', '@', '\t', '\r', '\'']),
            "{cell}"
        );
    }
    let replies = table.rows.iter().filter(|row| row[2] == "RX");
    assert!(replies.clone().all(|row| row[5].starts_with("reply ")));
    // What the page said itself is in it, with no bytes.
    let system = table.rows.iter().filter(|row| row[2] == "SYS");
    assert!(system.clone().count() > 0);
    assert!(
        system
            .clone()
            .all(|row| row[4].is_empty() && !row[5].is_empty())
    );
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn the_exported_log_is_the_wires_own_line_by_line() -> Result<()> {
    the_log_is_the_wire(Line::default())
}

#[test]
fn an_adapter_that_echoes_adds_no_line_to_the_log() -> Result<()> {
    the_log_is_the_wire(Line::default().with(&["--echo", "whole"]))
}

#[test]
fn collapsed_polls_are_counted_and_exported_all_the_same() -> Result<()> {
    let scenario = Scenario::spinning()?;
    let page = &scenario.page;
    if !page.find("checkbox", "Collapse status polls")?.on {
        page.click("checkbox", "Collapse status polls")?;
    }
    page.wait_for_text("output", "Entries", |text| text.contains("collapsed"))?;
    disconnect(&scenario)?;
    let table = Table::read(&page.download("Export CSV")?)?;
    assert_same(&table, &scenario.adapter.wire()?)?;
    assert_quiet_console(page);
    Ok(())
}

/// Checks every row of an exported recording against the replies that it was made of.
fn assert_rows_are_replies(table: &Table, replies: &[Reply]) -> Result<()> {
    assert_eq!(table.head, TELEMETRY_HEAD);
    let expected: Vec<String> = replies.iter().map(|reply| hex(&reply.frame)).collect();
    assert_equal(&table.column("raw_hex")?, &expected);
    let mut undetermined = 0;
    for (row, reply) in table.rows.iter().zip(replies) {
        let bytes: Vec<u8> = row[9]
            .split(' ')
            .map(|byte| u8::from_str_radix(byte, 16))
            .collect::<Result<_, _>>()?;
        ms_of_day(&row[0])?;
        assert_eq!(row[1], bytes[0].to_string(), "{row:?}");
        let mode = ["", "current", "velocity", "position"][usize::from(bytes[1])];
        assert!(row[2].to_lowercase().contains(mode), "{row:?}");
        let signed = |high: usize| i16::from_be_bytes([bytes[high], bytes[high + 1]]);
        assert_eq!(row[3], signed(4).to_string(), "{row:?}");
        let amps = f64::from(signed(2)) * 8.0 / 32_767.0;
        assert!((row[4].parse::<f64>()? - amps).abs() < 0.001, "{row:?}");
        assert_eq!(row[7], format!("0x{:02X}", bytes[8]), "{row:?}");
        assert_eq!(row[8], "OK", "{row:?}");
        // Where a reply was late it is not certain what had been asked.
        if row[5].is_empty() && row[6].is_empty() {
            undetermined += 1;
            continue;
        }
        // A temperature is in the replies to queries and in no other.
        let temperature = if reply.queried {
            bytes[6].to_string()
        } else {
            String::new()
        };
        assert_eq!(row[5], temperature, "{row:?}");
        let degrees = if reply.queried {
            f64::from(bytes[7]) * 360.0 / 255.0
        } else {
            f64::from(u16::from_be_bytes([bytes[6], bytes[7]])) * 360.0 / 32_767.0
        };
        assert!((row[6].parse::<f64>()? - degrees).abs() < 1.5, "{row:?}");
    }
    assert!(
        undetermined * 4 < table.rows.len(),
        "{undetermined} of {} rows say neither",
        table.rows.len()
    );
    Ok(())
}

#[test]
fn the_last_minutes_can_be_exported_though_nobody_recorded() -> Result<()> {
    let scenario = Scenario::spinning()?;
    let page = &scenario.page;
    page.press("Escape")?;
    wait_for_speed(page, 0..=0)?;
    page.click("button", "Release")?;
    disconnect(&scenario)?;
    page.open_panel("Recording")?;
    let file = page.download("Export telemetry CSV")?;
    assert!(file.bytes()?.is_ascii());
    let table = Table::read(&file)?;
    let replies = undisturbed_replies(&scenario.adapter.wire()?);
    assert!(replies.iter().any(|reply| reply.queried));
    assert!(replies.iter().any(|reply| !reply.queried));
    assert_rows_are_replies(&table, &replies)?;
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn a_recording_has_one_row_a_reply_from_press_to_press() -> Result<()> {
    let scenario = Scenario::spinning()?;
    let page = &scenario.page;
    page.open_panel("Recording")?;
    let before = now_us();
    page.click("button", "Record telemetry")?;
    let began = now_us();
    thread::sleep(Duration::from_secs(2));
    let ending = now_us();
    page.click("button", "Stop recording")?;
    let ended = now_us();
    wait_until_enabled(page, "button", "Export telemetry CSV", true)?;
    let table = Table::read(&page.download("Export telemetry CSV")?)?;
    let replies = undisturbed_replies(&scenario.adapter.wire()?);
    let raw = table.column("raw_hex")?;
    let is_run = |run: &[Reply]| {
        run.iter()
            .zip(&raw)
            .all(|(reply, row)| hex(&reply.frame) == **row)
    };
    let run = replies.windows(raw.len()).find(|run| is_run(run));
    let run = run.context("the rows are no run of replies without a gap")?;
    // A reply that was on the wire before the press may be heard behind it.
    let heard_within = 500_000;
    let (first, last) = (run[0].frame.at_us, run[run.len() - 1].frame.at_us);
    let at_begin = before - heard_within..began + heard_within;
    let at_end = ending - heard_within..ended;
    assert!(at_begin.contains(&first), "{first} not in {at_begin:?}");
    assert!(at_end.contains(&last), "{last} not in {at_end:?}");
    assert_rows_are_replies(&table, run)?;
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn a_reply_that_is_lost_is_no_row() -> Result<()> {
    let line = Line::default().with(&["--loss", "0.1", "--seed", "7"]);
    let scenario = Scenario::connected(line)?;
    let page = &scenario.page;
    page.wait_for_text("output", "Link", |text| number(text).is_some())?;
    thread::sleep(Duration::from_secs(3));
    disconnect(&scenario)?;
    page.open_panel("Recording")?;
    let table = Table::read(&page.download("Export telemetry CSV")?)?;
    let wire = scenario.adapter.wire()?;
    let requests = wire
        .from_host()
        .frames
        .iter()
        .filter(|frame| asks(frame))
        .count();
    let rows = table.rows.len();
    assert!(
        rows > 10 && rows < requests,
        "{rows} rows, {requests} requests"
    );
    // None is repeated: each has its own moment.
    let times = table.column("timestamp")?;
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{times:?}");
    Ok(())
}

fn asks(frame: &Frame) -> bool {
    matches!(frame.bytes.get(1), Some(0x64 | 0x74))
}
