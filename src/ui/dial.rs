//! A dial that is dragged to an angle: straight up is 0°, and angles grow clockwise like those of the wheel.

use leptos::{prelude::*, svg::Svg};
use motorlink_i18n::{terms::in_language, tr};
use motorlink_messages::protocol::PositionTarget;
use web_sys::{KeyboardEvent, PointerEvent};

use crate::ui::{
    entry::ANGLE,
    mathematics,
    reactive::{dynamic, handler},
    target::Target,
};

/// Radius of the drawing, with its middle at the origin.
const RADIUS: f64 = 50.0;

#[component]
pub(crate) fn Dial(
    /// Raw position.
    target: Target,
    /// Called with every new value that the user enters here.
    #[prop(into)]
    on_edit: Callback<()>,
) -> impl IntoView {
    let dial = NodeRef::<Svg>::new();
    let degrees = move || ANGLE.shown(target.get());
    let turn_to = move |event: &PointerEvent| {
        if let Some(dial) = dial.get_untracked() {
            let place = dial.get_bounding_client_rect();
            let x = number(event.client_x()) - place.x() - place.width() / 2.0;
            let y = number(event.client_y()) - place.y() - place.height() / 2.0;
            target.set(raw_of(bearing(x, y)));
            on_edit.run(());
        }
    };
    let dragging = move |event: &PointerEvent| {
        dial.get_untracked()
            .is_some_and(|dial| dial.has_pointer_capture(event.pointer_id()))
    };
    view! {
        <svg
            class="dial"
            viewBox="-60 -60 120 120"
            role="slider"
            aria-label=tr!("Target angle dial")
            aria-valuemin="0"
            aria-valuemax="360"
            aria-valuenow=dynamic(move || format!("{:.0}", degrees()))
            aria-valuetext=dynamic(move || tr!("{angle} degrees", angle = in_language(format!("{:.1}", degrees()))))
            tabindex="0"
            node_ref=dial
            on:pointerdown=handler(move |event: PointerEvent| {
                if let Some(dial) = dial.get_untracked() {
                    // Without capture the drag ends at the edge of the dial, which is harmless.
                    let _ = dial.set_pointer_capture(event.pointer_id());
                }
                turn_to(&event);
            })
            on:pointermove=handler(move |event: PointerEvent| {
                if dragging(&event) {
                    turn_to(&event);
                }
            })
            on:keydown=handler(move |event: KeyboardEvent| {
                let by = match event.key().as_str() {
                    "ArrowUp" | "ArrowRight" => ANGLE.step,
                    "ArrowDown" | "ArrowLeft" => -ANGLE.step,
                    "PageUp" => ANGLE.page,
                    "PageDown" => -ANGLE.page,
                    _ => return,
                };
                event.prevent_default();
                target.set(ANGLE.moved(target.get_untracked(), by));
                on_edit.run(());
            })
            inner_html=dynamic(move || face(degrees()))
        ></svg>
    }
}

/// Pointer coordinates are integers or floats, depending on the version of the browser's interface.
fn number(pixels: impl Into<f64>) -> f64 {
    pixels.into()
}

/// The content of the dial at an angle.
fn face(degrees: f64) -> String {
    let ticks: String = (0..12).map(tick).collect();
    format!(
        "<circle class=\"dial-track\" r=\"50\"/><path class=\"dial-arc\" d=\"{}\"/>{ticks}\
         <g transform=\"rotate({degrees:.2})\">\
         <line class=\"dial-hand\" x1=\"0\" y1=\"-14\" x2=\"0\" y2=\"-42\"/>\
         <circle class=\"dial-knob\" cx=\"0\" cy=\"-50\" r=\"7\"/></g>\
         <circle class=\"dial-hub\" r=\"5\"/>",
        arc(degrees)
    )
}

fn tick(number: i32) -> String {
    let inner = if number % 3 == 0 { -36 } else { -39 };
    format!(
        "<line class=\"dial-tick\" x1=\"0\" x2=\"0\" y1=\"{inner}\" y2=\"-43\" transform=\"rotate({})\"/>",
        number * 30
    )
}

/// Degrees clockwise from straight up; `x` grows to the right and `y` downwards.
fn bearing(x: f64, y: f64) -> f64 {
    mathematics::modulo(mathematics::atan2(x, -y), 360.0)
}

/// The raw position of whole degrees, the resolution of a drag.
#[allow(
    clippy::cast_possible_truncation,
    reason = "whole degrees up to 360 are exact in any float"
)]
fn raw_of(degrees: f64) -> i32 {
    PositionTarget::from_degrees(degrees.round() as f32).into()
}

/// The arc from straight up clockwise to an angle, as path data.
fn arc(degrees: f64) -> String {
    // A full turn ends at its start, and SVG draws no such arc.
    let (sin, cos) = mathematics::sin_cos(degrees.min(359.9));
    let large = i32::from(degrees > 180.0);
    format!(
        "M0 -50A50 50 0 {large} 1 {:.2} {:.2}",
        RADIUS * sin,
        -RADIUS * cos
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_up_is_zero_and_angles_grow_clockwise() {
        for (x, y, degrees) in [
            (0.0, -9.0, 0.0),
            (9.0, 0.0, 90.0),
            (0.0, 9.0, 180.0),
            (-9.0, 0.0, 270.0),
        ] {
            assert!((bearing(x, y) - degrees).abs() < 1e-9);
        }
    }

    #[test]
    fn a_drag_ends_at_whole_degrees_in_range() {
        assert_eq!(raw_of(0.0), 0);
        assert_eq!(raw_of(89.7), 8_192);
        assert_eq!(raw_of(359.9), 32_767);
    }

    #[test]
    fn the_arc_goes_the_long_way_past_half_a_turn() {
        assert_eq!(arc(90.0), "M0 -50A50 50 0 0 1 50.00 -0.00");
        assert!(arc(270.0).contains(" 0 1 1 -50.00 "));
    }
}
