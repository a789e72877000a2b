//! How well the line works.

use leptos::prelude::*;
use motorlink_i18n::tr;

use crate::{
    model::page::use_page,
    ui::{
        format::{UNKNOWN, milliseconds, percent},
        reactive::dynamic,
    },
};

/// From this share of lost requests on, in per mille, the figure stands out: three of the last hundred are no chance.
const HIGH_LOSS_PER_MILLE: u16 = 30;

/// Output `Link`.
#[component]
pub(crate) fn LinkQuality() -> impl IntoView {
    let page = use_page();
    let parts = page.of_motor(|session, id| {
        let link = session.motor(id).map(|motor| motor.link);
        let rate = link.map(|link| link.command_hz.to_string());
        let round_trip = link.and_then(|link| link.round_trip_us).map(milliseconds);
        let per_mille = link.and_then(|link| link.loss_per_mille);
        let is_high = per_mille.is_some_and(|lost| lost >= HIGH_LOSS_PER_MILLE);
        let loss = per_mille.map(percent);
        let of_hundred = format!("% {}", tr!("lost" as "behind a number of percent"));
        [
            ("rate", rate, "Hz "),
            ("time", round_trip, "ms "),
            (
                if is_high { "loss high" } else { "loss" },
                loss,
                &of_hundred,
            ),
        ]
        .map(part)
        .concat()
    });
    view! {
        <div class="labelled link">
            <span class="label" aria-hidden="true">
                {tr!("Link")}
            </span>
            <output
                aria-label=tr!("Link")
                aria-live="off"
                title=tr!("Drive frames per second · round trip · lost of the last 100 requests")
                inner_html=dynamic(move || parts.get())
            ></output>
        </div>
    }
}

/// A figure with what it counts, as HTML.
fn part((name, figure, unit): (&str, Option<String>, &str)) -> String {
    let figure = figure.as_deref().unwrap_or(UNKNOWN);
    format!("<span class=\"link-part\"><b class=\"link-{name}\">{figure}</b> {unit}</span>")
}
