//! Stop all motors: what it stops, and that nothing drives until Release.

use motorlink_bus::{Activity, Bus, Command, Consent, Refusal, StopReason};
use motorlink_protocol::{Instant, Mode};

use crate::fixture::{Fixture, ID, Sent, ms, rpm};
use crate::stopping::{STOP, brake, report, spinning};

#[test]
fn stopped_means_stopped_until_released_and_release_restores_nothing() {
    let mut fixture = spinning(100);
    fixture.command(STOP).unwrap();
    fixture.run(ms(1_000));
    assert!(fixture.bus.is_halted());
    assert_eq!(fixture.drive(rpm(50)), Err(Refusal::Halted));
    assert_eq!(
        fixture.command(Command::SwitchMode {
            id: ID,
            mode: Mode::Current
        }),
        Err(Refusal::Halted)
    );
    fixture.command(Command::Release).unwrap();
    fixture.forget_the_past();
    fixture.run(ms(2_000));
    assert!(fixture.drive_times(ID).is_empty());
    assert_eq!(fixture.activity(), Activity::Idle);
    assert_eq!(fixture.drive(rpm(50)), Ok(()));
}

#[test]
fn a_halt_outlives_the_port() {
    let mut bus = Bus::halted(Instant::ZERO);
    let drive = Command::Drive {
        id: ID,
        setpoint: rpm(50),
        consent: Consent::None,
    };
    assert_eq!(bus.command(Instant::ZERO, drive), Err(Refusal::Halted));
}

#[test]
fn a_stop_of_one_motor_does_not_halt_it() {
    let mut fixture = spinning(100);
    fixture.command(Command::Stop(ID)).unwrap();
    assert_eq!(fixture.drive(rpm(50)), Err(Refusal::Stopping(ID)));
    fixture.run(ms(400));
    assert!(fixture.true_rpm().abs() < 1.0);
    assert_eq!(fixture.drive(rpm(50)), Ok(()));
}

#[test]
fn a_page_that_does_not_answer_for_a_second_stops_its_motors() {
    let mut fixture = spinning(100);
    fixture.page_lives = false;
    let hung = fixture.now;
    fixture.run(ms(3_000));
    let first_brake = fixture
        .sent
        .iter()
        .find(|s| s.drive_of(ID) == Some(brake()))
        .unwrap();
    assert!(
        first_brake.at.since(hung) <= ms(1_100),
        "{:?}",
        first_brake.at.since(hung)
    );
    assert!(fixture.true_rpm().abs() < 1.0);
    assert_eq!(report(&fixture).reason, StopReason::PageSilent);
    // The page is back: that starts nothing.
    fixture.page_lives = true;
    fixture.forget_the_past();
    fixture.run(ms(2_000));
    assert!(fixture.drive_times(ID).is_empty());
    assert_eq!(fixture.drive(rpm(50)), Err(Refusal::Halted));
}

#[test]
fn stop_all_brakes_a_watched_wheel_that_turns_though_we_do_not_drive_it() {
    let mut fixture = spinning(100);
    // As after a reload: another bus, which knows of no command.
    fixture.bus = Bus::new(fixture.now);
    fixture.command(Command::Watch(ID)).unwrap();
    fixture.run(ms(150));
    assert!(fixture.true_rpm() > 20.0);
    fixture.command(STOP).unwrap();
    fixture.run(ms(1_000));
    assert!(fixture.true_rpm().abs() < 1.0);
    assert!(report(&fixture).motors[0].confirmed);
}

#[test]
fn stop_all_with_nothing_to_stop_ends_at_once_and_halts() {
    let mut fixture = Fixture::one_motor();
    // The coarse angle needs a while to show standstill.
    fixture.run(ms(300));
    fixture.forget_the_past();
    fixture.command(STOP).unwrap();
    fixture.run(ms(10));
    assert_eq!(report(&fixture).motors, []);
    assert!(fixture.bus.is_halted());
    assert!(fixture.sent.iter().all(Sent::is_query));
}
