//! The texts about installing the page.

use motorlink_i18n::tr;

use crate::model::notice_board::{NoticeText, Remedy, Tone, Topic};

/// Why it cannot be installed.
pub(crate) fn installed() -> &'static str {
    tr!("Already installed.")
}
/// Why it cannot be installed.
pub(crate) fn not_offered() -> &'static str {
    tr!("This browser does not offer installation here. Check the browser menu.")
}
/// The hint of the button.
pub(crate) fn hint() -> &'static str {
    tr!("Opens in its own window, like other apps")
}

/// The advice after long driving in a tab.
pub(crate) fn advice() -> NoticeText {
    NoticeText {
        remedy: Some(Remedy::Install),
        ..NoticeText::new(
            Topic::Installing,
            Tone::Calm,
            tr!("Install MotorLink for long runs"),
            &[tr!(
                "The browser may discard a tab that stays hidden for long; a running wheel may then keep \
                 turning. It never discards an installed app."
            )],
        )
    }
}
