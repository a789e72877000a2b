//! Texts that are stored before it is known in which language they will be read.
//!
//! Within [`untranslated`], `tr!` gives English, and a message with placeholders keeps its values apart: its
//! English, then each value in the order of the placeholders. [`translate`] puts such a text into the current
//! language. A value may itself be such a message.
//!
//! ```
//! use motorlink_i18n::{Language, set_language, tr, translate, untranslated};
//!
//! let id = 7;
//! let stored = untranslated(|| tr!("No reply from motor {id}", id));
//! assert_eq!(translate(&stored), "No reply from motor 7");
//! set_language(Language::German);
//! assert_eq!(translate(&stored), tr!("No reply from motor {id}", id));
//! ```

use std::cell::Cell;

use crate::{
    language::{Language, current_language, set_language},
    next_placeholder,
    table::in_current_language,
    terms::in_language,
};

/// Begins a message with values.
pub(crate) const BEGIN: char = '\u{2}';
/// Precedes a value.
pub(crate) const VALUE: char = '\u{1F}';
/// Ends a message with values.
pub(crate) const END: char = '\u{3}';

thread_local! {
    static IS_UNTRANSLATED: Cell<bool> = const { Cell::new(false) };
}

/// Whether texts are being stored.
pub(crate) fn is_untranslated() -> bool {
    IS_UNTRANSLATED.get()
}

/// Runs a function whose texts are stored: see the module.
pub fn untranslated<T>(texts: impl FnOnce() -> T) -> T {
    let language = current_language();
    set_language(Language::English);
    IS_UNTRANSLATED.set(true);
    let stored = texts();
    IS_UNTRANSLATED.set(false);
    set_language(language);
    stored
}

/// A stored text in the current language. What is no message stays as it is, such as a name; numbers get the
/// decimal mark of the language.
#[must_use]
#[inline(never)]
pub fn translate(stored: &str) -> String {
    let mut out = String::new();
    let mut rest = stored;
    while !rest.is_empty() {
        push_text(&mut out, &mut rest);
        // A mark without its beginning: no text of this program has one.
        rest = behind_mark(rest);
    }
    out
}

/// Adds all up to the end of a message or value.
fn push_text(out: &mut String, rest: &mut &str) {
    loop {
        let plain = take_plain(rest);
        match in_current_language(plain) {
            Some(message) => out.push_str(message),
            None if is_number(plain) => out.push_str(&in_language(plain.to_owned())),
            None => out.push_str(plain),
        }
        if !rest.starts_with(BEGIN) {
            return;
        }
        *rest = behind_mark(rest);
        push_message(out, rest);
    }
}

/// Adds the message that begins here, and skips its end. A truncated one lacks values.
#[inline(never)]
fn push_message(out: &mut String, rest: &mut &str) {
    let english = take_plain(rest);
    let mut values = Vec::new();
    while rest.starts_with(VALUE) {
        *rest = behind_mark(rest);
        let mut value = String::new();
        push_text(&mut value, rest);
        values.push(value);
    }
    *rest = behind_mark(rest);
    let mut text = in_current_language(english).unwrap_or(english);
    while let Some((before, name, after)) = next_placeholder(text) {
        out.push_str(before);
        // The values are in the order of the English.
        let mut places = english;
        for value in &values {
            let Some((_, place, behind)) = next_placeholder(places) else {
                break;
            };
            if place == name {
                out.push_str(value);
            }
            places = behind;
        }
        text = after;
    }
    out.push_str(text);
}

/// Whether it begins with a sign or a digit; an ID, `0x01`, does not count.
fn is_number(text: &str) -> bool {
    !text.starts_with("0x")
        && text.starts_with(|first: char| matches!(first, '+' | '\u{2212}' | '0'..='9'))
}

/// The text up to the next mark.
fn take_plain<'a>(rest: &mut &'a str) -> &'a str {
    let is_mark = |byte: &u8| [BEGIN as u8, VALUE as u8, END as u8].contains(byte);
    let end = rest.as_bytes().iter().position(is_mark);
    let (plain, behind) = rest.split_at(end.unwrap_or(rest.len()));
    *rest = behind;
    plain
}

/// The text behind the mark that begins it.
fn behind_mark(rest: &str) -> &str {
    rest.get(1..).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use motorlink_protocol::Faults;

    use super::*;
    use crate::{terms, tr};

    /// Its text in each language, stored and as it is said at once.
    fn in_all_languages(text: impl Fn() -> String) {
        set_language(Language::Chinese);
        let stored = untranslated(&text);
        assert_eq!(current_language(), Language::Chinese);
        for language in Language::ALL {
            set_language(language);
            assert_eq!(translate(&stored), text());
        }
    }

    #[test]
    fn a_stored_text_is_read_in_any_language() {
        in_all_languages(|| tr!("Disconnected").to_owned());
        in_all_languages(|| {
            let goal = in_language("+0.50 A".to_owned());
            tr!("Motor {id} is running: {goal}", id = "0x01", goal)
        });
        // One message in another, and several in a list.
        in_all_languages(|| {
            let speed = tr!("{speed} rpm", speed = 3);
            let motor = tr!("motor {id} ({speed})", id = "0x01", speed);
            let motors = format!("{motor}, {motor}");
            tr!("Standstill not confirmed: {motors}", motors)
        });
        in_all_languages(|| {
            let faults = Faults::from_byte(0x18);
            tr!(
                "it reports a fault ({faults})",
                faults = terms::faults(faults)
            )
        });
    }

    #[test]
    fn other_texts_stay_as_they_are() {
        set_language(Language::German);
        for text in ["", "Arm v1.2", "0x01, 0x07", "CH343, 1a86:55d3"] {
            assert_eq!(translate(text), text);
        }
        // A message of another version is in English.
        let other = format!("{BEGIN}Motor {{id}} of old{VALUE}0x01{END}!");
        assert_eq!(translate(&other), "Motor 0x01 of old!");
    }

    #[test]
    fn a_truncated_text_is_read_up_to_there() {
        set_language(Language::English);
        let (id, goal) = ("0x01", "+5");
        let stored = untranslated(|| tr!("Motor {id} is running: {goal}", id, goal));
        let length = stored.chars().count();
        for kept in 0..length {
            let part: String = stored.chars().take(kept).collect();
            assert!(translate(&part).len() <= "Motor 0x01 is running: +5".len());
        }
        assert_eq!(translate("\u{3}a\u{1F}b"), "ab");
    }
}
