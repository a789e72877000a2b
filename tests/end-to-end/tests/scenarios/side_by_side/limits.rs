//! Limits that a person sets, crossed on the wire.

use std::time::Duration;

use crate::fixture::{
    Scenario, assert_ends_braked, assert_quiet_console, wait_for_speed, wait_until_enabled,
};
use anyhow::Result;
use end_to_end::{Line, Page, now_us};

const ABOVE_LIMIT: &str = "Above your speed limit of 60 rpm";

/// It was stopped and said why, the log has it, and nothing drives any more.
fn is_stopped_and_said(scenario: &Scenario, since_us: u64, why: &str) -> Result<()> {
    let page: &Page = &scenario.page;
    page.wait_for_text("region", "Notices", |text| text.contains(why))?;
    page.wait_for_text("log", "Packets", |text| text.contains(why))?;
    wait_for_speed(page, 0..=0)?;
    assert_ends_braked(&scenario.since(since_us)?);
    scenario.stays_undriven(Duration::from_secs(1))?;
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn a_wheel_beyond_its_speed_limit_is_stopped_and_faster_ones_are_not_started() -> Result<()> {
    let scenario = Scenario::spinning()?;
    scenario.page.open_panel("Settings")?;
    let lowered = now_us();
    scenario.page.fill("spinbutton", "Speed limit", "60")?;
    is_stopped_and_said(&scenario, lowered, "above your limit of 60 rpm")?;
    wait_until_enabled(&scenario.page, "button", "+100", false)?;
    let preset = scenario.page.find("button", "+100")?.description;
    assert!(preset.contains(ABOVE_LIMIT), "{preset}");
    // A key is refused by the bus.
    scenario.page.find("button", "+50")?.focus()?;
    scenario.page.press("2")?;
    let refused = |text: &str| text.contains(ABOVE_LIMIT);
    scenario.page.wait_for_text("region", "Notices", refused)?;
    scenario.stays_undriven(Duration::from_secs(1))?;
    scenario.page.click("button", "+50")?;
    wait_for_speed(&scenario.page, 48..=52)
}

#[test]
fn a_hot_motor_is_stopped_before_it_protects_itself() -> Result<()> {
    let mut scenario = Scenario::spinning()?;
    let heated = now_us();
    for celsius in [60, 70, 77] {
        scenario.adapter.act(&format!("temperature 1 {celsius}"))?;
    }
    is_stopped_and_said(&scenario, heated, "above your limit of 75 °C")
}

#[test]
fn limits_are_kept_for_the_next_port_and_the_next_visit() -> Result<()> {
    let scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    page.open_panel("Settings")?;
    page.fill("spinbutton", "Speed limit", "60")?;
    page.click("button", "Disconnect")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Disconnected"))?;
    page.reload()?;
    page.click("button", "Connect motor")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    page.open_panel("Settings")?;
    assert_eq!(page.find("spinbutton", "Speed limit")?.value, "60");
    page.open_panel("Control")?;
    page.wait_for_text("output", "Mode", |text| text.contains("elocity"))?;
    page.press("2")?;
    let refused = |text: &str| text.contains(ABOVE_LIMIT);
    page.wait_for_text("region", "Notices", refused)?;
    scenario.stays_undriven(Duration::from_secs(1))
}

#[test]
fn limits_show_where_one_drives() -> Result<()> {
    let scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    assert!(page.find_all("button", "Limit: 60 rpm")?.is_empty());
    page.open_panel("Settings")?;
    page.fill("spinbutton", "Speed limit", "60")?;
    page.fill("spinbutton", "Temperature limit", "55")?;
    page.open_panel("Control")?;
    page.wait_for_text("output", "Temperature", |text| text.contains("limit 55 °C"))?;
    // The field says it, and so do Start and the message of the panel, without a press.
    page.fill("spinbutton", "Target speed", "61")?;
    wait_until_enabled(page, "button", "Start", false)?;
    let field = page.find("spinbutton", "Target speed")?.description;
    assert!(field.contains(ABOVE_LIMIT), "{field}");
    let message = page.evaluate("document.querySelector('.tab-foot .reason').textContent")?;
    assert!(message.to_string().contains(ABOVE_LIMIT), "{message}");
    // The slider ends there.
    let slider =
        page.evaluate("[...document.querySelectorAll('[type=range]')].map((it) => it.max)[0]")?;
    assert_eq!(slider, "60");
    page.find("slider", "Target speed")?.focus()?;
    page.press("Home")?;
    assert_eq!(page.find("spinbutton", "Target speed")?.value, "-60");
    page.press("End")?;
    assert_eq!(page.find("spinbutton", "Target speed")?.value, "60");
    wait_until_enabled(page, "button", "Start", true)?;
    // The way to Settings.
    page.click("button", "Limit: 60 rpm")?;
    page.find("spinbutton", "Speed limit")?;
    // The slider of the current loop ends at its limit too: 1.5 A of 8 A, which are 32,767 raw.
    page.fill("spinbutton", "Current limit", "1.5")?;
    page.open_panel("Control")?;
    page.click("tab", "Current")?;
    let slider = page.evaluate("document.querySelector('.slider[max=\"6143\"]')?.min")?;
    assert_eq!(slider, "-6143");
    let marks = page.evaluate(
        "document.querySelector('.slider[max=\"6143\"]').nextElementSibling.textContent",
    )?;
    assert_eq!(marks, "−1.5 A0+1.5 A");
    page.click("button", "Limit: 1.5 A")?;
    page.find("spinbutton", "Current limit")?;
    assert_quiet_console(page);
    scenario.stays_undriven(Duration::from_secs(1))
}
