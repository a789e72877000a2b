//! Which notices are still true. A notice that is no longer true is withdrawn or replaced.

use motorlink_messages::{
    Notice, Update,
    bus::{Activity, Answer, IdQueryOutcome, MotorStatus, StopOutcome},
    protocol::{MotorId, Rpm},
};

use crate::model::{
    affected::{silent, stopping},
    notice_board::{Review, Until},
    notice_texts,
    snapshot::{Session, is_active},
};

/// Consecutive replies of 0 rpm that confirm a standstill, as in the bus: a single one may be from a wheel that
/// reverses.
const STANDSTILL_REPLIES: u8 = 3;

/// When this notice is no longer true.
pub(crate) fn until(notice: &Notice, session: &Session) -> Until {
    match notice {
        Notice::IdQueryEnded(IdQueryOutcome::NoReply) => Until::AnyAnswer,
        Notice::MotorSilent { id, .. } => Until::Answers(silent(session, *id)),
        Notice::ModeSwitchFailed { id, asked, .. } => Until::Loop(*id, *asked),
        Notice::Withdrawn { id, reason } => Until::AtRest {
            motors: stopping(session, *id),
            withdrawn: Some((*id, *reason)),
        },
        Notice::StopEnded(report) => {
            let motors = report.motors.iter().copied();
            let open = motors.filter(|motor| !motor.confirmed);
            Until::Standstill(open.map(|motor| (motor, 0)).collect())
        }
        _ => Until::Dismissed,
    }
}

/// Whether a notice is still true after an update of the worker.
pub(crate) fn review(until: &mut Until, update: &Update) -> Review {
    let motor = |id: &MotorId| update.motors.iter().find(|motor| motor.id == *id);
    let over = match until {
        Until::Dismissed => false,
        Until::AnyAnswer => !update.samples.is_empty(),
        Until::Answers(ids) => {
            let is_silent = |id: &MotorId| motor(id).is_some_and(MotorStatus::is_silent);
            let left: Vec<MotorId> = ids.iter().copied().filter(is_silent).collect();
            if !left.is_empty() {
                // What comes from a silent motor changes.
                let is_corrupted = |id| motor(id).is_some_and(|it| it.answer == Answer::Corrupted);
                let words = notice_texts::of_silence(&left, left.iter().all(is_corrupted));
                return Review::Replace(words, Until::Answers(left));
            }
            true
        }
        Until::Loop(id, mode) => {
            let replies = update.samples.iter().map(|sample| sample.reply);
            replies
                .into_iter()
                .any(|reply| (reply.id, reply.mode) == (*id, *mode))
        }
        Until::AtRest { motors, withdrawn } => {
            let at_rest = !motors.iter().filter_map(motor).any(is_active);
            if let (true, Some((id, reason))) = (at_rest, withdrawn) {
                let words = notice_texts::of_ended_drive(*id, *reason, motors);
                return Review::Replace(words, Until::Driven(std::mem::take(motors)));
            }
            at_rest
        }
        Until::Driven(ids) => ids.iter().filter_map(motor).any(is_driven),
        Until::Standstill(open) => return review_stop(open, update),
    };
    if over { Review::Withdraw } else { Review::Keep }
}

fn is_driven(motor: &MotorStatus) -> bool {
    matches!(
        motor.activity,
        Activity::Driven { .. } | Activity::DrivenRaw
    )
}

fn review_stop(open: &mut Vec<(StopOutcome, u8)>, update: &Update) -> Review {
    let before = open.len();
    for (motor, still) in open.iter_mut() {
        let of_motor = update
            .samples
            .iter()
            .filter(|sample| sample.reply.id == motor.id);
        for sample in of_motor {
            // Any motion after a standstill is a new one.
            if *still < STANDSTILL_REPLIES {
                *still = match sample.reply.speed.map(Rpm::magnitude) {
                    Some(0) => *still + 1,
                    Some(_) => 0,
                    None => *still,
                };
            }
        }
    }
    open.retain(|(_, still)| *still < STANDSTILL_REPLIES);
    match open.len() {
        // Also where all stood from the first: then it is a report of what happened.
        left if left == before => Review::Keep,
        0 => Review::Withdraw,
        _ => {
            let motors = open.iter().map(|(motor, _)| *motor);
            Review::Replace(
                notice_texts::of_unconfirmed(motors),
                Until::Standstill(open.clone()),
            )
        }
    }
}

#[cfg(test)]
#[path = "notice_lifetime_tests.rs"]
mod tests;
