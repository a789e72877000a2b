//! Line events and states on their way to the recorder.
//!
//! They do not pass through the page: a message channel connects the two workers.

use std::{collections::VecDeque, time::Duration};

use js_sys::{Array, Uint8Array};
use motorlink_bus::LineEvent;
use motorlink_messages::recorder::push_traffic;
use motorlink_protocol::Instant;
use wasm_bindgen::JsValue;
use web_sys::MessagePort;

use crate::scope::report;

/// A log that is 50 ms old looks like one of now, and 20 messages a second cost nothing. States go when the page gets them.
const PERIOD: Duration = Duration::from_millis(50);

/// Entries that wait until the recorder has started: 20 s of a busy line, in half a megabyte. Beyond
/// that the oldest are dropped.
const WAITING_MAX: usize = 20_000;

/// Line events that have not been posted to the recorder yet.
#[derive(Debug, Default)]
pub(crate) struct TrafficQueue {
    port: Option<MessagePort>,
    waiting: VecDeque<LineEvent>,
    last_sent: Instant,
}

impl TrafficQueue {
    /// Sets the port to the recorder. Waiting entries become due at once.
    pub(crate) fn connect(&mut self, port: MessagePort) {
        self.port = Some(port);
        self.send_soon();
    }

    pub(crate) fn push(&mut self, traffic: LineEvent) {
        if self.waiting.len() >= WAITING_MAX {
            self.waiting.pop_front();
        }
        self.waiting.push_back(traffic);
    }

    /// When the waiting entries are due; `None` if there are none, or no recorder.
    pub(crate) fn due(&self) -> Option<Instant> {
        let is_due = self.port.is_some() && !self.waiting.is_empty();
        is_due.then(|| self.last_sent + PERIOD)
    }

    /// Makes the waiting entries due at once.
    pub(crate) const fn send_soon(&mut self) {
        self.last_sent = Instant::ZERO;
    }

    /// Posts all waiting entries as one transferred buffer.
    pub(crate) fn send(&mut self, now: Instant) {
        let Some(port) = &self.port else { return };
        let mut buffer = Vec::new();
        for traffic in self.waiting.drain(..) {
            push_traffic(&mut buffer, &traffic);
        }
        send_encoded(port, &buffer);
        self.last_sent = now;
    }

    /// Posts the bytes of an update to the page: what it shows from now on. It is a buffer, not an array as line events
    /// are. Before the recorder has started it is lost.
    pub(crate) fn send_state(&self, update: &[u8]) {
        if let Some(port) = &self.port {
            send_state(port, update);
        }
    }
}

/// Posts line events to the recorder, encoded.
pub(crate) fn send_encoded(port: &MessagePort, events: &[u8]) {
    let array = Uint8Array::from(events);
    post(port, &array, &array);
}

/// Posts the bytes of an update to the recorder.
pub(crate) fn send_state(port: &MessagePort, update: &[u8]) {
    let array = Uint8Array::from(update);
    post(port, &array.buffer(), &array);
}

/// Posts a message, and transfers the buffer of this array.
fn post(port: &MessagePort, message: &JsValue, array: &Uint8Array) {
    let transfer = Array::of1(&array.buffer());
    if let Err(error) = port.post_message_with_transferable(message, &transfer) {
        report("traffic could not be posted to the recorder", &error);
    }
}

#[cfg(test)]
mod tests {
    use std::{cell::RefCell, rc::Rc};

    use gloo_timers::future::sleep;
    use motorlink_bus::{JunkBytes, LineEventKind};
    use motorlink_messages::recorder;
    use motorlink_protocol::{Mode, MotorId, Request};
    use wasm_bindgen::{JsCast, prelude::Closure};
    use wasm_bindgen_test::wasm_bindgen_test;
    use web_sys::{MessageChannel, MessageEvent};

    use super::*;

    fn traffic(n: u64) -> LineEvent {
        let id = MotorId::FIRST;
        let kind = match n % 3 {
            0 => LineEventKind::Sent {
                frame: Request::Query { id }.frame(),
                mode: Some(Mode::Position),
            },
            1 => LineEventKind::Junk(JunkBytes::new(&[1, 2, 3])),
            _ => LineEventKind::Silence {
                id,
                waited_us: 8_000,
            },
        };
        LineEvent {
            at: Instant::from_micros(n * 1_234),
            kind,
        }
    }

    #[wasm_bindgen_test]
    async fn entries_arrive_in_order_and_a_full_queue_drops_the_oldest() {
        let received: Rc<RefCell<Vec<Vec<LineEvent>>>> = Rc::default();
        let channel = MessageChannel::new().unwrap();
        let on_batch = Rc::clone(&received);
        let on_message = Closure::<dyn FnMut(MessageEvent)>::new(move |event: MessageEvent| {
            let bytes = event.data().unchecked_into::<Uint8Array>().to_vec();
            let batch = recorder::traffic(&bytes).collect();
            on_batch.borrow_mut().push(batch);
        });
        channel
            .port2()
            .set_onmessage(Some(on_message.as_ref().unchecked_ref()));

        let mut queue = TrafficQueue::default();
        for n in 0..20_010 {
            queue.push(traffic(n));
        }
        assert_eq!(queue.due(), None, "no recorder");
        queue.connect(channel.port1());
        let now = Instant::from_millis(1_000);
        assert!(queue.due().is_some_and(|due| due <= now));
        queue.send(now);
        assert_eq!(queue.due(), None, "nothing waits");
        queue.push(traffic(7));
        assert_eq!(queue.due(), Some(now + PERIOD));
        queue.send_soon();
        assert!(queue.due().is_some_and(|due| due <= now));
        queue.send(now);

        sleep(Duration::from_millis(200)).await;
        let expected: Vec<_> = (10..20_010).map(traffic).collect();
        assert_eq!(*received.borrow(), [expected, vec![traffic(7)]]);
    }
}
