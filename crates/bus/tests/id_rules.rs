//! Setting an ID: the ways round its rules.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::panic,
    reason = "a test that cannot go on fails"
)]

mod bench;

use bench::{Bench, ID, drive_frame, every, id, is_set_id, ms, raw, rpm, scan_report, status, to};
use motorlink_bus::{
    Command, Event, IdChangeOutcome, Passed, Repeat, SetIdFrames, StopReason, Traffic,
};
use motorlink_protocol::Request;
use motorlink_simulator::{MotorConfig, WireFaults, WorldConfig};

#[test]
fn a_raw_set_id_does_not_outlive_its_proof() {
    let mut bench = Bench::new(WorldConfig::default());
    assert_eq!(scan_report(&mut bench).found, [ID]);
    bench
        .command(raw(Request::SetId { id: to(5) }.frame(), every(0, 2)))
        .unwrap();
    bench.run(ms(120_000));
    bench.world.add_motor(MotorConfig::new(id(7)));
    bench.run(ms(2_000));
    let ids: Vec<_> = bench.world.motors().map(|m| m.id().get()).collect();
    assert!(ids.contains(&7), "{ids:?}");
}

/// A minute after the command at the latest, however many frames were asked for, however far apart.
#[test]
fn raw_set_id_frames_end_with_their_proof() {
    let mut bench = Bench::new(WorldConfig::default());
    assert_eq!(scan_report(&mut bench).found, [ID]);
    let began = bench.now;
    let frame = Request::SetId { id: to(5) }.frame();
    bench.command(raw(frame, every(0, 9_000))).unwrap();
    bench.run(ms(300_000));
    let times: Vec<_> = bench.sent.iter().filter(|sent| is_set_id(sent)).collect();
    assert_eq!(times.len(), 7);
    assert!(times.iter().all(|sent| sent.at.since(began) <= ms(60_000)));
    assert!(!status(&bench).running);
}

#[test]
fn a_raw_set_id_asks_once_more_as_the_other_does() {
    let mut bench = Bench::new(WorldConfig::default());
    assert_eq!(scan_report(&mut bench).found, [ID]);
    bench.world.add_motor(MotorConfig::new(id(7)));
    bench.run(ms(20_000));
    bench
        .command(raw(Request::SetId { id: to(5) }.frame(), every(5, 5)))
        .unwrap();
    bench.run(ms(2_000));
    let ids: Vec<_> = bench.world.motors().map(|m| m.id().get()).collect();
    assert!(ids.contains(&7), "{ids:?}");
}

#[test]
fn stop_of_a_motor_ends_raw_set_id() {
    let mut bench = Bench::new(WorldConfig::default());
    assert_eq!(scan_report(&mut bench).found, [ID]);
    bench
        .command(raw(Request::SetId { id: to(5) }.frame(), every(0, 100)))
        .unwrap();
    bench.run(ms(150));
    bench.command(Command::Stop(ID)).unwrap();
    assert!(!status(&bench).running, "{:?}", status(&bench));
}

#[test]
fn five_raw_set_id_frames_are_five_in_a_row() {
    let mut took = 0;
    for phase in 0..20 {
        let mut bench = Bench::new(WorldConfig::default());
        scan_report(&mut bench);
        bench.run(ms(200 + phase * 5));
        bench
            .command(raw(Request::SetId { id: to(5) }.frame(), every(5, 20)))
            .unwrap();
        bench.run(ms(500));
        took += u32::from(bench.world.motor(id(5)).is_some());
    }
    assert_eq!(took, 20, "{took} of 20");
}

#[test]
fn an_old_id_that_is_not_silent_is_not_changed() {
    let mut bench = Bench::new(WorldConfig::default());
    scan_report(&mut bench);
    bench
        .command(Command::SetId {
            from: ID,
            to: to(5),
            frames: SetIdFrames::Five,
        })
        .unwrap();
    bench.run_until(ms(5000), |bench| {
        bench
            .sent
            .iter()
            .any(|s| s.request() == Request::Query { id: id(5) })
    });
    bench.run(ms(10));
    bench.world.add_motor(MotorConfig::new(ID));
    bench.world.set_faults(WireFaults {
        corrupt_reply: 1.0,
        ..WireFaults::default()
    });
    bench.run_until(ms(5000), |bench| {
        bench.happened(|e| matches!(e, Event::IdChangeEnded { .. }))
    });
    let o = bench.events.iter().find_map(|(_, e)| match e {
        Event::IdChangeEnded { outcome, .. } => Some(*outcome),
        _ => None,
    });
    let junk = bench
        .events
        .iter()
        .filter(|(_, e)| {
            matches!(
                e,
                Event::Traffic(Traffic {
                    passed: Passed::Junk(_),
                    ..
                })
            )
        })
        .count();
    assert_ne!(
        o,
        Some(IdChangeOutcome::Changed),
        "with {junk} junk windows at the old ID"
    );
}

#[test]
fn an_id_is_not_set_on_a_turning_wheel() {
    let mut bench = Bench::new(WorldConfig::default());
    scan_report(&mut bench);
    bench
        .command(raw(drive_frame(ID, rpm(100)), every(50, 20)))
        .unwrap();
    bench.run(ms(1_050));
    bench.forget_the_past();
    bench
        .command(Command::SetId {
            from: ID,
            to: to(5),
            frames: SetIdFrames::Five,
        })
        .unwrap();
    bench.run_until(ms(5000), |bench| bench.sent.iter().any(is_set_id));
    assert!(bench.true_rpm().abs() < 1.0, "{} rpm", bench.true_rpm());
}

#[test]
fn silence_in_an_id_change_is_logged() {
    let mut bench = Bench::new(WorldConfig::default());
    scan_report(&mut bench);
    bench
        .command(Command::SetId {
            from: ID,
            to: to(5),
            frames: SetIdFrames::Five,
        })
        .unwrap();
    bench.run(ms(3000));
    assert!(bench.happened(|e| matches!(
        e,
        Event::Traffic(Traffic {
            passed: Passed::Silence { .. },
            ..
        })
    )));
}

#[test]
fn a_check_that_heard_a_quarrel_does_not_go_on() {
    let mut bench = Bench::new(WorldConfig::default());
    scan_report(&mut bench);
    bench.world.add_motor(MotorConfig {
        angle_deg: 77.0,
        ..MotorConfig::new(id(7))
    });
    let to = to(5);
    bench
        .command(Command::SetId {
            from: ID,
            to,
            frames: SetIdFrames::Five,
        })
        .unwrap();
    bench.run(ms(50));
    // It has quarrelled once, and would be missed from now on.
    bench.world.motor_mut(id(7)).unwrap().mute(true);
    bench.run(ms(5_000));
    assert!(!bench.sent.iter().any(is_set_id));
    let outcome = IdChangeOutcome::NotAlone;
    assert!(bench.happened(|event| *event
        == Event::IdChangeEnded {
            from: ID,
            to,
            outcome
        }));
}

#[test]
fn an_id_is_not_set_while_stopped() {
    let mut bench = Bench::new(WorldConfig::default());
    scan_report(&mut bench);
    bench
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    bench.run(ms(500));
    let a = bench.command(raw(Request::SetId { id: to(5) }.frame(), Repeat::Once));
    let c = bench.command(Command::SetId {
        from: ID,
        to: to(5),
        frames: SetIdFrames::Five,
    });
    assert_eq!(a, c);
}

#[test]
fn an_id_change_that_ends_with_its_port_is_told_as_cancelled() {
    let mut bench = Bench::new(WorldConfig::default());
    scan_report(&mut bench);
    bench
        .command(Command::SetId {
            from: ID,
            to: to(5),
            frames: SetIdFrames::Five,
        })
        .unwrap();
    bench.run_until(ms(1_000), |bench| {
        bench.sent.iter().filter(|sent| is_set_id(sent)).count() == 3
    });
    let told: Vec<Event> = bench.bus.close(bench.now).collect();
    let cancelled = |event: &Event| {
        matches!(
            event,
            Event::IdChangeEnded {
                outcome: IdChangeOutcome::Cancelled { frames_sent: 3 },
                ..
            }
        )
    };
    assert!(told.iter().any(cancelled), "{told:?}");
}
