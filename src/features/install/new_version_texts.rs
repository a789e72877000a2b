//! A new version of the page, in words.

use motorlink_i18n::tr;

use crate::model::notice_board::{NoticeText, Remedy, Tone, Topic};

fn take_it(tone: Tone, title: &str, advice: &str) -> NoticeText {
    NoticeText {
        remedy: Some(Remedy::TakeNewVersion),
        ..NoticeText::new(Topic::NewVersion, tone, title, &[advice])
    }
}

/// It can be taken.
pub(crate) fn is_ready() -> NoticeText {
    take_it(
        Tone::Calm,
        tr!("A new version is ready"),
        tr!("Taking it loads the page anew. What is set and the session are kept."),
    )
}

/// It cannot be taken while a port is open.
pub(crate) fn not_while_open() -> NoticeText {
    take_it(
        Tone::Warning,
        tr!("The new version was not taken"),
        tr!("A port is open. Press Disconnect first."),
    )
}

/// It cannot be taken while another tab has the page.
pub(crate) fn not_beside_others() -> NoticeText {
    take_it(
        Tone::Warning,
        tr!("The new version was not taken"),
        tr!("Another tab of MotorLink is open, and may drive. Close it first."),
    )
}
