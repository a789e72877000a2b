//! Region `Speed and current`: the telemetry of the last minutes and the setpoints.
//!
//! | file | idea |
//! |---|---|
//! | `state` | what is shown, and the actions on it |
//! | `controls` | windows, pause, picture, and how the graph is looked at |
//! | `pointer` | pointer, wheel and keys on the graph itself |
//! | `stage` | the canvases and their animation loop |
//! | `pace` | when the graph is drawn next |
//! | `traces`, `compared`, `axes` | the lines of one motor, the lines of several motors, and the axes |
//! | `legend` | the traces and the compared motors, with their values |
//! | `kept` | a run that is kept, to compare another one with it |
//! | `reading` | what the crosshair reads |
//! | `overlay` | the line of the crosshair, and the texts of the values |
//! | `description` | the values in words |
//! | `watchers` | size, visibility and theme |
//! | `picture` | the PNG image and the SVG drawing |
//! | `linked` | what it shows, for a link |
//!
//! The parts that need no browser are in [`crate::features::graph::plot`].

pub(crate) mod axes;
pub(crate) mod compared;
pub(crate) mod controls;
pub(crate) mod description;
pub(crate) mod kept;
pub(crate) mod legend;
pub(crate) mod linked;
pub(crate) mod overlay;
mod pace;
pub(crate) mod picture;
pub mod plot;
pub(crate) mod pointer;
pub(crate) mod reading;
pub(crate) mod stage;
pub(crate) mod state;
pub(crate) mod traces;
pub(crate) mod watchers;

use std::rc::Rc;

use leptos::{html::Div, prelude::*};
use motorlink_i18n::tr;

use self::{controls::Controls, kept::controls::KeptRun, legend::LegendPanel, state::Chart};
use crate::{
    features::graph::{plot::texts, stage::StageCell},
    ui::reactive::{dynamic, handler, memo},
};

/// The section `Speed and current` with its graph, the img of the same name.
#[component]
pub(crate) fn Graph(chart: Chart) -> impl IntoView {
    chart.reset_drawing();
    let place = NodeRef::<Div>::new();
    let stage: StageCell = StoredValue::new_local(Rc::default());
    let (view, traces) = (chart.view, chart.traces);
    // The canvases start when they are mounted; their drawing needs no reactivity.
    Effect::new(move |_| {
        if let Some(place) = place.get() {
            stage::mount(chart, stage, &place);
        }
    });
    let name = move || {
        texts::name(traces.get().compared, view.get(), &|at_us| {
            chart.day_us(at_us) / 1_000
        })
    };
    let empty = memo(move || {
        chart.page.shown.track();
        let history = chart.page.history;
        history.with_value(|history| history.reported().is_empty())
    });
    view! {
        <section
            class="panel graph-panel"
            class:expanded=dynamic(move || chart.expanded.get())
            aria-label=tr!("Speed and current")
        >
            <Controls chart stage />
            <KeptRun chart />
            <div class="graph-box" node_ref=place>
                <LegendPanel chart />
                <div
                    class="graph-plot"
                    role="img"
                    aria-label=dynamic(name)
                    aria-describedby="graph-words graph-keys"
                    tabindex="0"
                    on:pointerdown=handler(move |event| pointer::down(chart, &event))
                    on:pointermove=handler(move |event| pointer::moved(chart, &event))
                    on:pointerup=handler(move |_| pointer::up(chart))
                    on:pointercancel=handler(move |_| pointer::left(chart))
                    on:pointerleave=handler(move |_| pointer::left(chart))
                    on:wheel=handler(move |event| pointer::wheel(chart, &event))
                    on:dblclick=handler(move |_| chart.reset())
                    on:keydown=handler(move |event| pointer::key(chart, &event))
                    inner_html=overlay::PLOT
                ></div>
                <p class="graph-none quiet" hidden=dynamic(move || !empty.get())>
                    {texts::no_data()}
                </p>
                <p hidden id="graph-words"></p>
                <p hidden id="graph-keys">
                    // Read aloud after the values.
                    {tr!(
                        "Plus and minus zoom, the arrow keys pan, Home shows the oldest data and \
                         End the newest. While paused, the arrow keys move a crosshair that reads \
                         values."
                    )}
                    " "
                    {tr!("Page Up and Page Down zoom the values, Backspace fits the axes to them.")}
                    " "
                    {tr!("Comma and full stop move the crosshair from mark to mark.")}
                    " "
                    {tr!("In a replay, Enter goes to the crosshair.")}
                </p>
            </div>
        </section>
    }
}
