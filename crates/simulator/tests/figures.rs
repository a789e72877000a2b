//! The published figures of the motor, each with its tolerance and where it comes from.

use crate::fixture;
use std::time::Duration;

use crate::fixture::{Fixture, current, ms, speed, speed_at};
use motorlink_protocol::{Mode, Setpoint};

/// Asserts that a figure is met, and shows both when it is not. `cargo test -- --nocapture` lists
/// all figures.
fn holds(name: &str, measured: f64, published: f64, tolerance: f64) {
    println!("{name}: {measured:.3}, published {published} +-{tolerance}");
    let off = (measured - published).abs();
    assert!(
        off <= tolerance,
        "{name}: {measured}, published {published} +-{tolerance}"
    );
}

fn millis(time: Option<Duration>) -> f64 {
    time.expect("reached in time").as_secs_f64() * 1000.0
}

/// A fixture whose motor turns at 120 rpm.
fn at_120_rpm() -> Fixture {
    let mut fixture = Fixture::with_one_motor();
    fixture.drive_for(speed(120), ms(1500));
    assert!((fixture.motor().speed_rpm() - 120.0).abs() < 1.0);
    fixture
}

/// Measured on real units: 446 ms to 90 % of 120 rpm at acceleration 0 or 1, 837 ms at 2, 1.99 s at 5.
#[test]
fn spin_up_takes_as_long_as_acceleration_says() {
    for (accel, published_ms) in [(0, 446.0), (1, 446.0), (2, 837.0), (5, 1990.0)] {
        let mut fixture = Fixture::with_one_motor();
        let time = fixture.drive_until(speed_at(120, accel), ms(4000), |motor| {
            motor.speed_rpm() >= 108.0
        });
        let name = format!("90 % of 120 rpm at acceleration {accel}, ms");
        holds(&name, millis(time), published_ms, published_ms * 0.03);
    }
}

/// Measured on real units: at acceleration 20 the wheel reaches 41 rpm in 3 s.
#[test]
fn the_gentlest_published_spin_up_reaches_41_rpm_in_3_s() {
    let mut fixture = Fixture::with_one_motor();
    fixture.drive_for(speed_at(120, 20), ms(3000));
    holds(
        "rpm after 3 s at acceleration 20",
        fixture.motor().speed_rpm().into(),
        41.0,
        1.5,
    );
}

/// Measured on real units: 0.40 A at most on the way to 120 rpm.
#[test]
fn spin_up_current_peaks_at_0_4_amps_as_reported() {
    let mut fixture = Fixture::with_one_motor();
    let mut peak = 0.0_f32;
    for _ in 0..45 {
        let reply = fixture.drive(speed(120)).expect("an answer");
        peak = peak.max(reply.current.unwrap().amps());
    }
    holds("peak current of a spin-up, A", peak.into(), 0.40, 0.05);
}

/// Data sheet: 200 +-10 rpm at 18 V, at most 0.25 A; a command of 330 does not reach 330.
#[test]
fn without_load_a_command_of_330_runs_at_200_rpm() {
    let mut fixture = Fixture::with_one_motor();
    fixture.drive_for(speed(330), ms(3000));
    holds(
        "no-load speed, rpm",
        fixture.motor().speed_rpm().into(),
        200.0,
        10.0,
    );
    let mut sum = 0.0;
    for _ in 0..200 {
        sum += f64::from(
            fixture
                .drive(speed(330))
                .expect("an answer")
                .current
                .unwrap()
                .amps(),
        );
    }
    let mean = sum / 200.0;
    println!("no-load current, mean of 200 replies: {mean:.3} A, published at most 0.25");
    assert!((0.1..=0.25).contains(&mean), "{mean} A");
}

/// Data sheet: 115 rpm at 1.25 A under 0.96 N.m.
#[test]
fn the_rated_load_gives_the_rated_speed_and_current() {
    let mut fixture = Fixture::with_one_motor();
    fixture.motor_mut().set_load_nm(0.96);
    fixture.drive_for(speed(330), ms(5000));
    holds(
        "rated speed, rpm",
        fixture.motor().speed_rpm().into(),
        115.0,
        5.0,
    );
    holds(
        "rated current, A",
        fixture.motor().current_a().into(),
        1.25,
        0.07,
    );
}

/// Data sheet: 2.7 A and 2.0 N.m at stall.
#[test]
fn a_blocked_wheel_draws_stall_current() {
    let mut fixture = Fixture::with_one_motor();
    fixture.motor_mut().block(true);
    fixture.drive_for(speed(330), ms(2000));
    holds(
        "stall current, A",
        fixture.motor().current_a().into(),
        2.7,
        0.05,
    );
    holds(
        "stall torque, N.m",
        fixture.motor().torque_nm().into(),
        2.0,
        0.05,
    );
}

/// Data sheet: 0.75 N.m/A.
#[test]
fn torque_follows_current() {
    let mut fixture = Fixture::with_one_motor();
    fixture.switch(Mode::Current);
    fixture.motor_mut().block(true);
    fixture.drive_for(current(1.0), ms(100));
    holds(
        "torque at 1 A, N.m",
        fixture.motor().torque_nm().into(),
        0.75,
        0.01,
    );
}

/// Measured on real units: velocity 0 stops an unloaded wheel from 120 rpm in about 370 ms.
#[test]
fn velocity_zero_stops_in_370_ms() {
    let time = at_120_rpm().drive_until(speed(0), ms(2000), |motor| motor.speed_rpm().abs() < 0.5);
    holds(
        "stop from 120 rpm by velocity 0, ms",
        millis(time),
        370.0,
        20.0,
    );
}

/// Measured on real units: the brake stops an unloaded wheel from 120 rpm in about 250 ms.
#[test]
fn the_brake_stops_in_250_ms() {
    let mut fixture = at_120_rpm();
    let stopped = |motor: &motorlink_simulator::VirtualMotor| motor.speed_rpm().abs() < 0.5;
    let time = fixture.drive_until(Setpoint::Brake, ms(2000), stopped);
    holds(
        "stop from 120 rpm by the brake, ms",
        millis(time),
        250.0,
        15.0,
    );
}

/// Measured on real units: acceleration does nothing on the way down.
#[test]
fn acceleration_does_not_soften_a_stop() {
    let mut fixture = at_120_rpm();
    let stopped = |motor: &motorlink_simulator::VirtualMotor| motor.speed_rpm().abs() < 0.5;
    let time = fixture.drive_until(speed_at(0, 20), ms(2000), stopped);
    holds(
        "stop from 120 rpm at acceleration 20, ms",
        millis(time),
        370.0,
        20.0,
    );
}

/// Measured on real units: a coasting wheel takes more than 6 s from 120 rpm.
#[test]
fn a_coasting_wheel_takes_more_than_6_s() {
    let mut fixture = at_120_rpm();
    // 0 A: the windings are open.
    fixture.switch(Mode::Current);
    let start = fixture.now;
    while fixture.motor().speed_rpm() != 0.0 {
        fixture.wait(ms(10));
        assert!(fixture.now.since(start) < ms(20_000), "it never stops");
    }
    let time_s = fixture.now.since(start).as_secs_f64();
    println!("coasting from 120 rpm: {time_s:.2} s, published more than 6");
    assert!((6.0..12.0).contains(&time_s), "{time_s} s");
}

/// Captures: between 13:15:36.962 and 13:15:37.558 the angle of a motor at +100 rpm falls by 600
/// degrees a second.
#[test]
fn at_plus_100_rpm_the_reported_angle_falls_by_600_degrees_a_second() {
    for (rpm, published) in [(100, -600.0), (-100, 600.0)] {
        let mut fixture = Fixture::with_one_motor();
        fixture.drive_for(speed(rpm), ms(1500));
        let mut degrees = 0.0_f64;
        let mut before = fixture.motor().angle_deg();
        fixture.drive_watching(speed(rpm), ms(1000), |_, motor| {
            degrees += f64::from(fixture::turn_between(before, motor.angle_deg()));
            before = motor.angle_deg();
        });
        holds(
            &format!("degrees a second at {rpm} rpm"),
            degrees,
            published,
            6.0,
        );
        let reply = fixture.drive(speed(rpm)).expect("an answer");
        assert_eq!(i32::from(reply.speed.unwrap().rpm()), rpm);
    }
}

/// The mean of the captured currents at +100 rpm is 0.24 A, none is negative, none above 0.37 A.
#[test]
fn current_at_plus_100_rpm_scatters_as_in_the_captures() {
    let mut fixture = Fixture::with_one_motor();
    fixture.drive_for(speed(100), ms(1500));
    let amps: Vec<f32> = (0..200)
        .map(|_| {
            fixture
                .drive(speed(100))
                .expect("an answer")
                .current
                .unwrap()
                .amps()
        })
        .collect();
    let mean = f64::from(amps.iter().sum::<f32>()) / 200.0;
    holds("mean current at +100 rpm, A", mean, 0.243, 0.05);
    let spread = amps.iter().fold(0.0_f32, |most, amps| most.max(*amps))
        - amps.iter().fold(1.0_f32, |least, amps| least.min(*amps));
    assert!((0.15..0.45).contains(&spread), "{spread} A");
}

/// Captures: a standing motor reports exactly 0 rpm, 6 to 10 raw units of current and 32 degrees.
#[test]
fn a_standing_motor_reports_zero_speed_and_next_to_no_current() {
    let mut fixture = Fixture::with_one_motor();
    let reply = fixture.query();
    assert_eq!(reply.speed.unwrap().rpm(), 0);
    assert!(
        (4..=12).contains(&reply.current.unwrap().raw()),
        "{:?}",
        reply.current.unwrap().raw()
    );
    assert_eq!(fixture.motor().speed_rpm().to_bits(), 0.0_f32.to_bits());
}
