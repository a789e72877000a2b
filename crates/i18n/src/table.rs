//! The messages by number. Numbers are assigned at compile time; texts are looked up at run time.

use std::cell::RefCell;

use crate::language::{Language, current_language};

include!(concat!(env!("OUT_DIR"), "/keys.rs"));

/// The messages in the order of their numbers, separated by NUL.
#[cfg(feature = "embedded")]
const ENGLISH: &str = include_str!(concat!(env!("OUT_DIR"), "/en.txt"));
#[cfg(not(feature = "embedded"))]
const ENGLISH: &str = include_str!(concat!(env!("OUT_DIR"), "/en-first.txt"));

thread_local! {
    /// The messages of each language, by its index in `Language::ALL`.
    static TEXTS: RefCell<[Option<Box<[&'static str]>>; 3]> = const { RefCell::new([const { None }; 3]) };
}

/// The file of a language: its messages in the order of their numbers, separated by NUL. For the build,
/// which writes the files, and for tests.
#[cfg(feature = "embedded")]
#[must_use]
pub const fn file(language: Language) -> &'static str {
    match language {
        Language::English => ENGLISH,
        Language::Chinese => include_str!(concat!(env!("OUT_DIR"), "/zh.txt")),
        Language::German => include_str!(concat!(env!("OUT_DIR"), "/de.txt")),
    }
}

/// The file of a language, if the program contains it.
const fn embedded(language: Language) -> Option<&'static str> {
    #[cfg(feature = "embedded")]
    let text = Some(file(language));
    #[cfg(not(feature = "embedded"))]
    let text = match language {
        Language::English => Some(ENGLISH),
        Language::Chinese | Language::German => None,
    };
    text
}

/// Whether the messages of a language are in the program or were loaded by [`load_texts`].
#[must_use]
pub fn has(language: Language) -> bool {
    embedded(language).is_some()
        || TEXTS.with_borrow(|texts| texts.get(language as usize).is_some_and(Option::is_some))
}

/// Loads the file of a language, for the life of the thread. Returns false and changes nothing if the file has
/// another number of messages than this program: it is of another version.
#[must_use]
pub fn load_texts(language: Language, file: String) -> bool {
    if file.split('\0').count() != KEYS.len() {
        return false;
    }
    store(language, file.leak());
    true
}

/// The loaded file of a language, to send it to a worker; `None` if the program contains it.
#[must_use]
pub fn loaded_texts(language: Language) -> Option<String> {
    if embedded(language).is_some() {
        return None;
    }
    TEXTS.with_borrow(|texts| Some(texts.get(language as usize)?.as_ref()?.join("\0")))
}

/// Makes the English texts known of the parts that load later. Such a part calls this first; the texts are in its file.
/// The files of other languages have them.
#[inline(never)]
pub fn load_later_texts() {
    #[cfg(not(feature = "embedded"))]
    {
        let later = include_str!(concat!(env!("OUT_DIR"), "/en-later.txt"));
        let is_known = TEXTS.with_borrow(|texts| {
            let english = texts.first().and_then(Option::as_ref);
            english.is_some_and(|english| english.len() == KEYS.len())
        });
        if !is_known {
            store(Language::English, [ENGLISH, later].join("\0").leak());
        }
    }
}

fn store(language: Language, file: &'static str) {
    TEXTS.with_borrow_mut(|texts| {
        if let Some(messages) = texts.get_mut(language as usize) {
            *messages = Some(file.split('\0').collect());
        }
    });
}

/// The message of a number in the current language, or in English if that language is not loaded.
#[must_use]
pub fn text(number: usize) -> &'static str {
    let language = if has(current_language()) {
        current_language()
    } else {
        Language::English
    };
    let find = || {
        TEXTS.with_borrow(|texts| {
            let messages = texts.get(language as usize)?.as_ref()?;
            messages.get(number).copied()
        })
    };
    if let Some(message) = find() {
        return message;
    }
    store(language, embedded(language).unwrap_or_default());
    find().unwrap_or_default()
}

/// The translation of an English message; `None` for another text, and in English.
#[inline(never)]
pub(crate) fn in_current_language(english: &str) -> Option<&'static str> {
    if current_language() == Language::English {
        return None;
    }
    let number = ENGLISH.split('\0').position(|one| one == english)?;
    Some(text(number))
}

/// The translation of an English message into the current language, in any context; other texts do not change.
/// For tests that press a button by its English name.
#[must_use]
pub fn translated(english: &str) -> &str {
    let is_it = |key: &&str| key.rsplit('\u{4}').next() == Some(english);
    match KEYS.iter().position(is_it) {
        Some(number) => text(number),
        None => english,
    }
}

/// The number of a message, at compile time.
///
/// # Panics
///
/// If no file of translations has the message.
#[must_use]
#[allow(
    clippy::panic,
    reason = "evaluated by the compiler, whose error it becomes"
)]
pub const fn number_of(key: &str) -> usize {
    // Both parts are sorted.
    if let Some(number) = found_in(key, 0, FIRST) {
        return number;
    }
    match found_in(key, FIRST, KEYS.len()) {
        Some(number) => number,
        None => panic!(
            "locales/*.po do not hold this message: run `cargo xtask translations` and translate it"
        ),
    }
}

#[allow(
    clippy::indexing_slicing,
    reason = "evaluated by the compiler, whose error it becomes"
)]
/// The number of a message in a sorted part of the keys.
const fn found_in(key: &str, mut from: usize, mut to: usize) -> Option<usize> {
    while from < to {
        let middle = usize::midpoint(from, to);
        match compared(key.as_bytes(), KEYS[middle].as_bytes()) {
            0 => return Some(middle),
            1.. => from = middle + 1,
            _ => to = middle,
        }
    }
    None
}

#[allow(
    clippy::indexing_slicing,
    reason = "evaluated by the compiler, whose error it becomes"
)]
const fn compared(left: &[u8], right: &[u8]) -> i32 {
    let mut at = 0;
    while at < left.len() && at < right.len() {
        if left[at] != right[at] {
            return if left[at] < right[at] { -1 } else { 1 };
        }
        at += 1;
    }
    if left.len() == right.len() {
        0
    } else if left.len() < right.len() {
        -1
    } else {
        1
    }
}

/// Checks at compile time that a message has exactly these placeholders.
///
/// # Panics
///
/// If one is missing on either side.
#[allow(
    clippy::panic,
    clippy::indexing_slicing,
    reason = "evaluated by the compiler, whose error it becomes"
)]
pub const fn check_places(text: &str, names: &[&str]) {
    let text = text.as_bytes();
    let (mut at, mut places) = (0, 0);
    while at < text.len() {
        if text[at] == b'{' {
            let mut known = 0;
            while known < names.len() && !starts_with(text, at + 1, names[known].as_bytes()) {
                known += 1;
            }
            assert!(known < names.len(), "a place in braces is not filled");
            places += 1;
        }
        at += 1;
    }
    assert!(
        places >= names.len(),
        "what is to be filled in has no place in braces"
    );
}

/// Whether this name and a closing brace follow here.
#[allow(
    clippy::indexing_slicing,
    reason = "evaluated by the compiler, whose error it becomes"
)]
const fn starts_with(text: &[u8], from: usize, name: &[u8]) -> bool {
    let mut at = 0;
    while at < name.len() {
        if from + at >= text.len() || text[from + at] != name[at] {
            return false;
        }
        at += 1;
    }
    from + at < text.len() && text[from + at] == b'}'
}
