//! Tab `Position`.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::protocol::{Mode, PositionTarget, family::Model};

use crate::{
    features::drive::{
        actions::Drive,
        loop_panel::{loop_blocked_by, loop_panel, loop_start_blocked_by},
        stop_and_start::stop_and_start,
    },
    ui::{
        button::PressButton,
        dial::Dial,
        entry,
        number_field::NumberField,
        reactive::memo,
        slider::{Slider, marks},
    },
};

const MODE: Mode = Mode::Position;

/// Of the raw position, rounded.
const ONE_DEGREE: &str = "91";

const PRESETS: [(f32, &str); 4] = [(0.0, "0°"), (90.0, "90°"), (180.0, "180°"), (270.0, "270°")];

#[component]
pub(crate) fn PositionTab(drive: Drive) -> impl IntoView {
    let page = drive.page;
    let position = drive.targets.position;
    let disabled_reason = loop_blocked_by(page, MODE);
    let go_blocked_by = loop_start_blocked_by(page, MODE, [position]);
    // Others report the angle from another zero than the target's.
    let holds = memo(move || !page.model.get().has_separate_frames());
    let hint_of_angle = Signal::derive(move || {
        let words = match page.model.get() {
            Model::Ddsm115 | Model::Ddsm315 => tr!("Decreases at speed > 0"),
            Model::Ddsm210 => tr!("0° is where the loop was entered"),
            Model::Ddsm400 => tr!("0° is where the loop was entered (uncertain)"),
        };
        words.to_owned()
    });
    let preset = move |(degrees, label): (f32, &'static str)| {
        view! {
            <PressButton
                label=label
                class="button preset"
                disabled_reason=disabled_reason
                on_press=move || {
                    position.set(PositionTarget::from_degrees(degrees).into());
                    drive.start(MODE);
                }
            />
        }
    };
    let body = view! {
        <div class="dial-and-fields">
            <Dial target=position on_edit=move || drive.adjust(MODE) />
            <div class="fields">
                <NumberField
                    id="target-angle"
                    name=tr!("Target angle")
                    unit="°"
                    hint=hint_of_angle
                    target=position
                    entry=entry::ANGLE
                    on_edit=move || drive.adjust(MODE)
                />
                <NumberField
                    id="target-position"
                    name=tr!("Raw position")
                    unit=tr!("raw")
                    hint=tr!("32\u{202F}767 = 360°")
                    target=position
                    entry=entry::POSITION
                    on_edit=move || drive.adjust(MODE)
                />
            </div>
        </div>
        <Slider
            name=tr!("Target angle")
            unit="°"
            target=position
            entry=entry::ANGLE
            step=ONE_DEGREE
            marks=marks(["0°", "180°", "360°"])
            on_edit=move || drive.adjust(MODE)
        />
        <div class="button-row six">
            {PRESETS.map(preset).collect_view()}
            {stop_and_start(drive, MODE, tr!("Ends the motion"), go_blocked_by)}
        </div>
    };
    let hint = Signal::derive(move || {
        let words = if holds.get() {
            tr!("Stop holds the present angle. STOP brakes the wheel to a standstill.")
        } else {
            tr!("Stop and STOP brake the wheel to a standstill: this model cannot hold an angle.")
        };
        words.to_owned()
    });
    loop_panel(drive, MODE, go_blocked_by, hint, body)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arrow_key_moves_the_slider_by_a_degree() {
        let raw: i32 = PositionTarget::from_degrees(1.0).into();
        assert_eq!(raw.to_string(), ONE_DEGREE);
    }
}
