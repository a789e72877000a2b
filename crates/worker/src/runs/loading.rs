//! Loads the program of the runs with the first message to it.

use std::rc::Rc;

use js_sys::{Function, Promise, Reflect};
use motorlink_runs::Decides as _;
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::{JsFuture, spawn_local};

use crate::{
    connecting::pump,
    port_owner::Shared,
    runs::host::{Loading, Message},
    scope::{global, report},
};

/// Passes a message of the page to the program. The first one loads it.
pub(crate) fn run_message(shared: &Shared, message: Message) {
    let mut owner = shared.borrow_mut();
    match &mut owner.control.runs.program {
        Loading::Done(_) => owner.run_message(message),
        Loading::Begun(waiting) => waiting.push(message),
        Loading::Failed => owner.control.runs.program.has_failed(),
        program @ Loading::No => {
            *program = Loading::Begun(vec![message]);
            let shared = Rc::clone(shared);
            spawn_local(async move {
                let loaded = load().await;
                loading_ended(&shared, loaded);
                pump(&shared);
            });
        }
    }
}

fn loading_ended(shared: &Shared, loaded: Result<Function, JsValue>) {
    let mut owner = shared.borrow_mut();
    match loaded {
        Ok(program) => {
            let before = std::mem::replace(&mut owner.control.runs.program, Loading::Done(program));
            if let Loading::Begun(waiting) = before {
                for message in waiting {
                    owner.run_message(message);
                }
            }
        }
        Err(error) => {
            report("the program of the runs could not be loaded", &error);
            owner.control.runs.program.has_failed();
            // The network may be back when the person tries again.
            owner.control.runs.program = Loading::No;
        }
    }
}

/// Calls `loadRuns` of the script that starts the worker.
async fn load() -> Result<Function, JsValue> {
    let load: Function = Reflect::get(&global(), &"loadRuns".into())?.dyn_into()?;
    let loading: Promise = load.call0(&JsValue::UNDEFINED)?.dyn_into()?;
    JsFuture::from(loading).await?.dyn_into()
}
