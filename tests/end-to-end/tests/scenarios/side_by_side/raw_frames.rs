//! Talking to a motor byte by byte.

use std::{thread, time::Duration};

use crate::fixture::{
    Scenario, assert_ends_braked, assert_quiet_console, exports::hex, tick, wait_for_speed,
    wait_for_wire,
};
use anyhow::Result;
use end_to_end::{Frame, Line, Page, WAIT_MAX, now_us, retry, wait_until};

/// A feedback query for motor 1 without its CRC, which is 04.
const QUERY: &str = "01 74 00 00 00 00 00 00 00";
/// A drive frame, 100 rpm, without its CRC, which is 4F.
const DRIVE: &str = "01 64 00 64 00 00 00 00 00";

fn in_the_editor() -> Result<Scenario> {
    let scenario = Scenario::connected(Line::default())?;
    scenario.page.open_panel("Raw Hex")?;
    Ok(scenario)
}

fn type_bytes(page: &Page, text: &str) -> Result<()> {
    page.find("textbox", "Frame bytes")?.type_over(text)
}

/// On a busy machine a reply may come too late to be one: then the query is sent again.
fn press_until_answered(page: &Page) -> Result<String> {
    retry("press Send", PRESSES_MAX, || {
        page.click("button", "Send")?;
        // What is said of the press before is not of this one.
        thread::sleep(Duration::from_millis(500));
        let said = |text: &str| text.contains("01 02") || text.contains("No reply");
        let answer = page.wait_for_text("output", "Reply", said)?;
        Ok(if answer.contains("01 02") {
            Ok(answer)
        } else {
            Err(answer)
        })
    })
}

const PRESSES_MAX: u32 = 3;

#[test]
fn nine_bytes_get_their_crc_and_the_answer_stands_beside_them() -> Result<()> {
    let scenario = in_the_editor()?;
    let page = &scenario.page;
    type_bytes(page, QUERY)?;
    page.wait_for_text("output", "Frame with CRC", |text| {
        text.contains("CRC") && text.contains("04")
    })?;
    let pressed = now_us();
    let answer = press_until_answered(page)?;
    // What it shows was on the wire, behind a query.
    let wire = scenario.since(pressed)?;
    let mut replies = wire.frames.windows(2).filter_map(|pair| {
        let queried = hex(&pair[0]) == format!("{QUERY} 04");
        queried.then(|| hex(&pair[1]))
    });
    assert!(
        replies.any(|reply| answer.contains(&reply)),
        "{answer}\n{wire}"
    );
    // The answer goes with the bytes that it answered.
    type_bytes(page, "02 74")?;
    page.wait_for_text("output", "Reply", |text| text.contains("appears here"))?;
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn a_frame_sent_by_hand_is_in_the_log_whatever_is_collapsed_or_filtered() -> Result<()> {
    let scenario = in_the_editor()?;
    let page = &scenario.page;
    let entries = page.wait_for_text("output", "Entries", |text| text.contains("collapsed"))?;
    page.wait_for_text("log", "Packets", |text| !text.contains(QUERY))?;
    type_bytes(page, QUERY)?;
    page.click("button", "Send")?;
    // With its reply, whose row is counted below.
    page.wait_for_text("log", "Packets", |text| {
        let after = text.split_once(QUERY).map(|(_, after)| after);
        after.is_some_and(|after| after.contains("RX"))
    })?;
    assert!(entries.contains("collapsed"), "{entries}");

    // What was collapsed before it is opened in its place, and collapsed again, by keyboard.
    let toggle = |opened: bool| {
        let sign = if opened { "\u{2212}" } else { "+" };
        format!(
            "[...document.querySelectorAll('.packet-before:not([hidden])')].findLast((it) => \
                it.textContent.startsWith('{sign}') && it.ariaExpanded === '{opened}')"
        )
    };
    let rows = "document.querySelectorAll('.packet-meaning:not(:empty)').length";
    let name = page.evaluate(&format!("{}.ariaLabel", toggle(false)))?;
    assert!(name.to_string().contains("collapsed frame"), "{name}");
    page.evaluate(&format!("{}.focus()", toggle(false)))?;
    page.press("Enter")?;
    wait_until("the collapsed frames in their place", WAIT_MAX, || {
        let opened = page.evaluate("document.activeElement.ariaExpanded")?;
        Ok(if opened == "true" {
            Ok(())
        } else {
            Err(opened.to_string())
        })
    })?;
    let opened = page.evaluate(rows)?;
    page.press("Enter")?;
    wait_until("fewer rows than opened", WAIT_MAX, || {
        let rows = page.evaluate(rows)?;
        let closed = page.evaluate("document.activeElement.ariaExpanded")? == "false";
        Ok(if closed && rows.as_u64() < opened.as_u64() {
            Ok(())
        } else {
            Err(format!("{rows} of {opened}"))
        })
    })?;

    page.find("searchbox", "Filter")?
        .type_over("no such text")?;
    page.wait_for_text("log", "Packets", |text| {
        text.contains(QUERY) && text.matches("TX").count() == 1
    })?;

    // Nor does Clear lose it for good.
    page.find("searchbox", "Filter")?
        .type_over("no such text at all")?;
    page.click("button", "Clear")?;
    page.wait_for_text("log", "Packets", |text| !text.contains(QUERY))?;
    // Longer than a double click.
    thread::sleep(Duration::from_millis(700));
    page.click("button", "Undo")?;
    page.wait_for_text("log", "Packets", |text| text.contains(QUERY))?;
    page.find("button", "Clear")?;
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn a_motor_that_is_not_there_is_said_to_be_silent() -> Result<()> {
    let scenario = in_the_editor()?;
    let page = &scenario.page;
    type_bytes(page, "0x09,0x74,0,0,0,0,0,0,0")?;
    // Single digits are either half of a byte: what is wrong is said.
    assert!(page.find("button", "Send")?.disabled);
    type_bytes(page, "0x09,0x74,00,00,00,00,00,00,00")?;
    let pressed = now_us();
    page.click("button", "Send")?;
    page.wait_for_text("output", "Reply", |text| text.contains("No reply"))?;
    let wire = scenario.since(pressed)?;
    assert_eq!(wire.of_motor(9).from_host().len(), 1, "{wire}");
    assert!(wire.of_motor(9).from_motors().is_empty(), "{wire}");
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn ten_bytes_are_sent_as_they_are() -> Result<()> {
    let scenario = in_the_editor()?;
    let page = &scenario.page;
    type_bytes(page, &format!("{QUERY} FF"))?;
    page.wait_for_text("output", "Frame with CRC", |text| text.contains("bad CRC"))?;
    let pressed = now_us();
    page.click("button", "Send")?;
    agree(page)?;
    wait_for_wire(&scenario, pressed, "the frame with the wrong CRC", |wire| {
        let wrong = |frame: &Frame| hex(frame) == format!("{QUERY} FF");
        wire.from_host().frames.iter().any(wrong)
    })?;
    page.wait_for_text("output", "Reply", |text| text.contains("No reply"))?;
    assert_quiet_console(page);
    Ok(())
}

/// Says yes to a frame that may move the wheel.
fn agree(page: &Page) -> Result<()> {
    page.wait_for_text("alertdialog", "Send this frame?", |text| !text.is_empty())?;
    page.click("button", "Send it")
}

#[test]
fn a_frame_that_moves_the_wheel_asks_first_and_space_stops_it() -> Result<()> {
    let scenario = in_the_editor()?;
    let page = &scenario.page;
    type_bytes(page, DRIVE)?;
    page.click("checkbox", "Repeat")?;
    page.fill("spinbutton", "Count", "0")?;
    page.fill("spinbutton", "Interval", "20")?;
    let pressed = now_us();
    page.click("button", "Send")?;
    page.wait_for_text("alertdialog", "Send this frame?", |text| {
        text.contains("Space")
    })?;
    assert!(
        scenario.since(pressed)?.drives().is_empty(),
        "nobody agreed"
    );
    page.click("button", "Send it")?;
    wait_for_speed(page, 97..=103)?;
    // On its period: 25 frames take half a second.
    let wire = wait_for_wire(&scenario, pressed, "25 drive frames", |wire| {
        wire.drives().len() >= 25
    })?;
    let drives = wire.drives();
    assert!(
        drives
            .frames
            .iter()
            .all(|frame| hex(frame) == format!("{DRIVE} 4F")),
        "{drives}"
    );
    let median = drives.gaps().unwrap().median_us;
    assert!((18_000..=22_000).contains(&median), "{median} us apart");

    page.evaluate("document.activeElement?.blur()")?;
    let stopped = now_us();
    page.press(" ")?;
    page.wait_for_text("alertdialog", "Stopped", |text| {
        text.to_lowercase().contains("confirmed")
    })?;
    wait_for_speed(page, 0..=0)?;
    assert_ends_braked(&scenario.since(stopped)?);
    scenario.stays_undriven(Duration::from_secs(1))?;
    page.click("button", "Release")?;
    scenario.stays_undriven(Duration::from_secs(1))?;

    // It was asked once; the editor's own Stop stops the wheel too.
    page.open_panel("Raw Hex")?;
    page.click("button", "Send")?;
    wait_for_speed(page, 97..=103)?;
    page.open_panel("Raw Hex")?;
    let stopped = now_us();
    page.click("button", "Stop")?;
    wait_for_speed(page, 0..=0)?;
    assert_ends_braked(&scenario.since(stopped)?);
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn a_frame_is_repeated_as_often_as_it_says() -> Result<()> {
    let scenario = in_the_editor()?;
    let page = &scenario.page;
    type_bytes(page, "097400000000000000")?;
    tick(page, "Repeat", true)?;
    page.fill("spinbutton", "Count", "7")?;
    page.fill("spinbutton", "Interval", "30")?;
    let pressed = now_us();
    page.click("button", "Send")?;
    page.wait_for_text("output", "Reply", |text| text.contains("7 of 7"))?;
    let sent = scenario.since(pressed)?.from_host().of_motor(9);
    assert_eq!(sent.len(), 7, "{sent}");
    assert_quiet_console(page);
    Ok(())
}
