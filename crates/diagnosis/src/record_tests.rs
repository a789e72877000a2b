//! Lines that are good, dead, noisy or lossy, and their diagnosis.

use motorlink_simulator::{LineCondition, WireFaults, World, WorldConfig};

use super::*;
use crate::{
    doctor::Diagnosis,
    recorded_bus::{ID, RecordedBus},
};

#[test]
fn every_case_of_the_virtual_line_is_diagnosed() {
    for (case, expected) in [
        (LineCondition::Good, Verdict::Healthy),
        (
            LineCondition::Dead,
            Verdict::Faulty(vec![Diagnosis::Nothing]),
        ),
        (
            LineCondition::EchoOnly,
            Verdict::Faulty(vec![Diagnosis::EchoOnly]),
        ),
        (
            LineCondition::SharedId,
            Verdict::Faulty(vec![Diagnosis::SharedId(ID)]),
        ),
        // At rest this fault has no effect.
        (LineCondition::NoiseGrowsWithSpeed, Verdict::Healthy),
        (
            LineCondition::HoldsBytes,
            Verdict::Faulty(vec![Diagnosis::LatencyTimer]),
        ),
        (
            LineCondition::Stranger,
            Verdict::Faulty(vec![Diagnosis::Stranger]),
        ),
    ] {
        let mut bus = RecordedBus::new(case);
        // What is lost while the window grows is gone by then, or not counted yet.
        let first = if case == LineCondition::Good { 6 } else { 5 };
        for seconds in [first, 10, 30] {
            assert_eq!(*bus.run(seconds), expected, "{case:?}, {seconds} s more");
        }
    }
}

#[test]
fn noise_that_grows_with_speed_is_told_from_noise() {
    let mut bus = RecordedBus::new(LineCondition::NoiseGrowsWithSpeed);
    bus.run(6);
    bus.drive(100);
    let grows = Verdict::Faulty(vec![Diagnosis::NoiseGrowsWithSpeed]);
    assert_eq!(*bus.run(6), grows);
    assert_eq!(*bus.run(30), grows);
}

#[test]
fn a_driven_motor_on_a_good_line_is_healthy() {
    let mut bus = RecordedBus::new(LineCondition::Good);
    assert_eq!(*bus.run(1), Verdict::TooLittle);
    bus.run(5);
    bus.drive(100);
    assert_eq!(*bus.run(20), Verdict::Healthy);
}

#[test]
fn a_cleared_record_starts_again_and_without_a_port_there_is_none() {
    let mut bus = RecordedBus::new(LineCondition::Dead);
    assert_eq!(*bus.record.verdict(), Verdict::NotConnected);
    assert!(matches!(bus.run(10), Verdict::Faulty(_)));
    bus.record.clear();
    bus.look();
    assert_eq!(*bus.record.verdict(), Verdict::TooLittle);
    bus.record.look(None);
    assert_eq!(*bus.record.verdict(), Verdict::NotConnected);
}

/// While the page is hidden, the bus is not examined. That time does not count.
#[test]
fn time_without_examination_is_not_counted() {
    let mut bus = RecordedBus::new(LineCondition::Good);
    bus.run(5);
    bus.world.set_line_condition(bus.now, LineCondition::Dead);
    bus.run_to(bus.now + Duration::from_secs(60));
    bus.world.set_line_condition(bus.now, LineCondition::Good);
    // The header remembers the last hundred exchanges.
    assert_eq!(*bus.run(12), Verdict::Healthy);
}

/// The verdicts, one per second.
fn course(bus: &mut RecordedBus, seconds: u64) -> Vec<Verdict> {
    (0..seconds).map(|_| bus.run(1).clone()).collect()
}

/// A line that has these faults from the beginning.
fn faulty(faults: WireFaults, seed: u64) -> RecordedBus {
    RecordedBus::on(World::new(WorldConfig {
        faults,
        seed,
        ..WorldConfig::default()
    }))
}

/// The header's figure.
fn loss_per_mille(bus: &RecordedBus) -> Option<u16> {
    bus.bus.motors(bus.now).next()?.link.loss_per_mille
}

#[test]
fn a_lossy_line_is_never_called_healthy() {
    let losing = WireFaults {
        lose_request: 0.3,
        ..WireFaults::default()
    };
    let damaging = WireFaults {
        corrupt_reply: 0.2,
        ..WireFaults::default()
    };
    for (name, faults, cause) in [
        ("30 % lost", losing, Diagnosis::Lost),
        ("20 % damaged", damaging, Diagnosis::Damaged),
    ] {
        for seed in 0..40 {
            let mut bus = faulty(faults.clone(), seed);
            let verdicts = course(&mut bus, 30);
            let lossy = Verdict::Faulty(vec![cause]);
            assert!(
                !verdicts.contains(&Verdict::Healthy),
                "{name}, seed {seed}: {verdicts:?}"
            );
            assert_eq!(verdicts[7..], vec![lossy; 23], "{name}, seed {seed}");
        }
    }
}

/// A late computer is no cause that can be named, but what is lost may be a stop.
#[test]
fn a_line_that_loses_much_is_told_on_a_late_computer_too() {
    for (lose_reply, loses_much) in [(0.3, true), (0.01, false)] {
        let faults = WireFaults {
            lose_reply,
            ..WireFaults::default()
        };
        for seed in 0..40 {
            let mut bus = faulty(faults.clone(), seed);
            bus.late_hz = Some(50);
            let verdict = bus.run(8).clone();
            assert!(!matches!(verdict, Verdict::Faulty(_)), "{verdict:?}");
            assert_eq!(bus.record.loses_much(), loses_much, "seed {seed}");
        }
    }
}

/// For each loss rate, at rest or driven.
#[test]
fn the_doctor_is_never_better_than_the_header() {
    for percent in [1_u8, 3, 6, 10, 15] {
        for seed in 0..10 {
            let mut bus = faulty(
                WireFaults {
                    lose_reply: f64::from(percent) / 100.0,
                    ..WireFaults::default()
                },
                seed,
            );
            for second in 0..30 {
                if second == 10 && percent < 10 {
                    bus.drive(100);
                }
                let verdict = bus.run(1).clone();
                let looked = loss_per_mille(&bus);
                assert!(
                    verdict != Verdict::Healthy || looked.is_some_and(|loss| loss < 50),
                    "{percent} %, seed {seed}, {second} s: {looked:?}"
                );
            }
        }
    }
}

/// Two seconds after the last reply, as the alert does; no diagnosis before that.
#[test]
fn a_line_that_dies_while_driving_is_dead_and_not_lossy() {
    for ms in (0..1_000).step_by(70) {
        let mut bus = RecordedBus::new(LineCondition::Good);
        bus.run(6);
        bus.drive(100);
        assert_eq!(*bus.run(12), Verdict::Healthy);
        bus.run_to(bus.now + Duration::from_millis(ms));
        bus.world.set_line_condition(bus.now, LineCondition::Dead);
        let verdicts = course(&mut bus, 15);
        let nothing = Verdict::Faulty(vec![Diagnosis::Nothing]);
        for (second, verdict) in verdicts.iter().enumerate() {
            let expected: &[&Verdict] = match second {
                0 => &[&Verdict::Healthy, &Verdict::SomeLoss, &Verdict::TooLittle],
                1 | 2 => &[&Verdict::TooLittle, &nothing],
                _ => &[&nothing],
            };
            assert!(
                expected.contains(&verdict),
                "{second} s after {ms} ms: {verdict:?}"
            );
        }
        bus.world.set_line_condition(bus.now, LineCondition::Good);
        let verdicts = course(&mut bus, 25);
        let lossy = [Diagnosis::Lost, Diagnosis::Damaged];
        let lossy = lossy.map(|cause| Verdict::Faulty(vec![cause]));
        assert!(
            !verdicts.iter().any(|verdict| lossy.contains(verdict)),
            "back after {ms} ms: {verdicts:?}"
        );
        assert_eq!(verdicts.last(), Some(&Verdict::Healthy));
    }
}

#[test]
fn a_line_that_becomes_slow_is_called_slow() {
    let mut bus = RecordedBus::new(LineCondition::Good);
    assert_eq!(*bus.run(20), Verdict::Healthy);
    bus.world
        .set_line_condition(bus.now, LineCondition::HoldsBytes);
    let verdicts = course(&mut bus, 30);
    let slow = Verdict::Faulty(vec![Diagnosis::LatencyTimer]);
    let is_slow = |verdict: &Verdict| *verdict == slow;
    assert!(verdicts[3..].iter().all(is_slow), "{verdicts:?}");
}

#[test]
fn the_figures_name_the_time_that_they_cover() {
    let mut bus = RecordedBus::new(LineCondition::Good);
    bus.run(5);
    let (seconds, judged) = bus.record.judged();
    assert_eq!((seconds, judged.asked), (4, judged.answered));
    bus.run(10);
    assert_eq!(bus.record.judged().0, 10);
    bus.record.clear();
    assert_eq!(bus.record.judged(), (0, Tally::default()));
}

#[test]
fn noise_that_grows_with_speed_is_not_called_healthy_while_the_wheel_turns() {
    for rpm in [40, 60, 100, 150] {
        for rest in [2, 6, 12] {
            let mut bus = RecordedBus::new(LineCondition::NoiseGrowsWithSpeed);
            bus.run(rest);
            bus.drive(rpm);
            let verdicts = course(&mut bus, 70);
            let not_healthy = |verdict: &Verdict| !matches!(verdict, Verdict::Healthy);
            assert!(
                verdicts[3..].iter().all(not_healthy),
                "{rpm} rpm after {rest} s: {verdicts:?}"
            );
            let grows = Verdict::Faulty(vec![Diagnosis::NoiseGrowsWithSpeed]);
            if rest > 2 && rpm > 40 {
                assert!(
                    verdicts[6..50].iter().all(|verdict| *verdict == grows),
                    "{rpm} rpm after {rest} s: {verdicts:?}"
                );
            }
        }
    }
}
