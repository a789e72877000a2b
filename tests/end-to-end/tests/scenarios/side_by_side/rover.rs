//! A vehicle with four wheels, seen from above.

use std::{thread, time::Duration};

use crate::fixture::{Scenario, assert_quiet_console, number, wait_for_wire, wait_until_enabled};
use anyhow::{Context, Result};
use end_to_end::{Line, Page, View, WAIT_MAX, now_us, wait_until};

/// A scan takes longer on a busy machine.
const SCAN_MAX: Duration = Duration::from_secs(60);

/// Motors 1 and 3 on the left, 2 and 4 on the right, as this browser has stored it.
const FLEET: &str = "localStorage.setItem('motorlink.fleet', \
    '1\\tyes\\tleft\\tFront left\\n2\\tyes\\tright\\tFront right\\n\
    3\\tyes\\tleft\\tRear left\\n4\\tyes\\tright\\tRear right\\n')";

/// A rover whose wheels have all been found, with the panel that drives it open.
fn rover() -> Result<Scenario> {
    let scenario = Scenario::connected(Line::with_motors(&[1, 2, 3, 4]))?;
    let page = &scenario.page;
    page.look(View::DESKTOP)?;
    assert!(
        page.find_all("region", "Rover")?.is_empty(),
        "without a group"
    );
    page.evaluate(FLEET)?;
    page.reload()?;
    crate::fixture::connect(page)?;
    page.open_panel("ID Manager")?;
    let scan = page.find_all("button", "Full scan")?.pop();
    scan.context("no button Full scan")?.click()?;
    page.wait_for_text_within(SCAN_MAX, "status", "Scan result", |text| {
        text.contains("4 motors")
    })?;
    page.open_panel("Drive together")?;
    page.fill("spinbutton", "Group speed", "80")?;
    page.press("Enter")?;
    wait_until_enabled(page, "application", "Drive pad", true)?;
    Ok(scenario)
}

/// A figure of the group. The cards `Forward` and `Heading` have two.
fn figure(page: &Page, name: &str) -> Result<f64> {
    let card = match name {
        "Driven" => "Forward",
        "Turn" => "Heading",
        own => own,
    };
    said(&page.text("output", card)?, name).with_context(|| format!("{name} is unknown"))
}

/// The number behind this word of a card, or the first one.
fn said(card: &str, word: &str) -> Option<f64> {
    number(card.split_once(word).map_or(card, |(_, rest)| rest))
}

/// Holds an arrow key on the drive pad for this long, until the rover stands again.
fn hold(
    scenario: &Scenario,
    key: &str,
    duration: Duration,
    meanwhile: impl Fn(&Page) -> Result<()>,
) -> Result<()> {
    let page = &scenario.page;
    page.find_like("application", "Drive pad")?.focus()?;
    let pressed = now_us();
    page.hold_key(key)?;
    wait_for_wire(scenario, pressed, "four driven wheels", |wire| {
        (1..=4).all(|id| wire.of_motor(id).drives().len() > 5)
    })?;
    thread::sleep(duration);
    meanwhile(page)?;
    page.release_key(key)?;
    page.wait_for_text("output", "Forward", |text| text.starts_with("0.00"))?;
    page.wait_for_text("output", "Heading", |text| text.contains("Turn 0 "))?;
    Ok(())
}

#[test]
fn a_rover_is_seen_from_above_with_the_path_that_it_drives() -> Result<()> {
    let scenario = rover()?;
    let page = &scenario.page;
    assert!(
        page.find_all("region", "Wheel")?.is_empty(),
        "the rover replaces it"
    );
    assert!(figure(page, "Driven")?.abs() < 0.01);

    // The cards are those of the group.
    page.wait_for_text("output", "Current", |text| text.contains("sum of 4"))?;
    page.wait_for_text("output", "Temperature", |text| text.contains("0x0"))?;
    page.click("radio", "Motor")?;
    page.find("output", "Position")?;
    page.click("radio", "Group")?;

    // 80 rpm with a wheel radius of 51 mm are 0.43 m/s.
    hold(&scenario, "ArrowUp", Duration::from_secs(1), |page| {
        page.wait_for_text("output", "Forward", |text| {
            number(text).is_some_and(|speed| (0.38..0.48).contains(&speed))
        })?;
        let said = page.text("list", "Right wheels")?;
        assert!(said.contains("Front right") && said.contains('+'), "{said}");
        Ok(())
    })?;
    let driven = figure(page, "Driven")?;
    assert!((0.25..3.0).contains(&driven), "{driven} m");
    let heading = figure(page, "Heading")?;
    assert!(
        (heading + 180.0) % 360.0 > 170.0 && (heading + 180.0) % 360.0 < 190.0,
        "{heading}"
    );

    // On the spot, to the right.
    hold(
        &scenario,
        "ArrowRight",
        Duration::from_millis(300),
        |page| {
            page.wait_for_text("output", "Heading", |text| {
                said(text, "Turn").is_some_and(|turn| turn > 100.0)
            })?;
            Ok(())
        },
    )?;
    assert!((figure(page, "Heading")? - heading).abs() > 5.0);
    assert!(
        (figure(page, "Driven")? - driven).abs() < 0.1,
        "the middle stays"
    );

    // One press shows the single wheel, and one the rover again.
    page.click("button", "Single wheel")?;
    page.find("region", "Wheel")?;
    assert!(page.find_all("region", "Rover")?.is_empty());
    page.click("button", "Rover")?;
    page.find("region", "Rover")?;
    assert!(page.find_all("region", "Wheel")?.is_empty());
    assert!(
        (figure(page, "Driven")? - driven).abs() < 0.1,
        "the path is kept"
    );
    page.click("button", "Reset path")?;
    page.wait_for_text("output", "Forward", |text| text.contains("Driven 0.00"))?;

    // The measures have a range, and are stored.
    page.fill("spinbutton", "Wheel radius", "9")?;
    page.press("Enter")?;
    let field = page.find("spinbutton", "Wheel radius")?;
    assert!(
        field.description.contains("10 to 500 mm"),
        "{}",
        field.description
    );
    page.fill("spinbutton", "Wheel radius", "60")?;
    page.press("Enter")?;
    page.click("button", "Single wheel")?;
    page.reload()?;
    crate::fixture::connect(page)?;
    wait_until("the stored view", WAIT_MAX, || {
        let rover = page.find_all("button", "Rover")?;
        Ok(if rover.is_empty() {
            Err("no button Rover".to_owned())
        } else {
            Ok(())
        })
    })?;
    page.find("region", "Wheel")?;
    page.open_panel("Drive together")?;
    assert_eq!(page.find("spinbutton", "Wheel radius")?.value, "60");
    assert_quiet_console(page);
    Ok(())
}

/// A wheel that answers no more is unknown, and the path says so where it goes on.
#[test]
fn a_wheel_that_loses_power_is_said_at_its_place() -> Result<()> {
    let mut scenario = rover()?;
    scenario.adapter.act("power 2 off")?;
    scenario.adapter.act("power 4 off")?;
    let page = &scenario.page;
    page.wait_for_text("list", "Right wheels", |text| {
        text.matches("No reply").count() == 2
    })?;
    assert!(!page.text("list", "Left wheels")?.contains("No reply"));
    page.wait_for_text("output", "Forward", |text| text.starts_with('–'))?;
    scenario.adapter.act("power 2 on")?;
    scenario.adapter.act("power 4 on")?;
    scenario
        .page
        .wait_for_text("output", "Forward", |text| text.starts_with("0.00"))?;
    Ok(())
}

/// The wheels that a card covers, and the cards that the figures cover.
const COVERED: &str = "(() => {
    const boxes = (what) => [...document.querySelectorAll(what)]
        .filter((element) => element.checkVisibility({ opacityProperty: true }))
        .map((element) => element.getBoundingClientRect());
    const meet = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
    const cards = boxes('.rover-card');
    const among = (what) => boxes(what).filter((box) => cards.some((card) => meet(box, card))).length;
    return [boxes('.rover-tyre').length, among('.rover-tyre'), among('.rover-figure')];
})()";

#[test]
fn the_cards_of_the_wheels_cover_no_wheel_and_no_figure() -> Result<()> {
    let scenario = rover()?;
    let page = &scenario.page;
    for (width, height) in [
        (390, 844),
        (844, 390),
        (720, 450),
        (1024, 768),
        (1440, 900),
        (2560, 1440),
    ] {
        page.look(View::window(width, height))?;
        let what = format!("no card over a wheel or a figure at {width} x {height}");
        wait_until(&what, WAIT_MAX, || {
            let covered = page.evaluate(COVERED)?;
            Ok(if covered == serde_json::json!([4, 0, 0]) {
                Ok(())
            } else {
                Err(format!("wheels, covered wheels and figures: {covered}"))
            })
        })?;
    }
    Ok(())
}
