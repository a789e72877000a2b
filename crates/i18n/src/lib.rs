//! What the page says, in each of its languages.
//!
//! The English stands where it is said, in [`tr!`]; the translations stand in `locales/*.po`, which any
//! editor of gettext's files opens. That a message is among them, and that what is to be filled in is
//! there and is used, is checked when the code is compiled; that all are translated, when it is built for
//! release. The English is in the program. The page fetches the file of another language when it is chosen. `cargo xtask translations` brings the files up to date with the code.
//!
//! ```
//! use motorlink_i18n::{Language, speak, tr};
//!
//! assert_eq!(tr!("Help"), "Help");
//! assert_eq!(tr!("No reply from motor {id}", id = 7), "No reply from motor 7");
//! speak(Language::German);
//! assert_eq!(tr!("Help"), "Hilfe");
//! ```

mod language;
mod table;
pub mod terms;

use std::fmt::{Display, Write};

pub use language::{Language, speak, spoken};
#[cfg(feature = "embedded")]
pub use table::file;
#[doc(hidden)]
pub use table::{check_places, number_of, said, text};
pub use table::{give, given, has};

/// Words in the language that is [`spoken`] now.
///
/// Words alone are a `&'static str`; words with places in braces that are to be filled are a `String`. A
/// word that needs another translation elsewhere has a context: `tr!("Current" as "electric")`.
///
/// # Compile errors
///
/// Where `locales/*.po` do not hold the message, and where the places in braces and what is to be filled
/// in are not the same.
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

/// The message of a number with its places filled.
#[doc(hidden)]
#[must_use]
pub fn filled(number: usize, values: &[(&str, &dyn Display)]) -> String {
    let mut filled = String::new();
    let mut rest = text(number);
    while let Some((before, opened)) = rest.split_once('{') {
        let (name, after) = opened.split_once('}').unwrap_or((opened, ""));
        filled.push_str(before);
        if let Some((_, value)) = values.iter().find(|(known, _)| *known == name) {
            // Writing to a string cannot fail.
            let _ = write!(filled, "{value}");
        }
        rest = after;
    }
    filled.push_str(rest);
    filled
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_come_in_the_language_that_is_spoken() {
        assert_eq!(tr!("Help"), "Help");
        speak(Language::German);
        assert_eq!(tr!("Help"), "Hilfe");
        speak(Language::Chinese);
        assert_eq!(tr!("Help"), "帮助");
    }

    #[test]
    fn places_are_filled_wherever_a_language_has_them() {
        let id = 7;
        assert_eq!(tr!("No reply from motor {id}", id), "No reply from motor 7");
        speak(Language::Chinese);
        let said = tr!("No reply from motor {id}", id = "0x07");
        assert!(said.contains("0x07") && !said.contains('{'), "{said}");
    }

    #[test]
    fn one_word_has_a_translation_in_each_context() {
        assert_eq!(tr!("Current" as "electric"), "Current");
        speak(Language::German);
        assert_eq!(tr!("Current" as "electric"), "Strom");
        assert_eq!(said("Current"), "Strom");
        assert_eq!(said("+100"), "+100");
    }
}
