//! The web worker that owns the port and the bus.
//!
//! Everything that touches the motors happens here, away from the page: a hidden page's timers
//! crawl and a busy page is late, but a worker's loop goes on. What crosses to the page and back is
//! in `motorlink-messages`.
//!
//! | file | what it holds |
//! |---|---|
//! | `station` | the one owner: the session, the bus, and what is done with messages and events |
//! | `connecting` | opening, trying and reopening serial ports |
//! | `session` | the state of the port |
//! | `telling` | what the bus tells, passed on to the page |
//! | `line` | a serial port or the virtual bus: bytes out, bytes in |
//! | `serial` | Web Serial: open, read, write, close, and its errors |
//! | `outbox` | what goes to the page, at most once a frame |
//! | `alarm` | one wake-up at a precise moment |
//! | `scope` | the worker's global object: clock, messages |

mod alarm;
mod connecting;
mod line;
mod outbox;
mod scope;
mod serial;
mod session;
mod station;
mod telling;

use motorlink_messages::ToPage;

fn main() {
    std::panic::set_hook(Box::new(|panic| {
        console_error_panic_hook::hook(panic);
        // The loop ends here and frames cease: the wheel coasts. The page must not think otherwise.
        scope::post(&ToPage::Died);
    }));
    station::start();
}
