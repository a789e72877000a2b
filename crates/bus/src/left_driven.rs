//! Motors that an earlier connection left driven: they are stopped first.

use motorlink_protocol::{Instant, Mode, MotorId};

use crate::{
    bus::Bus,
    event::StopReason,
    motor::{Control, Motor, Rest},
    refusal::Refusal,
};

/// A motor that was driven over an earlier connection and whose standstill no reply has confirmed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LeftDriven {
    /// Which motor.
    pub id: MotorId,
    /// The loop it was last driven in; `None` if it is not known.
    pub mode: Option<Mode>,
}

impl Bus {
    /// Stops these motors as the first act on the port, before the ID query and every other request. Nothing drives
    /// until that stop has ended.
    ///
    /// A motor keeps its last command when frames cease, so a motor that was driven when the port was lost may still
    /// turn. Call it before the first [`Bus::poll`]. It does not halt the bus.
    pub fn stop_first(&mut self, now: Instant, motors: impl IntoIterator<Item = LeftDriven>) {
        let mut ids = Vec::new();
        for LeftDriven { id, mode } in motors {
            let motor = self.watch(now, id);
            motor.rest.doubt();
            motor.left_in = mode;
            ids.push(id);
        }
        if ids.is_empty() {
            return;
        }
        self.begin_stop(now, StopReason::LeftDriven, &|motor| {
            ids.contains(&motor.id)
        });
        if let Some(stop) = &mut self.stop {
            stop.goes_first = true;
        }
    }

    /// Stops again what was driven on a line that was dead, and answers again: its stop frames did not arrive, and it may
    /// have kept its last command. All such motors are stopped together, since their line is most likely the same.
    ///
    /// A motor that answered during its whole stop is left alone: a person may hold its wheel.
    pub(crate) fn stop_what_is_back(&mut self, now: Instant) {
        let is_stopped = |motor: &Motor| matches!(motor.control, Control::Stopping(_));
        let waits = |motor: &Motor| motor.rest == Rest::StopWhenBack && !is_stopped(motor);
        let is_back = |motor: &Motor| waits(motor) && !motor.is_without_answer();
        if self.motors.iter().any(is_back) {
            self.begin_stop(now, StopReason::LeftDriven, &waits);
        }
    }

    /// The motors that are driven, or whose standstill is not confirmed since: what to remember if the port is lost now.
    ///
    /// Before each frame that may start a motion, the motor is among them.
    pub fn left_driven(&self) -> impl Iterator<Item = LeftDriven> {
        let motors = self.motors.iter();
        let left = motors.filter(|motor| motor.is_left_driven() || self.is_driven_raw(motor.id));
        left.map(|motor| LeftDriven {
            id: motor.id,
            mode: motor.left_loop(),
        })
    }

    /// Whether the stop runs that goes before everything else on the port.
    pub(crate) fn stops_first(&self) -> bool {
        self.stop.as_ref().is_some_and(|stop| stop.goes_first)
    }

    /// Refuses what may move a wheel, or takes the line, while that stop runs.
    pub(crate) fn check_not_stopping_first(&self) -> Result<(), Refusal> {
        if self.stops_first() {
            Err(Refusal::StopsFirst)
        } else {
            Ok(())
        }
    }
}

impl Motor {
    /// Whether it would be left driven if the port were lost now.
    fn is_left_driven(&self) -> bool {
        let starts = match self.control {
            Control::Switching(switch) => switch.was_driven || switch.queued_setpoint.is_some(),
            Control::Driven(_) => true,
            Control::Idle | Control::Stopping(_) => false,
        };
        starts || self.may_turn()
    }

    /// The loop that it was last driven in; `None` if it may be another one.
    fn left_loop(&self) -> Option<Mode> {
        match self.control {
            Control::Driven(driven) => Some(driven.goal.mode()),
            // It may be in either.
            Control::Switching(_) => None,
            Control::Idle | Control::Stopping(_) => self.assumed_loop(),
        }
    }
}
