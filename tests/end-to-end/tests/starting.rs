//! The page is used while it still comes.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test fails by panicking, in its helpers too"
)]

mod story;

use anyhow::Result;
use end_to_end::{Bench, FirstPress};
use story::assert_quiet_console;

/// Slow enough for a press to come before the worker.
const TIMES_SLOWER: f64 = 4.0;

#[test]
fn a_press_before_all_of_the_page_is_there_connects_once_it_is() -> Result<()> {
    let bench = Bench::start()?;
    let (page, first) = FirstPress::on(&bench, TIMES_SLOWER)?;
    let FirstPress {
        usable_ms,
        whole_ms,
    } = first;
    assert!(
        usable_ms < whole_ms,
        "usable {usable_ms} ms, whole {whole_ms} ms"
    );
    page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    page.wait_for_text("output", "Mode", |text| text.contains("elocity"))?;
    assert_quiet_console(&page);
    Ok(())
}
