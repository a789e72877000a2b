//! The languages, and the current one.

use std::cell::Cell;

/// A language of the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Language {
    /// The language of the code.
    #[default]
    English,
    /// Simplified Chinese.
    Chinese,
    /// German.
    German,
}

impl Language {
    /// All languages, in the order of the list.
    pub const ALL: [Self; 3] = [Self::English, Self::Chinese, Self::German];

    /// Its own name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::English => "English",
            Self::Chinese => "简体中文",
            Self::German => "Deutsch",
        }
    }

    /// The tag of BCP 47, for the attribute `lang`.
    #[must_use]
    pub const fn tag(self) -> &'static str {
        match self {
            Self::English => "en",
            Self::Chinese => "zh-Hans",
            Self::German => "de",
        }
    }

    /// The two letters in preferences, addresses and file names.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::English => "en",
            Self::Chinese => "zh",
            Self::German => "de",
        }
    }

    /// The language of a BCP 47 tag, such as `de`, `zh-CN` or `en-GB`. Any Chinese tag gives Simplified
    /// Chinese.
    #[must_use]
    pub fn from_tag(tag: &str) -> Option<Self> {
        let language = tag.split('-').next().unwrap_or_default();
        Self::ALL
            .into_iter()
            .find(|known| known.key().eq_ignore_ascii_case(language))
    }

    /// The decimal mark.
    #[must_use]
    pub const fn decimal_mark(self) -> char {
        match self {
            Self::English | Self::Chinese => '.',
            Self::German => ',',
        }
    }
}

thread_local! {
    static LANGUAGE: Cell<Language> = const { Cell::new(Language::English) };
}

/// Sets the language of this thread. The page and each of its workers are a thread.
pub fn set_language(language: Language) {
    LANGUAGE.set(language);
}

/// The language of this thread; English at first.
#[must_use]
pub fn current_language() -> Language {
    LANGUAGE.get()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_browser_s_language_is_found_by_its_first_part() {
        for (tag, language) in [
            ("en-GB", Some(Language::English)),
            ("zh-CN", Some(Language::Chinese)),
            ("zh-Hant-TW", Some(Language::Chinese)),
            ("DE", Some(Language::German)),
            ("fr", None),
            ("", None),
        ] {
            assert_eq!(Language::from_tag(tag), language, "{tag}");
        }
        for language in Language::ALL {
            assert_eq!(Language::from_tag(language.key()), Some(language));
            assert_eq!(Language::from_tag(language.tag()), Some(language));
        }
    }
}
