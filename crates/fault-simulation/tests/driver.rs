//! Worlds in which the computer of the native driver fails, and rules that hold in each.
#![cfg(test)]

use std::time::Duration;

use motorlink_bus::{Command, Consent};
use motorlink_fault_simulation::{
    Act, DriverCoverage, DriverRule, DriverScenario, Process, play_driver, shrink_driver,
};
use motorlink_protocol::{MotorId, Setpoint, SpeedTarget, family::Model};
use motorlink_simulator::WhenSilent;
use strum::VariantArray;

/// `cargo xtask reliability driver` plays many times as many.
const SEEDS: u64 = 1_000;
/// Each rule has something to judge, and each act happens, at least so often.
const EACH: u64 = 5;

#[test]
fn the_rules_hold_on_every_computer() {
    let mut coverage = DriverCoverage::default();
    for seed in 1..=SEEDS {
        let scenario = DriverScenario::of(seed);
        if let Err(violation) = play_driver(&scenario, &mut coverage) {
            let (short, last) = shrink_driver(&scenario, violation);
            panic!("{last}\n{short}");
        }
    }
    for rule in DriverRule::VARIANTS {
        let times = coverage.judged.get(rule).copied().unwrap_or(0);
        assert!(times >= EACH, "{rule:?} judged only {times} times");
    }
    for (act, times) in coverage.acts {
        assert!(times >= EACH, "{act} only {times} times");
    }
}

/// Two motors turn. Their process is killed, and the next one finds its port stalled until the stop of what was left
/// driven has ended.
fn left_driven_behind_a_stalled_port(
    model: Model,
    found_as: [Option<Model>; 2],
    stalls: Duration,
) -> DriverScenario {
    let start = |id| {
        Act::Command(Command::Start {
            id,
            setpoint: Setpoint::velocity(SpeedTarget::clamped(60)),
            consent: Consent::None,
        })
    };
    let ms = Duration::from_millis;
    let of = DriverScenario::of(1);
    let motors = vec![MotorId::FIRST, MotorId::new(2).unwrap()];
    let first = vec![
        (ms(300), start(motors[0])),
        (ms(10), start(motors[1])),
        (ms(700), Act::Kill),
    ];
    let second = vec![(ms(0), Act::PortStalls(stalls)), (ms(9_000), Act::End)];
    let process = |model, acts| Process {
        model,
        acts,
        pause: ms(300),
    };
    DriverScenario {
        model,
        motors,
        when_silent: WhenSilent::Keep,
        processes: vec![process(found_as[0], first), process(found_as[1], second)],
        ..of
    }
}

/// Each of these wheels kept turning for ever, though its motor answered again.
#[test]
fn what_was_left_driven_and_answers_late_is_stopped() {
    let like = [Some(Model::Ddsm115), Some(Model::Ddsm315)];
    for (model, found_as) in [
        (Model::Ddsm115, [None, None]),
        (Model::Ddsm210, [None, Some(Model::Ddsm210)]),
        (Model::Ddsm400, [Some(Model::Ddsm400), None]),
        (Model::Ddsm315, like),
        (Model::Ddsm315, [Some(Model::Ddsm315), None]),
    ] {
        for stalls_ms in [2_900, 3_100, 3_300, 3_600, 5_000] {
            let stalls = Duration::from_millis(stalls_ms);
            let scenario = left_driven_behind_a_stalled_port(model, found_as, stalls);
            let mut coverage = DriverCoverage::default();
            let played = play_driver(&scenario, &mut coverage);
            assert_eq!(played, Ok(()), "{scenario}");
            assert_eq!(coverage.judged[&DriverRule::LeftIsStopped], 2);
        }
    }
}
