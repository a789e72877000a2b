//! What a busy machine delays is counted, and what the line itself takes is not.
#![cfg(test)]

mod fixture;

use std::time::Duration;

use fixture::{Fixture, ID, ms, rpm};
use motorlink_simulator::WorldConfig;

fn late_hz(fixture: &Fixture) -> u16 {
    fixture.bus.line_status(fixture.now).late_hz
}

/// Runs for a second. Every 17 ms, another phase of the drive frames each time, the machine is too busy to call
/// the bus for so long.
fn busy_second(fixture: &mut Fixture, busy: Duration) {
    for _ in 0..60 {
        fixture.run(ms(17).saturating_sub(busy));
        fixture.sleep(busy);
    }
}

#[test]
fn a_machine_that_calls_in_time_is_never_late() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(3_000));
    assert_eq!(late_hz(&fixture), 0);
}

#[test]
fn calls_and_replies_that_a_busy_machine_delays_are_counted_for_a_second() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    busy_second(&mut fixture, ms(8));
    let late = late_hz(&fixture);
    assert!((20..=110).contains(&late), "{late} a second");
    fixture.run(ms(1_200));
    assert_eq!(late_hz(&fixture), 0);
}

#[test]
fn a_delay_within_a_millisecond_is_not_late() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    busy_second(&mut fixture, Duration::from_micros(900));
    assert_eq!(late_hz(&fixture), 0);
}

#[test]
fn a_motor_that_is_slow_to_answer_is_not_late() {
    let slow = WorldConfig {
        turnaround: ms(4),
        ..WorldConfig::default()
    };
    let mut fixture = Fixture::watching(slow, &[ID]);
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_000));
    assert_eq!(late_hz(&fixture), 0);
}
