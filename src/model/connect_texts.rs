//! Texts about ports: their state, and connection errors.

use motorlink_i18n::tr;
use motorlink_messages::{Adapter, ConnectError, Connection};

use crate::{
    link::{address::BadParameter, serial_ports::PickTrouble},
    model::{
        help_topic::HelpTopic,
        notice_board::{NoticeText, Remedy, Tone, Topic},
        terms,
    },
};

/// The second line of the connection's state.
pub(crate) fn of_connection(connection: Connection) -> (&'static str, String) {
    match connection {
        Connection::Disconnected => (tr!("Disconnected"), tr!("No port is open").to_owned()),
        Connection::Connecting => (tr!("Connecting"), tr!("Opening the port").to_owned()),
        Connection::Connected(Adapter::Recording) => (tr!("Replay"), String::new()),
        Connection::Connected(adapter) => (tr!("Connected"), terms::adapter(adapter)),
        Connection::Reconnecting(adapter) => (
            tr!("Reconnecting"),
            tr!("Plug {adapter} back in", adapter = terms::adapter(adapter)),
        ),
        Connection::Failed(error) => (tr!("Failed"), failed_briefly(error).to_owned()),
    }
}

fn failed_briefly(error: ConnectError) -> &'static str {
    match error {
        ConnectError::NoWebSerial => tr!("No Web Serial: use Chrome, Edge or the virtual motor"),
        ConnectError::PortGone => tr!("The port is gone: press Other port"),
        ConnectError::OpenFailed => tr!("Close other programs and tabs that use the port"),
        ConnectError::AlreadyOpen => tr!("Already open: press Disconnect, then Connect motor"),
        ConnectError::Other => tr!("Replug the adapter, then press Connect motor"),
        ConnectError::OtherTab => tr!("Another MotorLink tab uses this adapter"),
        ConnectError::Forbidden => tr!("The browser blocks serial ports for this page"),
    }
}

/// The notice of a failed connection.
pub(crate) fn of_connect_error(error: ConnectError) -> NoticeText {
    let port = |title, advice| {
        NoticeText::new(Topic::Port, Tone::Error, title, advice)
            .explained_at(HelpTopic::PortDoesNotOpen)
    };
    match error {
        ConnectError::NoWebSerial => of_pick_trouble(PickTrouble::NoWebSerial),
        ConnectError::PortGone => port(
            tr!("The port is no longer available"),
            &[tr!(
                "Plug in the adapter, then press Connect motor or Other port."
            )],
        )
        .explained_at(HelpTopic::NoPortInList),
        ConnectError::OpenFailed => port(
            tr!("The port does not open"),
            &[
                tr!(
                    "In use? Close other tabs and programs that use the port, such as a serial \
                     monitor."
                ),
                tr!(
                    "Linux: no permission? Run sudo usermod -aG dialout $USER, then log out and \
                     in. A Snap or Flatpak browser may not see any ports: use the deb or rpm \
                     package."
                ),
                tr!(
                    "Linux: brltty claims CH340 adapters as Braille displays. If you do not need \
                     it: sudo apt remove brltty."
                ),
                tr!(
                    "Windows, macOS: install the driver for the adapter's chip (CH34x, CP210x, \
                     FTDI)."
                ),
                tr!("Port missing? Unplug the adapter and plug it back in."),
            ],
        ),
        ConnectError::AlreadyOpen => port(
            tr!("The port is already open"),
            &[tr!("Press Disconnect, then Connect motor.")],
        ),
        ConnectError::Other => port(
            tr!("The browser could not open the port"),
            &[tr!(
                "Unplug the adapter, plug it back in and press Connect motor."
            )],
        ),
        ConnectError::OtherTab => port(
            tr!("Another MotorLink tab uses this adapter"),
            &[tr!(
                "Press Disconnect in that tab or close it, then press Connect motor here."
            )],
        ),
        ConnectError::Forbidden => of_pick_trouble(PickTrouble::Forbidden),
    }
}

/// The notice of an address that asks for virtual motors that do not exist.
pub(crate) fn of_bad_parameter(bad: &BadParameter) -> NoticeText {
    NoticeText {
        topic: Topic::Port,
        tone: Tone::Error,
        title: tr!(
            "The address has an unknown value: {parameter}",
            parameter = &bad.text
        ),
        advice: vec![tr!(
            "Nothing is connected. Use one of: {values}.",
            values = bad.possible
        )],
        remedy: None,
        help: None,
    }
}

/// The notice if no port could be chosen.
pub(crate) fn of_pick_trouble(trouble: PickTrouble) -> NoticeText {
    let port = |tone, title, advice| {
        NoticeText::new(Topic::Port, tone, title, advice).explained_at(HelpTopic::NoPortInList)
    };
    match trouble {
        PickTrouble::NoWebSerial => port(
            Tone::Warning,
            tr!("This browser cannot open serial ports"),
            &[
                tr!(
                    "To drive a real motor, open this page in desktop Chrome, Edge or Firefox 151 \
                     or later, over HTTPS or on localhost."
                ),
                tr!("The virtual motor works here: press Virtual motor."),
            ],
        )
        .explained_at(HelpTopic::Ports),
        PickTrouble::Dismissed { filtered: true } => NoticeText {
            remedy: Some(Remedy::ShowAllPorts),
            ..port(
                Tone::Calm,
                tr!("No port selected"),
                &[
                    tr!(
                        "The list shows common USB-RS485 adapters first. If yours is missing, show \
                         all ports."
                    ),
                    tr!("Nothing in the list? Check the USB cable: some carry power only."),
                ],
            )
        },
        PickTrouble::Dismissed { filtered: false } => NoticeText {
            remedy: Some(Remedy::ShowAllPorts),
            ..port(
                Tone::Calm,
                tr!("No port selected"),
                &[tr!(
                    "Adapter not listed? Check the USB cable (some carry power only) and the \
                     driver for the adapter's chip."
                )],
            )
        },
        PickTrouble::Forbidden => port(
            Tone::Error,
            tr!("The browser blocks serial ports for this page"),
            &[tr!(
                "Allow serial ports in the site settings (icon left of the address), or ask your \
                 browser administrator."
            )],
        )
        .explained_at(HelpTopic::Ports),
        PickTrouble::Framed => port(
            Tone::Error,
            tr!("The browser blocks serial ports for this page"),
            &[tr!(
                "This page is a frame in another one that lacks allow=\"serial\". Open it in a tab of its own."
            )],
        )
        .explained_at(HelpTopic::Ports),
        PickTrouble::Vanished => of_connect_error(ConnectError::PortGone),
        PickTrouble::Unknown => NoticeText {
            remedy: Some(Remedy::ShowAllPorts),
            ..port(
                Tone::Error,
                tr!("The browser's port picker did not open"),
                &[tr!("Press Other port, or reload the page.")],
            )
        },
    }
}

#[cfg(test)]
mod tests {
    use motorlink_messages::Adapter;

    use super::*;

    #[test]
    fn every_trouble_says_what_to_do() {
        for error in [
            ConnectError::NoWebSerial,
            ConnectError::PortGone,
            ConnectError::OpenFailed,
            ConnectError::AlreadyOpen,
            ConnectError::Other,
            ConnectError::OtherTab,
            ConnectError::Forbidden,
        ] {
            assert!(!of_connect_error(error).advice.is_empty(), "{error:?}");
            let (state, brief) = of_connection(Connection::Failed(error));
            assert_eq!(state, "Failed");
            assert!(!brief.is_empty(), "{error:?}");
        }
        for trouble in [
            PickTrouble::NoWebSerial,
            PickTrouble::Dismissed { filtered: true },
            PickTrouble::Dismissed { filtered: false },
            PickTrouble::Forbidden,
            PickTrouble::Framed,
            PickTrouble::Vanished,
            PickTrouble::Unknown,
        ] {
            assert!(!of_pick_trouble(trouble).advice.is_empty(), "{trouble:?}");
        }
    }

    #[test]
    fn a_port_that_does_not_open_names_every_cause() {
        let all = of_connect_error(ConnectError::OpenFailed).advice.join(" ");
        for cause in [
            "other tabs",
            "dialout",
            "Snap",
            "brltty",
            "driver",
            "Port missing?",
        ] {
            assert!(all.contains(cause), "{cause}");
        }
    }

    #[test]
    fn a_model_that_does_not_exist_is_named_with_the_possible_ones() {
        let possible = "ddsm115, ddsm315, ddsm210, ddsm400";
        let bad = BadParameter {
            text: "model=ddsm500".to_owned(),
            possible,
        };
        let words = of_bad_parameter(&bad);
        assert!(words.title.contains("model=ddsm500"), "{}", words.title);
        let advice = words.advice.join(" ");
        assert!(advice.contains("Nothing is connected"), "{advice}");
        assert!(advice.contains(possible), "{advice}");
    }

    #[test]
    fn a_lost_adapter_is_to_be_plugged_in() {
        let (state, detail) = of_connection(Connection::Reconnecting(Adapter::VIRTUAL));
        assert_eq!(
            (state, detail.as_str()),
            ("Reconnecting", "Plug Virtual motor back in")
        );
    }
}
