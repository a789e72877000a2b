//! `motorlink doctor`: what is likely to be wrong with the line.

use std::time::{Duration, Instant};

use motorlink_bus::{Command, Consent, Counters, LineStatus};
use motorlink_diagnosis::{
    Line, Record, Verdict, echoed, garbled,
    texts::{Advice, cause, judged, loss_ended, remedy, some_lost, too_little, well},
};
use motorlink_driver::{Ender, Status};
use motorlink_i18n::load_later_texts;
use motorlink_protocol::{MotorId, Setpoint};
use serde_json::{Value, json};

use crate::{
    arguments::{Doctor, Global},
    confirm::{can_ask, confirm_on},
    connection::{Connection, Happened, on_line},
    drive::{ends_drive, rpm_setpoint},
    failure::Failure,
    output::{print, say},
    scan::scan,
    signed_id::SignedId,
    starting,
    stop_report::most_serious,
    words,
};

/// How often the line is looked at, as on the page.
const LOOK: Duration = Duration::from_millis(100);

/// So many IDs with noise are watched where no motor answers cleanly.
const NOISY_MAX: usize = 4;

/// Which commands do what the diagnosis advises.
fn advice() -> Advice {
    Advice {
        wiring: vec![
            "Is the motor's supply on? A DDSM115 needs 18 V.",
            "DDSM115: is the brown wire tied to GND? Swap orange and white: some adapters label A and B the other way round.",
            "Is it another model? motorlink scan asks at both baud rates.",
        ],
        other_port: "Is it the right port? Choose it with --port; motorlink ports lists them.",
        change_id: "Connect only one, change its ID with motorlink set-id, then connect the other.",
        list_motors: "motorlink scan lists every motor on the bus.",
        find_id: "Is the ID correct? motorlink scan lists every motor on the bus.",
    }
}

/// What was found.
struct Report {
    at_rest: Verdict,
    /// While the wheels turned; `None` if they did not for the whole time.
    turning: Option<Verdict>,
    /// The figures of the last ten seconds, in words.
    judged: String,
    /// What was counted for each motor; the last row is what belongs to no motor.
    counted: Vec<(Option<MotorId>, Counters)>,
    line: Option<LineStatus>,
}

/// Watches the line, at rest and then while the wheels turn, and prints what it is diagnosed as.
pub fn run(global: &Global, how: &Doctor, ender: &Ender) -> Result<(), Failure> {
    let setpoint = how.rpm.map(|rpm| rpm_setpoint(rpm, 0)).transpose()?;
    if setpoint.is_some() && !how.yes {
        can_ask()?;
    }
    load_later_texts();
    let mut report = None;
    // Printed once the wheels stand: nobody may read it for long.
    let stopped = on_line(
        global,
        ender,
        |_| (),
        |connection| {
            report = Some(examine(connection, how, setpoint)?);
            Ok(())
        },
    );
    let Some(report) = report else { return stopped };
    let printed = if how.json {
        print(to_json(&report))
    } else {
        describe(&report)
    };
    most_serious(printed.and_then(|()| result(&report, setpoint)), stopped)
}

/// Fails unless the line is healthy, also while the wheels turn if that was asked for.
fn result(report: &Report, setpoint: Option<Setpoint>) -> Result<(), Failure> {
    let is_healthy = report.at_rest == Verdict::Healthy
        && matches!(report.turning, None | Some(Verdict::Healthy));
    let text = if !is_healthy {
        "the line is not healthy"
    } else if setpoint.is_some() && report.turning.is_none() {
        "the wheels did not turn as asked, so the line was examined at rest only"
    } else {
        return Ok(());
    };
    Err(Failure::NotDone(text.to_owned()))
}

fn examine(
    connection: &mut Connection,
    how: &Doctor,
    setpoint: Option<Setpoint>,
) -> Result<Report, Failure> {
    let may_turn = find_motors(connection, setpoint.is_some())?;
    let mut record = Record::default();
    let was_quiet = watch(connection, how, &mut record)?;
    let at_rest = record.verdict().clone();
    // Two motors with one ID would both turn, and what is lost may be a stop, whatever the cause.
    let is_well = matches!(
        at_rest,
        Verdict::Healthy | Verdict::SomeLoss | Verdict::LossEnded
    ) && !record.loses_much();
    let mut turning = None;
    if let Some(setpoint) = setpoint
        && may_turn
        && was_quiet
        && is_well
        && turn(connection, how, setpoint)?
        && watch(connection, how, &mut record)?
    {
        turning = Some(record.verdict().clone());
    }
    let status = connection.status()?;
    let motors = status.motors.iter();
    let mut counted: Vec<_> = motors
        .map(|motor| (Some(motor.id), motor.counters))
        .collect();
    counted.extend(status.line.map(|line| (None, line.unaddressed)));
    Ok(Report {
        at_rest,
        turning,
        judged: judged(record.judged()),
        counted,
        line: status.line,
    })
}

/// Watches the motors of `--id` or the only one that answers, which may turn, or else what a scan finds. Returns whether
/// they may turn.
fn find_motors(connection: &mut Connection, shall_turn: bool) -> Result<bool, Failure> {
    match connection.wait_for_motors() {
        Ok(()) => return Ok(true),
        Err(Failure::Interrupted) => return Err(Failure::Interrupted),
        // They are watched all the same.
        Err(_) if !connection.motors.is_empty() => return Ok(false),
        Err(_) => {}
    }
    let mut watched = match scan(connection) {
        Ok(report) if shall_turn && !report.found.is_empty() => {
            return Err(Failure::NotDone(format!(
                "motors {} answer: name those that may turn with --id",
                words::ids(report.found)
            )));
        }
        Ok(report) => {
            let noisy = report.noisy.into_iter().take(NOISY_MAX);
            report.found.into_iter().chain(noisy).collect()
        }
        Err(failure @ (Failure::Interrupted | Failure::OtherModel(_))) => return Err(failure),
        Err(_) => Vec::new(),
    };
    if watched.is_empty() {
        watched.push(MotorId::FIRST);
    }
    for id in watched {
        connection.driver.command(Command::Watch(id));
        connection.motors.push(SignedId::straight(id));
    }
    Ok(false)
}

/// Starts the wheels, if the person agrees. Returns whether it did.
fn turn(connection: &Connection, how: &Doctor, setpoint: Setpoint) -> Result<bool, Failure> {
    if !how.yes {
        let motors = connection.motors.iter().map(ToString::to_string);
        let question = format!(
            "Motors {} turn at {setpoint} for {} s. Are their wheels free?",
            motors.collect::<Vec<_>>().join(", "),
            how.secs
        );
        match confirm_on(connection, &question) {
            Ok(()) => {}
            Err(Failure::Interrupted) => return Err(Failure::Interrupted),
            Err(_) => return Ok(false),
        }
    }
    let usage = |error: motorlink_bus::GroupError| Failure::Usage(error.to_string());
    let motors = connection.motors.iter().copied();
    let start = starting::start(motors, setpoint, Consent::None).map_err(usage)?;
    connection.driver.command(start);
    Ok(true)
}

/// Looks at the line until the time is over. Returns whether nothing ended it before, such as a wheel that does not
/// turn as asked.
fn watch(connection: &Connection, how: &Doctor, record: &mut Record) -> Result<bool, Failure> {
    let until = Instant::now() + Duration::from_secs(how.secs);
    let mut look_at = Instant::now();
    loop {
        let happened = connection.next()?;
        let now = Instant::now();
        if now >= look_at {
            look_at = now + LOOK;
            record.look(line(&connection.status()?));
        }
        if matches!(happened, Happened::Entry(_, entry) if ends_drive(&entry, false)) {
            return Ok(false);
        }
        if now >= until {
            return Ok(true);
        }
    }
}

fn line(status: &Status) -> Option<Line<'_>> {
    let motors = status.motors.as_slice();
    let now = status.now;
    let status = status.line.as_ref()?;
    Some(Line {
        now,
        status,
        motors,
    })
}

fn describe(report: &Report) -> Result<(), Failure> {
    print("Motor     requests   replies  no reply  corrupted    echoes   foreign")?;
    for (id, counters) in &report.counted {
        let name = id.map_or_else(|| "no motor".to_owned(), |id| id.to_string());
        let [asked, replies, silent, garbled, echoed, foreign] = counts(counters);
        print(format_args!(
            "{name:<8}{asked:>10}{replies:>10}{silent:>10}{garbled:>11}{echoed:>10}{foreign:>10}"
        ))?;
    }
    if let Some(line) = &report.line {
        print(format_args!("Round trip {}", round_trip(line)))?;
    }
    say(&report.judged);
    let Some(turning) = &report.turning else {
        return say_verdict(&report.at_rest);
    };
    print("At rest:")?;
    say_verdict(&report.at_rest)?;
    print("While the wheels turn:")?;
    say_verdict(turning)
}

fn say_verdict(verdict: &Verdict) -> Result<(), Failure> {
    let found = match verdict {
        Verdict::NotConnected => return print("The port is lost."),
        Verdict::TooLittle => return print(too_little()),
        Verdict::Healthy => return print(well()),
        Verdict::SomeLoss => return print(some_lost()),
        Verdict::LossEnded => return print(loss_ended()),
        Verdict::Faulty(found) => found,
    };
    for diagnosis in found {
        print(cause(*diagnosis))?;
        for step in remedy(*diagnosis, &advice()) {
            print(format_args!("  - {step}"))?;
        }
    }
    Ok(())
}

fn round_trip(line: &LineStatus) -> String {
    let ms = |us: Option<u32>| us.map(|us| f64::from(us) / 1_000.0);
    match (ms(line.round_trip.median_us), ms(line.round_trip.p99_us)) {
        (Some(median), Some(p99)) => format!("{median:.1} ms median, {p99:.1} ms p99"),
        _ => "unknown: no reply".to_owned(),
    }
}

/// Requests, replies, requests without one, corrupted replies, echoes, frames of others.
const fn counts(counters: &Counters) -> [u64; 6] {
    [
        counters.requests,
        counters.replies,
        counters.silences,
        garbled(counters),
        echoed(counters),
        counters.wrong_ids,
    ]
}

fn to_json(report: &Report) -> Value {
    let counted = report.counted.iter().map(|(id, counters)| {
        let [requests, replies, silences, garbled, echoes, foreign] = counts(counters);
        json!({
            "motor_id": id.map(MotorId::get),
            "requests": requests,
            "replies": replies,
            "without_reply": silences,
            "corrupted": garbled,
            "echoes": echoes,
            "foreign": foreign,
        })
    });
    let round_trip = report.line.map(|line| line.round_trip);
    json!({
        "at_rest": of_verdict(&report.at_rest),
        "turning": report.turning.as_ref().map(of_verdict),
        "counted": counted.collect::<Vec<Value>>(),
        "round_trip_median_us": round_trip.and_then(|round_trip| round_trip.median_us),
        "round_trip_p99_us": round_trip.and_then(|round_trip| round_trip.p99_us),
    })
}

fn of_verdict(verdict: &Verdict) -> Value {
    let (name, found) = match verdict {
        Verdict::NotConnected => ("not_connected", &[][..]),
        Verdict::TooLittle => ("too_little", &[][..]),
        Verdict::Healthy => ("healthy", &[][..]),
        Verdict::SomeLoss => ("some_loss", &[][..]),
        Verdict::LossEnded => ("loss_ended", &[][..]),
        Verdict::Faulty(found) => ("faulty", found.as_slice()),
    };
    let causes = found.iter().map(|diagnosis| {
        json!({
            "cause": cause(*diagnosis),
            "remedies": remedy(*diagnosis, &advice()),
        })
    });
    json!({ "verdict": name, "causes": causes.collect::<Vec<Value>>() })
}
