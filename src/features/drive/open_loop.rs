//! Tab `Open loop`.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::protocol::{Mode, OpenLoopTarget};

use crate::{
    features::drive::{
        actions::Drive,
        loop_panel::{loop_blocked_by, loop_panel, loop_start_blocked_by},
        stop_and_start::stop_and_start,
    },
    ui::{
        button::PressButton,
        entry, format,
        number_field::NumberField,
        slider::{Slider, marks},
    },
};

const MODE: Mode = Mode::OpenLoop;

/// Percent of the supply of the preset buttons, and their names.
const PRESETS: [(i32, &str); 5] = [
    (-20, "-20 %"),
    (-10, "-10 %"),
    (0, "0 %"),
    (10, "+10 %"),
    (20, "+20 %"),
];

#[component]
pub(crate) fn OpenLoopTab(drive: Drive) -> impl IntoView {
    let page = drive.page;
    let output = drive.targets.open_loop;
    let disabled_reason = loop_blocked_by(page, MODE);
    let start_blocked_by = loop_start_blocked_by(page, MODE, [output]);
    let mirrored = page.of_motor(|session, id| session.mirror(id).is_mirrored());
    let hint = Signal::derive(move || {
        let words = if mirrored.get() {
            tr!("±32\u{202F}767 = the whole supply; mirrored")
        } else {
            tr!("±32\u{202F}767 = the whole supply")
        };
        words.to_owned()
    });
    let preset = move |(percent, name): (i32, &'static str)| {
        view! {
            <PressButton
                label=format!("{} %", format::signed(percent))
                name=name
                class="button preset"
                disabled_reason=disabled_reason
                on_press=move || {
                    output.set(percent * OpenLoopTarget::MAX / 100);
                    drive.start(MODE);
                }
            />
        }
    };
    let body = view! {
        <NumberField
            id="target-output"
            name=tr!("Target output")
            unit=tr!("raw")
            hint=hint
            target=output
            entry=entry::OUTPUT
            on_edit=move || drive.adjust(MODE)
        />
        <Slider
            name=tr!("Target output")
            unit=tr!("raw")
            target=output
            entry=entry::OUTPUT
            marks=marks(["−100 %", "0", "+100 %"])
            on_edit=move || drive.adjust(MODE)
        />
        <p class="reason">
            {tr!(
                "No controller limits the speed. Begin with 10 %."
            )}
        </p>
        <div class="button-row five">{PRESETS.map(preset).collect_view()}</div>
        <div class="button-row two">
            {stop_and_start(drive, MODE, tr!("Brakes to a standstill: the last frame is a brake"), start_blocked_by)}
        </div>
    };
    let hint = tr!("Stop brakes the wheel to a standstill. The last frame is a brake.");
    loop_panel(drive, MODE, start_blocked_by, hint.to_owned().into(), body)
}
