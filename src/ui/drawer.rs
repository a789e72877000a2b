//! The drawer: a panel over the right part of the page that is not modal. STOP and the rest of the page stay usable.

use leptos::prelude::*;
use motorlink_i18n::tr;

use crate::ui::{button::PressButton, reactive::dynamic};

/// A panel of the drawer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Drawer {
    /// The quality of the link, and its problems.
    Link,
    /// Driving several motors together.
    Together,
    /// Limits, the setup as a file, and stored data.
    Settings,
    /// The choice of the virtual motors.
    VirtualMotors,
    /// The setup of the wheels of a rover, one motor after the other.
    WheelSetup,
    /// Saves and opens session files.
    Session,
    /// The setup as a link.
    SetupLink,
    /// What is asked of motors, and the runs that ask it.
    Experiments,
}

/// Opens a panel of the drawer, or closes it.
pub(crate) fn toggle(open: RwSignal<Option<Drawer>>, which: Drawer) {
    open.update(|open| *open = (*open != Some(which)).then_some(which));
}

/// A panel of the drawer, mounted once and shown while it is `open`.
pub(crate) fn panel_of_drawer(
    open: RwSignal<Option<Drawer>>,
    which: Drawer,
    title: &'static str,
    content: impl IntoView + 'static,
) -> impl IntoView {
    let closed = move || open.get() != Some(which);
    view! {
        <section class="panel drawer" aria-label=title hidden=dynamic(closed)>
            <div class="drawer-head">
                <h2>{title}</h2>
                <PressButton
                    label=tr!("Close")
                    name=tr!("Close the panel")
                    class="button small"
                    on_press=move || open.set(None)
                />
            </div>
            {content}
        </section>
    }
}
