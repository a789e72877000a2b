//! The size of the graph and of its picture.

use anyhow::Result;
use end_to_end::{Line, View, WAIT_MAX, wait_until};

use crate::fixture::{
    Scenario,
    places::{Place, STOP, all_in_sight, in_sight, look},
    spin,
};

#[test]
fn the_graph_is_large_and_its_values_lie_beside_the_curve() -> Result<()> {
    let scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    page.click("button", "Skip the tour")?;
    spin(page, "+100", 97..=103)?;
    let view = View::DESKTOP;
    look(page, view)?;
    let graph = in_sight(page, view, "img", "Speed and current")?;
    // Its legend is beside it.
    assert!(
        graph.height() >= 160.0 && graph.width() >= 600.0,
        "{graph:?}"
    );

    page.click("button", "Pause")?;
    page.find_like("img", "Speed and current")?.focus()?;
    page.press("ArrowLeft")?;
    let values = wait_until("the crosshair", WAIT_MAX, || {
        Ok(match page.find_all("status", "Crosshair")?.pop() {
            Some(values) => Ok(values),
            None => Err("none".to_owned()),
        })
    })?;
    let values = Place::of(&values)?;
    assert!(!values.covers(graph), "{values:?} over {graph:?}");
    page.click("button", "Resume")?;

    page.click("button", "Expand")?;
    let expanded = in_sight(page, view, "img", "Speed and current")?;
    assert!(
        expanded.height() > 600.0 && expanded.width() > 1_100.0,
        "{expanded:?}"
    );
    all_in_sight(
        page,
        view,
        &[STOP, ("button", "Motor 0x01"), ("button", "Shrink")],
    )?;

    let picture = page.download("PNG")?.bytes()?;
    let size =
        |at: usize| -> Result<u32> { Ok(u32::from_be_bytes(picture[at..at + 4].try_into()?)) };
    let (width, height) = (size(16)?, size(20)?);
    assert!(width >= 1_600 && height >= 900, "{width} x {height}");
    page.click("button", "Shrink")?;
    assert_eq!(in_sight(page, view, "img", "Speed and current")?, graph);
    Ok(())
}
