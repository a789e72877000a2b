//! Downloads of files that the page creates.

use leptos::prelude::*;
use std::time::Duration;
use wasm_bindgen::JsCast;
use web_sys::{Blob, HtmlElement, Url};

/// Time for the browser to read the file: the largest log is about 100 MB.
const KEPT_FOR: Duration = Duration::from_secs(60);

/// Makes the browser save a file under this name.
pub(crate) fn save_blob(blob: &Blob, name: &str) {
    let Ok(url) = Url::create_object_url_with_blob(blob) else {
        return;
    };
    // A clicked link is the only way to name a file.
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
            // It fails for expired addresses only.
            let _ = Url::revoke_object_url(&url);
        },
        KEPT_FOR,
    );
}
