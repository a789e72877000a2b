//! The group `Remote` of the page, at the other end of a message port.

use js_sys::Array;
use motorlink_messages::remote::RemoteRequest;
use wasm_bindgen::{JsCast, prelude::Closure};
use web_sys::{MessageEvent, MessagePort};

use crate::scope::{global, report};

/// The port, and who listens at it.
pub(crate) struct Group {
    port: MessagePort,
    _on_message: Closure<dyn FnMut(MessageEvent)>,
}

impl Group {
    pub(crate) fn listen(
        port: MessagePort,
        mut asked: impl FnMut(RemoteRequest) + 'static,
    ) -> Self {
        let on_message = Closure::<dyn FnMut(MessageEvent)>::new(move |event: MessageEvent| {
            let text = event.data().as_string().unwrap_or_default();
            if let Some(request) = RemoteRequest::of(&text) {
                asked(request);
            }
        });
        port.set_onmessage(Some(on_message.as_ref().unchecked_ref()));
        Self {
            port,
            _on_message: on_message,
        }
    }

    /// Shows a text of [`WhoDrives`](motorlink_messages::remote::WhoDrives).
    pub(crate) fn show(&self, state: &str) {
        if let Err(error) = self.port.post_message(&state.into()) {
            report("the page did not take who drives", &error);
        }
    }
}

/// Calls `take` with the port of the group, which the page posts behind an empty message. To be called before
/// [`on_message`](crate::scope::on_message).
pub(crate) fn on_group(take: impl Fn(MessagePort) + 'static) {
    let handler = Closure::<dyn FnMut(MessageEvent)>::new(move |event: MessageEvent| {
        if let Ok(objects) = event.data().dyn_into::<Array>()
            && let Ok(port) = objects.get(1).dyn_into()
        {
            // It is no message of the page.
            event.stop_immediate_propagation();
            take(port);
        }
    });
    let added =
        global().add_event_listener_with_callback("message", handler.as_ref().unchecked_ref());
    if let Err(error) = added {
        report("the page cannot ask for control", &error);
    }
    handler.forget();
}
