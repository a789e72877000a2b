//! The state of the port, and the buttons that change it.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{Adapter, Connection, VirtualLine, protocol::MotorId};

use crate::{
    features::connect::actions::Connect,
    link::worker_link::WorkerState,
    model::{
        connect_texts,
        guards::{is_in_use, port_blocked_by, serial_blocked_by},
        page::{Page, use_page},
        place::Panel,
        snapshot::{Reading, Session},
        terms,
    },
    ui::{
        button::PressButton,
        reactive::{dynamic, memo},
    },
};

/// Status `Connection`: the port, and on an open port the selected motor.
#[component]
pub(crate) fn ConnectionState() -> impl IntoView {
    let page = use_page();
    let words = memo(move || match page.worker.state.get() {
        WorkerState::Dead => (tr!("Failed"), tr!("Reload the page").to_owned()),
        WorkerState::Starting | WorkerState::Running => {
            let id = page.selected.get();
            page.shown.with(|session| {
                let (state, detail) = connect_texts::of_connection(session.connection);
                let state = match motor_trouble(session, id) {
                    Some(MotorTrouble::Silent(words)) => words,
                    Some(MotorTrouble::Fault) => tr!("Motor fault"),
                    None => return (state, detail),
                };
                (state, format!("{id} · {detail}"))
            })
        }
    });
    let state = move || match page.worker.state.get() {
        WorkerState::Dead => "Failed",
        _ => page.shown.with(|session| {
            let trouble = motor_trouble(session, page.selected.get());
            trouble.map_or_else(|| key(session.connection), MotorTrouble::key)
        }),
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

/// Why the selected motor cannot be used, although the port is open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum MotorTrouble {
    /// In words.
    Silent(&'static str),
    Fault,
}

impl MotorTrouble {
    const fn key(self) -> &'static str {
        match self {
            Self::Silent(_) => "Silent",
            Self::Fault => "Fault",
        }
    }
}

fn motor_trouble(session: &Session, id: MotorId) -> Option<MotorTrouble> {
    if session.is_recording() || !matches!(session.connection, Connection::Connected(_)) {
        return None;
    }
    let answer = session.motor(id).map(|motor| motor.answer);
    if let Some(words) = answer.and_then(terms::trouble_of_replies) {
        return Some(MotorTrouble::Silent(words));
    }
    let faults = session.faults(id).filter(Reading::is_fresh)?.value;
    faults.any_named().then_some(MotorTrouble::Fault)
}

/// Its class.
const fn key(connection: Connection) -> &'static str {
    match connection {
        Connection::Disconnected => "Disconnected",
        Connection::Connecting => "Connecting",
        Connection::Connected(Adapter::Recording) => "Recording",
        Connection::Connected(_) => "Connected",
        Connection::Reconnecting(_) => "Reconnecting",
        Connection::Failed(_) => "Failed",
    }
}

/// Buttons `Connect motor` or `Disconnect`, `Virtual motor`, `Virtual motors` and `Other port`.
#[component]
pub(crate) fn ConnectButtons(
    connect: Connect,
    /// Whether they are those of the first screen. The others are in the header, and hidden meanwhile.
    #[prop(optional)]
    is_first: bool,
) -> impl IntoView {
    let page = connect.page;
    let (around, class) = if is_first {
        ("first-buttons", "button primary connect")
    } else {
        ("connect-buttons", "button connect")
    };
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
    let virtual_blocked_by = Signal::derive(move || virtual_blocked_by(page, None));
    let label = Signal::derive(move || {
        let word = if open.get() {
            tr!("Disconnect")
        } else {
            tr!("Connect motor")
        };
        word.to_owned()
    });
    view! {
        <div class=around hidden=dynamic(move || page.shows_first_screen() != is_first)>
            <PressButton
                label=label
                class=class
                disabled_reason=connect_blocked_by
                on_press=move || {
                    if open.get_untracked() { connect.disconnect() } else { connect.connect() }
                }
            />
            <PressButton
                label=tr!("Virtual motor")
                hint=tr!("Simulated motor. Needs no hardware or permission.")
                disabled_reason=virtual_blocked_by
                on_press=move || connect.connect_virtual()
            />
            <PressButton
                label="▾"
                name=tr!("Virtual motors")
                class="button virtual-choice"
                hint=tr!("Virtual motors")
                on_press=move || {
                    const WHICH: Panel = Panel::VirtualMotors;
                    let is_open = page.open.get_untracked().panel == Some(WHICH);
                    page.show_panel((!is_open).then_some(WHICH));
                }
            />
            <PressButton
                label=tr!("Other port…")
                name=tr!("Other port")
                hint=tr!("Other port")
                disabled_reason=no_serial_reason
                on_press=move || connect.choose_port(true)
            />
        </div>
    }
}

/// Why this virtual line cannot be connected, or any if none is given: a stray press must not replace the motors
/// that are being driven.
pub(crate) fn virtual_blocked_by(page: Page, wanted: Option<VirtualLine>) -> Option<String> {
    let open = page.shown.with(|session| session.connection.virtual_line());
    if open.is_some() && wanted.is_none_or(|wanted| open == Some(wanted)) {
        return Some(tr!("The virtual motor is already connected.").to_owned());
    }
    port_blocked_by(page.worker.state.get())
}

#[cfg(test)]
mod tests {
    use motorlink_messages::bus::Answer;
    use motorlink_messages::protocol::{Faults, Mode};

    use super::*;
    use crate::model::snapshot::tests::{ID, session, status};

    #[test]
    fn an_open_port_is_not_all_while_its_motor_is_silent_or_reports_a_fault() {
        let well = session(1_000, status(1_000, Mode::Velocity, 0));
        assert_eq!(motor_trouble(&well, ID), None);
        let mut faulty = well.clone();
        if let Some(sample) = &mut faulty.motors[0].last {
            sample.reply.faults = Faults::from_byte(0x10);
        }
        assert_eq!(motor_trouble(&faulty, ID), Some(MotorTrouble::Fault));
        faulty.motors[0].answer = Answer::Missing;
        assert_eq!(
            motor_trouble(&faulty, ID),
            Some(MotorTrouble::Silent("No reply"))
        );
        faulty.connection = Connection::Disconnected;
        assert_eq!(motor_trouble(&faulty, ID), None);
    }
}
