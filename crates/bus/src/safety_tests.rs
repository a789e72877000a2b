//! The decisions as tables.

use motorlink_protocol::{Fault, PositionTarget, SpeedTarget};

use super::*;

const ID: MotorId = MotorId::FIRST;

fn amps(raw: i32) -> Setpoint {
    Setpoint::Current(CurrentTarget::new(raw).unwrap())
}

#[test]
fn a_stop_brakes_at_once_only_where_that_cannot_turn_the_wheel() {
    use Mode::{Current, Position, Velocity};
    for (fresh, last, plan) in [
        (Some(Velocity), Some(Velocity), StopPlan::Brake),
        (Some(Velocity), Some(Position), StopPlan::Brake),
        (Some(Current), Some(Current), StopPlan::BrakeWhileSwitching),
        (Some(Position), Some(Position), StopPlan::SwitchThenBrake),
        (None, Some(Velocity), StopPlan::BrakeWhileSwitching),
        (None, Some(Current), StopPlan::BrakeWhileSwitching),
        (None, Some(Position), StopPlan::SwitchThenBrake),
        (None, None, StopPlan::SwitchThenBrake),
    ] {
        assert_eq!(
            stop_plan(fresh, last),
            plan,
            "fresh {fresh:?}, last {last:?}"
        );
    }
}

#[test]
fn nothing_is_sent_into_a_change_to_or_from_the_position_loop() {
    for from in Mode::ALL {
        for to in Mode::ALL {
            let frame = neutral_between(from, to);
            assert_eq!(
                frame.is_none(),
                from == Mode::Position || to == Mode::Position
            );
            assert!(
                frame.is_none_or(|drive| drive.signed() == 0),
                "{from:?} to {to:?}"
            );
        }
    }
}

#[test]
fn the_position_loop_needs_a_known_slow_wheel() {
    let speed = |rpm| Some(Rpm::new(rpm));
    assert_eq!(
        check_position_switch(ID, None),
        Err(Refusal::SpeedUnknown(ID))
    );
    for slow in [0, 9, -9] {
        assert_eq!(check_position_switch(ID, speed(slow)), Ok(()));
    }
    for fast in [10, -10, 330, i16::MIN] {
        assert_eq!(
            check_position_switch(ID, speed(fast)),
            Err(Refusal::TooFast(Rpm::new(fast)))
        );
    }
}

#[test]
fn a_drive_is_refused_for_each_reason_by_name() {
    let velocity = Setpoint::velocity(SpeedTarget::clamped(100));
    let stalled = Faults::NONE.with(Fault::Stall);
    let drive = |setpoint, consent, reported, faults| {
        let known = Known {
            reported,
            faults,
            temperature: Some(Celsius::new(75)),
        };
        check_drive(
            Model::Ddsm115,
            ID,
            setpoint,
            consent,
            Limits::default(),
            known,
        )
    };
    let none = Some(Faults::NONE);
    assert_eq!(
        drive(velocity, Consent::None, Some(Mode::Velocity), none),
        Ok(())
    );
    assert_eq!(
        drive(velocity, Consent::None, None, None),
        Err(Refusal::NotAnswering(ID))
    );
    assert_eq!(
        drive(velocity, Consent::None, Some(Mode::Current), none),
        Err(Refusal::OtherLoop {
            id: ID,
            asked: Mode::Velocity,
            reported: Mode::Current
        })
    );
    assert_eq!(
        drive(velocity, Consent::None, Some(Mode::Velocity), Some(stalled)),
        Err(Refusal::FaultActive {
            id: ID,
            faults: stalled
        })
    );
    let reserved = Some(Faults::from_byte(0b1110_0000));
    assert_eq!(
        drive(velocity, Consent::None, Some(Mode::Velocity), reserved),
        Ok(())
    );
    for (raw, asks) in [
        (25_000, false),
        (25_001, true),
        (-25_000, false),
        (-25_001, true),
    ] {
        let asked = drive(amps(raw), Consent::None, Some(Mode::Current), none);
        assert_eq!(asked.is_err(), asks, "{raw}");
        assert_eq!(
            drive(amps(raw), Consent::HighCurrent, Some(Mode::Current), none),
            Ok(())
        );
    }
}

#[test]
fn a_setpoint_stands_only_while_its_motor_answers_in_its_loop_without_fault() {
    let ms = Duration::from_millis;
    let hot = Faults::NONE.with(Fault::OverTemperature);
    let velocity = Some(Mode::Velocity);
    assert_eq!(
        check_driven(velocity, velocity, Faults::NONE, None, ms(199), 9),
        None
    );
    assert_eq!(
        check_driven(velocity, velocity, Faults::NONE, None, ms(200), 3),
        Some(WithdrawReason::Silent)
    );
    assert_eq!(
        check_driven(velocity, velocity, hot, None, ms(0), 0),
        Some(WithdrawReason::Fault(hot))
    );
    assert_eq!(
        check_driven(Some(Mode::Current), velocity, Faults::NONE, None, ms(0), 0),
        Some(WithdrawReason::OtherLoop {
            reported: Mode::Velocity
        })
    );
    let exceeded = ExceededLimit::Temperature {
        reached: Celsius::new(76),
        limit: 75,
    };
    assert_eq!(
        check_driven(velocity, velocity, Faults::NONE, Some(exceeded), ms(0), 0),
        Some(WithdrawReason::Limit(exceeded))
    );
}

#[test]
fn a_motor_is_asked_for_no_more_than_its_limits_and_not_while_it_is_too_hot() {
    let limits = Limits::new(100, 2_700, 60).unwrap();
    let drive = |rpm, celsius| {
        let known = Known {
            reported: Some(Mode::Velocity),
            faults: Some(Faults::NONE),
            temperature: Some(Celsius::new(celsius)),
        };
        let setpoint = Setpoint::velocity(SpeedTarget::clamped(rpm));
        check_drive(Model::Ddsm115, ID, setpoint, Consent::None, limits, known)
    };
    assert_eq!(drive(-100, 60), Ok(()));
    assert_eq!(drive(-101, 20), Err(Refusal::AboveSpeedLimit(100)));
    assert!(matches!(drive(10, 61), Err(Refusal::TooHot { id: ID, .. })));
}

#[test]
fn a_torque_reversal_passes_through_zero() {
    let raw = |raw| CurrentTarget::new(raw).ok();
    assert_eq!(step_towards(amps(-500), raw(500)), amps(0));
    assert_eq!(step_towards(amps(500), raw(-1)), amps(0));
    assert_eq!(step_towards(amps(900), raw(500)), amps(900));
    assert_eq!(step_towards(amps(1), raw(-500)), amps(0));
    assert_eq!(step_towards(amps(0), raw(500)), amps(0));
    assert_eq!(step_towards(amps(500), raw(0)), amps(500));
    assert_eq!(step_towards(amps(-500), None), amps(-500));
    let angle = Setpoint::Position(PositionTarget::new(7).unwrap());
    assert_eq!(step_towards(angle, raw(-1)), angle);
}
