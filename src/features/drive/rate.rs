//! The drive settings of all loops.

use leptos::prelude::*;
use motorlink_i18n::tr;

use crate::{
    model::page::use_page,
    ui::{
        entry,
        number_field::NumberField,
        reactive::{dynamic, handler},
    },
};

#[component]
pub(crate) fn Settings() -> impl IntoView {
    let page = use_page();
    let rate = page.settings.rate;
    let keep_driving = move || page.preferences.with(|chosen| chosen.keep_driving);
    view! {
        <div class="settings">
            <NumberField
                id="command-rate"
                name=tr!("Command rate")
                unit="Hz"
                hint=tr!("50 Hz or more, if the line allows it")
                target=rate
                entry=entry::RATE
                on_edit=move || page.set_rate(rate.get_untracked())
            />
            <label class="check">
                <input
                    type="checkbox"
                    prop:checked=dynamic(keep_driving)
                    on:change=handler(move |event| {
                        let checked = event_target_checked(&event);
                        page.prefer(|preferences| preferences.keep_driving = checked);
                    })
                />
                {tr!("Keep driving while hidden")}
            </label>
        </div>
    }
}
