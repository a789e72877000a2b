//! A line that fails: echoes, junk, losses, silence, power cuts, protections.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test fails by panicking, in its helpers too"
)]

mod bench;

use bench::{Bench, ID, amps, degrees, id, ms, rpm};
use motorlink_bus::{Activity, Command, Event, Limits, Refusal, WithdrawReason};
use motorlink_protocol::{Detail, Fault, Frame, Instant, Mode, Request};
use motorlink_simulator::{Echo, Split, WireFaults, WorldConfig};

fn on_a_wire_with(faults: WireFaults, seed: u64) -> Bench {
    let config = WorldConfig {
        seed,
        faults,
        ..WorldConfig::default()
    };
    Bench::watching(config, &[ID])
}

/// Every reply that was read says what was true of the motor: no layout is ever read as the other.
fn assert_telemetry_is_true(bench: &Bench, seed: u64) {
    for (at, event) in &bench.events {
        let Event::Telemetry(sample) = event else {
            continue;
        };
        assert_eq!(sample.reply.id, ID, "seed {seed} at {at:?}");
        if let Detail::Query { temperature, .. } = sample.reply.detail {
            let true_c = bench.world.motor(ID).unwrap().temperature_c();
            let read = f32::from(temperature.degrees());
            assert!(
                (read - true_c).abs() <= 3.0,
                "seed {seed} at {at:?}: {read} for {true_c}"
            );
        }
    }
}

#[test]
fn echoes_whole_and_cut_are_told_from_replies() {
    for echo in [Echo::Whole].into_iter().chain((1..10).map(Echo::Cut)) {
        let mut bench = on_a_wire_with(
            WireFaults {
                echo,
                ..WireFaults::default()
            },
            1,
        );
        bench.drive(rpm(100)).unwrap();
        bench.run(ms(2_000));
        let status = bench.status(ID);
        assert_eq!(status.link.loss_per_mille, Some(0), "{echo:?}");
        let (whole, cut) = (status.counters.echoes_whole, status.counters.echoes_cut);
        assert_eq!(echo == Echo::Whole, whole > 100, "{echo:?}: {whole} whole");
        assert_eq!(echo != Echo::Whole, cut > 100, "{echo:?}: {cut} cut");
        assert_eq!(status.counters.junk_bytes, 0, "{echo:?}");
        assert!((bench.true_rpm() - 100.0).abs() < 3.0);
        assert_telemetry_is_true(&bench, 1);
    }
}

#[test]
fn replies_in_pieces_are_put_together() {
    let mut bench = on_a_wire_with(
        WireFaults {
            split: Some(Split::default()),
            ..WireFaults::default()
        },
        3,
    );
    bench.drive(rpm(100)).unwrap();
    bench.run(ms(3_000));
    assert_eq!(bench.status(ID).link.loss_per_mille, Some(0));
    assert_telemetry_is_true(&bench, 3);
}

#[test]
fn an_adapter_that_holds_bytes_for_16_ms_is_waited_for() {
    let faults = WireFaults {
        hold: ms(16),
        ..WireFaults::default()
    };
    let mut bench = on_a_wire_with(faults, 4);
    bench.drive(rpm(100)).unwrap();
    bench.run(ms(3_000));
    let status = bench.status(ID);
    assert_eq!(status.link.loss_per_mille, Some(0));
    assert!(status.link.round_trip_us.unwrap() > 16_000);
    assert!(
        status
            .temperature
            .is_some_and(|(at, _)| bench.now.since(at) < ms(500))
    );
    assert_telemetry_is_true(&bench, 4);
}

#[test]
fn with_losses_and_flipped_bits_nothing_false_is_read_and_driving_goes_on() {
    for seed in 0..40 {
        let faults = WireFaults {
            lose_reply: 0.15,
            corrupt_reply: 0.15,
            ..WireFaults::default()
        };
        let mut bench = on_a_wire_with(faults, seed);
        if bench.drive(rpm(100)).is_err() {
            continue; // it was not heard lately, and says so
        }
        bench.run(ms(3_000));
        let withdrawn = bench.happened(|e| matches!(e, Event::Withdrawn { .. }));
        // Of 150; three losses in a row widen the window once, which costs a frame.
        let frames = bench.drive_times(ID).len();
        assert!(withdrawn || frames >= 144, "seed {seed}: {frames}");
        let counters = bench.status(ID).counters;
        assert!(counters.silences > 0, "seed {seed}: {counters:?}");
        assert!(counters.bad_crcs > 0, "seed {seed}: {counters:?}");
        assert_telemetry_is_true(&bench, seed);
    }
}

#[test]
fn after_any_junk_the_next_good_reply_but_one_is_read() {
    let mut bench = Bench::one_motor();
    bench.drive(rpm(50)).unwrap();
    bench.run(ms(500));
    for length in 0..300_usize {
        let junk: Vec<u8> = (0..length)
            .map(|n| [0x01, 0x02, 0x64, 0xFF][n * 7 % 4])
            .collect();
        bench.forget_the_past();
        bench.bus.receive(bench.now, &junk);
        bench.run(ms(45)); // two drive frames and perhaps a query
        let heard = bench
            .events
            .iter()
            .filter(|(_, e)| matches!(e, Event::Telemetry(_)))
            .count();
        assert!(heard >= 1, "{length} bytes of junk");
    }
}

#[test]
fn a_good_frame_of_another_motor_is_counted_and_not_taken() {
    let mut bench = Bench::one_motor();
    bench.run(ms(1_000));
    let speed = bench.status(ID).last.unwrap().reply.speed;
    let stranger = Frame::with_crc([9, 2, 0, 0, 0, 99, 30, 0, 0]);
    bench.bus.receive(bench.now, stranger.bytes());
    bench.run(ms(150));
    let counted = bench.bus.line_status(bench.now).unaddressed.wrong_ids
        + bench.status(ID).counters.wrong_ids;
    assert_eq!(counted, 1);
    assert_eq!(bench.status(ID).last.unwrap().reply.speed, speed);
    assert!(bench.bus.motors(bench.now).all(|motor| motor.id == ID));
}

#[test]
fn a_motor_that_falls_silent_loses_its_setpoint_and_is_not_started_again_when_it_is_back() {
    let mut bench = Bench::one_motor();
    bench.drive(rpm(100)).unwrap();
    bench.run(ms(1_000));
    bench.world.motor_mut(ID).unwrap().power(false);
    let cut = bench.now;
    bench.run(ms(6_000));
    let withdrawn = bench
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
    let silent = bench
        .events
        .iter()
        .find(|(_, e)| *e == Event::MotorSilent(ID))
        .unwrap();
    assert!(silent.0.since(cut) >= ms(1_900) && silent.0.since(cut) <= ms(2_100));
    bench.world.motor_mut(ID).unwrap().power(true);
    bench.forget_the_past();
    bench.run(ms(3_000));
    assert!(bench.happened(|e| *e == Event::MotorBack(ID)));
    assert!(bench.drive_times(ID).is_empty());
    assert!(bench.true_rpm().abs() < 1.0);
}

/// A machine that holds the worker up for a while is no silent motor.
#[test]
fn a_bus_that_was_not_run_for_a_while_drives_on() {
    let mut bench = Bench::one_motor();
    bench.drive(rpm(100)).unwrap();
    for held_up in [50, 150, 250, 400] {
        bench.run(ms(500));
        bench.now = bench.now + ms(held_up);
        bench.run(ms(500));
        assert!(
            !bench.happened(|e| matches!(e, Event::Withdrawn { .. })),
            "{held_up} ms"
        );
    }
    assert!((bench.true_rpm() - 100.0).abs() < 3.0);
}

/// A raw current of 1,000 would be read as 330 rpm by a motor that came back in the velocity loop.
#[test]
fn a_current_is_never_sent_to_a_motor_that_came_back_in_the_velocity_loop() {
    for off in [10, 50, 120, 190, 250, 1_000] {
        let mut bench = Bench::one_motor();
        bench.switch(Mode::Current);
        bench.world.motor_mut(ID).unwrap().set_load_nm(0.5);
        bench.drive(amps(0.25)).unwrap();
        bench.run(ms(500));
        bench.world.motor_mut(ID).unwrap().power(false);
        bench.run(ms(off));
        bench.world.motor_mut(ID).unwrap().power(true);
        bench.run(ms(1_000));
        assert!(
            bench.happened(|e| matches!(e, Event::Withdrawn { .. })),
            "off for {off} ms"
        );
        assert!(
            bench.true_rpm().abs() < 1.0,
            "off for {off} ms: {}",
            bench.true_rpm()
        );
        assert_eq!(bench.activity(), Activity::Idle);
    }
}

#[test]
fn a_protection_takes_the_setpoint_and_its_end_does_not_bring_it_back() {
    let mut bench = Bench::one_motor();
    // The limit of half a second would be crossed first.
    let no_limits = Limits::new(330, 8_000, 80).unwrap();
    bench.command(Command::SetLimits(no_limits)).unwrap();
    bench.world.motor_mut(ID).unwrap().block(true);
    bench.drive(rpm(100)).unwrap();
    bench.run_until(ms(7_000), |b| {
        b.happened(|e| matches!(e, Event::Withdrawn { .. }))
    });
    let stalled = bench.events.iter().any(|(_, e)| {
        matches!(e, Event::Withdrawn { reason: WithdrawReason::Fault(faults), .. }
            if faults.contains(Fault::Stall))
    });
    assert!(stalled);
    bench.run(ms(500));
    assert!(matches!(
        bench.drive(rpm(100)),
        Err(Refusal::FaultActive { .. } | Refusal::Stopping(_))
    ));
    bench.world.motor_mut(ID).unwrap().block(false);
    bench.run(ms(10_000));
    assert!(bench.true_rpm().abs() < 1.0);
    assert_eq!(bench.activity(), Activity::Idle);
    assert_eq!(bench.drive(rpm(100)), Ok(()));
}

/// A drive reply that comes when a query is in flight would be read as 60 degrees of heat.
#[test]
fn a_late_reply_is_not_read_in_the_layout_of_the_next_request() {
    let mut bench = Bench::one_motor();
    bench.run(ms(500));
    // Fast round trips have made the window short; now one reply takes 20 ms.
    for trial in 0..60 {
        bench.drive(rpm(60)).unwrap();
        bench.run(ms(80 + trial));
        bench.world.set_faults(WireFaults {
            hold: ms(20),
            ..WireFaults::default()
        });
        bench.run(ms(25));
        bench.world.set_faults(WireFaults::default());
        bench.run(ms(40));
        assert_telemetry_is_true(&bench, trial);
    }
    assert!(
        bench.status(ID).counters.late > 0,
        "{:?} {:?}",
        bench.status(ID).counters,
        bench.bus.line_status(bench.now).unaddressed
    );
}

/// Of a query and a drive frame that were both lost, either may still be answered.
#[test]
fn after_two_losses_in_a_row_no_layout_is_read_as_the_other() {
    for trial in 0..120_u64 {
        for stall in [28, 36, 45, 70, 110, 160] {
            let mut bench = Bench::one_motor();
            bench.switch(Mode::Position);
            bench.drive(degrees(40.0)).unwrap();
            bench.run(ms(1_200) + std::time::Duration::from_micros(trial * 931));
            bench.forget_the_past();
            bench.world.set_faults(WireFaults {
                hold: ms(stall),
                ..WireFaults::default()
            });
            bench.run(ms(stall));
            bench.world.set_faults(WireFaults::default());
            bench.run(ms(60));
            assert_telemetry_is_true(&bench, trial);
            for (_, event) in &bench.events {
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

/// What an adapter or a machine that is held up hands out long after the window is not read as the answer
/// to what was asked since: a position as a temperature.
#[test]
fn the_answer_to_an_id_query_is_not_read_in_the_layout_of_a_later_query() {
    for stall in [55, 65, 75, 100, 150, 300] {
        let mut bench = Bench::new(WorldConfig::default());
        bench.world.set_faults(WireFaults {
            hold: ms(stall),
            ..WireFaults::default()
        });
        bench.command(Command::IdQuery).unwrap();
        bench.run(ms(5));
        bench.command(Command::Watch(ID)).unwrap();
        bench.run(ms(stall));
        bench.world.set_faults(WireFaults::default());
        bench.run(ms(500));
        assert_telemetry_is_true(&bench, stall);
        assert!(bench.status(ID).temperature.is_some());
    }
}

#[test]
fn windows_are_never_waited_twice_and_frames_never_overlap() {
    let mut bench = Bench::watching(WorldConfig::default(), &[ID, id(9)]);
    bench.drive(rpm(100)).unwrap();
    bench.run(ms(3_000));
    for pair in bench.sent.windows(2) {
        let gap = pair[1].at.since(pair[0].at);
        assert!(
            gap >= std::time::Duration::from_micros(1_868),
            "{gap:?} between {pair:?}"
        );
    }
    // Motor 9 is silent: asked ten times a second at first, once a second when that is known.
    let asked = bench
        .sent
        .iter()
        .filter(|s| s.request() == Request::Query { id: id(9) })
        .count();
    assert!((15..=25).contains(&asked), "{asked}");
    assert!(bench.now > Instant::ZERO);
}
