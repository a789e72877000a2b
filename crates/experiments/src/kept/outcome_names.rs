//! The outcome of a run as a name in its file.

use std::mem::discriminant;

use motorlink_protocol::{Faults, Instant, Mode, MotorId};

use super::Outcome;
use crate::runner::{Cause, End, ExceededLimit};

/// The name of an outcome.
pub(super) fn name(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Running => "running",
        Outcome::Ended(End::Finished { .. }) => "finished",
        Outcome::Ended(End::Aborted { cause, .. }) => {
            let mut known = causes(MotorId::FIRST).into_iter();
            let is_same = |(_, it): &(_, Cause)| discriminant(it) == discriminant(&cause);
            known.find(is_same).map_or("", |(name, _)| name)
        }
        Outcome::PageClosed => "page_closed",
    }
}

/// The causes by their names in a file, without the details that it does not have.
const fn causes(id: MotorId) -> [(&'static str, Cause); 21] {
    [
        ("stopped", Cause::Stopped),
        ("driven", Cause::Driven(id)),
        ("fault", Cause::Fault(id, Faults::NONE)),
        ("silent", Cause::Silent(id)),
        ("limit", Cause::Limit(id, ExceededLimit::OfBus)),
        ("other_loop", Cause::OtherLoop(id, Mode::Velocity)),
        ("refused", Cause::Refused(id)),
        ("unplugged", Cause::Unplugged),
        ("tab_closed", Cause::TabClosed),
        ("page_silent", Cause::PageSilent),
        ("operator_lost", Cause::OperatorLost),
        ("focus_lost", Cause::FocusLost),
        ("slept", Cause::Slept),
        ("late", Cause::Late),
        ("wait_timed_out", Cause::WaitTimedOut { step: 0 }),
        ("paused_too_long", Cause::PausedTooLong),
        ("port_closed", Cause::PortClosed),
        ("scan", Cause::Scan),
        ("other_model", Cause::OtherModel),
        ("left_driven", Cause::LeftDriven),
        ("program_failed", Cause::ProgramFailed),
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
            let (_, cause) = known.find(|(of, _)| *of == name)?;
            Some(Outcome::Ended(End::Aborted { cause, at }))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The compiler asks here for a new cause. `causes` needs it, too.
    const fn is_named(cause: Cause) -> bool {
        match cause {
            Cause::Stopped
            | Cause::Driven(_)
            | Cause::Fault(..)
            | Cause::Silent(_)
            | Cause::Limit(..)
            | Cause::OtherLoop(..)
            | Cause::Refused(_)
            | Cause::Unplugged
            | Cause::TabClosed
            | Cause::PageSilent
            | Cause::OperatorLost
            | Cause::FocusLost
            | Cause::Slept
            | Cause::Late
            | Cause::WaitTimedOut { .. }
            | Cause::PausedTooLong
            | Cause::PortClosed
            | Cause::Scan
            | Cause::OtherModel
            | Cause::LeftDriven
            | Cause::ProgramFailed => true,
        }
    }

    #[test]
    fn every_cause_is_read_by_its_name() {
        let at = Instant::from_millis(7);
        for (of, cause) in causes(MotorId::FIRST) {
            let aborted = Outcome::Ended(End::Aborted { cause, at });
            assert!(is_named(cause) && name(aborted) == of, "{of}");
            assert_eq!(read(of, at, MotorId::FIRST), Some(aborted));
        }
    }
}
