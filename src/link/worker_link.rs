//! The link to the port worker.

use std::{cell::Cell, rc::Rc};

use js_sys::Uint8Array;
use leptos::logging;
use motorlink_messages::{ToPage, ToWorker, decode, encode};
use web_sys::{MessagePort, Worker};

use crate::{
    link::started_worker::{NoWorker, Role, StartedWorker, post},
    ui::clock::page_now_ms,
};

/// The state of the worker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum WorkerState {
    /// Its code is being loaded.
    Starting,
    /// It has sent its first message.
    Running,
    /// It could not be started, or it has failed.
    Dead,
}

/// A worker with an open port pings four times a second. After this number of checks without a ping, a third of a second
/// apart, it counts as failed: a machine that stalls that long must not drive motors. A worker that has ended is noticed at
/// once (`rescue`); this is for one that runs for ever.
///
/// Checks count, not time: a page that hung gets one check, and then the pings that arrived meanwhile. The timers of a
/// hidden page fire once a second at most, so it takes longer there.
pub(crate) const SILENT_LOOKS_MAX: u32 = 9;
/// The same while a real wheel may turn: four pings are missing, and twice the delay after which the bus itself stops all
/// motors.
pub(crate) const SILENT_LOOKS_MAX_TURNING: u32 = 3;

/// The page's end of the link to its worker.
pub(crate) struct WorkerLink {
    worker: StartedWorker,
    pings: Rc<Pings>,
}

/// Number of checks since the last ping, if there was one.
#[derive(Debug, Default)]
struct Pings {
    silent_looks: Cell<Option<u32>>,
}

impl Pings {
    fn received(&self) {
        self.silent_looks.set(Some(0));
    }

    /// Checks whether the worker has stopped pinging; `looks_max` is `None` if no port is open.
    fn have_ended(&self, looks_max: Option<u32>) -> bool {
        let looks = self.silent_looks.get().filter(|_| looks_max.is_some());
        self.silent_looks.set(looks.map(|looks| looks + 1));
        looks.is_some() && looks >= looks_max
    }
}

impl WorkerLink {
    /// Starts the worker that the page names. `on_message` gets every message except for pings; `lost` is called when
    /// the worker has failed, after which no message arrives.
    pub(crate) fn spawn(
        mut on_message: impl FnMut(ToPage) + 'static,
        lost: impl FnMut() + 'static,
    ) -> Result<Self, NoWorker> {
        let pings = Rc::<Pings>::default();
        let received = Rc::clone(&pings);
        let worker = StartedWorker::start(
            Role::Worker,
            Box::new(move |worker, data| {
                match decode::<ToPage>(&Uint8Array::new(data).to_vec()) {
                    // At once and before anything else: a hidden page answers too, and a page whose
                    // handlers no longer run must not answer.
                    Ok(ToPage::Ping) => {
                        received.received();
                        pong(worker);
                    }
                    Ok(message) => {
                        if let ToPage::Hello { .. } = message {
                            pong(worker);
                        }
                        on_message(message);
                    }
                    // Both are of one build, and the texts of the causes are long.
                    Err(_) => logging::error!("a message of the worker does not read"),
                }
            }),
            Box::new(lost),
        )?;
        Ok(Self { worker, pings })
    }

    /// Sends one message, at once.
    pub(crate) fn post(&self, message: &ToWorker) {
        if let Ok(bytes) = encode(message) {
            self.worker.post(&bytes);
        }
    }

    /// Posts it the port for the line events.
    pub(crate) fn hand_over(&self, port: &MessagePort) {
        self.worker.hand_over(port);
    }

    /// Posts it the port of the group `Remote`, behind an empty message.
    pub(crate) fn hand_over_group(&self, port: &MessagePort) {
        self.worker.post_with(&[], &[], &[port.into()]);
    }

    /// Terminates it: it sends no more frames, and no message of it arrives.
    pub(crate) fn end(&self) {
        self.worker.end();
    }

    /// Checks whether the worker has stopped pinging: more than this number of checks ago, or `None` if no port is open.
    pub(crate) fn has_died(&self, looks_max: Option<u32>) -> bool {
        self.pings.have_ended(looks_max)
    }
}

fn pong(worker: &Worker) {
    let pong = ToWorker::Pong {
        page_ms: page_now_ms(),
    };
    if let Ok(bytes) = encode(&pong) {
        post(worker, &bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_worker_that_pings_no_more_has_failed_after_so_many_checks() {
        let pings = Pings::default();
        let has_ended = |_: &u32| pings.have_ended(Some(SILENT_LOOKS_MAX_TURNING));
        assert_eq!((1..100).find(has_ended), None, "no ping yet");
        pings.received();
        assert_eq!((1..100).find(has_ended), Some(4));
    }

    #[test]
    fn a_ping_between_two_checks_or_a_closed_port_is_no_failure() {
        let pings = Pings::default();
        for _ in 0..100 {
            pings.received();
            assert!(!pings.have_ended(Some(SILENT_LOOKS_MAX_TURNING)));
            // A page that hung: its timer is due, and then it gets what arrived meanwhile.
            assert!(!pings.have_ended(Some(SILENT_LOOKS_MAX_TURNING)));
        }
        assert!(!(0..100).any(|_| pings.have_ended(None)));
    }
}
