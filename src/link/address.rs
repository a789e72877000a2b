//! The address of the page.

/// A query parameter, such as `virtual` of `?port=virtual`.
pub(crate) fn parameter(name: &str) -> Option<String> {
    let query = web_sys::window()?.location().search().ok()?;
    web_sys::UrlSearchParams::new_with_str(&query)
        .ok()?
        .get(name)
}
