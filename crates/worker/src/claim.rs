//! Claims an adapter for this tab: two tabs must not write to one line.
//!
//! A claim is a Web Lock, because the browser releases the locks of a worker however it ends. Web Serial
//! gives an adapter no name that another tab would know. So there are as many locks for a model of
//! adapter as there are adapters of it plugged in; opening them shows which one is free. Claims are
//! processed one after the other, and the last one counts. If the browser refuses a lock, the tab goes
//! on without one.
//!
//! With the claim the file is opened that remembers what is driven: see [`crate::driven_file`].
//!
//! The script that starts the worker (`boot/adapters.js`) takes and keeps the lock: a promise inside a
//! callback is five lines of JavaScript, but two kilobytes of wasm.

use js_sys::{Function, Promise, Reflect};
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::JsFuture;

use crate::{driven_file::DrivenFile, scope::global};

/// Claims an adapter of the same model as the port at this place, and releases the claim of another
/// model. Gives what remembers what is driven on it, or nothing when other tabs have all adapters of that model.
pub(crate) async fn claim(place: u16) -> Option<DrivenFile> {
    let claimed = match call(&place.into()) {
        Some(promise) => JsFuture::from(promise).await.unwrap_or_default(),
        None => JsValue::UNDEFINED,
    };
    // Without locks, the port itself refuses a second tab.
    (claimed != JsValue::FALSE).then(|| DrivenFile::of(claimed))
}

/// Releases the claim, and any claim that is still pending.
pub(crate) fn release_claim() {
    call(&JsValue::UNDEFINED);
}

/// Calls `claimAdapter` of the script.
fn call(place: &JsValue) -> Option<Promise> {
    let function = Reflect::get(&global(), &"claimAdapter".into()).ok()?;
    let function: Function = function.dyn_into().ok()?;
    let promise = function.call1(&JsValue::UNDEFINED, place).ok()?;
    promise.dyn_into().ok()
}
