//! Text files of the site, fetched when they are needed.

use wasm_bindgen::JsCast;
use wasm_bindgen_futures::JsFuture;
use web_sys::Response;

/// The text at an address relative to the page. `None` where the file or the network is missing.
pub(crate) async fn text_of(address: &str) -> Option<String> {
    let response = web_sys::window()?.fetch_with_str(address);
    let response: Response = JsFuture::from(response).await.ok()?.dyn_into().ok()?;
    if !response.ok() {
        return None;
    }
    JsFuture::from(response.text().ok()?)
        .await
        .ok()?
        .as_string()
}

/// The address of a file whose name the build writes into a `meta` element of the page.
pub(crate) fn address(meta: &str) -> Option<String> {
    let document = web_sys::window()?.document()?;
    let named = document
        .query_selector(&format!("meta[name={meta}]"))
        .ok()??;
    named.get_attribute("content")
}
