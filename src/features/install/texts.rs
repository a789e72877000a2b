//! The page as an installed program, in words.

use motorlink_i18n::tr;

use crate::model::notice_board::{NoticeText, Remedy, Tone, Topic};

/// Why it cannot be installed.
pub(crate) fn installed() -> &'static str {
    tr!("It is installed.")
}
/// Why it cannot be installed.
pub(crate) fn not_offered() -> &'static str {
    tr!("This browser does not offer it here; where it can, its own menu has it.")
}
/// What the button does.
pub(crate) fn hint() -> &'static str {
    tr!("A window of its own, and a place among the programs")
}

/// For those who drive for long in a tab.
pub(crate) fn advice() -> NoticeText {
    NoticeText {
        remedy: Some(Remedy::Install),
        ..NoticeText::new(
            Topic::Installing,
            Tone::Calm,
            tr!("Install MotorLink for long drives"),
            &[tr!(
                "A browser may discard a tab that is hidden for long, which stops the motors. It leaves the \
               window of an installed page alone."
            )],
        )
    }
}
