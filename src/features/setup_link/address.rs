//! The address of the page. This is loaded with the tools; the panel loads when it is opened.

use js_sys::Reflect;
use leptos::prelude::*;
use wasm_bindgen::JsValue;

use crate::{
    model::{page::Page, place::Panel},
    ui::listener::on_window,
};

/// What is before a setup. A browser sends the fragment to no server.
pub(super) const IN_ADDRESS: &str = "#setup=";

/// Opens the panel if the address has a setup, now and whenever the address changes.
pub(crate) fn watch(page: Page) {
    let open = move || {
        if part("hash").starts_with(IN_ADDRESS) {
            page.open_in_setup(Panel::SetupLink);
        }
    };
    open();
    on_window("hashchange", move |_| open());
}

/// A part of the address, such as `hash`. A typed binding to each would add to the first program.
pub(super) fn part(name: &str) -> String {
    let location = JsValue::from(window().location());
    let part = Reflect::get(&location, &name.into()).ok();
    part.and_then(|part| part.as_string()).unwrap_or_default()
}
