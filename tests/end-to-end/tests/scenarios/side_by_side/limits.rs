//! Limits that a person sets, crossed on the wire.

use std::time::Duration;

use crate::fixture::{
    Scenario, assert_ends_braked, assert_quiet_console, open_panel, wait_for_speed,
};
use anyhow::Result;
use end_to_end::{Line, Page, now_us};

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
    open_panel(&scenario.page, "Settings")?;
    let lowered = now_us();
    scenario.page.fill("spinbutton", "Speed limit", "60")?;
    is_stopped_and_said(&scenario, lowered, "above your limit of 60 rpm")?;
    scenario.page.click("button", "+100")?;
    let refused = |text: &str| text.contains("Above your speed limit of 60 rpm");
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
    open_panel(page, "Settings")?;
    page.fill("spinbutton", "Speed limit", "60")?;
    page.click("button", "Disconnect")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Disconnected"))?;
    page.reload()?;
    page.click("button", "Connect")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    open_panel(page, "Settings")?;
    assert_eq!(page.find("spinbutton", "Speed limit")?.value, "60");
    page.wait_for_text("output", "Mode", |text| text.contains("elocity"))?;
    page.click("button", "+100")?;
    let refused = |text: &str| text.contains("Above your speed limit of 60 rpm");
    page.wait_for_text("region", "Notices", refused)?;
    scenario.stays_undriven(Duration::from_secs(1))
}
