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
    /// One for all copies: who sees a sleep first sees it for all.
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

    /// Now, in microseconds since the worker's time origin. Steps of 0.1 ms, as browsers have it.
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

    /// When the clock was zero, in milliseconds of the time that page and worker share.
    pub(crate) fn origin_ms(&self) -> f64 {
        self.performance
            .as_ref()
            .map_or(0.0, Performance::time_origin)
    }
}

/// Posts a message to the page.
pub(crate) fn post(message: &ToPage) {
    match encode(message) {
        Ok(bytes) => post_bytes(&bytes),
        Err(error) => report("a message could not be encoded", &error.to_string().into()),
    }
}

/// Posts bytes to the page as one buffer that changes hands.
pub(crate) fn post_bytes(bytes: &[u8]) {
    let array = Uint8Array::from(bytes);
    let transfer = Array::of1(&array.buffer());
    if let Err(error) = global().post_message_with_transfer(&array, &transfer) {
        report("a message could not be posted to the page", &error);
    }
}

/// What the page sends.
pub(crate) enum Arrived {
    /// A message of ours.
    Message(Vec<u8>),
    /// An end of the line between the two workers, on which the traffic goes to the recorder.
    Line(MessagePort),
}

/// Hands everything that the page sends to `handle`, for as long as the worker lives.
pub(crate) fn on_message(mut handle: impl FnMut(Arrived) + 'static) {
    let handler = Closure::<dyn FnMut(MessageEvent)>::new(move |event: MessageEvent| {
        let other = match event.data().dyn_into::<Uint8Array>() {
            Ok(bytes) => return handle(Arrived::Message(bytes.to_vec())),
            Err(other) => other,
        };
        match other.dyn_into::<MessagePort>() {
            Ok(port) => handle(Arrived::Line(port)),
            Err(other) => report("the page sent what is neither bytes nor a port", &other),
        }
    });
    global().set_onmessage(Some(handler.as_ref().unchecked_ref()));
    handler.forget();
}

/// Tells the console of something that is our own fault. What a user can act on goes to the page.
pub(crate) fn report(what: &str, error: &JsValue) {
    web_sys::console::error_2(&format!("MotorLink worker: {what}").into(), error);
}
