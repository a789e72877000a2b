//! The worker's global object: its clock and its messages.

use std::{cell::Cell, rc::Rc};

use js_sys::{Array, Date, Uint8Array};
use motorlink_messages::{AwakeClock, ToPage, encode};
use motorlink_protocol::Instant;
use wasm_bindgen::{JsCast, JsValue, prelude::Closure};
use web_sys::{DedicatedWorkerGlobalScope, MessageEvent, MessagePort, Performance};

/// The worker's global object.
pub(crate) fn global() -> DedicatedWorkerGlobalScope {
    // The type is only a view: a wrong one fails at the first call, and this is a worker.
    js_sys::global().unchecked_into()
}

/// Reads the worker's monotonic clock, and counts the time that the computer slept.
#[derive(Clone, Debug)]
pub(crate) struct Clock {
    performance: Option<Performance>,
    /// Shared by all copies, so that a sleep is counted once.
    awake: Rc<Cell<AwakeClock>>,
}

impl Clock {
    pub(crate) fn new() -> Self {
        let clock = Self {
            performance: global().performance(),
            awake: Rc::default(),
        };
        clock.now();
        clock
    }

    /// Now, in microseconds since the worker's time origin. Browsers round to 0.1 ms.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a float cast saturates, and milliseconds since the start are positive"
    )]
    pub(crate) fn now(&self) -> Instant {
        let millis = self.performance.as_ref().map_or(0.0, Performance::now);
        let mut awake = self.awake.get();
        let millis = awake.read(millis, Date::now());
        self.awake.set(awake);
        Instant::from_micros((millis * 1000.0) as u64)
    }

    /// The zero of the clock, in milliseconds since 1970.
    pub(crate) fn origin_ms(&self) -> f64 {
        self.performance
            .as_ref()
            .map_or(0.0, Performance::time_origin)
    }
}

/// Posts a message to the page.
pub(crate) fn post(message: &ToPage) {
    posted(message);
}

/// The same; returns its bytes.
pub(crate) fn posted(message: &ToPage) -> Vec<u8> {
    let encoded = encode(message).unwrap_or_else(|error| {
        report("a message could not be encoded", &error.to_string().into());
        Vec::new()
    });
    post_bytes(&encoded);
    encoded
}

/// Posts bytes to the page as one transferred buffer.
pub(crate) fn post_bytes(bytes: &[u8]) {
    let array = Uint8Array::from(bytes);
    let transfer = Array::of1(&array.buffer());
    if let Err(error) = global().post_message_with_transfer(&array, &transfer) {
        report("a message could not be posted to the page", &error);
    }
}

/// A message from the page.
pub(crate) enum Incoming {
    /// An encoded message.
    Message(Vec<u8>),
    /// One end of the channel on which the port worker posts line events to the recorder.
    TrafficPort(MessagePort),
}

/// Calls `handle` with every message from the page, until the worker ends.
pub(crate) fn on_message(mut handle: impl FnMut(Incoming) + 'static) {
    let handler = Closure::<dyn FnMut(MessageEvent)>::new(move |event: MessageEvent| {
        let other = match event.data().dyn_into::<Uint8Array>() {
            Ok(bytes) => return handle(Incoming::Message(bytes.to_vec())),
            Err(other) => other,
        };
        match other.dyn_into::<MessagePort>() {
            Ok(port) => handle(Incoming::TrafficPort(port)),
            Err(other) => report("the page sent neither bytes nor a port", &other),
        }
    });
    global().set_onmessage(Some(handler.as_ref().unchecked_ref()));
    handler.forget();
}

/// Writes an internal error to the console. Errors that a user can act on go to the page.
pub(crate) fn report(what: &str, error: &JsValue) {
    web_sys::console::error_2(&format!("MotorLink worker: {what}").into(), error);
}
