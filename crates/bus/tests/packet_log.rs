//! What the packet log is told is what passed on the wire.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::panic,
    reason = "a test that cannot go on fails"
)]

mod bench;

use bench::{Bench, ID, ms, rpm};
use motorlink_bus::{Command, Event, Passed, Traffic};
use motorlink_protocol::{Drive, Frame, Layout, Mode, explain_heard, explain_sent};
use motorlink_simulator::{Echo, Speaker, Split, WireFaults, WorldConfig};

fn log(bench: &Bench) -> Vec<Traffic> {
    let traffic = bench.events.iter().filter_map(|(_, event)| match event {
        Event::Traffic(traffic) => Some(*traffic),
        _ => None,
    });
    traffic.collect()
}

/// Frames of both sides in the order in which they were on the wire.
fn on_the_wire(bench: &mut Bench) -> Vec<(bool, Vec<u8>)> {
    let traffic = bench.world.drain_traffic();
    traffic
        .map(|passed| (passed.from == Speaker::Host, passed.frame.bytes().to_vec()))
        .collect()
}

/// Drives, switches, scans and stops a motor.
fn busy_day(bench: &mut Bench) {
    bench.command(Command::Watch(ID)).unwrap();
    bench.run(ms(300));
    bench.drive(rpm(100)).unwrap();
    bench.run(ms(1_000));
    bench.command(Command::FullScan).unwrap();
    bench.run(ms(4_000));
    bench.switch(Mode::Current);
    bench.run(ms(300));
}

#[test]
fn every_frame_is_logged_once_and_in_order() {
    for echo in [Echo::Off, Echo::Whole, Echo::Cut(4)] {
        let mut bench = Bench::new(WorldConfig {
            faults: WireFaults {
                echo,
                split: Some(Split::default()),
                ..WireFaults::default()
            },
            ..WorldConfig::default()
        });
        on_the_wire(&mut bench);
        busy_day(&mut bench);
        // Until no exchange is under way.
        bench.run_until(ms(200), |bench| bench.world.next_event().is_none());
        let logged: Vec<(bool, Vec<u8>)> = log(&bench)
            .iter()
            .filter_map(|traffic| match traffic.passed {
                Passed::Sent { frame, .. } => Some((true, frame.bytes().to_vec())),
                Passed::Heard { frame, .. } => Some((false, frame.bytes().to_vec())),
                Passed::Junk(junk) => Some((false, junk.bytes().to_vec())),
                Passed::Silence { .. } | Passed::Unsent { .. } => None,
            })
            .collect();
        assert!(logged.len() > 500, "{}", logged.len());
        let wire = on_the_wire(&mut bench);
        for (place, pair) in logged.iter().zip(&wire).enumerate() {
            assert_eq!(
                pair.0, pair.1,
                "{echo:?}, line {place}, logged and on the wire"
            );
        }
        assert_eq!(logged.len(), wire.len(), "{echo:?}");
    }
}

#[test]
fn the_log_is_in_the_order_of_time() {
    let mut bench = Bench::new(WorldConfig::default());
    busy_day(&mut bench);
    let times: Vec<_> = log(&bench).iter().map(|traffic| traffic.at).collect();
    assert!(times.is_sorted());
}

#[test]
fn frames_are_logged_with_what_gives_them_meaning() {
    let mut bench = Bench::one_motor();
    bench.drive(rpm(100)).unwrap();
    bench.run(ms(1_000));
    let words: Vec<String> = log(&bench)
        .iter()
        .filter_map(|traffic| match traffic.passed {
            Passed::Sent { frame, mode } => Some(explain_sent(&frame, mode).to_string()),
            Passed::Heard { frame, asked } => {
                assert!(asked.is_some());
                Some(explain_heard(&frame, asked).to_string())
            }
            _ => None,
        })
        .collect();
    assert!(words.contains(&"drive +100 rpm".to_owned()), "{words:?}");
    assert!(words.contains(&"feedback query".to_owned()));
    assert!(words.iter().any(|words| words.contains("28 °C")));
}

#[test]
fn spoilt_replies_and_silence_are_logged_as_such() {
    let mut bench = Bench::one_motor();
    bench.world.set_faults(WireFaults {
        corrupt_reply: 1.0,
        ..WireFaults::default()
    });
    bench.run(ms(500));
    let junk: Vec<Frame> = log(&bench)
        .iter()
        .filter_map(|traffic| match traffic.passed {
            Passed::Junk(junk) => Some(Frame::new(junk.bytes().try_into().unwrap())),
            Passed::Heard { frame, .. } => panic!("{frame} was spoilt"),
            _ => None,
        })
        .collect();
    assert!(junk.len() >= 4);
    let said = explain_heard(&junk[0], Some(Layout::Query)).to_string();
    assert!(said.starts_with("CRC"), "{said}");

    bench.world.set_faults(WireFaults {
        lose_reply: 1.0,
        ..WireFaults::default()
    });
    bench.forget_the_past();
    bench.run(ms(500));
    let silences = log(&bench);
    let silences = silences.iter().filter(|traffic| {
        matches!(traffic.passed, Passed::Silence { id, waited_us } if id == ID && waited_us >= 6_000)
    });
    assert!(silences.count() >= 4);
}

#[test]
fn a_frame_that_the_adapter_did_not_take_is_logged_as_not_sent_and_its_setpoint_is_withdrawn() {
    let mut bench = Bench::new(WorldConfig::default());
    bench.command(Command::Watch(ID)).unwrap();
    bench.run(ms(300));
    bench.drive(rpm(100)).unwrap();
    bench.run(ms(1_000));
    bench.adapter_is_busy = true;
    bench.run_until(ms(200), |bench| bench.world.next_event().is_none());
    on_the_wire(&mut bench);
    bench.forget_the_past();
    bench.run(ms(400));
    assert_eq!(on_the_wire(&mut bench), []);
    let logged = log(&bench);
    let is_sent = |traffic: &&Traffic| matches!(traffic.passed, Passed::Sent { .. });
    assert_eq!(logged.iter().find(is_sent), None);
    let unsent = logged
        .iter()
        .filter(|traffic| matches!(traffic.passed, Passed::Unsent { .. }));
    assert!(unsent.count() >= 10);
    assert!(bench.happened(|event| matches!(event, Event::Withdrawn { id: ID, .. })));

    bench.adapter_is_busy = false;
    bench.run(ms(2_000));
    let drives = bench.sent.iter().filter_map(|sent| sent.drive_of(ID));
    let of_zero = |drive: &Drive| drive.value == [0, 0];
    assert!(drives.clone().count() > 0 && drives.clone().all(|drive| of_zero(&drive)));
}
