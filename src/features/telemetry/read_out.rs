//! One read-out with its age.

use leptos::prelude::*;
use motorlink_i18n::tr;

use crate::{
    model::snapshot::Reading,
    ui::{
        format::{self, UNKNOWN},
        reactive::dynamic,
    },
};

/// Words longer than this are set smaller, or several faults would not have room.
const LONG: usize = 24;

/// What a read-out shows of one reading.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Shown {
    pub(crate) figure: String,
    pub(crate) unit: &'static str,
    /// In small print.
    pub(crate) detail: String,
    age: String,
    fresh: bool,
    verdict: Verdict,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    None,
    Good,
    Warm,
    Bad,
}

impl Shown {
    pub(crate) fn new<T>(reading: &Reading<T>, figure: String, unit: &'static str) -> Self {
        Self {
            figure,
            unit,
            detail: String::new(),
            age: format::age(reading.age),
            fresh: reading.is_fresh(),
            verdict: Verdict::None,
        }
    }

    pub(crate) fn with_detail(self, detail: String) -> Self {
        Self { detail, ..self }
    }

    pub(crate) fn good(self) -> Self {
        Self {
            verdict: Verdict::Good,
            ..self
        }
    }

    pub(crate) fn warm(self) -> Self {
        Self {
            verdict: Verdict::Warm,
            ..self
        }
    }

    pub(crate) fn bad(self) -> Self {
        Self {
            verdict: Verdict::Bad,
            ..self
        }
    }

    /// How the style sheet names what it looks like.
    pub(crate) fn look(&self) -> &'static str {
        // Old words are grey, whatever they say.
        match self.verdict {
            _ if !self.fresh => "stale",
            Verdict::None => "",
            Verdict::Good => "good",
            Verdict::Warm => "warm",
            Verdict::Bad if self.figure.len() > LONG => "bad long",
            Verdict::Bad => "bad",
        }
    }
}

/// An output with its name, its figure and its age; grey when it no longer says what is.
#[component]
pub(crate) fn ReadOut(
    name: &'static str,
    class: &'static str,
    shown: Memo<Option<Shown>>,
    /// What is drawn below them, as HTML; for those who see it, since the figures say the same.
    #[prop(into)]
    drawing: String,
) -> impl IntoView {
    let age_id = format!("age-{class}");
    let part = move |read: fn(&Shown) -> String| {
        move || shown.with(|shown| shown.as_ref().map(read).unwrap_or_default())
    };
    let look = move || {
        shown.with(|shown| {
            let look = shown.as_ref().map_or("stale", Shown::look);
            format!("panel read-out {class} {look}")
        })
    };
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
            class=dynamic(look)
        >
            <div class="read-out-head">
                <span class="read-out-name" aria-hidden="true">
                    {name}
                </span>
                <span class="age" id=age_id.clone() title=tr!("Age of the reading")>
                    {dynamic(part(|shown| shown.age.clone()))}
                </span>
            </div>
            <output aria-label=name aria-live="off" aria-describedby=age_id>
                <span class="figure">{dynamic(figure)}</span>
                <span class="unit">{dynamic(unit)}</span>
                <span class="detail">{dynamic(detail)}</span>
            </output>
            <div class="drawing" aria-hidden="true" inner_html=drawing></div>
        </div>
    }
}
