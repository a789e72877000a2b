//! Files that are dropped onto the page, or that the system opens with the installed app.
//!
//! This is loaded with the desk, because a file can come before the panel is opened. The panel takes it.

use js_sys::{Function, Promise, Reflect};
use leptos::{prelude::*, task::spawn_local};
use wasm_bindgen::{JsCast, JsValue, prelude::Closure};
use wasm_bindgen_futures::JsFuture;
use web_sys::Event;

use crate::{
    model::{page::Page, place::Place},
    ui::listener::on_window,
};

/// The file that waits for the panel.
#[derive(Clone, Copy)]
pub(crate) struct Incoming {
    pub(crate) file: RwSignal<Option<JsValue>, LocalStorage>,
}

impl Incoming {
    /// Of this page: made at the first call, for the owner of the page.
    pub(crate) fn of_page(owner: &Owner) -> Self {
        owner.with(|| {
            use_context().unwrap_or_else(|| {
                let new = Self {
                    file: RwSignal::new_local(None),
                };
                provide_context(new);
                new
            })
        })
    }

    pub(crate) fn take(self, page: Page, file: JsValue) {
        // Nothing if the page was closed meanwhile.
        if self.file.try_set(Some(file)).is_none() {
            page.open(Place::Record);
        }
    }

    /// Receives files until the current owner is dropped.
    pub(crate) fn listen(self, page: Page) {
        // Without this, the browser opens a dropped file in place of the page, and driving ends.
        on_window("dragover", |event| {
            if has_files(&event) {
                event.prevent_default();
            }
        });
        on_window("drop", move |event| {
            if !has_files(&event) {
                return;
            }
            event.prevent_default();
            if let Some(file) = first_file(&event) {
                self.take(page, file);
            }
        });
        self.listen_to_launches(page);
    }

    /// Receives the files with which the system opens the installed app.
    fn listen_to_launches(self, page: Page) {
        let queue = member(&window(), "launchQueue");
        let Ok(consume) = member(&queue, "setConsumer").dyn_into::<Function>() else {
            return;
        };
        // Not an event, but the type of closure that the first program has already.
        let consumer = Closure::<dyn FnMut(Event)>::new(move |launch: Event| {
            let handle = item(&member(&launch, "files"), 0);
            let Ok(get_file) = member(&handle, "getFile").dyn_into::<Function>() else {
                return;
            };
            let Ok(file) = get_file.call1(&handle, &JsValue::UNDEFINED) else {
                return;
            };
            let file: Promise = file.unchecked_into();
            spawn_local(async move {
                if let Ok(file) = JsFuture::from(file).await {
                    self.take(page, file);
                }
            });
        });
        // It fails in no browser that has the queue. There is one consumer for the life of the page.
        let _ = consume.call1(&queue, consumer.as_ref());
        consumer.forget();
    }
}

/// Whether files are dragged: text that is dragged goes into a field as always.
fn has_files(event: &JsValue) -> bool {
    let types = member(&member(event, "dataTransfer"), "types");
    (0..4).any(|place| item(&types, place).as_string().as_deref() == Some("Files"))
}

fn first_file(event: &JsValue) -> Option<JsValue> {
    let files = member(&member(event, "dataTransfer"), "files");
    let file = item(&files, 0);
    file.is_object().then_some(file)
}

/// A member of an object, or nothing. Typed bindings to these interfaces would add to the first program.
pub(super) fn member(object: &JsValue, name: &str) -> JsValue {
    Reflect::get(object, &name.into()).unwrap_or_default()
}

fn item(list: &JsValue, place: u32) -> JsValue {
    Reflect::get_u32(list, place).unwrap_or_default()
}
