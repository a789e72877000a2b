//! What is in sight on small laptops and large screens.

use std::{thread, time::Duration};

use anyhow::{Context, Result, ensure};
use end_to_end::{Bench, Frame, Line, Page, Usb, View, now_us, retry, wait_until};
use serde_json::json;

use crate::fixture::{
    Scenario, connect,
    places::{LANDSCAPE, LAPTOP, Place, READ_OUTS, STOP, WIDE, WIDEST, in_sight, look},
    spin, wait_for_wire,
};

const SCANS_MAX: u32 = 5;
/// On a busy machine a scan of 254 addresses takes half a minute.
const SCAN_MAX: Duration = Duration::from_secs(90);

/// A stall takes the motor 5 s to notice.
const STALL_MAX: Duration = Duration::from_secs(40);

/// Around the notices that are shown and the tour, and whether they are cut.
const NOTICES: &str = "(() => {
    const shown = [...document.querySelectorAll('.notices, .notice')].filter((it) => it.getClientRects().length);
    const boxes = shown.map((it) => it.getBoundingClientRect());
    const most = (pick, side) => pick(...boxes.map((box) => box[side]));
    const cut = [...document.querySelectorAll('.notices, .notice-list')].some((it) => it.scrollHeight > it.clientHeight + 1);
    return [most(Math.min, 'left'), most(Math.min, 'top'), most(Math.max, 'right'), most(Math.max, 'bottom'), cut];
})()";

/// Where controls and figures lie.
const FIXED: &str = "JSON.stringify(['.control-panel', '.read-out.speed'].map((name) => {
    const { left, top } = document.querySelector(name).getBoundingClientRect();
    return [left, top];
}))";

/// The notices that are shown, the tour among them.
fn notices(page: &Page, view: View) -> Result<Place> {
    let shown = page.evaluate(NOTICES)?;
    let side = |at: usize| shown[at].as_f64().context("no notices");
    let (place, clipped) = (
        Place {
            left: side(0)?,
            top: side(1)?,
            right: side(2)?,
            bottom: side(3)?,
        },
        &shown[4],
    );
    ensure!(
        place.top >= 0.0 && place.bottom <= f64::from(view.height),
        "{place:?} in {view:?}"
    );
    // Sideways a phone has little room: the tour scrolls.
    let is_tour = page.find_all("button", "Skip the tour")?.len() == 1;
    ensure!(
        *clipped == json!(false) || is_tour && view == LANDSCAPE,
        "the notices are cut in {view:?}"
    );
    let stop = in_sight(page, view, STOP.0, STOP.1)?;
    ensure!(!place.covers(stop), "STOP is covered in {view:?}");
    for (role, name) in READ_OUTS {
        let read_out = Place::of(&page.find(role, name)?)?;
        ensure!(!place.covers(read_out), "{name} is covered in {view:?}");
    }
    Ok(place)
}

const SIZES: [View; 6] = [
    View::PHONE,
    LANDSCAPE,
    View::TABLET,
    LAPTOP,
    View::DESKTOP,
    WIDE,
];

/// The texts of visible elements that match a selector.
fn visible(page: &Page, selector: &str) -> Result<serde_json::Value> {
    page.evaluate(&format!(
        "[...document.querySelectorAll({selector:?})].filter((it) => it.checkVisibility({{ visibilityProperty: true }}))
            .map((it) => it.ariaLabel ?? it.textContent)"
    ))
}

#[test]
fn the_first_screen_has_one_primary_button_and_nothing_disabled() -> Result<()> {
    let bench = Bench::reuse()?;
    let page = bench.open("/")?;
    page.find("button", "Open recording")?;
    for view in SIZES {
        look(&page, view)?;
        assert_eq!(
            visible(&page, ".primary")?,
            json!(["Connect motor"]),
            "{view:?}"
        );
        assert_eq!(visible(&page, ":disabled")?, json!([]), "{view:?}");
        page.find("heading", "Drive your hub motor from the browser")?;
        for name in ["Connect motor", "Virtual motor", "STOP all motors"] {
            in_sight(&page, view, "button", name)?;
        }
        for name in ["One wheel", "Rover", "Faulty cable", "Open recording"] {
            page.find("button", name)?;
        }
    }
    look(&page, View::DESKTOP)?;
    page.click("button", "Rover")?;
    page.wait_for_text("status", "Connection", |text| text.contains("4 virtual"))?;
    page.click("radio", "Group")?;
    assert!(page.find_all("button", "One wheel")?.is_empty());
    Ok(())
}

#[test]
fn the_tour_and_an_alert_are_in_sight_in_every_window() -> Result<()> {
    let bench = Bench::reuse()?;
    let adapter = bench.plug(Line::default(), Usb::default())?;
    let page = bench.open("/?port=virtual")?;
    page.find("button", "Spin at 20 rpm")?;
    for view in SIZES {
        look(&page, view)?;
        let tour = notices(&page, view)?;
        in_sight(&page, view, "button", "Skip the tour")?;
        in_sight(&page, view, "button", "Spin at 20 rpm")?;
        if view != LANDSCAPE {
            let wheel = Place::of(&page.find_like("img", "Digital twin")?)?;
            ensure!(!tour.covers(wheel), "the wheel is covered in {view:?}");
        }
        // An offer covers no control.
        in_sight(&page, view, "tab", "Velocity")?;
        in_sight(&page, view, "spinbutton", "Target speed")?;
    }
    look(&page, LAPTOP)?;
    // Nor is it cut in another place.
    for place in ["Test", "Setup", "Diagnose"] {
        page.click("button", place)?;
        in_sight(&page, LAPTOP, "button", "Spin at 20 rpm")?;
        if place == "Test" {
            page.click("tab", "Step response")?;
            in_sight(&page, LAPTOP, "button", "Arm")?;
        }
    }
    page.open_panel("Control")?;
    page.click("button", "Skip the tour")?;
    page.click("button", "Disconnect")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Disconnected"))?;
    connect(&page)?;
    let mut scenario = Scenario {
        bench,
        adapter,
        page,
    };
    scenario.page.open_panel("Settings")?;
    scenario.page.fill("spinbutton", "Current limit", "8")?;
    spin(&scenario.page, "+100", 97..=103)?;
    let places = |page: &Page| -> Result<Vec<_>> {
        let place = |view| {
            look(page, view)?;
            page.evaluate(FIXED)
        };
        SIZES.into_iter().map(place).collect()
    };
    let before = places(&scenario.page)?;
    scenario.adapter.act("block 1 on")?;
    let page = &scenario.page;
    page.wait_for_text_within(STALL_MAX, "region", "Notices", |text| {
        // On a busy machine the motor may be lost first, which is an alert too.
        ["stall", "no longer driven"]
            .iter()
            .any(|alert| text.to_lowercase().contains(alert))
    })?;
    for view in SIZES {
        look(page, view)?;
        notices(page, view)?;
    }
    assert_eq!(places(page)?, before, "an alert moves nothing");
    Ok(())
}

/// Scans until every motor is found: on a busy machine a scan may miss some.
fn find_motors(page: &Page, motors: usize) -> Result<()> {
    page.open_panel("ID Manager")?;
    retry("full scan", SCANS_MAX, || {
        let scan = page.find_all("button", "Full scan")?.pop();
        scan.context("no button Full scan")?.click()?;
        thread::sleep(Duration::from_millis(500));
        wait_until("the end of the scan", SCAN_MAX, || {
            let cancel = page.find("button", "Cancel")?;
            Ok(if cancel.disabled {
                Ok(())
            } else {
                Err("it goes on".to_owned())
            })
        })?;
        let found = page.evaluate("document.querySelectorAll('.motor-chip').length")?;
        Ok(if found == json!(motors) {
            Ok(())
        } else {
            Err(format!("{found} motors"))
        })
    })?;
    page.open_panel("Control")
}

/// The rover of the issue: driven by the pad, with the telemetry of all four motors and the graph beside it.
#[test]
fn a_group_is_driven_with_its_telemetry_and_the_graph_in_sight() -> Result<()> {
    let scenario = Scenario::connected(Line::with_motors(&[1, 2, 3, 4]))?;
    let page = &scenario.page;
    page.click("button", "Skip the tour")?;
    find_motors(page, 4)?;
    look(page, View::DESKTOP)?;
    page.open_panel("Drive together")?;
    for id in 1..=4 {
        page.click("checkbox", &format!("Drive 0x{id:02X}"))?;
        let side = if id % 2 == 1 { "left" } else { "right" };
        page.choose(&format!("Side of 0x{id:02X}"), side)?;
    }
    let pad = page.find_like("application", "Drive pad")?;
    pad.focus()?;
    let pressed = now_us();
    page.hold_key("ArrowUp")?;
    wait_for_wire(&scenario, pressed, "four driven motors", |wire| {
        (1..=4).all(|id| {
            let drives = wire.of_motor(id).drives();
            let last = drives.last().and_then(Frame::drive_setpoint);
            last.is_some_and(|rpm| rpm != 0)
        })
    })?;
    let view = View::DESKTOP;
    let panel = Place::of(&page.find("region", "Drive together")?)?;
    for (role, name) in [
        ("output", "Forward"),
        ("output", "Current"),
        ("output", "Heading"),
        ("output", "Temperature"),
        ("button", "Motor 0x01"),
        ("button", "Motor 0x02"),
        ("button", "Motor 0x03"),
        ("button", "Motor 0x04"),
        ("img", "Speed and current"),
        STOP,
    ] {
        let place = in_sight(page, view, role, name)?;
        assert!(!panel.covers(place), "{name}: {place:?} under {panel:?}");
    }
    in_sight(page, view, "application", "Drive pad")?;
    page.release_key("ArrowUp")?;
    for panel in ["Link health", "Settings"] {
        page.open_panel(panel)?;
        let panel = in_sight(page, view, "region", panel)?;
        let graph = in_sight(page, view, "img", "Speed and current")?;
        assert!(!panel.covers(graph));
    }
    Ok(())
}

#[test]
fn eight_motors_are_in_sight_in_the_strip_and_in_the_list() -> Result<()> {
    let scenario = Scenario::connected(Line::with_motors(&[1, 2, 3, 4, 5, 6, 7, 8]))?;
    let page = &scenario.page;
    page.click("button", "Skip the tour")?;
    find_motors(page, 8)?;
    page.open_panel("ID Manager")?;
    for view in [View::DESKTOP, LAPTOP] {
        look(page, view)?;
        for id in 1..=8 {
            in_sight(page, view, "button", &format!("Motor 0x{id:02X}"))?;
        }
        let faults = page.evaluate(
            "[...document.querySelectorAll('[data-figure=faults]')]
                .every((figure) => figure.getBoundingClientRect().right < innerWidth)",
        )?;
        assert_eq!(faults, json!(true));
        let list = page.evaluate(
            "(() => { const list = document.querySelector('.found-list');
                return list.scrollHeight <= list.clientHeight + 1; })()",
        )?;
        assert_eq!(list, json!(true), "all motors found in {view:?}");
    }
    Ok(())
}

#[test]
fn a_wide_screen_gives_its_room_to_the_graph_and_the_wheel() -> Result<()> {
    let scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    page.click("button", "Skip the tour")?;
    look(page, View::DESKTOP)?;
    let area = |place: Place| place.width() * place.height();
    // The wheel is round.
    let least = |place: Place| place.width().min(place.height());
    let mut graph = area(in_sight(page, View::DESKTOP, "img", "Speed and current")?);
    let mut wheel = least(in_sight(page, View::DESKTOP, "region", "Wheel")?);
    for view in [WIDE, WIDEST] {
        look(page, view)?;
        let edge = ["Telemetry", "Speed and current"]
            .map(|name| -> Result<f64> { Ok(in_sight(page, view, "region", name)?.right) });
        let mut right = 0.0_f64;
        for edge in edge {
            right = right.max(edge?);
        }
        assert!(
            right > f64::from(view.width) - 30.0,
            "idle at the right: {right}"
        );
        let larger = area(in_sight(page, view, "img", "Speed and current")?);
        assert!(larger > 1.25 * graph, "{view:?}: {larger} after {graph}");
        graph = larger;
        let larger = least(in_sight(page, view, "region", "Wheel")?);
        assert!(larger > 1.1 * wheel, "{view:?}: {larger} after {wheel}");
        wheel = larger;
    }
    Ok(())
}
