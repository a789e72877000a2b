//! What scans and ID changes say when they end: what was found, and what to do.

use std::fmt::Write;

use motorlink_messages::{
    Notice,
    bus::{Command, IdChangeOutcome, IdQueryOutcome, ScanReport, SurveyStatus},
    protocol::{AssignableId, MotorId},
};

use crate::{
    help_topic::HelpTopic,
    notice_board::{Remedy, Tone, Topic, Words},
    words::WIRING,
};

/// More IDs than these are counted, not named.
const NAMED_MAX: usize = 8;

/// Why an ID is only changed on a bus with one motor.
const ONE_MOTOR_ONLY: &str =
    "Every motor that hears a new ID takes it: leave only the one connected that is to get it.";

fn words(tone: Tone, title: impl Into<String>, advice: &[&str]) -> Words {
    Words {
        topic: Topic::Survey,
        tone,
        title: title.into(),
        advice: advice.iter().map(|line| (*line).to_owned()).collect(),
        remedy: None,
        // What goes wrong with a scan is that nobody answers, or too many.
        help: match tone {
            _ if advice == WIRING => Some(HelpTopic::NoAnswer),
            Tone::Calm => None,
            Tone::Warning | Tone::Error => Some(HelpTopic::TwoMotorsOneId),
        },
    }
}

/// Whether this notice is one that the ID manager shows itself.
pub(crate) fn belongs_to_id_manager(notice: &Notice) -> bool {
    match notice {
        Notice::IdQueryEnded(_) | Notice::ScanEnded(_) | Notice::IdChangeEnded { .. } => true,
        Notice::Refused { command, .. } | Notice::TooLate(command) => is_survey(*command),
        _ => false,
    }
}

/// Whether this command asks who is there or changes an ID.
pub(crate) const fn is_survey(command: Command) -> bool {
    matches!(
        command,
        Command::IdQuery | Command::FullScan | Command::SetId { .. }
    )
}

/// Who answered the ID query.
pub(crate) fn of_id_query(outcome: IdQueryOutcome) -> Words {
    let said = match outcome {
        IdQueryOutcome::One(id) => words(
            Tone::Calm,
            format!("Motor {id} answers"),
            &["One clean answer. Full scan makes sure that there is no other."],
        ),
        IdQueryOutcome::Cancelled => words(
            Tone::Calm,
            "The ID query was not sent: a stop came first",
            &["Press Scan again."],
        ),
        IdQueryOutcome::Nobody => words(Tone::Warning, "No motor answers on this adapter", &WIRING),
        IdQueryOutcome::Garbled => Words {
            remedy: Some(Remedy::FullScan),
            ..words(
                Tone::Warning,
                "Several motors answered at once, or there is noise on the line",
                &[
                    "Full scan asks every address on its own and finds them all.",
                    "Only one motor on the line? Then check A and B, and put 120 Ω across them \
                     beyond 1 m.",
                ],
            )
        },
    };
    Words {
        topic: Topic::Answer,
        ..said
    }
}

/// How a full scan ended.
pub(crate) fn of_scan(report: &ScanReport) -> Words {
    let found = found(&report.found);
    if !report.complete {
        let title = format!("The scan was cancelled after {} addresses", report.asked);
        return words(Tone::Calm, title, &[&format!("Until then: {found}.")]);
    }
    if !report.noisy.is_empty() {
        let title = format!("Noise, but no clean answer at {}", ids(&report.noisy));
        let shared =
            "Two motors may share an ID there: connect one of them alone and give it another.";
        let line = "Else check A and B, and put 120 Ω across them beyond 1 m.";
        let rest = format!("Besides: {found}.");
        return words(Tone::Warning, title, &[shared, line, &rest]);
    }
    if report.found.is_empty() {
        return words(Tone::Warning, "No motor answers at any address", &WIRING);
    }
    let took = tenths_of_a_second(report.took_ms);
    let title = format!("Full scan: {found}");
    words(
        Tone::Calm,
        title,
        &[&format!(
            "All {} addresses were asked, in {took}.",
            report.asked
        )],
    )
}

/// A full scan that was to prove that one motor is there has not proved it.
pub(crate) fn of_no_proof(report: &ScanReport, to: AssignableId) -> Words {
    let unchanged = |why: &str| format!("The ID was not changed: {why}");
    if !report.complete {
        let advice = "Only a whole scan proves that one motor is there. Press Set ID again.";
        return words(Tone::Calm, unchanged("the scan was cancelled"), &[advice]);
    }
    if !report.noisy.is_empty() {
        let noise = format!("noise at {}", ids(&report.noisy));
        let advice = "Two motors may share an ID there, or the line is bad.";
        return words(Tone::Warning, unchanged(&noise), &[advice, ONE_MOTOR_ONLY]);
    }
    match report.found.as_slice() {
        [] => words(Tone::Warning, unchanged("no motor answers"), &WIRING),
        [only] => words(
            Tone::Calm,
            format!("Motor {only} has this ID already"),
            &[&format!(
                "{} is {only}: there is nothing to change.",
                to.id().get()
            )],
        ),
        several => {
            let count = format!("{} motors answer, {}", several.len(), ids(several));
            words(Tone::Warning, unchanged(&count), &[ONE_MOTOR_ONLY])
        }
    }
}

/// How an ID change ended.
pub(crate) fn of_id_change(from: MotorId, to: AssignableId, outcome: IdChangeOutcome) -> Words {
    let to = to.id();
    let unchanged = |why: &str| format!("The ID was not changed: {why}");
    match outcome {
        IdChangeOutcome::Changed => words(
            Tone::Calm,
            format!("Motor {from} is motor {to} now"),
            &[
                "The new ID answers and the old one is silent. The motor keeps it through power-off.",
                "To change it again, switch the motor's power off and on first.",
            ],
        ),
        IdChangeOutcome::Kept => words(
            Tone::Warning,
            format!("Motor {from} kept its ID"),
            &[
                "It has taken an ID since power-up already (its firmware allows one), or it did not \
                 hear five frames in a row.",
                "Switch its power off and on, then press Set ID again.",
            ],
        ),
        IdChangeOutcome::Lost => words(
            Tone::Error,
            format!("Neither {from} nor {to} answers"),
            &["Check the motor's power and plugs, then press Full scan to see which ID it has."],
        )
        .explained_at(HelpTopic::NoAnswer),
        IdChangeOutcome::Both => words(
            Tone::Error,
            format!("Both {from} and {to} answer: there is more than one motor"),
            &["Press Full scan to see who is there.", ONE_MOTOR_ONLY],
        ),
        IdChangeOutcome::NotAlone => words(
            Tone::Warning,
            unchanged("the line is not as the scan found it"),
            &[
                "Nothing was sent. A motor was added or removed, or the answer was lost.",
                ONE_MOTOR_ONLY,
            ],
        ),
        IdChangeOutcome::NotStopped => words(
            Tone::Error,
            unchanged("a motor did not confirm its stop"),
            &["Nothing was sent. Look at the wheel; if it turns, switch its power off."],
        )
        .explained_at(HelpTopic::StopNotConfirmed),
        IdChangeOutcome::Cancelled { frames_sent: 0 } => words(
            Tone::Calm,
            unchanged("it was cancelled"),
            &["Nothing was sent."],
        ),
        IdChangeOutcome::Cancelled { frames_sent } => words(
            Tone::Warning,
            format!("The ID change was cut short after {frames_sent} frames"),
            &[&format!(
                "The motor may have either ID, {from} or {to}: press Full scan to see which."
            )],
        ),
    }
}

/// How far a scan or ID change is.
pub(crate) fn of_progress(survey: Option<&SurveyStatus>) -> String {
    match survey {
        None => "No scan is running; a scan first stops what is driven".to_owned(),
        Some(SurveyStatus::Stopping) => "What is driven is stopped first".to_owned(),
        Some(SurveyStatus::Scanning {
            asked, of, left_ms, ..
        }) => {
            // Rounded up: nobody minds a scan that is over sooner.
            let left = left_ms.div_ceil(1_000).max(1);
            format!("{asked} of {of}, about {left} s left")
        }
        Some(SurveyStatus::SettingId { from, to }) => {
            format!("Motor {from} is being given ID {}", to.id())
        }
    }
}

/// `motor 0x01 answers`, `3 motors answer, 0x01, 0x02, 0x07`.
fn found(motors: &[MotorId]) -> String {
    match motors {
        [] => "no motor answers".to_owned(),
        [only] => format!("motor {only} answers"),
        several => format!("{} motors answer, {}", several.len(), ids(several)),
    }
}

fn ids(motors: &[MotorId]) -> String {
    let mut text = String::new();
    for id in motors.iter().take(NAMED_MAX) {
        if !text.is_empty() {
            text.push_str(", ");
        }
        text.push_str(&id.to_string());
    }
    if motors.len() > NAMED_MAX {
        let _ = write!(text, " and {} more", motors.len() - NAMED_MAX);
    }
    text
}

/// `2.1 s`
fn tenths_of_a_second(millis: u32) -> String {
    let tenths = millis.div_ceil(100);
    format!("{}.{} s", tenths / 10, tenths % 10)
}

#[cfg(test)]
#[path = "scan_words_tests.rs"]
pub(crate) mod tests;
