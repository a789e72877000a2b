//! When a limit is exceeded, and what is tolerated.

use motorlink_protocol::{Detail, Faults, Mode, MotorId, Reply, SpeedTarget};

use super::*;

fn sample(at_ms: u64, rpm: i16, amps: f32) -> Sample {
    Sample {
        at: Instant::from_millis(at_ms),
        reply: Reply {
            id: MotorId::FIRST,
            mode: Mode::Velocity,
            current: Some(Current::from_amps(amps)),
            speed: Some(Rpm::new(rpm)),
            detail: Detail::Undetermined([0, 0]),
            faults: Faults::NONE,
        },
    }
}

fn exceeded(limits: Limits, samples: &[Sample], celsius: Option<u8>) -> Option<ExceededLimit> {
    let mut over = Overcurrent::default();
    for sample in samples {
        over.record(*sample, limits);
    }
    let last = *samples.last().unwrap();
    limits.exceeded(last, celsius.map(Celsius::new), over, Instant::ZERO)
}

#[test]
fn a_speed_is_crossed_beyond_what_a_wheel_overshoots() {
    let limits = Limits::new(100, 2_700, 75).unwrap();
    for rpm in [0, 100, -100, 110, -110] {
        assert_eq!(exceeded(limits, &[sample(1, rpm, 0.1)], None), None);
    }
    for rpm in [111, -111, i16::MIN] {
        let exceeded = exceeded(limits, &[sample(1, rpm, 0.1)], None);
        assert!(matches!(
            exceeded,
            Some(ExceededLimit::Speed { limit: 100, .. })
        ));
    }
}

#[test]
fn a_current_is_crossed_by_every_reply_of_half_a_second() {
    let limits = Limits::default();
    let at = |ms, amps| sample(ms, 0, amps);
    let short = [at(0, 2.8), at(499, -5.0)];
    assert_eq!(exceeded(limits, &short, None), None);
    let broken = [at(0, 2.8), at(300, 2.6), at(700, 2.8)];
    assert_eq!(exceeded(limits, &broken, None), None);
    let long = [at(0, 2.8), at(300, -2.8), at(500, 2.75)];
    let words = exceeded(limits, &long, None).unwrap().to_string();
    assert_eq!(words, "2.750 A, above your limit of 2.7 A");
}

#[test]
fn what_it_drew_before_it_was_driven_is_not_counted() {
    let (limits, mut over) = (Limits::default(), Overcurrent::default());
    for ms in [0, 400, 800] {
        over.record(sample(ms, 0, 3.0), limits);
    }
    let last = sample(800, 0, 3.0);
    let since = |ms| limits.exceeded(last, None, over, Instant::from_millis(ms));
    assert_eq!(since(301), None);
    assert!(since(300).is_some());
}

#[test]
fn a_temperature_is_crossed_above_its_limit_and_unknown_is_not_hot() {
    let cool = [sample(1, 0, 0.0)];
    assert_eq!(exceeded(Limits::default(), &cool, None), None);
    assert_eq!(exceeded(Limits::default(), &cool, Some(75)), None);
    let hot = exceeded(Limits::default(), &cool, Some(76)).unwrap();
    assert_eq!(hot.to_string(), "76 °C, above your limit of 75 °C");
}

/// The greatest speed of any model.
fn family_max() -> u16 {
    let models = motorlink_protocol::family::Model::ALL;
    models
        .map(|model| model.spec().speed_rpm_max)
        .into_iter()
        .max()
        .unwrap()
}

#[test]
fn limits_lie_within_what_the_motor_takes() {
    assert_eq!(Limits::new(330, 2_700, 75), Ok(Limits::default()));
    let fastest = family_max();
    assert_eq!(Limits::SPEED_RPM.1, fastest);
    assert_eq!(i32::from(fastest), SpeedTarget::MAX);
    for (speed, current, temperature) in [
        (0, 2_700, 75),
        (381, 2_700, 75),
        (330, 99, 75),
        (330, 8_001, 75),
        (330, 2_700, 29),
        (330, 2_700, 81),
    ] {
        assert!(Limits::new(speed, current, temperature).is_err());
    }
}

#[test]
fn only_a_speed_is_refused_before_it_is_reached() {
    let limits = Limits::new(100, 100, 30).unwrap();
    let speed = |rpm| Setpoint::velocity(SpeedTarget::clamped(rpm));
    assert!(limits.allow(speed(100)) && limits.allow(speed(-100)) && limits.allow(Setpoint::Brake));
    assert!(!limits.allow(speed(101)) && !limits.allow(speed(-330)));
}

#[test]
fn limits_are_what_they_were_made_of() {
    let limits = Limits::new(123, 2_345, 67).unwrap();
    assert_eq!(limits.speed_rpm(), 123);
    assert_eq!(limits.current_ma(), 2_345);
    assert_eq!(limits.temperature_c(), 67);
}

#[test]
fn limits_are_stored_as_three_numbers_and_checked_when_read() {
    let numbers = [123, 2_345, 67];
    let limits = Limits::try_from(numbers).unwrap();
    assert_eq!(Ok(limits), Limits::new(123, 2_345, 67));
    assert_eq!(<[u16; 3]>::from(limits), numbers);
    let refused = Limits::try_from([381, 2_700, 75]).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "limits go from 1 to 380 rpm, from 0.1 to 8 A and from 30 to 80 °C"
    );
}

/// 11,059 raw is 2,700 mA, and 11,064 is 2,701.
#[test]
fn a_current_at_its_limit_is_not_above_it() {
    let limits = Limits::new(330, 2_700, 75).unwrap();
    let lasted = |raw: i16| {
        let mut at_limit = sample(1, 0, 0.0);
        at_limit.reply.current = Some(Current::from_raw(raw));
        let later = Sample {
            at: Instant::from_millis(1_000),
            ..at_limit
        };
        exceeded(limits, &[at_limit, later], None).is_some()
    };
    assert!(!lasted(11_059) && !lasted(-11_059));
    assert!(lasted(11_064) && lasted(-11_064));
}
