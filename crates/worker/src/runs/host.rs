//! The program of the runs: passes inputs to it, once it is loaded.

use js_sys::{Function, Uint8Array};
use motorlink_messages::{ToPage, decode, encode, runs::DIED};
use motorlink_protocol::Instant;
use motorlink_runs::{Decides, Input, Output};
use wasm_bindgen::{JsCast, JsValue};

use crate::scope::{post, report};

/// A message of the page, and whether the person's act is too old to start something.
pub(crate) type Message = (Vec<u8>, bool);

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

impl Decides for Loading {
    fn is_there(&self) -> bool {
        matches!(self, Self::Done(_))
    }

    fn decide(&mut self, now: Instant, input: &Input) -> Option<Output> {
        match self {
            Self::Done(program) => call(program, now, input),
            Self::No | Self::Begun(_) | Self::Failed => None,
        }
    }

    /// Tells the page.
    fn has_failed(&mut self) {
        *self = Self::Failed;
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
