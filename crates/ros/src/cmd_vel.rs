//! The newest command of `cmd_vel`, and for how long it counts.

use std::time::{Duration, Instant};

use crate::node::{attachment::Attachment, messages::Twist};

/// No robot is asked for more, in m/s and rad/s.
const SPEED_MAX: f64 = 1_000.0;
/// Senders that are remembered. More are no robot.
const SENDERS_MAX: usize = 16;
/// A clock may be so much faster or slower: 500 ppm, as one that is set slowly, and up to 100 ms.
const DRIFT_PER: i64 = 2_000;
const DRIFT_MAX_NS: i64 = 100_000_000;
/// Nobody asks when no command that moves the robot has come for so long: a slow publisher sends one a second.
pub const REST: Duration = Duration::from_secs(2);
/// Less is no delay that matters.
const LATE_NS: i64 = 100_000_000;
/// Before, nobody knows how fast the messages of a sender are.
const LEARNED_AFTER: Duration = Duration::from_millis(500);
/// Messages that stay so late for so long come from a sender whose clock was set.
const CLOCK_SET_AFTER: Duration = Duration::from_secs(1);
/// Messages that were delayed come close together: their delay falls. That of a clock that was set changes no more than this.
const STEADY_NS: i64 = 50_000_000;

/// What is asked of the robot.
#[derive(Debug)]
pub struct CmdVel {
    timeout: Duration,
    /// Ages are counted from here.
    start: Instant,
    /// The newest command, and the time from which it counts.
    newest: Option<(Instant, Twist)>,
    /// The newest command that moves the robot, in time or late.
    moving: Option<Instant>,
    /// The newest last.
    senders: Vec<([u8; 16], Sender)>,
    /// Since when the sender of the newest command asks, after a rest: see [`Sender::run`].
    run: Option<Instant>,
}

/// What became of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taken {
    /// It is the newest command.
    InTime,
    /// The network has delayed it for longer than a command counts, or it came out of order, or its sender is not known long enough
    /// to tell.
    TooLate,
    /// The clock of its sender was set, or the network delays all of it: which one is not known.
    ClockSet,
    /// It has a value that is no speed of a robot: no number, or 1,000 and more. No command counts any more.
    NoSpeed,
}

impl CmdVel {
    /// A command counts for `timeout`.
    #[must_use]
    pub fn new(timeout: Duration, start: Instant) -> Self {
        Self {
            timeout,
            start,
            newest: None,
            moving: None,
            senders: Vec::new(),
            run: None,
        }
    }

    /// Takes a message.
    pub fn take(&mut self, now: Instant, twist: Twist, attachment: Attachment) -> Taken {
        let values = [twist.linear.x, twist.angular.z];
        // False for what is no number, too.
        if !values.iter().all(|value| value.abs() < SPEED_MAX) {
            self.newest = None;
            self.moving = Some(now);
            return Taken::NoSpeed;
        }
        let moves = values != [0.0, 0.0];
        if moves {
            self.moving = Some(now);
        }
        let delay = self.delay(now, attachment, moves);
        // A command that was delayed counts for what is left of its time.
        let from = delay.map(|delay| now.checked_sub(delay));
        match from {
            Ok(Some(from)) if now.duration_since(from) < self.timeout => {
                self.newest = Some((from, twist));
                Taken::InTime
            }
            Ok(_) => Taken::TooLate,
            Err(taken) => taken,
        }
    }

    /// How much longer than the fastest of its sender the message was on its way.
    fn delay(
        &mut self,
        now: Instant,
        attachment: Attachment,
        moves: bool,
    ) -> Result<Duration, Taken> {
        let at_ns = nanoseconds(now.saturating_duration_since(self.start));
        let mut known = self.senders.iter();
        let place = known.position(|(name, _)| *name == attachment.sender);
        let place = place.unwrap_or_else(|| {
            if self.senders.len() >= SENDERS_MAX {
                self.senders.remove(0);
            }
            let sender = Sender {
                since_ns: at_ns,
                ..Sender::default()
            };
            self.senders.push((attachment.sender, sender));
            self.senders.len() - 1
        });
        let Some((_, sender)) = self.senders.get_mut(place) else {
            return Err(Taken::TooLate);
        };
        sender.follow(now, attachment, moves)?;
        let delay_ns = sender.delay_ns(at_ns, at_ns.saturating_sub(attachment.sent_ns))?;
        // Of messages that were all delayed, each one looks like the fastest.
        if at_ns - sender.since_ns < nanoseconds(LEARNED_AFTER) {
            return Err(Taken::TooLate);
        }
        sender.judge_beginning(attachment);
        self.run = sender.run;
        Ok(Duration::from_nanos(u64::try_from(delay_ns).unwrap_or(0)))
    }

    /// The computer has slept: what was asked before is not asked now, and how late messages are is not known.
    pub fn forget(&mut self, now: Instant) {
        self.newest = None;
        let at_ns = nanoseconds(now.saturating_duration_since(self.start));
        for (_, sender) in &mut self.senders {
            (sender.since_ns, sender.fastest_ns, sender.late) = (at_ns, None, None);
        }
    }

    /// Whether the sender of the newest command has begun to ask since then, after a rest. Its own clock and the numbers of its
    /// messages show that: a silence of the network shows nothing.
    #[must_use]
    pub fn has_begun_since(&self, since: Instant) -> bool {
        self.run.is_some_and(|began| began > since)
    }

    /// The command that counts; `None` if commands have ceased.
    #[must_use]
    pub fn wanted(&self, now: Instant) -> Option<Twist> {
        let (from, twist) = self.newest?;
        (now.duration_since(from) < self.timeout).then_some(twist)
    }

    /// Whether nobody has asked the robot to move since `since`, for the time of [`REST`].
    #[must_use]
    pub fn rests(&self, now: Instant, since: Instant) -> bool {
        let last = self.moving.map_or(since, |moving| moving.max(since));
        now.duration_since(last) >= REST
    }
}

/// A publisher.
#[derive(Debug, Default)]
struct Sender {
    /// From when on it is learned how fast its messages are.
    since_ns: i64,
    /// Its difference between arrival and sending then.
    learned_ns: i64,
    /// Its first message. It may have sent others before.
    first: Option<Attachment>,
    /// The number of its newest message.
    number: i64,
    /// When it sent its newest message that moves the robot.
    moving_sent_ns: Option<i64>,
    /// Whether messages since that one are missing.
    is_cut: bool,
    /// When it began to ask, after a rest of 2 s; `None` if it is not known to have rested.
    run: Option<Instant>,
    /// Its smallest difference between arrival and sending, by the two clocks, and when it was found.
    fastest_ns: Option<(i64, i64)>,
    /// When its messages began to be late, and the smallest delay since.
    late: Option<(i64, i64)>,
}

impl Sender {
    /// Follows what it sends, late or not.
    fn follow(&mut self, now: Instant, attachment: Attachment, moves: bool) -> Result<(), Taken> {
        let Attachment {
            number, sent_ns, ..
        } = attachment;
        if self.first.is_none() {
            self.first = Some(attachment);
        } else if number <= self.number {
            return Err(Taken::TooLate);
        } else {
            self.is_cut |= number > self.number.saturating_add(1);
        }
        self.number = number;
        if moves {
            let before = self.moving_sent_ns.replace(sent_ns);
            let is_begin =
                before.is_none_or(|before| sent_ns.saturating_sub(before) >= nanoseconds(REST));
            if is_begin {
                self.run = (!self.is_cut).then_some(now);
            }
            self.is_cut = false;
        }
        Ok(())
    }

    /// A sender that is seen late may have asked all the time: it has sent messages for 2 s before its first one came.
    fn judge_beginning(&mut self, attachment: Attachment) {
        let Some(first) = self.first.filter(|first| first.number > 1) else {
            return;
        };
        let seen = attachment.number.saturating_sub(first.number);
        if seen == 0 {
            return;
        }
        let period_ns = attachment.sent_ns.saturating_sub(first.sent_ns) / seen;
        if period_ns.saturating_mul(first.number - 1) >= nanoseconds(REST) {
            self.run = None;
        }
        // Once is enough.
        self.first = Some(Attachment { number: 1, ..first });
    }

    fn delay_ns(&mut self, at_ns: i64, difference_ns: i64) -> Result<i64, Taken> {
        let Some((found_ns, fastest_ns)) = self.fastest_ns else {
            (self.fastest_ns, self.learned_ns) = (Some((at_ns, difference_ns)), difference_ns);
            return Ok(0);
        };
        let drift_ns = ((at_ns - found_ns) / DRIFT_PER).min(DRIFT_MAX_NS);
        let delay_ns = difference_ns.saturating_sub(fastest_ns.saturating_add(drift_ns));
        let (since_ns, smallest_ns) = match self.late {
            _ if delay_ns <= 0 => {
                let is_learned = at_ns - self.since_ns >= nanoseconds(LEARNED_AFTER);
                let known_ns = if is_learned {
                    fastest_ns
                } else {
                    self.learned_ns
                };
                if known_ns.saturating_sub(difference_ns) > LATE_NS {
                    // What came before was late: it is learned again.
                    (self.since_ns, self.learned_ns) = (at_ns, difference_ns);
                }
                (self.fastest_ns, self.late) = (Some((at_ns, difference_ns)), None);
                return Ok(0);
            }
            _ if delay_ns < LATE_NS => {
                self.late = None;
                return Ok(delay_ns);
            }
            // What falls is a queue that empties.
            Some((since_ns, smallest_ns)) if delay_ns >= smallest_ns - STEADY_NS => {
                (since_ns, smallest_ns.min(delay_ns))
            }
            _ => (at_ns, delay_ns),
        };
        if at_ns - since_ns >= nanoseconds(CLOCK_SET_AFTER) {
            let fastest_ns = difference_ns.saturating_sub(delay_ns - smallest_ns);
            (self.fastest_ns, self.late) = (Some((at_ns, fastest_ns)), None);
            return Err(Taken::ClockSet);
        }
        self.late = Some((since_ns, smallest_ns));
        Ok(delay_ns)
    }
}

fn nanoseconds(duration: Duration) -> i64 {
    i64::try_from(duration.as_nanos()).unwrap_or(i64::MAX)
}

#[cfg(test)]
#[path = "cmd_vel_tests.rs"]
mod tests;
