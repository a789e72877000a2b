//! What happened on the line, second by second.

use std::time::Duration;

use motorlink_messages::{
    Connection,
    bus::{Counters, RoundTripStatus},
    protocol::{Instant, MotorId},
};

use crate::{
    features::link_doctor::doctor::{
        Findings, MotorFindings, Tally, Verdict, diagnose, header_says_lossy,
    },
    model::snapshot::Session,
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

/// The last minute of one connection, and what it is diagnosed as.
#[derive(Clone, Debug, Default)]
pub(crate) struct Record {
    connection: Option<Connection>,
    /// When it was looked at last, and what was seen then.
    looked_at: Option<Instant>,
    seen: Vec<Seen>,
    /// Seconds that were counted.
    second: u32,
    /// Oldest first.
    entries: Vec<Entry>,
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
    pub(crate) const RECENT: u32 = 10;
    /// Two queries of an idle motor: what is lost of a second that ends so may be the beginning of a silence.
    const OVERDUE_AFTER: Duration = Duration::from_millis(200);

    /// The line is another from now on.
    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }

    /// Looks at the line, which does something once a second. Whether it did.
    pub(crate) fn look(&mut self, session: &Session) -> bool {
        let Some(line) = &session.line else {
            self.clear();
            return true;
        };
        let went_back = self.looked_at.is_some_and(|at| session.now < at);
        if went_back || self.connection != Some(session.connection) {
            self.clear();
            self.connection = Some(session.connection);
            self.verdict = Verdict::TooLittle;
        }
        let elapsed = self.looked_at.map(|at| session.now.since(at));
        if elapsed.is_some_and(|elapsed| elapsed < Self::EVERY) {
            // The header is not a second late, either.
            let is_refuted = self.verdict == Verdict::Healthy
                && session
                    .motors
                    .iter()
                    .any(|motor| header_says_lossy(motor.link.loss_per_mille));
            if is_refuted {
                self.verdict = Verdict::SomeLoss;
            }
            return is_refuted;
        }
        self.looked_at = Some(session.now);
        let mut seen = vec![Seen {
            id: None,
            counters: line.unaddressed,
            motion: Motion::Unclear,
            silent: false,
            overdue: false,
            loss_per_mille: None,
        }];
        for motor in &session.motors {
            seen.push(Seen {
                id: Some(motor.id),
                counters: motor.counters,
                motion: motion(session, motor.id),
                silent: motor.silent,
                overdue: motor
                    .last
                    .is_none_or(|last| session.now.since(last.at) > Self::OVERDUE_AFTER),
                loss_per_mille: motor.link.loss_per_mille,
            });
        }
        if elapsed.is_some_and(|elapsed| elapsed <= Self::EVERY_MAX) {
            self.count(&seen);
            let mut findings = self.findings(&seen, line.round_trip);
            findings.computer_is_late = line.late_hz >= LATE_MIN_HZ;
            self.verdict = diagnose(&findings);
        }
        self.seen = seen;
        true
    }

    /// What the last look has shown.
    pub(crate) const fn verdict(&self) -> &Verdict {
        &self.verdict
    }

    /// What happened to all motors in the last ten seconds.
    pub(crate) fn judged(&self) -> Tally {
        let mut judged = Tally::default();
        let recent = |entry: &&Entry| entry.second + Self::RECENT > self.second;
        for entry in self.entries.iter().filter(recent) {
            if entry.id.is_some() {
                judged += entry.tally;
            }
        }
        judged
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
        let mut findings = Findings {
            round_trip,
            ..Findings::default()
        };
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

/// How a wheel is at this moment.
fn motion(session: &Session, id: MotorId) -> Motion {
    match session.speed(id) {
        Some(speed) if !speed.is_fresh() => Motion::Unclear,
        Some(speed) if speed.value.magnitude() >= TURNING_FROM_RPM => Motion::Turning,
        Some(_) => Motion::Standing,
        None => Motion::Unclear,
    }
}
