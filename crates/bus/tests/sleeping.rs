//! A computer that slept, or a worker that was delayed, drives nothing by itself.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test fails by panicking, in its helpers too"
)]

mod bench;

use std::time::Duration;

use bench::{Bench, ID, amps, degrees, every, ms, raw, rpm, scan_report, to};
use motorlink_bus::{Activity, Command, Event, IdChangeOutcome, Refusal, SetIdFrames, StopReason};
use motorlink_protocol::{Mode, Request, Setpoint};

/// What the bus is told first after the gap.
#[derive(Clone, Copy, Debug)]
enum First {
    Poll,
    Pong,
    Bytes,
    Watch,
    Drive,
    Adjust,
}

const FIRST: [First; 6] = [
    First::Poll,
    First::Pong,
    First::Bytes,
    First::Watch,
    First::Drive,
    First::Adjust,
];

/// Calls the bus once, without the poll behind it.
fn call(bench: &mut Bench, first: First) {
    let setpoint = rpm(100);
    let consent = motorlink_bus::Consent::None;
    let now = bench.now;
    match first {
        First::Poll => {}
        First::Pong => bench.bus.page_answered(now),
        First::Bytes => bench.deliver(),
        First::Watch => bench.bus.command(now, Command::Watch(ID)).unwrap(),
        First::Drive => {
            let drive = Command::Drive {
                id: ID,
                setpoint,
                consent,
            };
            assert_eq!(bench.bus.command(now, drive), Err(Refusal::Halted));
        }
        First::Adjust => {
            let adjust = Command::Adjust {
                id: ID,
                setpoint,
                consent,
            };
            assert!(bench.bus.command(now, adjust).is_err());
        }
    }
}

fn stop_reason(bench: &Bench) -> Option<StopReason> {
    bench.events.iter().find_map(|(_, event)| match event {
        Event::StopBegan(reason) => Some(*reason),
        _ => None,
    })
}

/// Frames that would move a wheel.
fn drives(bench: &Bench) -> usize {
    let moves = |sent: &&bench::Sent| {
        sent.drive_of(ID)
            .is_some_and(|drive| drive.signed() != 0 && !drive.brakes())
    };
    bench.sent.iter().filter(moves).count()
}

#[test]
fn a_wheel_driven_before_a_gap_is_stopped_whatever_comes_first_after_it() {
    for first in FIRST {
        for (gap, reason) in [
            (ms(800), StopReason::LoopDelayed),
            (ms(4_000), StopReason::LoopDelayed),
            (ms(30_000), StopReason::ComputerSlept),
            (Duration::from_secs(600), StopReason::ComputerSlept),
        ] {
            // The gap begins at any place of the drive loop.
            for phase_us in [0, 700, 1_900, 2_600, 9_000, 15_000] {
                let mut bench = Bench::one_motor();
                bench.drive(rpm(100)).unwrap();
                bench.run(ms(1_500) + Duration::from_micros(phase_us));
                bench.forget_the_past();
                bench.sleep(gap);
                call(&mut bench, first);
                bench.run(ms(1_000));
                assert_eq!(drives(&bench), 0, "{first:?} after {gap:?}");
                assert_eq!(stop_reason(&bench), Some(reason), "{first:?}");
                assert!(bench.bus.is_halted());
                assert!(bench.true_rpm().abs() < 1.0);
                assert_eq!(bench.drive(rpm(50)), Err(Refusal::Halted));
                bench.command(Command::Release).unwrap();
                bench.drive(rpm(50)).unwrap();
            }
        }
    }
}

#[test]
fn every_way_to_drive_ends_by_a_gap() {
    let frame = bench::drive_frame(ID, rpm(40));
    for mode in [Mode::Current, Mode::Position, Mode::Velocity] {
        let mut bench = Bench::one_motor();
        bench.switch(mode);
        match mode {
            Mode::Current => bench.drive(amps(0.3)).unwrap(),
            Mode::Position => bench.drive(degrees(300.0)).unwrap(),
            Mode::Velocity => bench.command(raw(frame, every(0, 20))).unwrap(),
        }
        bench.run(ms(150));
        bench.sleep(ms(60_000));
        let before = bench.world.motor(ID).unwrap().turns();
        bench.run(ms(2_000));
        assert_eq!(bench.activity(), Activity::Idle, "{mode:?}");
        assert_eq!(stop_reason(&bench), Some(StopReason::ComputerSlept));
        let after = bench.world.motor(ID).unwrap().turns();
        assert!(
            (after - before).abs() < 0.01,
            "{mode:?}: {before} to {after}"
        );
    }
}

#[test]
fn a_late_call_within_half_a_second_goes_on() {
    let mut bench = Bench::one_motor();
    bench.drive(rpm(100)).unwrap();
    bench.run(ms(1_500));
    bench.forget_the_past();
    bench.sleep(ms(490));
    bench.run(ms(200));
    assert_eq!(stop_reason(&bench), None);
    assert_eq!(bench.activity(), Activity::Driven { setpoint: rpm(100) });
}

#[test]
fn a_gap_while_nothing_is_driven_stops_nothing() {
    let mut bench = Bench::one_motor();
    bench.sleep(ms(60_000));
    bench.run(ms(500));
    assert_eq!(stop_reason(&bench), None);
    assert!(!bench.bus.is_halted());
    bench.drive(rpm(50)).unwrap();
}

/// Five frames in a row, of which some were sent a night ago.
#[test]
fn an_id_change_does_not_go_on_after_a_gap() {
    let mut bench = Bench::one_motor();
    scan_report(&mut bench);
    bench
        .command(Command::SetId {
            from: ID,
            to: to(5),
            frames: SetIdFrames::Five,
        })
        .unwrap();
    bench.run_until(ms(2_000), |bench| {
        bench
            .sent
            .iter()
            .filter(|sent| bench::is_set_id(sent))
            .count()
            >= 2
    });
    bench.forget_the_past();
    bench.sleep(ms(60_000));
    bench.run(ms(2_000));
    assert!(!bench.sent.iter().any(bench::is_set_id));
    assert!(bench.happened(|event| matches!(
        event,
        Event::IdChangeEnded {
            outcome: IdChangeOutcome::Cancelled { .. },
            ..
        }
    )));
}

#[test]
fn a_stop_under_way_goes_on_after_a_gap_and_is_confirmed() {
    let mut bench = Bench::one_motor();
    bench.drive(rpm(100)).unwrap();
    bench.run(ms(1_500));
    bench
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    bench.run(ms(30));
    bench.forget_the_past();
    bench.sleep(ms(20_000));
    bench.run(ms(500));
    let confirmed = bench.events.iter().find_map(|(_, event)| match event {
        Event::StopEnded(report) => Some(report.motors[0].confirmed),
        _ => None,
    });
    assert_eq!(confirmed, Some(true));
    let brake = |sent: &bench::Sent| {
        matches!(sent.request(), Request::Query { .. })
            || sent.drive_of(ID) == Some(Setpoint::Brake.into())
    };
    assert!(bench.sent.iter().all(brake));
}

/// It was measured a night ago.
#[test]
fn a_reply_that_waited_through_a_gap_is_no_reading_of_now() {
    let mut bench = Bench::one_motor();
    bench.run_until(ms(200), |bench| {
        bench.sent.last().is_some_and(bench::Sent::is_query)
    });
    bench.forget_the_past();
    bench.sleep(ms(114_000));
    bench.deliver();
    bench.run(ms(0));
    assert!(!bench.happened(|event| matches!(event, Event::Telemetry(_))));
    bench.run(ms(300));
    assert!(bench.happened(|event| matches!(event, Event::Telemetry(_))));
}

#[test]
fn a_release_from_before_a_gap_does_not_release_the_stop_of_the_gap() {
    let mut bench = Bench::one_motor();
    bench.drive(rpm(100)).unwrap();
    bench.run(ms(1_000));
    bench.sleep(ms(20_000));
    let released = bench.bus.command(bench.now, Command::Release);
    assert_eq!(released, Err(Refusal::Halted));
    bench.run(ms(500));
    assert!(bench.bus.is_halted());
    bench.command(Command::Release).unwrap();
    assert!(!bench.bus.is_halted());
}
