//! Whether the page shows a recording, and who gets the messages of the live line meanwhile.
//!
//! Everything else about it loads with the panel `Session file`. It sets a function that gets each message that would
//! cross between the recording and the live line, and decides whether it does.

use std::rc::Rc;

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{
    ToWorker, Update,
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
}

/// Returns whether it has dealt with the message.
pub(crate) type Gate = Rc<dyn Fn(Crossing<'_>) -> bool>;

/// The shown recording.
#[derive(Clone, Copy)]
pub(crate) struct Replay {
    /// The name of its file; `None` while the page shows the live line.
    pub(crate) name: RwSignal<Option<String>>,
    /// Set while a recording is shown.
    pub(crate) gate: StoredValue<Option<Gate>, LocalStorage>,
}

impl Replay {
    pub(crate) fn new() -> Self {
        Self {
            name: RwSignal::new(None),
            gate: StoredValue::new_local(None),
        }
    }

    /// Whether the recording has dealt with this message, so that it does not cross.
    pub(crate) fn keeps(self, message: Crossing<'_>) -> bool {
        // Cloned, because the gate may end the replay.
        self.gate.get_value().is_some_and(|gate| gate(message))
    }

    /// Why something of the live line cannot be done now.
    pub(crate) fn blocks(self) -> Option<String> {
        self.name
            .with(Option::is_some)
            .then(|| blocked().to_owned())
    }
}

/// Why nothing can be driven while a recording is shown.
pub(crate) fn blocked() -> &'static str {
    tr!("This is a recording. End the replay to drive.")
}
