//! The messages by number. The numbers exist while the code is compiled; at run time there are the texts.

use std::cell::OnceCell;

use crate::language::{Language, spoken};

include!(concat!(env!("OUT_DIR"), "/keys.rs"));

static ENGLISH: &str = include_str!(concat!(env!("OUT_DIR"), "/en.txt"));
static CHINESE: &str = include_str!(concat!(env!("OUT_DIR"), "/zh.txt"));
static GERMAN: &str = include_str!(concat!(env!("OUT_DIR"), "/de.txt"));

thread_local! {
    /// One for each language: only what is spoken is ever split.
    static TEXTS: [OnceCell<Box<[&'static str]>>; 3] = const { [const { OnceCell::new() }; 3] };
}

/// The message of a number, in the language that is spoken.
#[must_use]
pub fn text(number: usize) -> &'static str {
    let (place, all) = match spoken() {
        Language::English => (0, ENGLISH),
        Language::Chinese => (1, CHINESE),
        Language::German => (2, GERMAN),
    };
    TEXTS
        .with(|texts| {
            let texts = texts.get(place)?.get_or_init(|| all.split('\0').collect());
            texts.get(number).copied()
        })
        .unwrap_or_default()
}

/// What a message of the code reads in the language that is spoken, in whatever context; a text that is none
/// of them stays. For tests that press a button by its English name.
#[must_use]
pub fn said(english: &str) -> &str {
    let is_it = |key: &&str| key.rsplit('\u{4}').next() == Some(english);
    match KEYS.iter().position(is_it) {
        Some(number) => text(number),
        None => english,
    }
}

/// The number of a message, while the code is compiled.
///
/// # Panics
///
/// Where no file of translations holds the message.
#[must_use]
#[allow(
    clippy::panic,
    clippy::indexing_slicing,
    reason = "evaluated by the compiler, whose error it becomes"
)]
pub const fn number_of(key: &str) -> usize {
    let (mut from, mut to) = (0, KEYS.len());
    while from < to {
        let middle = usize::midpoint(from, to);
        match compared(key.as_bytes(), KEYS[middle].as_bytes()) {
            0 => return middle,
            1.. => from = middle + 1,
            _ => to = middle,
        }
    }
    panic!("locales/*.po do not hold this message: run `cargo xtask translations` and translate it")
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

/// Whether a message has exactly these places, while the code is compiled.
///
/// # Panics
///
/// Where one is missing on either side.
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

/// Whether this name and the brace behind it stand here.
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
