//! What a busy machine delays is counted, and what the line itself takes is not.

use std::time::Duration;

use crate::fixture::{Fixture, ID, id, ms, rpm};
use motorlink_bus::{BusSettings, Command, CommandRate};
use motorlink_simulator::{WireFaults, WorldConfig};

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

/// Runs for five seconds on a machine that stalls for 30 ms twelve times a second.
fn overloaded(fixture: &mut Fixture) {
    for _ in 0..60 {
        fixture.run(ms(53));
        fixture.sleep(ms(30));
    }
}

#[test]
fn a_reply_that_the_computer_takes_late_is_late_and_not_lost() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    overloaded(&mut fixture);
    let status = fixture.status(ID);
    let (late, lost) = (status.counters.late, status.counters.lost());
    assert!(late > 0, "{:?}", status.counters);
    assert_eq!(lost, 0, "{:?}", status.counters);
    assert_eq!(status.link.loss_per_mille, Some(0), "{:?}", status.link);
    assert!(status.link.late_per_mille > Some(0), "{:?}", status.link);
}

#[test]
fn a_reply_that_the_line_loses_is_lost_and_not_late() {
    let mut fixture = Fixture::one_motor();
    fixture.world.set_faults(WireFaults {
        lose_reply: 0.1,
        ..WireFaults::default()
    });
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(5_000));
    let status = fixture.status(ID);
    let (late, lost) = (status.counters.late, status.counters.lost());
    assert!(late == 0 && lost > 15, "{:?}", status.counters);
    assert_eq!(status.counters.not_asked, 0);
    assert_eq!(status.link.late_per_mille, Some(0), "{:?}", status.link);
}

#[test]
fn rounds_that_the_computer_was_too_late_for_are_not_asked() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_000));
    fixture.forget_the_past();
    fixture.sleep(ms(300));
    fixture.run(ms(1_000));
    // Of 65 drive frames and 13 queries; what the bus catches up was asked.
    let asked = fixture.sent.len() as u64;
    let counters = fixture.status(ID).counters;
    assert!(
        (76..=79).contains(&(asked + counters.not_asked)),
        "{asked} asked, {counters:?}"
    );
    fixture.run(ms(1_000));
    assert_eq!(fixture.status(ID).counters.not_asked, counters.not_asked);
}

#[test]
fn a_line_that_is_too_slow_for_the_rate_blames_no_computer() {
    let mut fixture = Fixture::watching(WorldConfig::with_ids([ID, id(2)]), &[ID, id(2)]);
    fixture
        .command(Command::Configure(BusSettings {
            rate: CommandRate::new(500).unwrap(),
            ..BusSettings::default()
        }))
        .unwrap();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(2_000));
    assert_eq!(fixture.status(ID).counters.not_asked, 0);
}
