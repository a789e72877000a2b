//! What happened on the line, second by second.

use std::time::Duration;

use motorlink_bus::{
    Counters, FRESH_FOR, LineStatus, MotorStatus, ROUND_TRIP_BINS_US, RoundTripStatus,
};
use motorlink_protocol::{Instant, MotorId};

use crate::{
    doctor::{
        Findings, LATENCY_TIMER_ENDS_US, MotorFindings, Verdict, diagnose, header_says_lossy,
        loses_much,
    },
    tally::Tally,
};

/// From here on a wheel turns: below it the current, and so what is heard of it, is that of rest.
const TURNING_FROM_RPM: u16 = 20;

/// From so many late calls and replies a second on, lost replies may be the computer's.
const LATE_MIN_HZ: u16 = 5;

/// How a wheel is, or was for a whole second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Motion {
    Standing,
    Turning,
    /// It changed, or its motor was not heard.
    Unclear,
}

/// Counters as they stood.
#[derive(Clone, Copy, Debug)]
struct Seen {
    /// `None` is what came while no single motor was asked.
    id: Option<MotorId>,
    counters: Counters,
    motion: Motion,
    /// Whether the bus calls it silent.
    silent: bool,
    /// Whether its last reply is so old that one is overdue.
    overdue: bool,
    loss_per_mille: Option<u16>,
}

/// What happened in a second.
#[derive(Clone, Copy, Debug)]
struct Entry {
    /// Its number.
    second: u32,
    id: Option<MotorId>,
    tally: Tally,
    motion: Motion,
}

/// An open line as it is at one moment.
#[derive(Clone, Copy, Debug)]
pub struct Line<'a> {
    /// The moment, on the clock of the bus.
    pub now: Instant,
    /// What the bus says of it.
    pub status: &'a LineStatus,
    /// Every motor that is asked.
    pub motors: &'a [MotorStatus],
}

/// The last minute of one connection, and what it is diagnosed as.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// When it was looked at last, and what was seen then.
    looked_at: Option<Instant>,
    seen: Vec<Seen>,
    /// Seconds that were counted.
    second: u32,
    /// Oldest first.
    entries: Vec<Entry>,
    /// Replies with the delay of a latency timer among the last 256, at each of the last looks, oldest first.
    delayed: Vec<u32>,
    verdict: Verdict,
}

impl Record {
    const EVERY: Duration = Duration::from_secs(1);
    /// While the page is hidden nothing is shown, and nobody looks: what lies between is not one
    /// second.
    const EVERY_MAX: Duration = Duration::from_secs(3);
    /// A wheel that has been turning for a while is compared with the time when it stood.
    const SECONDS_MAX: u32 = 60;
    /// A diagnosis is of the present.
    pub const RECENT: u32 = 10;
    /// In this time a slow adapter is noticed.
    const NEW: u32 = 4;
    /// Two queries of an idle motor: what is lost of a second that ends so may be the beginning of a silence.
    const OVERDUE_AFTER: Duration = Duration::from_millis(200);

    /// The line is another from now on.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Looks at the line, which does something once a second. Whether it did. `None` is a port that is not open.
    pub fn look(&mut self, line: Option<Line>) -> bool {
        let Some(line) = line else {
            self.clear();
            return true;
        };
        if self.looked_at.is_none_or(|at| line.now < at) {
            self.clear();
            self.verdict = Verdict::TooLittle;
        }
        let elapsed = self.looked_at.map(|at| line.now.since(at));
        if elapsed.is_some_and(|elapsed| elapsed < Self::EVERY) {
            // The header is not a second late, either.
            let is_refuted = self.verdict == Verdict::Healthy
                && line
                    .motors
                    .iter()
                    .any(|motor| header_says_lossy(motor.link.loss_per_mille));
            if is_refuted {
                self.verdict = Verdict::SomeLoss;
            }
            return is_refuted;
        }
        self.looked_at = Some(line.now);
        let mut seen = vec![Seen {
            id: None,
            counters: line.status.unaddressed,
            motion: Motion::Unclear,
            silent: false,
            overdue: false,
            loss_per_mille: None,
        }];
        for motor in line.motors {
            seen.push(Seen {
                id: Some(motor.id),
                counters: motor.counters,
                motion: motion(motor, line.now),
                silent: motor.is_silent(),
                overdue: motor
                    .last
                    .is_none_or(|last| line.now.since(last.at) > Self::OVERDUE_AFTER),
                loss_per_mille: motor.link.loss_per_mille,
            });
        }
        if elapsed.is_some_and(|elapsed| elapsed <= Self::EVERY_MAX) {
            self.count(&seen);
            self.delayed.push(delayed_of(&line.status.round_trip));
            let kept = self.delayed.len().saturating_sub(Self::NEW as usize + 1);
            self.delayed.drain(..kept);
            let mut findings = self.findings(&seen, line.status.round_trip);
            findings.computer_is_late = line.status.late_hz >= LATE_MIN_HZ;
            self.verdict = diagnose(&findings);
        }
        self.seen = seen;
        true
    }

    /// What the last look has shown.
    #[must_use]
    pub const fn verdict(&self) -> &Verdict {
        &self.verdict
    }

    /// Whether a motor lost 5 % or more of its requests in the last ten seconds, and at least five. The verdict names no
    /// cause for that where the computer is late, or where fewer than 50 were asked.
    #[must_use]
    pub fn loses_much(&self) -> bool {
        let findings = self.findings(&self.seen, RoundTripStatus::default());
        let mut motors = findings.motors.iter();
        motors.any(|motor| loses_much(&motor.recent))
    }

    /// What happened to all motors in the last seconds, at most ten, and how many seconds these were.
    #[must_use]
    pub fn judged(&self) -> (u32, Tally) {
        let mut judged = Tally::default();
        let recent = |entry: &&Entry| entry.second + Self::RECENT > self.second;
        for entry in self.entries.iter().filter(recent) {
            if entry.id.is_some() {
                judged += entry.tally;
            }
        }
        let seconds = self.second.min(Self::RECENT);
        (seconds, judged.with_requests_of_before())
    }

    /// Another second is over.
    fn count(&mut self, seen: &[Seen]) {
        self.second += 1;
        let oldest = self.second.saturating_sub(Self::SECONDS_MAX);
        self.entries.retain(|entry| entry.second > oldest);
        for now in seen {
            if let Some(before) = self.seen.iter().find(|before| before.id == now.id) {
                self.entries.push(Entry {
                    second: self.second,
                    id: now.id,
                    tally: Tally::since(&before.counters, &now.counters),
                    motion: if before.motion == now.motion {
                        now.motion
                    } else {
                        Motion::Unclear
                    },
                });
            }
        }
    }

    fn findings(&self, seen: &[Seen], round_trip: RoundTripStatus) -> Findings {
        let of_motors = self.entries.iter().filter(|entry| entry.id.is_some());
        let new = of_motors.filter(|entry| entry.second + Self::NEW > self.second);
        let mut findings = Findings {
            round_trip,
            newly_answered: new.map(|entry| entry.tally.answered).sum(),
            ..Findings::default()
        };
        if let [before, .., now] = *self.delayed {
            findings.newly_delayed = now.saturating_sub(before);
        }
        for now in seen {
            let [mut recent, mut standing, mut turning] = [Tally::default(); 3];
            let [mut heard, mut quiet] = [Tally::default(); 2];
            // Latest first: the second before a silent one is that in which the silence began.
            let mut falls_silent = now.overdue;
            let mut is_quiet = true;
            let own = self.entries.iter().rev();
            for entry in own.filter(|entry| entry.id == now.id) {
                if entry.second + Self::RECENT > self.second {
                    recent += entry.tally;
                    let is_silent = entry.tally.answered == 0;
                    is_quiet &= is_silent;
                    if is_quiet {
                        quiet += entry.tally;
                    }
                    if !is_silent && !falls_silent {
                        heard += entry.tally;
                    }
                    falls_silent = is_silent && entry.tally.asked > 0;
                }
                match entry.motion {
                    Motion::Standing => standing += entry.tally,
                    Motion::Turning => turning += entry.tally,
                    Motion::Unclear => {}
                }
            }
            if let Some(id) = now.id {
                findings.motors.push(MotorFindings {
                    id,
                    recent,
                    heard,
                    quiet,
                    silent: now.silent,
                    loss_per_mille: now.loss_per_mille,
                    standing,
                    turning,
                });
            } else {
                findings.foreign = recent.foreign;
                findings.levels = recent.levels;
                findings.text = recent.text;
                findings.blocks = recent.blocks;
            }
        }
        findings
    }
}

fn delayed_of(round_trip: &RoundTripStatus) -> u32 {
    let bins = ROUND_TRIP_BINS_US.iter().zip(&round_trip.histogram);
    let delayed = bins.filter(|(end_us, _)| LATENCY_TIMER_ENDS_US.contains(end_us));
    delayed.map(|(_, count)| u32::from(*count)).sum()
}

/// How a wheel is at this moment.
fn motion(motor: &MotorStatus, now: Instant) -> Motion {
    match motor.speed {
        Some((at, _)) if now.since(at) > FRESH_FOR => Motion::Unclear,
        Some((_, speed)) if speed.magnitude() >= TURNING_FROM_RPM => Motion::Turning,
        Some(_) => Motion::Standing,
        None => Motion::Unclear,
    }
}

#[cfg(test)]
#[path = "record_tests.rs"]
mod tests;

#[cfg(test)]
#[path = "odd_bytes_tests.rs"]
mod odd_bytes_tests;
