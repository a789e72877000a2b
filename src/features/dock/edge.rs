//! The upper edge of the dock: it is dragged, or moved by keys, and the height is remembered.
//!
//! The style sheet bounds the height in every window, so that no control goes out of sight.

use leptos::{html::Div, prelude::*};
use motorlink_i18n::tr;
use wasm_bindgen::JsCast;
use web_sys::{Element, HtmlElement, KeyboardEvent, PointerEvent};

use crate::{
    model::dock,
    ui::{
        reactive::{dynamic, effect, handler},
        size_watch::SizeWatch,
    },
};

/// Higher than any window, in CSS pixels.
const FAR_PX: i32 = 100_000;

/// An arrow key moves the edge by this, in CSS pixels.
const STEP_PX: i32 = 20;

/// A drag of the edge.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Drag {
    from_y: f64,
    from_px: i32,
}

/// Separator `Height of graph and packet log`.
#[component]
pub(crate) fn Edge() -> impl IntoView {
    let edge = NodeRef::<Div>::new();
    let drag = StoredValue::new_local(None::<Drag>);
    let height = RwSignal::new(0);
    // Until the edge is used, every height is possible.
    let bounds = RwSignal::new((0, FAR_PX));
    let watch = StoredValue::new_local(None::<SizeWatch>);
    effect(move || {
        let dock = edge.get().and_then(|edge| dock_of(&edge));
        watch.set_value(dock.and_then(|dock| {
            let watched = dock.clone();
            SizeWatch::of(&dock, move || {
                let _ = height.try_set(watched.offset_height());
            })
        }));
    });
    let measure_bounds = move || {
        if let Some(dock) = edge.get_untracked().and_then(|edge| dock_of(&edge)) {
            bounds.set(bounds_px(&dock));
        }
    };
    let move_to = move |height_px: i32| {
        if let Some(dock) = edge.get_untracked().and_then(|edge| dock_of(&edge)) {
            resize(&dock, height_px);
            height.set(dock.offset_height());
        }
    };
    // The height that the style sheet allows, so that the next drag begins there.
    let remember = move || dock::remember_height(Some(height.get_untracked()));
    let down = move |event: PointerEvent| {
        let Some(edge) = edge.get_untracked().filter(|_| event.button() == 0) else {
            return;
        };
        measure_bounds();
        // Without capture the drag ends at the edge.
        let _ = edge.set_pointer_capture(event.pointer_id());
        let from_px = height.get_untracked();
        let from_y = number(event.client_y());
        drag.set_value(Some(Drag { from_y, from_px }));
    };
    let moved = move |event: PointerEvent| {
        if let Some(drag) = drag.get_value() {
            move_to(drag.from_px - whole(number(event.client_y()) - drag.from_y));
        }
    };
    let up = move |_| {
        if drag.get_value().is_some() {
            drag.set_value(None);
            remember();
        }
    };
    let key = move |event: KeyboardEvent| {
        let height_px = height.get_untracked();
        let height_px = match event.key().as_str() {
            "ArrowUp" => height_px + STEP_PX,
            "ArrowDown" => height_px - STEP_PX,
            "Home" => 0,
            "End" => FAR_PX,
            _ => return,
        };
        event.prevent_default();
        move_to(height_px);
        remember();
    };
    view! {
        <div
            class="dock-edge"
            role="separator"
            aria-orientation="horizontal"
            aria-label=tr!("Height of graph and packet log")
            aria-valuemin=dynamic(move || bounds.get().0)
            aria-valuemax=dynamic(move || bounds.get().1)
            aria-valuenow=dynamic(move || height.get())
            title=tr!("Drag it, or press the arrow keys up and down. A double click resets it.")
            tabindex="0"
            node_ref=edge
            on:focus=handler(move |_| measure_bounds())
            on:pointerdown=handler(down)
            on:pointermove=handler(moved)
            on:pointerup=handler(up)
            on:pointercancel=handler(up)
            on:dblclick=handler(move |_| {
                dock::show_height(None);
                dock::remember_height(None);
            })
            on:keydown=handler(key)
        ></div>
    }
}

/// The dock. The edge is the first part of it.
fn dock_of(edge: &Element) -> Option<HtmlElement> {
    edge.parent_element()?.dyn_into().ok()
}

/// The least and the greatest height that the style sheet allows in this window.
fn bounds_px(dock: &HtmlElement) -> (i32, i32) {
    let shown = dock::height();
    dock::show_height(Some(0));
    let min_px = dock.offset_height();
    dock::show_height(Some(FAR_PX));
    let max_px = dock.offset_height();
    dock::show_height(shown);
    (min_px, max_px)
}

/// Shows a height, within its bounds. Where the page scrolls, the dock grows downwards: the page is scrolled by as much, so
/// that the edge stays under the pointer.
fn resize(dock: &HtmlElement, height_px: i32) {
    let top = || dock.get_bounding_client_rect().top();
    let (top_before, height_before_px) = (top(), dock.offset_height());
    dock::show_height(Some(height_px.clamp(0, FAR_PX)));
    let grown_px = dock.offset_height() - height_before_px;
    let by = top() - (top_before - f64::from(grown_px));
    if by.abs() >= 1.0 {
        window().scroll_by_with_x_and_y(0.0, by);
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
