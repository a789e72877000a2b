//! Requests of the page: a motor to watch, a command, a fault of the virtual bus, an answer to a ping.

use std::time::Duration;

use motorlink_bus::{Command, Refusal, StopReason, StopReport};
use motorlink_messages::{LineCondition, Notice};
use motorlink_port::{NotDone, PortControl};
use motorlink_protocol::MotorId;

use super::{PortOwner, is_at_rest};
use crate::{
    port_state::{PortState, Stage},
    runs::host::Message,
};

impl PortOwner {
    pub(crate) fn select(&mut self, id: MotorId) {
        let now = self.now();
        self.selected = id;
        self.outbox.touch();
        if let PortState::Open(open) = &mut self.port {
            let never_replied: Vec<_> = open
                .host
                .bus
                .motors(now)
                .filter(|motor| {
                    motor.last.is_none()
                        && !motor.may_turn
                        && !open.host.line.is_made_with(motor.id)
                })
                .map(|m| m.id)
                .collect();
            let forget = never_replied.into_iter().map(Command::Forget);
            for command in forget.chain([Command::Watch(id)]) {
                // Refused for a driven motor, which stays watched.
                let _: Result<(), Refusal> = open.host.bus.command(now, command);
            }
        }
    }

    /// How long ago the person acted.
    pub(crate) fn age(&self, given_ms: f64) -> Duration {
        self.page_clock.age(self.now(), given_ms)
    }

    /// Passes a message of the page to the loaded program of the runs.
    pub(crate) fn run_message(&mut self, message: Message) {
        let now = self.now();
        let bus = match &mut self.port {
            PortState::Open(open) if matches!(open.stage, Stage::Settled) => {
                Some(&mut open.host.bus)
            }
            _ => None,
        };
        let PortControl { runs, settings, .. } = &mut self.control;
        runs.message(now, message, bus, *settings);
    }

    pub(crate) fn command(&mut self, command: Command, given_ms: f64) {
        let now = self.now();
        if command.is_too_old(self.age(given_ms)) {
            self.outbox.notice(Notice::TooLate(command.into()));
            return;
        }
        if matches!(command, Command::StopAll(StopReason::PageGone)) {
            self.traffic.send_soon();
        }
        self.outbox.touch();
        let (bus, is_settled) = match &mut self.port {
            PortState::Open(open) => {
                let is_settled = matches!(open.stage, Stage::Settled);
                (Some(&mut open.host.bus), is_settled)
            }
            _ => (None, false),
        };
        let is_open = bus.is_some();
        match self.control.command(now, command, bus, is_settled) {
            Err(NotDone::Refused(refusal)) => {
                let command = command.into();
                self.outbox.notice(Notice::Refused { command, refusal });
            }
            Err(NotDone::NotConnected) => self.outbox.notice(Notice::NotConnected),
            Ok(()) => {}
        }
        if let Command::StopAll(reason) = command
            && !is_open
        {
            // Nothing to stop; nothing drives until the user releases.
            self.outbox.notice(Notice::StopBegan(reason));
            let report = StopReport {
                reason,
                motors: Vec::new(),
            };
            self.outbox.notice(Notice::StopEnded(report));
        }
    }

    /// Injects a fault into the virtual line, or removes it. The bus is not told, as on a real line.
    pub(crate) fn set_virtual_wire(&mut self, wire: LineCondition) {
        let now = self.now();
        let PortState::Open(open) = &mut self.port else {
            return;
        };
        if open.host.line.adapter().virtual_line().is_none() {
            return;
        }
        let waits_for_stop = wire == LineCondition::SharedId;
        if waits_for_stop {
            // The second motor would obey the frames of the first, but the user started only the first.
            let motors = open.host.bus.motors(now);
            let driven: Vec<_> = motors
                .filter(|motor| !is_at_rest(motor))
                .map(|motor| Command::Stop(motor.id))
                .collect();
            for command in driven.into_iter().chain([Command::StopRaw]) {
                // A stop is never refused.
                let _: Result<(), Refusal> = open.host.bus.command(now, command);
            }
        }
        open.next_wire = waits_for_stop.then_some(wire);
        if !waits_for_stop {
            open.host.line.set_wire(now, wire);
        }
        self.outbox.touch();
    }

    pub(crate) fn page_answered(&mut self, page_ms: f64) {
        let now = self.now();
        self.page_clock.heard(now, page_ms);
        self.outbox.page_answered();
        if let PortState::Open(open) = &mut self.port {
            open.host.bus.page_answered(now);
        }
    }
}
