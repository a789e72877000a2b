//! Tab `Velocity`.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::protocol::{Mode, Setpoint, family::Model};

use crate::{
    features::drive::{
        actions::Drive,
        limit::{LimitLink, Quantity, or_refused, speed_refused},
        loop_panel::{loop_blocked_by, loop_panel, loop_start_blocked_by},
    },
    model::guards::stop_blocked_by,
    ui::{
        button::PressButton,
        entry, format,
        number_field::NumberField,
        slider::{Slider, marks},
    },
};

const MODE: Mode = Mode::Velocity;

/// The keys of this tab, as HTML. Which speeds the digits have depends on the limit, so the help has them.
fn hint() -> String {
    let keys = tr!(
        "<kbd>F</kbd><kbd>B</kbd> forward, back <kbd>S</kbd> stop <kbd>K</kbd> brake <kbd>1</kbd>–<kbd>5</kbd> preset speeds"
    );
    ["<span class=\"keys\">", keys, "</span>"].concat()
}

/// What a unit of the acceleration is.
fn acceleration_hint(model: Model) -> &'static str {
    match model {
        Model::Ddsm115 | Model::Ddsm315 => tr!("Higher = slower ramp (1 is about 3.6 ms per rpm)"),
        Model::Ddsm210 => tr!("Higher = slower ramp (1 is 1 or 0.1 ms per rpm: uncertain)"),
        Model::Ddsm400 => tr!("Higher = slower ramp (1 is about 1 ms per rpm)"),
    }
}

/// What the motor reaches if this speed is beyond that, else what a positive speed does.
fn speed_hint(model: Model, rpm: i32, mirrored: bool) -> &'static str {
    let nominal = &model.spec().nominal;
    if nominal.supply_v.is_some() && rpm.unsigned_abs() > nominal.no_load_rpm.into() {
        tr!("Reaches about 200 rpm at 18 V without load")
    } else if mirrored {
        tr!("Mirrored: + is clockwise, facing the wheel")
    } else {
        tr!("+ is counter-clockwise, facing the wheel")
    }
}

#[component]
pub(crate) fn VelocityTab(drive: Drive) -> impl IntoView {
    let page = drive.page;
    let targets = drive.targets;
    let disabled_reason = loop_blocked_by(page, MODE);
    let start = loop_start_blocked_by(page, MODE, [targets.speed, targets.acceleration]);
    let start_blocked_by = or_refused(page, start, move || targets.speed.get());
    let above_limit = Signal::derive(move || speed_refused(page, targets.speed.get()));
    let preset_blocked_by = loop_start_blocked_by(page, MODE, [targets.acceleration]);
    let limit = Box::leak(Box::new(move || page.speed_limit()));
    let speed_max = Box::leak(Box::new(move || page.speed_max()));
    let halt_blocked_by = page.of_motor(|session, _| stop_blocked_by(session));
    let mirrored = page.of_motor(|session, id| session.mirror(id).is_mirrored());
    let hint_of_speed = Signal::derive(move || {
        speed_hint(page.model.get(), targets.speed.get(), mirrored.get()).to_owned()
    });
    let ends = Signal::derive(move || {
        let (back, forward) = if mirrored.get() {
            (tr!("CCW"), tr!("CW"))
        } else {
            (tr!("CW"), tr!("CCW"))
        };
        let limit = page.speed_limit();
        marks([
            &format!("−{limit} {back}"),
            "0",
            &format!("+{limit} {forward}"),
        ])
    });
    // With a plus the label would read like a step up.
    let preset = move |rpm: i32, name, label: &'static str| {
        view! {
            <PressButton
                label=label
                name=name
                class="button preset"
                disabled_reason=or_refused(page, preset_blocked_by, move || rpm)
                on_press=move || drive.drive_at(rpm)
            />
        }
    };
    let body = view! {
        <NumberField
            id="target-speed"
            name=tr!("Target speed")
            unit=format::rpm()
            hint=hint_of_speed
            target=targets.speed
            entry=entry::SPEED
            limit=speed_max
            objection=above_limit
            on_edit=move || drive.adjust(MODE)
        />
        <Slider
            name=tr!("Target speed")
            unit=format::rpm()
            target=targets.speed
            entry=entry::SPEED
            limit=limit
            marks=ends
            on_edit=move || drive.adjust(MODE)
        />
        <LimitLink page quantity=Quantity::Speed />
        <NumberField
            id="acceleration"
            name=tr!("Acceleration")
            hint=Signal::derive(move || acceleration_hint(page.model.get()).to_owned())
            target=targets.acceleration
            entry=entry::ACCELERATION
            on_edit=move || drive.adjust(MODE)
        />
        <div class="button-row seven">
            {preset(-100, "-100", "\u{2212}100")}
            {preset(-50, "-50", "\u{2212}50")}
            <PressButton
                label=tr!("Stop")
                class="button halt"
                hint=tr!("Brakes to a standstill: the last frame is a brake")
                disabled_reason=halt_blocked_by
                on_press=move || drive.stop_motor()
            />
            <PressButton
                label=tr!("Start")
                class="button primary"
                disabled_reason=start_blocked_by
                on_press=move || drive.start(MODE)
            />
            <PressButton
                label=tr!("Brake")
                class="button brake"
                hint=tr!("Brakes and keeps braking")
                disabled_reason=disabled_reason
                on_press=move || drive.drive(Setpoint::Brake)
            />
            {preset(50, "+50", "50")}
            {preset(100, "+100", "100")}
        </div>
    };
    loop_panel(drive, MODE, start_blocked_by, hint().into(), body)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_speed_that_the_motor_does_not_reach_names_what_it_reaches() {
        let nominal = Model::Ddsm115.spec().nominal;
        let (rpm, volts) = (nominal.no_load_rpm, nominal.supply_v.unwrap());
        let expected = format!("Reaches about {rpm} rpm at {volts} V without load");
        for (target, is_beyond) in [
            (0, false),
            (200, false),
            (-200, false),
            (201, true),
            (-330, true),
        ] {
            let hint = speed_hint(Model::Ddsm115, target, false);
            assert_eq!(hint == expected, is_beyond, "{target}: {hint}");
        }
        // No source gives the voltage of the others' no-load speed.
        for model in [Model::Ddsm315, Model::Ddsm210, Model::Ddsm400] {
            let hint = speed_hint(model, 380, true);
            assert!(hint.starts_with("Mirrored"), "{model}: {hint}");
        }
    }
}
