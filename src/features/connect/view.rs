//! The state of the port, and the buttons that change it.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{Adapter, Connection};

use crate::{
    features::connect::actions::Connect,
    link::worker_link::WorkerState,
    model::{
        connect_texts,
        guards::{is_in_use, port_blocked_by, serial_blocked_by},
        page::use_page,
    },
    ui::{
        button::PressButton,
        reactive::{dynamic, memo},
    },
};

/// Status `Connection`.
#[component]
pub(crate) fn ConnectionState() -> impl IntoView {
    let page = use_page();
    let words = memo(move || match page.worker.state.get() {
        WorkerState::Dead => (tr!("Failed"), tr!("Reload the page").to_owned()),
        WorkerState::Starting | WorkerState::Running => page
            .shown
            .with(|session| connect_texts::of_connection(session.connection)),
    });
    let state = move || match page.worker.state.get() {
        WorkerState::Dead => "Failed",
        _ => page.shown.with(|session| key(session.connection)),
    };
    view! {
        <div
            class="connection"
            role="status"
            aria-label=tr!("Connection")
            data-state=dynamic(state)
            title=dynamic(move || words.with(|(_, detail)| detail.clone()))
        >
            <strong class="connection-state">{dynamic(move || words.with(|(state, _)| *state))}</strong>
            " "
            <span class="connection-detail">
                {dynamic(move || words.with(|(_, detail)| detail.clone()))}
            </span>
        </div>
    }
}

/// Its class.
const fn key(connection: Connection) -> &'static str {
    match connection {
        Connection::Disconnected => "Disconnected",
        Connection::Connecting => "Connecting",
        Connection::Connected(_) => "Connected",
        Connection::Reconnecting(_) => "Reconnecting",
        Connection::Failed(_) => "Failed",
    }
}

/// Buttons `Connect` or `Disconnect`, `Other port` and `Virtual motor`.
#[component]
pub(crate) fn ConnectButtons(connect: Connect) -> impl IntoView {
    let page = connect.page;
    // The other button is Disconnect then.
    let open = memo(move || page.shown.with(|session| is_in_use(session.connection)));
    let no_serial_reason = Signal::derive(move || serial_blocked_by(page.worker.state.get()));
    let connect_blocked_by = Signal::derive(move || {
        if open.get() {
            None
        } else {
            serial_blocked_by(page.worker.state.get())
        }
    });
    let virtual_blocked_by = Signal::derive(move || {
        let connection = page.shown.with(|session| session.connection);
        match connection {
            Connection::Connected(Adapter::Virtual) => {
                Some(tr!("The virtual motor is already connected.").to_owned())
            }
            _ => port_blocked_by(page.worker.state.get()),
        }
    });
    let label = Signal::derive(move || {
        let word = if open.get() {
            tr!("Disconnect")
        } else {
            tr!("Connect")
        };
        word.to_owned()
    });
    view! {
        <div class="connect-buttons">
            <PressButton
                label=label
                class="button connect"
                disabled_reason=connect_blocked_by
                on_press=move || {
                    if open.get_untracked() { connect.disconnect() } else { connect.connect() }
                }
            />
            <PressButton
                label=tr!("Other port…")
                name=tr!("Other port")
                hint=tr!("Other port")
                disabled_reason=no_serial_reason
                on_press=move || connect.choose_port(true)
            />
            <PressButton
                label=tr!("Virtual motor")
                hint=tr!("Simulated motor. Needs no hardware or permission.")
                disabled_reason=virtual_blocked_by
                on_press=move || connect.connect_virtual()
            />
        </div>
    }
}
