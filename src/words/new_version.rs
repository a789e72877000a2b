//! A new version of the page, in words.

use motorlink_i18n::tr;

use super::words;
use crate::notice_board::{Remedy, Tone, Topic, Words};

fn take_it(tone: Tone, title: &str, advice: &str) -> Words {
    Words {
        remedy: Some(Remedy::TakeNewVersion),
        ..words(Topic::NewVersion, tone, title, &[advice])
    }
}

/// It can be taken.
pub(crate) fn is_ready() -> Words {
    take_it(
        Tone::Calm,
        tr!("A new version is ready"),
        tr!("Taking it loads the page anew. What is set and the session are kept."),
    )
}

/// It cannot be taken while a port is open.
pub(crate) fn not_while_open() -> Words {
    take_it(
        Tone::Warning,
        tr!("The new version was not taken"),
        tr!("A port is open. Press Disconnect first."),
    )
}

/// It cannot be taken while another tab has the page.
pub(crate) fn not_beside_others() -> Words {
    take_it(
        Tone::Warning,
        tr!("The new version was not taken"),
        tr!("Another tab of MotorLink is open, and may drive. Close it first."),
    )
}
