//! Texts of the help outside of its files.

use motorlink_i18n::tr;

/// The language of the help, by the name of its file in `public/help/`.
pub(crate) fn help_language() -> &'static str {
    motorlink_i18n::current_language().key()
}

pub(crate) fn loading() -> &'static str {
    tr!("Loading help.")
}
pub(crate) fn not_loaded() -> &'static str {
    tr!("Help could not be loaded. Check your network connection, then try again.")
}
