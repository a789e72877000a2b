//! The chart and the figures of one run, or of several over each other.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::experiments::{
    analysis::{SetpointRate, setpoint_rate},
    chart::{Chart, HEIGHT_MAX, charts, compared_charts},
    kept::{Outcome, RunHeader},
    study::{Findings, StudyKind},
};

use super::{
    figures::{Figure, Figures},
    texts as names,
};
use crate::features::experiments::{chart::Charts, kept::KeptRuns, texts};

/// The charts of these runs.
pub(super) fn charts_of(kept: KeptRuns, shown: &[u32]) -> Vec<Chart> {
    if let [number] = shown {
        return kept
            .findings(*number)
            .map_or_else(Vec::new, |findings| charts(&findings, &names::acceleration));
    }
    let runs: Vec<(String, Findings)> = shown
        .iter()
        .filter_map(|number| {
            let name = names::legend(&kept.header(*number)?);
            Some((name, kept.findings(*number)?.as_ref().clone()))
        })
        .collect();
    compared_charts(&runs, &names::acceleration)
}

/// The figures of a run with the share of missing replies; `None` while its record is read.
pub(super) fn figures_of(kept: KeptRuns, header: &RunHeader) -> Option<Figures> {
    let found = kept.findings(header.number)?;
    let mut figures = Figures::of(&found, &header.model);
    if let Some(rates) = rates(kept, header) {
        figures.add_missing(&rates);
    }
    Some(figures)
}

/// The rate of each motor, once the run has ended; `None` for one that hardly answered. A run that withholds frames has
/// none.
pub(super) fn rates(kept: KeptRuns, header: &RunHeader) -> Option<Vec<Option<SetpointRate>>> {
    let is_withheld = header.study()?.kind() == StudyKind::Silence;
    if is_withheld || header.outcome == Outcome::Running {
        return None;
    }
    let ids = header.motors.iter().map(|(id, _)| *id);
    kept.with_record(header.number, |record| {
        ids.map(|id| setpoint_rate(record, id, header.request_hz))
            .collect()
    })
}

/// The charts. `shown` has the numbers of the runs.
#[component]
pub(crate) fn RunChart(kept: KeptRuns, shown: Signal<Vec<u32>>) -> impl IntoView {
    let charts = move || charts_of(kept, &shown.get());
    let label = Signal::derive(move || {
        let first = shown.with(|shown| shown.first().copied());
        let kind = first.and_then(|first| Some(kept.header(first)?.study()?.kind()));
        match kind {
            Some(StudyKind::Frequency) => tr!("Bode plot").to_owned(),
            Some(kind) => texts::study(kind).to_owned(),
            None => tr!("Chart").to_owned(),
        }
    });
    view! { <Charts charts=Box::new(charts) label height_max=Signal::stored(HEIGHT_MAX) /> }
}

/// The figures of a run with what they mean; of several runs beside each other.
#[component]
pub(crate) fn RunFigures(kept: KeptRuns, shown: Signal<Vec<u32>>) -> impl IntoView {
    let compared = move || {
        let shown = shown.get();
        let runs = shown.iter().filter_map(|number| {
            let header = kept.header(*number)?;
            Some((names::legend(&header), figures_of(kept, &header)?))
        });
        (shown.len() > 1).then(|| figures_view(Figures::beside_each_other(runs)))
    };
    let runs = move || {
        let shown = shown.get();
        let shown = if shown.len() > 1 { Vec::new() } else { shown };
        let runs = shown.into_iter().filter_map(move |number| {
            let header = kept.header(number)?;
            let figures = figures_of(kept, &header);
            let outcome = names::end(kept, &header);
            Some(view! {
                <section class="run-figures" aria-label=header.name.clone()>
                    <h3>{header.name.clone()}</h3>
                    <p class="quiet">{names::date(&header)} " · " {outcome}</p>
                    {figures.map(figures_view)}
                </section>
            })
        });
        runs.collect_view()
    };
    view! { <div class="run-results">{compared} {runs}</div> }
}

fn figures_view(figures: Figures) -> impl IntoView {
    let columns = figures.columns;
    let has_columns = columns.len() > 1;
    let head = has_columns.then(|| {
        let names = columns.into_iter();
        let cells = names.map(|name| view! { <span>{name}</span> });
        view! {
            <div class="figure-row figure-head of-several">
                <span></span>
                <span class="figure-values">{cells.collect_view()}</span>
            </div>
        }
    });
    let rows = figures.rows.into_iter().map(|Figure { name, values }| {
        let values = values.into_iter();
        let cells = values.map(|value| view! { <span>{value}" "</span> });
        view! {
            <div class="figure-row" class:of-several=has_columns>
                <span class="figure-name" aria-hidden="true">{name}</span>
                <output class="figure-values" aria-label=name>{cells.collect_view()}</output>
            </div>
        }
    });
    let meaning = figures.meaning.into_iter().chain(figures.maker);
    view! {
        {head}
        {rows.collect_view()}
        {meaning.map(|text| view! { <p class="figure-meaning">{text}</p> }).collect_view()}
    }
}
