//! The recorder in the browser: messages, the line from the other worker, and turns that end early enough
//! for both.

mod again;
mod disk;
mod files;
mod found;
mod keeping;
mod state;
mod store;

use std::{cell::RefCell, rc::Rc, time::Duration};

use js_sys::Uint8Array;
use motorlink_messages::{
    decode, encode,
    recorder::{FromRecorder, ToRecorder, traffic},
};
use motorlink_recorder::{Output, Recorder, WallClock};
use wasm_bindgen::{JsCast, prelude::Closure};
use web_sys::{MessageEvent, MessagePort};

use self::{
    again::Again,
    files::Parts,
    state::{Keeping, RecorderWorker, Shared, local_time, tell},
    store::Job,
};
use crate::scope::{self, Arrived, Clock, report};

/// A turn ends after this long, so that messages and traffic are taken in.
const TURN: Duration = Duration::from_millis(8);
/// Entries between two looks at the clock: half a millisecond, on a slow machine two.
const STEP: u64 = 500;
/// Summer time begins and ends on the minute.
const UTC_OFFSET_PERIOD: Duration = Duration::from_secs(60);

/// Starts the worker.
pub(crate) fn start() {
    let clock = Clock::new();
    let now = clock.now();
    let own_clock = WallClock::new(clock.origin_ms(), 0).with_local_time(local_time(i64::MAX));
    let shared: Shared = Rc::new_cyclic(|worker| {
        let worker = worker.clone();
        let again = Again::new(move || {
            if let Some(shared) = worker.upgrade() {
                turn(&shared);
            }
        });
        RefCell::new(RecorderWorker {
            clock,
            recorder: Recorder::new(own_clock).keeping(),
            parts: Parts::default(),
            again,
            keeping: Keeping::default(),
            turn,
            utc_offset_asked: now,
        })
    });
    keeping::begin(&shared);
    scope::on_message(move |arrived| match arrived {
        Arrived::Message(bytes) => match decode::<ToRecorder>(&bytes) {
            Ok(message) => {
                keeping::handle(&shared, &message);
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
        Arrived::Line(port) => listen(&shared, &port),
    });
}

/// The page is told that nothing comes any more.
pub(crate) fn died() {
    tell(&FromRecorder::Died);
}

/// Gives the page a file. Where the browser has no room for it, there is none.
fn post_file(parts: &mut Parts, message: &FromRecorder) {
    let encoded = encode(message).map_err(|error| error.to_string().into());
    if let Err(error) = encoded.and_then(|bytes| parts.post_as_file(&bytes)) {
        report("a file could not be posted to the page", &error);
        if let FromRecorder::Exported { what, .. } = *message {
            let cancelled = false;
            tell(&FromRecorder::NotExported { what, cancelled });
        }
    }
}

/// Takes in the traffic that comes on this line, for as long as the worker lives.
fn listen(shared: &Shared, port: &MessagePort) {
    let shared = Rc::clone(shared);
    let handler = Closure::<dyn FnMut(MessageEvent)>::new(move |event: MessageEvent| {
        let bytes = Uint8Array::new(&event.data()).to_vec();
        {
            let recorder = &mut shared.borrow_mut().recorder;
            traffic(&bytes).for_each(|traffic| recorder.passed(&traffic));
        }
        turn(&shared);
    });
    port.set_onmessage(Some(handler.as_ref().unchecked_ref()));
    handler.forget();
}

/// Does what is to be done, as far as a turn goes, and sees to it that the rest is done.
fn turn(shared: &Shared) {
    let mut worker = shared.borrow_mut();
    let RecorderWorker {
        clock,
        recorder,
        parts,
        again,
        keeping,
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
            Output::Tell(message) => tell(&message),
            Output::Part(bytes) => parts.push(&bytes),
            Output::File(message) => post_file(parts, &message),
            Output::NoFile(message) => {
                parts.clear();
                tell(&message);
            }
            Output::Keep(act) => keeping.add(shared, Job::Act(act)),
            Output::NextKept => keeping.read_next(shared),
            Output::Work if now.since(began) < TURN => recorder.work(now, STEP),
            Output::Work => return again.soon(),
            Output::Wait(None) => return,
            Output::Wait(Some(at)) => return again.after(at.since(now)),
        }
    }
}
