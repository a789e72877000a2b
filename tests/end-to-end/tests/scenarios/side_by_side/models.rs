//! The siblings of the DDSM115, each on its own line: found by the page, driven and stopped in each loop, given
//! another ID, and kept within limits.

use std::time::Duration;

use crate::fixture::{
    Scenario, assert_quiet_console, number, rules, spin, wait_for_speed, wait_until_enabled,
};
use anyhow::Result;
use end_to_end::{Bench, Frame, Line, Page, Usb, now_us, retry, wait_until};
use serde_json::json;

const SCAN_MAX: Duration = Duration::from_secs(60);
/// A switch and a quarter turn take half a second; a busy page shows it a little later.
const DONE_MAX: Duration = Duration::from_secs(5);
const PRESSES_MAX: u32 = 3;

/// A model with the actions of the user and what the page shows for it.
struct Case {
    model: &'static str,
    /// As the page finds it.
    found: &'static str,
    /// The option that the user chooses, if the page finds another model.
    chosen: Option<&'static str>,
    /// The value of a drive frame at +50 rpm.
    at_50_rpm: i16,
    /// Whether an angle counts from where the position loop was entered.
    relative: bool,
    loops: &'static [Loop],
}

/// A loop with a setpoint that turns a free wheel.
struct Loop {
    tab: &'static str,
    field: &'static str,
    setpoint: &'static str,
}

const OPEN_LOOP: Loop = Loop {
    tab: "Open loop",
    field: "Target output",
    // A fifth of the supply.
    setpoint: "6553",
};
/// 15 mA: the free wheel gains 40 rpm in a second, and stays below the speed limit.
const CURRENT: Loop = Loop {
    tab: "Current",
    field: "Raw current",
    setpoint: "60",
};
const POSITION: Loop = Loop {
    tab: "Position",
    field: "Target angle",
    setpoint: "90",
};

const DDSM210: Case = Case {
    model: "ddsm210",
    found: "DDSM210",
    chosen: None,
    at_50_rpm: 500,
    relative: true,
    loops: &[OPEN_LOOP, POSITION],
};
const DDSM400: Case = Case {
    model: "ddsm400",
    found: "DDSM400",
    chosen: None,
    at_50_rpm: 500,
    relative: true,
    loops: &[OPEN_LOOP, CURRENT, POSITION],
};
/// Its frames are those of a DDSM115.
const DDSM315: Case = Case {
    model: "ddsm315",
    found: "DDSM115",
    chosen: Some("DDSM315 / M0602C"),
    at_50_rpm: 50,
    relative: false,
    loops: &[CURRENT, POSITION],
};

#[test]
fn a_ddsm210_is_found_driven_in_each_loop_stopped_limited_and_given_an_id() -> Result<()> {
    operate_every_loop(&DDSM210)
}

#[test]
fn a_ddsm400_is_found_enabled_driven_in_each_loop_stopped_limited_and_given_an_id() -> Result<()> {
    operate_every_loop(&DDSM400)
}

#[test]
fn a_ddsm315_is_chosen_driven_in_each_loop_stopped_limited_and_given_an_id() -> Result<()> {
    operate_every_loop(&DDSM315)
}

/// The page tries each baud rate, and the board answers at both. The page reports neither a motor nor noise.
#[test]
fn a_driver_board_in_json_mode_is_reported_with_its_switch() -> Result<()> {
    let bench = Bench::reuse()?;
    let _board = bench.plug(Line::default().with(&["--json"]), Usb::default())?;
    let page = bench.open("/")?;
    page.click("button", "Connect motor")?;
    page.wait_for_text("region", "Notices", |text| {
        text.contains("JSON") && text.contains("away from ESP32")
    })?;
    assert_quiet_console(&page);
    Ok(())
}

/// Whether a long figure of the current lies over the scale of its line.
const COVERS_ITS_SCALE: &str = "(() => {
    const figure = document.querySelector('.read-out.current .figure');
    const scale = document.querySelector('.read-out.current .spark-scale');
    const [was, label] = [figure.textContent, scale.dataset.scale];
    const isRaw = figure.nextElementSibling.textContent.includes('raw');
    [figure.textContent, scale.dataset.scale] = isRaw ? ['+20000', '±32768'] : ['+2.00', '±2.00'];
    const [one, two] = [figure, scale].map((part) => part.getBoundingClientRect());
    [figure.textContent, scale.dataset.scale] = [was, label];
    return one.left < two.right && two.left < one.right && one.top < two.bottom && two.top < one.bottom;
})()";

fn operate_every_loop(case: &Case) -> Result<()> {
    let mut scenario = found(case)?;
    let has_current = case.loops.iter().any(|it| it.tab == CURRENT.tab);
    let tabs = scenario.page.find_all("tab", CURRENT.tab)?;
    assert_eq!(tabs.len(), usize::from(has_current));
    velocity(&mut scenario, case.at_50_rpm)?;
    assert_eq!(scenario.page.evaluate(COVERS_ITS_SCALE)?, json!(false));
    for it in case.loops {
        turned_and_stopped(&mut scenario, it, case.relative)?;
    }
    limited(&mut scenario)?;
    given_an_id(&scenario)?;
    assert_quiet_console(&scenario.page);
    Ok(())
}

/// The page has found the model, and the motor answers.
fn found(case: &Case) -> Result<Scenario> {
    let scenario = Scenario::connected(Line::default().with(&["--model", case.model]))?;
    let page = &scenario.page;
    page.wait_for_text("combobox", "Model", |text| text.contains(case.found))?;
    scenario.stays_undriven(Duration::from_millis(500))?;
    if let Some(option) = case.chosen {
        page.choose("Model", option)?;
        // The port is opened again.
        scenario.stays_undriven(Duration::from_secs(1))?;
        wait_until_enabled(page, "button", "+50", true)?;
    }
    Ok(scenario)
}

/// The button that starts the motor in this loop.
fn start(it: &Loop) -> &'static str {
    if it.tab == POSITION.tab {
        "Go"
    } else {
        "Start"
    }
}

/// Presses the button until its effect is seen. If a busy machine delays replies, the page says so and the user presses
/// again.
fn press_until(
    page: &Page,
    button: &str,
    says: &[&str],
    done: impl Fn() -> Result<()>,
) -> Result<()> {
    retry(&format!("press {button}"), PRESSES_MAX, || {
        page.click("button", button)?;
        if done().is_ok() {
            return Ok(Ok(()));
        }
        rules::the_page_says_one_of(page, says)?;
        Ok(Err("the motor was lost for a moment".to_owned()))
    })
}

/// Starts the motor in this loop, waits until its wheel has turned, and stops it with Space.
fn turned_and_stopped(scenario: &mut Scenario, it: &Loop, relative: bool) -> Result<()> {
    let page = &scenario.page;
    page.click("tab", it.tab)?;
    page.fill("spinbutton", it.field, it.setpoint)?;
    let is_position = it.tab == POSITION.tab;
    let before = page.wait_for_text("output", "Position", |text| number(text).is_some())?;
    let zero = number(&before).filter(|_| relative).unwrap_or_default();
    let has_moved = |figure: f64| {
        let from_goal = (figure - zero - 90.0 + 180.0).rem_euclid(360.0) - 180.0;
        if is_position {
            from_goal.abs() < 3.0
        } else {
            figure > 0.0
        }
    };
    let output = if is_position { "Position" } else { "Speed" };
    let unconfirmed = [
        "did not confirm the switch",
        "is still in the",
        "has not confirmed standstill",
    ];
    let says = [&rules::LOST[..], &unconfirmed].concat();
    press_until(page, start(it), &says, || {
        let moved = |text: &str| number(text).is_some_and(has_moved);
        page.wait_for_text_within(DONE_MAX, "output", output, moved)?;
        Ok(())
    })?;
    let stopped = now_us();
    page.press(" ")?;
    page.wait_for_text("alertdialog", "Stopped", |text| {
        text.to_lowercase().contains("confirmed")
    })?;
    let braked = scenario.since(stopped)?.drives();
    assert!(braked.frames.iter().any(Frame::brakes), "{braked}");
    page.click("button", "Release")?;
    wait_for_speed(page, 0..=0)
}

/// Drives in the velocity loop at +50 rpm; the frames are in the unit of the model.
fn velocity(scenario: &mut Scenario, raw: i16) -> Result<()> {
    let page = &scenario.page;
    page.click("tab", "Velocity")?;
    wait_until_enabled(page, "button", "+50", true)?;
    let pressed = now_us();
    spin(page, "+50", 48..=52)?;
    let drives = scenario.since(pressed)?.drives();
    let setpoints = || drives.frames.iter().filter_map(Frame::drive_setpoint);
    assert!(setpoints().any(|setpoint| setpoint == raw), "{drives}");
    assert!(setpoints().all(|setpoint| setpoint <= raw), "{drives}");
    page.wait_for_text("output", "Temperature", |text| {
        text.contains(|c: char| c.is_ascii_digit())
    })?;
    page.click("button", "Stop")?;
    wait_for_speed(page, 0..=0)
}

/// A lowered speed limit stops a faster wheel.
fn limited(scenario: &mut Scenario) -> Result<()> {
    let page = &scenario.page;
    // A stop leaves the motor in the velocity loop.
    page.click("tab", "Velocity")?;
    wait_until_enabled(page, "button", "+50", true)?;
    spin(page, "+50", 48..=52)?;
    page.open_panel("Settings")?;
    page.fill("spinbutton", "Speed limit", "30")?;
    page.wait_for_text("region", "Notices", |text| {
        text.contains("above your limit of 30 rpm")
    })?;
    wait_for_speed(page, 0..=0)?;
    page.open_panel("Settings")?;
    page.fill("spinbutton", "Speed limit", "200")?;
    page.open_panel("Control")
}

/// A scan finds the motor, and it takes another ID.
fn given_an_id(scenario: &Scenario) -> Result<()> {
    let page = &scenario.page;
    page.open_panel("ID Manager")?;
    page.fill("spinbutton", "New ID", "5")?;
    page.click("button", "Set ID")?;
    wait_until("the question for the ID", SCAN_MAX, || {
        let question = page.find_all("alertdialog", "Change the ID?")?.pop();
        Ok(question
            .map(drop)
            .ok_or_else(|| "no question yet".to_owned()))
    })?;
    page.click("button", "Set ID 0x05")?;
    page.wait_for_text("status", "Scan result", |text| {
        text.contains("now has ID 0x05")
    })?;
    Ok(())
}
