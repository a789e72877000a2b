//! Adapters: plugged in late, alike, silent, not to be opened.

use std::{thread, time::Duration};

use crate::fixture::{
    assert_quiet_console,
    rules::{the_page_says, the_page_says_one_of},
    wait_for_speed,
};
use anyhow::Result;
use end_to_end::{Bench, Line, Usb, now_us, retry};

const CONNECTS_MAX: u32 = 3;

#[test]
fn an_adapter_plugged_in_later_is_connected_to() -> Result<()> {
    let bench = Bench::reuse()?;
    let page = bench.open("/")?;
    let adapter = bench.plug(Line::default(), Usb::default())?;
    crate::fixture::connect(&page)?;
    page.click("button", "+50")?;
    wait_for_speed(&page, 47..=53)?;
    assert!(!adapter.wire()?.drives().is_empty());
    Ok(())
}

/// Web Serial knows no serial numbers: they are told apart by who answers.
#[test]
fn of_two_identical_adapters_the_one_with_the_chosen_motor_is_taken() -> Result<()> {
    let bench = Bench::reuse()?;
    let first = bench.plug(Line::with_motors(&[1]), Usb::default())?;
    let second = bench.plug(Line::with_motors(&[2]), Usb::default())?;
    let page = bench.open("/")?;
    for (motor, meant, other) in [("0x02 · 2", &second, &first), ("0x01 · 1", &first, &second)] {
        page.choose("Motor", motor)?;
        crate::fixture::connect(&page)?;
        let pressed = now_us();
        page.click("button", "+50")?;
        wait_for_speed(&page, 47..=53)?;
        assert!(
            !meant.wire()?.since(pressed).drives().is_empty(),
            "motor {motor}"
        );
        assert!(
            other.wire()?.drives().since(pressed).is_empty(),
            "motor {motor}"
        );
        page.click("button", "Stop")?;
        wait_for_speed(&page, 0..=0)?;
        page.click("button", "Disconnect")?;
        page.wait_for_text("status", "Connection", |text| text.contains("Disconnected"))?;
    }
    assert_quiet_console(&page);
    Ok(())
}

#[test]
fn a_line_on_which_nobody_answers_says_what_to_check() -> Result<()> {
    let bench = Bench::reuse()?;
    let _adapter = bench.plug(Line::default().with(&["--loss", "1"]), Usb::default())?;
    let page = bench.open("/")?;
    page.click("button", "Connect motor")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    for words in ["18 V", "rown", "A and B"] {
        the_page_says(&page, words)?;
    }
    assert!(page.find("button", "Start")?.disabled);
    assert!(!page.find("button", "STOP all motors")?.disabled);
    Ok(())
}

#[test]
fn several_motors_that_answer_the_id_query_at_once_are_noticed() -> Result<()> {
    let bench = Bench::reuse()?;
    let _adapter = bench.plug(Line::with_motors(&[1, 2]), Usb::default())?;
    let page = bench.open("/")?;
    // On a busy machine the replies may come after the query's time: then the page has found none.
    retry("connect", CONNECTS_MAX, || {
        crate::fixture::connect(&page)?;
        if the_page_says_one_of(&page, &["several motors", "Several motors"]).is_ok() {
            return Ok(Ok(()));
        }
        the_page_says(&page, "No motors found")?;
        page.click("button", "Disconnect")?;
        page.wait_for_text("status", "Connection", |text| text.contains("Disconnected"))?;
        Ok(Err("the replies came late".to_owned()))
    })
}

#[test]
fn a_port_that_cannot_be_opened_names_the_causes_and_the_session_goes_on() -> Result<()> {
    let bench = Bench::reuse()?;
    let mut adapter = bench.plug(Line::default(), Usb::default())?;
    let page = bench.open("/")?;
    thread::sleep(Duration::from_millis(300));
    // One of the three causes that look alike to a page.
    adapter.take_node()?;
    page.click("button", "Connect motor")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Failed"))?;
    let text = page.evaluate("document.body.innerText")?;
    let text = text.as_str().unwrap_or_default();
    for word in ["dialout", "programs that use the port", "brltty"] {
        assert!(
            text.contains(word),
            "the page does not say {word:?}: {text}"
        );
    }
    page.click("button", "Virtual motor")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    Ok(())
}

#[test]
fn a_dismissed_picker_is_no_error() -> Result<()> {
    let bench = Bench::reuse()?;
    let page = bench.open("/")?;
    page.click("button", "Connect motor")?;
    page.dismiss_picker(|| {
        let text = page.evaluate("document.body.innerText")?;
        Ok(text
            .as_str()
            .is_some_and(|text| text.contains("Show all ports") || text.contains("No port")))
    })?;
    assert_quiet_console(&page);
    Ok(())
}
