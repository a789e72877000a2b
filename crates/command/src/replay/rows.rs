//! What was recorded as lines, CSV or JSON, as `monitor` writes them, at once.

use motorlink_bus::LineEventKind;
use motorlink_driver::Ender;
use motorlink_messages::{
    Update,
    sessions::{FromReplay, PlaySpeed, ToReplay},
};
use motorlink_protocol::{Instant, MotorId, family::Model};
use motorlink_session::{Record, Table, TelemetryJson, for_each_record};

use crate::{
    failure::Failure,
    monitor::with_id,
    output::{Rows, print},
    signed_id::SignedId,
    values::Values,
};

use super::{Recorded, arguments::Replay, micros, playback::Playback};

/// A line for each motor five times a second, as `monitor` without options.
const LINES_EVERY_US: u64 = 200_000;

/// Where the replies go.
enum Output<'a> {
    Csv(Box<Table>, Rows<'a>),
    Json(Box<TelemetryJson>),
}

impl<'a> Output<'a> {
    fn of(how: &'a Replay) -> Result<Self, Failure> {
        let Some(csv) = &how.csv else {
            return Ok(Self::Json(Box::default()));
        };
        let mut out = Rows::to(csv.as_deref())?;
        let mut table = Table::of_telemetry();
        let mut head = Vec::new();
        table.head(&mut head);
        out.write(&head)?;
        Ok(Self::Csv(Box::new(table), out))
    }

    /// Every record goes to the writer, which follows the line; rows are written of those that are shown.
    fn add(&mut self, record: &Record, is_shown: impl Fn(MotorId) -> bool) -> Result<(), Failure> {
        let Some(event) = record.line() else {
            return Ok(());
        };
        match self {
            Self::Csv(table, out) => {
                let mut row = Vec::new();
                table.record(&mut row, record);
                let LineEventKind::Received { frame, .. } = event.kind else {
                    return Ok(());
                };
                let &[id, ..] = frame.bytes();
                if MotorId::new(id).is_ok_and(is_shown) {
                    out.write(&row)?;
                }
                Ok(())
            }
            Self::Json(telemetry) => match telemetry.add_event(&event) {
                Some((id, json)) if is_shown(id) => print(with_id(id, &json)),
                _ => Ok(()),
            },
        }
    }
}

/// Writes a row for every reply.
pub fn write(mut recorded: Recorded, how: &Replay, ender: &Ender) -> Result<(), Failure> {
    let mut output = Output::of(how)?;
    let (first, _) = recorded.overview.begins().unwrap_or_default();
    let part = first + recorded.from..=first + recorded.to;
    let motors = recorded.motors;
    let is_motor = |id| motors.iter().any(|motor| motor.id == id);
    let opened = &mut recorded.opened;
    let mut written = Ok(());
    let read = for_each_record(&mut opened.bytes, &opened.session, |record| {
        if ender.is_asked() {
            written = Err(Failure::Interrupted);
        }
        if written.is_ok() {
            let is_in_part = part.contains(&record.at);
            written = output.add(&record, |id| is_in_part && is_motor(id));
        }
    });
    read.map_err(Failure::file(&how.file))?;
    written
}

/// Writes a line for each motor at each time: the states that the screen would show, without waiting for them.
pub fn write_lines(recorded: Recorded, model: Option<Model>, ender: &Ender) -> Result<(), Failure> {
    let (mut due_us, to_us) = (micros(recorded.from), micros(recorded.to));
    let mut playback = Playback::new(recorded.opened, &recorded.overview);
    let mut now = Instant::ZERO;
    playback.ask(ToReplay::Seek { after_us: due_us }, now);
    playback.ask(ToReplay::Play(PlaySpeed::REAL_TIME), now);
    loop {
        if ender.is_asked() {
            return Err(Failure::Interrupted);
        }
        let mut written = Ok(());
        let next = playback.turn(now, |message| {
            if let FromReplay::Update { place, update } = message
                && (due_us..=to_us).contains(&place.after_us)
                && written.is_ok()
            {
                due_us = place.after_us + LINES_EVERY_US;
                written = print_lines(&recorded.motors, model, place.after_us, &update);
            }
        });
        written?;
        match next {
            Some(next) if playback.place.after_us < to_us => now = next,
            _ => return Ok(()),
        }
    }
}

#[expect(clippy::cast_precision_loss, reason = "exact for a century")]
fn print_lines(
    motors: &[SignedId],
    model: Option<Model>,
    after_us: u64,
    update: &Update,
) -> Result<(), Failure> {
    let model = model.or(update.line.map(|line| line.model));
    motors.iter().try_for_each(|signed| {
        let Some(motor) = update.motors.iter().find(|motor| motor.id == signed.id) else {
            return Ok(());
        };
        let values = Values::of(model.unwrap_or_default(), motor, update.now, *signed);
        let seconds = after_us as f64 / 1e6;
        print(format_args!("{seconds:>9.3} {}", values.line()))
    })
}
