//! Commands in time, late, and of clocks that were set.
#![cfg(test)]

use super::*;
use crate::rover::tests::twist;

const MS: i64 = 1_000_000;

/// Of another sender.
fn unknown() -> Attachment {
    Attachment {
        number: 1,
        sent_ns: 0,
        sender: [9; 16],
    }
}

struct Publisher {
    start: Instant,
    cmd_vel: CmdVel,
    number: i64,
    asked: Twist,
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
            asked: twist(0.1, 0.0),
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
        self.cmd_vel.take(now, self.asked, attachment)
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
    // These came sooner, so that the others were late.
    for ms in (3_600..4_100).step_by(50) {
        assert_eq!(publisher.sent(ms, ms + 10), Taken::TooLate);
    }
    assert_eq!(publisher.sent(4_100, 4_110), Taken::InTime);
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
    // Forward: those before seem to have been late.
    publisher.clock_ms += 7_200_000;
    for ms in (2_100..2_600).step_by(50) {
        assert_eq!(publisher.sent(ms, ms), Taken::TooLate);
    }
    assert_eq!(publisher.sent(2_600, 2_600), Taken::InTime);
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
fn a_sender_begins_to_ask_after_a_rest_of_its_own() {
    let begun = |publisher: &Publisher, since| {
        let since = publisher.at(since);
        publisher.cmd_vel.has_begun_since(since)
    };
    let mut publisher = Publisher::new();
    for ms in (550..3_000).step_by(50) {
        publisher.sent(ms, ms);
    }
    assert!(!begun(&publisher, 2_000), "it has asked all the time");
    // A silence in which nothing is missing, by its clock and its numbers.
    publisher.sent(5_200, 5_200);
    assert!(begun(&publisher, 3_000));
    // The network delivers three seconds at once, in order.
    for ms in (5_250..8_300).step_by(50) {
        publisher.sent(ms, ms.max(8_250));
    }
    assert!(!begun(&publisher, 6_000));
    // The network loses three seconds.
    publisher.number += 60;
    publisher.sent(11_300, 11_300);
    assert!(!begun(&publisher, 9_000));
    publisher.asked = twist(0.0, 0.0);
    publisher.sent(12_000, 12_000);
    publisher.asked = twist(0.1, 0.0);
    publisher.sent(13_400, 13_400);
    assert!(begun(&publisher, 13_000));
}

#[test]
fn a_sender_that_is_seen_late_may_have_asked_all_the_time() {
    for (sent_before, has_begun) in [(5_000, false), (45, false), (5, true), (0, true)] {
        let mut publisher = Publisher::new();
        publisher.cmd_vel = CmdVel::new(Duration::from_millis(500), publisher.start);
        publisher.number = sent_before;
        for ms in (1_000..2_000).step_by(50) {
            publisher.sent(ms, ms);
        }
        let since = publisher.at(900);
        assert_eq!(
            publisher.cmd_vel.has_begun_since(since),
            has_begun,
            "{sent_before}"
        );
    }
}

#[test]
fn a_queue_that_empties_slowly_moves_nothing_until_it_is_empty() {
    let mut publisher = Publisher::new();
    publisher.cmd_vel = CmdVel::new(Duration::from_millis(100), publisher.start);
    // 10 s of messages arrive twice as fast as they were sent.
    for number in 0..200 {
        let sent = publisher.sent(number * 50, 10_000 + number * 25);
        assert_eq!(sent, Taken::TooLate, "{number}");
    }
}

#[test]
fn after_a_sleep_it_is_learned_again_how_late_messages_are() {
    let mut publisher = Publisher::new();
    assert_eq!(publisher.sent(1_000, 1_000), Taken::InTime);
    let now = publisher.at(1_010);
    publisher.cmd_vel.forget(now);
    assert!(!publisher.is_asked(1_010));
    // Sent before the sleep of an hour, during it, and after it.
    for sent_ms in [1_050, 1_800_000, 3_600_900] {
        assert_eq!(publisher.sent(sent_ms, 1_050), Taken::TooLate);
    }
    assert_eq!(publisher.sent(3_601_500, 1_600), Taken::InTime);
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
        let taken = publisher.cmd_vel.take(now, twist(wrong, 0.0), unknown());
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
        .take(publisher.at(2_999), twist(0.0, 0.0), unknown());
    assert!(publisher.cmd_vel.rests(publisher.at(3_000), since));
    let later = publisher.at(1_001);
    assert!(!publisher.cmd_vel.rests(publisher.at(3_000), later));
}
