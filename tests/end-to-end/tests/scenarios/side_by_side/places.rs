//! The five places of the page, while a wheel is driven.

use std::{thread, time::Duration};

use anyhow::Result;
use end_to_end::{Frame, WAIT_MAX, now_us, wait_until};

use crate::fixture::{Scenario, assert_ends_braked, assert_quiet_console};

/// Each place with a panel of it.
const PLACES: [(&str, &str); 5] = [
    ("2", "Session file"),
    ("3", "Experiments"),
    ("4", "ID Manager"),
    ("5", "Link health"),
    ("1", "Telemetry"),
];

/// Drive frames follow each other within 20 ms; a busy machine delays them.
const GAP_US_MAX: u64 = 500_000;

#[test]
fn a_wheel_is_driven_on_through_all_places_and_stopped_from_any() -> Result<()> {
    let scenario = Scenario::spinning()?;
    let page = &scenario.page;
    let from_us = now_us();
    for (key, panel) in PLACES {
        page.press(&format!("Alt+{key}"))?;
        wait_until(&format!("the place with {panel}"), WAIT_MAX, || {
            let is_open = !page.find_all("region", panel)?.is_empty();
            Ok(is_open.then_some(()).ok_or_else(|| "closed".to_owned()))
        })?;
        assert!(!page.find("button", "STOP all motors")?.disabled);
        thread::sleep(Duration::from_secs(1));
    }
    let drives = scenario.since(from_us)?.drives();
    let is_same = |frame: &Frame| frame.drive_setpoint() == Some(100);
    assert!(drives.frames.iter().all(is_same), "{drives}");
    let gaps = drives.gaps().expect("drive frames");
    assert!(gaps.max_us < GAP_US_MAX, "{} us", gaps.max_us);

    for (key, _) in PLACES {
        page.press("Alt+1")?;
        crate::fixture::spin(page, "+100", 97..=103)?;
        page.press(&format!("Alt+{key}"))?;
        let pressed_us = now_us();
        page.click("button", "STOP all motors")?;
        page.wait_for_text("alertdialog", "Stopped", |text| text.contains("confirmed"))?;
        assert_ends_braked(&scenario.since(pressed_us)?);
        page.click("button", "Release")?;
    }
    assert_quiet_console(page);
    Ok(())
}
