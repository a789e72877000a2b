//! Playing by the caller's clock.

use std::time::Duration;

use motorlink_messages::sessions::{FromReplay, PlaySpeed, ToReplay};
use motorlink_protocol::family::Model;

use super::{
    driver::{Replay, updates},
    live::{Live, ms, rpm},
};

/// A motor driven for this many seconds, at 50 Hz.
fn driven_for(secs: u64) -> Vec<u8> {
    let mut live = Live::of(Model::Ddsm115);
    live.drive(1, rpm(50));
    live.run(Duration::from_secs(secs));
    live.end().0
}

#[test]
fn a_replay_plays_at_its_speed_about_thirty_times_a_second() {
    let file = driven_for(150);
    for (per_mille, expected_us) in [
        (100, 100_000),
        (1_000, 1_000_000),
        (4_000, 4_000_000),
        (100_000, 100_000_000),
    ] {
        let mut replay = Replay::of(&file);
        replay.messages.clear();
        replay.play(per_mille);
        replay.run(Duration::from_secs(1));
        let (place, _) = replay.last();
        let within = expected_us * 95 / 100..=expected_us;
        assert!(within.contains(&place.after_us), "{per_mille}: {place:?}");
        assert!(place.plays);
        let number = updates(&replay.messages).count();
        assert!((28..=32).contains(&number), "{per_mille}: {number}");
        let mut places: Vec<u64> = updates(&replay.messages)
            .map(|one| one.0.after_us)
            .collect();
        places.dedup();
        assert!(places.is_sorted() && places.len() >= 28);
    }
}

#[test]
fn every_reply_is_told_once_in_order() {
    let mut live = Live::of(Model::Ddsm210);
    live.drive(1, rpm(50));
    live.run(ms(4_000));
    let (file, all) = live.end_with_samples();
    let mut replay = Replay::of(&file);
    replay.play(700);
    replay.run(Duration::from_secs(9));
    assert!(!replay.last().0.plays);
    let told: Vec<_> = updates(&replay.messages)
        .flat_map(|(_, update)| update.samples.clone())
        .collect();
    assert_eq!(told, all);
}

#[test]
fn a_pause_ends_all_updates_and_the_end_pauses() {
    let file = driven_for(3);
    let mut replay = Replay::of(&file);
    replay.play(1_000);
    replay.run(ms(700));
    replay.ask(ToReplay::Pause);
    let paused = replay.last().0;
    assert!(!paused.plays);
    replay.messages.clear();
    replay.run(Duration::from_secs(5));
    assert_eq!((replay.messages.len(), replay.due), (0, None));
    replay.play(2_000);
    replay.run(Duration::from_secs(5));
    let place = replay.last().0;
    assert!(!place.plays && place.after_us > 3_000_000, "{place:?}");
    // Nothing is left to play.
    let again = replay.ask(ToReplay::Play(PlaySpeed::REAL_TIME));
    let shown: Vec<_> = updates(&again).map(|one| one.0).collect();
    assert_eq!(shown, [place]);
    // From the beginning: the page does not wait for the jump.
    replay.handle(ToReplay::Seek { after_us: 0 });
    replay.play(1_000);
    replay.run(ms(400));
    let place = replay.last().0;
    assert!(
        place.plays && (300_000..400_000).contains(&place.after_us),
        "{place:?}"
    );
}

#[test]
fn slow_reading_slows_the_playing_down() {
    let file = driven_for(100);
    let mut replay = Replay::of(&file);
    replay.play(100_000);
    replay.messages.clear();
    // Every poll takes 20 ms.
    let began = replay.now;
    let mut longest = 0;
    let mut before = replay.last_place();
    while replay.now.since(began) < Duration::from_secs(1) {
        replay.step();
        replay.now = replay.now + ms(20);
        let place = replay.last_place();
        longest = longest.max(place - before);
        before = place;
    }
    assert!(before < 80_000_000, "{before}: it lags behind");
    assert!(
        (1..=5_000_000).contains(&longest),
        "{longest}: no step is longer than 50 ms of the clock"
    );
}

#[test]
fn a_gap_of_hours_is_played_as_a_gap_and_can_be_skipped() {
    let mut live = Live::of(Model::Ddsm115);
    live.drive(1, rpm(50));
    live.run(ms(500));
    live.pass_hours(5);
    live.run(ms(2_500));
    let (file, _) = live.end();
    let mut replay = Replay::of(&file);
    replay.play(100_000);
    replay.run(Duration::from_secs(10));
    let (place, update) = replay.last();
    assert!(
        (900_000_000..1_010_000_000).contains(&place.after_us),
        "{place:?}"
    );
    // The port is closed.
    assert_eq!((update.motors.len(), update.line), (0, None));
    assert!(replay.polls < 3_000, "{}", replay.polls);
    let after_us = replay.begun().1 - 500_000;
    replay.ask(ToReplay::Seek { after_us });
    assert_eq!(replay.last().1.motors.len(), 2);
}

#[test]
fn unreadable_bytes_pause_it() {
    let file = driven_for(30);
    let mut replay = Replay::of(&file);
    replay.play(1_000);
    replay.run(ms(200));
    replay.messages.clear();
    replay.player.unreadable();
    replay.settle();
    assert_eq!(replay.messages.first(), Some(&FromReplay::Unreadable));
    assert!(!replay.last().0.plays);
    // It can be tried again.
    replay.ask(ToReplay::Seek {
        after_us: 5_000_000,
    });
    assert_eq!(replay.last().0.after_us, 5_000_000);
}
