//! The tab `Runs`: the kept runs, compared, exported and deleted.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::experiments::{
    chart::RUNS_MAX,
    kept::{Outcome, RunHeader},
    sequence::NAME_MAX,
};

use super::{
    export::{Format, export},
    texts as names,
    view::{RunChart, RunFigures},
};
use crate::{
    features::experiments::{kept::KeptRuns, texts},
    ui::{
        button::PressButton,
        reactive::{dynamic, handler},
    },
};

/// What is chosen in the list.
#[derive(Clone, Copy)]
struct Choice {
    kept: KeptRuns,
    /// The marked runs.
    marked: RwSignal<Vec<u32>>,
    /// The runs in the chart.
    shown: RwSignal<Vec<u32>>,
    /// Whether the user is asked about the marked runs.
    asks: RwSignal<bool>,
    format: RwSignal<&'static str>,
}

impl Choice {
    fn none_marked(self) -> Option<String> {
        let none = self.marked.with(Vec::is_empty);
        none.then(|| tr!("Mark a run in the list first.").to_owned())
    }

    fn compare_blocked_by(self) -> Option<String> {
        let (count, is_one_study) = self.marked.with(|marked| {
            let kinds = marked.iter().map(|number| {
                let study = self.kept.header(*number)?.study()?;
                Some(study.kind())
            });
            let mut kinds: Vec<_> = kinds.collect();
            kinds.dedup();
            (marked.len(), kinds.len() == 1)
        });
        let fits = (2..=RUNS_MAX).contains(&count) && is_one_study;
        (!fits).then(|| tr!("Mark two to eight runs of the same study.").to_owned())
    }

    fn export_blocked_by(self) -> Option<String> {
        let marked = self.marked.get();
        let reading = || {
            let is_read = self.kept.has_records(&marked);
            (!is_read).then(|| tr!("The data of these runs is being read.").to_owned())
        };
        if marked.len() > RUNS_MAX {
            return Some(tr!("Mark at most eight runs.").to_owned());
        }
        self.none_marked().or_else(reading)
    }

    fn chosen_format(self) -> Option<Format> {
        let key = self.format.get();
        Format::ALL.into_iter().find(|format| format.key() == key)
    }

    fn mark(self, number: u32, is_marked: bool) {
        self.asks.set(false);
        self.marked.update(|marked| {
            marked.retain(|other| *other != number);
            if is_marked {
                marked.push(number);
            }
        });
        // A single run is shown without Compare.
        if let [only] = *self.marked.get_untracked() {
            self.shown.set(vec![only]);
        }
    }

    fn delete(self) {
        let gone = self.marked.get_untracked();
        self.kept.delete(&gone);
        self.shown
            .update(|shown| shown.retain(|number| !gone.contains(number)));
        self.marked.set(Vec::new());
        self.asks.set(false);
    }

    fn export(self) {
        let marked = self.marked.get_untracked();
        if let Some(format) = untrack(|| self.chosen_format()) {
            untrack(|| export(self.kept, &marked, format));
        }
    }
}

/// The tab without its frame.
#[component]
pub(crate) fn RunsTab(kept: KeptRuns) -> impl IntoView {
    let of = Choice {
        kept,
        marked: RwSignal::new(Vec::new()),
        shown: RwSignal::new(Vec::new()),
        asks: RwSignal::new(false),
        format: RwSignal::new(Format::Report.key()),
    };
    let rows = move || {
        kept.list.with(|list| {
            let rows = list.iter().map(|run| row(of, run));
            rows.collect_view()
        })
    };
    let is_empty = move || kept.list.with(Vec::is_empty);
    let shown = Signal::derive(move || of.shown.get());
    view! {
        <div class="experiment-ask runs">
            <p class="quiet" hidden=dynamic(move || !is_empty())>
                {tr!("No runs yet. Each run is kept here with its data.")}
            </p>
            <ul class="run-list" aria-label=tr!("Runs")>{rows}</ul>
            {buttons(of)}
            <p role="status" class="run-said">{dynamic(move || kept.said.get())}</p>
        </div>
        <div class="experiment-curves">
            <RunChart kept shown />
        </div>
        <div class="experiment-results">
            <RunFigures kept shown />
        </div>
    }
}

fn row(of: Choice, run: &RunHeader) -> impl IntoView + use<> {
    let number = run.number;
    let is_marked = move || of.marked.with(|marked| marked.contains(&number));
    let is_shown = move || of.shown.with(|shown| shown.contains(&number));
    let mut facts = format!("{} · {}", names::motors(run), run.model);
    let study = run.study();
    let kind = study.as_ref().map(|study| texts::study(study.kind()));
    // Most runs have no other name.
    if let Some(kind) = kind.filter(|kind| *kind != run.name.as_str()) {
        facts = format!("{kind} · {facts}");
    }
    if let Some(list) = study.as_ref().and_then(names::accelerations) {
        let named = tr!("Acceleration {value}", value = list);
        facts = format!("{facts} · {named}");
    }
    let ended = names::outcome(run.outcome);
    let class = match run.outcome {
        Outcome::PageClosed => "bad",
        _ if run.outcome.cause().is_some() => "bad",
        _ => "quiet",
    };
    let mark = tr!("Mark {run}", run = run.name.as_str());
    view! {
        <li class="run-row" class:shown=dynamic(is_shown)>
            <input
                type="checkbox"
                aria-label=mark
                prop:checked=dynamic(is_marked)
                on:change=handler(move |event| of.mark(number, event_target_checked(&event)))
            />
            <button
                type="button"
                class="run-open"
                aria-pressed=dynamic(move || if is_shown() { "true" } else { "false" })
                on:click=handler(move |_| of.shown.set(vec![number]))
            >
                <span class="run-name">{run.name.clone()}</span>
                " "
                <span class="quiet">{facts}</span>
                " "
                <span class="quiet">
                    {names::date(run)} " · " <span class=class>{ended}</span>
                </span>
            </button>
        </li>
    }
}

fn buttons(of: Choice) -> impl IntoView {
    let options = Format::ALL.map(|format| {
        view! { <option value=format.key()>{format.name()}</option> }
    });
    let question = move || {
        tr!(
            "Delete the marked runs ({count}) with their data?",
            count = of.marked.with(Vec::len)
        )
    };
    let none_marked = Signal::derive(move || of.none_marked());
    let one = move || {
        of.marked
            .with(|marked| <[u32; 1]>::try_from(marked.as_slice()).ok())
    };
    let name = move || {
        let header = one().and_then(|[number]| of.kept.header(number));
        header.map(|header| header.name).unwrap_or_default()
    };
    let rename = move |event| {
        let typed: String = event_target_value(&event);
        let typed: String = typed.trim().chars().take(NAME_MAX).collect();
        if let (Some([number]), false) = (untrack(one), typed.is_empty()) {
            of.kept.rename(number, &typed);
        }
    };
    view! {
        <label class="ask-field">
            <span class="field-name">{tr!("Name of the run")}</span>
            <input
                type="text"
                maxlength=NAME_MAX.to_string()
                prop:value=dynamic(name)
                disabled=dynamic(move || one().is_none())
                title=tr!("Mark one run to rename it")
                on:change=handler(rename)
            />
        </label>
        <div class="button-row">
            <PressButton
                label=tr!("Compare")
                class="button small"
                disabled_reason=Signal::derive(move || of.compare_blocked_by())
                on_press=move || of.shown.set(of.marked.get_untracked())
            />
            <PressButton
                label=tr!("Delete")
                class="button small"
                disabled_reason=none_marked
                on_press=move || of.asks.set(true)
            />
        </div>
        <div class="button-row">
            <select
                class="select"
                aria-label=tr!("Format of the export")
                on:change=handler(move |event| {
                    let key = event_target_value(&event);
                    let format = Format::ALL.into_iter().find(|format| format.key() == key);
                    if let Some(format) = format {
                        of.format.set(format.key());
                    }
                })
            >
                {options.collect_view()}
            </select>
            <PressButton
                label=tr!("Export")
                class="button small"
                disabled_reason=Signal::derive(move || of.export_blocked_by())
                on_press=move || of.export()
            />
        </div>
        <div class="run-question" role="group" hidden=dynamic(move || !of.asks.get())>
            <p>{dynamic(question)}</p>
            <PressButton
                label=tr!("Delete runs")
                class="button small"
                on_press=move || of.delete()
            />
            <PressButton
                label=tr!("Keep")
                class="button small"
                on_press=move || of.asks.set(false)
            />
        </div>
    }
}
