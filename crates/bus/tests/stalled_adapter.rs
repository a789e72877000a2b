//! An adapter that stalls keeps what it is given and puts it on the wire later: how much that is.

use crate::fixture::{Fixture, ID, Sent, degrees, id, longest_gap, ms, rpm};
use motorlink_bus::{BusSettings, Command, CommandRate, Consent, Event, StopReason};
use motorlink_protocol::{Frame, Instant, Mode, MotorId, Setpoint};
use motorlink_simulator::{Echo, WireFaults, WorldConfig};

/// Nothing passes the adapter. What the bus sends meanwhile is what will come out of it.
fn stalled() -> WireFaults {
    WireFaults {
        lose_request: 1.0,
        ..WireFaults::default()
    }
}

fn as_fast_as_it_goes(fixture: &mut Fixture) {
    fixture
        .command(Command::Configure(BusSettings {
            rate: CommandRate::new(500).unwrap(),
            ..BusSettings::default()
        }))
        .unwrap();
}

fn driven(setpoint: Setpoint, mode: Mode) -> Fixture {
    let mut fixture = Fixture::one_motor();
    as_fast_as_it_goes(&mut fixture);
    if mode != Mode::Velocity {
        fixture.switch(mode);
    }
    fixture.drive(setpoint).unwrap();
    fixture.run(ms(500));
    fixture
}

/// When drive frames that are no stop were handed to the adapter since.
fn moving(fixture: &Fixture, motor: MotorId, since: Instant) -> Vec<Instant> {
    let frames = fixture.sent.iter().filter(|sent| sent.at >= since);
    let moving = frames.filter(|sent| sent.drive_of(motor).is_some_and(|drive| !drive.brakes()));
    moving.map(|sent| sent.at).collect()
}

#[test]
fn behind_an_adapter_that_stalls_no_more_than_one_drive_frame_waits() {
    for (setpoint, mode) in [(rpm(100), Mode::Velocity), (degrees(90.0), Mode::Position)] {
        for stop_after in [0, 1, 5, 50, 150, 250, 500] {
            let mut fixture = driven(setpoint, mode);
            let stalls = fixture.now;
            fixture.world.set_faults(stalled());
            fixture.run(ms(stop_after));
            fixture
                .command(Command::StopAll(StopReason::Operator))
                .unwrap();
            fixture.run(ms(1000 - stop_after));
            let waiting = moving(&fixture, ID, stalls);
            assert!(
                waiting.len() <= 1,
                "stopped {stop_after} ms into it, {mode:?}: {} drive frames wait",
                waiting.len()
            );
        }
    }
}

#[test]
fn what_is_driven_when_a_short_stall_ends_is_driven_on() {
    let mut fixture = driven(rpm(100), Mode::Velocity);
    fixture.world.set_faults(stalled());
    fixture.run(ms(60));
    fixture.world.set_faults(WireFaults::default());
    let ended = fixture.now;
    fixture.run(ms(60));
    assert!(!moving(&fixture, ID, ended).is_empty());
    assert!((fixture.true_rpm() - 100.0).abs() < 5.0);
}

#[test]
fn on_a_line_that_loses_frames_a_motor_gets_the_drive_frames_that_it_wants() {
    for (loss, gap_max) in [(0.05, ms(60)), (0.15, ms(90))] {
        let mut fixture = driven(rpm(100), Mode::Velocity);
        fixture.world.set_faults(WireFaults {
            lose_request: loss / 2.0,
            lose_reply: loss / 2.0,
            ..WireFaults::default()
        });
        let began = fixture.now;
        fixture.run(ms(10_000));
        let frames = moving(&fixture, ID, began);
        assert!(frames.len() >= 1500, "{loss}: {} in 10 s", frames.len());
        assert!(
            longest_gap(&frames) <= gap_max,
            "{loss}: {:?}",
            longest_gap(&frames)
        );
    }
}

/// The echo of a frame proves that the adapter has carried it.
#[test]
fn where_the_adapter_echoes_a_lost_reply_holds_no_drive_frame_back() {
    let mut fixture = driven(rpm(100), Mode::Velocity);
    fixture.world.set_faults(WireFaults {
        echo: Echo::Whole,
        lose_reply: 1.0,
        ..WireFaults::default()
    });
    let began = fixture.now;
    fixture.run(ms(100));
    assert!(moving(&fixture, ID, began).len() > 1);
}

#[test]
fn a_motor_that_falls_silent_leaves_those_beside_it_driven() {
    let mut fixture = Fixture::watching(WorldConfig::with_ids([ID, id(2)]), &[ID, id(2)]);
    for motor in [ID, id(2)] {
        let drive = Command::Drive {
            id: motor,
            setpoint: rpm(100),
            consent: Consent::None,
        };
        fixture.command(drive).unwrap();
    }
    fixture.run(ms(500));
    fixture.world.motor_mut(ID).unwrap().power(false);
    let since = fixture.now;
    fixture.run(ms(5_000));
    let frames = moving(&fixture, id(2), since);
    assert!(frames.len() >= 245, "{} in 5 s", frames.len());
    assert!(longest_gap(&frames) <= ms(60), "{:?}", longest_gap(&frames));
}

/// The query for a proof goes to the motor that answered last. Its silence is that of both.
#[test]
fn of_two_motors_that_lose_power_at_once_neither_is_driven_when_it_is_back() {
    for last in [ID, id(2)] {
        let mut fixture = Fixture::watching(WorldConfig::with_ids([ID, id(2)]), &[ID, id(2)]);
        fixture.drive(rpm(100)).unwrap();
        fixture.run(ms(1_000));
        // Until the one of them has answered last.
        fixture.run_until(ms(500), |fixture| {
            let newest = fixture
                .bus
                .motors(fixture.now)
                .max_by_key(|it| it.last.map(|it| it.at));
            newest.unwrap().id == last
        });
        for motor in [ID, id(2)] {
            fixture.world.motor_mut(motor).unwrap().power(false);
        }
        fixture.run(ms(5_000));
        assert!(fixture.happened(|event| matches!(event, Event::Withdrawn { .. })));
        for motor in [ID, id(2)] {
            fixture.world.motor_mut(motor).unwrap().power(true);
        }
        fixture.forget_the_past();
        fixture.run(ms(1_000));
        let moves = |sent: &Sent| sent.drive_of(ID).is_some_and(|drive| drive.signed() != 0);
        assert!(!fixture.sent.iter().any(moves), "{last} answered last");
    }
}

/// Seed 19696 of the fault simulation: the adapter delivers what it held, and the last reply says
/// that the motor lost its power for a moment. Its angle would now be a speed.
#[test]
fn every_reply_of_a_chunk_is_read_before_the_next_drive_frame() {
    let in_position: Frame = "01 03 00 0A 00 00 56 5F 00 6B".parse().unwrap();
    let in_velocity: Frame = "01 02 00 09 00 00 1E AC 00 A9".parse().unwrap();
    for stalled_for in [40, 80, 120] {
        let mut fixture = Fixture::one_motor();
        // Round trips of 6 ms: 2 ms after a query, its reply may still be on the wire.
        fixture.world.set_faults(WireFaults {
            hold: ms(4),
            ..WireFaults::default()
        });
        fixture.switch(Mode::Position);
        fixture.drive(degrees(120.0)).unwrap();
        fixture.run(ms(1_000));
        fixture.world.set_faults(stalled());
        fixture.run(ms(stalled_for));
        fixture.forget_the_past();
        fixture.run_until(ms(100), |fixture| {
            fixture.sent.last().is_some_and(Sent::is_query)
        });
        fixture.run(ms(2));
        let delivered = fixture.now;
        let chunk = [*in_position.bytes(), *in_velocity.bytes()].concat();
        fixture.bus.receive(delivered, &chunk);
        fixture.run(ms(100));
        assert!(fixture.happened(|event| matches!(event, Event::Withdrawn { .. })));
        let sent = moving(&fixture, ID, delivered);
        assert!(sent.is_empty(), "stalled for {stalled_for} ms: {sent:?}");
    }
}
