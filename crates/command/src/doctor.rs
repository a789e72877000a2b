//! `motorlink doctor`: what is likely to be wrong with the line.

use std::time::{Duration, Instant};

use motorlink_bus::{Command, Consent, LineStatus, MotorStatus};
use motorlink_diagnosis::{
    Diagnosis, Line, Record, Verdict, cause, echoed, garbled, judged, remedy, some_lost,
    too_little, well,
};
use motorlink_driver::{Ender, Status};
use motorlink_protocol::{MotorId, Setpoint};
use serde_json::{Value, json};

use crate::{
    arguments::{Doctor, Global},
    confirm::confirm_on,
    connection::{Connection, Happened, on_line},
    drive::{ends_drive, rpm_setpoint},
    failure::Failure,
    output::{print, say},
    scan::scan,
    signed_id::SignedId,
    starting, words,
};

/// How often the line is looked at, as on the page.
const LOOK: Duration = Duration::from_millis(100);

/// What to check where no motor answers, the most frequent cause first.
const WIRING: [&str; 3] = [
    "Is the motor's supply on? A DDSM115 needs 18 V.",
    "DDSM115: is the brown wire tied to GND? Swap orange and white: some adapters label A and B the other way round.",
    "Is it another model? motorlink scan asks at both baud rates.",
];

/// Watches the line, at rest and then while the wheels turn, and prints what it is diagnosed as.
pub fn run(global: &Global, how: &Doctor, ender: &Ender) -> Result<(), Failure> {
    let setpoint = how.rpm.map(|rpm| rpm_setpoint(rpm, 0)).transpose()?;
    on_line(
        global,
        ender,
        |_| (),
        |connection| {
            let answers = find_motors(connection)?;
            let mut record = Record::default();
            watch(connection, how, &mut record)?;
            if let Some(setpoint) = setpoint
                && answers
            {
                turn(connection, how, setpoint)?;
                watch(connection, how, &mut record)?;
            }
            let status = connection.status()?;
            if how.json {
                print(to_json(&record, &status))?;
            } else {
                describe(&record, &status)?;
            }
            match record.verdict() {
                Verdict::Healthy => Ok(()),
                _ => Err(Failure::NotDone("the line is not healthy".to_owned())),
            }
        },
    )
}

/// Watches the motors that answer, or else those of `--id`, or else motor 1. Returns whether one answers.
fn find_motors(connection: &mut Connection) -> Result<bool, Failure> {
    match connection.wait_for_motors() {
        Ok(()) => return Ok(true),
        Err(Failure::Interrupted) => return Err(Failure::Interrupted),
        Err(_) if !connection.motors.is_empty() => return Ok(false),
        Err(_) => {}
    }
    let found = scan(connection)?.found;
    let answers = !found.is_empty();
    let watched = if answers { found } else { vec![MotorId::FIRST] };
    for id in watched {
        connection.driver.command(Command::Watch(id));
        connection.motors.push(SignedId::straight(id));
    }
    Ok(answers)
}

/// Starts the wheels, once the person has agreed.
fn turn(connection: &Connection, how: &Doctor, setpoint: Setpoint) -> Result<(), Failure> {
    let motors = connection.motors.iter();
    let ids = words::ids(motors.clone().map(|motor| motor.id));
    if !how.yes {
        let question = format!("The wheels of {ids} turn at {setpoint}. Are they free to turn?");
        confirm_on(connection, question)?;
    }
    let usage = |error: motorlink_bus::GroupError| Failure::Usage(error.to_string());
    let start = starting::start(motors.copied(), setpoint, Consent::None).map_err(usage)?;
    connection.driver.command(start);
    Ok(())
}

/// Looks at the line until the time is over, or until a wheel does not turn as asked.
fn watch(connection: &Connection, how: &Doctor, record: &mut Record) -> Result<(), Failure> {
    let until = Instant::now() + how.secs;
    let mut look_at = Instant::now();
    loop {
        let happened = connection.next()?;
        let now = Instant::now();
        if now >= look_at {
            look_at = now + LOOK;
            record.look(line(&connection.status()?));
        }
        let ended = matches!(happened, Happened::Entry(_, entry) if ends_drive(&entry, false));
        if ended || now >= until {
            return Ok(());
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

fn describe(record: &Record, status: &Status) -> Result<(), Failure> {
    print("Motor     requests   replies  no reply  corrupted    echoes   foreign")?;
    for (name, [asked, replies, silent, garbled, echoed, foreign]) in rows(status) {
        print(format_args!(
            "{name:<8}{asked:>10}{replies:>10}{silent:>10}{garbled:>11}{echoed:>10}{foreign:>10}"
        ))?;
    }
    if let Some(line) = &status.line {
        print(format_args!("Round trip {}", round_trip(line)))?;
    }
    say(judged(record.judged()));
    let found = match record.verdict() {
        Verdict::NotConnected => return print("The port is lost."),
        Verdict::TooLittle => return print(too_little()),
        Verdict::Healthy => return print(well()),
        Verdict::SomeLoss => return print(some_lost()),
        Verdict::Faulty(found) => found,
    };
    for diagnosis in found {
        print(cause(*diagnosis))?;
        for step in remedy(*diagnosis, &WIRING) {
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

/// What was counted for each motor, and while none was asked: requests, replies, silences, damaged replies, echoes,
/// frames of others.
fn rows(status: &Status) -> Vec<(String, [u64; 6])> {
    let of = |counters: &motorlink_bus::Counters| {
        [
            counters.requests,
            counters.replies,
            counters.silences,
            garbled(counters),
            echoed(counters),
            counters.wrong_ids,
        ]
    };
    let motor = |motor: &MotorStatus| (motor.id.to_string(), of(&motor.counters));
    let mut rows: Vec<_> = status.motors.iter().map(motor).collect();
    if let Some(line) = &status.line {
        rows.push(("others".to_owned(), of(&line.unaddressed)));
    }
    rows
}

fn to_json(record: &Record, status: &Status) -> Value {
    let verdict = match record.verdict() {
        Verdict::NotConnected => "not_connected",
        Verdict::TooLittle => "too_little",
        Verdict::Healthy => "healthy",
        Verdict::SomeLoss => "some_loss",
        Verdict::Faulty(_) => "faulty",
    };
    let found: &[Diagnosis] = match record.verdict() {
        Verdict::Faulty(found) => found,
        _ => &[],
    };
    let causes = found.iter().map(|diagnosis| {
        json!({
            "cause": cause(*diagnosis),
            "remedies": remedy(*diagnosis, &WIRING),
        })
    });
    let counted = |(name, counts): (String, [u64; 6])| {
        let [requests, replies, silences, garbled, echoes, foreign] = counts;
        json!({
            "of": name,
            "requests": requests,
            "replies": replies,
            "without_reply": silences,
            "corrupted": garbled,
            "echoes": echoes,
            "foreign": foreign,
        })
    };
    let round_trip = status.line.map(|line| line.round_trip);
    json!({
        "verdict": verdict,
        "causes": causes.collect::<Vec<_>>(),
        "counted": rows(status).into_iter().map(counted).collect::<Vec<Value>>(),
        "round_trip_median_us": round_trip.and_then(|round_trip| round_trip.median_us),
        "round_trip_p99_us": round_trip.and_then(|round_trip| round_trip.p99_us),
    })
}
