//! The height of the graph: its edge is dragged, or moved by keys, and remembered.
//!
//! The style sheet bounds the height in every window, so that no control goes out of sight.

use leptos::{html::Div, prelude::*};
use motorlink_i18n::tr;
use wasm_bindgen::JsCast;
use web_sys::{Element, HtmlElement, KeyboardEvent, PointerEvent};

use crate::{
    model::graph_height,
    ui::reactive::{dynamic, handler},
};

/// The heights that can be entered, in CSS pixels. The style sheet allows less in most windows.
const HEIGHT_PX: (i32, i32) = (150, 2_000);

/// An arrow key moves the edge by this, in CSS pixels.
const STEP_PX: i32 = 20;

/// A drag of the edge.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Drag {
    from_y: f64,
    from_px: i32,
}

/// Separator `Height of the graph`.
#[component]
pub(crate) fn Edge() -> impl IntoView {
    let edge = NodeRef::<Div>::new();
    let drag = StoredValue::new_local(None::<Drag>);
    let height = RwSignal::new(0);
    let measure = move || {
        if let Some(panel) = edge.get_untracked().and_then(|edge| panel(&edge)) {
            height.set(panel.offset_height());
        }
    };
    let move_to = move |height_px: i32| {
        graph_height::show(Some(height_px.clamp(HEIGHT_PX.0, HEIGHT_PX.1)));
        measure();
    };
    // What the style sheet made of it, so that the next drag begins there.
    let remember = move || graph_height::remember(Some(height.get_untracked()));
    let down = move |event: PointerEvent| {
        let Some(edge) = edge.get_untracked().filter(|_| event.button() == 0) else {
            return;
        };
        measure();
        // Without capture the drag ends at the edge.
        let _ = edge.set_pointer_capture(event.pointer_id());
        let from_px = height.get_untracked();
        let from_y = number(event.client_y());
        drag.set_value(Some(Drag { from_y, from_px }));
    };
    let moved = move |event: PointerEvent| {
        if let (Some(drag), Some(edge)) = (drag.get_value(), edge.get_untracked()) {
            let by_px = whole(number(event.client_y()) - drag.from_y);
            move_to(drag.from_px + grows(&edge) * by_px);
        }
    };
    let up = move |_| {
        if drag.get_value().is_some() {
            drag.set_value(None);
            remember();
        }
    };
    let key = move |event: KeyboardEvent| {
        let Some(edge) = edge.get_untracked() else {
            return;
        };
        let by_px = match event.key().as_str() {
            "ArrowUp" => -STEP_PX,
            "ArrowDown" => STEP_PX,
            _ => return,
        };
        event.prevent_default();
        measure();
        move_to(height.get_untracked() + grows(&edge) * by_px);
        remember();
    };
    view! {
        <div
            class="graph-edge"
            role="separator"
            aria-orientation="horizontal"
            aria-label=tr!("Height of the graph")
            aria-valuemin=HEIGHT_PX.0
            aria-valuemax=HEIGHT_PX.1
            aria-valuenow=dynamic(move || height.get().max(HEIGHT_PX.0).to_string())
            title=tr!("Drag it, or press the arrow keys up and down. A double click resets it.")
            tabindex="0"
            node_ref=edge
            on:focus=handler(move |_| measure())
            on:pointerdown=handler(down)
            on:pointermove=handler(moved)
            on:pointerup=handler(up)
            on:pointercancel=handler(up)
            on:dblclick=handler(move |_| {
                graph_height::show(None);
                graph_height::remember(None);
                measure();
            })
            on:keydown=handler(key)
        ></div>
    }
}

/// The panel of the graph.
fn panel(edge: &Element) -> Option<HtmlElement> {
    edge.parent_element()?.dyn_into().ok()
}

/// 1 if the graph grows downwards: where the page scrolls, the edge is the lower one.
fn grows(edge: &Element) -> i32 {
    let Some(panel) = panel(edge) else {
        return -1;
    };
    let (edge, panel) = (
        edge.get_bounding_client_rect(),
        panel.get_bounding_client_rect(),
    );
    if edge.top() - panel.top() > panel.height() / 2.0 {
        1
    } else {
        -1
    }
}

/// Pointer coordinates are integers or floats, depending on the version of the browser's interface.
fn number(pixels: impl Into<f64>) -> f64 {
    pixels.into()
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "a float cast saturates, and a part of a pixel is nothing to see"
)]
fn whole(pixels: f64) -> i32 {
    pixels as i32
}
