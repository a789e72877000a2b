//! The browser's dialog for a file to write (File System Access API). Firefox and Safari have none.

use js_sys::{Array, Function, Object, Promise, Reflect};
use leptos::prelude::window;
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::JsFuture;
use web_sys::DomException;

/// What came of it.
pub(super) enum Picked {
    /// The handle of a file.
    File(JsValue),
    /// The user has closed the dialog.
    Cancelled,
    /// The browser has no such dialog, or does not allow it here.
    NoDialog,
}

/// Opens the dialog. It has to be called in a press of a button.
pub(super) async fn pick(name: &str, description: &str) -> Picked {
    let Ok(Some(dialog)) = show(name, description) else {
        return Picked::NoDialog;
    };
    match JsFuture::from(dialog).await {
        Ok(handle) => Picked::File(handle),
        Err(error) => {
            let error = error.dyn_ref::<DomException>().map(DomException::name);
            match error.as_deref() {
                Some("AbortError") => Picked::Cancelled,
                _ => Picked::NoDialog,
            }
        }
    }
}

/// The name of a chosen file.
pub(super) fn name_of(handle: &JsValue) -> Option<String> {
    Reflect::get(handle, &"name".into()).ok()?.as_string()
}

/// Removes the file of a handle if it is empty, as the dialog has left it: it would be no session. Chromium only; a
/// failure leaves the file.
pub(super) async fn remove_if_empty(handle: &JsValue) -> Result<(), JsValue> {
    let call = |method: &str| {
        let method = Reflect::get(handle, &method.into())?;
        let called = method.dyn_into::<Function>()?.call0(handle)?;
        called.dyn_into::<Promise>()
    };
    let file = JsFuture::from(call("getFile")?).await?;
    let size = Reflect::get(&file, &"size".into())?;
    if size == 0 {
        JsFuture::from(call("remove")?).await?;
    }
    Ok(())
}

fn show(name: &str, description: &str) -> Result<Option<Promise>, JsValue> {
    let show = Reflect::get(&window(), &"showSaveFilePicker".into())?;
    let Ok(show) = show.dyn_into::<Function>() else {
        return Ok(None);
    };
    let object = |entries: &[(&str, &JsValue)]| {
        let object = Object::new();
        for (key, value) in entries {
            Reflect::set(&object, &(*key).into(), value)?;
        }
        Ok::<JsValue, JsValue>(object.into())
    };
    let endings = Array::of1(&".mcap".into());
    let accept = object(&[("application/octet-stream", &endings)])?;
    let kind = object(&[("description", &description.into()), ("accept", &accept)])?;
    let kinds = Array::of1(&kind);
    let options = object(&[("suggestedName", &name.into()), ("types", &kinds)])?;
    let dialog = show.call1(&window(), &options)?;
    Ok(Some(dialog.unchecked_into()))
}
