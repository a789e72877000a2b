//! Which adapter is this tab's: two tabs must not speak on one line.
//!
//! A Web Lock decides, since whatever ends a worker gives its locks back. Web Serial has no name for an
//! adapter that another tab would know, so the tabs that have one of a make are counted against the
//! adapters of it that are plugged in; which of these is free is found by opening them. Claims are carried out one after the other, so that
//! the last is what stands; what the browser refuses is as without locks.
//!
//! The script that starts the worker (`boot/adapters.js`) takes and keeps the lock: a promise
//! that calls back to make a promise is five lines there, and two kilobytes here.

use js_sys::{Function, Promise, Reflect};
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::JsFuture;

use crate::scope::global;

/// Claims an adapter of the make of the port at this place, and gives back one of another make. False
/// when other tabs have all of that make.
pub(crate) async fn claim(place: u16) -> bool {
    let claimed = match call(&place.into()) {
        Some(promise) => JsFuture::from(promise).await.unwrap_or_default(),
        None => JsValue::UNDEFINED,
    };
    // Without locks the port itself has to refuse the second who opens it.
    claimed != JsValue::FALSE
}

/// Gives back what was claimed. Claims that are under way are given back, too.
pub(crate) fn give_back() {
    call(&JsValue::UNDEFINED);
}

/// The script's `claimAdapter`.
fn call(place: &JsValue) -> Option<Promise> {
    let function = Reflect::get(&global(), &"claimAdapter".into()).ok()?;
    let function: Function = function.dyn_into().ok()?;
    let promise = function.call1(&JsValue::UNDEFINED, place).ok()?;
    promise.dyn_into().ok()
}
