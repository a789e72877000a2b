//! The texts of notices that come only after a while: a motor is driven, a line fails, a scan ends. They load with a
//! later part.

use std::cell::Cell;

use motorlink_i18n::tr;
use motorlink_messages::{LineError, Notice};

use crate::model::{
    help_topic::HelpTopic,
    notice_board::{NoticeText, Tone, Topic},
    scan_texts,
};

type Texts = fn(&Notice) -> Option<NoticeText>;

thread_local! {
    static LOADED: Cell<Option<Texts>> = const {
        // Native tests load no parts.
        Cell::new(if cfg!(test) { Some(of_notice) } else { None })
    };
}

/// Called by the part that has the texts.
pub(crate) fn load() {
    LOADED.set(Some(of_notice));
}

/// The text of such a notice, once it is loaded.
pub(crate) fn if_loaded(notice: &Notice) -> Option<NoticeText> {
    LOADED.get()?(notice)
}

fn of_notice(notice: &Notice) -> Option<NoticeText> {
    match notice {
        Notice::NotRemembered => Some(NoticeText::new(
            Topic::Memory,
            Tone::Warning,
            tr!("This browser does not keep what is driven"),
            &[tr!(
                "If the page or the browser crashes, the next page does not know which motors to stop. Keep the power \
                 switch in reach."
            )],
        )),
        Notice::Missed => Some(NoticeText::new(
            Topic::Recorder,
            Tone::Warning,
            tr!("Entries of the packet log and notices are missing"),
            &[tr!(
                "The connection was too slow. Session files that the server writes (--log) have all entries."
            )],
        )),
        Notice::LineError { error, count } => Some(of_line_error(*error, *count)),
        Notice::ScanEnded(report) => Some(scan_texts::of_scan(report)),
        Notice::IdChangeEnded { from, to, outcome } => {
            Some(scan_texts::of_id_change(*from, *to, *outcome))
        }
        Notice::SendsText { is_json: true } => Some(NoticeText::new(
            Topic::Line,
            Tone::Warning,
            tr!("The driver board answers in JSON"),
            &[
                tr!(
                    "Set the switch of the DDSM Driver HAT away from ESP32: then USB reaches the motors \
                     directly."
                ),
                choose_another_port(),
            ],
        )),
        Notice::SendsText { is_json: false } => Some(NoticeText::new(
            Topic::Line,
            Tone::Warning,
            tr!("Another device sends text on this port"),
            &[
                tr!(
                    "No motor sends text, so this port is left alone while the text goes on. It may be the log of a \
                     controller."
                ),
                choose_another_port(),
            ],
        )),
        _ => None,
    }
}

/// How to choose another port.
pub(crate) fn choose_another_port() -> &'static str {
    tr!("Another adapter? Press Disconnect, then Connect motor, and choose its port.")
}

fn of_line_error(error: LineError, count: u32) -> NoticeText {
    let title = match error {
        LineError::Break => tr!("Break on the bus: {count} since connecting", count),
        LineError::Framing => tr!("Framing errors: {count} since connecting", count),
        LineError::Parity => tr!("Parity errors: {count} since connecting", count),
        LineError::Overrun => tr!("Received bytes lost: {count} times since connecting", count),
        LineError::Other => tr!(
            "Corrupted bytes on the bus: {count} since connecting",
            count
        ),
    };
    let advice = match error {
        LineError::Overrun => tr!(
            "The computer was too busy for the adapter. Close other programs and tabs, or lower the command rate."
        ),
        _ => tr!(
            "Check A and B for a loose wire. If the bus is longer than 1 m, add 120 Ω across A and B."
        ),
    };
    NoticeText::new(Topic::Line, Tone::Warning, title, &[advice])
        .explained_at(HelpTopic::DamagedBytes)
}
