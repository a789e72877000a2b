//! Listeners on the window that get events before all others.

use leptos::prelude::*;
use wasm_bindgen::{JsCast, prelude::Closure};
use web_sys::{AddEventListenerOptions, Event, Window};

struct Listener {
    window: Window,
    name: &'static str,
    closure: Closure<dyn FnMut(Event)>,
}

/// Calls `handle` with every event of this name in the page, until the current owner is dropped.
///
/// It listens in the capture phase, in which an event goes from the window to its target. So it comes first, and gets
/// events that do not bubble.
pub(crate) fn on_window(name: &'static str, handle: impl FnMut(Event) + 'static) {
    let Some(window) = web_sys::window() else {
        return;
    };
    let closure = Closure::<dyn FnMut(Event)>::new(handle);
    let options = AddEventListenerOptions::new();
    options.set_capture(true);
    let added = window.add_event_listener_with_callback_and_add_event_listener_options(
        name,
        closure.as_ref().unchecked_ref(),
        &options,
    );
    if added.is_ok() {
        StoredValue::new_local(Listener {
            window,
            name,
            closure,
        });
    }
}

/// Whether the window itself has lost the focus, and not an element in it.
pub(crate) fn is_of_window(blur: &Event) -> bool {
    let target = blur.target();
    target.is_some_and(|target| target.is_instance_of::<Window>())
}

impl Drop for Listener {
    fn drop(&mut self) {
        let callback = self.closure.as_ref().unchecked_ref();
        // A listener that cannot be removed was never added.
        let _ = self
            .window
            .remove_event_listener_with_callback_and_bool(self.name, callback, true);
    }
}
