//! Tab `Velocity`.

use leptos::prelude::*;
use motorlink_messages::protocol::{Mode, Setpoint};

use super::{
    number_field::NumberField,
    panel::{loop_panel, why_not_in, why_not_with},
    slider::{Slider, marks},
};
use crate::{
    components::button::PressButton, desk::use_desk, entry, format, permission::why_not_stop,
    tab::Tab,
};

const MODE: Mode = Mode::Velocity;

/// The keys of this tab.
const HINT: &str = "<span class=\"keys\"><kbd>F</kbd><kbd>B</kbd> forward, back <kbd>S</kbd> stop \
                    <kbd>K</kbd> brake <kbd>1</kbd>–<kbd>5</kbd> 50–250 rpm</span>";

#[component]
pub(super) fn VelocityTab() -> impl IntoView {
    let desk = use_desk();
    let targets = desk.targets;
    let why_not = why_not_in(desk, MODE);
    let why_not_start = why_not_with(desk, MODE, [targets.speed, targets.acceleration]);
    let why_not_preset = why_not_with(desk, MODE, [targets.acceleration]);
    let why_not_halt = desk.of_motor(|session, _| why_not_stop(session));
    let mirrored = desk.of_motor(|session, id| session.mirror(id).is_mirrored());
    let hint = Signal::derive(move || {
        let words = if mirrored.get() {
            "mirrored: + turns clockwise, seen from the face"
        } else {
            "+ turns counter-clockwise, seen from the face"
        };
        words.to_owned()
    });
    let ends = Signal::derive(move || {
        marks(if mirrored.get() {
            ["−330 CCW", "0", "+330 CW"]
        } else {
            ["−330 CW", "0", "+330 CCW"]
        })
    });
    let preset = move |rpm: i32, name| {
        view! {
            <PressButton
                label=format::signed(rpm)
                name=name
                class="button preset"
                why_not=why_not_preset
                on_press=move || desk.drive_at(rpm)
            />
        }
    };
    let body = view! {
        <NumberField
            name="Target speed"
            unit="rpm"
            hint=hint
            target=targets.speed
            entry=entry::SPEED
            on_edit=move || desk.adjust(MODE)
        />
        <Slider
            name="Target speed"
            unit="rpm"
            target=targets.speed
            entry=entry::SPEED
            marks=ends
            on_edit=move || desk.adjust(MODE)
        />
        <NumberField
            name="Acceleration"
            hint="Larger is gentler: about 3.6 ms per rpm for each unit"
            target=targets.acceleration
            entry=entry::ACCELERATION
            on_edit=move || desk.adjust(MODE)
        />
        <div class="button-row seven">
            {preset(-100, "-100")}
            {preset(-50, "-50")}
            <PressButton
                label="Stop"
                class="button halt"
                hint="Brakes to a standstill, then lets go"
                why_not=why_not_halt
                on_press=move || desk.stop_motor(Tab::Loop(MODE))
            />
            <PressButton
                label="Start"
                class="button primary"
                why_not=why_not_start
                on_press=move || desk.start(MODE)
            />
            <PressButton
                label="Brake"
                class="button brake"
                hint="Brakes and holds the brake"
                why_not=why_not
                on_press=move || desk.drive(Setpoint::Brake)
            />
            {preset(50, "+50")}
            {preset(100, "+100")}
        </div>
    };
    loop_panel(MODE, why_not_start, HINT, body)
}
