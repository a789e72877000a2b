//! Who is on the line, and under which number.

use std::time::Duration;

use crate::fixture::{
    Scenario, assert_quiet_console, wait_for_speed, wait_for_wire, wait_until_enabled,
};
use anyhow::{Context, Result};
use end_to_end::{Frame, Line, Page, WAIT_MAX, WireLog, now_us, retry, wait_until};

/// With the tab open in which motors are found.
fn in_the_id_manager(line: Line) -> Result<Scenario> {
    let scenario = Scenario::connected(line)?;
    scenario.page.open_panel("ID Manager")?;
    Ok(scenario)
}

/// On a busy machine replies come late, windows are long and silent addresses are asked four times.
const SCAN_MAX: Duration = Duration::from_secs(120);

/// Presses Full scan. Where several motors answered at once, a notice offers one, too.
fn press_full_scan(page: &Page) -> Result<()> {
    page.find_all("button", "Full scan")?
        .pop()
        .context("no button Full scan")?
        .click()
}

/// Presses Full scan and waits for its end.
fn scan_fully(page: &Page) -> Result<()> {
    press_full_scan(page)?;
    wait_until_enabled(page, "button", "Cancel", true)?;
    wait_for_end_of_scan(page)
}

fn wait_for_end_of_scan(page: &Page) -> Result<()> {
    wait_until("the scan to end", SCAN_MAX, || {
        let cancel = page.find("button", "Cancel")?;
        Ok(if cancel.disabled {
            Ok(())
        } else {
            Err(page.text("progressbar", "Scan")?)
        })
    })
}

/// The IDs of the list of motors, as it names them.
fn motors_found(page: &Page) -> Result<Vec<u8>> {
    let items = page.find("list", "Motors found")?.items()?;
    let id = |item: &String| {
        let hex = item.split("0x").nth(1)?.get(..2)?;
        u8::from_str_radix(hex, 16).ok()
    };
    Ok(items.iter().filter_map(id).collect())
}

fn is_set_id(frame: &Frame) -> bool {
    frame.bytes.starts_with(&[0xAA, 0x55, 0x53])
}

fn set_ids(wire: &WireLog) -> usize {
    let host = wire.from_host();
    host.frames.iter().filter(|frame| is_set_id(frame)).count()
}

#[test]
fn a_full_scan_finds_three_motors_and_invents_none() -> Result<()> {
    let scenario = in_the_id_manager(Line::with_motors(&[1, 42, 254]))?;
    let page = &scenario.page;
    let pressed = now_us();
    scan_fully(page)?;
    wait_until("all three motors in the list", WAIT_MAX, || {
        let found = motors_found(page)?;
        Ok(if found == [1, 42, 254] {
            Ok(())
        } else {
            Err(format!("{found:?}"))
        })
    })?;
    // Every address was asked.
    let asked = scenario.since(pressed)?.from_host();
    for address in 1..=254 {
        let queried = |frame: &Frame| frame.bytes[..2] == [address, 0x74];
        assert!(asked.frames.iter().any(queried), "{address} was not asked");
    }
    // A click selects one, and it is the one that is driven.
    let chosen = now_us();
    page.find_like("button", "0x2A · 42")?.click()?;
    page.open_panel("Telemetry")?;
    page.wait_for_text("output", "Speed", |text| {
        crate::fixture::number(text).is_some()
    })?;
    assert!(page.find("combobox", "Motor")?.value.contains("0x2A"));
    page.click("tab", "Velocity")?;
    page.click("button", "+50")?;
    wait_for_speed(page, 47..=53)?;
    let drives = scenario.since(chosen)?.drives();
    assert!(
        drives.frames.iter().all(|frame| frame.id() == Some(42)),
        "{drives}"
    );
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn a_scan_tells_how_far_it_is_and_ends_at_once_when_cancelled() -> Result<()> {
    // Silent addresses are waited for longer where bytes are held, so there is time to cancel.
    let line = Line::with_motors(&[1]).with(&["--latency-ms", "16"]);
    let scenario = in_the_id_manager(line)?;
    let page = &scenario.page;
    let pressed = now_us();
    press_full_scan(page)?;
    wait_for_wire(&scenario, pressed, "a scan at address 20", |wire| {
        !wire.of_motor(20).is_empty()
    })?;
    wait_until("progress", WAIT_MAX, || {
        let asked = page.find("progressbar", "Scan")?.value;
        let some = asked.parse::<f64>().is_ok_and(|asked| asked > 0.0);
        Ok(if some { Ok(()) } else { Err(asked) })
    })?;
    page.click("button", "Cancel")?;
    wait_until_enabled(page, "button", "Full scan", true)?;
    let ended = now_us();
    // The motor that is watched is asked on; nobody else is.
    let wire = wait_for_wire(&scenario, ended, "twenty more requests", |wire| {
        wire.from_host().len() >= 20
    })?;
    let host = wire.from_host();
    assert!(
        host.frames.iter().all(|frame| frame.id() == Some(1)),
        "{host}"
    );
    // It was cut short.
    assert!(scenario.since(pressed)?.of_motor(254).is_empty());
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn what_is_driven_stands_before_anybody_else_is_asked() -> Result<()> {
    let scenario = Scenario::spinning()?;
    let page = &scenario.page;
    page.open_panel("ID Manager")?;
    let pressed = now_us();
    press_full_scan(page)?;
    let wire = wait_for_wire(&scenario, pressed, "another address to be asked", |wire| {
        !wire.of_motor(9).is_empty()
    })?;
    let first = wire.of_motor(9).first().unwrap().at_us;
    let before = wire.until(first);
    crate::fixture::assert_ends_braked(&before);
    let last = before.from_motors().last().unwrap().bytes.clone();
    let rpm = i16::from_be_bytes([last[4], last[5]]);
    assert_eq!(rpm, 0, "{before}");
    wait_for_end_of_scan(page)?;
    // A scan restores nothing.
    let drives = scenario.since(first)?.drives();
    assert!(drives.is_empty(), "{drives}");
    Ok(())
}

#[test]
fn a_scan_names_one_motor_and_tells_when_several_answer() -> Result<()> {
    let scenario = in_the_id_manager(Line::with_motors(&[7]))?;
    on_a_busy_machine(|| {
        scenario.page.click("button", "Scan")?;
        let said = scenario
            .page
            .wait_for_text("status", "Scan result", |text| {
                ["found", "replied", "No motors"]
                    .iter()
                    .any(|end| text.contains(end))
            })?;
        Ok(if said.contains("0x07 found") {
            Ok(())
        } else {
            Err(said)
        })
    })?;
    assert_eq!(motors_found(&scenario.page)?, [7]);
    drop(scenario);

    let scenario = in_the_id_manager(Line::with_motors(&[1, 2, 3]))?;
    scenario.page.click("button", "Scan")?;
    let said = |text: &str| text.contains("everal motors") && text.contains("Full scan");
    scenario.page.wait_for_text("status", "Scan result", said)?;
    assert_quiet_console(&scenario.page);
    Ok(())
}

/// Enters a new ID, and waits until the question is asked whether it is meant.
fn propose_id(page: &Page, id: u8) -> Result<()> {
    page.fill("spinbutton", "New ID", &id.to_string())?;
    on_a_busy_machine(|| {
        page.click("button", "Set ID")?;
        wait_until(&format!("an end of the scan for ID {id}"), SCAN_MAX, || {
            if !page.find_all("alertdialog", "Change the ID?")?.is_empty() {
                return Ok(Ok(Ok(())));
            }
            // None while the question is opening: what is behind it is out of reach.
            let Some(status) = page.find_all("status", "Scan result")?.pop() else {
                return Ok(Err("a question".to_owned()));
            };
            let said = status.text()?;
            Ok(if said.contains("not changed") {
                Ok(Err(said))
            } else {
                Err(said)
            })
        })
    })
}

/// Enters a new ID and agrees to it; what is said then.
fn set_id(page: &Page, id: u8, wanted: &str) -> Result<()> {
    on_a_busy_machine(|| {
        propose_id(page, id)?;
        page.click("button", &format!("Set ID 0x{id:02X}"))?;
        let ended = |text: &str| text.contains(wanted) || text.contains("not changed");
        let said = page.wait_for_text("status", "Scan result", ended)?;
        Ok(if said.contains(wanted) {
            Ok(())
        } else {
            Err(said)
        })
    })
}

/// Does again what a line on a busy machine refuses, since replies came late there. A person would, too: the page
/// says so.
fn on_a_busy_machine(act: impl FnMut() -> Result<Result<(), String>>) -> Result<()> {
    retry("scan or set an ID", 3, act)
}

#[test]
fn an_id_change_survives_reconnecting() -> Result<()> {
    let scenario = in_the_id_manager(Line::default())?;
    let page = &scenario.page;
    let pressed = now_us();
    propose_id(page, 5)?;
    let question = page.text("alertdialog", "Change the ID?")?;
    for words in ["0x01", "0x05", "flash", "power-off"] {
        assert!(question.contains(words), "{question}");
    }
    assert_eq!(
        set_ids(&scenario.since(pressed)?),
        0,
        "before a person agreed"
    );
    page.press("Escape")?;
    assert!(page.find_all("alertdialog", "Stopped")?.is_empty());
    assert_eq!(
        set_ids(&scenario.since(pressed)?),
        0,
        "Escape is no consent"
    );
    set_id(page, 5, "Motor 0x01 now has ID 0x05")?;
    // Five in a row, with nothing between them, and each as the maker sends it.
    let wire = scenario.since(pressed)?;
    let host = wire.from_host();
    let first = host.frames.iter().position(is_set_id).unwrap();
    assert_eq!(set_ids(&wire), 5);
    for frame in &host.frames[first..first + 5] {
        assert_eq!(
            frame.bytes,
            [0xAA, 0x55, 0x53, 5, 0, 0, 0, 0, 0, 0],
            "{host}"
        );
    }
    // The new ID was heard, and the old one asked for.
    let after = wire.since(host.frames[first + 4].at_us);
    assert!(!after.from_motors().of_motor(5).is_empty(), "{after}");
    assert!(!after.from_host().of_motor(1).is_empty(), "{after}");
    assert!(after.from_motors().of_motor(1).is_empty(), "{after}");

    page.click("button", "Disconnect")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Disconnected"))?;
    let again = now_us();
    crate::fixture::connect(page)?;
    assert!(page.find("combobox", "Motor")?.value.contains("0x05"));
    page.click("tab", "Velocity")?;
    page.click("button", "+50")?;
    wait_for_speed(page, 47..=53)?;
    let drives = scenario.since(again)?.drives();
    assert!(
        drives.frames.iter().all(|frame| frame.id() == Some(5)),
        "{drives}"
    );
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn a_motor_that_has_taken_an_id_takes_the_next_after_power_off() -> Result<()> {
    let mut scenario = in_the_id_manager(Line::default())?;
    set_id(&scenario.page, 5, "now has ID 0x05")?;
    set_id(&scenario.page, 6, "0x05 did not change its ID")?;
    let said = scenario.page.text("status", "Scan result")?;
    assert!(said.contains("ower-cycle the motor"), "{said}");
    scenario.adapter.act("power 5 off")?;
    scenario.adapter.act("power 5 on")?;
    set_id(&scenario.page, 6, "now has ID 0x06")?;
    assert_quiet_console(&scenario.page);
    Ok(())
}

/// M0601 units are reported to take more than five frames.
#[test]
fn a_motor_that_needs_more_frames_is_offered_them_and_takes_them() -> Result<()> {
    let line = Line::default().with(&["--set-id-frames", "8"]);
    let scenario = in_the_id_manager(line)?;
    let page = &scenario.page;
    assert!(page.find_all("button", "Send 10 frames")?.is_empty());
    set_id(page, 5, "Motor 0x01 did not change its ID")?;
    let pressed = now_us();
    page.click("button", "Send 10 frames")?;
    page.wait_for_text_within(SCAN_MAX, "alertdialog", "Change the ID?", |text| {
        text.contains("10 frames")
    })?;
    assert_eq!(
        set_ids(&scenario.since(pressed)?),
        0,
        "before a person agreed"
    );
    page.click("button", "Set ID 0x05")?;
    page.wait_for_text("status", "Scan result", |text| {
        text.contains("Motor 0x01 now has ID 0x05")
    })?;
    assert_eq!(set_ids(&scenario.since(pressed)?), 10);
    assert!(page.find_all("button", "Send 10 frames")?.is_empty());
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn an_id_is_not_set_where_two_motors_would_hear_it() -> Result<()> {
    let scenario = in_the_id_manager(Line::with_motors(&[1, 2]))?;
    let page = &scenario.page;
    page.fill("spinbutton", "New ID", "5")?;
    page.click("button", "Set ID")?;
    page.wait_for_text_within(SCAN_MAX, "status", "Scan result", |text| {
        text.contains("not changed") && text.contains("2 motors")
    })?;
    assert!(page.find_all("alertdialog", "Change the ID?")?.is_empty());
    let wire = scenario.adapter.wire()?;
    assert_eq!(set_ids(&wire), 0, "{wire}");
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn an_id_that_no_motor_may_have_is_refused_where_it_is_typed() -> Result<()> {
    let scenario = in_the_id_manager(Line::default())?;
    let page = &scenario.page;
    for (id, why) in [
        ("200", "ID query"),
        ("0", "0"),
        ("255", "254"),
        ("0xC8", "ID query"),
    ] {
        page.fill("spinbutton", "New ID", id)?;
        wait_until_enabled(page, "button", "Set ID", false)?;
        let field = page.find("spinbutton", "New ID")?;
        assert!(
            field.description.contains(why),
            "{id}: {}",
            field.description
        );
    }
    // That which it has already is no change.
    page.fill("spinbutton", "New ID", "1")?;
    wait_until_enabled(page, "button", "Set ID", false)?;
    page.fill("spinbutton", "New ID", "5")?;
    wait_until_enabled(page, "button", "Set ID", true)?;
    assert_eq!(set_ids(&scenario.adapter.wire()?), 0);
    assert_quiet_console(page);
    Ok(())
}
