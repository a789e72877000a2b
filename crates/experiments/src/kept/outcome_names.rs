//! The outcome of a run as a name in its file.

use motorlink_protocol::{Faults, Instant, Mode, MotorId};

use super::Outcome;
use crate::runner::{Cause, End, ExceededLimit};

/// The name of an outcome.
pub(super) fn name(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Running => "running",
        Outcome::Ended(End::Finished { .. }) => "finished",
        Outcome::Ended(End::Aborted { cause, .. }) => cause.into(),
        Outcome::PageClosed => "page_closed",
    }
}

/// Every cause, as a file gives it back.
const fn causes(id: MotorId) -> [Cause; 21] {
    [
        Cause::Stopped,
        Cause::Driven(id),
        Cause::Fault(id, Faults::NONE),
        Cause::Silent(id),
        Cause::Limit(id, ExceededLimit::OfBus),
        Cause::OtherLoop(id, Mode::Velocity),
        Cause::Refused(id),
        Cause::Unplugged,
        Cause::TabClosed,
        Cause::PageSilent,
        Cause::OperatorLost,
        Cause::FocusLost,
        Cause::Slept,
        Cause::Late,
        Cause::WaitTimedOut { step: 0 },
        Cause::PausedTooLong,
        Cause::PortClosed,
        Cause::Scan,
        Cause::OtherModel,
        Cause::LeftDriven,
        Cause::ProgramFailed,
    ]
}

/// The outcome of this name. `id` is the motor of a cause that has one.
pub(super) fn read(name: &str, at: Instant, id: MotorId) -> Option<Outcome> {
    match name {
        // Nothing runs in a file.
        "running" | "page_closed" => Some(Outcome::PageClosed),
        "finished" => Some(Outcome::Ended(End::Finished { at })),
        _ => {
            let mut known = causes(id).into_iter();
            let cause = known.find(|cause| <&str>::from(cause) == name)?;
            Some(Outcome::Ended(End::Aborted { cause, at }))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cause_is_read_by_its_name() {
        let at = Instant::from_millis(7);
        for cause in causes(MotorId::FIRST) {
            let aborted = Outcome::Ended(End::Aborted { cause, at });
            let read = read(name(aborted), at, MotorId::FIRST);
            assert_eq!(read, Some(aborted));
        }
    }
}
