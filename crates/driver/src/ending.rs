//! The end of the thread: the motors are stopped, also after a failure.

use std::panic::{AssertUnwindSafe, catch_unwind};

use motorlink_bus::{Command, Refusal, StopReason};
use motorlink_messages::LeftBehind;
use motorlink_protocol::Instant;
use motorlink_runs::Runs;

use crate::{
    computer::Computer,
    owner::{Owner, Stage},
};

impl<C: Computer> Owner<C> {
    /// Whether a motor must be stopped before the port is closed. While the port is lost, no motor can be stopped: the next
    /// driver does it.
    pub(crate) fn needs_stop(&mut self) -> bool {
        let now = self.computer.now();
        self.host
            .as_ref()
            .is_some_and(|host| host.bus.needs_stop(now))
    }

    pub(crate) fn begin_end(&mut self, now: Instant) {
        if self.stage.is_ending() {
            return;
        }
        self.stage = Stage::Ending { has_stopped: false };
        let Some(host) = &mut self.host else { return };
        if !host.bus.is_stopping() {
            // What an earlier stop has shown is not the result of this end.
            self.last_stop = None;
        }
        if host.bus.needs_stop(now) {
            let stop = Command::StopAll(StopReason::Disconnect);
            // A stop is never refused.
            let _: Result<(), Refusal> = host.bus.command(now, stop);
        }
    }

    /// The bus has failed, and its state is not to be trusted. The line is: another bus stops what the file names.
    pub(crate) fn stop_after_failure(&mut self) {
        self.stage = Stage::Ending { has_stopped: false };
        self.control.is_halted = true;
        // The failure may be theirs.
        self.control.runs = Runs::default();
        let now = self.computer.now();
        let Some(mut host) = self.host.take() else {
            // No line is left. The next driver stops what the file names.
            if let Some(left) = self.file.written() {
                self.file.left.carry(left);
            }
            return;
        };
        let nothing = LeftBehind::nothing(host.bus.model());
        let left = self.file.written().unwrap_or(nothing);
        host.bus = self.new_bus(now, left.model).after_another(now);
        host.bus.stop_first(now, left.motors);
        self.host = Some(host);
        // If this one fails too, the motors are in the file.
        let _ = catch_unwind(AssertUnwindSafe(|| self.run_open()));
    }
}
