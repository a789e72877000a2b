//! Commands in time, late, and of clocks that were set.
#![cfg(test)]

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
        let mut publisher = Self {
            start,
            cmd_vel: CmdVel::new(Duration::from_millis(500), start),
            number: 0,
            clock_ms: 1_700_000_000_000,
        };
        // Its clock is known.
        assert_eq!(publisher.sent(0, 10), Taken::TooLate);
        publisher
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
    assert_eq!(publisher.sent(1_000, 1_010), Taken::InTime);
    assert!(publisher.is_asked(1_509));
    assert!(!publisher.is_asked(1_510));
}

#[test]
fn a_command_that_was_delayed_counts_for_what_is_left() {
    let mut publisher = Publisher::new();
    assert_eq!(publisher.sent(1_100, 1_410), Taken::InTime);
    assert!(publisher.is_asked(1_600));
    assert!(!publisher.is_asked(1_615));
}

#[test]
fn what_a_network_delayed_for_seconds_drives_nothing() {
    let mut publisher = Publisher::new();
    // 50 messages of 20 Hz arrive together, 3 s after the first of them was sent.
    for number in 1..50 {
        let sent = publisher.sent(number * 50, 3_000 + number);
        assert_eq!(sent, Taken::TooLate);
    }
    assert!(!publisher.is_asked(3_100));
    let sent = publisher.sent(3_200, 3_210);
    assert_eq!(sent, Taken::InTime, "the network has recovered");
}

#[test]
fn what_an_unknown_sender_has_sent_long_ago_drives_nothing() {
    let mut publisher = Publisher::new();
    publisher.cmd_vel = CmdVel::new(Duration::from_millis(500), publisher.start);
    for number in 1..50 {
        let sent = publisher.sent(number * 50, 3_000 + number);
        assert_eq!(sent, Taken::TooLate);
    }
    assert_eq!(publisher.sent(3_600, 3_610), Taken::InTime);
}

#[test]
fn a_clock_that_was_set_back_is_said_after_a_second() {
    let mut publisher = Publisher::new();
    for ms in (550..1_000).step_by(50) {
        assert_eq!(publisher.sent(ms, ms), Taken::InTime);
    }
    publisher.clock_ms -= 3_600_000;
    for ms in (1_000..2_000).step_by(50) {
        assert_eq!(publisher.sent(ms, ms), Taken::TooLate);
    }
    assert_eq!(publisher.sent(2_000, 2_000), Taken::ClockSet);
    assert_eq!(publisher.sent(2_050, 2_050), Taken::InTime);
    publisher.clock_ms += 7_200_000;
    assert_eq!(publisher.sent(2_100, 2_100), Taken::InTime);
}

#[test]
fn a_clock_that_drifts_delays_nothing() {
    for ppm in [400_i64, -400] {
        let mut publisher = Publisher::new();
        let clock_ms = publisher.clock_ms;
        for second in 1..20_000 {
            publisher.clock_ms = clock_ms + ppm * i64::try_from(second).unwrap() / 1_000;
            let sent = publisher.sent(second * 1_000, second * 1_000);
            assert_eq!(sent, Taken::InTime);
            assert!(publisher.is_asked(second * 1_000 + 390));
        }
    }
}

#[test]
fn missing_messages_are_noticed() {
    let mut publisher = Publisher::new();
    let has_missed = |publisher: &Publisher, ms| {
        let now = publisher.at(ms);
        publisher.cmd_vel.has_missed(now)
    };
    publisher.sent(1_000, 1_000);
    // A message that is lost while others come matters little.
    publisher.number += 1;
    publisher.sent(1_100, 1_100);
    assert!(!has_missed(&publisher, 1_100));
    publisher.number += 1;
    publisher.sent(4_000, 4_000);
    publisher.sent(4_001, 4_001);
    assert!(has_missed(&publisher, 4_010));
    assert!(!has_missed(&publisher, 6_001));
}

#[test]
fn an_old_number_does_nothing() {
    let mut publisher = Publisher::new();
    publisher.sent(1_000, 1_000);
    publisher.number -= 1;
    assert_eq!(publisher.sent(1_100, 1_100), Taken::TooLate);
}

#[test]
fn what_is_no_speed_ends_the_command() {
    let mut publisher = Publisher::new();
    for wrong in [f64::NAN, f64::INFINITY, -1e300, 1_000.0] {
        publisher.sent(1_000, 1_000);
        assert!(publisher.is_asked(1_100), "{wrong}");
        let now = publisher.at(1_100);
        let taken = publisher.cmd_vel.take(now, twist(wrong, 0.0), None);
        assert_eq!(taken, Taken::NoSpeed);
        assert!(!publisher.is_asked(1_100), "{wrong}");
    }
}

#[test]
fn it_rests_when_nobody_has_asked_for_two_seconds() {
    let mut publisher = Publisher::new();
    publisher.sent(1_000, 1_000);
    let since = publisher.at(0);
    assert!(!publisher.cmd_vel.rests(publisher.at(2_999), since));
    publisher
        .cmd_vel
        .take(publisher.at(2_999), twist(0.0, 0.0), None);
    assert!(publisher.cmd_vel.rests(publisher.at(3_000), since));
    let later = publisher.at(1_001);
    assert!(!publisher.cmd_vel.rests(publisher.at(3_000), later));
}
