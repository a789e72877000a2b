//! `motorlink monitor`: shows what the motors report.

use std::{
    collections::BTreeMap,
    fmt::Write as _,
    io::{IsTerminal, Write, stdout},
    time::{Duration, Instant},
};

use motorlink_bus::{Event, LineEvent, LineEventKind};
use motorlink_driver::{Ender, Entry, zero_unix_us};
use motorlink_protocol::MotorId;
use motorlink_recorder::{CsvLines, LocalTime, WallClock};
use motorlink_session::TelemetryJson;

use crate::{
    arguments::{Global, Monitor},
    connection::{Connection, Happened, on_line},
    failure::Failure,
    output::{Rows, print},
    values::Values,
    watching::watch_found,
};

/// Where the replies go.
enum Output<'a> {
    /// A table that is drawn again.
    Table,
    /// A line for each motor at each time.
    Lines,
    Csv(Box<CsvLines>, WallClock, Rows<'a>),
    Json(Box<TelemetryJson>),
}

/// Shows the motors until Ctrl-C or the end of the time.
pub fn run(global: &Global, how: &Monitor, ender: &Ender) -> Result<(), Failure> {
    let writes_all = how.json || how.csv.is_some();
    on_line(
        global,
        ender,
        |options| options.tells_traffic = writes_all,
        |connection| {
            watch_found(connection)?;
            let mut output = output(connection, how)?;
            match show(connection, how, &mut output) {
                // Ctrl-C is the usual end.
                Err(Failure::Interrupted) => Ok(()),
                shown => shown,
            }
        },
    )
}

fn output<'a>(connection: &Connection, how: &'a Monitor) -> Result<Output<'a>, Failure> {
    if how.json {
        return Ok(Output::Json(Box::default()));
    }
    let Some(csv) = &how.csv else {
        let draws = stdout().is_terminal();
        return Ok(if draws { Output::Table } else { Output::Lines });
    };
    let mut out = Rows::to(csv.as_deref())?;
    let mut lines = CsvLines::of_telemetry();
    let mut head = Vec::new();
    lines.head(&mut head);
    out.write(&head)?;
    let zero_us = zero_unix_us(connection.status()?.now);
    let clock = WallClock::from_us(zero_us, LocalTime::default());
    Ok(Output::Csv(Box::new(lines), clock, out))
}

fn show(connection: &Connection, how: &Monitor, output: &mut Output<'_>) -> Result<(), Failure> {
    let begun = Instant::now();
    let period = Duration::try_from_secs_f64(1.0 / how.hz).unwrap_or(Duration::from_secs(1));
    let mut thinned = Thinned::new(period);
    let mut draw_at = begun;
    let mut drawn_lines = 0;
    loop {
        if how.secs.is_some_and(|secs| begun.elapsed() >= secs) {
            return Ok(());
        }
        let happened = connection.next()?;
        let now = Instant::now();
        if let (
            Happened::Entry(_, Entry::Event(Event::Line(event))),
            Output::Csv(..) | Output::Json(_),
        ) = (&happened, &*output)
        {
            write(event, output, thinned.takes(event))?;
        }
        if now < draw_at {
            continue;
        }
        draw_at = now + period;
        match output {
            Output::Table => drawn_lines = draw(connection, drawn_lines)?,
            Output::Lines => print_lines(connection)?,
            Output::Csv(..) | Output::Json(_) => {}
        }
    }
}

/// Takes at most one reply of each motor in a period.
struct Thinned {
    period: Duration,
    last: BTreeMap<MotorId, motorlink_protocol::Instant>,
}

impl Thinned {
    const fn new(period: Duration) -> Self {
        Self {
            period,
            last: BTreeMap::new(),
        }
    }

    fn takes(&mut self, event: &LineEvent) -> bool {
        let LineEventKind::Received { frame, .. } = event.kind else {
            return false;
        };
        let &[id, ..] = frame.bytes();
        let Ok(id) = MotorId::new(id) else {
            return false;
        };
        // A reply a little early belongs to the next period.
        let early = self.period / 4;
        let is_due =
            |last: &motorlink_protocol::Instant| event.at.since(*last) + early >= self.period;
        let is_due = self.last.get(&id).is_none_or(is_due);
        if is_due {
            self.last.insert(id, event.at);
        }
        is_due
    }
}

/// Every event goes to the writer, which follows the line; rows are written of those that are taken.
fn write(event: &LineEvent, output: &mut Output<'_>, is_taken: bool) -> Result<(), Failure> {
    match output {
        Output::Csv(lines, clock, out) => {
            let mut row = Vec::new();
            lines.event(&mut row, event, *clock);
            if is_taken {
                out.write(&row)?;
            }
        }
        Output::Json(lines) => {
            if let Some((id, json)) = lines.add_event(event)
                && is_taken
            {
                print(with_id(id, &json))?;
            }
        }
        Output::Table | Output::Lines => {}
    }
    Ok(())
}

/// The telemetry of a motor with its ID in front.
pub fn with_id(id: MotorId, json: &str) -> String {
    let rest = json.strip_prefix('{').unwrap_or_default();
    format!("{{\"motor_id\":{},{rest}", id.get())
}

fn lines(connection: &Connection) -> Result<Vec<String>, Failure> {
    let status = connection.status()?;
    let model = connection.driver.model();
    let of = |signed: &crate::signed_id::SignedId| {
        let motor = status.motor(signed.id)?;
        Some(Values::of(model, motor, status.now, *signed).line())
    };
    Ok(connection.motors.iter().filter_map(of).collect())
}

/// Draws the table over the one before. Returns its number of lines.
fn draw(connection: &Connection, drawn_lines: usize) -> Result<usize, Failure> {
    let lines = lines(connection)?;
    let mut text = String::new();
    if drawn_lines > 0 {
        // Writing to a string does not fail.
        let _ = write!(text, "\x1b[{drawn_lines}A");
    }
    for line in [Values::HEAD.to_owned()].iter().chain(&lines) {
        let _ = write!(text, "\r\x1b[K{line}\n");
    }
    let mut out = stdout().lock();
    let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    written.map_err(Failure::output)?;
    Ok(lines.len() + 1)
}

fn print_lines(connection: &Connection) -> Result<(), Failure> {
    let mut out = stdout().lock();
    for line in lines(connection)? {
        writeln!(out, "{line}").map_err(Failure::output)?;
    }
    Ok(())
}
