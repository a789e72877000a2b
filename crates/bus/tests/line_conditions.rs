//! Line faults that begin while a wheel is driven.

use crate::fixture::{Fixture, ID, ms, rpm};
use motorlink_bus::{Activity, Command};
use motorlink_simulator::{LineCondition, WhenSilent};

/// What the worker does when the operator chooses two motors with one ID: the brake is the next
/// frame that the second motor receives.
#[test]
fn a_second_motor_with_the_id_of_a_driven_one_does_not_start() {
    for since_ms in 0..20 {
        let mut fixture = Fixture::one_motor();
        fixture.drive(rpm(100)).unwrap();
        fixture.run(ms(500 + since_ms));
        fixture.bus.command(fixture.now, Command::Stop(ID)).unwrap();
        fixture
            .world
            .set_line_condition(fixture.now, LineCondition::SharedId);
        let mut fastest_rpm = 0.0_f32;
        for _ in 0..4_000 {
            fixture.run(ms(1));
            let second = fixture.world.motors().nth(1).unwrap();
            fastest_rpm = fastest_rpm.max(second.speed_rpm().abs());
        }
        assert!(fastest_rpm < 0.5, "{fastest_rpm} rpm, {since_ms} ms");
        // Its replies collide, so its standstill is not confirmed: the stop begins again whenever it answers.
        let activity = fixture.activity();
        assert!(
            matches!(activity, Activity::Idle | Activity::Stopping { .. }),
            "{activity:?}"
        );
    }
}

/// No condition starts a wheel that stands, or whose setpoint was withdrawn.
#[test]
fn no_line_starts_a_wheel() {
    for case in LineCondition::ALL.iter().copied() {
        // Its firmware coasts, so that the wheel stands when the line is back: this is about a wheel that stands.
        let mut fixture = Fixture::one_motor_when_silent(WhenSilent::CoastAfter(WhenSilent::AFTER));
        fixture.drive(rpm(100)).unwrap();
        fixture.run(ms(500));
        fixture
            .world
            .set_line_condition(fixture.now, LineCondition::Dead);
        fixture.run(ms(12_000));
        assert_eq!(fixture.activity(), Activity::Idle, "withdrawn");
        assert_eq!(fixture.true_rpm().to_bits(), 0, "coasted");
        fixture.world.set_line_condition(fixture.now, case);
        fixture.run(ms(3_000));
        for motor in fixture.world.motors() {
            assert_eq!(motor.speed_rpm().to_bits(), 0, "{case:?}");
        }
    }
}
