//! Opens a port for the model of its motors, and stops first what was left driven on it.

use std::time::Duration;

use motorlink_bus::{Bus, Command, DETECTION_MAX, DetectedModel, ModelSearch, Refusal};
use motorlink_protocol::{Instant, family::Model};

use crate::{
    computer::Computer, host::Host, left_motors::LeftMotors, open_failure::OpenFailure,
    owner::Owner,
};

/// How long motors that were left driven may take to answer before another model is tried: an ID query of 60 ms and three
/// queries at 10 Hz.
const LEFT_ANSWER: Duration = Duration::from_millis(400);

impl<C: Computer> Owner<C> {
    /// Opens the serial port at `path` for the model of its motors: the one that was left driven, the one that was asked
    /// for, or the one that answers.
    pub(crate) fn open_serial(&mut self, path: &str) -> Result<(), OpenFailure> {
        let left = self.file.left_model();
        if let Some(model) = left {
            self.open_for(path, model, LeftMotors::Stop)?;
            let answered = |bus: &Bus, now| {
                bus.motors(now)
                    .any(|motor| motor.last.is_some())
                    .then_some(())
            };
            if self.wait_on_trial(LEFT_ANSWER, answered)?.is_some() {
                return Ok(());
            }
            // They may be without power, and other motors may be here.
            self.close_line();
        }
        if let Some(model) = self.asked_model {
            // They may answer now.
            return self.open_for(path, model, LeftMotors::Stop);
        }
        let mut search = ModelSearch::from(left.unwrap_or_default());
        while let Some(model) = search.next_model() {
            self.open_for(path, model, LeftMotors::Leave)?;
            let detected = self.wait_on_trial(DETECTION_MAX, Bus::detected_model)?;
            let other = match detected {
                // What was left driven did not answer before, and may now.
                Some(DetectedModel::Own) if left.is_some_and(|left| left.is_like(model)) => {
                    self.close_line();
                    return self.open_for(path, model, LeftMotors::Stop);
                }
                Some(DetectedModel::Own) => return Ok(()),
                Some(DetectedModel::Other(model)) => Some(model),
                None => None,
            };
            search.not_found(other);
            self.close_line();
        }
        // Nothing answers. What was left driven is stopped when it does.
        self.open_for(path, left.unwrap_or_default(), LeftMotors::Stop)
    }

    /// Opens the port on trial for this model. The first act is the stop of motors of this model that were left driven.
    pub(crate) fn open_for(
        &mut self,
        path: &str,
        model: Model,
        how: LeftMotors,
    ) -> Result<(), OpenFailure> {
        self.number += 1;
        let line = self.computer.open_line(path, model, self.number)?;
        let now = self.computer.now();
        let mut bus = self.new_bus(now, model).after_another(now).on_trial();
        let left = self.file.left_model();
        if how == LeftMotors::Stop && left.is_some_and(|left| left.is_like(model)) {
            bus.stop_first(now, self.file.take_left());
        }
        self.host = Some(Host {
            bus,
            line,
            has_queried: !self.asks_for_id(),
        });
        Ok(())
    }

    /// Whether the ID query is sent. Several motors would reply to it at once.
    pub(crate) fn asks_for_id(&self) -> bool {
        self.watched.len() < 2
    }

    /// A bus on which nothing drives, with what the program has set.
    pub(crate) fn new_bus(&self, now: Instant, model: Model) -> Bus {
        let mut bus = Bus::with_model(now, model);
        if self.is_halted {
            bus = bus.into_halted();
        }
        let id_query = self.asks_for_id().then_some(Command::IdQuery);
        let watched = self.watched.iter().copied().map(Command::Watch);
        let first = [Command::Configure(self.settings)];
        for command in first.into_iter().chain(id_query).chain(watched) {
            // None of them is refused while nothing drives.
            let _: Result<(), Refusal> = bus.command(now, command);
        }
        bus
    }

    /// Runs the port on trial until `found` returns a result. Returns `None` after `limit`, or later if a stop still runs
    /// then.
    fn wait_on_trial<T>(
        &mut self,
        limit: Duration,
        found: impl Fn(&Bus, Instant) -> Option<T>,
    ) -> Result<Option<T>, OpenFailure> {
        let until = self.computer.now() + limit;
        loop {
            let wake = self.turn();
            let now = self.computer.now();
            let Some(host) = &self.host else {
                return Err(OpenFailure::Lost);
            };
            let is_active = host.bus.is_active(now);
            if let Some(result) = found(&host.bus, now) {
                return Ok(Some(result));
            }
            if self.stage.is_ending() && !is_active {
                return Err(OpenFailure::Ended);
            }
            if now >= until && !is_active {
                return Ok(None);
            }
            let wake = if now < until { wake.min(until) } else { wake };
            self.take_inputs(wake);
        }
    }
}
