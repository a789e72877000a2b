//! The runs in the port worker: passes inputs to their program, and does what it returns.

use js_sys::{Function, Uint8Array};
use motorlink_bus::{Bus, BusSettings, Command, Event};
use motorlink_messages::{ToPage, decode, encode, runs::DIED};
use motorlink_protocol::Instant;
use motorlink_runs::{Host, Input, Output};
use wasm_bindgen::{JsCast, JsValue};

use crate::scope::{post, report};

/// A message of the page, and whether the person's act is too old to start something.
pub(crate) type Message = (Vec<u8>, bool);

/// The runs of experiments: the program, once it is loaded, and what it drives.
#[derive(Default)]
pub(crate) struct Runs {
    pub(crate) program: Loading,
    host: Host,
    /// When the port had taken the last frame.
    pub(crate) taken: Instant,
}

/// The program.
#[derive(Default)]
pub(crate) enum Loading {
    /// It is loaded with the first message.
    #[default]
    No,
    /// The messages wait for the program.
    Begun(Vec<Message>),
    /// It is called like this.
    Done(Function),
    /// It has failed. Its memory is in an unknown state, so it is not called again.
    Failed,
}

impl Runs {
    /// When the next tick is due.
    pub(crate) const fn wake(&self) -> Option<Instant> {
        self.host.wake()
    }

    /// The settings of the bus: see [`Host::settings`].
    pub(crate) fn settings(&self, of_person: BusSettings) -> BusSettings {
        self.host.settings(of_person)
    }

    /// Ticks if that is due.
    pub(crate) fn tick(&mut self, now: Instant, bus: &mut Bus, of_person: BusSettings) {
        if self.host.tick_due(now).is_some() {
            self.pass(now, Input::Tick, Some(bus), of_person);
        }
    }

    /// Passes on an event of the bus that concerns a run.
    pub(crate) fn event(
        &mut self,
        now: Instant,
        event: &Event,
        bus: &mut Bus,
        of_person: BusSettings,
    ) {
        if let Some(mut input) = self.host.input_of(event, bus.model()) {
            if let Input::Sent { at, .. } = &mut input {
                *at = self.taken;
            }
            self.pass(now, input, Some(bus), of_person);
        }
    }

    /// The port is gone: no run goes on.
    pub(crate) fn closed(&mut self, now: Instant, input: Input, of_person: BusSettings) {
        if self.wake().is_some() {
            self.pass(now, input, None, of_person);
        }
    }

    /// Stops the motors of the run before a person drives by hand. Returns the input for
    /// [`commanded`](Self::commanded), which follows when the bus has taken the command.
    pub(crate) fn before_command(
        &mut self,
        now: Instant,
        command: Command,
        bus: &mut Bus,
        of_person: BusSettings,
    ) -> Option<Input> {
        let input = self.host.ended_by(command)?;
        if let Input::Driven(_) = input {
            self.host.stop(now, Some(bus), of_person);
        }
        Some(input)
    }

    /// Passes an input to the program, if it is loaded.
    pub(crate) fn pass(
        &mut self,
        now: Instant,
        input: Input,
        bus: Option<&mut Bus>,
        of_person: BusSettings,
    ) {
        let Loading::Done(program) = &self.program else {
            return;
        };
        let call = |now, input: &Input| call(program, now, input);
        if self.host.pass(now, input, bus, of_person, call).is_err() {
            self.died();
        }
    }

    /// The program has failed: tells the page.
    pub(crate) fn died(&mut self) {
        self.program = Loading::Failed;
        post(&ToPage::Run(DIED.to_vec()));
    }
}

/// Calls the program. Returns nothing if it has failed.
#[allow(clippy::cast_precision_loss, reason = "microseconds fit for 285 years")]
fn call(program: &Function, now: Instant, input: &Input) -> Option<Output> {
    let input = encode(input).ok()?;
    let input = Uint8Array::from(input.as_slice());
    let now_us = JsValue::from(now.as_micros() as f64);
    let output = match program.call2(&JsValue::UNDEFINED, &input, &now_us) {
        Ok(output) => output.dyn_into::<Uint8Array>().ok()?,
        Err(error) => {
            report("the program of the runs has failed", &error);
            return None;
        }
    };
    decode(&output.to_vec()).ok()
}

#[cfg(test)]
mod tests {
    use js_sys::JsString;
    use motorlink_runs::Act;
    use wasm_bindgen::prelude::Closure;
    use wasm_bindgen_test::wasm_bindgen_test;

    use super::*;
    use crate::runs::program::handle;

    /// A function as the glue of the program exports it.
    fn function(of: impl Fn(Uint8Array, f64) -> Result<Uint8Array, JsValue> + 'static) -> Function {
        let closure = Closure::<dyn Fn(Uint8Array, f64) -> Result<Uint8Array, JsValue>>::new(of);
        closure.into_js_value().unchecked_into()
    }

    #[wasm_bindgen_test]
    fn an_input_reaches_the_program_and_its_output_comes_back() {
        let program = function(|input, now_us| {
            let output = handle(&input.to_vec(), now_us);
            Ok(Uint8Array::from(output.as_slice()))
        });
        let nothing = Output {
            act: Act::Nothing,
            wake: None,
        };
        let now = Instant::from_millis(5);
        assert_eq!(call(&program, now, &Input::Tick), Some(nothing));
    }

    #[wasm_bindgen_test]
    fn a_program_that_traps_or_returns_nonsense_has_failed() {
        let traps = function(|_, _| Err(JsString::from("unreachable").into()));
        assert_eq!(call(&traps, Instant::ZERO, &Input::Tick), None);
        let nonsense = function(|_, _| Ok(Uint8Array::new_with_length(0)));
        assert_eq!(call(&nonsense, Instant::ZERO, &Input::Tick), None);
    }
}
