//! Schedules the next turn: at once, but after the messages that have arrived, or after a delay.

use std::{cell::Cell, rc::Rc, time::Duration};

use gloo_timers::callback::Timeout;
use wasm_bindgen::{JsCast, JsValue, prelude::Closure};
use web_sys::{MessageChannel, MessagePort};

use crate::scope::report;

pub(crate) struct TurnScheduler {
    turn: Rc<dyn Fn()>,
    /// A channel to this worker. Unlike a timeout, which takes at least 4 ms, a message arrives at once and
    /// in order with the other messages.
    own_port: Option<MessagePort>,
    is_scheduled: Rc<Cell<bool>>,
    timeout: Option<Timeout>,
}

impl TurnScheduler {
    pub(crate) fn new(turn: impl Fn() + 'static) -> Self {
        let turn: Rc<dyn Fn()> = Rc::new(turn);
        let is_scheduled: Rc<Cell<bool>> = Rc::default();
        let own_port = MessageChannel::new().map(|channel| {
            let (turn, is_scheduled) = (Rc::clone(&turn), Rc::clone(&is_scheduled));
            let handler = Closure::<dyn FnMut()>::new(move || {
                is_scheduled.set(false);
                turn();
            });
            let handler = handler.into_js_value();
            channel.port2().set_onmessage(Some(handler.unchecked_ref()));
            channel.port1()
        });
        Self {
            turn,
            own_port: own_port.ok(),
            is_scheduled,
            timeout: None,
        }
    }

    /// Schedules a turn after the messages that have arrived.
    pub(crate) fn soon(&mut self) {
        if self.is_scheduled.replace(true) {
            return;
        }
        if let Some(port) = &self.own_port {
            if let Err(error) = port.post_message(&JsValue::UNDEFINED) {
                report("a worker could not schedule its next turn", &error);
            }
        } else {
            self.is_scheduled.set(false);
            self.after(Duration::ZERO);
        }
    }

    /// Schedules a turn after this delay, instead of any earlier delayed one.
    pub(crate) fn after(&mut self, delay: Duration) {
        // Rounded up: a turn that is too early would only schedule another one.
        let millis = delay.as_micros().div_ceil(1000);
        let turn = Rc::clone(&self.turn);
        let timeout = Timeout::new(u32::try_from(millis).unwrap_or(u32::MAX), move || turn());
        self.timeout = Some(timeout);
    }
}

#[cfg(test)]
mod tests {
    use gloo_timers::future::sleep;
    use wasm_bindgen_test::wasm_bindgen_test;

    use super::*;

    #[wasm_bindgen_test]
    async fn a_turn_runs_once_however_often_it_is_scheduled() {
        let turns = Rc::new(Cell::new(0));
        let count = Rc::clone(&turns);
        let mut scheduler = TurnScheduler::new(move || count.set(count.get() + 1));
        scheduler.soon();
        scheduler.soon();
        assert_eq!(turns.get(), 0, "not within the call");
        sleep(Duration::from_millis(200)).await;
        assert_eq!(turns.get(), 1);
        scheduler.after(Duration::from_secs(60));
        scheduler.after(Duration::from_millis(10));
        scheduler.soon();
        sleep(Duration::from_millis(400)).await;
        assert_eq!(turns.get(), 3);
    }
}
