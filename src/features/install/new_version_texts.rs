//! The texts about a new version of the page.

use motorlink_i18n::tr;

use crate::model::notice_board::{NoticeText, Remedy, Tone, Topic};

fn take_it(tone: Tone, title: &str, advice: &str) -> NoticeText {
    NoticeText {
        remedy: Some(Remedy::TakeNewVersion),
        ..NoticeText::new(Topic::NewVersion, tone, title, &[advice])
    }
}

/// It can be activated.
pub(crate) fn is_ready() -> NoticeText {
    take_it(
        Tone::Calm,
        tr!("A new version is ready"),
        tr!("Updating reloads the page. Your settings and session are kept."),
    )
}

/// It cannot be activated while a port is open.
pub(crate) fn not_while_open() -> NoticeText {
    take_it(
        Tone::Warning,
        tr!("Not updated"),
        tr!("A port is open. Press Disconnect first."),
    )
}

/// It cannot be activated while another tab has the page open.
pub(crate) fn not_beside_others() -> NoticeText {
    take_it(
        Tone::Warning,
        tr!("Not updated"),
        tr!("Another MotorLink tab is open and may be driving a motor. Close it first."),
    )
}
