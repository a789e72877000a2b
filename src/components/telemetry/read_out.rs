//! One read-out with its age.

use leptos::prelude::*;

use crate::components::live::live;

use crate::{
    format::{self, UNKNOWN},
    session::Reading,
};

/// What a read-out shows of one reading.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Shown {
    pub(super) figure: String,
    pub(super) unit: &'static str,
    /// In small print.
    pub(super) detail: String,
    age: String,
    fresh: bool,
    verdict: Verdict,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    None,
    Good,
    Bad,
}

impl Shown {
    pub(super) fn new<T>(reading: &Reading<T>, figure: String, unit: &'static str) -> Self {
        Self {
            figure,
            unit,
            detail: String::new(),
            age: format::age(reading.age),
            fresh: reading.is_fresh(),
            verdict: Verdict::None,
        }
    }

    pub(super) fn with_detail(self, detail: String) -> Self {
        Self { detail, ..self }
    }

    pub(super) fn good(self) -> Self {
        Self {
            verdict: Verdict::Good,
            ..self
        }
    }

    pub(super) fn bad(self) -> Self {
        Self {
            verdict: Verdict::Bad,
            ..self
        }
    }
}

/// An output with its name, its figure and its age; grey when it no longer says what is.
#[component]
pub(super) fn ReadOut(
    name: &'static str,
    class: &'static str,
    shown: Memo<Option<Shown>>,
) -> impl IntoView {
    let age_id = format!("age-{class}");
    let part = move |read: fn(&Shown) -> String| {
        move || shown.with(|shown| shown.as_ref().map(read).unwrap_or_default())
    };
    let verdict = move |wanted| {
        shown.with(|shown| shown.as_ref().is_some_and(|shown| shown.verdict == wanted))
    };
    let stale = move || shown.with(|shown| !shown.as_ref().is_some_and(|shown| shown.fresh));
    let figure = move || {
        shown.with(|shown| {
            let figure = shown.as_ref().map(|shown| shown.figure.clone());
            figure.unwrap_or_else(|| UNKNOWN.to_owned())
        })
    };
    // Spaces belong to the words, so that the whole reads well aloud.
    let unit = part(|shown| match shown.unit {
        "" => String::new(),
        "°" => "°".to_owned(),
        unit => format!(" {unit}"),
    });
    let detail = part(|shown| match shown.detail.as_str() {
        "" => String::new(),
        detail => format!(" {detail}"),
    });
    view! {
        <div
            class=format!("panel read-out {class}")
            class:stale=live(stale)
            class:good=live(move || verdict(Verdict::Good))
            class:bad=live(move || verdict(Verdict::Bad))
        >
            <div class="read-out-head">
                <span class="read-out-name" aria-hidden="true">
                    {name}
                </span>
                <span class="age" id=age_id.clone() title="Age of the reading">
                    {live(part(|shown| shown.age.clone()))}
                </span>
            </div>
            <output aria-label=name aria-live="off" aria-describedby=age_id>
                <span class="figure">{live(figure)}</span>
                <span class="unit">{live(unit)}</span>
                <span class="detail">{live(detail)}</span>
            </output>
        </div>
    }
}
