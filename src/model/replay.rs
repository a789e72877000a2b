//! Whether the page shows a recording, and who gets the messages of the live line meanwhile.
//!
//! Everything else about it loads with the panel `Session file`. It sets a function that gets each message that would
//! cross between the recording and the live line, and decides whether it does.

use std::{cell::RefCell, hint::black_box, rc::Rc};

use motorlink_i18n::tr;
use motorlink_messages::{
    ToWorker, Update,
    protocol::Instant,
    recorder::{FromRecorder, ToRecorder},
};

/// A message that the recording may keep to itself.
#[derive(Clone, Copy)]
pub(crate) enum Crossing<'a> {
    ToWorker(&'a ToWorker),
    FromWorker(&'a Update),
    /// The port worker has failed.
    WorkerLost,
    ToRecorder(&'a ToRecorder),
    FromRecorder(&'a FromRecorder),
    /// STOP, or a key that stops.
    Stop,
    /// A press on this row of the packet log.
    Row(u64),
    /// A press on this time in the graph.
    Moment(Instant),
}

/// Returns whether it has dealt with the message.
pub(crate) type Gate = Rc<dyn Fn(Crossing<'_>) -> bool>;

thread_local! {
    /// Set while a recording is shown.
    static GATE: RefCell<Option<Gate>> = const { RefCell::new(None) };
}

/// A recording is shown from now on.
pub(crate) fn set_gate(gate: Gate) {
    // There is only one, which the optimizer would find. It would call it directly, and with it would come into the first
    // program what it uses.
    GATE.set(Some(black_box(gate)));
}

/// The live line is shown from now on. A function of its own for the same reason.
pub(crate) fn clear_gate() {
    GATE.set(None);
}

/// Whether a recording is shown that has dealt with this message, so that it does not cross.
pub(crate) fn keeps(message: Crossing<'_>) -> bool {
    // Cloned, because the gate may end the replay.
    let gate = GATE.with_borrow(Clone::clone);
    gate.is_some_and(|gate| gate(message))
}

/// Why nothing can be driven while a recording is shown.
pub(crate) fn blocked() -> &'static str {
    tr!("This is a recording. End the replay to drive.")
}
