//! The rate that a run achieved, and the replies that were lost.

use motorlink_protocol::MotorId;

use super::statistics::mean;
use crate::runner::{Record, Sample};

/// How far an interval may be from a period, as a part of it, to be taken for one.
const NEAR: f64 = 0.3;
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

/// The rate of this motor, at most `asked_hz`; `None` for a short run, or one whose record is thinned.
///
/// Requests are not recorded. Their period is the one between replies, see `period_s`. What is missing of as many replies as
/// there are periods is lost. An adapter that hands on several replies at once hides their period: then the rate is the
/// asked one.
#[must_use]
pub fn setpoint_rate(record: &Record, id: MotorId, asked_hz: f64) -> Option<SetpointRate> {
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
    rate(&times, asked_hz)
}

fn rate(times: &[f64], asked_hz: f64) -> Option<SetpointRate> {
    if times.len() < REPLIES_MIN {
        return None;
    }
    let pairs = times.iter().zip(times.iter().skip(1));
    let period_s = period_s(pairs.map(|(one, next)| next - one).collect())?;
    let achieved_hz = asked_hz.min(1.0 / period_s);
    let whole_s = times.last()? - times.first()?;
    let replies = f64::from(u32::try_from(times.len() - 1).ok()?);
    Some(SetpointRate {
        achieved_hz,
        lost: (1.0 - replies / (achieved_hz * whole_s)).max(0.0),
    })
}

/// The usual time between replies: the mean of the intervals about as long as their first quartile. Up to a quarter of the
/// replies may be late, which makes the interval before it longer and the next one shorter, and more than half of them may
/// be lost, by chance. Where more are late, and none is lost, it is the mean of all.
pub(super) fn period_s(intervals: Vec<f64>) -> Option<f64> {
    let pairs = intervals.iter().zip(intervals.iter().skip(1));
    let even_s = quartile(pairs.map(|(one, next)| (one + next) / 2.0).collect());
    let all_s = mean(intervals.iter().copied())?;
    let one_s = quartile(intervals.clone())?;
    if even_s.is_some_and(|even_s| one_s < 0.8 * even_s && all_s < 1.05 * even_s) {
        return Some(all_s);
    }
    let usual = ((1.0 - NEAR) * one_s)..=((1.0 + NEAR) * one_s);
    mean(intervals.into_iter().filter(|it| usual.contains(it)))
}

fn quartile(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 4).copied()
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use super::*;

    /// A reply every 5 ms, but for those that are lost; some come late.
    fn found(late_s: impl Fn(u32) -> f64, is_lost: impl Fn(u32) -> bool) -> SetpointRate {
        let kept = (0..1_000).filter(|at| !is_lost(*at));
        let times: Vec<f64> = kept.map(|at| f64::from(at) * 0.005 + late_s(at)).collect();
        // More than the line carried: the rate is what the replies tell.
        rate(&times, 500.0).unwrap()
    }

    #[test]
    fn replies_that_come_late_are_neither_a_higher_rate_nor_lost() {
        // Of so many, one waits for the next: a busy computer, or an adapter that hands on what has come every 16 ms.
        for one_in in [20, 5, 2] {
            let late_s = |at| if at % one_in == 1 { 0.0023 } else { 0.0 };
            let found = found(late_s, |_| false);
            assert!((found.achieved_hz - 200.0).abs() < 1.0, "{found:?}");
            assert!(found.lost < 0.01, "{found:?}");
        }
    }

    #[test]
    fn lost_replies_are_no_lower_rate() {
        for part in [0.01, 0.1, 0.3] {
            let random = RefCell::new(fastrand::Rng::with_seed(1));
            let found = found(|_| 0.0, |_| random.borrow_mut().f64() < part);
            assert!((found.achieved_hz - 200.0).abs() < 1.0, "{found:?}");
            assert!((found.lost - part).abs() < 0.03, "{found:?}");
        }
    }
}
