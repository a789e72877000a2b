//! A line that fails: echoes, junk, losses, silence, power cuts, protections.
#![cfg(test)]

mod fixture;

use fixture::{Fixture, ID, amps, degrees, id, ms, rpm};
use motorlink_bus::{
    Activity, BusSettings, Command, Event, Limits, LineEventKind, Refusal, WithdrawReason,
};
use motorlink_protocol::{Detail, Fault, Frame, Instant, Mode, Request};
use motorlink_simulator::{Echo, Split, WireFaults, WorldConfig};

fn on_a_wire_with(faults: WireFaults, seed: u64) -> Fixture {
    let config = WorldConfig {
        seed,
        faults,
        ..WorldConfig::default()
    };
    Fixture::watching(config, &[ID])
}

/// Every reply that was read says what was true of the motor: no layout is ever read as the other.
fn assert_telemetry_is_true(fixture: &Fixture, seed: u64) {
    for (at, event) in &fixture.events {
        let Event::Telemetry(sample) = event else {
            continue;
        };
        assert_eq!(sample.reply.id, ID, "seed {seed} at {at:?}");
        if let Detail::Query { temperature, .. } = sample.reply.detail {
            let true_c = fixture.world.motor(ID).unwrap().temperature_c();
            let read = f32::from(temperature.degrees());
            assert!(
                (read - true_c).abs() <= 3.0,
                "seed {seed} at {at:?}: {read} for {true_c}"
            );
        }
    }
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
        assert_telemetry_is_true(&fixture, 1);
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
    assert_telemetry_is_true(&fixture, 3);
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
    assert_telemetry_is_true(&fixture, 4);
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
        // Of 150; three losses in a row widen the window once, which costs a frame.
        let frames = fixture.drive_times(ID).len();
        assert!(withdrawn || frames >= 144, "seed {seed}: {frames}");
        let counters = fixture.status(ID).counters;
        assert!(counters.silences > 0, "seed {seed}: {counters:?}");
        assert!(counters.bad_crcs > 0, "seed {seed}: {counters:?}");
        assert_telemetry_is_true(&fixture, seed);
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
    assert!(fixture.drive_times(ID).is_empty());
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

/// A drive reply that comes when a query is in flight would be read as 60 degrees of heat.
#[test]
fn a_late_reply_is_not_read_in_the_layout_of_the_next_request() {
    let mut fixture = Fixture::one_motor();
    fixture.run(ms(500));
    // Fast round trips have made the window short; now one reply takes 20 ms.
    for trial in 0..60 {
        fixture.drive(rpm(60)).unwrap();
        fixture.run(ms(80 + trial));
        fixture.world.set_faults(WireFaults {
            hold: ms(20),
            ..WireFaults::default()
        });
        fixture.run(ms(25));
        fixture.world.set_faults(WireFaults::default());
        fixture.run(ms(40));
        assert_telemetry_is_true(&fixture, trial);
    }
    assert!(
        fixture.status(ID).counters.late > 0,
        "{:?} {:?}",
        fixture.status(ID).counters,
        fixture.bus.line_status(fixture.now).unaddressed
    );
}

/// Of a query and a drive frame that were both lost, either may still be answered.
#[test]
fn after_two_losses_in_a_row_no_layout_is_read_as_the_other() {
    for trial in 0..120_u64 {
        for stall in [28, 36, 45, 70, 110, 160] {
            let mut fixture = Fixture::one_motor();
            fixture.switch(Mode::Position);
            fixture.drive(degrees(40.0)).unwrap();
            fixture.run(ms(1_200) + std::time::Duration::from_micros(trial * 931));
            fixture.forget_the_past();
            fixture.world.set_faults(WireFaults {
                hold: ms(stall),
                ..WireFaults::default()
            });
            fixture.run(ms(stall));
            fixture.world.set_faults(WireFaults::default());
            fixture.run(ms(60));
            assert_telemetry_is_true(&fixture, trial);
            for (_, event) in &fixture.events {
                let Event::Telemetry(sample) = event else {
                    continue;
                };
                if let Detail::Drive { position } = sample.reply.detail {
                    assert!(
                        (position.degrees() - 40.0).abs() < 3.0,
                        "{trial} {stall} {position}"
                    );
                }
            }
        }
    }
}

/// A reply that a stalled adapter or machine delivers long after its window is not read as the answer
/// to a later request: a position would be read as a temperature.
#[test]
fn the_answer_to_an_id_query_is_not_read_in_the_layout_of_a_later_query() {
    for stall in [55, 65, 75, 100, 150, 300] {
        let mut fixture = Fixture::new(WorldConfig::default());
        fixture.world.set_faults(WireFaults {
            hold: ms(stall),
            ..WireFaults::default()
        });
        fixture.command(Command::IdQuery).unwrap();
        fixture.run(ms(5));
        fixture.command(Command::Watch(ID)).unwrap();
        fixture.run(ms(stall));
        fixture.world.set_faults(WireFaults::default());
        fixture.run(ms(500));
        assert_telemetry_is_true(&fixture, stall);
        assert!(fixture.status(ID).temperature.is_some());
    }
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

/// Seed 57716: an adapter begins to hold bytes for 120 ms, and a motor loses its power for a moment. Its
/// replies from the velocity loop are too late to be readings, and the angle would be read as a speed.
#[test]
fn a_reply_of_unknown_age_that_reports_another_loop_takes_the_setpoint() {
    for wait in 0..20 {
        let mut fixture = fixture::two();
        fixture.switch(Mode::Position);
        fixture.drive(degrees(40.0)).unwrap();
        fixture.run(ms(1_000 + wait));
        fixture.world.set_faults(WireFaults {
            hold: ms(120),
            ..WireFaults::default()
        });
        fixture.run(ms(20));
        fixture.forget_the_past();
        fixture.world.motor_mut(ID).unwrap().power(false);
        fixture.world.motor_mut(ID).unwrap().power(true);
        fixture.run(ms(400));
        let other_loop = |event: &Event| {
            let Event::Line(line) = event else {
                return false;
            };
            let LineEventKind::Received { frame, .. } = line.kind else {
                return false;
            };
            frame
                .bytes()
                .starts_with(&[ID.get(), Mode::Velocity.byte()])
        };
        let heard = fixture.events.iter().find(|(_, event)| other_loop(event));
        let (heard, _) = heard.expect("a reply from the velocity loop");
        let angle = |sent: &&fixture::Sent| {
            sent.at >= *heard && sent.drive_of(ID).is_some_and(|drive| drive.signed() != 0)
        };
        let sent = fixture.sent.iter().find(angle);
        assert!(sent.is_none(), "{wait} ms: {sent:?} behind {heard:?}");
    }
}

/// A drive frame with a byte that no drive frame has is answered like one, by a motor that does not mind.
#[test]
fn the_answer_to_an_unknown_raw_frame_is_not_read_in_the_layout_of_a_later_query() {
    let [id, command, high, low, ..] = *fixture::drive_frame(ID, rpm(60)).bytes();
    let odd = Frame::with_crc([id, command, high, low, 0, 0, 0, 0, 1]);
    for stall in [30, 45, 65, 90] {
        for trial in 0..20 {
            let mut fixture = Fixture::one_motor();
            fixture.run(ms(5 * trial));
            fixture.world.set_faults(WireFaults {
                hold: ms(stall),
                ..WireFaults::default()
            });
            fixture
                .command(fixture::raw(odd, fixture::every(24, 40)))
                .unwrap();
            fixture.run(ms(2_000));
            assert_telemetry_is_true(&fixture, stall);
        }
    }
}
