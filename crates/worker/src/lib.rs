//! The web workers: the one that owns the port and the bus, the recorder, and the one for session files.
//!
//! The first one controls the motors, not the page: browsers slow down the timers of a hidden page, and
//! a busy page is late, but a worker's loop is not affected. The recorder keeps the packet log and the
//! recording in a second worker, so that slow work there delays neither frames nor the screen. A third one
//! writes, reads and replays session files; it is started when it is used. The runs of experiments are a program that the
//! first one loads into its own thread. Recorder, session worker and runs are instances of one program, `tasks`
//! (`src/bin/tasks/`), each with its own memory. The messages between the page and the workers are in `motorlink-messages`.
//!
//! | file | what it holds |
//! |---|---|
//! | `port_owner` | the state of the port worker: the port, the bus, and what happens to commands and events |
//! | `connecting` | opening, trying and reopening serial ports |
//! | `claim` | claims an adapter for this tab |
//! | `memory` | remembers what is driven beyond the end of the worker |
//! | `mock_serial` | serial ports for tests, with virtual motors |
//! | `asks_again` | repeats the ID query while nothing answers |
//! | `left` | motors that were left driven on adapters that are not open |
//! | `line_errors` | counts errors of the line |
//! | `port_state` | the state of the port |
//! | `forwarding` | forwards the events of the bus to the page |
//! | `line` | a serial port or the virtual bus: bytes out, bytes in |
//! | `serial` | Web Serial: open, read, write, close, and its errors |
//! | `recorder_request` | requests of the session worker to the recorder |
//! | `traffic` | line events on their way to the recorder |
//! | `alarm` | a precise timer |
//! | `scope` | the worker's global object: clock, messages |
//! | `runs` | the runs of experiments: an instance of the program `tasks`, which the port worker loads and calls |
//! | `recorder` | the second worker: `motorlink-recorder` in the browser |
//! | `sessions` | the third worker: `motorlink-session` in the browser |
//! | `remote` | the worker of a page that comes from a server: it connects page and server |
//! | `page_clock` | the clock of the page, as a worker knows it |
//! | `turn_scheduler` | the turns of a worker with much to do |
//! | `local_time` | the local time of the browser |
//! | `blob_parts` | files that are written part by part |

mod alarm;
mod asks_again;
mod blob_parts;
mod claim;
mod connecting;
mod driven_file;
mod forwarding;
mod left;
mod line;
mod line_errors;
mod local_time;
#[cfg(test)]
mod mock_serial;
mod page_clock;
mod port_owner;
mod port_state;
mod recorder;
mod recorder_request;
mod remote;
mod runs;
mod scope;
mod serial;
mod sessions;
mod start;
mod traffic;
mod turn_scheduler;

use motorlink_messages::ToPage;

/// Starts the worker that owns the port. Called in the scope of a dedicated worker.
pub fn start_worker() {
    // The loop has ended: no frame is sent any more, and a wheel may turn on. The page starts another worker that stops it.
    on_panic(|| scope::post(&ToPage::Died));
    start::start();
}

/// Starts the recorder. Called in the scope of a dedicated worker.
pub fn start_recorder() {
    on_panic(recorder::died);
    recorder::start();
}

/// Starts the session worker. Called in the scope of a dedicated worker.
pub fn start_sessions() {
    on_panic(sessions::died);
    sessions::start();
}

/// Starts the worker that connects the page to the server that it comes from. Called in the scope of a dedicated worker.
pub fn start_remote() {
    on_panic(|| scope::post(&ToPage::Died));
    remote::start();
}

/// Handles an input of the port worker in the program of the runs: see `runs`.
#[must_use]
pub fn run_program(input: &[u8], now_us: f64) -> Vec<u8> {
    runs::program::handle(input, now_us)
}

fn on_panic(report: impl Fn() + Send + Sync + 'static) {
    std::panic::set_hook(Box::new(move |panic| {
        console_error_panic_hook::hook(panic);
        report();
    }));
}
