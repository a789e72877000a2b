//! A frame that the port did not take was not sent, and counts for nothing.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test fails by panicking, in its helpers too"
)]

mod bench;

use std::time::Duration;

use bench::{Bench, ID, amps, degrees, ms, rpm, scan_report};
use motorlink_bus::{Activity, Command, Event, Passed, StopReason, WithdrawReason};
use motorlink_protocol::{Drive, Mode, MotorId, Request};
use motorlink_simulator::{MotorConfig, WireFaults, WorldConfig};

const STOP: Command = Command::StopAll(StopReason::Operator);

/// A wheel that is driven in the position loop and has come to 120 degrees, where a zero would turn it.
fn at_120(mode_switch_frames: u8, faults: WireFaults, seed: u64) -> Bench {
    let motor = MotorConfig {
        mode_switch_frames,
        ..MotorConfig::new(MotorId::FIRST)
    };
    let config = WorldConfig {
        seed,
        motors: vec![motor],
        ..WorldConfig::default()
    };
    let mut bench = Bench::watching(config, &[ID]);
    bench.switch(Mode::Position);
    bench.drive(degrees(120.0)).unwrap();
    bench.run(ms(2_000));
    bench.world.set_faults(faults);
    bench.forget_the_past();
    bench
}

fn turns(bench: &Bench) -> f32 {
    bench.world.motor(ID).unwrap().turns()
}

fn moved_deg(bench: &Bench, before: f32) -> f32 {
    (turns(bench) - before).abs() * 360.0
}

#[test]
fn switches_of_a_stop_that_were_refused_are_sent_before_the_brake() {
    for frames in [1, 5] {
        for refusals in 1..=30 {
            for begins_us in (0..20_000).step_by(2_500) {
                let mut bench = at_120(frames, WireFaults::default(), 1);
                bench.run(Duration::from_micros(begins_us));
                bench.forget_the_past();
                let before = turns(&bench);
                bench.refusals = refusals;
                bench.command(STOP).unwrap();
                bench.run(ms(2_500));
                let moved = moved_deg(&bench, before);
                let what = format!("{refusals} refused from {begins_us} us on, takes {frames}");
                assert!(bench.sent[0].is_switch(), "{what}");
                assert!(moved < 2.0, "{moved} degrees: {what}");
            }
        }
    }
}

#[test]
fn a_motor_that_needs_five_switches_is_not_braked_into_the_position_loop() {
    for lost in [0.1, 0.3] {
        for seed in 0..149 {
            let faults = WireFaults {
                lose_request: lost,
                ..WireFaults::default()
            };
            let mut bench = at_120(5, faults, seed);
            let before = turns(&bench);
            bench.command(STOP).unwrap();
            bench.run(ms(2_000));
            let moved = moved_deg(&bench, before);
            assert!(moved < 2.0, "{moved} degrees, seed {seed}, {lost} lost");
            assert_eq!(bench.activity(), Activity::Idle);
        }
    }
}

/// Its replies are lost, and one request in ten.
#[test]
fn a_silent_motor_in_the_position_loop_gets_the_brake_after_many_switches() {
    for seed in 0..149 {
        let faults = WireFaults {
            lose_request: 0.1,
            ..WireFaults::default()
        };
        let mut bench = at_120(5, faults, seed);
        let before = turns(&bench);
        bench.world.motor_mut(ID).unwrap().mute(true);
        bench.command(STOP).unwrap();
        bench.run(ms(2_000));
        let moved = moved_deg(&bench, before);
        assert!(moved < 2.0, "{moved} degrees, seed {seed}");
        assert!(bench.sent.iter().any(|sent| sent.drive_of(ID).is_some()));
    }
}

#[test]
fn a_port_that_takes_nothing_withdraws_the_setpoint() {
    let mut bench = Bench::one_motor();
    bench.drive(rpm(100)).unwrap();
    bench.run(ms(1_500));
    bench.forget_the_past();
    bench.adapter_is_busy = true;
    bench.run(ms(300));
    assert!(bench.happened(|event| matches!(
        event,
        Event::Withdrawn {
            reason: WithdrawReason::Silent,
            ..
        }
    )));
    bench.adapter_is_busy = false;
    bench.run(ms(2_000));
    let moves = |sent: &&bench::Sent| sent.drive_of(ID).is_some_and(|drive| drive.signed() != 0);
    assert_eq!(bench.sent.iter().filter(moves).count(), 0);
    assert!(bench.true_rpm().abs() < 1.0);
}

#[test]
fn every_refused_frame_is_logged_as_not_sent_and_none_as_silence() {
    let mut bench = Bench::one_motor();
    bench.drive(rpm(100)).unwrap();
    bench.run(ms(100));
    bench.forget_the_past();
    bench.adapter_is_busy = true;
    bench.run(ms(100));
    let mut refused = 0;
    for (_, event) in &bench.events {
        let Event::Traffic(traffic) = event else {
            continue;
        };
        match traffic.passed {
            Passed::Unsent { .. } => refused += 1,
            Passed::Sent { .. } | Passed::Silence { .. } => panic!("{traffic:?}"),
            _ => {}
        }
    }
    // Every 5 ms at most.
    assert!((15..=21).contains(&refused), "{refused} in 100 ms");
}

#[test]
fn a_scan_through_refusals_finds_every_motor() {
    let mut bench = Bench::new(WorldConfig::with_ids([ID, bench::id(77), bench::id(250)]));
    bench.command(Command::FullScan).unwrap();
    for _ in 0..40 {
        bench.adapter_is_busy = true;
        bench.run(ms(30));
        bench.adapter_is_busy = false;
        bench.run(ms(50));
    }
    bench.run(ms(8_000));
    let found = bench.events.iter().find_map(|(_, event)| match event {
        Event::ScanEnded(report) => Some(report.found.clone()),
        _ => None,
    });
    assert_eq!(found, Some(vec![ID, bench::id(77), bench::id(250)]));
}

#[test]
fn a_scan_on_a_port_that_takes_nothing_ends() {
    let mut bench = Bench::one_motor();
    bench.adapter_is_busy = true;
    let report = scan_report(&mut bench);
    assert!(report.found.is_empty());
}

/// Reverses the torque on a bad line. Panics where the reverse is sent before an answered zero; says
/// whether it was sent.
fn reverses(lose: f64, refuse: bool, seed: u64) -> bool {
    let config = WorldConfig {
        seed,
        ..WorldConfig::default()
    };
    let mut bench = Bench::watching(config, &[ID]);
    bench.switch(Mode::Current);
    bench.drive(amps(2.0)).unwrap();
    bench.run(ms(100));
    bench.world.set_faults(WireFaults {
        lose_request: lose / 2.0,
        lose_reply: lose,
        ..WireFaults::default()
    });
    bench.forget_the_past();
    bench.drive(amps(-2.0)).unwrap();
    if refuse {
        bench.adapter_is_busy = true;
        bench.run(ms(30));
        bench.adapter_is_busy = false;
    }
    bench.run(ms(400));
    let mut zero_at = None;
    let mut answered = false;
    for (at, event) in &bench.events {
        let Event::Traffic(traffic) = event else {
            continue;
        };
        match traffic.passed {
            Passed::Sent { frame, .. } => {
                if let Ok(Request::Drive { drive, .. }) = Request::parse(&frame) {
                    match drive.signed() {
                        0 => zero_at = Some(*at),
                        1.. => {}
                        _ => {
                            assert!(answered, "seed {seed}: reversed without an answered zero");
                            return true;
                        }
                    }
                }
            }
            Passed::Heard { .. } => answered |= zero_at.is_some(),
            _ => {}
        }
    }
    false
}

#[test]
fn a_reversal_waits_for_a_zero_that_is_answered() {
    for (lose, refuse, at_least) in [
        (0.0, false, 100),
        (0.0, true, 100),
        (0.3, false, 50),
        // Here most are withdrawn by silence instead.
        (0.6, true, 0),
    ] {
        let reversed = (0..100).filter(|seed| reverses(lose, refuse, *seed));
        let reversed = reversed.count();
        assert!(reversed >= at_least, "{reversed} of 100, {lose} lost");
    }
    // The same with every zero lost.
    let mut bench = Bench::one_motor();
    bench.switch(Mode::Current);
    bench.drive(amps(2.0)).unwrap();
    bench.run(ms(100));
    bench.world.motor_mut(ID).unwrap().mute(true);
    bench.forget_the_past();
    bench.drive(amps(-2.0)).unwrap();
    bench.run(ms(150));
    assert!(!bench.sent.is_empty());
    let value = |sent: &bench::Sent| sent.drive_of(ID).map_or(0, Drive::signed);
    assert!(bench.sent.iter().all(|sent| value(sent) == 0));
}
