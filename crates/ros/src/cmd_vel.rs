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
    /// When a sender was last heard again after a silence in which it has sent more.
    missed: Option<Instant>,
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
            missed: None,
        }
    }

    /// Takes a message.
    pub fn take(&mut self, now: Instant, twist: Twist, attachment: Option<Attachment>) -> Taken {
        let values = [twist.linear.x, twist.angular.z];
        // False for what is no number, too.
        if !values.iter().all(|value| value.abs() < SPEED_MAX) {
            self.newest = None;
            self.moving = Some(now);
            return Taken::NoSpeed;
        }
        if values != [0.0, 0.0] {
            self.moving = Some(now);
        }
        let delay = match attachment {
            Some(attachment) => self.delay(now, attachment),
            None => Ok(Duration::ZERO),
        };
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
    fn delay(&mut self, now: Instant, attachment: Attachment) -> Result<Duration, Taken> {
        let at_ns = nanoseconds(now.saturating_duration_since(self.start));
        let mut known = self.senders.iter();
        let place = known.position(|(name, _)| *name == attachment.sender);
        let place = place.unwrap_or_else(|| {
            if self.senders.len() >= SENDERS_MAX {
                self.senders.remove(0);
            }
            let sender = Sender {
                since_ns: at_ns,
                newest_ns: at_ns,
                ..Sender::default()
            };
            self.senders.push((attachment.sender, sender));
            self.senders.len() - 1
        });
        let Some((_, sender)) = self.senders.get_mut(place) else {
            return Err(Taken::TooLate);
        };
        let before = sender.number.unwrap_or(attachment.number.saturating_sub(1));
        if before >= attachment.number {
            return Err(Taken::TooLate);
        }
        sender.number = Some(attachment.number);
        let silence_ns = at_ns - sender.newest_ns;
        sender.newest_ns = at_ns;
        let is_cut = before.saturating_add(1) < attachment.number;
        if is_cut && silence_ns >= nanoseconds(self.timeout) {
            self.missed = Some(now);
        }
        let delay_ns = sender.delay_ns(at_ns, at_ns.saturating_sub(attachment.sent_ns))?;
        // Of messages that were all delayed, each one looks like the fastest.
        if at_ns - sender.since_ns < nanoseconds(self.timeout) {
            return Err(Taken::TooLate);
        }
        Ok(Duration::from_nanos(u64::try_from(delay_ns).unwrap_or(0)))
    }

    /// Whether a silence of the last 2 s was none: its sender has sent more, and it has not come through.
    #[must_use]
    pub fn has_missed(&self, now: Instant) -> bool {
        let missed = self.missed;
        missed.is_some_and(|at| now.saturating_duration_since(at) < REST)
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
    /// When its first message came.
    since_ns: i64,
    /// When its newest message came.
    newest_ns: i64,
    /// The number of that message.
    number: Option<i64>,
    /// Its smallest difference between arrival and sending, by the two clocks, and when it was found.
    fastest_ns: Option<(i64, i64)>,
    /// When its messages began to be late, and by how much.
    late: Option<(i64, i64)>,
}

impl Sender {
    fn delay_ns(&mut self, at_ns: i64, difference_ns: i64) -> Result<i64, Taken> {
        let Some((found_ns, fastest_ns)) = self.fastest_ns else {
            self.fastest_ns = Some((at_ns, difference_ns));
            return Ok(0);
        };
        let drift_ns = ((at_ns - found_ns) / DRIFT_PER).min(DRIFT_MAX_NS);
        let delay_ns = difference_ns.saturating_sub(fastest_ns.saturating_add(drift_ns));
        let (since_ns, first_ns) = match self.late {
            _ if delay_ns <= 0 => {
                (self.fastest_ns, self.late) = (Some((at_ns, difference_ns)), None);
                return Ok(0);
            }
            _ if delay_ns < LATE_NS => {
                self.late = None;
                return Ok(delay_ns);
            }
            Some(late) if (delay_ns - late.1).abs() <= STEADY_NS => late,
            _ => (at_ns, delay_ns),
        };
        if at_ns - since_ns >= nanoseconds(CLOCK_SET_AFTER) {
            (self.fastest_ns, self.late) = (Some((at_ns, difference_ns)), None);
            return Err(Taken::ClockSet);
        }
        self.late = Some((since_ns, first_ns));
        Ok(delay_ns)
    }
}

fn nanoseconds(duration: Duration) -> i64 {
    i64::try_from(duration.as_nanos()).unwrap_or(i64::MAX)
}

#[cfg(test)]
#[path = "cmd_vel_tests.rs"]
mod tests;
