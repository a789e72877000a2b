//! What scans and ID changes say when they end: what was found, and what to do.

use motorlink_i18n::tr;
use motorlink_messages::{
    Notice,
    bus::{Command, IdChangeOutcome, IdQueryOutcome, ScanReport, SurveyStatus},
    protocol::{AssignableId, MotorId},
};

use crate::{
    model::{
        help_topic::HelpTopic,
        notice_board::{NoticeText, Remedy, Tone, Topic},
    },
    ui::format::in_language,
};

/// More IDs than these are counted, not named.
const NAMED_MAX: usize = 8;

/// Why an ID is only changed on a bus with one motor.
fn one_motor_only() -> &'static str {
    tr!("Every motor that hears a new ID takes it: leave only the one connected that is to get it.")
}

fn text(tone: Tone, title: impl Into<String>, advice: &[&str]) -> NoticeText {
    NoticeText {
        topic: Topic::Survey,
        tone,
        title: title.into(),
        advice: advice.iter().map(|line| (*line).to_owned()).collect(),
        remedy: None,
        // What goes wrong with a scan is that nobody answers, or too many.
        help: match tone {
            _ if advice == wiring() => Some(HelpTopic::NoAnswer),
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
pub(crate) fn of_id_query(outcome: IdQueryOutcome) -> NoticeText {
    let said = match outcome {
        IdQueryOutcome::One(id) => text(
            Tone::Calm,
            tr!("Motor {id} answers", id),
            &[tr!(
                "One clean answer. Full scan makes sure that there is no other."
            )],
        ),
        IdQueryOutcome::Cancelled => text(
            Tone::Calm,
            tr!("The ID query was not sent: a stop came first"),
            &[tr!("Press Scan again.")],
        ),
        IdQueryOutcome::Nobody => text(
            Tone::Warning,
            tr!("No motor answers on this adapter"),
            &wiring(),
        ),
        IdQueryOutcome::Garbled => NoticeText {
            remedy: Some(Remedy::FullScan),
            ..text(
                Tone::Warning,
                tr!("Several motors answered at once, or there is noise on the line"),
                &[
                    tr!("Full scan asks every address on its own and finds them all."),
                    tr!(
                        "Only one motor on the line? Then check A and B, and put 120 Ω across them \
                     beyond 1 m."
                    ),
                ],
            )
        },
    };
    NoticeText {
        topic: Topic::Answer,
        ..said
    }
}

/// How a full scan ended.
pub(crate) fn of_scan(report: &ScanReport) -> NoticeText {
    let found = found(&report.found);
    if !report.complete {
        let title = tr!(
            "The scan was cancelled after {count} addresses",
            count = report.asked
        );
        return text(Tone::Calm, title, &[&tr!("Until then: {found}.", found)]);
    }
    if !report.noisy.is_empty() {
        let title = tr!(
            "Noise, but no clean answer at {ids}",
            ids = ids(&report.noisy)
        );
        let shared =
            tr!("Two motors may share an ID there: connect one of them alone and give it another.");
        let line = tr!("Else check A and B, and put 120 Ω across them beyond 1 m.");
        let rest = tr!("Besides: {found}.", found);
        return text(Tone::Warning, title, &[shared, line, &rest]);
    }
    if report.found.is_empty() {
        return text(
            Tone::Warning,
            tr!("No motor answers at any address"),
            &wiring(),
        );
    }
    let took = tenths_of_a_second(report.took_ms);
    let title = tr!("Full scan: {found}", found);
    text(
        Tone::Calm,
        title,
        &[&tr!(
            "All {count} addresses were asked, in {took}.",
            count = report.asked,
            took
        )],
    )
}

/// A full scan that was to prove that one motor is there has not proved it.
pub(crate) fn of_no_proof(report: &ScanReport, to: AssignableId) -> NoticeText {
    let unchanged = |why: &str| tr!("The ID was not changed: {why}", why);
    if !report.complete {
        let advice = tr!("Only a whole scan proves that one motor is there. Press Set ID again.");
        return text(
            Tone::Calm,
            unchanged(tr!("the scan was cancelled")),
            &[advice],
        );
    }
    if !report.noisy.is_empty() {
        let noise = tr!("noise at {ids}", ids = ids(&report.noisy));
        let advice = tr!("Two motors may share an ID there, or the line is bad.");
        return text(
            Tone::Warning,
            unchanged(&noise),
            &[advice, one_motor_only()],
        );
    }
    match report.found.as_slice() {
        [] => text(Tone::Warning, unchanged(tr!("no motor answers")), &wiring()),
        [only] => text(
            Tone::Calm,
            tr!("Motor {only} has this ID already", only),
            &[&tr!(
                "{number} is {only}: there is nothing to change.",
                number = to.id().get(),
                only
            )],
        ),
        several => {
            let count = several_answer(several);
            text(Tone::Warning, unchanged(&count), &[one_motor_only()])
        }
    }
}

/// How an ID change ended.
pub(crate) fn of_id_change(
    from: MotorId,
    to: AssignableId,
    outcome: IdChangeOutcome,
) -> NoticeText {
    let to = to.id();
    let unchanged = |why: &str| tr!("The ID was not changed: {why}", why);
    match outcome {
        IdChangeOutcome::Changed => text(
            Tone::Calm,
            tr!("Motor {from} is motor {to} now", from, to),
            &[
                tr!(
                    "The new ID answers and the old one is silent. The motor keeps it through power-off."
                ),
                tr!("To change it again, switch the motor's power off and on first."),
            ],
        ),
        IdChangeOutcome::Kept { frames } => {
            let why = tr!(
                "It has taken an ID since power-up already (its firmware allows one), or {count} frames \
                 in a row are too few for it.",
                count = frames.count()
            );
            let power = tr!("Switch its power off and on, then press Set ID again.");
            let more = frames.more().map(|more| {
                tr!(
                    "Or press Send {count} frames: some motors take more.",
                    count = more.count()
                )
            });
            let advice = [&*why, power].into_iter().chain(more.as_deref());
            let advice: Vec<&str> = advice.collect();
            text(
                Tone::Warning,
                tr!("Motor {from} kept its ID", from),
                &advice,
            )
        }
        IdChangeOutcome::Lost => text(
            Tone::Error,
            tr!("Neither {from} nor {to} answers", from, to),
            &[tr!(
                "Check the motor's power and plugs, then press Full scan to see which ID it has."
            )],
        )
        .explained_at(HelpTopic::NoAnswer),
        IdChangeOutcome::Both => text(
            Tone::Error,
            tr!(
                "Both {from} and {to} answer: there is more than one motor",
                from,
                to
            ),
            &[
                tr!("Press Full scan to see who is there."),
                one_motor_only(),
            ],
        ),
        IdChangeOutcome::NotAlone => text(
            Tone::Warning,
            unchanged(tr!("the line is not as the scan found it")),
            &[
                tr!("Nothing was sent. A motor was added or removed, or the answer was lost."),
                one_motor_only(),
            ],
        ),
        IdChangeOutcome::NotStopped => text(
            Tone::Error,
            unchanged(tr!("a motor did not confirm its stop")),
            &[tr!(
                "Nothing was sent. Look at the wheel; if it turns, switch its power off."
            )],
        )
        .explained_at(HelpTopic::StopNotConfirmed),
        IdChangeOutcome::Cancelled { frames_sent: 0 } => text(
            Tone::Calm,
            unchanged(tr!("it was cancelled")),
            &[tr!("Nothing was sent.")],
        ),
        IdChangeOutcome::Cancelled { frames_sent } => text(
            Tone::Warning,
            tr!(
                "The ID change was cut short after {frames_sent} frames",
                frames_sent
            ),
            &[&tr!(
                "The motor may have either ID, {from} or {to}: press Full scan to see which.",
                from,
                to
            )],
        ),
    }
}

/// How far a scan or ID change is.
pub(crate) fn of_progress(survey: Option<&SurveyStatus>) -> String {
    match survey {
        None => tr!("No scan is running; a scan first stops what is driven").to_owned(),
        Some(SurveyStatus::Stopping) => tr!("What is driven is stopped first").to_owned(),
        Some(SurveyStatus::Scanning {
            asked, of, left_ms, ..
        }) => {
            // Rounded up: nobody minds a scan that is over sooner.
            let left = left_ms.div_ceil(1_000).max(1);
            tr!("{asked} of {of}, about {left} s left", asked, of, left)
        }
        Some(SurveyStatus::SettingId { from, to }) => {
            tr!("Motor {from} is being given ID {to}", from, to = to.id())
        }
    }
}

/// `motor 0x01 answers`, `3 motors answer, 0x01, 0x02, 0x07`.
fn found(motors: &[MotorId]) -> String {
    match motors {
        [] => tr!("no motor answers").to_owned(),
        [only] => tr!("motor {only} answers", only),
        several => several_answer(several),
    }
}

fn several_answer(motors: &[MotorId]) -> String {
    tr!(
        "{count} motors answer, {ids}",
        count = motors.len(),
        ids = ids(motors)
    )
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
        let count = motors.len() - NAMED_MAX;
        return tr!("{ids} and {count} more", ids = text, count);
    }
    text
}

/// `2.1 s`
fn tenths_of_a_second(millis: u32) -> String {
    let tenths = millis.div_ceil(100);
    in_language(format!("{}.{} s", tenths / 10, tenths % 10))
}

/// What to check where nobody answers, in the order in which it is mostly the reason.
pub(crate) fn wiring() -> [&'static str; 4] {
    [
        tr!("Is the motor's 18 V supply on?"),
        tr!("Is the brown wire tied to GND?"),
        tr!("Swap orange and white: adapters label A and B both ways."),
        tr!("Is it the right ID? Choose another in the list Motor."),
    ]
}

#[cfg(test)]
#[path = "scan_texts_tests.rs"]
pub(crate) mod tests;
