//! The recorder in the browser: messages of the page, line events of the other worker, and turns that are
//! short enough for both.

mod disk;
mod found;
mod session_requests;
mod state;
mod store;

use std::{cell::RefCell, rc::Rc, time::Duration};

use js_sys::{ArrayBuffer, Uint8Array};
use motorlink_messages::{
    decode, encode,
    recorder::{FromRecorder, ToRecorder, traffic},
};
use motorlink_recorder::{Output, Recorder, WallClock};
use wasm_bindgen::{JsCast, JsValue, prelude::Closure};
use web_sys::{MessageEvent, MessagePort};

use self::{
    state::{RecorderWorker, Saving, Shared, post},
    store::Job,
};
use crate::{
    blob_parts::{CSV, Parts},
    local_time::local_time,
    recorder_request::RecorderRequest,
    scope::{self, Clock, Incoming, report},
    turn_scheduler::TurnScheduler,
};

/// A turn ends after this time, so that messages and line events are received.
const TURN: Duration = Duration::from_millis(8);
/// Entries between two readings of the clock: half a millisecond of work, two on a slow machine.
const STEP: u64 = 500;
/// Entries and samples in one answer to the session worker: a millisecond of work, five on a slow machine.
const KEPT_STEP: u64 = 2_000;
/// Summer time begins and ends on the minute.
const UTC_OFFSET_PERIOD: Duration = Duration::from_secs(60);

/// Starts the worker.
pub(crate) fn start() {
    let clock = Clock::new();
    let now = clock.now();
    let own_clock = WallClock::new(clock.origin_ms(), 0).with_local_time(local_time(i64::MAX));
    let shared: Shared = Rc::new_cyclic(|worker| {
        let worker = worker.clone();
        let scheduler = TurnScheduler::new(move || {
            if let Some(shared) = worker.upgrade() {
                turn(&shared);
            }
        });
        RefCell::new(RecorderWorker {
            clock,
            recorder: Recorder::new(own_clock).saving(),
            parts: Parts::default(),
            scheduler,
            saving: Saving::default(),
            turn,
            utc_offset_asked: now,
        })
    });
    session_requests::begin(&shared);
    scope::on_message(move |incoming| match incoming {
        Incoming::Message(bytes) => match decode::<ToRecorder>(&bytes) {
            Ok(message) => {
                session_requests::handle(&shared, &message);
                shared.borrow_mut().recorder.handle(message);
                turn(&shared);
            }
            Err(error) => {
                let error = error.to_string().into();
                report(
                    "the page sent the recorder a message of another build",
                    &error,
                );
            }
        },
        Incoming::TrafficPort(port) => receive_traffic(&shared, &port),
    });
}

/// Tells the page that the recorder has failed.
pub(crate) fn died() {
    post(&FromRecorder::Died);
}

/// Posts a file to the page, or reports that there is none if the browser has no room for it.
fn post_file(parts: &mut Parts, message: &FromRecorder) {
    let encoded = encode(message).map_err(|error| error.to_string().into());
    if let Err(error) = encoded.and_then(|bytes| parts.post_as_file(&bytes, CSV)) {
        report("a file could not be posted to the page", &error);
        if let FromRecorder::Exported { what, .. } = *message {
            let cancelled = false;
            post(&FromRecorder::NotExported { what, cancelled });
        }
    }
}

/// Receives the line events on this port, or requests of the session worker, until the worker ends.
fn receive_traffic(shared: &Shared, port: &MessagePort) {
    let shared = Rc::clone(shared);
    let answers = port.clone();
    let handler = Closure::<dyn FnMut(MessageEvent)>::new(move |event: MessageEvent| {
        // The page asks before it opens the dialog for a file.
        if event.data().is_null() {
            let reason = shared.borrow().recorder.not_kept();
            return answer(&answers, encode(&reason).map_err(|error| error.to_string()));
        }
        if let Some(request) = RecorderRequest::of(&event.data()) {
            let recorder = &mut shared.borrow_mut().recorder;
            let kept = match request {
                RecorderRequest::First(range) => recorder.first_kept(range, KEPT_STEP),
                RecorderRequest::Next => recorder.next_kept(KEPT_STEP),
            };
            return answer(&answers, encode(&kept).map_err(|error| error.to_string()));
        }
        let bytes = Uint8Array::new(&event.data()).to_vec();
        {
            let recorder = &mut shared.borrow_mut().recorder;
            if event.data().is_instance_of::<ArrayBuffer>() {
                recorder.add_state(bytes);
            } else {
                traffic(&bytes).for_each(|traffic| recorder.add_event(&traffic));
            }
        }
        turn(&shared);
    });
    port.set_onmessage(Some(handler.as_ref().unchecked_ref()));
    handler.forget();
}

/// Answers the session worker or the page.
fn answer(port: &MessagePort, encoded: Result<Vec<u8>, String>) {
    let bytes = encoded.map_err(JsValue::from);
    let posted = bytes.and_then(|bytes| port.post_message(&Uint8Array::from(bytes.as_slice())));
    if let Err(error) = posted {
        report("a request for what is kept got no answer", &error);
    }
}

/// Does as much as fits into one turn, and schedules another for the rest.
fn turn(shared: &Shared) {
    let mut worker = shared.borrow_mut();
    let RecorderWorker {
        clock,
        recorder,
        parts,
        scheduler,
        saving,
        utc_offset_asked,
        ..
    } = &mut *worker;
    let began = clock.now();
    if began.since(*utc_offset_asked) > UTC_OFFSET_PERIOD {
        *utc_offset_asked = began;
        let from_ms = recorder.begins_ms().unwrap_or(i64::MAX);
        recorder.set_local_time(local_time(from_ms));
    }
    loop {
        let now = clock.now();
        match recorder.poll(now) {
            Output::Post(message) => post(&message),
            Output::Part(bytes) => {
                if let Err(error) = parts.push(&bytes) {
                    // The file is not posted when it is complete.
                    report("a part of a file could not be stored", &error);
                }
            }
            Output::File(message) => post_file(parts, &message),
            Output::NoFile(message) => {
                parts.clear();
                post(&message);
            }
            Output::Store(action) => saving.add(shared, Job::Action(action)),
            Output::NextFile => saving.read_next(shared),
            Output::Work if now.since(began) < TURN => recorder.work(now, STEP),
            Output::Work => return scheduler.soon(),
            Output::Wait(None) => return,
            Output::Wait(Some(at)) => return scheduler.after(at.since(now)),
        }
    }
}
