//! The panel of the rover, in the place of the single wheel.

use std::{cell::RefCell, rc::Rc};

use leptos::{html, prelude::*};
use motorlink_i18n::tr;
use motorlink_messages::experiments::vehicle::{Geometry, Vehicle};
use web_sys::Element;

use crate::{
    features::rover::{
        painter::Painter,
        picture::{Scale, cards, picture},
        state::Rover,
    },
    model::vehicle::vehicle_of,
    ui::{
        animation::{Frames, Next},
        button::PressButton,
        frame_rate::frame_rate,
        reactive::{dynamic, effect, memo},
    },
};

/// At a standstill the figures change as often as those of the rest of the page.
const RESTING_PERIOD_MS: f64 = 100.0;
/// How often the path is continued while it is not shown.
const UNSEEN_PERIOD_MS: f64 = 1_000.0;

/// The frame of the panel, in which the drawing of a vehicle is set.
fn frame() -> String {
    let figure = |id: &str, name: &str| {
        format!(
            "<span class=\"rover-figure\"><span aria-hidden=\"true\">{name}</span>\
             <output id=\"rover-{id}\" aria-label=\"{name}\" aria-live=\"off\"></output></span>"
        )
    };
    [
        "<svg class=\"rover-picture\" role=\"img\" aria-label=\"",
        tr!("Rover"),
        "\"></svg><div class=\"rover-wheels\"></div><div class=\"rover-foot\">\
         <svg class=\"rover-map\" aria-hidden=\"true\"><use href=\"#rover-path\"/>\
         <path class=\"rover-here\" d=\"M0 -.6L.4 .5L0 .25L-.4 .5Z\"/></svg><p class=\"rover-figures\">",
        &figure("forward", tr!("Forward" as "motion")),
        &figure("turn", tr!("Turn")),
        &figure("driven", tr!("Driven")),
        &figure("heading", tr!("Heading")),
        "<span class=\"rover-gap-count\" id=\"rover-gap-count\"></span></p>\
         <p class=\"rover-key\" aria-hidden=\"true\"><span class=\"measured\">",
        tr!("measured"),
        "</span> <span class=\"commanded\">",
        tr!("commanded"),
        "</span></p></div>",
    ]
    .concat()
}

/// Region `Rover`, while the group is a vehicle, and the button that shows the single wheel instead.
#[component]
pub(crate) fn RoverPanel(rover: Rover) -> impl IntoView {
    let page = rover.page;
    let panel = NodeRef::<html::Section>::new();
    let vehicle = memo(move || page.motors.names.with(vehicle_of));
    let is_single = move || rover.is_single.get();
    let label = move || {
        let single = if is_single() {
            tr!("Rover")
        } else {
            tr!("Single wheel")
        };
        single.to_owned()
    };
    draw(rover, vehicle, panel);
    view! {
        <div
            class="rover-place"
            class:single=dynamic(is_single)
            hidden=dynamic(move || vehicle.with(Option::is_none))
        >
            <section
                class="panel rover-panel"
                aria-label=tr!("Rover")
                hidden=dynamic(is_single)
                node_ref=panel
                inner_html=frame()
            ></section>
            <div class="rover-acts">
                <span hidden=dynamic(is_single)>
                    <PressButton
                        label=tr!("Reset path")
                        class="button small"
                        hint=tr!("The path begins where the rover is now")
                        on_press=move || rover.reset_path()
                    />
                </span>
                <PressButton
                    label=Signal::derive(label)
                    class="button small"
                    hint=tr!("Switches between the rover and the wheel of the selected motor")
                    on_press=move || rover.switch()
                />
            </div>
        </div>
    }
}

/// Sets the drawing of each vehicle, and draws while the panel is shown.
fn draw(rover: Rover, vehicle: Memo<Option<Vehicle>>, panel: NodeRef<html::Section>) {
    let painter = Rc::new(RefCell::new(None::<Painter>));
    let to_paint = Rc::clone(&painter);
    let frames = Frames::new(move |now_ms| {
        let Some(vehicle) = vehicle.try_get_untracked().flatten() else {
            return Next::Woken;
        };
        rover.follow(&vehicle);
        if rover.is_single.get_untracked() {
            return Next::After(UNSEEN_PERIOD_MS);
        }
        let session = rover.page.present();
        let mut painter = to_paint.borrow_mut();
        let moves = painter
            .as_mut()
            .is_some_and(|painter| rover.trip.with_value(|trip| painter.paint(&session, trip)));
        Next::in_step(
            if moves {
                frame_rate().step_ms()
            } else {
                RESTING_PERIOD_MS
            },
            now_ms,
        )
    });
    let wake = frames.waker();
    effect(move || {
        let geometry = rover.geometry.get();
        rover.is_single.track();
        if let (Some(panel), Some(vehicle)) = (panel.get(), vehicle.get()) {
            set_drawing(&panel, &vehicle, geometry);
            *painter.borrow_mut() = Painter::of(&panel, &vehicle, geometry);
        }
        wake();
    });
    // Dropped with the panel; this ends the loop.
    StoredValue::new_local(Some(frames));
}

fn set_drawing(panel: &Element, vehicle: &Vehicle, geometry: Geometry) {
    let find = |selector| panel.query_selector(selector).ok().flatten();
    if let (Some(drawing), Some(wheels)) = (find(".rover-picture"), find(".rover-wheels")) {
        let scale = Scale::of(vehicle, geometry);
        // It fails for invalid names only.
        let _ = drawing.set_attribute("viewBox", &scale.view_box());
        drawing.set_inner_html(&picture(vehicle, geometry));
        wheels.set_inner_html(&cards(vehicle));
    }
}
