//! The rows above the graph: windows, pause and now, and how it is looked at.

use leptos::prelude::*;
use motorlink_i18n::tr;

use crate::{
    features::graph::{
        kept::controls::KeepButton,
        legend, picture,
        plot::{keys::GraphAction, trace::Trace, view::WINDOWS},
        stage::StageCell,
        state::Chart,
    },
    ui::{
        button::PressButton,
        choice_keys::move_choice,
        reactive::{dynamic, handler},
    },
};

#[component]
pub(crate) fn Controls(chart: Chart, stage: StageCell) -> impl IntoView {
    let view = chart.view;
    let paused = move || view.with(|view| view.is_paused());
    let label = Signal::derive(move || {
        if paused() {
            tr!("Resume")
        } else {
            tr!("Pause")
        }
        .to_owned()
    });
    let live_already = Signal::derive(move || {
        let live = view.with(|view| view.is_live());
        live.then(|| tr!("The newest data is already shown.").to_owned())
    });
    let expand = Signal::derive(move || {
        if chart.expanded.get() {
            tr!("Shrink")
        } else {
            tr!("Expand")
        }
        .to_owned()
    });
    let is_certain = move || chart.page.model.get().spec().current.is_certain();
    let [ten, minute, five] = WINDOWS;
    view! {
        <div class="graph-head">
            <h2>
                {tr!("Speed and current")} " "
                // The name is shown whole or not at all.
                <span class="graph-of quiet">
                    {dynamic(move || {
                        let title = legend::title(chart);
                        title.replace(' ', "\u{A0}").replacen('\u{A0}', " ", 1)
                    })}
                </span>
            </h2>
            // The help says between which scales sources disagree.
            <button
                type="button"
                class="help-link"
                data-help="specifications"
                hidden=dynamic(is_certain)
            >
                {tr!("Scale of the current uncertain")}
            </button>
            <div
                class="graph-comparing"
                inner_html=legend::choice(chart.traces.get_untracked().compared)
                on:change=handler(move |event| {
                    let compared = Trace::from_class(&event_target_value(&event));
                    chart.traces.update(|traces| traces.compared = compared);
                    chart.wake();
                })
            ></div>
            <div class="graph-windows" role="radiogroup" aria-label=tr!("Window" as "of time")>
                <Window chart window=ten />
                <Window chart window=minute />
                <Window chart window=five />
            </div>
            <div class="graph-buttons">
                <PressButton
                    class="button small graph-pause"
                    label
                    hint=tr!("New values are still stored.")
                    on_press=move || chart.pause_or_resume()
                />
                <PressButton
                    class="button small"
                    label=tr!("Now")
                    disabled_reason=live_already
                    on_press=move || chart.follow()
                />
                <PressButton
                    class="button small graph-expand"
                    label=expand
                    hint=tr!("The graph takes the place of the other panels.")
                    on_press=move || chart.expanded.update(|expanded| *expanded = !*expanded)
                />
            </div>
            <Tools chart stage />
        </div>
    }
}

/// How the graph is looked at, its pictures, and the run to keep.
#[component]
fn Tools(chart: Chart, stage: StageCell) -> impl IntoView {
    let fitted_already = Signal::derive(move || {
        let zoomed = chart.fitting.with(|fitting| fitting.is_zoomed());
        (!zoomed).then(|| tr!("Each axis is fitted to its values.").to_owned())
    });
    view! {
        <div class="graph-tools">
            <Check
                label=tr!("Symmetric")
                checked=Signal::derive(move || chart.fitting.with(|fitting| fitting.symmetric))
                on_change=move |symmetric| {
                    chart.fitting.update(|fitting| fitting.symmetric = symmetric);
                    chart.wake();
                }
            />
            <Check
                label=tr!("Box zoom")
                hint=tr!("A drag with Shift does so too.")
                checked=chart.zooms_box
                on_change=move |on| chart.zooms_box.set(on)
            />
            <Check
                label=tr!("Second cursor")
                hint=tr!(
                    "The values at the crosshair have their difference to those at the second cursor. A click moves it."
                )
                checked=Signal::derive(move || chart.reference.with(Option::is_some))
                on_change=move |on| chart.place_reference(on)
            />
            <PressButton
                class="button small"
                label=tr!("Fit")
                hint=tr!("Fits each axis to its values.")
                disabled_reason=fitted_already
                on_press=move || chart.run(GraphAction::Fit)
            />
            <span class="graph-apart"></span>
            <PressButton
                class="button small"
                label="PNG"
                hint=tr!("Saves the graph as a PNG image.")
                on_press=move || picture::save(chart, stage)
            />
            <PressButton
                class="button small"
                label="SVG"
                name=tr!("Save SVG")
                hint=tr!("Saves the graph as an SVG drawing in light colours.")
                on_press=move || picture::save_svg(chart, stage)
            />
            <KeepButton chart />
        </div>
    }
}

/// A switch of how the graph is looked at.
#[component]
fn Check(
    label: &'static str,
    #[prop(optional)] hint: Option<&'static str>,
    #[prop(into)] checked: Signal<bool>,
    #[prop(into)] on_change: Callback<bool>,
) -> impl IntoView {
    view! {
        <label class="graph-check" title=hint>
            <input
                type="checkbox"
                prop:checked=dynamic(move || checked.get())
                on:change=handler(move |event| on_change.run(event_target_checked(&event)))
            />
            {label}
        </label>
    }
}

/// The button of one window. After a zoom none of them may be selected.
#[component]
fn Window(chart: Chart, window: (u64, &'static str)) -> impl IntoView {
    let (span_us, name) = window;
    let view = chart.view;
    let chosen = move || view.with(|view| view.span_us == span_us);
    let first_of_none = move || {
        let [(first_us, _), ..] = WINDOWS;
        let known = |shown| WINDOWS.iter().any(|(span_us, _)| *span_us == shown);
        span_us == first_us && view.with(|view| !known(view.span_us))
    };
    view! {
        <button
            type="button"
            role="radio"
            class="graph-window"
            aria-checked=dynamic(move || if chosen() { "true" } else { "false" })
            tabindex=dynamic(move || if chosen() || first_of_none() { "0" } else { "-1" })
            on:click=handler(move |_| choose(chart, span_us))
            on:keydown=handler(|event| move_choice(&event))
        >
            {name}
        </button>
    }
}

fn choose(chart: Chart, span_us: u64) {
    chart.show(chart.view.get_untracked().with_span(span_us));
}
