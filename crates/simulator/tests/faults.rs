//! What adapters and cables do to bytes, one fault at a time.

use std::time::Duration;

use crate::fixture::{Fixture, ONE, ms, speed, us};
use motorlink_protocol::{Frame, Layout, Reply, Request};
use motorlink_simulator::{
    Chunk, Echo, LineCondition, Split, VirtualMotor, WireFaults, WorldConfig,
};

const QUERY: Request = Request::Query { id: ONE };

fn with(faults: WireFaults) -> Fixture {
    Fixture::new(WorldConfig {
        faults,
        ..WorldConfig::default()
    })
}

/// All chunks of one exchange, with their times since its start.
fn chunks(fixture: &mut Fixture) -> Vec<(Duration, Vec<u8>)> {
    let start = fixture.now;
    fixture.world.transmit(start, QUERY.frame().bytes());
    fixture.now = fixture.now + ms(40);
    std::iter::from_fn(|| fixture.world.receive(start + ms(40)))
        .map(|Chunk { at, bytes }| (at.since(start), bytes))
        .collect()
}

fn is_reply(bytes: &[u8]) -> bool {
    <[u8; 10]>::try_from(bytes)
        .is_ok_and(|bytes| Reply::decode(&Frame::new(bytes), Some(Layout::Query)).is_ok())
}

#[test]
fn an_echo_comes_whole_in_front_of_the_reply() {
    let mut fixture = with(WireFaults {
        echo: Echo::Whole,
        ..WireFaults::default()
    });
    let received = chunks(&mut fixture);
    assert_eq!(received.len(), 2);
    assert_eq!(received[0], (us(868), QUERY.frame().bytes().to_vec()));
    assert!(is_reply(&received[1].1));
}

/// motor.md: a cut echo in front of a reply shifts the frame.
#[test]
fn a_cut_echo_shifts_the_reply() {
    let mut fixture = with(WireFaults {
        echo: Echo::Cut(3),
        ..WireFaults::default()
    });
    let received = fixture.send(QUERY.frame());
    assert_eq!(received.len(), 13);
    assert_eq!(received[..3], QUERY.frame().bytes()[..3]);
    assert!(!is_reply(&received[..10]));
    assert!(is_reply(&received[3..]));
    // Every frame again, not only the first.
    assert_eq!(fixture.send(QUERY.frame()).len(), 13);
}

#[test]
fn lost_replies_are_lost_to_the_host_alone() {
    let mut fixture = with(WireFaults {
        lose_reply: 0.25,
        ..WireFaults::default()
    });
    let received = (0..400)
        .filter(|_| !fixture.send(QUERY.frame()).is_empty())
        .count();
    assert!((270..330).contains(&received), "{received} of 400");
    assert_eq!(
        fixture.world.drain_wire_frames().count(),
        800,
        "all were on the wire"
    );
}

#[test]
fn lost_requests_do_not_drive() {
    let mut fixture = with(WireFaults {
        lose_request: 1.0,
        ..WireFaults::default()
    });
    fixture.drive_for(speed(100), ms(500));
    assert!(!fixture.motor().is_driven());
    assert_eq!(fixture.motor().speed_rpm().to_bits(), 0);
}

#[test]
fn a_corrupt_reply_has_one_bit_wrong() {
    let mut good = with(WireFaults::default());
    let mut bad = with(WireFaults {
        corrupt_reply: 1.0,
        ..WireFaults::default()
    });
    for _ in 0..100 {
        let (good, bad) = (good.send(QUERY.frame()), bad.send(QUERY.frame()));
        let wrong: u32 = good
            .iter()
            .zip(&bad)
            .map(|(good, bad)| (good ^ bad).count_ones())
            .sum();
        assert_eq!((wrong, bad.len()), (1, 10));
        assert!(!is_reply(&bad), "a CRC finds every single bit");
    }
}

#[test]
fn a_corrupt_request_is_not_answered() {
    let mut fixture = with(WireFaults {
        corrupt_request: 1.0,
        ..WireFaults::default()
    });
    for _ in 0..100 {
        assert_eq!(fixture.send(QUERY.frame()), []);
    }
}

#[test]
fn stray_bytes_come_before_or_after_a_reply() {
    let mut fixture = with(WireFaults {
        stray: 1.0,
        ..WireFaults::default()
    });
    let (mut before, mut after) = (0, 0);
    for _ in 0..100 {
        let received = fixture.send(QUERY.frame());
        assert!((11..=13).contains(&received.len()), "{received:?}");
        before += usize::from(is_reply(&received[received.len() - 10..]));
        after += usize::from(is_reply(&received[..10]));
    }
    assert!(before > 25 && after > 25, "{before} {after}");
}

#[test]
fn a_split_reply_comes_in_pieces_that_make_the_whole() {
    let mut fixture = with(WireFaults {
        split: Some(Split::default()),
        ..WireFaults::default()
    });
    let mut pieces_seen = [0; 4];
    for _ in 0..100 {
        let received = chunks(&mut fixture);
        pieces_seen[received.len()] += 1;
        assert_eq!(received[0].0, us(2336));
        assert!(received.is_sorted_by_key(|(at, _)| *at));
        assert!(received.last().unwrap().0 <= us(2336 + 2000));
        assert!(is_reply(&received.concat_bytes()));
    }
    assert_eq!(pieces_seen[0] + pieces_seen[1], 0);
    assert!(pieces_seen[2] > 5 && pieces_seen[3] > 50, "{pieces_seen:?}");
}

trait ConcatBytes {
    fn concat_bytes(&self) -> Vec<u8>;
}

impl ConcatBytes for Vec<(Duration, Vec<u8>)> {
    fn concat_bytes(&self) -> Vec<u8> {
        self.iter().flat_map(|(_, bytes)| bytes.clone()).collect()
    }
}

/// motor.md: FTDI chips hold received bytes for up to 16 ms.
#[test]
fn a_held_reply_comes_late() {
    let mut fixture = with(WireFaults {
        hold: ms(16),
        ..WireFaults::default()
    });
    let received = chunks(&mut fixture);
    assert_eq!(received.len(), 1);
    assert_eq!(received[0].0, us(2336) + ms(16));
    assert!(is_reply(&received[0].1));
}

#[test]
fn a_holding_adapter_delivers_echo_and_reply_together() {
    let mut fixture = with(WireFaults {
        echo: Echo::Whole,
        hold: ms(16),
        ..WireFaults::default()
    });
    let received = chunks(&mut fixture);
    assert_eq!(received.len(), 1);
    assert_eq!(
        received[0].0,
        us(868) + ms(16),
        "the timer runs from the first byte"
    );
    assert_eq!(received[0].1.len(), 20);
}

#[test]
fn a_holding_adapter_delivers_a_full_packet_at_once() {
    let mut fixture = with(WireFaults {
        echo: Echo::Whole,
        hold: ms(16),
        ..WireFaults::default()
    });
    let start = fixture.now;
    for millis in [0, 4, 8, 12] {
        fixture
            .world
            .transmit(start + ms(millis), QUERY.frame().bytes());
    }
    let chunk = fixture.world.receive(start + ms(40)).expect("a packet");
    assert!(chunk.bytes.len() >= 62, "{}", chunk.bytes.len());
    assert!(chunk.at < start + ms(16));
}

#[test]
fn faults_can_be_changed_while_it_runs() {
    let mut fixture = with(WireFaults::default());
    assert!(fixture.ask(QUERY).is_some());
    fixture.world.set_faults(WireFaults {
        lose_reply: 1.0,
        ..WireFaults::default()
    });
    assert!(fixture.ask(QUERY).is_none());
    fixture.world.set_faults(WireFaults::default());
    assert!(fixture.ask(QUERY).is_some());
}

#[test]
fn noise_grows_with_the_speed_of_the_wheel() {
    let mut fixture = with(WireFaults {
        corrupt_reply_per_rpm: 0.002,
        ..WireFaults::default()
    });
    let good = |fixture: &mut Fixture| {
        (0..200)
            .filter(|_| fixture.drive(speed(0)).is_some())
            .count()
    };
    assert_eq!(good(&mut fixture), 200, "at rest");
    fixture.drive_for(speed(100), ms(1_000));
    let good = (0..400)
        .filter(|_| fixture.drive(speed(100)).is_some())
        .count();
    assert!((280..360).contains(&good), "{good} of 400 at 100 rpm");
}

#[test]
fn a_stranger_is_heard_behind_every_reply() {
    let mut fixture = with(LineCondition::Stranger.faults());
    let received = chunks(&mut fixture);
    assert_eq!(received.len(), 2);
    assert_eq!(received[1].0, us(2336 + 868));
    assert!(is_reply(&received[0].1) && is_reply(&received[1].1));
    assert_eq!((received[0].1[0], received[1].1[0]), (1, 7));
}

#[test]
fn two_motors_that_share_an_id_are_garbage_and_one_alone_is_heard_again() {
    let mut fixture = with(WireFaults::default());
    fixture
        .world
        .set_line_condition(fixture.now, LineCondition::SharedId);
    assert_eq!(fixture.world.motors().count(), 2);
    for _ in 0..100 {
        let received = fixture.send(QUERY.frame());
        assert!(!received.is_empty() && !is_reply(&received));
    }
    // Chosen twice, there are two and not three.
    fixture
        .world
        .set_line_condition(fixture.now, LineCondition::SharedId);
    assert_eq!(fixture.world.motors().count(), 2);
    fixture
        .world
        .set_line_condition(fixture.now, LineCondition::Good);
    assert_eq!(fixture.world.motors().count(), 1);
    assert!(fixture.ask(QUERY).is_some());
}

/// A motor that is plugged in while a frame passes has not heard how it began.
#[test]
fn a_motor_does_not_obey_a_frame_that_was_on_the_wire_before_it() {
    let mut fixture = with(WireFaults::default());
    let drive = Request::drive(ONE, speed(100)).frame();
    fixture.world.transmit(fixture.now, drive.bytes());
    fixture
        .world
        .set_line_condition(fixture.now + us(400), LineCondition::SharedId);
    fixture.wait(ms(10));
    let driven: Vec<_> = fixture
        .world
        .motors()
        .map(VirtualMotor::is_driven)
        .collect();
    assert_eq!(driven, [true, false]);
}

#[test]
fn no_case_of_a_line_drives_anything() {
    let mut fixture = with(WireFaults::default());
    for case in LineCondition::ALL.iter().copied() {
        fixture.world.set_line_condition(fixture.now, case);
        for _ in 0..20 {
            fixture.send(QUERY.frame());
        }
        for motor in fixture.world.motors() {
            assert!(!motor.is_driven(), "{case:?}");
            assert_eq!(motor.speed_rpm().to_bits(), 0, "{case:?}");
        }
    }
}

#[test]
fn answers_that_collide_become_a_good_frame_only_where_they_are_said_to() {
    for mix_answers in [0.0, 1.0] {
        let mut fixture = Fixture::with_ids(&[1, 2, 3]);
        fixture.world.set_faults(WireFaults {
            mix_answers,
            ..WireFaults::default()
        });
        let received = fixture.send(Request::IdQuery.frame());
        let frame = Frame::new(received.try_into().unwrap());
        let is_good = Reply::decode(&frame, Some(Layout::Drive)).is_ok();
        assert_eq!(is_good, mix_answers > 0.0, "{frame}");
        // One alone is as it was.
        assert!(fixture.ask(QUERY).is_some());
    }
}
