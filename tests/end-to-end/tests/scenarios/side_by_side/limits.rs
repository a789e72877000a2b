//! Limits that a person sets, crossed on the wire.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test fails by panicking, in its helpers too"
)]

use std::time::Duration;

use crate::fixture::{Story, assert_ends_braked, assert_quiet_console, open_panel, wait_for_speed};
use anyhow::Result;
use end_to_end::{Line, Page, now_us};

/// It was stopped and said why, the log has it, and nothing drives any more.
fn is_stopped_and_said(story: &Story, since_us: u64, why: &str) -> Result<()> {
    let page: &Page = &story.page;
    page.wait_for_text("region", "Notices", |text| text.contains(why))?;
    page.wait_for_text("log", "Packets", |text| text.contains(why))?;
    wait_for_speed(page, 0..=0)?;
    assert_ends_braked(&story.since(since_us)?);
    story.stays_undriven(Duration::from_secs(1))?;
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn a_wheel_beyond_its_speed_limit_is_stopped_and_faster_ones_are_not_started() -> Result<()> {
    let story = Story::spinning()?;
    open_panel(&story.page, "Settings")?;
    let lowered = now_us();
    story.page.fill("spinbutton", "Speed limit", "60")?;
    is_stopped_and_said(&story, lowered, "above your limit of 60 rpm")?;
    story.page.click("button", "+100")?;
    let refused = |text: &str| text.contains("above your speed limit of 60 rpm");
    story.page.wait_for_text("region", "Notices", refused)?;
    story.stays_undriven(Duration::from_secs(1))?;
    story.page.click("button", "+50")?;
    wait_for_speed(&story.page, 48..=52)
}

#[test]
fn a_hot_motor_is_stopped_before_it_protects_itself() -> Result<()> {
    let mut story = Story::spinning()?;
    let heated = now_us();
    for celsius in [60, 70, 77] {
        story.adapter.act(&format!("temperature 1 {celsius}"))?;
    }
    is_stopped_and_said(&story, heated, "above your limit of 75 °C")
}

#[test]
fn limits_are_kept_for_the_next_port_and_the_next_visit() -> Result<()> {
    let story = Story::connected(Line::default())?;
    let page = &story.page;
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
    let refused = |text: &str| text.contains("above your speed limit of 60 rpm");
    page.wait_for_text("region", "Notices", refused)?;
    story.stays_undriven(Duration::from_secs(1))
}
