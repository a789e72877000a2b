//! Translations of the page's texts.
//!
//! The English text is in the code, in [`tr!`]; the translations are in `locales/*.po`, in the format of
//! gettext. The compiler checks that each message exists there and that its placeholders match. A release
//! build checks that all are translated. The program contains English; the page fetches the file of another
//! language when it is chosen. `cargo xtask translations` updates the files from the code.
//!
//! ```
//! use motorlink_i18n::{Language, set_language, tr};
//!
//! assert_eq!(tr!("Help"), "Help");
//! assert_eq!(tr!("No reply from motor {id}", id = 7), "No reply from motor 7");
//! set_language(Language::German);
//! assert_eq!(tr!("Help"), "Hilfe");
//! ```

pub mod family_terms;
mod language;
mod table;
pub mod terms;
mod untranslated;

use std::fmt::{Display, Write};

pub use language::{Language, current_language, set_language};
#[cfg(feature = "embedded")]
pub use table::file;
#[doc(hidden)]
pub use table::{check_places, number_of, text, translated};
pub use table::{has, load_later_texts, load_texts, loaded_texts};
use untranslated::{BEGIN, END, VALUE, is_untranslated};
pub use untranslated::{translate, untranslated};

/// A text in the [`current_language`].
///
/// A text without placeholders is a `&'static str`, one with placeholders in braces a `String`. A word that
/// needs another translation elsewhere has a context: `tr!("Current" as "electric")`.
///
/// # Compile errors
///
/// If `locales/*.po` do not have the message, or if the placeholders and the given values differ.
#[macro_export]
macro_rules! tr {
    ($text:literal $(as $context:literal)?) => {
        $crate::text(const { $crate::number_of($crate::key!($text $($context)?)) })
    };
    ($text:literal $(as $context:literal)?, $($name:ident $(= $value:expr)?),+ $(,)?) => {{
        const { $crate::check_places($text, &[$(stringify!($name)),+]) };
        $crate::filled(
            const { $crate::number_of($crate::key!($text $($context)?)) },
            &[$((stringify!($name), &$crate::value!($name $($value)?))),+],
        )
    }};
}

#[doc(hidden)]
#[macro_export]
macro_rules! key {
    ($text:literal) => {
        $text
    };
    ($text:literal $context:literal) => {
        concat!($context, "\u{4}", $text)
    };
}

#[doc(hidden)]
#[macro_export]
macro_rules! value {
    ($name:ident) => {
        $name
    };
    ($name:ident $value:expr) => {
        $value
    };
}

/// The message of a number with its placeholders filled, or with its values apart: see [`untranslated`].
#[doc(hidden)]
#[must_use]
pub fn filled(number: usize, values: &[(&str, &dyn Display)]) -> String {
    let text = text(number);
    let is_stored = is_untranslated();
    let mut filled = String::new();
    if is_stored {
        filled.push(BEGIN);
        filled.push_str(text);
    }
    let mut rest = text;
    while let Some((before, name, after)) = next_placeholder(rest) {
        if is_stored {
            filled.push(VALUE);
        } else {
            filled.push_str(before);
        }
        if let Some((_, value)) = values.iter().find(|(known, _)| *known == name) {
            // Writing to a string cannot fail.
            let _ = write!(filled, "{value}");
        }
        rest = after;
    }
    if is_stored {
        filled.push(END);
    } else {
        filled.push_str(rest);
    }
    filled
}

/// The text before the next placeholder, its name, and the text behind it.
fn next_placeholder(text: &str) -> Option<(&str, &str, &str)> {
    let (before, opened) = text.split_once('{')?;
    let (name, after) = opened.split_once('}').unwrap_or((opened, ""));
    Some((before, name, after))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_in_the_current_language() {
        assert_eq!(tr!("Help"), "Help");
        set_language(Language::German);
        assert_eq!(tr!("Help"), "Hilfe");
        set_language(Language::Chinese);
        assert_eq!(tr!("Help"), "帮助");
    }

    #[test]
    fn places_are_filled_wherever_a_language_has_them() {
        let id = 7;
        assert_eq!(tr!("No reply from motor {id}", id), "No reply from motor 7");
        set_language(Language::Chinese);
        let said = tr!("No reply from motor {id}", id = "0x07");
        assert!(said.contains("0x07") && !said.contains('{'), "{said}");
    }

    #[test]
    fn one_word_has_a_translation_in_each_context() {
        assert_eq!(tr!("Current" as "electric"), "Current");
        set_language(Language::German);
        assert_eq!(tr!("Current" as "electric"), "Strom");
        assert_eq!(translated("Current"), "Strom");
        assert_eq!(translated("+100"), "+100");
    }
}
