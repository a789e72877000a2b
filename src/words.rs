//! What the page says when something happened: what it was, and what to do.

use motorlink_messages::{
    ConnectError, Connection, Notice,
    bus::{Command, IdQueryOutcome, Refusal, StopOutcome, StopReason, StopReport, WithdrawReason},
    protocol::{Mode, MotorId},
};

use crate::{
    notice_board::{Remedy, Tone, Topic, Words},
    scan_words,
};

pub(crate) mod installation;
pub(crate) mod journal;
pub(crate) mod kept;
pub(crate) mod link;
pub(crate) mod log_lines;
pub(crate) mod new_version;
pub(crate) mod setup;

/// What can go wrong before the worker is asked to open a port.
#[cfg_attr(
    not(target_arch = "wasm32"),
    allow(dead_code, reason = "found out where there is a browser")
)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PickTrouble {
    /// The browser has no Web Serial.
    NoWebSerial,
    /// The picker was closed without a choice; it showed only usual adapters where `filtered`.
    Dismissed { filtered: bool },
    /// The browser forbids serial ports to this page.
    Forbidden,
    /// The picked port is not among the permitted ones: it was pulled out meanwhile.
    Vanished,
    /// Anything else.
    Unknown,
}

fn words(topic: Topic, tone: Tone, title: impl Into<String>, advice: &[&str]) -> Words {
    Words {
        topic,
        tone,
        title: title.into(),
        advice: advice.iter().map(|line| (*line).to_owned()).collect(),
        remedy: None,
    }
}

/// The second line of the connection's state.
pub(crate) fn of_connection(connection: Connection) -> (&'static str, String) {
    match connection {
        Connection::Disconnected => ("Disconnected", "No port is open".to_owned()),
        Connection::Connecting => ("Connecting", "Opening the port".to_owned()),
        Connection::Connected(adapter) => ("Connected", adapter.to_string()),
        Connection::Reconnecting(adapter) => ("Reconnecting", format!("Plug {adapter} in again")),
        Connection::Failed(error) => ("Failed", failed_briefly(error).to_owned()),
    }
}

const fn failed_briefly(error: ConnectError) -> &'static str {
    match error {
        ConnectError::NoWebSerial => "No Web Serial: use Chrome, Edge or the virtual motor",
        ConnectError::PortGone => "The port is gone: press Choose another port",
        ConnectError::OpenFailed => "Close other programs and tabs that use the port",
        ConnectError::AlreadyOpen => "Open already: press Disconnect, then Connect",
        ConnectError::Other => "Unplug the adapter, plug it in and press Connect",
        ConnectError::OtherTab => "Another tab of MotorLink uses this adapter",
    }
}

/// What a failed connection says at length.
pub(crate) fn of_connect_error(error: ConnectError) -> Words {
    let port = |title, advice| words(Topic::Port, Tone::Error, title, advice);
    match error {
        ConnectError::NoWebSerial => of_pick_trouble(PickTrouble::NoWebSerial),
        ConnectError::PortGone => port(
            "The port is not there any more",
            &["Plug the adapter in, then press Connect or Choose another port."],
        ),
        ConnectError::OpenFailed => port(
            "The port does not open",
            &[
                "In use? Close other tabs and programs that hold it, such as a serial monitor.",
                "Linux: no permission? Run sudo usermod -aG dialout $USER and log in again. A browser \
                 from snap or Flatpak may not see ports at all: use a packaged one.",
                "Linux: brltty takes CH340 adapters for Braille displays: sudo apt remove brltty.",
                "Windows, macOS: install the driver of the adapter's chip (CH34x, CP210x, FTDI).",
                "Gone? Unplug the adapter and plug it in again.",
            ],
        ),
        ConnectError::AlreadyOpen => port(
            "The port is open already",
            &["Press Disconnect, then Connect."],
        ),
        ConnectError::Other => port(
            "The browser could not open the port",
            &["Unplug the adapter, plug it in again and press Connect."],
        ),
        ConnectError::OtherTab => port(
            "Another tab of MotorLink uses this adapter",
            &["Press Disconnect there, or close that tab; then press Connect here."],
        ),
    }
}

/// What went wrong with choosing a port.
pub(crate) fn of_pick_trouble(trouble: PickTrouble) -> Words {
    let port = |tone, title, advice| words(Topic::Port, tone, title, advice);
    match trouble {
        PickTrouble::NoWebSerial => port(
            Tone::Warning,
            "This browser cannot open serial ports",
            &[
                "For a real motor open this page in Chrome, Edge or Firefox 151 on a desktop, over \
                 https or from localhost.",
                "The virtual motor works here: press Virtual motor.",
            ],
        ),
        PickTrouble::Dismissed { filtered: true } => Words {
            remedy: Some(Remedy::ShowAllPorts),
            ..port(
                Tone::Calm,
                "No port was chosen",
                &[
                    "The list shows usual USB-RS485 adapters first. If yours is not in it, show all \
                     ports.",
                    "Nothing in the list? Check the USB cable: some carry power only.",
                ],
            )
        },
        PickTrouble::Dismissed { filtered: false } => Words {
            remedy: Some(Remedy::ShowAllPorts),
            ..port(
                Tone::Calm,
                "No port was chosen",
                &[
                    "Is the adapter not in the list? Check the USB cable (some carry power only) and \
                     the driver of its chip.",
                ],
            )
        },
        PickTrouble::Forbidden => port(
            Tone::Error,
            "The browser forbids serial ports to this page",
            &[
                "Allow serial ports in the site settings (left of the address), or ask who manages \
                 this browser.",
            ],
        ),
        PickTrouble::Vanished => of_connect_error(ConnectError::PortGone),
        PickTrouble::Unknown => Words {
            remedy: Some(Remedy::ShowAllPorts),
            ..port(
                Tone::Error,
                "The browser's list of ports did not open",
                &["Press Choose another port, or reload the page."],
            )
        },
    }
}

/// What the worker tells; `None` where the page shows it in another way.
pub(crate) fn of_notice(notice: &Notice) -> Option<Words> {
    Some(match notice {
        Notice::Refused { command, refusal } => of_refusal(*command, *refusal)?,
        Notice::TooLate(_) => words(
            Topic::Command,
            Tone::Warning,
            "That was not done: it came too late",
            &["The page was busy when you pressed. Press again."],
        ),
        Notice::NotConnected => words(
            Topic::Command,
            Tone::Calm,
            "Nothing is connected",
            &["Press Connect or Virtual motor."],
        ),
        Notice::IdQueryEnded(
            outcome
            @ (IdQueryOutcome::Nobody | IdQueryOutcome::Garbled | IdQueryOutcome::Cancelled),
        ) => scan_words::of_id_query(*outcome),
        Notice::ScanEnded(report) => scan_words::of_scan(report),
        Notice::IdChangeEnded { from, to, outcome } => {
            scan_words::of_id_change(*from, *to, *outcome)
        }
        Notice::ModeSwitchFailed {
            id,
            asked,
            reported,
        } => of_failed_switch(*id, *asked, *reported),
        Notice::Withdrawn { id, reason } => of_withdrawal(*id, *reason),
        Notice::MotorSilent(id) => of_silence(*id),
        Notice::StopEnded(report) => of_stop(report)?,
        Notice::AdapterLost { driven } => of_lost_adapter(driven),
        Notice::AdapterBack => words(
            Topic::Port,
            Tone::Calm,
            "The adapter is back",
            &["Nothing drives. Press Start when you are ready."],
        ),
        Notice::LineError => words(
            Topic::Line,
            Tone::Warning,
            "Damaged bytes on the line",
            &["Check A and B for a loose wire; beyond 1 m put 120 Ω across A and B."],
        ),
        // Shown where the motor, its loop and the stop are shown.
        Notice::IdQueryEnded(IdQueryOutcome::One(_))
        | Notice::ModeSwitched { .. }
        | Notice::MotorBack(_)
        | Notice::StopBegan(_) => return None,
    })
}

/// The topic that this notice settles.
pub(crate) fn settled_by(notice: &Notice) -> Option<Topic> {
    match notice {
        Notice::ModeSwitched { id, .. } => Some(Topic::Loop(*id)),
        Notice::MotorBack(_)
        | Notice::IdQueryEnded(IdQueryOutcome::One(_))
        | Notice::ScanEnded(_) => Some(Topic::Answer),
        _ => None,
    }
}

fn of_refusal(command: Command, refusal: Refusal) -> Option<Words> {
    // A drag that outlasts its motor's drive is no mistake of anybody, and a current that has to
    // be confirmed is asked about.
    if matches!(
        command,
        Command::Adjust { .. } | Command::AdjustTogether { .. } | Command::Forget(_)
    ) || matches!(refusal, Refusal::NeedsConsent(_))
    {
        return None;
    }
    let title = match command {
        Command::Drive { id, .. } => format!("Motor {id} was not driven"),
        Command::DriveTogether { .. } => "The motors were not driven".to_owned(),
        Command::SwitchMode { mode, .. } => format!("The {mode} was not asked for"),
        Command::IdQuery => "The ID query was not sent".to_owned(),
        Command::FullScan => "The bus was not scanned".to_owned(),
        Command::SetId { .. } => "The ID was not changed".to_owned(),
        Command::SendRaw { .. } => "The frame was not sent".to_owned(),
        _ => "That was not done".to_owned(),
    };
    Some(words(
        Topic::Command,
        Tone::Warning,
        title,
        &[&refusal.to_string()],
    ))
}

/// What to check where nobody answers, in the order in which it is mostly the reason.
pub(crate) const WIRING: [&str; 4] = [
    "Is the motor's 18 V supply on?",
    "Is the brown wire tied to GND?",
    "Swap orange and white: adapters label A and B both ways.",
    "Is it the right ID? Choose another in the list Motor.",
];

fn of_silence(id: MotorId) -> Words {
    words(
        Topic::Answer,
        Tone::Warning,
        format!("Motor {id} has not answered for 2 s"),
        &WIRING,
    )
}

fn of_failed_switch(id: MotorId, asked: Mode, reported: Option<Mode>) -> Words {
    let title = reported.map_or_else(
        || format!("Motor {id} reports no loop; the {asked} was asked for"),
        |reported| format!("Motor {id} stays in the {reported}; the {asked} was asked for"),
    );
    let advice = match asked {
        Mode::Position => "It refuses the position loop at 10 rpm and above: stop it, then switch.",
        Mode::Current | Mode::Velocity => {
            "Press Switch again. If it stays, turn its power off and on."
        }
    };
    words(Topic::Loop(id), Tone::Error, title, &[advice])
}

fn of_withdrawal(id: MotorId, reason: WithdrawReason) -> Words {
    let (why, advice) = match reason {
        WithdrawReason::Silent => (
            "it did not answer for 200 ms".to_owned(),
            "Check its power and the signal plug, then press Start.",
        ),
        WithdrawReason::Fault(faults) => (
            format!("it reports {faults}"),
            "Wait until the fault clears, free the wheel if it is blocked, then press Start.",
        ),
        WithdrawReason::OtherLoop { reported } => (
            format!("it reports the {reported}: it lost power, or another master spoke"),
            "Check its power, then switch its loop and press Start.",
        ),
        WithdrawReason::Limit(crossed) => (
            format!("{crossed}"),
            "Find out why. The limits stand under Settings; nothing starts by itself.",
        ),
    };
    words(
        Topic::Setpoint(id),
        Tone::Error,
        format!("Motor {id} is being stopped: {why}"),
        &[advice],
    )
}

fn of_stop(report: &StopReport) -> Option<Words> {
    let open: Vec<String> = report
        .motors
        .iter()
        .copied()
        .filter(|motor| !motor.confirmed)
        .map(of_unconfirmed)
        .collect();
    if open.is_empty() {
        return None;
    }
    Some(words(
        Topic::Stop,
        Tone::Error,
        format!("Standstill is not confirmed: {}", open.join(", ")),
        &["Look at the wheel. If it turns, switch its power off."],
    ))
}

fn of_unconfirmed(motor: StopOutcome) -> String {
    let speed = motor
        .speed
        // Without a sign, which a mirrored motor has the other way round.
        .map_or_else(
            || "speed unknown".to_owned(),
            |speed| format!("{} rpm", speed.magnitude()),
        );
    format!("motor {} ({speed})", motor.id)
}

fn of_lost_adapter(driven: &[MotorId]) -> Words {
    let coasts = match driven {
        [] => None,
        [id] => Some(format!(
            "Motor {id} was driven: without frames its wheel coasts to a standstill. Keep clear."
        )),
        ids => Some(format!(
            "{} motors were driven: without frames their wheels coast to a standstill. Keep clear.",
            ids.len()
        )),
    };
    let mut words = words(Topic::Port, Tone::Error, "The adapter was pulled out", &[]);
    words.advice.extend(coasts);
    let plug = "Plug it in again: the page reconnects, and nothing drives until you press Start.";
    words.advice.push(plug.to_owned());
    words
}

/// The worker itself has failed.
pub(crate) fn of_dead_worker(driven: bool) -> Words {
    let coasts = "Its frames have ceased, so a wheel that was driven coasts to a standstill.";
    let mut words = words(
        Topic::Worker,
        Tone::Error,
        "The background worker has stopped",
        &["Reload the page to go on."],
    );
    if driven {
        words.advice.insert(0, coasts.to_owned());
    }
    words.remedy = Some(Remedy::Reload);
    words
}

/// Another motor was chosen while one was driven.
pub(crate) fn of_choice_while_driven(before: MotorId, chosen: MotorId) -> Words {
    words(
        Topic::Choice,
        Tone::Calm,
        format!("Motor {before} is being stopped"),
        &[&format!(
            "You chose motor {chosen}; only the chosen motor is driven."
        )],
    )
}

/// Why all motors are stopped, in the words of the dialog.
pub(crate) const fn of_stop_reason(reason: StopReason) -> &'static str {
    match reason {
        StopReason::Operator => "You pressed Stop all motors.",
        StopReason::PageHidden => "The page was hidden, and Keep driving while hidden is off.",
        StopReason::PageGone => "The page was closed, reloaded or frozen.",
        StopReason::PageSilent => "The page did not answer its worker for a second.",
        StopReason::Disconnect => "The port was closed.",
        StopReason::OneMotor => "A motor was stopped.",
        StopReason::Survey => "The bus is to be scanned.",
    }
}

#[cfg(test)]
#[path = "words_tests.rs"]
mod tests;
