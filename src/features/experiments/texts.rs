//! What the panel says about errors of a sequence, refusals and ends of runs.

use motorlink_i18n::tr;
use motorlink_messages::{
    bus::CarriedRate,
    experiments::{
        chart::AxisName,
        runner::{Cause, End, ExceededLimit, StartRefusal},
        sequence::{Problem, Quantity, RunLimits, Sequence, SequenceError, Template},
        study::StudyKind,
    },
    protocol::MotorId,
    runs::NotArmed,
};

use crate::{model::terms, ui::format};

/// A number with at most three decimals, in the language.
pub(super) fn number(value: f64) -> String {
    let text = format!("{value:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    format::in_language(text.replace('-', "\u{2212}"))
}

/// The same, with a sign for directions.
pub(super) fn signed(value: f64) -> String {
    let sign = if value > 0.0 { "+" } else { "" };
    format!("{sign}{}", number(value))
}

/// The unit of a quantity.
pub(super) fn unit(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Rpm => format::rpm(),
        Quantity::Amps => "A",
        Quantity::Degrees => "°",
    }
}

/// The name of an axis with its unit.
pub(super) fn axis(name: AxisName) -> String {
    let (name, unit) = match name {
        AxisName::Time => (tr!("Time"), "s"),
        AxisName::Speed => (tr!("Speed"), format::rpm()),
        AxisName::Current => (tr!("Current" as "electric"), "A"),
        AxisName::Temperature => (tr!("Temperature"), "°C"),
        AxisName::Frequency => (tr!("Frequency"), "Hz"),
        AxisName::Gain => (tr!("Gain"), "dB"),
        AxisName::Phase => (tr!("Phase"), "°"),
        AxisName::Position => (tr!("Position"), "°"),
        AxisName::RSquared => return tr!("R² of the sine").to_owned(),
    };
    format!("{name} ({unit})")
}

/// `38 s`, `5 min 20 s`, `2 h 5 min`
pub(super) fn duration(seconds: f64) -> String {
    if seconds < 60.0 {
        return tr!(
            "{seconds} s",
            seconds = number((seconds * 10.0).round() / 10.0)
        );
    }
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a float cast saturates, and a run takes a day at most"
    )]
    let whole = seconds.round() as u64;
    let (hours, minutes, seconds) = (whole / 3600, whole / 60 % 60, whole % 60);
    if hours == 0 {
        tr!("{minutes} min {seconds} s", minutes, seconds)
    } else {
        tr!("{hours} h {minutes} min", hours, minutes)
    }
}

pub(super) fn template(template: Template) -> &'static str {
    match template {
        Template::WarmUp => tr!("Warm-up"),
        Template::BackAndForth => tr!("Back and forth"),
        Template::Staircase => tr!("Staircase"),
        Template::SineSweep => tr!("Sine sweep"),
        Template::PositionTour => tr!("Position tour"),
        Template::Endurance => tr!("Endurance"),
    }
}

/// The sequence of a template, named in the language of the page.
pub(super) fn of_template(template: Template) -> Sequence {
    let mut sequence = template.sequence();
    self::template(template).clone_into(&mut sequence.name);
    sequence
}

pub(super) fn study(kind: StudyKind) -> &'static str {
    match kind {
        StudyKind::Sequence => tr!("Sequence"),
        StudyKind::Step => tr!("Step response"),
        StudyKind::Frequency => tr!("Frequency response"),
        StudyKind::Friction => tr!("Friction"),
        StudyKind::CoastDown => tr!("Coast down"),
        StudyKind::Heating => tr!("Heating"),
        StudyKind::TorqueSpeed => tr!("Torque and speed"),
        StudyKind::Silence => terms::when_frames_cease(),
    }
}

/// `90`, or `about 90`.
pub(super) fn rate(carried: CarriedRate) -> String {
    let rate = format!("{:.0}", carried.hertz);
    if carried.is_about {
        tr!("about {rate}", rate)
    } else {
        rate
    }
}

/// `150 rpm, 2.7 A, 60 °C`
pub(super) fn limits(limits: RunLimits) -> String {
    let RunLimits { rpm, amps, celsius } = limits;
    let text = |limit: Option<f64>| limit.map_or_else(|| format::UNKNOWN.to_owned(), number);
    let (rpm, amps, celsius) = (text(rpm), text(amps), text(celsius));
    format!("{rpm} {}, {amps} A, {celsius} °C", format::rpm())
}

/// The name and the unit of a parameter of a study.
pub(super) fn parameter(name: &str) -> (&'static str, &'static str) {
    match name {
        "from_rpm" => (tr!("From"), format::rpm()),
        "to_rpm" => (tr!("To"), format::rpm()),
        "repeats" => (tr!("Repeats"), ""),
        "hold_s" => (tr!("Hold"), "s"),
        "rest_s" => (tr!("Rest"), "s"),
        "lowest_hz" => (tr!("Lowest frequency"), "Hz"),
        "highest_hz" => (tr!("Highest frequency"), "Hz"),
        "points" => (tr!("Points"), ""),
        "amplitude_rpm" => (tr!("Amplitude"), format::rpm()),
        "centre_rpm" => (tr!("Mean speed"), format::rpm()),
        "highest_rpm" => (tr!("Highest speed"), format::rpm()),
        "speeds" => (tr!("Speeds in each direction"), ""),
        "push_amps" => (tr!("Push current"), "A"),
        "speed_rpm" => (tr!("Speed"), format::rpm()),
        "amps" => (tr!("Current" as "electric"), "A"),
        "for_s" => (tr!("Duration"), "s"),
        "celsius_max" => (tr!("Highest temperature"), "°C"),
        "loaded_max_rpm" => (tr!("Speed limit"), format::rpm()),
        _ => ("", ""),
    }
}

/// What a study needs of the person.
pub(super) fn advice(kind: StudyKind) -> &'static str {
    match kind {
        StudyKind::Sequence => "",
        StudyKind::Step => {
            tr!("The wheel turns freely. Each repeat goes from one speed to the other.")
        }
        StudyKind::Frequency => {
            tr!("The wheel turns freely. Each frequency gets a sine of its own.")
        }
        StudyKind::Friction => tr!(
            "The wheel turns freely at even speeds in both directions. Current over speed gives the friction."
        ),
        StudyKind::CoastDown => tr!(
            "The wheel turns freely. A known current pushes it, then it coasts: this gives inertia and friction."
        ),
        StudyKind::Heating => tr!(
            "Load the wheel so that it turns slowly. If it is blocked, its stall protection ends the run after 5 s. A constant current heats the winding."
        ),
        StudyKind::TorqueSpeed => tr!(
            "The wheel turns at one speed. Leave it free for the first 8 s, then load it more and more with a brake. Keep hands, gloves and hair clear."
        ),
        StudyKind::Silence => tr!(
            "The wheel turns freely at 30 rpm. Drive frames cease for 0.6 s while queries go on, and then once more without queries. At the end the motor is stopped."
        ),
    }
}

/// `Row 4: 400 is above 330`, or the place in a file.
pub(super) fn refused(error: &SequenceError, row: Option<usize>) -> String {
    let problem = problem(&error.problem);
    match row {
        Some(row) => tr!("Row {row}: {problem}", row = row + 1, problem),
        None if error.place.is_empty() => format::capitalized(&problem),
        None => format!("{}: {problem}", error.place),
    }
}

/// What is wrong at a place.
pub(super) fn problem(problem: &Problem) -> String {
    match problem {
        Problem::NotJson { line, column } => {
            tr!("not JSON at line {line}, column {column}", line, column)
        }
        Problem::TooLarge => tr!("the file is too large for a sequence").to_owned(),
        Problem::NewerVersion => {
            tr!("written by a newer version; update this page to read it").to_owned()
        }
        Problem::NoVersion => tr!("not a sequence: \"motorlink_sequence\" must be 1").to_owned(),
        Problem::NotText => tr!("not text in UTF-8; save the file as CSV UTF-8").to_owned(),
        Problem::ThousandsMark => tr!(
            "this may be a number with a mark for thousands; write it without marks, or with one decimal mark in all rows"
        )
        .to_owned(),
        Problem::Expected("a number") => tr!("expected a number").to_owned(),
        Problem::Expected(what) => tr!("expected {what}", what = *what),
        Problem::UnknownField => tr!("unknown field; check its spelling").to_owned(),
        Problem::Twice => tr!("appears twice; keep one").to_owned(),
        Problem::Missing => tr!("is missing").to_owned(),
        Problem::NotWith(other) => tr!("cannot be used with {other}", other = *other),
        Problem::Above { value, max } => tr!(
            "{value} is above {max}",
            value = number(*value),
            max = number(*max)
        ),
        Problem::Below { value, min } => tr!(
            "{value} is below {min}",
            value = number(*value),
            min = number(*min)
        ),
        Problem::TimeFalls => tr!("times must rise from row to row").to_owned(),
        Problem::UnknownMotor(id) => {
            tr!("no motor {id} here; scan for it, or use another", id = *id)
        }
        Problem::UnknownGroup => {
            tr!("no group of this name; use a motor, all, or a group").to_owned()
        }
        Problem::NoMotors => tr!("no motor to run with; connect one").to_owned(),
        Problem::TooManyMotors { max } => tr!("a run drives at most {max} motors", max = *max),
        Problem::OtherLoop { id, before } => tr!(
            "motor {id} is driven in the {before} before; one run keeps each motor in one loop",
            id = *id,
            before = terms::mode(*before)
        ),
        Problem::EndlessLoop => {
            tr!("a loop without end; give the number of passes, 1 or more").to_owned()
        }
        Problem::TimelessLoop => tr!("a loop whose steps take no time").to_owned(),
        Problem::TooDeep { max } => tr!("repeats are nested deeper than {max}", max = *max),
        Problem::TooManySteps { max } => tr!("more than {max} steps", max = *max),
        Problem::NoSteps => tr!("no steps; add one").to_owned(),
        Problem::RunTooLong { hours_max } => tr!(
            "the run could take longer than {hours_max} hours",
            hours_max = *hours_max
        ),
    }
}

/// Why the worker did not arm the run.
pub(super) fn not_armed(why: &NotArmed) -> String {
    match why {
        NotArmed::NotConnected => {
            tr!("Not connected. Press Connect motor or Virtual motor.").to_owned()
        }
        NotArmed::Halted => tr!("STOP is active. Press Release to drive again.").to_owned(),
        NotArmed::Running => tr!("A run is in progress. Abort it first.").to_owned(),
        NotArmed::Busy => {
            tr!("A motor is in use, or a scan is running. Stop it, then press Arm again.")
                .to_owned()
        }
        NotArmed::Sequence(error) => error.clone(),
    }
}

/// Why the armed run was not started.
pub(super) fn not_started(why: StartRefusal) -> String {
    match why {
        StartRefusal::NotArmed => tr!("Not armed. Press Arm first.").to_owned(),
        StartRefusal::ArmedTooLongAgo => {
            tr!("Armed over a minute ago. Press Arm again.").to_owned()
        }
        StartRefusal::NotAnswering(id) => tr!(
            "Motor {id} has not replied for half a second. Check the link.",
            id
        ),
        StartRefusal::OtherLoop {
            id,
            needed,
            reported,
        } => tr!(
            "Motor {id} is in the {reported}. Switch it to the {needed} first.",
            id,
            reported = terms::mode(reported),
            needed = terms::mode(needed)
        ),
        StartRefusal::Fault(id, faults) => tr!(
            "Motor {id} reports a fault ({faults}). Start when it has cleared.",
            id,
            faults = terms::faults(faults)
        ),
        StartRefusal::NoAngle(id) => tr!(
            "Motor {id} has not reported its angle. Wait for telemetry.",
            id
        ),
        StartRefusal::OtherAngle(id) => tr!(
            "Position setpoints of motor {id} do not count from the angle that it reports. Use a speed.",
            id
        ),
        StartRefusal::TooLate => tr!("The page was not responding. Press Run again.").to_owned(),
    }
}

/// How a run ended.
pub(super) fn end(end: End, row: Option<usize>) -> String {
    match end {
        End::Finished { .. } => tr!("Finished. The motors are stopped.").to_owned(),
        End::Aborted { cause, .. } => {
            let cause = self::cause(cause, row);
            tr!("Aborted: {cause}. The data is kept.", cause)
        }
    }
}

/// How an armed run ended that never moved anything.
pub(super) fn disarmed(end: End) -> String {
    match end {
        End::Finished { .. } => String::new(),
        End::Aborted { cause, .. } => {
            let cause = self::cause(cause, None);
            tr!("Disarmed: {cause}.", cause)
        }
    }
}

fn cause(cause: Cause, row: Option<usize>) -> String {
    match cause {
        Cause::Stopped => tr!("stopped by you").to_owned(),
        Cause::Driven(id) => tr!("motor {id} was driven by hand", id),
        Cause::Fault(id, faults) => tr!(
            "motor {id} reports a fault: {faults}",
            id,
            faults = terms::faults(faults)
        ),
        Cause::Silent(id) => tr!("motor {id} does not reply", id),
        Cause::Limit(id, limit) => limit_of(id, limit),
        Cause::OtherLoop(id, mode) => {
            tr!("motor {id} is in the {mode}", id, mode = terms::mode(mode))
        }
        Cause::Refused(id) => tr!("a setpoint of motor {id} was refused", id),
        Cause::Unplugged => tr!("the adapter was unplugged").to_owned(),
        Cause::TabClosed => tr!("the page was closed").to_owned(),
        Cause::PageSilent => tr!("the page did not respond").to_owned(),
        Cause::OperatorLost => tr!("remote control ended").to_owned(),
        Cause::FocusLost => tr!("the page lost the focus").to_owned(),
        Cause::Slept => tr!("the computer slept").to_owned(),
        Cause::Late => tr!("the computer was too busy for half a second").to_owned(),
        Cause::WaitTimedOut { .. } => match row {
            Some(row) => tr!(
                "the condition in row {row} was not fulfilled in its time",
                row = row + 1
            ),
            None => tr!("a condition was not fulfilled in its time").to_owned(),
        },
        Cause::PausedTooLong => tr!("paused for over ten minutes").to_owned(),
        Cause::PortClosed => tr!("the port was closed").to_owned(),
        Cause::Scan => tr!("a scan began").to_owned(),
        Cause::OtherModel => tr!("another motor model is set").to_owned(),
        Cause::LeftDriven => tr!("a motor replied again and had to be stopped").to_owned(),
        Cause::ProgramFailed => tr!("the program that runs experiments failed").to_owned(),
    }
}

fn limit_of(id: MotorId, exceeded: ExceededLimit) -> String {
    let (reached, limit, unit) = match exceeded {
        ExceededLimit::Rpm { reached, limit } => (reached, limit, format::rpm()),
        ExceededLimit::Amps { reached, limit } => (reached, limit, "A"),
        ExceededLimit::Celsius { reached, limit } => (reached, limit, "°C"),
        ExceededLimit::OfBus => return tr!("motor {id} is above your limit", id),
    };
    tr!(
        "motor {id} reached {reached} {unit}, above the limit of {limit} {unit}",
        id,
        reached = number(reached),
        limit = number(limit),
        unit
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_duration_names_the_units_that_matter() {
        assert_eq!(duration(37.96), "38 s");
        assert_eq!(duration(320.0), "5 min 20 s");
        assert_eq!(duration(7_500.0), "2 h 5 min");
    }

    #[test]
    fn a_number_has_its_sign_and_no_needless_zero() {
        assert_eq!(number(-0.5), "\u{2212}0.5");
        assert_eq!(signed(100.0), "+100");
        assert_eq!(signed(0.0), "0");
    }

    #[test]
    fn an_error_names_its_row_or_its_place_in_the_file() {
        let error = SequenceError {
            place: "steps[3].rpm".to_owned(),
            problem: Problem::Above {
                value: 400.0,
                max: 330.0,
            },
        };
        assert_eq!(refused(&error, Some(3)), "Row 4: 400 is above 330");
        assert_eq!(refused(&error, None), "steps[3].rpm: 400 is above 330");
    }
}
