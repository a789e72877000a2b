//! One read-out with its age.

use std::time::Duration;

use leptos::prelude::*;
use motorlink_i18n::tr;

use crate::{
    model::snapshot::Reading,
    ui::{
        format::{self, UNKNOWN},
        reactive::dynamic,
    },
};

/// Longer texts get a smaller font, so that several faults fit.
const LONG: usize = 24;

/// The shown state of one reading.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Shown {
    pub(crate) figure: String,
    pub(crate) unit: &'static str,
    /// In small print.
    pub(crate) detail: String,
    /// Explains it.
    pub(crate) hint: &'static str,
    age: String,
    fresh: bool,
    rating: Rating,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rating {
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
            hint: "",
            age: shown_age(reading.age),
            fresh: reading.is_fresh(),
            rating: Rating::None,
        }
    }

    pub(crate) fn with_detail(self, detail: String) -> Self {
        Self { detail, ..self }
    }

    pub(crate) fn with_hint(self, hint: &'static str) -> Self {
        Self { hint, ..self }
    }

    pub(crate) fn good(self) -> Self {
        Self {
            rating: Rating::Good,
            ..self
        }
    }

    pub(crate) fn warm(self) -> Self {
        Self {
            rating: Rating::Warm,
            ..self
        }
    }

    pub(crate) fn bad(self) -> Self {
        Self {
            rating: Rating::Bad,
            ..self
        }
    }

    /// Its classes.
    pub(crate) fn class(&self) -> &'static str {
        // Old values are grey.
        match self.rating {
            _ if !self.fresh => "stale",
            Rating::None => "",
            Rating::Good => "good",
            Rating::Warm => "warm",
            Rating::Bad if self.figure.len() > LONG => "bad long",
            Rating::Bad => "bad",
        }
    }
}

/// A younger value needs none: values come many times a second, and changing ages would distract.
const AGE_FROM: Duration = Duration::from_secs(1);

fn shown_age(age: Duration) -> String {
    if age < AGE_FROM {
        return String::new();
    }
    format::age(age)
}

/// An output with its name, its value and its age; grey if it is out of date.
#[component]
pub(crate) fn ReadOut(
    name: &'static str,
    class: &'static str,
    shown: Memo<Option<Shown>>,
    /// The drawing below, as HTML. It repeats the values, so screen readers skip it.
    #[prop(into)]
    drawing: String,
) -> impl IntoView {
    let age_id = format!("age-{class}");
    let part = move |read: fn(&Shown) -> String| {
        move || shown.with(|shown| shown.as_ref().map(read).unwrap_or_default())
    };
    let look = move || {
        shown.with(|shown| {
            let look = shown.as_ref().map_or("stale", Shown::class);
            format!("panel read-out {class} {look}")
        })
    };
    let figure = move || {
        shown.with(|shown| {
            let figure = shown.as_ref().map(|shown| shown.figure.clone());
            figure.unwrap_or_else(|| UNKNOWN.to_owned())
        })
    };
    // The texts contain the spaces, for screen readers.
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
                    <span class="motor-title"></span>
                </span>
                <span class="age" id=age_id.clone() title=tr!("Age of the reading")>
                    {dynamic(part(|shown| shown.age.clone()))}
                </span>
            </div>
            <output
                aria-label=name
                aria-live="off"
                aria-describedby=age_id
                title=dynamic(part(|shown| shown.hint.to_owned()))
            >
                <span class="figure">{dynamic(figure)}</span>
                <span class="unit">{dynamic(unit)}</span>
                <span class="detail">{dynamic(detail)}</span>
            </output>
            <div class="drawing" aria-hidden="true" inner_html=drawing></div>
        </div>
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_age_is_shown_from_a_second_on() {
        assert_eq!(shown_age(Duration::from_millis(999)), "");
        assert_eq!(shown_age(Duration::from_secs(1)), "1.0 s");
    }
}
