//! Region `Motors`: every motor that was found, at a glance, and the way to what concerns them all.

use leptos::prelude::*;

use super::live::{heard, live};
use crate::{desk::use_desk, drawer::Drawer};

/// Region `Motors`.
#[component]
pub(crate) fn MotorStrip() -> impl IntoView {
    view! {
        <section class="motor-strip" aria-label="Motors">
            <div class="motor-strip-end">
                <DrawerButton which=Drawer::Together label="Drive together" />
                <DrawerButton which=Drawer::Link label="Link" />
            </div>
        </section>
    }
}

/// Opens and closes a panel of the drawer.
#[component]
fn DrawerButton(which: Drawer, label: &'static str) -> impl IntoView {
    let desk = use_desk();
    let is_open = move || desk.drawer.get() == Some(which);
    view! {
        <button
            type="button"
            class="button small"
            aria-expanded=live(move || if is_open() { "true" } else { "false" })
            on:click=heard(move |_| {
                let open = desk.drawer.get_untracked() == Some(which);
                desk.drawer.set(if open { None } else { Some(which) });
            })
        >
            {label}
        </button>
    }
}
