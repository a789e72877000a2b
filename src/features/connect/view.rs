//! The state of the port, and the buttons that change it.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{Adapter, Connection};

use crate::{
    features::install::new_version::is_in_use,
    link::serial_ports,
    model::{
        desk::{Desk, WorkerState, use_desk},
        notice_texts as words,
    },
    ui::{
        button::PressButton,
        reactive::{live, memo},
    },
};

/// Status `Connection`.
#[component]
pub(crate) fn ConnectionState() -> impl IntoView {
    let desk = use_desk();
    let words = memo(move || match desk.worker.get() {
        WorkerState::Dead => (tr!("Failed"), tr!("Reload the page").to_owned()),
        WorkerState::Starting | WorkerState::Running => desk
            .shown
            .with(|session| words::of_connection(session.connection)),
    });
    let state = move || match desk.worker.get() {
        WorkerState::Dead => "Failed",
        _ => desk.shown.with(|session| key(session.connection)),
    };
    view! {
        <div
            class="connection"
            role="status"
            aria-label=tr!("Connection")
            data-state=live(state)
            title=live(move || words.with(|(_, detail)| detail.clone()))
        >
            <strong class="connection-state">{live(move || words.with(|(state, _)| *state))}</strong>
            " "
            <span class="connection-detail">
                {live(move || words.with(|(_, detail)| detail.clone()))}
            </span>
        </div>
    }
}

/// As the style sheet names it.
const fn key(connection: Connection) -> &'static str {
    match connection {
        Connection::Disconnected => "Disconnected",
        Connection::Connecting => "Connecting",
        Connection::Connected(_) => "Connected",
        Connection::Reconnecting(_) => "Reconnecting",
        Connection::Failed(_) => "Failed",
    }
}

/// Buttons `Connect` or `Disconnect`, `Choose another port` and `Virtual motor`.
#[component]
pub(crate) fn ConnectButtons() -> impl IntoView {
    let desk = use_desk();
    // Then one disconnects.
    let open = memo(move || desk.shown.with(|session| is_in_use(session.connection)));
    let why_no_serial = Signal::derive(move || why_not_serial(desk));
    let why_not_connect = Signal::derive(move || {
        if open.get() {
            None
        } else {
            why_not_serial(desk)
        }
    });
    let why_not_virtual = Signal::derive(move || {
        let connection = desk.shown.with(|session| session.connection);
        match connection {
            Connection::Connected(Adapter::Virtual) => {
                Some(tr!("The virtual motor is connected.").to_owned())
            }
            _ => why_not_at_all(desk),
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
                why_not=why_not_connect
                on_press=move || {
                    if open.get_untracked() { desk.disconnect() } else { desk.connect() }
                }
            />
            <PressButton
                label=tr!("Other port…")
                name=tr!("Choose another port")
                hint=tr!("Choose another port")
                why_not=why_no_serial
                on_press=move || desk.choose_port(true)
            />
            <PressButton
                label=tr!("Virtual motor")
                hint=tr!("A simulated motor: no hardware, no permission")
                why_not=why_not_virtual
                on_press=move || desk.connect_virtual()
            />
        </div>
    }
}

pub(crate) fn why_not_at_all(desk: Desk) -> Option<String> {
    (desk.worker.get() == WorkerState::Dead)
        .then(|| tr!("The background worker has stopped. Reload the page.").to_owned())
}

pub(crate) fn why_not_serial(desk: Desk) -> Option<String> {
    if !serial_ports::is_supported() {
        let words = tr!(
            "This browser has no Web Serial. Use Chrome, Edge or Firefox 151 on a desktop, over https; the virtual motor works here."
        );
        return Some(words.to_owned());
    }
    why_not_at_all(desk)
}
