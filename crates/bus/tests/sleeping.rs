//! A computer that slept, or a worker that was delayed, drives nothing by itself.

use crate::fixture;
use std::time::Duration;

use crate::fixture::{Fixture, ID, amps, degrees, every, ms, raw, rpm, scan_report, to};
use motorlink_bus::{
    Activity, BusSettings, Command, CommandRate, Event, IdChangeOutcome, Refusal, SetIdFrames,
    StopReason,
};
use motorlink_protocol::{Mode, Request, Setpoint};

/// The first call of the bus after the gap.
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
fn call(fixture: &mut Fixture, first: First) {
    let setpoint = rpm(100);
    let consent = motorlink_bus::Consent::None;
    let now = fixture.now;
    match first {
        First::Poll => {}
        First::Pong => fixture.bus.page_answered(now),
        First::Bytes => fixture.deliver(),
        First::Watch => fixture.bus.command(now, Command::Watch(ID)).unwrap(),
        First::Drive => {
            let drive = Command::Drive {
                id: ID,
                setpoint,
                consent,
            };
            assert_eq!(fixture.bus.command(now, drive), Err(Refusal::Halted));
        }
        First::Adjust => {
            let adjust = Command::Adjust {
                id: ID,
                setpoint,
                consent,
            };
            assert!(fixture.bus.command(now, adjust).is_err());
        }
    }
}

fn stop_reason(fixture: &Fixture) -> Option<StopReason> {
    fixture.events.iter().find_map(|(_, event)| match event {
        Event::StopBegan(reason) => Some(*reason),
        _ => None,
    })
}

/// Frames that would move a wheel.
fn drives(fixture: &Fixture) -> usize {
    let moves = |sent: &&fixture::Sent| {
        sent.drive_of(ID)
            .is_some_and(|drive| drive.signed() != 0 && !drive.brakes())
    };
    fixture.sent.iter().filter(moves).count()
}

#[test]
fn a_wheel_driven_before_a_gap_is_stopped_by_any_first_call_after_it() {
    for first in FIRST {
        for (gap, reason) in [
            (ms(800), StopReason::LoopDelayed),
            (ms(4_000), StopReason::LoopDelayed),
            (ms(30_000), StopReason::ComputerSlept),
            (Duration::from_secs(60), StopReason::ComputerSlept),
        ] {
            // The gap begins at any place of the drive loop.
            for phase_us in [0, 700, 1_900, 2_600, 9_000, 15_000] {
                let mut fixture = Fixture::one_motor();
                fixture.drive(rpm(100)).unwrap();
                fixture.run(ms(1_500) + Duration::from_micros(phase_us));
                fixture.forget_the_past();
                fixture.sleep(gap);
                call(&mut fixture, first);
                fixture.run(ms(1_000));
                assert_eq!(drives(&fixture), 0, "{first:?} after {gap:?}");
                assert_eq!(stop_reason(&fixture), Some(reason), "{first:?}");
                assert!(fixture.bus.is_halted());
                assert!(fixture.true_rpm().abs() < 1.0);
                assert_eq!(fixture.drive(rpm(50)), Err(Refusal::Halted));
                fixture.command(Command::Release).unwrap();
                fixture.drive(rpm(50)).unwrap();
            }
        }
    }
}

#[test]
fn every_way_to_drive_ends_by_a_gap() {
    let frame = fixture::drive_frame(ID, rpm(40));
    for mode in [Mode::Current, Mode::Position, Mode::Velocity] {
        let mut fixture = Fixture::one_motor();
        fixture.switch(mode);
        match mode {
            Mode::OpenLoop => unreachable!("a DDSM115 has none"),
            Mode::Current => fixture.drive(amps(0.3)).unwrap(),
            Mode::Position => fixture.drive(degrees(300.0)).unwrap(),
            Mode::Velocity => fixture.command(raw(frame, every(0, 20))).unwrap(),
        }
        fixture.run(ms(150));
        fixture.sleep(ms(60_000));
        let before = fixture.world.motor(ID).unwrap().turns();
        fixture.run(ms(2_000));
        assert_eq!(fixture.activity(), Activity::Idle, "{mode:?}");
        assert_eq!(stop_reason(&fixture), Some(StopReason::ComputerSlept));
        // It was driven all along: what it turns now is its braking distance.
        let turns = (fixture.world.motor(ID).unwrap().turns() - before).abs();
        assert!(turns < 0.5, "{mode:?}: {turns} turns");
        assert!(fixture.true_rpm().abs() < 1.0, "{mode:?}");
    }
}

#[test]
fn a_late_call_within_half_a_second_goes_on() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_500));
    fixture.forget_the_past();
    fixture.sleep(ms(490));
    fixture.run(ms(200));
    assert_eq!(stop_reason(&fixture), None);
    assert_eq!(fixture.activity(), Activity::Driven { setpoint: rpm(100) });
}

#[test]
fn a_gap_while_nothing_is_driven_stops_nothing() {
    let mut fixture = Fixture::one_motor();
    fixture.sleep(ms(60_000));
    fixture.run(ms(500));
    assert_eq!(stop_reason(&fixture), None);
    assert!(!fixture.bus.is_halted());
    fixture.drive(rpm(50)).unwrap();
}

/// It could not answer while the bus did not ask.
#[test]
fn a_page_that_answered_before_a_gap_is_not_called_silent_after_it() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_500));
    fixture.sleep(ms(60_000));
    fixture.run(ms(1_000));
    let silent = |event: &Event| matches!(event, Event::StopBegan(StopReason::PageSilent));
    assert!(!fixture.happened(silent));
}

/// Five frames in a row, of which some were sent a night ago.
#[test]
fn an_id_change_does_not_go_on_after_a_gap() {
    let mut fixture = Fixture::one_motor();
    scan_report(&mut fixture);
    fixture
        .command(Command::SetId {
            from: ID,
            to: to(5),
            frames: SetIdFrames::Five,
        })
        .unwrap();
    fixture.run_until(ms(2_000), |fixture| {
        fixture
            .sent
            .iter()
            .filter(|sent| fixture::is_set_id(sent))
            .count()
            >= 2
    });
    fixture.forget_the_past();
    fixture.sleep(ms(60_000));
    fixture.run(ms(2_000));
    assert!(!fixture.sent.iter().any(fixture::is_set_id));
    assert!(fixture.happened(|event| matches!(
        event,
        Event::IdChangeEnded {
            outcome: IdChangeOutcome::Cancelled { .. },
            ..
        }
    )));
}

#[test]
fn a_stop_under_way_goes_on_after_a_gap_and_is_confirmed() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_500));
    fixture
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    fixture.run(ms(30));
    fixture.forget_the_past();
    fixture.sleep(ms(20_000));
    fixture.run(ms(500));
    let confirmed = fixture.events.iter().find_map(|(_, event)| match event {
        Event::StopEnded(report) => Some(report.motors[0].confirmed),
        _ => None,
    });
    assert_eq!(confirmed, Some(true));
    let brake = |sent: &fixture::Sent| {
        matches!(sent.request(), Request::Query { .. })
            || sent.drive_of(ID) == Some(Setpoint::Brake.into())
    };
    assert!(fixture.sent.iter().all(brake));
}

/// It was measured a night ago.
#[test]
fn a_reply_that_waited_through_a_gap_is_no_reading_of_now() {
    let mut fixture = Fixture::one_motor();
    fixture.run_until(ms(200), |fixture| {
        fixture.sent.last().is_some_and(fixture::Sent::is_query)
    });
    fixture.forget_the_past();
    fixture.sleep(ms(114_000));
    fixture.deliver();
    fixture.run(ms(0));
    assert!(!fixture.happened(|event| matches!(event, Event::Telemetry(_))));
    fixture.run(ms(300));
    assert!(fixture.happened(|event| matches!(event, Event::Telemetry(_))));
}

#[test]
fn a_release_from_before_a_gap_does_not_release_the_stop_of_the_gap() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_000));
    fixture.sleep(ms(20_000));
    let released = fixture.bus.command(fixture.now, Command::Release);
    assert_eq!(released, Err(Refusal::Halted));
    fixture.run(ms(500));
    assert!(fixture.bus.is_halted());
    fixture.command(Command::Release).unwrap();
    assert!(!fixture.bus.is_halted());
}

/// A page that had sent nothing blamed the plug: "no reply for 200 ms. Check the motor's power".
#[test]
fn a_stalled_computer_is_not_blamed_on_the_motor() {
    for phase in 0..20 {
        let mut fixture = Fixture::one_motor();
        fixture
            .command(Command::Configure(BusSettings {
                rate: CommandRate::new(200).unwrap(),
                ..BusSettings::default()
            }))
            .unwrap();
        fixture.drive(rpm(100)).unwrap();
        fixture.run(ms(1_000 + phase));
        fixture.world.motor_mut(ID).unwrap().mute(true);
        fixture.run(ms(30));
        fixture.world.motor_mut(ID).unwrap().mute(false);
        fixture.sleep(ms(193));
        fixture.run(ms(300));
        let is_withdrawn = |event: &Event| matches!(event, Event::Withdrawn { .. });
        assert!(!fixture.happened(is_withdrawn), "phase {phase}");
    }
}

#[test]
fn a_motor_that_nobody_asked_while_the_computer_slept_is_not_silent() {
    for slept in [2_100, 4_000, 60_000] {
        let mut fixture = Fixture::one_motor();
        fixture.run(ms(500));
        fixture.sleep(ms(slept));
        fixture.run(ms(500));
        let is_silent = |event: &Event| matches!(event, Event::MotorSilent { .. });
        assert!(!fixture.happened(is_silent), "{slept} ms");
        // One without power is asked, and then it is silent.
        fixture.world.motor_mut(ID).unwrap().power(false);
        fixture.run(ms(2_200));
        assert!(fixture.happened(is_silent), "{slept} ms");
    }
}
