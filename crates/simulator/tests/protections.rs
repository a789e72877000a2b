//! Protections and their recovery, after the maker's manual.

use crate::fixture::{Fixture, ms, query_detail, speed};
use motorlink_protocol::{Fault, Faults};

/// Drives at 100 rpm and gives the faults of the last reply.
fn faults_after(fixture: &mut Fixture, millis: u64) -> Faults {
    fixture.drive_for(speed(100), ms(millis));
    fixture.drive(speed(100)).expect("it always answers").faults
}

/// Blocked for over 5 s, clears after 5 s.
#[test]
fn a_blocked_wheel_stalls_after_5_s_and_is_free_again_5_s_later() {
    let mut fixture = Fixture::with_one_motor();
    fixture.drive_for(speed(100), ms(1000));
    fixture.motor_mut().block(true);
    assert_eq!(faults_after(&mut fixture, 4900), Faults::NONE);
    assert!((fixture.motor().current_a() - 2.7).abs() < 0.05);
    assert_eq!(
        faults_after(&mut fixture, 200),
        Faults::NONE.with(Fault::Stall)
    );
    assert_eq!(
        fixture.motor().torque_nm().to_bits(),
        0,
        "drive frames are ignored"
    );

    fixture.motor_mut().block(false);
    assert_eq!(
        faults_after(&mut fixture, 4600),
        Faults::NONE.with(Fault::Stall)
    );
    assert_eq!(fixture.motor().speed_rpm().to_bits(), 0);
    assert_eq!(faults_after(&mut fixture, 1500), Faults::NONE);
    assert!(fixture.motor().speed_rpm() > 50.0, "it drives again");
}

#[test]
fn a_wheel_that_is_held_at_zero_speed_is_not_stalled() {
    let mut fixture = Fixture::with_one_motor();
    fixture.motor_mut().block(true);
    fixture.drive_for(speed(0), ms(10_000));
    assert_eq!(fixture.query().faults, Faults::NONE);
}

/// 80 degrees trips, below 75 clears.
#[test]
fn a_hot_winding_rests_until_it_has_cooled_below_75() {
    let mut fixture = Fixture::with_one_motor();
    assert_eq!(faults_after(&mut fixture, 1000), Faults::NONE);
    fixture.motor_mut().set_temperature_c(81.0);
    assert_eq!(
        faults_after(&mut fixture, 200),
        Faults::NONE.with(Fault::OverTemperature)
    );
    assert_eq!(fixture.motor().torque_nm().to_bits(), 0, "the wheel coasts");
    assert_eq!(query_detail(&fixture.query()).0, 81);

    let mut seconds = 0;
    while !fixture.query().faults.is_none() {
        assert!(
            fixture.motor().temperature_c() > 74.9,
            "{}",
            fixture.motor().temperature_c()
        );
        fixture.wait(ms(1000));
        seconds += 1;
        assert!(seconds < 600, "it never cools");
    }
    let celsius = fixture.motor().temperature_c();
    assert!((74.0..75.1).contains(&celsius), "{celsius}");
    assert_eq!(faults_after(&mut fixture, 1000), Faults::NONE);
    assert!(fixture.motor().speed_rpm() > 50.0, "it drives again");
}

#[test]
fn a_hot_motor_at_rest_says_so_too() {
    let mut fixture = Fixture::with_one_motor();
    fixture.motor_mut().set_temperature_c(85.0);
    fixture.wait(ms(200));
    assert!(fixture.query().faults.contains(Fault::OverTemperature));
}

/// 3 A from the supply, clears after 5 s.
#[test]
fn bus_overcurrent_trips_and_clears_after_5_s() {
    let mut fixture = Fixture::with_one_motor();
    fixture.motor_mut().set_leak_a(0.0, 3.1);
    assert_eq!(
        faults_after(&mut fixture, 100),
        Faults::NONE.with(Fault::BusOvercurrent)
    );
    fixture.motor_mut().set_leak_a(0.0, 0.0);
    assert_eq!(
        faults_after(&mut fixture, 4800),
        Faults::NONE.with(Fault::BusOvercurrent)
    );
    assert_eq!(fixture.motor().speed_rpm().to_bits(), 0);
    assert_eq!(faults_after(&mut fixture, 1000), Faults::NONE);
    assert!(fixture.motor().speed_rpm() > 50.0);
}

/// 4.6 A in a phase, clears after 5 s, and trips again while the cause lasts.
#[test]
fn phase_overcurrent_trips_again_while_its_cause_lasts() {
    let mut fixture = Fixture::with_one_motor();
    fixture.motor_mut().set_leak_a(4.7, 0.0);
    assert!(faults_after(&mut fixture, 100).contains(Fault::PhaseOvercurrent));
    assert!(faults_after(&mut fixture, 6000).contains(Fault::PhaseOvercurrent));
}

#[test]
fn a_broken_encoder_shows_until_it_is_mended() {
    let mut fixture = Fixture::with_one_motor();
    fixture.motor_mut().break_encoder(true);
    assert_eq!(
        faults_after(&mut fixture, 500),
        Faults::NONE.with(Fault::Sensor)
    );
    assert_eq!(fixture.motor().speed_rpm().to_bits(), 0);
    fixture.motor_mut().break_encoder(false);
    assert_eq!(faults_after(&mut fixture, 500), Faults::NONE);
}

#[test]
fn a_power_cycle_clears_a_stall() {
    let mut fixture = Fixture::with_one_motor();
    fixture.motor_mut().block(true);
    assert_eq!(
        faults_after(&mut fixture, 5200),
        Faults::NONE.with(Fault::Stall)
    );
    fixture.motor_mut().power(false);
    fixture.motor_mut().power(true);
    fixture.motor_mut().block(false);
    assert_eq!(faults_after(&mut fixture, 500), Faults::NONE);
}

/// The rated point is one that the motor can be run at for good.
#[test]
fn rated_load_warms_the_winding_in_minutes_but_not_to_its_protection() {
    let mut fixture = Fixture::with_one_motor();
    fixture.motor_mut().set_load_nm(0.96);
    fixture.drive_for(speed(115), ms(60_000));
    let after_a_minute = fixture.motor().temperature_c();
    assert!((32.0..45.0).contains(&after_a_minute), "{after_a_minute}");
    fixture.drive_for(speed(115), ms(900_000));
    let settled = fixture.motor().temperature_c();
    assert!((55.0..75.0).contains(&settled), "{settled}");
    assert_eq!(fixture.query().faults, Faults::NONE);
}
