//! What passed on the line, on its way to the recorder.
//!
//! It does not go through the page, which has enough to do: the two workers share a line.

use std::{collections::VecDeque, time::Duration};

use js_sys::{Array, Uint8Array};
use motorlink_bus::LineEvent;
use motorlink_messages::recorder::push_traffic;
use motorlink_protocol::Instant;
use web_sys::MessagePort;

use crate::scope::report;

/// A log that is 50 ms old looks like one of now, and 20 messages a second cost nothing.
const PERIOD: Duration = Duration::from_millis(50);

/// Entries that wait for a recorder that has not begun yet: 20 s of a full line, in half a megabyte. The
/// oldest give way.
const WAITING_MAX: usize = 20_000;

#[derive(Debug, Default)]
pub(crate) struct TrafficTape {
    port: Option<MessagePort>,
    waiting: VecDeque<LineEvent>,
    last_sent: Instant,
}

impl TrafficTape {
    /// Takes the line to the recorder. What has waited goes at once.
    pub(crate) fn connect(&mut self, port: MessagePort) {
        self.port = Some(port);
        self.hurry();
    }

    pub(crate) fn push(&mut self, traffic: LineEvent) {
        if self.waiting.len() >= WAITING_MAX {
            self.waiting.pop_front();
        }
        self.waiting.push_back(traffic);
    }

    /// When there is something to send next.
    pub(crate) fn due(&self) -> Option<Instant> {
        let is_due = self.port.is_some() && !self.waiting.is_empty();
        is_due.then(|| self.last_sent + PERIOD)
    }

    /// Makes what waits due at once.
    pub(crate) const fn hurry(&mut self) {
        self.last_sent = Instant::ZERO;
    }

    /// Posts everything that waits as one buffer that changes hands.
    pub(crate) fn send(&mut self, now: Instant) {
        let Some(port) = &self.port else { return };
        let mut buffer = Vec::new();
        for traffic in self.waiting.drain(..) {
            push_traffic(&mut buffer, &traffic);
        }
        let array = Uint8Array::from(buffer.as_slice());
        let transfer = Array::of1(&array.buffer());
        if let Err(error) = port.post_message_with_transferable(&array, &transfer) {
            report("traffic could not be posted to the recorder", &error);
        }
        self.last_sent = now;
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
        let passed = match n % 3 {
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
            kind: passed,
        }
    }

    #[wasm_bindgen_test]
    async fn what_was_pushed_arrives_in_order_and_what_was_too_much_is_the_oldest() {
        let heard: Rc<RefCell<Vec<Vec<LineEvent>>>> = Rc::default();
        let channel = MessageChannel::new().unwrap();
        let hear = Rc::clone(&heard);
        let on_message = Closure::<dyn FnMut(MessageEvent)>::new(move |event: MessageEvent| {
            let bytes = event.data().unchecked_into::<Uint8Array>().to_vec();
            hear.borrow_mut().push(recorder::traffic(&bytes).collect());
        });
        channel
            .port2()
            .set_onmessage(Some(on_message.as_ref().unchecked_ref()));

        let mut tape = TrafficTape::default();
        for n in 0..20_010 {
            tape.push(traffic(n));
        }
        assert_eq!(tape.due(), None, "nobody is there");
        tape.connect(channel.port1());
        let now = Instant::from_millis(1_000);
        assert!(tape.due().is_some_and(|due| due <= now));
        tape.send(now);
        assert_eq!(tape.due(), None, "nothing waits");
        tape.push(traffic(7));
        assert_eq!(tape.due(), Some(now + PERIOD));
        tape.hurry();
        assert!(tape.due().is_some_and(|due| due <= now));
        tape.send(now);

        sleep(Duration::from_millis(200)).await;
        let expected: Vec<_> = (10..20_010).map(traffic).collect();
        assert_eq!(*heard.borrow(), [expected, vec![traffic(7)]]);
    }
}
