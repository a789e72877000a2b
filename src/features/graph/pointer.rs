//! Pointer, wheel and keys on the graph.

use leptos::prelude::*;
use motorlink_messages::protocol::Instant;
use wasm_bindgen::JsCast;
use web_sys::{Element, KeyboardEvent, PointerEvent, WheelEvent};

use crate::{
    features::graph::{
        plot::{keys, view::Watch},
        state::{Chart, Crosshair, Drag},
    },
    model::{
        history::ZERO_US,
        replay::{self, Crossing},
    },
    ui::mathematics::limited,
};

/// A pointer that moves less than this between down and up is a click, in CSS pixels.
const CLICK_PX: f64 = 3.0;

/// Maximal pixels that count for one wheel event: a notch of a mouse is 100 or more, an event of a trackpad a few.
const WHEEL_MAX: f64 = 50.0;
/// The zoom of an event of [`WHEEL_MAX`], in percent.
const WHEEL_ZOOM: f64 = 20.0;
/// Pixels per line, for wheels that report lines.
const LINE_PX: f64 = 16.0;

/// The distances of an event from the left and from the top of the graph, in CSS pixels.
fn place(event: &web_sys::MouseEvent) -> (f64, f64) {
    let graph = event
        .current_target()
        .and_then(|target| target.dyn_into::<Element>().ok());
    let corner = graph.map_or((0.0, 0.0), |graph| {
        let graph = graph.get_bounding_client_rect();
        (graph.left(), graph.top())
    });
    (
        number(event.client_x()) - corner.0,
        number(event.client_y()) - corner.1,
    )
}

/// Pointer coordinates are integers or floats, depending on the version of the browser's interface.
fn number(pixels: impl Into<f64>) -> f64 {
    pixels.into()
}

pub(crate) fn down(chart: Chart, event: &PointerEvent) {
    if event.button() != 0 {
        return;
    }
    let (x, y) = place(event);
    let mut view = chart.view.get_untracked();
    if view.is_live() {
        // A drag moves the period under the pointer, so the view must not follow the time.
        view.watch = Watch::Panned(chart.now_us());
    }
    chart.drag.set(Some(Drag {
        from: (x, y),
        view,
        pane: chart.pane_at(y).map(|(pane, _)| pane),
        is_box: event.shift_key() || chart.zooms_box.get_untracked(),
        begun: false,
    }));
    chart.crosshair.set(Crosshair::Pointer(x));
    chart.wake();
}

pub(crate) fn moved(chart: Chart, event: &PointerEvent) {
    let (x, y) = place(event);
    chart.crosshair.set(Crosshair::Pointer(x));
    if let Some(mut drag) = chart.drag.get() {
        let (from_x, from_y) = drag.from;
        let by_px = x - from_x;
        if !drag.begun && by_px.abs().max((y - from_y).abs()) >= CLICK_PX {
            drag.begun = true;
            if let Some(target) = event.current_target()
                && let Ok(element) = target.dyn_into::<Element>()
            {
                // Without capture the drag ends at the edge of the graph, which is harmless.
                let _ = element.set_pointer_capture(event.pointer_id());
            }
        }
        chart.drag.set(Some(drag));
        if drag.begun && drag.is_box {
            chart.zoom_box.set(Some([drag.from, (x, y)]));
        } else if drag.begun {
            let columns = by_px * chart.layout.get().ratio;
            let width = f64::from(chart.layout.get().columns().max(1));
            let by_us = drag.view.part_us(-columns / width);
            chart.show(drag.view.panned(by_us, chart.reach()));
            pan_values(chart, drag, y);
        }
    }
    chart.wake();
}

/// A scale that the user has chosen moves with the pointer; a fitted one stays fitted.
fn pan_values(chart: Chart, drag: Drag, y: f64) {
    let fitting = chart.fitting.get_untracked();
    if let Some(pane) = drag
        .pane
        .filter(|pane| fitting.zoomed(pane.trace).is_some())
    {
        let count = chart.traces.get_untracked().panes().len();
        let at = |y| chart.layout.get().place_in(count, pane.place, y);
        let by = at(drag.from.1) - at(y);
        chart.fit(fitting.with(pane.trace, pane.scale.part(pane.trace, (by, 1.0 + by))));
    }
}

/// The end of a drag. A click moves the second cursor; without one, it goes to that time of a replay.
pub(crate) fn up(chart: Chart) {
    let drag = chart.drag.take();
    let zoom_box = chart.zoom_box.take();
    let layout = chart.layout.get();
    let click = drag.filter(|drag| !drag.begun);
    let column = click.map(|drag| layout.column(drag.from.0));
    // Beside the plot are the labels of the axes.
    let columns = f64::from(layout.columns());
    if let Some(column) = column.filter(|column| (0.0..=columns).contains(column)) {
        let at_us = chart.grid.get().moment_us(column);
        // While there is a second cursor, a click is for it.
        match chart.reference.get_untracked() {
            Some(_) => chart.move_reference(Some(at_us)),
            None => {
                go_to(at_us);
            }
        }
    }
    if let (Some(pane), Some(corners)) = (drag.and_then(|drag| drag.pane), zoom_box) {
        chart.zoom_to(pane, corners);
    }
    chart.wake();
}

/// A replay goes to this time of the history's clock. Returns whether there is a replay.
fn go_to(at_us: u64) -> bool {
    at_us.checked_sub(ZERO_US).is_some_and(|at_us| {
        let moment = Crossing::Moment(Instant::from_micros(at_us));
        replay::keeps(moment)
    })
}

/// The pointer has left the graph, or the browser uses it for its own gesture.
pub(crate) fn left(chart: Chart) {
    chart.drag.set(None);
    chart.zoom_box.set(None);
    if let Crosshair::Pointer(_) = chart.crosshair.get() {
        chart.crosshair.set(Crosshair::None);
        chart.wake();
    }
}

/// Vertical movement zooms around the pointer: the values at the left of the plot, else the time. Horizontal movement
/// pans.
pub(crate) fn wheel(chart: Chart, event: &WheelEvent) {
    // Ctrl and wheel is the zoom of the browser.
    if event.ctrl_key() {
        return;
    }
    event.prevent_default();
    let unit = match event.delta_mode() {
        WheelEvent::DOM_DELTA_PIXEL => 1.0,
        _ => LINE_PX,
    };
    let (across, down) = (event.delta_x() * unit, event.delta_y() * unit);
    if across.abs() > down.abs() {
        let view = chart.view.get_untracked();
        let width = f64::from(chart.layout.get().columns().max(1));
        let by_us = view.part_us(across * chart.layout.get().ratio / width);
        chart.show(view.panned(by_us, chart.reach()));
    } else {
        let zoom = limited(down, -WHEEL_MAX, WHEEL_MAX) / WHEEL_MAX * WHEEL_ZOOM;
        let (x, y) = place(event);
        let layout = chart.layout.get();
        match chart.pane_at(y).filter(|_| layout.column(x) < 0.0) {
            Some((pane, at)) => chart.zoom_values(pane.trace, 100.0 + zoom, at),
            None => chart.zoom(percent(zoom), layout.part(x)),
        }
    }
}

/// At least one percent in either direction, so that small movements have an effect.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "between 80 and 120"
)]
fn percent(zoom: f64) -> u64 {
    if zoom < 0.0 {
        (100.0 + zoom).floor() as u64
    } else {
        (100.0 + zoom).ceil() as u64
    }
}

pub(crate) fn key(chart: Chart, event: &KeyboardEvent) {
    let modified = event.ctrl_key() || event.alt_key() || event.meta_key();
    let paused = chart.view.get_untracked().is_paused();
    if event.key() == "Enter"
        && !modified
        && let Crosshair::Moment(at_us) = chart.crosshair.get()
    {
        if go_to(at_us) {
            event.prevent_default();
        }
        return;
    }
    if let Some(action) = keys::graph_action(&event.key(), modified, event.shift_key(), paused) {
        event.prevent_default();
        chart.run(action);
    }
}
