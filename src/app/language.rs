//! The language of the page: from the address, the stored choice or the browser.

use leptos::{prelude::*, task::spawn_local};
use motorlink_i18n::{Language, has, load_texts, set_language};

use crate::{
    app::features::Features,
    link::{address::parameter, files},
    model::{
        local_storage::{remember, remembered},
        notice_texts::of_missing_language,
    },
};

/// The key of the stored choice.
pub(crate) const STORED_AS: &str = "language";

/// The first supported language of these tags, or English.
pub(crate) fn first_known<'a>(tags: impl IntoIterator<Item = &'a str>) -> Language {
    let mut known = tags.into_iter().filter_map(Language::from_tag);
    known.next().unwrap_or_default()
}

/// The language from the address, the stored choice or the browser, in this order.
pub(crate) fn preferred() -> Language {
    let mut tags: Vec<String> = parameter("lang").into_iter().collect();
    tags.extend(remembered(STORED_AS));
    if let Some(window) = web_sys::window() {
        let browsers = window.navigator().languages();
        tags.extend(browsers.iter().filter_map(|tag| tag.as_string()));
    }
    first_known(tags.iter().map(String::as_str))
}

/// Sets the language of the page. Existing notices are not translated.
pub(crate) fn use_language(language: Language) {
    set_language(language);
    if let Some(root) = document().document_element() {
        let _ = root.set_attribute("lang", language.tag());
    }
}

/// Fetches the texts of a language unless they are loaded. Returns false if that fails.
pub(crate) async fn fetch(language: Language) -> bool {
    if has(language) {
        return true;
    }
    let address = files::address(&["motorlink-text-", language.key()].concat());
    match address {
        Some(address) => files::text_of(&address)
            .await
            .is_some_and(|file| load_texts(language, file)),
        None => false,
    }
}

impl Features {
    /// Draws the page in another language, once its texts are loaded. Driving continues: the worker does not
    /// depend on the language.
    pub(crate) fn choose_language(self, language: Language) {
        if has(language) {
            self.change_language(language);
            return;
        }
        spawn_local(async move {
            if fetch(language).await {
                self.change_language(language);
            } else {
                self.page.notify(&|| of_missing_language(language));
                // Reset the list to the language of the page.
                self.page.language.notify();
            }
        });
    }

    fn change_language(self, language: Language) {
        remember(STORED_AS, language.key());
        use_language(language);
        self.log.set_language(language);
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
