//! Which language the page speaks: the one that the address names, or the one chosen here, or the browser's
//! own.

use leptos::prelude::*;
use motorlink_i18n::{Language, speak};

use crate::{app::features::Features, model::preferences::remember};

/// The name by which the choice is remembered.
pub(crate) const STORED_AS: &str = "language";

/// The first that is known of what the address, the memory and the browser name, in this order.
pub(crate) fn first_known<'a>(tags: impl IntoIterator<Item = &'a str>) -> Language {
    let mut known = tags.into_iter().filter_map(Language::from_tag);
    known.next().unwrap_or_default()
}

/// Has the page speak this language from now on. What is said already stays as it was said: notices, and
/// the lines of the log that are the page's own.
pub(crate) fn speak_from_now_on(language: Language) {
    speak(language);
    if let Some(root) = document().document_element() {
        let _ = root.set_attribute("lang", language.tag());
    }
}

impl Features {
    /// Speaks another language, and draws the page anew in it. What is driven is driven on: the worker knows
    /// nothing of it.
    pub(crate) fn choose_language(self, language: Language) {
        remember(STORED_AS, language.key());
        speak_from_now_on(language);
        self.log.speak(language);
        self.page.language.set(language);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_language_that_there_is_wins() {
        assert_eq!(first_known(["fr", "de-AT", "zh"]), Language::German);
        assert_eq!(first_known(["", "zh-TW", "en"]), Language::Chinese);
        assert_eq!(first_known(["fr", "ja"]), Language::English);
        assert_eq!(first_known([]), Language::English);
    }
}
