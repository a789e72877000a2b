//! The newest command of `cmd_vel`, and for how long it counts.

use std::{
    collections::HashMap,
    time::{Duration, Instant},
};

use crate::node::{attachment::Attachment, messages::Twist};

/// No robot is asked for more, in m/s and rad/s.
const SPEED_MAX: f64 = 1_000.0;
/// Senders that are remembered. More are no robot.
const SENDERS_MAX: usize = 16;
/// A clock may be so much faster or slower: 1 ms in a second.
const DRIFT_PER: i64 = 1_000;
/// Less is no delay that matters.
const LATE_NS: i64 = 100_000_000;
/// Messages that stay so late for so long come from a sender whose clock was set.
const CLOCK_SET_AFTER: Duration = Duration::from_secs(1);
/// Messages that were held up come close together: their delay falls. That of a clock that was set changes no more than this.
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
    senders: HashMap<[u8; 16], Sender>,
}

/// What became of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taken {
    /// It is the newest command.
    InTime,
    /// The network has held it up for longer than a command counts, or it came out of order.
    TooLate,
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
            senders: HashMap::new(),
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
        let delay = attachment.map_or(Some(Duration::ZERO), |attachment| {
            self.delay(now, attachment)
        });
        // A command that was held up counts for what is left of its time.
        let from = delay.and_then(|delay| now.checked_sub(delay));
        match from.filter(|from| now.duration_since(*from) < self.timeout) {
            Some(from) => {
                self.newest = Some((from, twist));
                Taken::InTime
            }
            None => Taken::TooLate,
        }
    }

    /// How much longer than the fastest of its sender the message was on its way; `None` for one that comes out of order.
    fn delay(&mut self, now: Instant, attachment: Attachment) -> Option<Duration> {
        if self.senders.len() >= SENDERS_MAX && !self.senders.contains_key(&attachment.sender) {
            self.senders.clear();
        }
        let at_ns = nanoseconds(now.duration_since(self.start));
        let sender = self.senders.entry(attachment.sender).or_default();
        if sender.number >= attachment.number {
            return None;
        }
        sender.number = attachment.number;
        let delay_ns = sender.delay_ns(at_ns, at_ns.saturating_sub(attachment.sent_ns));
        Some(Duration::from_nanos(u64::try_from(delay_ns).unwrap_or(0)))
    }

    /// The command that counts; `None` if commands have ceased.
    #[must_use]
    pub fn wanted(&self, now: Instant) -> Option<Twist> {
        let (from, twist) = self.newest?;
        (now.duration_since(from) < self.timeout).then_some(twist)
    }

    /// Whether nobody has asked the robot to move since `since`, for as long as a command counts.
    #[must_use]
    pub fn rests(&self, now: Instant, since: Instant) -> bool {
        let last = self.moving.map_or(since, |moving| moving.max(since));
        now.duration_since(last) >= self.timeout
    }
}

/// A publisher.
#[derive(Debug, Default)]
struct Sender {
    /// The number of its newest message.
    number: i64,
    /// Its smallest difference between arrival and sending, by the two clocks, and when it was found.
    fastest_ns: Option<(i64, i64)>,
    /// When its messages began to be late, and by how much.
    late: Option<(i64, i64)>,
}

impl Sender {
    fn delay_ns(&mut self, at_ns: i64, difference_ns: i64) -> i64 {
        let Some((found_ns, fastest_ns)) = self.fastest_ns else {
            self.fastest_ns = Some((at_ns, difference_ns));
            return 0;
        };
        let drift_ns = (at_ns - found_ns) / DRIFT_PER;
        let delay_ns = difference_ns.saturating_sub(fastest_ns.saturating_add(drift_ns));
        let (since_ns, first_ns) = match self.late {
            _ if delay_ns <= 0 => {
                (self.fastest_ns, self.late) = (Some((at_ns, difference_ns)), None);
                return 0;
            }
            _ if delay_ns < LATE_NS => {
                self.late = None;
                return delay_ns;
            }
            Some(late) if (delay_ns - late.1).abs() <= STEADY_NS => late,
            _ => (at_ns, delay_ns),
        };
        if at_ns - since_ns >= nanoseconds(CLOCK_SET_AFTER) {
            (self.fastest_ns, self.late) = (Some((at_ns, difference_ns)), None);
            return 0;
        }
        self.late = Some((since_ns, first_ns));
        delay_ns
    }
}

fn nanoseconds(duration: Duration) -> i64 {
    i64::try_from(duration.as_nanos()).unwrap_or(i64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rover::tests::twist;

    const MS: i64 = 1_000_000;

    struct Publisher {
        start: Instant,
        cmd_vel: CmdVel,
        number: i64,
        /// Its clock shows so much more.
        clock_ms: i64,
    }

    impl Publisher {
        fn new() -> Self {
            let start = Instant::now();
            Self {
                start,
                cmd_vel: CmdVel::new(Duration::from_millis(500), start),
                number: 0,
                clock_ms: 1_700_000_000_000,
            }
        }

        fn at(&self, ms: u64) -> Instant {
            self.start + Duration::from_millis(ms)
        }

        fn sent(&mut self, sent_ms: u64, arrives_ms: u64) -> Taken {
            self.number += 1;
            let sent_ms = i64::try_from(sent_ms).unwrap() + self.clock_ms;
            let attachment = Attachment {
                number: self.number,
                sent_ns: sent_ms * MS,
                sender: [1; 16],
            };
            let now = self.at(arrives_ms);
            self.cmd_vel.take(now, twist(0.1, 0.0), Some(attachment))
        }

        fn is_asked(&self, ms: u64) -> bool {
            self.cmd_vel.wanted(self.at(ms)).is_some()
        }
    }

    #[test]
    fn a_command_counts_for_its_time_only() {
        let mut publisher = Publisher::new();
        assert_eq!(publisher.sent(0, 10), Taken::InTime);
        assert!(publisher.is_asked(509));
        assert!(!publisher.is_asked(510));
    }

    #[test]
    fn a_command_that_was_held_up_counts_for_what_is_left() {
        let mut publisher = Publisher::new();
        publisher.sent(0, 10);
        assert_eq!(publisher.sent(100, 410), Taken::InTime);
        assert!(publisher.is_asked(600));
        assert!(!publisher.is_asked(615));
    }

    #[test]
    fn what_a_network_held_up_for_seconds_drives_nothing() {
        let mut publisher = Publisher::new();
        publisher.sent(0, 10);
        // 50 messages of 20 Hz arrive together, 3 s after the first of them was sent.
        for number in 1..50 {
            let sent = publisher.sent(number * 50, 3_000 + number);
            assert_eq!(
                sent == Taken::InTime,
                number * 50 + 500 > 3_000 + number - 10
            );
        }
        assert!(!publisher.is_asked(3_100));
        assert_eq!(
            publisher.sent(3_200, 3_210),
            Taken::InTime,
            "the network is well again"
        );
    }

    #[test]
    fn a_clock_that_was_set_stops_the_robot_for_a_second_at_most() {
        let mut publisher = Publisher::new();
        for ms in (0..1_000).step_by(50) {
            assert_eq!(publisher.sent(ms, ms), Taken::InTime);
        }
        publisher.clock_ms -= 3_600_000;
        for ms in (1_000..2_000).step_by(50) {
            assert_eq!(publisher.sent(ms, ms), Taken::TooLate);
        }
        assert_eq!(publisher.sent(2_000, 2_000), Taken::InTime);
        publisher.clock_ms += 7_200_000;
        assert_eq!(publisher.sent(2_050, 2_050), Taken::InTime);
    }

    #[test]
    fn a_clock_that_drifts_holds_nothing_up() {
        let mut publisher = Publisher::new();
        for second in 0..20_000 {
            // 500 ppm.
            let sent = publisher.sent(second * 1_000 - second / 2, second * 1_000);
            assert_eq!(sent, Taken::InTime);
            assert!(publisher.is_asked(second * 1_000 + 450));
        }
    }

    #[test]
    fn an_old_number_does_nothing() {
        let mut publisher = Publisher::new();
        publisher.sent(0, 0);
        publisher.number = 0;
        assert_eq!(publisher.sent(100, 100), Taken::TooLate);
    }

    #[test]
    fn what_is_no_speed_ends_the_command() {
        let mut publisher = Publisher::new();
        for wrong in [f64::NAN, f64::INFINITY, -1e300, 1_000.0] {
            publisher.sent(0, 0);
            assert!(publisher.is_asked(100), "{wrong}");
            let now = publisher.at(100);
            let taken = publisher.cmd_vel.take(now, twist(wrong, 0.0), None);
            assert_eq!(taken, Taken::NoSpeed);
            assert!(!publisher.is_asked(100), "{wrong}");
        }
    }

    #[test]
    fn it_rests_when_nobody_asks_it_to_move() {
        let mut publisher = Publisher::new();
        publisher.sent(0, 100);
        let (now, since) = (publisher.at(599), publisher.at(0));
        assert!(!publisher.cmd_vel.rests(now, since));
        publisher.cmd_vel.take(now, twist(0.0, 0.0), None);
        assert!(publisher.cmd_vel.rests(publisher.at(600), since));
        assert!(
            !publisher
                .cmd_vel
                .rests(publisher.at(600), publisher.at(101))
        );
    }
}
