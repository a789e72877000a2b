//! How motors are driven, whichever the loop.

use leptos::prelude::*;
use motorlink_i18n::tr;

use crate::{
    model::desk::use_desk,
    ui::{
        entry,
        number_field::NumberField,
        reactive::{heard, live},
    },
};

#[component]
pub(crate) fn Settings() -> impl IntoView {
    let desk = use_desk();
    let rate = desk.targets.rate;
    let keep_driving = move || desk.preferences.with(|chosen| chosen.keep_driving);
    view! {
        <div class="settings">
            <NumberField
                id="command-rate"
                name=tr!("Command rate")
                unit="Hz"
                hint=tr!("The motor wants 50 or more")
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
                {tr!("Keep driving while hidden")}
            </label>
        </div>
    }
}
