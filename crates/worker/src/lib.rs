//! The web workers: the one that owns the port and the bus, and the recorder.
//!
//! Everything that touches the motors happens in the first, away from the page: a hidden page's timers
//! crawl and a busy page is late, but a worker's loop goes on. The recorder keeps the packet log and the
//! recording, away from both: what takes long there delays no frame and no screen. Each is a program of
//! its own (`src/bin/`), so that a visit loads the page first. What crosses to the page and back is in
//! `motorlink-messages`.
//!
//! | file | what it holds |
//! |---|---|
//! | `station` | the one owner: the session, the bus, and what is done with messages and events |
//! | `connecting` | opening, trying and reopening serial ports |
//! | `claim` | which adapters are this tab's and no other's |
//! | `session` | the state of the port |
//! | `telling` | what the bus tells, passed on to the page |
//! | `line` | a serial port or the virtual bus: bytes out, bytes in |
//! | `serial` | Web Serial: open, read, write, close, and its errors |
//! | `outbox` | what goes to the page, at most once a frame |
//! | `traffic` | what passed on the line, on its way to the recorder |
//! | `alarm` | one wake-up at a precise moment |
//! | `scope` | the worker's global object: clock, messages |
//! | `recorder` | the other worker: `motorlink-recorder` in the browser |

mod alarm;
mod claim;
mod connecting;
mod line;
mod outbox;
mod recorder;
mod scope;
mod serial;
mod session;
mod start;
mod station;
mod telling;
mod traffic;

use motorlink_messages::ToPage;

/// Starts the worker that owns the port. Called in the scope of a dedicated worker.
pub fn start_worker() {
    // The loop ends here and frames cease: the wheel coasts. The page must not think otherwise.
    on_panic(|| scope::post(&ToPage::Died));
    start::start();
}

/// Starts the recorder. Called in the scope of a dedicated worker.
pub fn start_recorder() {
    on_panic(recorder::died);
    recorder::start();
}

fn on_panic(tell: impl Fn() + Send + Sync + 'static) {
    std::panic::set_hook(Box::new(move |panic| {
        console_error_panic_hook::hook(panic);
        tell();
    }));
}
