//! Texts about the results of scans and ID changes.

use motorlink_diagnosis::texts::{blocks, no_blocks};
use motorlink_i18n::tr;
use motorlink_messages::{
    Notice,
    bus::{CommandKind, IdChangeOutcome, IdQueryOutcome, JobStatus, ScanFault, ScanReport},
    protocol::{AssignableId, MotorId},
};

use crate::{
    model::{
        help_topic::HelpTopic,
        notice_board::{NoticeText, Remedy, Tone, Topic},
    },
    ui::format::in_language,
};

/// More IDs than this are counted instead of named.
const NAMED_MAX: usize = 8;

/// So many addresses with noise, and no motor: no ID is shared so often.
const NOISY_EVERYWHERE: usize = 100;

/// Why an ID is only changed on a bus with one motor.
fn one_motor_only() -> &'static str {
    tr!("A new ID reaches every motor on the bus: connect only the motor to change.")
}

fn text(tone: Tone, title: impl Into<String>, advice: &[&str]) -> NoticeText {
    NoticeText {
        topic: Topic::Survey,
        tone,
        title: title.into(),
        advice: advice.iter().map(|line| (*line).to_owned()).collect(),
        remedy: None,
        // A scan fails if no motor or too many motors answer.
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

/// Whether this command is a scan, an ID query or an ID change.
pub(crate) const fn is_survey(command: CommandKind) -> bool {
    matches!(
        command,
        CommandKind::IdQuery | CommandKind::FullScan | CommandKind::SetId
    )
}

/// The result of the ID query.
pub(crate) fn of_id_query(outcome: IdQueryOutcome) -> NoticeText {
    let said = match outcome {
        IdQueryOutcome::One(id) => text(
            Tone::Calm,
            tr!("Motor {id} found", id),
            &[tr!(
                "One valid reply. Run Full scan to rule out other motors."
            )],
        ),
        IdQueryOutcome::Cancelled => text(
            Tone::Calm,
            tr!("A stop cancelled the ID query"),
            &[tr!("Press Scan again.")],
        ),
        IdQueryOutcome::NoReply => text(
            Tone::Warning,
            tr!("No motors found on this adapter"),
            &wiring(),
        ),
        IdQueryOutcome::Garbled => NoticeText {
            remedy: Some(Remedy::FullScan),
            ..text(
                Tone::Warning,
                tr!("Several motors replied at once, or there is noise on the bus"),
                &[
                    tr!("Full scan queries each address in turn and finds every motor."),
                    tr!(
                        "Only one motor on the bus? Check A and B. If the bus is longer than 1 m, \
                         add 120 Ω across them."
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

/// The result of a full scan.
pub(crate) fn of_scan(report: &ScanReport) -> NoticeText {
    let found = found(&report.found);
    if !report.complete {
        let title = tr!(
            "Scan cancelled after {count} addresses",
            count = report.asked
        );
        return text(Tone::Calm, title, &[&tr!("Before that: {found}.", found)]);
    }
    let is_noisy = report.noisy.len() >= NOISY_EVERYWHERE && report.found.is_empty();
    match report.fault {
        Some(ScanFault::Blocks) => {
            let found = tr!("Full scan: {found}", found);
            return text(Tone::Warning, blocks(), &[no_blocks(), &found])
                .explained_at(HelpTopic::DamagedBytes);
        }
        fault if fault == Some(ScanFault::Floating) || is_noisy => {
            return text(
                Tone::Warning,
                tr!("Bytes without a motor: the bus floats"),
                &[tr!(
                    "Nothing holds A and B at a level. Connect the motor and its supply, or use an adapter \
                     with bias resistors."
                )],
            )
            .explained_at(HelpTopic::DamagedBytes);
        }
        _ => {}
    }
    if !report.noisy.is_empty() {
        let title = tr!(
            "Noise, but no valid reply at {ids}",
            ids = ids(&report.noisy)
        );
        let shared = tr!("Two motors may share an ID. Connect only one of them and change its ID.");
        let line =
            tr!("Otherwise check A and B. If the bus is longer than 1 m, add 120 Ω across them.");
        let rest = tr!("Also: {found}.", found);
        return text(Tone::Warning, title, &[shared, line, &rest]);
    }
    if report.found.is_empty() {
        return text(
            Tone::Warning,
            tr!("No motors found at any address"),
            &wiring(),
        );
    }
    let took = tenths_of_a_second(report.took_ms);
    let title = tr!("Full scan: {found}", found);
    text(
        Tone::Calm,
        title,
        &[&tr!(
            "Queried all {count} addresses in {took}.",
            count = report.asked,
            took
        )],
    )
}

/// A full scan before an ID change did not prove that there is only one motor.
pub(crate) fn of_no_proof(report: &ScanReport, to: AssignableId) -> NoticeText {
    let unchanged = |why: &str| tr!("The ID was not changed: {why}", why);
    if !report.complete {
        let advice = tr!("Only a complete scan can confirm a single motor. Press Set ID again.");
        return text(
            Tone::Calm,
            unchanged(tr!("the scan was cancelled")),
            &[advice],
        );
    }
    if report.fault == Some(ScanFault::Blocks) {
        return text(Tone::Warning, unchanged(blocks()), &[no_blocks()])
            .explained_at(HelpTopic::DamagedBytes);
    }
    if !report.noisy.is_empty() {
        let noise = tr!("noise at {ids}", ids = ids(&report.noisy));
        let advice = tr!("Two motors may share an ID, or the bus is faulty.");
        return text(
            Tone::Warning,
            unchanged(&noise),
            &[advice, one_motor_only()],
        );
    }
    match report.found.as_slice() {
        [] => text(Tone::Warning, unchanged(tr!("no motors found")), &wiring()),
        [only] => text(
            Tone::Calm,
            tr!("Motor {only} already has this ID", only),
            &[&tr!(
                "{number} is {only}: nothing to change.",
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

/// The result of an ID change.
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
            tr!("Motor {from} now has ID {to}", from, to),
            &[
                tr!(
                    "The motor replies to the new ID and no longer to the old one. The ID survives \
                     power-off."
                ),
                tr!("To change the ID again, power-cycle the motor first."),
            ],
        ),
        IdChangeOutcome::Kept { frames } => {
            let why = tr!(
                "The ID was already changed since power-up (the firmware allows one change), or \
                 the motor needs more than {count} frames in a row.",
                count = frames.count()
            );
            let power = tr!("Power-cycle the motor, then press Set ID again.");
            let more = frames.more().map(|more| {
                tr!(
                    "Or press Send {count} frames: some motors need more.",
                    count = more.count()
                )
            });
            let advice = [&*why, power].into_iter().chain(more.as_deref());
            let advice: Vec<&str> = advice.collect();
            text(
                Tone::Warning,
                tr!("Motor {from} did not change its ID", from),
                &advice,
            )
        }
        IdChangeOutcome::Lost => text(
            Tone::Error,
            tr!("No reply from {from} or {to}", from, to),
            &[tr!(
                "Check the motor's power and plugs, then press Full scan to find its ID."
            )],
        )
        .explained_at(HelpTopic::NoAnswer),
        IdChangeOutcome::Both => text(
            Tone::Error,
            tr!(
                "Both {from} and {to} reply: more than one motor is connected",
                from,
                to
            ),
            &[tr!("Press Full scan to find all motors."), one_motor_only()],
        ),
        IdChangeOutcome::NotAlone => text(
            Tone::Warning,
            unchanged(tr!("the bus has changed since the scan")),
            &[
                tr!("Nothing was sent. A motor was added or removed, or a reply was lost."),
                one_motor_only(),
            ],
        ),
        IdChangeOutcome::NotStopped => text(
            Tone::Error,
            unchanged(tr!("a motor did not confirm the stop")),
            &[tr!(
                "Nothing was sent. Check the wheel: if it is turning, switch off the power."
            )],
        )
        .explained_at(HelpTopic::StopNotConfirmed),
        IdChangeOutcome::Cancelled { frames_sent: 0 } => text(
            Tone::Calm,
            unchanged(tr!("cancelled")),
            &[tr!("Nothing was sent.")],
        ),
        IdChangeOutcome::Cancelled { frames_sent } => text(
            Tone::Warning,
            tr!(
                "ID change cancelled after {frames_sent} frames",
                frames_sent
            ),
            &[&tr!(
                "The ID may be {from} or {to}. Press Full scan to check.",
                from,
                to
            )],
        ),
    }
}

/// The progress of a scan or ID change.
pub(crate) fn of_progress(job: Option<&JobStatus>) -> String {
    match job {
        None => tr!("No scan running. A scan stops all motors first.").to_owned(),
        Some(JobStatus::Stopping) => tr!("Stopping motors first").to_owned(),
        Some(JobStatus::Scanning {
            asked, of, left_ms, ..
        }) => {
            // Rounded up: a scan may end sooner than shown.
            let left = left_ms.div_ceil(1_000).max(1);
            tr!("{asked} of {of}, about {left} s left", asked, of, left)
        }
        Some(JobStatus::SettingId { from, to }) => {
            tr!("Changing motor {from} to ID {to}", from, to = to.id())
        }
    }
}

/// `motor 0x01 found`, `3 motors found (0x01, 0x02, 0x07)`.
fn found(motors: &[MotorId]) -> String {
    match motors {
        [] => tr!("no motors found").to_owned(),
        [only] => tr!("motor {only} found", only),
        several => several_answer(several),
    }
}

fn several_answer(motors: &[MotorId]) -> String {
    tr!(
        "{count} motors found ({ids})",
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

/// What to check if no motor answers, the most frequent cause first.
pub(crate) fn wiring() -> [&'static str; 4] {
    [
        tr!("Is the motor's supply on? A DDSM115 needs 18 V."),
        tr!(
            "DDSM115: is the brown wire tied to GND? Swap orange and white: some adapters label A and B \
             the other way round."
        ),
        tr!("Another model: compare its bus and wires with Help (?)."),
        tr!("Is the ID correct? Select another one in the Motor list."),
    ]
}

#[cfg(test)]
#[path = "scan_texts_tests.rs"]
pub(crate) mod tests;
