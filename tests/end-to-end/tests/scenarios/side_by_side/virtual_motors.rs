//! Virtual motors of each model, as many as one likes.

use anyhow::Result;
use end_to_end::{Bench, Page, View, WAIT_MAX, wait_until};

use crate::fixture::{
    assert_quiet_console, number,
    places::{STOP, in_sight, look},
    wait_until_enabled,
};

/// The status `Connection` says so, and this many motors report their speed.
fn wait_for_motors(page: &Page, connection: &str, count: usize) -> Result<()> {
    page.wait_for_text("status", "Connection", |text| text.contains(connection))?;
    wait_until(&format!("{count} motors"), WAIT_MAX, || {
        let speeds = figures(page, "speed")?;
        let reported = speeds.iter().filter(|text| number(text).is_some()).count();
        Ok((reported == count && speeds.len() == count)
            .then_some(())
            .ok_or_else(|| format!("{speeds:?}")))
    })
}

/// A figure of every motor in the strip, in the order of their IDs.
fn figures(page: &Page, figure: &str) -> Result<Vec<String>> {
    let found = page.evaluate(&format!(
        "[...document.querySelectorAll('.motor-chip [data-figure={figure}]')].map((it) => it.textContent)"
    ))?;
    Ok(serde_json::from_value(found)?)
}

fn names(page: &Page) -> Result<Vec<String>> {
    let found = page.evaluate(
        "[...document.querySelectorAll('.motor-chip-button')].map((it) => it.ariaLabel)",
    )?;
    Ok(serde_json::from_value(found)?)
}

/// An address opens a rover; its wheels have names and sides and drive as a group. The names of a real rover
/// stay as they were entered.
#[test]
fn an_address_opens_a_rover_that_drives_and_a_real_one_keeps_its_names() -> Result<()> {
    let bench = Bench::reuse()?;
    let page = bench.open("/")?;
    page.evaluate("localStorage.setItem('motorlink.fleet', '1\\tyes\\tright\\tReal wheel\\n')")?;
    page.go(&format!(
        "{}/?port=virtual&motors=4&model=ddsm315",
        bench.origin()
    ))?;
    wait_for_motors(&page, "4 virtual DDSM315", 4)?;
    assert_eq!(
        names(&page)?,
        [
            "Motor 0x01, Front left, left",
            "Motor 0x02, Front right, right, mirrored",
            "Motor 0x03, Rear left, left",
            "Motor 0x04, Rear right, right, mirrored",
        ]
    );
    page.open_panel("Drive together")?;
    page.fill("spinbutton", "Group speed", "60")?;
    page.press("Enter")?;
    page.click("button", "Start group")?;
    wait_until("four wheels at 60 rpm forward", WAIT_MAX, || {
        let speeds = figures(&page, "speed")?;
        let forward = |text: &String| number(text).is_some_and(|rpm| (55.0..=65.0).contains(&rpm));
        Ok((speeds.len() == 4 && speeds.iter().all(forward))
            .then_some(())
            .ok_or_else(|| format!("{speeds:?}")))
    })?;
    page.press("Escape")?;
    page.wait_for_text("output", "Forward", |text| text.starts_with("0.00"))?;
    page.click("button", "Release")?;
    page.click("button", "Disconnect")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Disconnected"))?;
    let side = "document.getElementById('side-1')?.value ?? ''";
    wait_until("the side of the real wheel", WAIT_MAX, || {
        let side = page.evaluate(side)?;
        Ok((side == "right")
            .then_some(())
            .ok_or_else(|| side.to_string()))
    })?;
    assert_quiet_console(&page);
    Ok(())
}

#[test]
fn an_address_that_names_no_virtual_motors_says_which_there_are() -> Result<()> {
    let bench = Bench::reuse()?;
    for (address, bad, possible) in [
        (
            "/?port=virtual&motors=4&model=foo",
            "model=foo",
            "ddsm115, ddsm315, ddsm210, ddsm400",
        ),
        (
            "/?port=virtual&motors=99",
            "motors=99",
            "1, 2, 4, 8, faults",
        ),
    ] {
        let page = bench.open(address)?;
        page.wait_for_text("region", "Notices", |text| {
            text.contains(bad) && text.contains(possible)
        })?;
        page.wait_for_text("status", "Connection", |text| text.contains("Disconnected"))?;
        bench.close(page)?;
    }
    Ok(())
}

/// By keyboard on a desktop, by finger on a phone; the button `Virtual motor` connects the last choice.
#[test]
fn the_virtual_motors_are_chosen_in_a_menu_and_remembered() -> Result<()> {
    let bench = Bench::reuse()?;
    let page = bench.open("/")?;
    page.find("button", "Virtual motors")?.focus()?;
    page.press("Enter")?;
    page.find("region", "Virtual motors")?;
    page.find("radio", "One of each fault")?.focus()?;
    page.press(" ")?;
    page.choose("Model of the virtual motors", "DDSM115 · M0601")?;
    page.find("button", "Connect virtual motors")?.focus()?;
    page.press("Enter")?;
    wait_for_motors(&page, "5 virtual DDSM115", 5)?;
    let all = names(&page)?;
    assert_eq!(all[3], "Motor 0x04, Stall");
    let faults = figures(&page, "faults")?;
    assert!(
        faults
            .iter()
            .zip(&all)
            .all(|(fault, _)| fault != "OK" && !fault.is_empty()),
        "{faults:?}"
    );

    page.click("button", "Skip the tour")?;
    look(&page, View::PHONE)?;
    page.click("button", "Setup")?;
    page.click("button", "Virtual motors")?;
    in_sight(&page, View::PHONE, "button", "Connect virtual motors")?;
    in_sight(&page, View::PHONE, STOP.0, STOP.1)?;
    page.click("radio", "Two wheels: left, right")?;
    page.click("button", "Connect virtual motors")?;
    wait_for_motors(&page, "2 virtual DDSM115", 2)?;

    page.reload()?;
    page.click("button", "Virtual motor")?;
    wait_for_motors(&page, "2 virtual DDSM115", 2)?;
    assert_quiet_console(&page);
    Ok(())
}

/// The tread stands, and the marks turn.
#[test]
fn a_person_who_wants_less_motion_sees_a_pointer_turn() -> Result<()> {
    let bench = Bench::reuse()?;
    let page = bench.open("/")?;
    page.want_less_motion()?;
    page.go(&format!("{}/?port=virtual", bench.origin()))?;
    page.wait_for_text("output", "Speed", |text| number(text).is_some())?;
    wait_until_enabled(&page, "button", "Start", true)?;
    page.press("f")?;
    let turned = |part: &str| -> Result<f64> {
        let angle = format!(
            "(() => {{ const m = new DOMMatrix(getComputedStyle(document.querySelector('{part}')).transform); \
             return Math.atan2(m.b, m.a); }})()"
        );
        Ok(serde_json::from_value(page.evaluate(&angle)?)?)
    };
    let first = turned(".twin-pointer")?;
    wait_until("the marks to turn", WAIT_MAX, || {
        let angle = turned(".twin-pointer")?;
        Ok(((angle - first).abs() > 0.5)
            .then_some(())
            .ok_or_else(|| angle.to_string()))
    })?;
    let wheel = turned(".twin-turning")?;
    assert!(wheel.abs() < f64::EPSILON, "the wheel is at {wheel}");
    page.press("Escape")?;
    assert_quiet_console(&page);
    Ok(())
}
