//! The panel `Experiments`: a tab for each kind of question, in three columns: ask, curves, result.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::experiments::{chart::HEIGHT_MAX, plan::Plan, study::StudyKind};
use wasm_bindgen::JsCast;
use web_sys::KeyboardEvent;

use crate::{
    features::experiments::{
        chart::{Charts, charts},
        code::CodeTab,
        fields::StudyFields,
        results::{
            runs_tab::RunsTab,
            view::{RunChart, RunFigures},
        },
        run_bar::{RunBar, RunSettings},
        sequence_fields::SequenceFields,
        state::{ExperimentTab, Experiments},
        steps::StepsTable,
        texts,
    },
    model::place::Place,
    ui::{
        choice_keys::move_choice,
        listener::on_window,
        reactive::{dynamic, effect, handler},
        tab_panel::tab_id,
    },
};

/// The height of the charts of a sequence. At 1440 x 900 px they are in sight, with the first steps above them.
const HEIGHT_MAX_BELOW_STEPS: f64 = 164.0;

/// The id of the panel of all tabs.
const STUDY_PANEL: &str = "panel-experiments";

fn name(tab: ExperimentTab) -> &'static str {
    match tab {
        ExperimentTab::Sequence => tr!("Sequence"),
        ExperimentTab::Step => tr!("Step response"),
        ExperimentTab::Frequency => tr!("Frequency response"),
        ExperimentTab::Characterise => tr!("Characterise"),
        ExperimentTab::Runs => tr!("Runs"),
        ExperimentTab::Code => tr!("Code"),
    }
}

/// The panel without its frame.
#[component]
pub(crate) fn ExperimentsPanel(of: Experiments) -> impl IntoView {
    let is_sequence = move || of.tab.get() == ExperimentTab::Sequence;
    let has_study = move || of.kind().is_some();
    let shown = Signal::derive(move || of.last_shown());
    let has_run = move || shown.with(|shown| !shown.is_empty());
    effect(move || {
        let is_open = of.page.place() == Place::Test;
        if is_open && of.tab.get() == ExperimentTab::Runs {
            of.kept.read_again();
        }
    });
    on_window("keydown", move |event| {
        let key = event.dyn_ref::<KeyboardEvent>().map(KeyboardEvent::key);
        if key.as_deref() == Some("Escape") && of.is_armed() {
            of.abort();
        }
    });
    let chosen_tab = move || tab_id(of.tab.get().key());
    view! {
        <div class="experiments">
            <div class="tabs" role="tablist" aria-label=tr!("Experiments")>
                {ExperimentTab::ALL.iter().map(|tab| tab_button(of, *tab)).collect_view()}
            </div>
            <div
                class="experiment"
                role="tabpanel"
                id=STUDY_PANEL
                aria-labelledby=dynamic(chosen_tab)
                class:sequence=dynamic(is_sequence)
                hidden=dynamic(move || !has_study())
            >
                <div class="experiment-ask">
                    <div class="experiment-fields" hidden=dynamic(move || !is_sequence())>
                        <SequenceFields of />
                    </div>
                    <div class="experiment-fields" hidden=dynamic(is_sequence)>
                        {characterise(of)}
                        <StudyFields of />
                    </div>
                    <RunSettings of />
                    <RunBar of />
                </div>
                <div class="experiment-curves">
                    <div class="experiment-steps" hidden=dynamic(move || !is_sequence())>
                        <StepsTable of />
                    </div>
                    <Curves of />
                    <div hidden=dynamic(move || !has_run())>
                        <RunChart kept=of.kept shown />
                    </div>
                </div>
                <div class="experiment-results" hidden=dynamic(move || !has_run())>
                    <RunFigures kept=of.kept shown />
                </div>
            </div>
            <div
                class="experiment-tab of-runs"
                id=panel_id(ExperimentTab::Runs)
                role="tabpanel"
                aria-labelledby=tab_id(ExperimentTab::Runs.key())
                hidden=dynamic(move || of.tab.get() != ExperimentTab::Runs)
            >
                <RunsTab kept=of.kept />
            </div>
            <div
                class="experiment-tab"
                id=panel_id(ExperimentTab::Code)
                role="tabpanel"
                aria-labelledby=tab_id(ExperimentTab::Code.key())
                hidden=dynamic(move || of.tab.get() != ExperimentTab::Code)
            >
                <CodeTab of />
            </div>
        </div>
    }
}

/// The element that a tab shows. The studies share one.
const fn panel_id(tab: ExperimentTab) -> &'static str {
    match tab {
        ExperimentTab::Runs => "panel-runs",
        ExperimentTab::Code => "panel-code",
        _ => STUDY_PANEL,
    }
}

fn tab_button(of: Experiments, tab: ExperimentTab) -> impl IntoView {
    let selected = move || of.tab.get() == tab;
    let works = move || of.shown.get().is_driving() && selected();
    view! {
        <button
            type="button"
            role="tab"
            class="tab"
            class:working=dynamic(works)
            id=tab_id(tab.key())
            aria-controls=panel_id(tab)
            aria-selected=dynamic(move || if selected() { "true" } else { "false" })
            tabindex=dynamic(move || if selected() { "0" } else { "-1" })
            on:click=handler(move |_| of.tab.set(tab))
            on:keydown=handler(|event| move_choice(&event))
        >
            {name(tab)}
        </button>
    }
}

/// The buttons that choose what is characterised.
fn characterise(of: Experiments) -> impl IntoView {
    let kinds = [
        StudyKind::Friction,
        StudyKind::CoastDown,
        StudyKind::Heating,
        StudyKind::TorqueSpeed,
        StudyKind::Silence,
    ];
    let button = move |kind| {
        let pressed = move || of.characterise.get() == kind;
        view! {
            <button
                type="button"
                class="button small"
                aria-pressed=dynamic(move || if pressed() { "true" } else { "false" })
                on:click=handler(move |_| of.characterise.set(kind))
            >
                {texts::study(kind)}
            </button>
        }
    };
    let is_open = move || of.tab.get() == ExperimentTab::Characterise;
    view! {
        <div
            class="experiment-kinds"
            role="group"
            aria-label=tr!("Characterise")
            hidden=dynamic(move || !is_open())
        >
            {kinds.map(button).collect_view()}
        </div>
    }
}

/// The setpoints that are asked for; during and after a run with what was measured.
#[component]
fn Curves(of: Experiments) -> impl IntoView {
    let charts = move || {
        of.live_drawn.track();
        let is_running = of.shown.get().is_driving();
        let armed = of.armed.get();
        let of_plan = |plan: &Plan| {
            let is_armed = armed.as_ref().is_some_and(|armed| armed.plan == *plan);
            of.live
                .with_value(|live| charts(plan, is_armed.then_some(live)))
        };
        of.checked.with(|checked| match (checked, &armed) {
            // A table that is edited meanwhile is not what runs.
            (_, Some(armed)) if is_running => of_plan(&armed.plan),
            (Some(Ok((_, plan))), _) => of_plan(plan),
            _ => Vec::new(),
        })
    };
    let label = Signal::derive(move || {
        let longest = of.checked.with(|checked| match checked {
            Some(Ok((_, plan))) => texts::duration(plan.longest_s()),
            _ => String::new(),
        });
        tr!("Setpoints over {time}", time = longest)
    });
    let height_max = Signal::derive(move || match of.tab.get() {
        ExperimentTab::Sequence => HEIGHT_MAX_BELOW_STEPS,
        _ => HEIGHT_MAX,
    });
    view! { <Charts charts=Box::new(charts) label height_max /> }
}
