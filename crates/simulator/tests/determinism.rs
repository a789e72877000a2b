//! One seed, one course of events, however often one looks.

use crate::fixture::{id, ms, speed, us};
use motorlink_protocol::{Instant, Mode, MotorId, Request};
use motorlink_simulator::{
    Beside, Chunk, Echo, MotorConfig, Split, WireFaults, WireFrame, World, WorldConfig,
};
use proptest::prelude::*;

/// Everything that can be told apart of a course of events.
#[derive(Debug, PartialEq)]
struct Course {
    chunks: Vec<Chunk>,
    traffic: Vec<WireFrame>,
    ends: Vec<(MotorId, [u32; 3])>,
}

fn bad_world(seed: u64) -> World {
    World::new(WorldConfig {
        seed,
        motors: vec![
            MotorConfig::new(id(1)),
            MotorConfig {
                load_nm: 0.3,
                ..MotorConfig::new(id(2))
            },
        ],
        faults: WireFaults {
            echo: Echo::Parts,
            lose_request: 0.05,
            lose_reply: 0.05,
            corrupt_request: 0.05,
            corrupt_reply: 0.05,
            corrupt_reply_per_rpm: 0.001,
            stray: 0.05,
            mix_answers: 0.5,
            split: Some(Split::default()),
            hold: us(700),
            stranger: Some(id(7)),
            beside: Some(Beside::After(0xFF)),
            block: 3,
            floating: true,
        },
        ..WorldConfig::default()
    })
}

/// What the host sends in its `count`th turn: all kinds, some over each other.
fn request(count: u64) -> Request {
    let motor = id(if count.is_multiple_of(3) { 2 } else { 1 });
    match count % 11 {
        5 => Request::IdQuery,
        7 => Request::Query { id: motor },
        9 if count > 200 => Request::SwitchMode {
            id: motor,
            mode: Mode::Current,
        },
        _ => Request::drive(
            motor,
            speed(if count.is_multiple_of(2) { 120 } else { -60 }),
        ),
    }
}

/// Plays 400 requests, 1.9 ms apart, and looks in between at these distances, over and over.
fn play(seed: u64, look_every_us: &[u64]) -> Course {
    let mut world = bad_world(seed);
    let start = Instant::from_millis(5);
    world.advance(start);
    let (mut chunks, mut traffic) = (Vec::new(), Vec::new());
    let end = start + ms(1000);
    let mut looks = look_every_us.iter().cycle();
    let mut look = start;
    for count in 0..400 {
        let sent_at = start + us(count * 1900);
        while look < sent_at {
            chunks.extend(std::iter::from_fn(|| world.receive(look)));
            traffic.extend(world.drain_wire_frames());
            look = look + us(*looks.next().unwrap());
        }
        world.transmit(sent_at, request(count).frame().bytes());
    }
    chunks.extend(std::iter::from_fn(|| world.receive(end)));
    traffic.extend(world.drain_wire_frames());
    let ends = world
        .motors()
        .map(|motor| {
            let values = [motor.speed_rpm(), motor.angle_deg(), motor.temperature_c()];
            (motor.id(), values.map(f32::to_bits))
        })
        .collect();
    Course {
        chunks,
        traffic,
        ends,
    }
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_seed_others() {
    let course = play(1, &[500]);
    assert!(course.chunks.len() > 100 && course.traffic.len() > 400);
    assert_eq!(course, play(1, &[500]));
    assert_ne!(course, play(2, &[500]));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn looking_more_or_less_often_changes_nothing(
        seed in any::<u64>(),
        looks in prop::collection::vec(1_u64..40_000, 1..8),
    ) {
        prop_assert_eq!(play(seed, &[1_000_000]), play(seed, &looks));
    }
}
