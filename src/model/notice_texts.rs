//! The texts of notices: what happened, and what to do.

use motorlink_i18n::{Language, tr};
use motorlink_messages::{
    Notice,
    bus::{
        CommandKind, IdQueryOutcome, Refusal, StopOutcome, StopReason, StopReport, WithdrawReason,
    },
    protocol::{Mode, MotorId},
};

use crate::model::{
    affected,
    help_topic::HelpTopic,
    later_notices,
    notice_board::{NoticeText, Remedy, Tone, Topic},
    scan_texts::{self, wiring},
    snapshot::Session,
    terms,
};

/// The text of a worker's notice; `None` if the page shows it in another way.
pub(crate) fn of_notice(notice: &Notice) -> Option<NoticeText> {
    of_notice_in(notice, &Session::default())
}

/// The same, with all affected motors.
pub(crate) fn of_notice_in(notice: &Notice, session: &Session) -> Option<NoticeText> {
    Some(match notice {
        Notice::Refused { command, refusal } => of_refusal(*command, *refusal)?,
        Notice::TooLate(_) => NoticeText::new(
            Topic::Command,
            Tone::Warning,
            tr!("Not done: timed out"),
            &[tr!("The page was busy. Press again.")],
        )
        .explained_at(HelpTopic::Troubleshooting),
        Notice::NotConnected => NoticeText::new(
            Topic::Command,
            Tone::Calm,
            tr!("Not connected"),
            &[tr!("Press Connect motor or Virtual motor.")],
        ),
        Notice::IdQueryEnded(
            outcome @ (IdQueryOutcome::NoReply
            | IdQueryOutcome::Garbled
            | IdQueryOutcome::Cancelled),
        ) => scan_texts::of_id_query(*outcome),
        Notice::ModeSwitchFailed {
            id,
            asked,
            reported,
        } => of_failed_switch(*id, *asked, *reported),
        Notice::Withdrawn { id, reason } => {
            of_withdrawal(*id, *reason, &affected::stopping(session, *id))
        }
        Notice::OtherModel { expected, found } => NoticeText::new(
            Topic::Line,
            Tone::Warning,
            tr!("Motor of another model"),
            &[&terms::other_model(*expected, *found)],
        ),
        Notice::MotorSilent { id, garbled } => {
            of_silence(&affected::silent(session, *id), *garbled)
        }
        Notice::StopEnded(report) => of_stop(report)?,
        Notice::AdapterLost { driven } => of_lost_adapter(driven),
        Notice::AdapterBack => NoticeText::new(
            Topic::Port,
            Tone::Calm,
            tr!("Adapter reconnected"),
            &[tr!("No motor starts until you press Start.")],
        ),
        Notice::NotRemembered
        | Notice::Missed
        | Notice::LineError { .. }
        | Notice::ScanEnded(_)
        | Notice::IdChangeEnded { .. }
        | Notice::SendsText { .. } => later_notices::if_loaded(notice)?,
        // Other parts of the page show these.
        Notice::IdQueryEnded(IdQueryOutcome::One(_))
        | Notice::ModeSwitched { .. }
        | Notice::MotorBack(_)
        | Notice::StopBegan(_) => return None,
    })
}

/// The topic that this notice settles.
pub(crate) fn settled_by(notice: &Notice) -> Option<Topic> {
    match notice {
        Notice::ModeSwitched { id, .. } => Some(Topic::Loop(*id)),
        // A silent motor is identified by its ID.
        Notice::IdQueryEnded(IdQueryOutcome::One(_))
        | Notice::ScanEnded(_)
        | Notice::MotorSilent { .. } => Some(Topic::Answer),
        _ => None,
    }
}

fn of_refusal(command: CommandKind, refusal: Refusal) -> Option<NoticeText> {
    // A drag that outlasts a drive is no error, and for a high current the page asks.
    if matches!(
        command,
        CommandKind::Adjust | CommandKind::AdjustGroup | CommandKind::Forget
    ) || matches!(refusal, Refusal::NeedsConsent(_))
    {
        return None;
    }
    let title = match command {
        CommandKind::Drive(id) => tr!("Motor {id} not started", id),
        CommandKind::DriveGroup => tr!("Motors not started").to_owned(),
        CommandKind::SwitchMode(mode) => {
            tr!("Not switched to the {mode}", mode = terms::mode(mode))
        }
        CommandKind::IdQuery => tr!("The ID query was not sent").to_owned(),
        CommandKind::FullScan => tr!("The bus was not scanned").to_owned(),
        CommandKind::SetId => tr!("The ID was not changed").to_owned(),
        CommandKind::SendRaw { .. } => tr!("The frame was not sent").to_owned(),
        _ => tr!("Not done").to_owned(),
    };
    Some(NoticeText {
        help: HelpTopic::of_refusal(refusal),
        ..NoticeText::new(
            Topic::Command,
            Tone::Warning,
            title,
            &[&terms::refusal(refusal)],
        )
    })
}

/// Motors do not answer. `garbled`: bytes come from all of them, but no valid reply.
pub(crate) fn of_silence(ids: &[MotorId], garbled: bool) -> NoticeText {
    let title = match ids {
        [id] if !garbled => tr!("No reply from motor {id} for 2 s", id),
        // True of those from which bytes come, and of the others.
        ids => tr!("No valid reply from {ids} for 2 s", ids = terms::ids(ids)),
    };
    if garbled {
        let advice = tr!(
            "Bytes come, but they are corrupted. Link health in Diagnose names the likely cause."
        );
        return NoticeText::new(Topic::Silence, Tone::Warning, title, &[advice])
            .explained_at(HelpTopic::DamagedBytes);
    }
    NoticeText::new(Topic::Silence, Tone::Warning, title, &wiring())
        .explained_at(HelpTopic::NoAnswer)
}

fn of_failed_switch(id: MotorId, asked: Mode, reported: Option<Mode>) -> NoticeText {
    let title = reported.map_or_else(
        || {
            tr!(
                "Motor {id} did not confirm the switch to the {asked}",
                id,
                asked = terms::mode(asked)
            )
        },
        |reported| {
            tr!(
                "Motor {id} is still in the {reported}, not the {asked}",
                id,
                reported = terms::mode(reported),
                asked = terms::mode(asked)
            )
        },
    );
    let advice = match asked {
        Mode::Position => {
            tr!("The position loop needs less than 10 rpm: stop the motor, then switch.")
        }
        Mode::OpenLoop | Mode::Current | Mode::Velocity => {
            tr!("Press Switch or Start again. If that fails, power-cycle the motor.")
        }
    };
    NoticeText::new(Topic::Loop(id), Tone::Error, title, &[advice])
        .explained_at(HelpTopic::StaysInLoop)
}

/// Why the setpoint of a motor is withdrawn, and what to do.
pub(crate) fn why_withdrawn(reason: WithdrawReason) -> (String, &'static str) {
    match reason {
        WithdrawReason::Silent => (
            tr!("no reply for 200 ms").to_owned(),
            tr!("Check the motor's power and signal plug, then press Start."),
        ),
        WithdrawReason::Fault(faults) => (
            tr!(
                "it reports a fault ({faults})",
                faults = terms::faults(faults)
            ),
            tr!("Wait until the fault clears, free the wheel if it is blocked, then press Start."),
        ),
        WithdrawReason::OtherLoop { reported } => (
            tr!(
                "it is now in the {reported} (power loss, or another master)",
                reported = terms::mode(reported)
            ),
            tr!("Check the motor's power, switch the loop back, then press Start."),
        ),
        WithdrawReason::NotEnabled => (
            tr!("it is not enabled any more (power loss)").to_owned(),
            tr!("Check the motor's power, then press Start."),
        ),
        WithdrawReason::TemperatureUnknown => (
            tr!("the temperature has not been known for 2 s").to_owned(),
            tr!("Check the motor's power and signal plug, then press Start."),
        ),
        WithdrawReason::AngleMisfits => (
            tr!("its angle does not fit its motion").to_owned(),
            tr!("Do not use its position loop."),
        ),
        WithdrawReason::Limit(exceeded) => (
            terms::exceeded_limit(exceeded),
            tr!("Find the cause before you press Start. The limits are in Settings."),
        ),
    }
}

/// A motor's setpoint was withdrawn, and all of these are being stopped for it.
fn of_withdrawal(id: MotorId, reason: WithdrawReason, stopping: &[MotorId]) -> NoticeText {
    let (why, advice) = why_withdrawn(reason);
    let title = match stopping {
        [_] => tr!("Stopping motor {id}: {why}", id, why),
        ids => tr!(
            "Stopping motors {ids} because of motor {id}: {why}",
            ids = terms::ids(ids),
            id,
            why
        ),
    };
    NoticeText::new(Topic::Setpoint(id), Tone::Error, title, &[advice])
        .explained_at(HelpTopic::of_withdrawal(reason))
}

/// The same after the stop, in the past tense.
pub(crate) fn of_ended_drive(
    id: MotorId,
    reason: WithdrawReason,
    stopped: &[MotorId],
) -> NoticeText {
    let why = match reason {
        WithdrawReason::Fault(faults) => {
            tr!(
                "it reported a fault ({faults})",
                faults = terms::faults(faults)
            )
        }
        WithdrawReason::OtherLoop { reported } => tr!(
            "it was in the {reported} (power loss, or another master)",
            reported = terms::mode(reported)
        ),
        WithdrawReason::NotEnabled => tr!("it lost power").to_owned(),
        WithdrawReason::Silent
        | WithdrawReason::TemperatureUnknown
        | WithdrawReason::AngleMisfits
        | WithdrawReason::Limit(_) => why_withdrawn(reason).0,
    };
    let title = match stopped {
        [_] => tr!("Motor {id} is no longer driven: {why}", id, why),
        ids => tr!(
            "Motors {ids} are no longer driven because of motor {id}: {why}",
            ids = terms::ids(ids),
            id,
            why
        ),
    };
    NoticeText {
        title,
        tone: Tone::Warning,
        ..of_withdrawal(id, reason, stopped)
    }
}

fn of_stop(report: &StopReport) -> Option<NoticeText> {
    let motors = report.motors.iter().copied();
    let mut open = motors.filter(|motor| !motor.confirmed).peekable();
    let left_driven = report.reason == StopReason::LeftDriven;
    if open.peek().is_some() {
        let mut words = of_unconfirmed(open);
        let stand = report.motors.iter().filter(|motor| motor.confirmed);
        let stand: Vec<MotorId> = stand.map(|motor| motor.id).collect();
        if !stand.is_empty() {
            words.advice.push(terms::stopped(&stand));
        }
        if left_driven {
            let why = of_stop_reason(report.reason);
            words.advice.insert(0, why.to_owned());
        }
        return Some(words);
    }
    left_driven.then(|| of_left_driven(report))
}

/// Motors that were driven when the connection or their replies were lost were stopped, and have confirmed it.
fn of_left_driven(report: &StopReport) -> NoticeText {
    let ids: Vec<MotorId> = report.motors.iter().map(|motor| motor.id).collect();
    let why = of_stop_reason(report.reason);
    NoticeText::new(Topic::Stop, Tone::Warning, terms::stopped(&ids), &[why])
        .explained_at(HelpTopic::StoppedByItself)
}

/// These motors have not reported standstill.
pub(crate) fn of_unconfirmed(motors: impl Iterator<Item = StopOutcome>) -> NoticeText {
    let motors: Vec<String> = motors.map(of_unconfirmed_motor).collect();
    let title = tr!(
        "Standstill not confirmed: {motors}",
        motors = motors.join(", ")
    );
    let advice = tr!("Check the wheel. If it is turning, switch off the power.");
    NoticeText::new(Topic::Stop, Tone::Error, title, &[advice])
        .explained_at(HelpTopic::StopNotConfirmed)
}

fn of_unconfirmed_motor(motor: StopOutcome) -> String {
    let speed = motor
        .speed
        // Without a sign, because a mirrored motor has the opposite one.
        .map_or_else(
            || tr!("speed unknown").to_owned(),
            |speed| tr!("{speed} rpm", speed = speed.magnitude()),
        );
    tr!("motor {id} ({speed})", id = motor.id, speed)
}

fn of_lost_adapter(driven: &[MotorId]) -> NoticeText {
    let may_turn = match driven {
        [] => None,
        [id] => Some(tr!(
            "Motor {id} was running, and its wheel may keep turning. Only the power switch stops it \
             now. Keep clear.",
            id
        )),
        ids => Some(tr!(
            "{count} motors were running, and their wheels may keep turning. Only the power switch \
             stops them now. Keep clear.",
            count = ids.len()
        )),
    };
    let mut words = NoticeText::new(Topic::Port, Tone::Error, tr!("Adapter unplugged"), &[])
        .explained_at(HelpTopic::StoppedByItself);
    let plug = if may_turn.is_some() {
        tr!("Plug it back in. The page reconnects and stops what was running first.")
    } else {
        tr!("Plug it back in. The page reconnects, but no motor starts until you press Start.")
    };
    words.advice.extend(may_turn);
    words.advice.push(plug.to_owned());
    words
}

/// The worker itself has failed.
pub(crate) fn of_dead_worker(driven: bool) -> NoticeText {
    let may_turn = tr!(
        "No frames are sent any more: a wheel that was running may keep turning. Only the power \
         switch stops it now."
    );
    let mut words = NoticeText::new(
        Topic::Worker,
        Tone::Error,
        tr!("The background worker has stopped"),
        &[tr!("Reload the page to continue.")],
    );
    if driven {
        words.advice.insert(0, may_turn.to_owned());
    }
    words.remedy = Some(Remedy::Reload);
    words.explained_at(HelpTopic::StoppedByItself)
}

/// The texts of a language could not be fetched.
pub(crate) fn of_missing_language(language: Language) -> NoticeText {
    NoticeText::new(
        Topic::Export,
        Tone::Warning,
        tr!("{language} could not be loaded", language = language.name()),
        &[tr!(
            "Check the network connection, then choose the language again."
        )],
    )
}

/// Another motor was chosen while one was driven.
pub(crate) fn of_choice_while_driven(before: MotorId, chosen: MotorId) -> NoticeText {
    NoticeText::new(
        Topic::Choice,
        Tone::Calm,
        tr!("Stopping motor {before}", before),
        &[&tr!(
            "You selected motor {chosen}. This stops the motor that was running.",
            chosen
        )],
    )
}

/// Why all motors are stopped, in the words of the dialog.
pub(crate) fn of_stop_reason(reason: StopReason) -> &'static str {
    match reason {
        StopReason::Operator => tr!("STOP was pressed."),
        StopReason::PageHidden => tr!("The page was hidden, and Keep driving while hidden is off."),
        StopReason::PageGone => tr!("The page was closed, reloaded or frozen."),
        StopReason::PageSilent => tr!("The page did not respond for 1 s."),
        StopReason::OperatorLost => tr!("Remote control ended."),
        StopReason::ComputerSlept => tr!("The computer slept; motors were stopped."),
        StopReason::LoopDelayed => {
            tr!("The computer was too busy; motors were stopped.")
        }
        StopReason::Disconnect => tr!("The port was closed."),
        StopReason::OneMotor => tr!("A motor was stopped."),
        StopReason::Job => tr!("A bus scan is starting."),
        StopReason::OtherModel => tr!("A motor of another model answered."),
        StopReason::LeftDriven => {
            tr!("Motors may have kept running while they could not be reached.")
        }
    }
}

#[cfg(test)]
#[path = "notice_texts_tests.rs"]
mod tests;
