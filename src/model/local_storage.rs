//! Values that the browser keeps beyond a visit (`localStorage`): preferences, names and sides, targets, and what was seen.
//! Each is written when it changes.

/// A single stored value.
pub(crate) fn remembered(name: &str) -> Option<String> {
    storage()?.get_item(&key(name)).ok()?
}

/// Stores a single value. A browser that cannot store it is not an error.
pub(crate) fn remember(name: &str, text: &str) {
    if let Some(storage) = storage() {
        let _ = storage.set_item(&key(name), text);
    }
}

/// Removes all stored values of the page.
pub(crate) fn forget_all() {
    let Some(storage) = storage() else { return };
    let length = storage.length().unwrap_or_default();
    let names = (0..length).filter_map(|place| storage.key(place).ok()?);
    let ours: Vec<String> = names.filter(|name| name.starts_with(PREFIX)).collect();
    for name in ours {
        let _ = storage.remove_item(&name);
    }
}

/// The prefix of every key, because all pages of an origin share one store.
const PREFIX: &str = "motorlink.";

fn storage() -> Option<web_sys::Storage> {
    web_sys::window()?.local_storage().ok()?
}

fn key(name: &str) -> String {
    [PREFIX, name].concat()
}
