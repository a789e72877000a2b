//! What a phone shows, upright and sideways.

use anyhow::{Result, ensure};
use end_to_end::{Line, Page, View};
use serde_json::json;

use crate::fixture::{
    Scenario,
    places::{LANDSCAPE, Place, READ_OUTS, STOP, all_in_sight, in_sight, look},
    spin,
};

#[test]
fn a_phone_has_on_its_first_screen_what_drives() -> Result<()> {
    let scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    page.click("button", "Skip the tour")?;
    look(page, View::PHONE)?;
    let first_screen = [
        ("status", "Connection"),
        ("region", "Wheel"),
        ("spinbutton", "Target speed"),
        ("slider", "Target speed"),
        ("button", "Start"),
        ("button", "Stop"),
        STOP,
        ("navigation", "Places"),
    ];
    all_in_sight(page, View::PHONE, &first_screen)?;
    all_in_sight(page, View::PHONE, &READ_OUTS)?;
    // It is enough to drive by, and nothing had to be scrolled.
    spin(page, "Start", 97..=103)?;
    assert_eq!(page.evaluate("scrollY")?, json!(0));

    look(page, LANDSCAPE)?;
    all_in_sight(
        page,
        LANDSCAPE,
        &[STOP, ("output", "Speed"), ("button", "Start")],
    )?;
    assert_eq!(page.evaluate(FAULT_TEXTS)?, json!(true));
    // The figures stay while the controls are scrolled.
    for view in [View::PHONE, LANDSCAPE] {
        look(page, view)?;
        page.evaluate("scrollTo(0, 10000)")?;
        ensure!(page.evaluate("scrollY")? != json!(0), "{view:?}");
        all_in_sight(page, view, &READ_OUTS)?;
        in_sight(page, view, STOP.0, STOP.1)?;
    }
    Ok(())
}

/// Whether the texts of a fault lie beside each other.
const FAULT_TEXTS: &str = "(() => {
    const card = document.querySelector('.read-out.faults');
    const [was, figure] = [card.className, card.querySelector('.figure')];
    const text = figure.textContent;
    card.className = 'panel read-out faults bad';
    figure.textContent = 'Over-temperature';
    const ends = ['.read-out-name', '.age', '.figure', '.detail'].map((name) => card.querySelector(name).getBoundingClientRect());
    const apart = (a, b) => a.right <= b.left + 1 || b.right <= a.left + 1 || a.bottom <= b.top + 1 || b.bottom <= a.top + 1;
    const all = ends.every((one, at) => one.width && ends.slice(at + 1).every((other) => apart(one, other)));
    [card.className, figure.textContent] = [was, text];
    return all;
})()";

#[test]
fn a_phone_shows_the_rest_behind_its_bar() -> Result<()> {
    let scenario = Scenario::connected(Line::with_motors(&[1, 2]))?;
    let page = &scenario.page;
    page.click("button", "Skip the tour")?;
    for view in [View::PHONE, LANDSCAPE] {
        for (place, role, name) in [
            ("Record", "button", "Save session"),
            ("Test", "button", "Arm"),
            ("Setup", "button", "Export setup"),
            ("Setup", "button", "Theme"),
            ("Diagnose", "textbox", "Frame bytes"),
            ("Drive", "button", "Start"),
        ] {
            look(page, view)?;
            page.click("button", place)?;
            in_sight(page, view, STOP.0, STOP.1)?;
            in_sight(page, view, "button", "Help")?;
            if name == "Arm" {
                keeps_the_buttons_of_a_run_in_sight(page, view)?;
            }
            for (role, name) in [(role, name), ("region", "Packet log"), ("button", "PNG")] {
                let shown = page.find(role, name)?;
                assert!(Place::of(&shown)?.width() > 0.0, "{name} in {place}");
            }
        }
    }
    Ok(())
}

fn keeps_the_buttons_of_a_run_in_sight(page: &Page, view: View) -> Result<()> {
    // A notice is above the form until it is dismissed.
    for dismiss in page.find_all("button", "Dismiss")? {
        dismiss.click()?;
    }
    page.click("button", "Arm")?;
    page.wait_for_text("status", "Run", |text| text.contains("Armed"))?;
    for top in [0, 300] {
        page.evaluate(&format!("scrollTo(0, {top})"))?;
        all_in_sight(page, view, &[("button", "Run"), ("button", "Abort")])?;
    }
    page.click("button", "Abort")
}

/// Controls in sight that are smaller than a finger: a tick is pressed with its label, and an absolute `::before` makes
/// a control larger than it looks.
const SMALL: &str = "[...document.querySelectorAll('button, select, input')]
    .filter((control) => control.getClientRects().length && getComputedStyle(control).visibility === 'visible')
    .map((control) => control.matches('.edit-name') ? control : control.closest('label, .language, .motor-chip') ?? control)
    .filter((target) => {
        const { width, height } = target.getBoundingClientRect();
        const before = getComputedStyle(target, '::before');
        const beyond = before.position === 'absolute' && before.content !== 'none';
        const more = (...sides) => beyond ? sides.reduce((sum, side) => sum - parseFloat(before[side]), 0) : 0;
        return width + more('left', 'right') < 43.5 || height + more('top', 'bottom') < 43.5;
    })
    .map((target) => target.outerHTML.slice(0, 120))";

#[test]
fn fingers_have_targets_of_44_pixels_and_no_hints_of_keys() -> Result<()> {
    let scenario = Scenario::connected(Line::with_motors(&[1, 2]))?;
    let page = &scenario.page;
    page.touch()?;
    look(page, View::PHONE)?;
    for place in ["Record", "Setup", "Diagnose", "Drive"] {
        page.click("button", place)?;
        assert_eq!(page.evaluate(SMALL)?, json!([]), "{place}");
    }
    let hints = page.evaluate(
        "[...document.querySelectorAll('.stop-keys, .keys')]
            .filter((hint) => hint.getClientRects().length).length",
    )?;
    assert_eq!(hints, json!(0));
    Ok(())
}
