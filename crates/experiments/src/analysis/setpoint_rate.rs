//! The rate that a run achieved, and the replies that were lost.

use motorlink_protocol::MotorId;

use super::statistics::mean;
use crate::runner::{Record, Sample};

/// Two periods are longer than this many.
const ONE_PERIOD: f64 = 1.5;
/// Fewer replies do not tell a period.
const REPLIES_MIN: usize = 20;

/// Setpoints per second to a motor, and how many of them have no reply.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetpointRate {
    /// Setpoints per second that the line carried.
    pub achieved_hz: f64,
    /// The part without a reply, 0 to 1.
    pub lost: f64,
}

/// The rate of this motor; `None` for a short run, or one whose record is thinned.
///
/// Requests are not recorded. Their period is the one between replies, see `period_s`, and a gap of several periods is
/// as many lost replies less one.
#[must_use]
pub fn setpoint_rate(record: &Record, id: MotorId) -> Option<SetpointRate> {
    if record.is_thinned() {
        return None;
    }
    // Replies to setpoints are those of the most frequent kind. The others are replies to queries.
    let kind = |sample: &Sample| (sample.degrees.is_some(), sample.celsius.is_some());
    let samples = || record.samples().iter().filter(|sample| sample.id == id);
    let kinds = [(true, false), (false, true), (false, false), (true, true)];
    let count = |of: &(bool, bool)| samples().filter(|sample| kind(sample) == *of).count();
    let most = kinds.into_iter().max_by_key(count)?;
    let began = record.began_at()?;
    let times = samples().filter(|sample| kind(sample) == most);
    let times: Vec<f64> = times
        .map(|sample| sample.at.since(began).as_secs_f64())
        .collect();
    if times.len() < REPLIES_MIN {
        return None;
    }
    let intervals: Vec<f64> = pairs(&times).collect();
    let period_s = period_s(intervals.clone())?;
    let lost = intervals.iter().map(|it| (it / period_s).round() - 1.0);
    let lost: f64 = lost.filter(|lost| *lost > 0.0).sum();
    let replies = f64::from(u32::try_from(intervals.len()).ok()?);
    let whole_s: f64 = intervals.iter().sum();
    Some(SetpointRate {
        achieved_hz: (replies + lost) / whole_s,
        lost: lost / (replies + lost),
    })
}

fn pairs(times: &[f64]) -> impl Iterator<Item = f64> {
    times
        .iter()
        .zip(times.iter().skip(1))
        .map(|(one, next)| next - one)
}

/// The shortest time between replies that occurs often: the mean of the intervals up to [`ONE_PERIOD`] times the shortest
/// twentieth. Lost replies only add longer ones.
pub(super) fn period_s(mut intervals: Vec<f64>) -> Option<f64> {
    intervals.sort_by(f64::total_cmp);
    let longest_s = intervals.get(intervals.len() / 20)? * ONE_PERIOD;
    mean(intervals.into_iter().filter(|it| *it <= longest_s))
}
