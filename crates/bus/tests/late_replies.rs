//! Replies that come late, or after losses: none is read in the layout of another request.

use crate::fixture;
use crate::fixture::{Fixture, ID, degrees, ms, rpm};
use motorlink_bus::{Bus, BusSettings, Command, Event, LineEventKind};
use motorlink_protocol::{Detail, Frame, Mode};
use motorlink_simulator::{WireFaults, WorldConfig};

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
        fixture.assert_telemetry_is_true(trial);
    }
    assert!(
        fixture.status(ID).counters.late > 0,
        "{:?} {:?}",
        fixture.status(ID).counters,
        fixture.bus.line_status(fixture.now).unaddressed
    );
}

/// The adapter holds the reply to the last drive frame while the port is closed and opened again.
#[test]
fn the_reply_to_a_request_from_before_the_port_was_opened_is_not_read_in_another_layout() {
    for closed in (2..120).step_by(3) {
        for (hold, watches_first, asks_for_id) in [
            (ms(40), true, true),
            (ms(120), true, true),
            (ms(120), true, false),
            (ms(120), false, false),
        ] {
            let mut fixture = Fixture::one_motor();
            fixture.drive(rpm(60)).unwrap();
            fixture.run(ms(300));
            fixture.world.set_faults(WireFaults {
                hold,
                ..WireFaults::default()
            });
            fixture.run(ms(25));
            fixture.forget_the_past();
            fixture.sleep(ms(closed));
            let (now, settings) = (fixture.now, BusSettings::default());
            let motors = watches_first.then_some(ID);
            fixture.bus = Bus::new(now)
                .prepared(now, settings, asks_for_id, motors)
                .after_another(now);
            fixture.command(Command::Watch(ID)).unwrap();
            fixture.run(ms(600));
            fixture.assert_telemetry_is_true(closed);
        }
    }
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
            fixture.assert_telemetry_is_true(trial);
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
        fixture.assert_telemetry_is_true(stall);
        assert!(fixture.status(ID).temperature.is_some());
    }
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
            fixture.assert_telemetry_is_true(stall);
        }
    }
}
