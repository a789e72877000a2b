//! The dock with graph and packet log: its edge, its title and its tabs.

use anyhow::Result;
use end_to_end::{Line, Page, View, WAIT_MAX, wait_until};

use crate::fixture::{
    Scenario, assert_quiet_console,
    places::{LAPTOP, Place, STOP, WIDE, all_in_sight, in_sight, look},
};

const EDGE: (&str, &str) = ("separator", "Height of graph and packet log");
const TITLE: &str = "Graph and packet log";
const GRAPH: (&str, &str) = ("region", "Speed and current");
const LOG: (&str, &str) = ("region", "Packet log");

/// What keeps its place, however high the dock is.
const FIXED: [(&str, &str); 5] = [
    STOP,
    ("button", "Start"),
    ("button", "Stop"),
    ("button", "Brake"),
    ("button", "Setup"),
];

fn fixed(page: &Page, view: View) -> Result<Vec<Place>> {
    let place = |(role, name)| in_sight(page, view, role, name);
    FIXED.into_iter().map(place).collect()
}

fn is_shown(page: &Page, (role, name): (&str, &str)) -> Result<bool> {
    Ok(!page.find_all(role, name)?.is_empty())
}

#[test]
fn the_dock_is_resized_at_its_edge_and_stays_so_in_every_place() -> Result<()> {
    let scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    page.click("button", "Skip the tour")?;
    // The page does not scroll: the wheel gives the room.
    look(page, WIDE)?;
    let edge = || page.find(EDGE.0, EDGE.1);
    let graph = || in_sight(page, WIDE, GRAPH.0, GRAPH.1);
    let (before, controls) = (graph()?, fixed(page, WIDE)?);
    edge()?.drag_down(-60.0)?;
    let grown = graph()?;
    assert_near(grown.height(), before.height() + 60.0);
    assert_near(grown.bottom, before.bottom);
    assert_near(in_sight(page, WIDE, LOG.0, LOG.1)?.top, grown.top);
    edge()?.focus()?;
    page.press("ArrowDown")?;
    assert_near(graph()?.height(), before.height() + 40.0);
    // No control goes out of sight, however far it is dragged.
    page.press("End")?;
    assert!(graph()?.height() > grown.height());
    assert_eq!(fixed(page, WIDE)?, controls);
    all_in_sight(page, WIDE, &[("button", "+100")])?;
    edge()?.drag_down(40.0)?;
    let chosen = graph()?;
    assert_eq!(fixed(page, WIDE)?, controls);
    for place in ["Record", "Test", "Setup", "Diagnose"] {
        page.click("button", place)?;
        assert_eq!(graph()?, chosen, "{place}");
    }
    page.click("button", "Drive")?;

    page.reload()?;
    crate::fixture::connect(page)?;
    let reloaded = wait_until("the graph", WAIT_MAX, || {
        Ok(graph().map_err(|error| error.to_string()))
    })?;
    assert_eq!(reloaded, chosen);

    // The page scrolls: it is scrolled with the edge.
    look(page, LAPTOP)?;
    let height = || -> Result<f64> { Ok(Place::of(&page.find(GRAPH.0, GRAPH.1)?)?.height()) };
    edge()?.drag_down(60.0)?;
    let before = height()?;
    edge()?.drag_down(-30.0)?;
    assert_near(height()?, before + 30.0);
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn the_dock_folds_to_its_title_and_tabs_choose_where_there_is_no_room_for_both() -> Result<()> {
    let scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    page.click("button", "Skip the tour")?;
    let view = View::DESKTOP;
    look(page, view)?;
    let (graph, controls) = (in_sight(page, view, GRAPH.0, GRAPH.1)?, fixed(page, view)?);
    page.click("button", TITLE)?;
    assert_eq!(fixed(page, view)?, controls);
    for gone in [GRAPH, LOG, EDGE] {
        assert!(!is_shown(page, gone)?, "{gone:?}");
    }
    page.reload()?;
    crate::fixture::connect(page)?;
    let is_folded = || -> Result<bool> {
        Ok(is_shown(page, ("button", TITLE))? && !is_shown(page, GRAPH)? && !is_shown(page, LOG)?)
    };
    wait_until("the folded dock", WAIT_MAX, || {
        Ok(if is_folded()? {
            Ok(())
        } else {
            Err("not folded".to_owned())
        })
    })?;
    page.click("button", TITLE)?;
    assert_eq!(in_sight(page, view, GRAPH.0, GRAPH.1)?, graph);

    look(page, View::TABLET)?;
    assert!(is_shown(page, GRAPH)? && !is_shown(page, LOG)?);
    page.click("tab", "Packet log")?;
    assert!(!is_shown(page, GRAPH)? && is_shown(page, LOG)?);
    page.wait_for_text("log", "Packets", |text| !text.trim().is_empty())?;
    // One below the other.
    look(page, View::PHONE)?;
    assert!(is_shown(page, GRAPH)? && is_shown(page, LOG)? && !is_shown(page, EDGE)?);
    assert_quiet_console(page);
    Ok(())
}

/// To half a pixel.
fn assert_near(actual: f64, expected: f64) {
    assert!((actual - expected).abs() < 0.5, "{actual}, not {expected}");
}
