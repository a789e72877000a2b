//! The setup given away as a file, and taken back.

use std::fs;

use crate::fixture::{Scenario, assert_quiet_console, wait_for_speed, wait_until_enabled};
use anyhow::Result;
use end_to_end::{Download, Line, Page};

/// A page on which motor 1 is `Port`, a left wheel that drives together with others, at 120 Hz.
fn rover() -> Result<Scenario> {
    let scenario = Scenario::connected(Line::with_motors(&[1, 2]))?;
    let page = &scenario.page;
    // A group has two motors.
    page.evaluate("localStorage.setItem('motorlink.fleet', '2\\tyes\\tright\\tStarboard\\n')")?;
    page.reload()?;
    crate::fixture::connect(page)?;
    page.fill("spinbutton", "Command rate", "120")?;
    page.open_panel("Drive together")?;
    page.fill("textbox", "Name of 0x01", "Port")?;
    page.choose("Side of 0x01", "left")?;
    page.click("checkbox", "Drive 0x01")?;
    page.fill("spinbutton", "Ramp", "300")?;
    Ok(scenario)
}

/// What the page shows of the setup.
fn shown(page: &Page) -> Result<[String; 5]> {
    Ok([
        page.find("spinbutton", "Command rate")?.value,
        page.find("textbox", "Name of 0x01")?.value,
        page.find("combobox", "Side of 0x01")?.value,
        page.find("checkbox", "Drive 0x01")?.on.to_string(),
        page.find("spinbutton", "Ramp")?.value,
    ])
}

fn import(page: &Page, file: &Download, wanted: &str) -> Result<String> {
    page.open_panel("Settings")?;
    page.upload("Import setup", &file.path)?;
    let words = page.wait_for_text("status", "Setup", |text| text.contains(wanted))?;
    page.open_panel("Drive together")?;
    Ok(words)
}

#[test]
fn a_setup_that_was_exported_comes_back_and_a_bad_file_changes_nothing() -> Result<()> {
    let scenario = rover()?;
    let page = &scenario.page;
    let mine = shown(page)?;
    page.open_panel("Settings")?;
    let file = page.download("Export setup")?;
    page.open_panel("Drive together")?;
    assert_eq!(file.name, "motorlink-setup.json");
    let json = String::from_utf8(file.bytes()?)?;
    assert!(json.contains("\"motorlink_setup\": 1"), "{json}");
    assert!(json.contains("\"name\": \"Port\""), "{json}");

    page.fill("spinbutton", "Command rate", "60")?;
    page.fill("textbox", "Name of 0x01", "Other")?;
    page.choose("Side of 0x01", "right")?;
    page.click("checkbox", "Drive 0x01")?;
    page.fill("spinbutton", "Ramp", "0")?;
    let other = shown(page)?;

    fs::write(&file.path, json.replace("\"left\"", "\"up\""))?;
    let words = import(page, &file, "Nothing was changed")?;
    assert!(words.contains("motors[0].side"), "{words}");
    assert!(words.contains("\"left\""), "{words}");
    assert_eq!(shown(page)?, other);

    fs::write(&file.path, &json)?;
    import(page, &file, "Imported")?;
    assert_eq!(shown(page)?, mine);
    page.reload()?;
    crate::fixture::connect(page)?;
    page.open_panel("Drive together")?;
    assert_eq!(shown(page)?, mine);
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn while_a_wheel_turns_no_setup_is_taken_in() -> Result<()> {
    let scenario = Scenario::spinning()?;
    let page = &scenario.page;
    page.open_panel("Settings")?;
    wait_until_enabled(page, "button", "Import setup", false)?;
    let why = page.find("button", "Import setup")?.description;
    assert!(why.contains("Motor 0x01 is in use"), "{why}");
    page.press("Escape")?;
    wait_for_speed(page, 0..=0)?;
    page.open_panel("Settings")?;
    wait_until_enabled(page, "button", "Import setup", true)?;
    Ok(())
}
