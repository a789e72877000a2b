//! What a driver is opened with, and how it ends.

use std::{
    path::PathBuf,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
        mpsc::Sender,
    },
};

use motorlink_bus::{BusSettings, StopReport};
use motorlink_protocol::{MotorId, family::Model};

use crate::{
    inputs::{Given, Input},
    locked_file::default_folder,
    ports::Place,
};

/// What a driver is opened with.
#[derive(Clone, Debug)]
pub struct Options {
    /// Where the motors are.
    pub place: Place,
    /// Their model; `None` finds out.
    pub model: Option<Model>,
    /// The motors to ask for telemetry.
    pub watch: Vec<MotorId>,
    /// Rate, ramp and limits.
    pub settings: BusSettings,
    /// The folder of the files that say what is driven; `None` remembers nothing.
    pub state_folder: Option<PathBuf>,
    /// Whether each frame and each reading is told, as a recording needs them. Otherwise the program wakes up less often,
    /// and asks for the state when it shows it.
    pub tells_traffic: bool,
    /// Ends the driver from elsewhere.
    pub ender: Ender,
}

impl Options {
    /// The motors at this place, with the usual settings.
    #[must_use]
    pub fn at(place: Place) -> Self {
        Self {
            place,
            model: None,
            watch: Vec::new(),
            settings: BusSettings::default(),
            state_folder: default_folder(),
            tells_traffic: false,
            ender: Ender::default(),
        }
    }
}

/// Ends a driver from elsewhere, such as from the handler of a signal: the motors are stopped, and the port is closed.
#[derive(Clone, Debug, Default)]
pub struct Ender(Arc<EnderState>);

#[derive(Debug, Default)]
struct EnderState {
    is_asked: AtomicBool,
    inputs: Mutex<Option<Sender<Given>>>,
}

impl Ender {
    /// Ends the driver, or the one that is opened with this ender next.
    pub fn end(&self) {
        self.0.is_asked.store(true, Ordering::SeqCst);
        let inputs = self.0.inputs.lock();
        if let Some(inputs) = &*inputs.unwrap_or_else(PoisonError::into_inner) {
            // It may have ended.
            let _ = inputs.send(Input::End.into());
        }
    }

    /// Whether an end was asked for.
    #[must_use]
    pub fn is_asked(&self) -> bool {
        self.0.is_asked.load(Ordering::SeqCst)
    }

    pub(crate) fn connect(&self, inputs: &Sender<Given>) {
        let mut slot = self.0.inputs.lock().unwrap_or_else(PoisonError::into_inner);
        *slot = Some(inputs.clone());
        drop(slot);
        if self.is_asked() {
            // The thread that receives it is not started yet.
            let _ = inputs.send(Input::End.into());
        }
    }
}

/// How a driver ended.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Ending {
    /// The result of the last stop.
    pub last_stop: Option<StopReport>,
    /// Motors that were driven and whose standstill is not confirmed. The next driver on this adapter stops them first.
    pub may_turn: Vec<MotorId>,
    /// Whether the driver itself failed. It has stopped the motors as far as it could.
    pub has_failed: bool,
}
