//! Another language, chosen while a motor is driven.

use anyhow::Result;
use end_to_end::{Line, WAIT_MAX, wait_until};
use motorlink_i18n::{Language, set_language, translated};
use serde_json::json;

use crate::fixture::{Scenario, spin};

/// All that the page shows and says.
const SAID: &str = "[document.title, document.body.innerText,
    ...[...document.querySelectorAll('[aria-label], [aria-valuetext], [title]')].flatMap((element) =>
        ['aria-label', 'aria-valuetext', 'title'].map((name) => element.getAttribute(name) ?? ''))].join('\\n')";

/// A German engineer reads U/min, Rechtslauf and Linkslauf, in the rows of the log too, whenever they were logged.
#[test]
fn german_has_its_units_and_words_everywhere() -> Result<()> {
    let scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    page.click("button", "Skip the tour")?;
    spin(page, "+50", 47..=53)?;
    page.choose("Language", "Deutsch")?;
    set_language(Language::German);
    wait_until("German rows", WAIT_MAX, || {
        let rows = page.text("log", translated("Packets"))?;
        Ok(if rows.contains("U/min") && !rows.contains("rpm") {
            Ok(())
        } else {
            Err(rows)
        })
    })?;
    page.click("button", translated("STOP all motors"))?;
    page.wait_for_text("alertdialog", translated("Stopped"), |text| {
        text.contains("U/min")
    })?;
    page.click("button", translated("Release"))?;
    page.click("button", "+100")?;
    page.wait_for_text("output", translated("Speed"), |text| text.contains("+100"))?;
    let said = page.evaluate(SAID)?;
    let said = said.as_str().unwrap_or_default();
    for english in ["rpm", "CW", "Motor 0x01 is running"] {
        let line = said.lines().find(|line| line.contains(english));
        assert_eq!(line, None, "{english}");
    }
    for german in [
        "+100 U/min",
        "Rechtslauf",
        "Linkslauf",
        "Motor 0x01 läuft: +100 U/min",
    ] {
        assert!(said.contains(german), "{german} in\n{said}");
    }
    assert_eq!(page.evaluate("document.documentElement.lang")?, json!("de"));
    set_language(Language::English);
    Ok(())
}
