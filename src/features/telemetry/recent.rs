//! The reports of the selected motor in the last ten seconds, at the full rate.

use std::collections::VecDeque;

use motorlink_messages::protocol::{Current, Rpm};

/// A report as the sparklines draw it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Report {
    /// When, in milliseconds of the shown time: see `Clock`.
    pub(crate) at_ms: f64,
    pub(crate) speed: Option<Rpm>,
    pub(crate) current: Option<Current>,
}

/// The last reports, oldest first.
#[derive(Debug, Default)]
pub(crate) struct Recent {
    reports: VecDeque<Report>,
}

impl Recent {
    /// The drawn period.
    pub(crate) const SPAN_MS: f64 = 10_000.0;
    /// Kept a little longer, so that the oldest drawn column is complete.
    const KEPT_MS: f64 = Self::SPAN_MS + 1_000.0;
    /// Twice what fits on the bus in that time: an exchange of twenty bytes takes 1.7 ms.
    const REPORTS_MAX: usize = 12_000;

    pub(crate) fn push(&mut self, report: Report) {
        self.reports.push_back(report);
        let too_old = |oldest: &Report| oldest.at_ms < report.at_ms - Self::KEPT_MS;
        while self.reports.len() > Self::REPORTS_MAX || self.reports.front().is_some_and(too_old) {
            self.reports.pop_front();
        }
    }

    pub(crate) fn clear(&mut self) {
        self.reports.clear();
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &Report> {
        self.reports.iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(at_ms: f64) -> Report {
        Report {
            at_ms,
            speed: Some(Rpm::new(0)),
            current: Some(Current::from_raw(0)),
        }
    }

    #[test]
    fn all_of_the_last_ten_seconds_is_kept_and_nothing_much_older() {
        let mut recent = Recent::default();
        for place in 0..15_000_u16 {
            recent.push(report(f64::from(place) * 2.0));
        }
        let ages: Vec<f64> = recent
            .iter()
            .map(|report| 29_998.0 - report.at_ms)
            .collect();
        let of_the_span = ages.iter().filter(|age| **age <= Recent::SPAN_MS).count();
        assert_eq!(of_the_span, 5_001);
        assert!(ages.iter().all(|age| *age <= Recent::KEPT_MS));
        recent.clear();
        assert_eq!(recent.iter().count(), 0);
    }

    #[test]
    fn the_number_of_reports_is_bounded() {
        let mut recent = Recent::default();
        for _ in 0..20_000 {
            recent.push(report(0.0));
        }
        assert_eq!(recent.iter().count(), Recent::REPORTS_MAX);
    }
}
