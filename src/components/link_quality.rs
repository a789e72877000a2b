//! How well the line works.

use leptos::prelude::*;
use motorlink_words::tr;

use crate::components::live::live;

use crate::{
    desk::use_desk,
    format::{UNKNOWN, milliseconds, percent},
};

/// Output `Link`.
#[component]
pub(crate) fn LinkQuality() -> impl IntoView {
    let desk = use_desk();
    let link = desk.of_motor(|session, id| {
        let link = session.motor(id)?.link;
        let round_trip = link.round_trip_us.map(milliseconds);
        let loss = link.loss_per_mille.map(percent);
        Some((link.command_hz.to_string(), round_trip, loss))
    });
    let rate = move || link.get().map_or_else(unknown, |(rate, ..)| rate);
    let round_trip = move || {
        link.get()
            .and_then(|(_, time, _)| time)
            .unwrap_or_else(unknown)
    };
    let loss = move || {
        link.get()
            .and_then(|(.., loss)| loss)
            .unwrap_or_else(unknown)
    };
    view! {
        <div class="labelled link">
            <span class="label" aria-hidden="true">
                {tr!("Link")}
            </span>
            <output
                aria-label=tr!("Link")
                aria-live="off"
                title=tr!("Drive frames a second · round trip · requests without a good reply")
            >
                <span class="link-part">
                    <b class="link-rate">{live(rate)}</b>
                    " Hz "
                </span>
                <span class="link-part">
                    <b class="link-time">{live(round_trip)}</b>
                    " ms "
                </span>
                <span class="link-part">
                    <b class="link-loss">{live(loss)}</b>
                    " % "
                    {tr!("lost" as "behind a number of percent")}
                </span>
            </output>
        </div>
    }
}

fn unknown() -> String {
    UNKNOWN.to_owned()
}
