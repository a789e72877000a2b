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

    /// Its classes: the look, and ` noted` if it has a detail.
    pub(crate) fn classes(&self) -> [&'static str; 2] {
        let note = if self.detail.is_empty() { "" } else { " noted" };
        // Old values are grey.
        let look = match self.rating {
            _ if !self.fresh => "stale",
            Rating::None => "",
            Rating::Good => "good",
            Rating::Warm => "warm",
            Rating::Bad if self.figure.len() > LONG => "bad long",
            Rating::Bad => "bad",
        };
        [look, note]
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

fn behind_a_space(text: &str) -> String {
    [if text.is_empty() { "" } else { " " }, text].concat()
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
    let age_id = ["age-", class].concat();
    let part_or = move |unknown: &'static str, read: fn(&Shown) -> String| {
        move || {
            shown.with(|shown| {
                let read = shown.as_ref().map(read);
                read.unwrap_or_else(|| unknown.to_owned())
            })
        }
    };
    let part = move |read| part_or("", read);
    let look = move || {
        shown.with(|shown| {
            let [look, note] = shown.as_ref().map_or(["stale", ""], Shown::classes);
            ["panel read-out ", class, " ", look, note].concat()
        })
    };
    let figure = part_or(UNKNOWN, |shown| shown.figure.clone());
    // The texts contain the spaces, for screen readers.
    let unit = part(|shown| match shown.unit {
        "°" => shown.unit.to_owned(),
        unit => behind_a_space(unit),
    });
    let detail = part(|shown| behind_a_space(&shown.detail));
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
