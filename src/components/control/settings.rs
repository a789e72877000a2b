//! How motors are driven, whichever the loop.

use leptos::prelude::*;

use crate::components::live::{heard, live};

use super::{number_field::NumberField, setup};
use crate::{desk::use_desk, entry};

const WHAT_LIMITS_DO: &str =
    "A driven motor that turns faster, gets hotter, or draws more for half a second is stopped";

#[component]
pub(super) fn Settings() -> impl IntoView {
    let desk = use_desk();
    let rate = desk.targets.rate;
    let keep_driving = move || desk.preferences.with(|chosen| chosen.keep_driving);
    setup::keep_working(desk);
    view! {
        <div class="settings">
            <NumberField
                name="Command rate"
                unit="Hz"
                hint="The motor wants 50 or more"
                target=rate
                entry=entry::RATE
                on_edit=move || desk.set_rate(rate.get_untracked())
            />
            <label class="check">
                <input
                    type="checkbox"
                    prop:checked=live(keep_driving)
                    on:change=heard(move |event| {
                        let checked = event_target_checked(&event);
                        desk.prefer(|preferences| preferences.keep_driving = checked);
                    })
                />
                "Keep driving while hidden"
            </label>
            <div class="limits" role="group" aria-label="Limits" title=WHAT_LIMITS_DO>
                <span class="field-name">"Stops above"</span>
                {[
                    ("Speed limit", "rpm", desk.targets.speed_limit, entry::SPEED_LIMIT),
                    ("Current limit", "A", desk.targets.current_limit, entry::CURRENT_LIMIT),
                    (
                        "Temperature limit",
                        "°C",
                        desk.targets.temperature_limit,
                        entry::TEMPERATURE_LIMIT,
                    ),
                ]
                    .map(|(name, unit, target, entry)| {
                        view! {
                            <NumberField name unit target entry on_edit=move || desk.set_limits() />
                        }
                    })}
            </div>
            <div class="setup" inner_html=setup::MARKUP></div>
        </div>
    }
}
