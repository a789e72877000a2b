//! A frame that the port did not take was not sent, and counts for nothing.

use crate::fixture;
use std::time::Duration;

use crate::fixture::{Fixture, ID, amps, degrees, id, ms, rpm, scan_report};
use motorlink_bus::{Activity, Command, Event, LineEventKind, StopReason, WithdrawReason};
use motorlink_protocol::{Drive, Mode, MotorId, Request};
use motorlink_simulator::{MotorConfig, WireFaults, WorldConfig};

const STOP: Command = Command::StopAll(StopReason::Operator);

/// A wheel that is driven in the position loop and has come to 120 degrees, where a zero would turn it.
fn at_120(mode_switch_frames: u8, faults: WireFaults, seed: u64) -> Fixture {
    let motor = MotorConfig {
        mode_switch_frames,
        ..MotorConfig::new(MotorId::FIRST)
    };
    let config = WorldConfig {
        seed,
        motors: vec![motor],
        ..WorldConfig::default()
    };
    let mut fixture = Fixture::watching(config, &[ID]);
    fixture.switch(Mode::Position);
    fixture.drive(degrees(120.0)).unwrap();
    fixture.run(ms(2_000));
    fixture.world.set_faults(faults);
    fixture.forget_the_past();
    fixture
}

fn turns(fixture: &Fixture) -> f32 {
    fixture.world.motor(ID).unwrap().turns()
}

fn moved_deg(fixture: &Fixture, before: f32) -> f32 {
    (turns(fixture) - before).abs() * 360.0
}

#[test]
fn switches_of_a_stop_that_were_refused_are_sent_before_the_brake() {
    for frames in [1, 5] {
        for refusals in 1..=30 {
            for begins_us in (0..20_000).step_by(2_500) {
                let mut fixture = at_120(frames, WireFaults::default(), 1);
                fixture.run(Duration::from_micros(begins_us));
                fixture.forget_the_past();
                let before = turns(&fixture);
                fixture.refusals = refusals;
                fixture.command(STOP).unwrap();
                fixture.run(ms(2_500));
                let moved = moved_deg(&fixture, before);
                let what = format!("{refusals} refused from {begins_us} us on, takes {frames}");
                assert!(fixture.sent[0].is_switch(), "{what}");
                assert!(moved < 2.0, "{moved} degrees: {what}");
            }
        }
    }
}

/// A port that is stalled takes no frame of the stop. The wheel turns on, and is stopped once the port takes frames again.
#[test]
fn a_motor_whose_stop_was_refused_to_its_end_is_stopped_when_it_answers() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(60)).unwrap();
    fixture.run(ms(500));
    fixture.refusals = u32::MAX;
    fixture.command(Command::Stop(ID)).unwrap();
    fixture.run(ms(4_000));
    let ended =
        |event: &Event| matches!(event, Event::StopEnded(report) if !report.motors[0].confirmed);
    assert!(fixture.events.iter().any(|(_, event)| ended(event)));
    fixture.forget_the_past();
    fixture.refusals = 0;
    fixture.run(ms(2_500));
    let confirmed = |event: &Event| matches!(event, Event::StopEnded(report) if report.reason == StopReason::LeftDriven && report.motors[0].confirmed);
    assert!(fixture.events.iter().any(|(_, event)| confirmed(event)));
    assert!(fixture.world.motor(ID).unwrap().speed_rpm().abs() < 1.0);
}

#[test]
fn a_motor_that_needs_five_switches_is_not_braked_into_the_position_loop() {
    for lost in [0.1, 0.3] {
        for seed in 0..149 {
            let faults = WireFaults {
                lose_request: lost,
                ..WireFaults::default()
            };
            let mut fixture = at_120(5, faults, seed);
            let before = turns(&fixture);
            fixture.command(STOP).unwrap();
            fixture.run(ms(2_000));
            let moved = moved_deg(&fixture, before);
            assert!(moved < 2.0, "{moved} degrees, seed {seed}, {lost} lost");
            assert_eq!(fixture.activity(), Activity::Idle);
        }
    }
}

/// Its replies are lost, and one request in ten.
#[test]
fn a_silent_motor_in_the_position_loop_gets_many_switches_and_no_brake() {
    for seed in 0..149 {
        let faults = WireFaults {
            lose_request: 0.1,
            ..WireFaults::default()
        };
        let mut fixture = at_120(5, faults, seed);
        let before = turns(&fixture);
        fixture.world.motor_mut(ID).unwrap().mute(true);
        fixture.command(STOP).unwrap();
        fixture.run(ms(2_000));
        let moved = moved_deg(&fixture, before);
        assert!(moved < 2.0, "{moved} degrees, seed {seed}");
        assert!(fixture.sent.iter().all(|sent| sent.drive_of(ID).is_none()));
        assert!(fixture.sent.iter().filter(|sent| sent.is_switch()).count() > 50);
    }
}

#[test]
fn a_port_that_takes_nothing_withdraws_the_setpoint() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_500));
    fixture.forget_the_past();
    fixture.adapter_is_busy = true;
    fixture.run(ms(300));
    assert!(fixture.happened(|event| matches!(
        event,
        Event::Withdrawn {
            reason: WithdrawReason::Silent,
            ..
        }
    )));
    fixture.adapter_is_busy = false;
    fixture.run(ms(2_000));
    let moves = |sent: &&fixture::Sent| sent.drive_of(ID).is_some_and(|drive| drive.signed() != 0);
    assert_eq!(fixture.sent.iter().filter(moves).count(), 0);
    assert!(fixture.true_rpm().abs() < 1.0);
}

#[test]
fn every_refused_frame_is_logged_as_not_sent_and_none_as_silence() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(100));
    fixture.forget_the_past();
    fixture.adapter_is_busy = true;
    fixture.run(ms(100));
    let mut refused = 0;
    for (_, event) in &fixture.events {
        let Event::Line(traffic) = event else {
            continue;
        };
        match traffic.kind {
            LineEventKind::NotSent { .. } => refused += 1,
            LineEventKind::Sent { .. } | LineEventKind::Silence { .. } => panic!("{traffic:?}"),
            _ => {}
        }
    }
    // Every 5 ms at most.
    assert!((15..=21).contains(&refused), "{refused} in 100 ms");
}

#[test]
fn a_scan_through_refusals_finds_every_motor() {
    let mut fixture = Fixture::new(WorldConfig::with_ids([ID, id(77), id(250)]));
    fixture.command(Command::FullScan).unwrap();
    for _ in 0..40 {
        fixture.adapter_is_busy = true;
        fixture.run(ms(30));
        fixture.adapter_is_busy = false;
        fixture.run(ms(50));
    }
    fixture.run(ms(8_000));
    let found = fixture.events.iter().find_map(|(_, event)| match event {
        Event::ScanEnded(report) => Some(report.found.clone()),
        _ => None,
    });
    assert_eq!(found, Some(vec![ID, id(77), id(250)]));
}

#[test]
fn a_scan_on_a_port_that_takes_nothing_ends() {
    let mut fixture = Fixture::one_motor();
    fixture.adapter_is_busy = true;
    let report = scan_report(&mut fixture);
    assert!(report.found.is_empty());
}

/// Reverses the torque on a bad line. Panics where the reverse is sent before an answered zero; says
/// whether it was sent.
fn reverses(lose: f64, refuse: bool, seed: u64) -> bool {
    let config = WorldConfig {
        seed,
        ..WorldConfig::default()
    };
    let mut fixture = Fixture::watching(config, &[ID]);
    fixture.switch(Mode::Current);
    fixture.drive(amps(2.0)).unwrap();
    fixture.run(ms(100));
    fixture.world.set_faults(WireFaults {
        lose_request: lose / 2.0,
        lose_reply: lose,
        ..WireFaults::default()
    });
    fixture.forget_the_past();
    fixture.drive(amps(-2.0)).unwrap();
    if refuse {
        fixture.adapter_is_busy = true;
        fixture.run(ms(30));
        fixture.adapter_is_busy = false;
    }
    fixture.run(ms(400));
    let mut zero_at = None;
    let mut answered = false;
    for (at, event) in &fixture.events {
        let Event::Line(traffic) = event else {
            continue;
        };
        match traffic.kind {
            LineEventKind::Sent { frame, .. } => {
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
            LineEventKind::Received { .. } => answered |= zero_at.is_some(),
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
    let mut fixture = Fixture::one_motor();
    fixture.switch(Mode::Current);
    fixture.drive(amps(2.0)).unwrap();
    fixture.run(ms(100));
    fixture.world.motor_mut(ID).unwrap().mute(true);
    fixture.forget_the_past();
    fixture.drive(amps(-2.0)).unwrap();
    fixture.run(ms(150));
    assert!(!fixture.sent.is_empty());
    let value = |sent: &fixture::Sent| sent.drive_of(ID).map_or(0, Drive::signed);
    assert!(fixture.sent.iter().all(|sent| value(sent) == 0));
}

/// An adapter begins to hold bytes, and every zero is lost: a reply to a frame before is no answer to it.
#[test]
fn a_late_reply_does_not_answer_a_zero_that_was_lost() {
    let holding = |lose_request| WireFaults {
        hold: ms(60),
        lose_request,
        ..WireFaults::default()
    };
    let ids = [ID, id(2), id(3)];
    for wait in 100..140 {
        let mut fixture = Fixture::watching(WorldConfig::with_ids(ids), &ids);
        fixture.switch(Mode::Current);
        fixture.world.motor_mut(ID).unwrap().set_load_nm(1.0);
        fixture.drive(amps(0.5)).unwrap();
        fixture.run(ms(577));
        fixture.world.set_faults(holding(0.0));
        fixture.run(ms(wait));
        fixture.world.set_faults(holding(1.0));
        fixture.forget_the_past();
        fixture.drive(amps(-0.5)).unwrap();
        fixture.run(ms(400));
        let value = |sent: &fixture::Sent| sent.drive_of(ID).map_or(0, Drive::signed);
        let reversed = fixture.sent.iter().find(|sent| value(sent) < 0);
        assert!(reversed.is_none(), "after {wait} ms: {reversed:?}");
    }
}
