//! The fields of the measures, in the panel `Drive together`.

use leptos::prelude::*;
use motorlink_i18n::tr;

use crate::{
    features::rover::{
        geometry::{RADIUS, TRACK},
        state::Rover,
    },
    model::vehicle::vehicle_of,
    ui::{
        number_field::NumberField,
        reactive::{dynamic, memo},
    },
};

/// Fields `Wheel radius` and `Track width`, while the group is a vehicle.
#[component]
pub(crate) fn GeometryFields(rover: Rover) -> impl IntoView {
    let names = rover.page.motors.names;
    let is_vehicle = memo(move || names.with(|names| vehicle_of(names).is_some()));
    view! {
        <div class="rover-measures" hidden=dynamic(move || !is_vehicle.get())>
            <NumberField
                id="wheel-radius"
                name=tr!("Wheel radius")
                unit="mm"
                hint=tr!("Used to calculate speed and path.")
                target=rover.radius
                entry=RADIUS
                on_edit=move || rover.measure()
            />
            <NumberField
                id="track-width"
                name=tr!("Track width")
                unit="mm"
                hint=tr!("Tyre centre to tyre centre.")
                target=rover.track
                entry=TRACK
                on_edit=move || rover.measure()
            />
        </div>
    }
}
