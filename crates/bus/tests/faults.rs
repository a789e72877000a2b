//! A line that fails: echoes, junk, losses, silence, power cuts, protections.

use crate::fixture::{Fixture, ID, amps, id, ms, rpm};
use motorlink_bus::{
    Activity, Answer, BusSettings, Command, Event, Limits, Refusal, WithdrawReason,
};
use motorlink_protocol::{Fault, Frame, Instant, Mode, Request};
use motorlink_simulator::{Echo, Split, WireFaults, WorldConfig};

fn on_a_wire_with(faults: WireFaults, seed: u64) -> Fixture {
    let config = WorldConfig {
        seed,
        faults,
        ..WorldConfig::default()
    };
    Fixture::watching(config, &[ID])
}

#[test]
fn whole_and_cut_echoes_are_distinguished_from_replies() {
    for echo in [Echo::Whole].into_iter().chain((1..10).map(Echo::Cut)) {
        let mut fixture = on_a_wire_with(
            WireFaults {
                echo,
                ..WireFaults::default()
            },
            1,
        );
        fixture.drive(rpm(100)).unwrap();
        fixture.run(ms(2_000));
        let status = fixture.status(ID);
        assert_eq!(status.link.loss_per_mille, Some(0), "{echo:?}");
        let (whole, cut) = (status.counters.echoes_whole, status.counters.echoes_cut);
        assert_eq!(echo == Echo::Whole, whole > 100, "{echo:?}: {whole} whole");
        assert_eq!(echo != Echo::Whole, cut > 100, "{echo:?}: {cut} cut");
        assert_eq!(status.counters.junk_bytes, 0, "{echo:?}");
        assert!((fixture.true_rpm() - 100.0).abs() < 3.0);
        fixture.assert_telemetry_is_true(1);
    }
}

#[test]
fn replies_in_pieces_are_put_together() {
    let mut fixture = on_a_wire_with(
        WireFaults {
            split: Some(Split::default()),
            ..WireFaults::default()
        },
        3,
    );
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(3_000));
    assert_eq!(fixture.status(ID).link.loss_per_mille, Some(0));
    fixture.assert_telemetry_is_true(3);
}

#[test]
fn an_adapter_that_holds_bytes_for_16_ms_is_waited_for() {
    let faults = WireFaults {
        hold: ms(16),
        ..WireFaults::default()
    };
    let mut fixture = on_a_wire_with(faults, 4);
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(3_000));
    let status = fixture.status(ID);
    assert_eq!(status.link.loss_per_mille, Some(0));
    assert!(status.link.round_trip_us.unwrap() > 16_000);
    assert!(
        status
            .temperature
            .is_some_and(|(at, _)| fixture.now.since(at) < ms(500))
    );
    fixture.assert_telemetry_is_true(4);
}

#[test]
fn with_losses_and_flipped_bits_nothing_false_is_read_and_driving_goes_on() {
    for seed in 0..40 {
        let faults = WireFaults {
            lose_reply: 0.15,
            corrupt_reply: 0.15,
            ..WireFaults::default()
        };
        let mut fixture = on_a_wire_with(faults, seed);
        if fixture.drive(rpm(100)).is_err() {
            continue; // its telemetry is not fresh, so the command is refused
        }
        fixture.run(ms(3_000));
        let withdrawn = fixture.happened(|e| matches!(e, Event::Withdrawn { .. }));
        // Of 150; three losses in a row widen the window once, and queries for an old temperature go
        // instead of a few.
        let frames = fixture.drive_times(ID).len();
        assert!(withdrawn || frames >= 140, "seed {seed}: {frames}");
        let counters = fixture.status(ID).counters;
        assert!(counters.silences > 0, "seed {seed}: {counters:?}");
        assert!(counters.bad_crcs > 0, "seed {seed}: {counters:?}");
        fixture.assert_telemetry_is_true(seed);
    }
}

#[test]
fn after_any_junk_the_next_good_reply_but_one_is_read() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(50)).unwrap();
    fixture.run(ms(500));
    for length in 0..300_usize {
        let junk: Vec<u8> = (0..length)
            .map(|n| [0x01, 0x02, 0x64, 0xFF][n * 7 % 4])
            .collect();
        fixture.forget_the_past();
        fixture.bus.receive(fixture.now, &junk);
        fixture.run(ms(45)); // two drive frames and perhaps a query
        let heard = fixture
            .events
            .iter()
            .filter(|(_, e)| matches!(e, Event::Telemetry(_)))
            .count();
        assert!(heard >= 1, "{length} bytes of junk");
    }
}

#[test]
fn a_good_frame_of_another_motor_is_counted_and_not_taken() {
    let mut fixture = Fixture::one_motor();
    fixture.run(ms(1_000));
    let speed = fixture.status(ID).last.unwrap().reply.speed;
    let stranger = Frame::with_crc([9, 2, 0, 0, 0, 99, 30, 0, 0]);
    fixture.bus.receive(fixture.now, stranger.bytes());
    fixture.run(ms(150));
    let counted = fixture.bus.line_status(fixture.now).unaddressed.wrong_ids
        + fixture.status(ID).counters.wrong_ids;
    assert_eq!(counted, 1);
    assert_eq!(fixture.status(ID).last.unwrap().reply.speed, speed);
    assert!(fixture.bus.motors(fixture.now).all(|motor| motor.id == ID));
}

#[test]
fn a_motor_that_falls_silent_loses_its_setpoint_and_is_not_started_again_when_it_is_back() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_000));
    fixture.world.motor_mut(ID).unwrap().power(false);
    let cut = fixture.now;
    fixture.run(ms(6_000));
    let withdrawn = fixture
        .events
        .iter()
        .find(|(_, e)| matches!(e, Event::Withdrawn { .. }))
        .unwrap();
    assert_eq!(
        withdrawn.1,
        Event::Withdrawn {
            id: ID,
            reason: WithdrawReason::Silent
        }
    );
    assert!(
        withdrawn.0.since(cut) <= ms(230),
        "{:?}",
        withdrawn.0.since(cut)
    );
    let silent = fixture
        .events
        .iter()
        .find(|(_, e)| {
            *e == (Event::MotorSilent {
                id: ID,
                garbled: false,
            })
        })
        .unwrap();
    assert!(silent.0.since(cut) >= ms(1_900) && silent.0.since(cut) <= ms(2_100));
    fixture.world.motor_mut(ID).unwrap().power(true);
    fixture.forget_the_past();
    fixture.run(ms(3_000));
    assert!(fixture.happened(|e| *e == Event::MotorBack(ID)));
    // It is stopped again, and nothing else.
    let mut drives = fixture.sent.iter().filter_map(|sent| sent.drive_of(ID));
    assert!(drives.all(motorlink_protocol::Drive::brakes));
    assert!(fixture.true_rpm().abs() < 1.0);
}

#[test]
fn a_motor_whose_replies_are_all_corrupted_is_told_from_one_without_power() {
    let mut fixture = Fixture::one_motor();
    fixture.run(ms(500));
    fixture.world.set_faults(WireFaults {
        corrupt_reply: 1.0,
        ..WireFaults::default()
    });
    fixture.run(ms(3_000));
    let garbled = true;
    assert!(fixture.happened(|e| *e == Event::MotorSilent { id: ID, garbled }));
    assert_eq!(fixture.status(ID).answer, Answer::Corrupted);
}

#[test]
fn what_comes_from_a_silent_motor_is_judged_again_while_it_is_silent() {
    let mut fixture = Fixture::one_motor();
    fixture.run(ms(500));
    let corrupted = |share| WireFaults {
        corrupt_reply: share,
        ..WireFaults::default()
    };
    fixture.world.set_faults(corrupted(1.0));
    fixture.run(ms(3_000));
    assert_eq!(fixture.status(ID).answer, Answer::Corrupted);
    fixture.world.motor_mut(ID).unwrap().power(false);
    fixture.run(ms(5_000));
    assert_eq!(fixture.status(ID).answer, Answer::Missing);
    // It starts, and the line is as bad as before.
    fixture.world.motor_mut(ID).unwrap().power(true);
    fixture.run(ms(5_000));
    assert_eq!(fixture.status(ID).answer, Answer::Corrupted);
    fixture.world.set_faults(corrupted(0.0));
    fixture.run(ms(1_000));
    assert_eq!(fixture.status(ID).answer, Answer::Comes);
}

/// A machine that holds the worker up for a while is no silent motor.
#[test]
fn a_bus_that_was_not_run_for_a_while_drives_on() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    for held_up in [50, 150, 250, 400] {
        fixture.run(ms(500));
        fixture.now = fixture.now + ms(held_up);
        fixture.run(ms(500));
        assert!(
            !fixture.happened(|e| matches!(e, Event::Withdrawn { .. })),
            "{held_up} ms"
        );
    }
    assert!((fixture.true_rpm() - 100.0).abs() < 3.0);
}

/// A raw current of 1,000 would be read as 330 rpm by a motor that came back in the velocity loop.
#[test]
fn a_current_is_never_sent_to_a_motor_that_came_back_in_the_velocity_loop() {
    for off in [10, 50, 120, 190, 250, 1_000] {
        let mut fixture = Fixture::one_motor();
        fixture.switch(Mode::Current);
        fixture.world.motor_mut(ID).unwrap().set_load_nm(0.5);
        fixture.drive(amps(0.25)).unwrap();
        fixture.run(ms(500));
        fixture.world.motor_mut(ID).unwrap().power(false);
        fixture.run(ms(off));
        fixture.world.motor_mut(ID).unwrap().power(true);
        fixture.run(ms(1_000));
        assert!(
            fixture.happened(|e| matches!(e, Event::Withdrawn { .. })),
            "off for {off} ms"
        );
        assert!(
            fixture.true_rpm().abs() < 1.0,
            "off for {off} ms: {}",
            fixture.true_rpm()
        );
        assert_eq!(fixture.activity(), Activity::Idle);
    }
}

#[test]
fn a_protection_takes_the_setpoint_and_its_end_does_not_bring_it_back() {
    let mut fixture = Fixture::one_motor();
    // The limit of half a second would be crossed first.
    let no_limits = Limits::new(330, 8_000, 80).unwrap();
    fixture
        .command(Command::Configure(BusSettings {
            limits: no_limits,
            ..BusSettings::default()
        }))
        .unwrap();
    fixture.world.motor_mut(ID).unwrap().block(true);
    fixture.drive(rpm(100)).unwrap();
    fixture.run_until(ms(7_000), |b| {
        b.happened(|e| matches!(e, Event::Withdrawn { .. }))
    });
    let stalled = fixture.events.iter().any(|(_, e)| {
        matches!(e, Event::Withdrawn { reason: WithdrawReason::Fault(faults), .. }
            if faults.contains(Fault::Stall))
    });
    assert!(stalled);
    fixture.run(ms(500));
    assert!(matches!(
        fixture.drive(rpm(100)),
        Err(Refusal::FaultActive { .. } | Refusal::Stopping(_))
    ));
    fixture.world.motor_mut(ID).unwrap().block(false);
    fixture.run(ms(10_000));
    assert!(fixture.true_rpm().abs() < 1.0);
    assert_eq!(fixture.activity(), Activity::Idle);
    assert_eq!(fixture.drive(rpm(100)), Ok(()));
}

#[test]
fn windows_are_never_waited_twice_and_frames_never_overlap() {
    let mut fixture = Fixture::watching(WorldConfig::default(), &[ID, id(9)]);
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(3_000));
    for pair in fixture.sent.windows(2) {
        let gap = pair[1].at.since(pair[0].at);
        assert!(
            gap >= std::time::Duration::from_micros(1_868),
            "{gap:?} between {pair:?}"
        );
    }
    // Motor 9 is silent: asked ten times a second at first, once a second when that is known.
    let asked = fixture
        .sent
        .iter()
        .filter(|s| s.request() == Request::Query { id: id(9) })
        .count();
    assert!((15..=25).contains(&asked), "{asked}");
    assert!(fixture.now > Instant::ZERO);
}
