//! Another turn: at once, but behind what has come meanwhile, or after a while.

use std::{cell::Cell, rc::Rc, time::Duration};

use gloo_timers::callback::Timeout;
use wasm_bindgen::{JsCast, JsValue, prelude::Closure};
use web_sys::{MessageChannel, MessagePort};

use crate::scope::report;

pub(super) struct Again {
    turn: Rc<dyn Fn()>,
    /// A message to ourselves: unlike a timeout, which is held back for 4 ms, it comes at once, and in
    /// its order among messages of others.
    to_ourselves: Option<MessagePort>,
    is_coming: Rc<Cell<bool>>,
    timeout: Option<Timeout>,
}

impl Again {
    pub(super) fn new(turn: impl Fn() + 'static) -> Self {
        let turn: Rc<dyn Fn()> = Rc::new(turn);
        let is_coming: Rc<Cell<bool>> = Rc::default();
        let to_ourselves = MessageChannel::new().map(|channel| {
            let (turn, is_coming) = (Rc::clone(&turn), Rc::clone(&is_coming));
            let handler = Closure::<dyn FnMut()>::new(move || {
                is_coming.set(false);
                turn();
            });
            let handler = handler.into_js_value();
            channel.port2().set_onmessage(Some(handler.unchecked_ref()));
            channel.port1()
        });
        Self {
            turn,
            to_ourselves: to_ourselves.ok(),
            is_coming,
            timeout: None,
        }
    }

    /// One turn more, as soon as what has come is taken in.
    pub(super) fn soon(&mut self) {
        if self.is_coming.replace(true) {
            return;
        }
        if let Some(port) = &self.to_ourselves {
            if let Err(error) = port.post_message(&JsValue::UNDEFINED) {
                report("the recorder could not go on", &error);
            }
        } else {
            self.is_coming.set(false);
            self.after(Duration::ZERO);
        }
    }

    /// One turn after this long, instead of the one that was asked for before.
    pub(super) fn after(&mut self, delay: Duration) {
        // Rounded up: a turn that comes too early asks for another.
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
    async fn turns_come_once_however_often_they_are_asked_for() {
        let turns = Rc::new(Cell::new(0));
        let count = Rc::clone(&turns);
        let mut again = Again::new(move || count.set(count.get() + 1));
        again.soon();
        again.soon();
        assert_eq!(turns.get(), 0, "not within the call");
        sleep(Duration::from_millis(200)).await;
        assert_eq!(turns.get(), 1);
        again.after(Duration::from_secs(60));
        again.after(Duration::from_millis(10));
        again.soon();
        sleep(Duration::from_millis(400)).await;
        assert_eq!(turns.get(), 3);
    }
}
