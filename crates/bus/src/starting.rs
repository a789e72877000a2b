//! What a person has started, and what it waits for: a stop, or a switch to its loop.

use motorlink_protocol::{Instant, Mode, MotorId, Setpoint};

use crate::{
    bus::Bus,
    event::{Event, StopOutcome},
    motor::{Control, Motor},
    refusal::Refusal,
    start::Start,
};

impl Bus {
    /// Goes on with what was started during this stop, or says why not.
    pub(crate) fn start_stopped(&mut self, now: Instant, outcome: StopOutcome, start: Start) {
        let id = outcome.id;
        let started = if outcome.confirmed {
            self.drive_in(now, id, start, true)
        } else {
            Err(Refusal::NotStopped(id))
        };
        if let Err(refusal) = started {
            self.events.push_back(Event::NotStarted { id, refusal });
        }
    }

    /// Whether a setpoint of this loop waits for a stop or a switch.
    pub(crate) fn waits_in(&mut self, id: MotorId, mode: Mode) -> bool {
        let waiting = self.motor_mut(id).and_then(|it| it.waiting_setpoint());
        waiting.is_some_and(|setpoint| setpoint.mode() == mode)
    }
}

impl Motor {
    /// What a person has started, and waits for a stop or a switch.
    pub(crate) fn waiting_setpoint(&self) -> Option<Setpoint> {
        match self.control {
            Control::Stopping(stop) => stop.then.map(|start| start.setpoint),
            Control::Switching(switch) => switch.queued_setpoint,
            Control::Idle | Control::Driven(_) => None,
        }
    }

    /// Whether it is driven after its stop or its switch.
    pub(crate) fn will_drive(&self) -> bool {
        let is_kept_driven =
            matches!(self.control, Control::Switching(switch) if switch.was_driven);
        is_kept_driven || self.waiting_setpoint().is_some()
    }

    pub(crate) fn is_switching_to(&self, mode: Mode) -> bool {
        matches!(self.control, Control::Switching(switch) if switch.to == mode)
    }
}
