//! Ports that are another's: a program's, another tab's, or nobody's any more.

use std::{thread, time::Duration};

use crate::fixture::{
    Scenario, assert_quiet_console, connect, number,
    rules::{
        it_drives_again_when_asked, nothing_but_stops_and_questions, the_log_has_it_all,
        the_page_says,
    },
    wait_for_speed,
};
use anyhow::Result;
use end_to_end::{Bench, Frame, Line, Page, Usb, now_us};

const OTHER_TAB: &str = "Another MotorLink tab uses this adapter";

fn fails(page: &Page) -> Result<()> {
    page.click("button", "Connect motor")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Failed"))?;
    Ok(())
}

#[test]
fn a_port_that_another_program_has_says_so_and_opens_once_it_is_free() -> Result<()> {
    let bench = Bench::start_as_user()?;
    let adapter = bench.plug(Line::default(), Usb::default())?;
    let held = adapter.hold()?;
    let page = bench.open("/")?;
    fails(&page)?;
    the_page_says(&page, "Close other tabs and programs that use the port")?;
    page.click("button", "Connect motor")?;
    // The page still shows the first failure. The second attempt takes two seconds.
    let failed = |text: &str| text.contains("Failed");
    page.wait_for_text("status", "Connection", |text| !failed(text))?;
    page.wait_for_text("status", "Connection", failed)?;
    drop(held);
    assert!(adapter.wire()?.is_empty(), "on a line of another's");
    connect(&page)?;
    it_drives_again_when_asked(&page)?;
    assert_quiet_console(&page);
    Ok(())
}

/// As where the node vanishes before the system says that the adapter is gone.
#[test]
fn a_line_whose_far_end_closes_while_driving_is_lost_and_comes_back() -> Result<()> {
    let mut scenario = Scenario::spinning()?;
    scenario.adapter.take_node()?;
    let page = &scenario.page;
    page.wait_for_text("status", "Connection", |text| text.contains("Reconnecting"))?;
    the_page_says(page, "Adapter unplugged")?;
    scenario.adapter.unplug()?;
    let back = now_us();
    scenario.adapter.plug()?;
    let page = &scenario.page;
    page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    page.wait_for_text("output", "Speed", |text| number(text).is_some())?;
    thread::sleep(Duration::from_secs(1));
    nothing_but_stops_and_questions(&scenario.since(back)?)?;
    the_log_has_it_all(&scenario, 1)?;
    it_drives_again_when_asked(&scenario.page)?;
    assert_quiet_console(&scenario.page);
    Ok(())
}

#[test]
fn the_second_tab_that_wants_the_port_says_so_and_gets_it_from_the_first() -> Result<()> {
    let mut scenario = Scenario::spinning()?;
    let asked = now_us();
    let second = scenario.bench.open("/")?;
    fails(&second)?;
    the_page_says(&second, OTHER_TAB)?;
    assert_quiet_console(&second);
    // The first drives on: nobody else has spoken. On a held-up machine it may have been stopped.
    let drives = scenario.since(asked)?.drives();
    let its_own = |frame: &Frame| frame.drive_setpoint() == Some(100) || frame.is_stop();
    assert!(
        !drives.is_empty() && drives.frames.iter().all(its_own),
        "{drives}"
    );
    let strange = scenario.since(asked)?.from_host();
    assert!(
        strange.frames.iter().all(|frame| frame.id() == Some(1)),
        "{strange}"
    );
    // While the adapter is pulled out it is waited for, and stays the first tab's.
    scenario.adapter.unplug()?;
    scenario.page.show()?;
    let waits = |text: &str| text.contains("Reconnecting");
    scenario.page.wait_for_text("status", "Connection", waits)?;
    scenario.adapter.plug()?;
    let back = |text: &str| text.contains("Connected");
    scenario.page.wait_for_text("status", "Connection", back)?;
    second.show()?;
    fails(&second)?;
    the_page_says(&second, OTHER_TAB)?;

    scenario.page.show()?;
    scenario.page.click("button", "Disconnect")?;
    let gone = |text: &str| text.contains("Disconnected");
    scenario.page.wait_for_text("status", "Connection", gone)?;
    second.show()?;
    connect(&second)?;
    it_drives_again_when_asked(&second)?;
    // And back, by a tab that is closed.
    scenario.bench.close(second)?;
    scenario.page.show()?;
    connect(&scenario.page)?;
    wait_for_speed(&scenario.page, 0..=0)?;
    assert_quiet_console(&scenario.page);
    Ok(())
}

/// Two adapters of one make: the second tab takes the one that is free.
#[test]
fn two_tabs_drive_by_two_identical_adapters() -> Result<()> {
    let bench = Bench::start_as_user()?;
    let first = bench.plug(Line::with_motors(&[1]), Usb::default())?;
    let page = bench.open("/")?;
    connect(&page)?;
    let second = bench.plug(Line::with_motors(&[2]), Usb::default())?;
    let other = bench.open("/")?;
    other.choose("Motor", "0x02 · 2")?;
    connect(&other)?;
    let pressed = now_us();
    it_drives_again_when_asked(&other)?;
    assert!(!second.wire()?.since(pressed).drives().is_empty());
    assert!(first.wire()?.since(pressed).drives().is_empty());
    // A third finds none.
    let third = bench.open("/")?;
    fails(&third)?;
    the_page_says(&third, OTHER_TAB)?;
    thread::sleep(Duration::from_millis(200));
    for (adapter, id) in [(&first, 1), (&second, 2)] {
        let host = adapter.wire()?.since(pressed).from_host();
        assert!(!host.is_empty(), "nobody asks motor {id}");
        assert!(
            host.frames.iter().all(|frame| frame.id() == Some(id)),
            "{host}"
        );
    }
    Ok(())
}
