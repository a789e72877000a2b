//! The button `Keep run`, and the row of the kept run: its name, the event at which both are aligned, and a shift by hand.

use leptos::prelude::*;
use motorlink_i18n::tr;

use crate::{
    features::graph::{
        kept::{
            alignment::Align,
            state::{self, Shown},
        },
        state::Chart,
    },
    ui::{
        button::PressButton,
        reactive::{dynamic, handler},
    },
};

/// The longest shift by hand: as long as the history is, both ways.
const SHIFT_MS_MAX: i32 = 600_000;

/// The button `Keep run`.
#[component]
pub(crate) fn KeepButton(chart: Chart) -> impl IntoView {
    let blocked_by = move || {
        chart.page.shown.track();
        let id = chart.page.selected.get();
        let history = chart.page.history;
        let has_data = history.with_value(|history| {
            let track = history.track(id);
            track.is_some_and(|track| track.newest().is_some())
        });
        (!has_data).then(|| tr!("No data yet.").to_owned())
    };
    view! {
        <PressButton
            class="button small graph-keep"
            label=tr!("Pin as reference")
            hint=tr!(
                "Keeps the curves of this motor and draws them under the next run, of a motor or of a recording."
            )
            disabled_reason=Signal::derive(blocked_by)
            on_press=move || state::keep(chart)
        />
    }
}

/// The row of the kept run, while there is one.
#[component]
pub(crate) fn KeptRun(chart: Chart) -> impl IntoView {
    let shown = Shown {
        name: RwSignal::new(String::new()),
        is_missing: RwSignal::new(false),
    };
    state::show_in(shown);
    let (align, _) = state::chosen();
    let by_ms = RwSignal::new(String::new());
    // Another run begins without a shift.
    Effect::new(move |_| {
        shown.name.track();
        by_ms.set(state::chosen().1.to_string());
    });
    let choose = move |event: web_sys::Event| {
        let key = event_target_value(&event);
        if let Some(align) = Align::ALL.into_iter().find(|align| align.key() == key) {
            state::choose(chart, align, state::chosen().1);
        }
    };
    let shift = move |event: web_sys::Event| {
        let (align, before) = state::chosen();
        // What is no number is replaced by the last one.
        let entered = event_target_value(&event).trim().parse::<i32>();
        let entered = entered.map_or(before, |ms| ms.clamp(-SHIFT_MS_MAX, SHIFT_MS_MAX));
        state::choose(chart, align, entered);
        by_ms.set(entered.to_string());
        by_ms.notify();
    };
    let option = move |of: Align| {
        let name = match of {
            Align::Start => tr!("Start" as "of a run"),
            Align::NewTarget => tr!("New target"),
            Align::Stop => tr!("Stop" as "of a run"),
        };
        view! {
            <option value=of.key() selected=of == align>
                {name}
            </option>
        }
    };
    view! {
        <div
            class="graph-kept"
            role="group"
            aria-label=tr!("Reference")
            hidden=dynamic(move || shown.name.with(String::is_empty))
        >
            <span class="graph-kept-name">{dynamic(move || shown.name.get())}</span>
            <label>
                <span>{tr!("Align at")}</span>
                <select class="select" aria-label=tr!("Align at") on:change=handler(choose)>
                    {Align::ALL.map(option)}
                </select>
            </label>
            <label>
                <span>{tr!("Shift")}</span>
                <input
                    type="number"
                    class="graph-shift"
                    aria-label=tr!("Shift")
                    step="10"
                    prop:value=dynamic(move || by_ms.get())
                    on:change=handler(shift)
                />
                "ms"
            </label>
            <PressButton
                class="button small"
                label=tr!("Remove")
                name=tr!("Remove the reference")
                on_press=move || state::remove(chart)
            />
            <span role="status" class="quiet">
                {dynamic(move || {
                    let is_missing = shown.is_missing.get();
                    if is_missing { tr!("One of the runs has no such event here.") } else { "" }
                })}
            </span>
        </div>
    }
}
