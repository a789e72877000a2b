//! A file given to the person.

use leptos::prelude::*;
use std::time::Duration;
use wasm_bindgen::JsCast;
use web_sys::{Blob, HtmlElement, Url};

/// How long the browser may take to read the file: the largest log is some 100 MB.
const KEPT_FOR: Duration = Duration::from_secs(60);

/// Has the browser save a file under this name, where it saves files.
pub(crate) fn save_blob(blob: &Blob, name: &str) {
    let Ok(url) = Url::create_object_url_with_blob(blob) else {
        return;
    };
    // A link that is pressed is the one way to name a file.
    let link = document().create_element("a").ok();
    if let Some(link) = link.and_then(|link| link.dyn_into::<HtmlElement>().ok())
        && let Some(body) = document().body()
        && link.set_attribute("href", &url).is_ok()
        && link.set_attribute("download", name).is_ok()
        && body.append_child(&link).is_ok()
    {
        link.click();
        link.remove();
    }
    set_timeout(
        move || {
            // It fails for addresses that are none any more.
            let _ = Url::revoke_object_url(&url);
        },
        KEPT_FOR,
    );
}
