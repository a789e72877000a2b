//! Opens a port for the model of its motors, and stops first what was left driven on it.

use motorlink_bus::{Awaited, Bus, DetectedModel, LeftMotors, OpeningOrder};
use motorlink_protocol::{Instant, family::Model};

use crate::{computer::Computer, host::Host, open_failure::OpenFailure, owner::Owner};

impl<C: Computer> Owner<C> {
    /// Opens the serial port at `path` for the model of its motors: the one that was left driven, the one that was asked
    /// for, or the one that answers.
    pub(crate) fn open_serial(&mut self, path: &str) -> Result<(), OpenFailure> {
        let left = self.file.left_model();
        let likely = left.unwrap_or_default();
        let mut order = OpeningOrder::new(left, self.asked_model, likely);
        loop {
            let trial = order.trial();
            self.open_for(path, trial.model, trial.left)?;
            let found = self.wait_on_trial(trial.awaits)?;
            if order.tried(found) {
                return Ok(());
            }
            self.close_line();
        }
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
        let watched = self.watched.iter().copied();
        bus.prepared(now, self.settings, self.asks_for_id(), watched)
    }

    /// Runs the port on trial until the motors show this. Returns `None` after its limit, or later if a stop still runs then.
    fn wait_on_trial(&mut self, awaited: Awaited) -> Result<Option<DetectedModel>, OpenFailure> {
        if awaited == Awaited::Nothing {
            return Ok(None);
        }
        let until = self.computer.now() + awaited.limit();
        loop {
            let wake = self.turn();
            let now = self.computer.now();
            let Some(host) = &self.host else {
                return Err(OpenFailure::Lost);
            };
            let is_active = host.bus.is_active(now);
            let found = awaited.found(&host.bus, now);
            if found.is_some() {
                return Ok(found);
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
