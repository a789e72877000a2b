//! Names of axes, figures as text, and how a run ended.

use motorlink_i18n::tr;
use motorlink_messages::experiments::{
    analysis::{Invalid, SetpointRate},
    kept::{Outcome, RunHeader},
    runner::End,
    study::Study,
};

use crate::{
    features::experiments::{kept::KeptRuns, texts},
    ui::{
        clock::{local_date, local_time},
        format::{self, UNKNOWN},
    },
};

/// `Acceleration 3`
pub(super) fn acceleration(byte: u8) -> String {
    tr!("Acceleration {value}", value = byte)
}

/// How a run ended.
pub(super) fn outcome(outcome: Outcome) -> String {
    match outcome {
        Outcome::Running => tr!("Running").to_owned(),
        Outcome::Ended(End::Finished { .. }) => tr!("Finished").to_owned(),
        Outcome::Ended(end) => texts::end(end, None),
        Outcome::PageClosed => tr!("Aborted: the page was closed").to_owned(),
    }
}

/// How a run ended, and whether data of it is missing.
pub(super) fn end(kept: KeptRuns, run: &RunHeader) -> String {
    let ended = outcome(run.outcome);
    if kept.is_incomplete(run.number) {
        let missing = tr!("A part of the data could not be stored and is missing.");
        format!("{ended} · {missing}")
    } else {
        ended
    }
}

/// Why a point of a Bode plot is invalid.
pub(super) fn invalid(why: Invalid) -> &'static str {
    match why {
        Invalid::TooShort => tr!("too few periods or replies"),
        Invalid::RepliesLost => tr!("too many replies lost"),
        Invalid::Saturated => tr!("the current was at its limit"),
        Invalid::Clipped => tr!("the setpoint was clipped"),
        Invalid::TooSmall => tr!("the response is smaller than 1 rpm"),
        Invalid::Noisy => tr!("too much noise"),
    }
}

/// `motor 1 (front left), ddsm115`
pub(super) fn motors(run: &RunHeader) -> String {
    let motors: Vec<String> = run
        .motors
        .iter()
        .map(|(id, name)| {
            if name.is_empty() {
                id.get().to_string()
            } else {
                format!("{} ({name})", id.get())
            }
        })
        .collect();
    motors.join(", ")
}

/// What tells a run from others beside it: `Step response, 1 (front left), 27/11/2026 14:02:11`.
pub(super) fn legend(run: &RunHeader) -> String {
    format!("{}, {}, {}", run.name, motors(run), date(run))
}

/// What was asked of each motor and what the line carried; `None` if the record does not tell it.
pub(super) fn setpoint_rate(
    run: &RunHeader,
    rates: &[Option<SetpointRate>],
) -> Option<(String, String)> {
    let asked = texts::number(run.request_hz);
    let of_motor = |rate: &Option<SetpointRate>| {
        rate.map_or_else(|| UNKNOWN.to_owned(), |rate| number(rate.achieved_hz, 1))
    };
    let achieved = rates.iter().map(of_motor);
    let achieved = achieved.collect::<Vec<_>>().join(", ");
    rates.iter().any(Option::is_some).then(|| {
        (
            tr!("Setpoints a second").to_owned(),
            tr!("asked {asked}, achieved {achieved}", asked, achieved),
        )
    })
}

/// The accelerations of step responses: `1, 5`.
pub(super) fn accelerations(study: &Study) -> Option<String> {
    let Study::Step(study) = study else {
        return None;
    };
    let bytes = study.accelerations.iter().map(|one| one.byte().to_string());
    Some(bytes.collect::<Vec<_>>().join(", "))
}

/// The local date and time of its start.
pub(super) fn date(run: &RunHeader) -> String {
    let ms = run.began_unix_ms;
    format!("{} {}", local_date(ms), local_time(ms))
}

/// A figure in the language of the page; a rounded zero has no sign.
pub(super) fn number(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let is_zero = text.bytes().all(|byte| matches!(byte, b'0' | b'.' | b'-'));
    let text = if is_zero {
        text.replace('-', "")
    } else {
        text.replace('-', "\u{2212}")
    };
    format::in_language(text)
}
