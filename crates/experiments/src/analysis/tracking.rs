//! How well a motor follows its setpoints.

use std::time::Duration;

use motorlink_protocol::{MotorId, Setpoint};

use crate::{
    runner::{Record, Sample},
    sequence::Quantity,
};

/// Setpoint less reported value, over all replies with a setpoint of one quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tracking {
    /// The quantity of the first setpoint. Replies under another one, and under a brake, are left out.
    pub quantity: Quantity,
    /// Root of the mean square.
    pub rms: f64,
    /// The one with the greatest magnitude.
    pub worst: f64,
    /// When that was measured, in seconds since the start of the run.
    pub worst_s: f64,
    /// Number of replies.
    pub replies: u32,
}

/// The tracking error of this motor; `None` without a reply to a setpoint. `airtime` is that of a frame of its model.
///
/// A reply is compared with the setpoint that the motor had when it measured: see [`Trace`](super::Trace).
#[must_use]
pub fn tracking(record: &Record, id: MotorId, airtime: Duration) -> Option<Tracking> {
    let began = record.began_at()?;
    let sent = record.sent_setpoints().iter();
    let mut sent = sent.filter(|sent| sent.id == id).peekable();
    let mut asked = None;
    let mut found: Option<Tracking> = None;
    for sample in record.samples().iter().filter(|sample| sample.id == id) {
        while let Some(next) = sent.next_if(|next| next.at + airtime + airtime <= sample.at) {
            asked = quantity_and_value(next.setpoint);
        }
        let Some((quantity, setpoint)) = asked else {
            continue;
        };
        let Some(error) = error(quantity, setpoint, sample) else {
            continue;
        };
        let worst_s = sample.at.since(began).as_secs_f64() - airtime.as_secs_f64();
        let first = Tracking {
            quantity,
            rms: 0.0,
            worst: 0.0,
            worst_s,
            replies: 0,
        };
        let tracking = found.get_or_insert(first);
        if tracking.quantity != quantity {
            continue;
        }
        // A sum until the end.
        tracking.rms += error * error;
        tracking.replies = tracking.replies.saturating_add(1);
        if error.abs() > tracking.worst.abs() {
            (tracking.worst, tracking.worst_s) = (error, worst_s);
        }
    }
    found.map(|sum| Tracking {
        rms: (sum.rms / f64::from(sum.replies)).sqrt(),
        ..sum
    })
}

fn quantity_and_value(setpoint: Setpoint) -> Option<(Quantity, f64)> {
    match setpoint {
        Setpoint::Velocity { speed, .. } => Some((Quantity::Rpm, speed.rpm().into())),
        Setpoint::Current(target) => Some((Quantity::Amps, target.amps().into())),
        Setpoint::Position(target) => Some((Quantity::Degrees, target.degrees().into())),
        Setpoint::Brake | Setpoint::OpenLoop(_) => None,
    }
}

/// `None` if the reply does not have the quantity.
fn error(quantity: Quantity, setpoint: f64, sample: &Sample) -> Option<f64> {
    match quantity {
        Quantity::Rpm => Some(setpoint - f64::from(sample.rpm?)),
        Quantity::Amps => Some(setpoint - f64::from(sample.current?.amps())),
        // The short way round.
        Quantity::Degrees => {
            Some((setpoint - f64::from(sample.degrees?) + 180.0).rem_euclid(360.0) - 180.0)
        }
    }
}
