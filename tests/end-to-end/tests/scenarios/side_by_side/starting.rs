//! The page is used while it still comes.

use crate::fixture::assert_quiet_console;
use anyhow::Result;
use end_to_end::{Bench, FirstPress, Page, Slowness, wait_until};

/// Slow enough for a press to come before the worker.
const SLOWNESS: Slowness = Slowness {
    processor: 4.0,
    slow_4g: false,
};

/// Presses a button while the page still comes.
fn press_early(bench: &Bench, button: &str) -> Result<Page> {
    let (page, first) = FirstPress::on(bench, SLOWNESS, button)?;
    let FirstPress {
        usable_ms,
        whole_ms,
    } = first;
    assert!(
        usable_ms < whole_ms,
        "usable {usable_ms} ms, whole {whole_ms} ms"
    );
    Ok(page)
}

#[test]
fn a_press_before_all_of_the_page_is_there_connects_once_it_is() -> Result<()> {
    let bench = Bench::start()?;
    let page = press_early(&bench, "Virtual motor")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    page.wait_for_text("output", "Mode", |text| text.contains("elocity"))?;
    assert_quiet_console(&page);
    Ok(())
}

#[test]
fn help_asked_for_before_all_of_the_page_is_there_has_the_focus_once_it_is() -> Result<()> {
    let bench = Bench::start()?;
    let page = press_early(&bench, "Help")?;
    wait_until("the focus on the help", end_to_end::WAIT_MAX, || {
        let focus = page.evaluate("document.activeElement.role")?;
        Ok(if focus == "dialog" {
            Ok(())
        } else {
            Err(focus.to_string())
        })
    })?;
    assert_quiet_console(&page);
    Ok(())
}
