//! The events for the packet log are the frames on the wire.

use crate::fixture::{Fixture, ID, ms, rpm};
use motorlink_bus::{Command, Consent, Event, LineEvent, LineEventKind, RawInterval, Repeat};
use motorlink_protocol::{Drive, Frame, Layout, Mode, Request, explain_received, explain_sent};
use motorlink_simulator::{Echo, Sender, Split, WireFaults, WorldConfig};

fn log(fixture: &Fixture) -> Vec<LineEvent> {
    let traffic = fixture.events.iter().filter_map(|(_, event)| match event {
        Event::Line(traffic) => Some(*traffic),
        _ => None,
    });
    traffic.collect()
}

/// Frames of both sides in the order in which they were on the wire.
fn on_the_wire(fixture: &mut Fixture) -> Vec<(bool, Vec<u8>)> {
    let traffic = fixture.world.drain_wire_frames();
    traffic
        .map(|passed| (passed.from == Sender::Host, passed.frame.bytes().to_vec()))
        .collect()
}

/// Drives, switches, scans and stops a motor.
fn busy_day(fixture: &mut Fixture) {
    fixture.command(Command::Watch(ID)).unwrap();
    fixture.run(ms(300));
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_000));
    fixture.command(Command::FullScan).unwrap();
    fixture.run(ms(4_000));
    fixture.switch(Mode::Current);
    fixture.run(ms(300));
}

#[test]
fn every_frame_is_logged_once_and_in_order() {
    for echo in [Echo::Off, Echo::Whole, Echo::Cut(4)] {
        let mut fixture = Fixture::new(WorldConfig {
            faults: WireFaults {
                echo,
                split: Some(Split::default()),
                ..WireFaults::default()
            },
            ..WorldConfig::default()
        });
        on_the_wire(&mut fixture);
        busy_day(&mut fixture);
        // Until no exchange is under way.
        fixture.run_until(ms(200), |fixture| fixture.world.next_event().is_none());
        let logged: Vec<(bool, Vec<u8>)> = log(&fixture)
            .iter()
            .filter_map(|traffic| match traffic.kind {
                LineEventKind::Sent { frame, .. }
                | LineEventKind::SentByHand { frame, .. }
                | LineEventKind::RepeatedByHand { frame, .. } => {
                    Some((true, frame.bytes().to_vec()))
                }
                LineEventKind::Received { frame, .. } => Some((false, frame.bytes().to_vec())),
                LineEventKind::Junk(junk) => Some((false, junk.bytes().to_vec())),
                _ => None,
            })
            .collect();
        assert!(logged.len() > 500, "{}", logged.len());
        let wire = on_the_wire(&mut fixture);
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
    let mut fixture = Fixture::new(WorldConfig::default());
    busy_day(&mut fixture);
    let times: Vec<_> = log(&fixture).iter().map(|traffic| traffic.at).collect();
    assert!(times.is_sorted());
}

#[test]
fn frames_are_logged_with_what_gives_them_meaning() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_000));
    let words: Vec<String> = log(&fixture)
        .iter()
        .filter_map(|traffic| match traffic.kind {
            LineEventKind::Sent { frame, mode } => Some(explain_sent(&frame, mode).to_string()),
            LineEventKind::Received { frame, asked } => {
                assert!(asked.is_some());
                Some(explain_received(&frame, asked).to_string())
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
    let mut fixture = Fixture::one_motor();
    fixture.world.set_faults(WireFaults {
        corrupt_reply: 1.0,
        ..WireFaults::default()
    });
    fixture.run(ms(500));
    let junk: Vec<Frame> = log(&fixture)
        .iter()
        .filter_map(|traffic| match traffic.kind {
            LineEventKind::Junk(junk) => Some(Frame::new(junk.bytes().try_into().unwrap())),
            LineEventKind::Received { frame, .. } => panic!("{frame} was spoilt"),
            _ => None,
        })
        .collect();
    assert!(junk.len() >= 4);
    let said = explain_received(&junk[0], Some(Layout::Query)).to_string();
    assert!(said.starts_with("CRC"), "{said}");

    fixture.world.set_faults(WireFaults {
        lose_reply: 1.0,
        ..WireFaults::default()
    });
    fixture.forget_the_past();
    fixture.run(ms(500));
    let silences = log(&fixture);
    let silences = silences.iter().filter(|traffic| {
        matches!(traffic.kind, LineEventKind::Silence { id, waited_us } if id == ID && waited_us >= 6_000)
    });
    assert!(silences.count() >= 4);
}

#[test]
fn a_frame_that_the_adapter_did_not_take_is_logged_as_not_sent_and_its_setpoint_is_withdrawn() {
    let mut fixture = Fixture::new(WorldConfig::default());
    fixture.command(Command::Watch(ID)).unwrap();
    fixture.run(ms(300));
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_000));
    fixture.adapter_is_busy = true;
    fixture.run_until(ms(200), |fixture| fixture.world.next_event().is_none());
    on_the_wire(&mut fixture);
    fixture.forget_the_past();
    fixture.run(ms(400));
    assert_eq!(on_the_wire(&mut fixture), []);
    let logged = log(&fixture);
    let is_sent = |traffic: &&LineEvent| matches!(traffic.kind, LineEventKind::Sent { .. });
    assert_eq!(logged.iter().find(is_sent), None);
    let unsent = logged
        .iter()
        .filter(|traffic| matches!(traffic.kind, LineEventKind::NotSent { .. }));
    assert!(unsent.count() >= 10);
    assert!(fixture.happened(|event| matches!(event, Event::Withdrawn { id: ID, .. })));

    fixture.adapter_is_busy = false;
    fixture.run(ms(2_000));
    let drives = fixture.sent.iter().filter_map(|sent| sent.drive_of(ID));
    let of_zero = |drive: &Drive| drive.value == [0, 0];
    assert!(drives.clone().count() > 0 && drives.clone().all(|drive| of_zero(&drive)));
}

#[test]
fn a_raw_frame_is_distinguished_from_the_same_bytes_of_the_bus_and_from_its_repetitions() {
    let mut fixture = Fixture::one_motor();
    let interval = RawInterval::new(20).unwrap();
    for _ in 0..2 {
        fixture
            .command(Command::SendRaw {
                frame: Request::Query { id: ID }.frame(),
                repeat: Repeat::Times { count: 3, interval },
                consent: Consent::None,
            })
            .unwrap();
        fixture.run(ms(200));
    }
    let by_hand: Vec<bool> = log(&fixture)
        .iter()
        .filter_map(|traffic| match traffic.kind {
            LineEventKind::SentByHand { .. } => Some(true),
            LineEventKind::RepeatedByHand { .. } => Some(false),
            _ => None,
        })
        .collect();
    assert_eq!(by_hand, [true, false, false, true, false, false]);
    let polled = |traffic: &LineEvent| matches!(traffic.kind, LineEventKind::Sent { .. });
    assert!(log(&fixture).iter().any(polled));
}
