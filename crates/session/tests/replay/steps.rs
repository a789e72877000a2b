//! Steps, frame by frame.

use motorlink_messages::{Update, sessions::ToReplay};
use motorlink_protocol::family::Model;

use super::{
    driver::{Replay, updates},
    live::{Live, ms, rpm},
};

fn step(replay: &mut Replay<'_>, forward: bool) -> (u64, Update) {
    let messages = replay.ask(ToReplay::Step { forward });
    let (place, update) = updates(&messages).last().unwrap();
    assert!(!place.plays);
    let update = Update {
        samples: Vec::new(),
        ..update.clone()
    };
    (place.after_us, update)
}

#[test]
fn steps_forward_and_back_meet_the_same_frames() {
    for model in [Model::Ddsm115, Model::Ddsm210] {
        let mut live = Live::of(model);
        live.drive(1, rpm(50));
        live.run(ms(3_000));
        let (file, _) = live.end();
        let mut replay = Replay::of(&file);
        replay.play(1_000);
        replay.run(ms(2_000));
        let forward: Vec<_> = (0..30).map(|_| step(&mut replay, true)).collect();
        let places: Vec<u64> = forward.iter().map(|one| one.0).collect();
        assert!(places.is_sorted_by(|a, b| a < b), "{places:?}");
        let mut back: Vec<_> = (0..29).map(|_| step(&mut replay, false)).collect();
        back.reverse();
        assert_eq!(back, forward[..29], "{model}");
        assert_eq!(step(&mut replay, true), forward[1]);
    }
}

#[test]
fn a_step_back_crosses_a_long_gap_and_ends_at_the_first_record() {
    let mut live = Live::of(Model::Ddsm115);
    live.run(ms(300));
    let last_us = live.now.as_micros();
    live.pass_hours(2);
    live.run(ms(100));
    let (file, _) = live.end();
    let mut replay = Replay::of(&file);
    let (first, duration_us) = replay.begun();
    let mut place = duration_us;
    replay.ask(ToReplay::Seek {
        after_us: duration_us,
    });
    let gap_from_us = last_us - first.as_micros();
    while place > gap_from_us {
        place = step(&mut replay, false).0;
    }
    assert!(gap_from_us - place < 200_000, "{place}");
    let mut steps = 0;
    while place > 0 {
        place = step(&mut replay, false).0;
        steps += 1;
    }
    assert!((4..60).contains(&steps), "{steps}");
    // There is nothing before it.
    assert!(replay.ask(ToReplay::Step { forward: false }).is_empty());
}

#[test]
fn a_step_at_the_end_stays_there() {
    let (file, _) = Live::of(Model::Ddsm115).end();
    let mut replay = Replay::of(&file);
    let end = replay.begun().1;
    replay.ask(ToReplay::Seek { after_us: end });
    assert_eq!(step(&mut replay, true).0, end);
}
