//! The command rate, of all loops.

use leptos::prelude::*;
use motorlink_i18n::tr;

use crate::{
    model::page::use_page,
    ui::{entry, number_field::NumberField},
};

#[component]
pub(crate) fn CommandRate() -> impl IntoView {
    let page = use_page();
    let rate = page.settings.rate;
    view! {
        <div class="command-rate">
            <NumberField
                id="command-rate"
                name=tr!("Command rate")
                unit="Hz"
                hint=tr!("50 Hz or more, if the line allows it")
                target=rate
                entry=entry::RATE
                on_edit=move || page.set_rate(rate.get_untracked())
            />
        </div>
    }
}
