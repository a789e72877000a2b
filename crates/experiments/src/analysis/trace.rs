//! The samples of one motor as signals over time.

use std::time::Duration;

use motorlink_protocol::{FRAME_AIRTIME, Instant, MotorId, Setpoint};

use super::{Point, setpoint_rate::period_s};
use crate::runner::Record;

/// Signals of one motor of a run, in seconds since its start.
///
/// Times are times at the motor. It receives a setpoint with the last byte of the frame, and measures its telemetry
/// when the first byte of the reply leaves. So setpoints are shifted later and replies earlier by the airtime of a
/// frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// Setpoints that differ from the one before, in rpm, A or degrees. A brake is 0.
    pub command: Vec<Point>,
    /// Speed in rpm.
    pub rpm: Vec<Point>,
    /// Current in A.
    pub amps: Vec<Point>,
    /// Temperature in deg C.
    pub celsius: Vec<Point>,
}

impl Trace {
    /// The signals of this motor at the baud of a DDSM115; empty if the run was not started.
    #[must_use]
    pub fn of(record: &Record, id: MotorId) -> Self {
        Self::with_airtime(record, id, FRAME_AIRTIME)
    }

    /// The signals of this motor; empty if the run was not started. `airtime` is that of a frame of its model.
    #[must_use]
    pub fn with_airtime(record: &Record, id: MotorId, airtime: Duration) -> Self {
        let Some(began) = record.began_at() else {
            return Self::default();
        };
        let since = |at: Instant| at.since(began).as_secs_f64();
        let received = |at: Instant| since(at + airtime);
        let measured = |at: Instant| since(at) - airtime.as_secs_f64();
        let sent = record.sent_setpoints().iter();
        let samples = || record.samples().iter().filter(|sample| sample.id == id);
        let point = Point::new;
        Self {
            command: sent
                .filter(|sent| sent.id == id)
                .map(|sent| point(received(sent.at), value(sent.setpoint)))
                .collect(),
            rpm: samples()
                .filter_map(|sample| Some(point(measured(sample.at), sample.rpm?.into())))
                .collect(),
            amps: samples()
                .filter_map(|sample| {
                    Some(point(measured(sample.at), sample.current?.amps().into()))
                })
                .collect(),
            celsius: samples()
                .filter_map(|sample| Some(point(measured(sample.at), sample.celsius?.into())))
                .collect(),
        }
    }

    /// Requests per second that the line carried, at most `asked_hz`.
    ///
    /// Requests are not recorded. Their period follows from the times between replies.
    #[must_use]
    pub fn request_hz(&self, asked_hz: f64) -> f64 {
        let pairs = self.rpm.iter().zip(self.rpm.iter().skip(1));
        let period_s = period_s(pairs.map(|(one, next)| next.t_s - one.t_s).collect());
        period_s.map_or(asked_hz, |period_s| asked_hz.min(1.0 / period_s))
    }

    /// The points of a signal from one time up to another.
    #[must_use]
    pub fn between(signal: &[Point], from_s: f64, to_s: f64) -> &[Point] {
        let first = signal.partition_point(|point| point.t_s < from_s);
        let end = signal.partition_point(|point| point.t_s < to_s);
        signal.get(first..end).unwrap_or_default()
    }
}

fn value(setpoint: Setpoint) -> f64 {
    match setpoint {
        Setpoint::Velocity { speed, .. } => speed.rpm().into(),
        Setpoint::Brake => 0.0,
        Setpoint::Current(current) => current.amps().into(),
        Setpoint::Position(position) => position.degrees().into(),
        Setpoint::OpenLoop(target) => target.raw().into(),
    }
}
