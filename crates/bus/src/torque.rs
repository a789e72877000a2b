//! The current that a motor may still follow, so that a torque reversal passes through zero.

use motorlink_protocol::{CurrentTarget, Frame, Request};

/// The last non-zero current that was sent to a motor, until the motor answers a zero.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Torque(Option<CurrentTarget>);

impl Torque {
    /// Records a drive frame in the current loop.
    pub(crate) fn sent(&mut self, current: CurrentTarget) {
        if current.raw() != 0 {
            self.0 = Some(current);
        }
    }

    /// Whether this current reverses the torque without a zero in between.
    pub(crate) fn is_reversed_by(self, current: CurrentTarget) -> bool {
        let possible = self.0.map_or(0, |possible| i32::from(possible.raw()));
        possible * i32::from(current.raw()) < 0
    }

    /// Records that the motor has answered this frame.
    pub(crate) fn answered(&mut self, frame: &Frame) {
        if let Ok(Request::Drive { drive, .. }) = Request::parse(frame)
            && drive.signed() == 0
        {
            self.0 = None;
        }
    }

    /// The current that the motor may follow; `None` if it is certainly zero.
    pub(crate) const fn possible(self) -> Option<CurrentTarget> {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use motorlink_protocol::{MotorId, Setpoint};

    use super::*;

    fn drive(raw: i32) -> Frame {
        let current = CurrentTarget::new(raw).unwrap();
        Request::drive(MotorId::FIRST, Setpoint::Current(current)).frame()
    }

    #[test]
    fn a_current_is_possible_until_a_zero_is_answered() {
        let forward = CurrentTarget::new(5_000).unwrap();
        let mut torque = Torque::default();
        assert_eq!(torque.possible(), None);
        torque.sent(forward);
        torque.answered(&drive(5_000));
        assert_eq!(torque.possible(), Some(forward));
        // A zero that is sent is not yet answered.
        torque.sent(CurrentTarget::ZERO);
        assert_eq!(torque.possible(), Some(forward));
        let query = Request::Query { id: MotorId::FIRST }.frame();
        torque.answered(&query);
        assert_eq!(torque.possible(), Some(forward));
        torque.answered(&drive(0));
        assert_eq!(torque.possible(), None);
    }
}
