//! A jump to any place shows what playing to it shows.

use std::time::Duration;

use motorlink_bus::{
    Activity, BusSettings, Command, CommandRate, Counters, RoundTripStatus, Sample, StopReason,
};
use motorlink_messages::{
    Update,
    recorder::PAST_SAMPLES_MAX,
    sessions::{ActivityChange, FromReplay, ToReplay},
};
use motorlink_protocol::{Instant, family::Model};
use motorlink_session::LookBack;
use proptest::prelude::*;

use super::{
    driver::{Replay, updates},
    live::{Live, id, ms, rpm},
    random::session,
};

/// Looks back less than the sessions of these tests are long, as the default does for long ones.
const SHORT: LookBack = LookBack {
    picture: Duration::from_millis(500),
    past: Duration::from_secs(3),
    bytes: 0,
};

fn state(update: &Update) -> Update {
    Update {
        samples: Vec::new(),
        ..update.clone()
    }
}

/// Without what counts for longer than such a replay looks back.
fn present(update: &Update) -> Update {
    let mut update = state(update);
    let now = update.now;
    for motor in &mut update.motors {
        motor.counters = Counters::default();
        motor.link.loss_per_mille = None;
        motor.link.round_trip_us = None;
        let is_recent = |at: Instant| now.since(at) < SHORT.past;
        motor.last = motor.last.filter(|last| is_recent(last.at));
        motor.position = motor.position.filter(|(at, _)| is_recent(*at));
        motor.temperature = motor.temperature.filter(|(at, _)| is_recent(*at));
    }
    if let Some(line) = &mut update.line {
        line.unaddressed = Counters::default();
        line.round_trip = RoundTripStatus::default();
    }
    update
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    #[test]
    fn a_jump_shows_what_playing_shows(
        seed in 1_u64..40,
        model in 0_usize..4,
        speed in 100_u32..100_000,
        stop_after in 10_u64..4_000,
    ) {
        let model = Model::ALL[model];
        let (file, _) = session(model, seed, 8);
        let mut playing = Replay::of(&file);
        playing.play(speed);
        playing.run(Duration::from_millis(stop_after));
        playing.ask(ToReplay::Pause);
        let (place, played) = playing.last();
        // Another replay jumps there, from the end.
        let mut jumping = Replay::of(&file);
        jumping.ask(ToReplay::Seek { after_us: u64::MAX });
        let messages = jumping.ask(ToReplay::Seek { after_us: place.after_us });
        let (jumped_to, jumped) = updates(&messages).last().unwrap();
        prop_assert_eq!(jumped_to, place);
        prop_assert_eq!(state(jumped), state(played));
    }

    #[test]
    fn a_jump_with_a_short_look_back_shows_the_present(
        seed in 1_u64..40,
        model in 0_usize..2,
        per_mille in 0_u64..1_000,
    ) {
        let model = Model::ALL[model];
        let (file, _) = session(model, seed, 14);
        let mut whole = Replay::of(&file);
        let after_us = whole.begun().1 * per_mille / 1_000;
        let mut short = Replay::with(&file, SHORT).unwrap();
        let [whole, short] = [&mut whole, &mut short].map(|replay| {
            let messages = replay.ask(ToReplay::Seek { after_us });
            present(updates(&messages).last().unwrap().1)
        });
        prop_assert_eq!(short, whole);
    }
}

/// Two motors for some seconds, at 230 replies a second.
fn driven_for(time: Duration) -> (Vec<u8>, Vec<Sample>) {
    let mut live = Live::of(Model::Ddsm115);
    let settings = BusSettings {
        rate: CommandRate::new(200).unwrap(),
        ..BusSettings::default()
    };
    live.command(Command::Configure(settings)).unwrap();
    live.drive(1, rpm(50));
    live.run(time);
    live.end_with_samples()
}

#[test]
fn the_graph_gets_the_last_minute_before_a_jump_newest_part_first() {
    let (file, all) = driven_for(Duration::from_secs(75));
    let mut replay = Replay::of(&file);
    let at = replay.begun().0 + Duration::from_secs(70);
    let after_us = 70_000_000;
    let messages = replay.ask(ToReplay::Seek { after_us });
    let is_update = |message: &FromReplay| matches!(message, FromReplay::Update { .. });
    assert_eq!(messages.first(), Some(&FromReplay::Jumped));
    assert!(is_update(&messages[1]), "the picture comes at once");
    let mut shown: Vec<Sample> = updates(&messages).next().unwrap().1.samples.clone();
    let mut parts = 0;
    for message in &messages[2..] {
        match message {
            FromReplay::Past(part) => {
                parts += 1;
                assert!(part.len() <= usize::from(PAST_SAMPLES_MAX));
                assert!(part.last().unwrap().at < shown[0].at);
                shown.splice(0..0, part.iter().copied());
            }
            FromReplay::Update { update, .. } => assert_eq!(update.samples, []),
            FromReplay::PastActivities(_) | FromReplay::Faults(_) => {}
            other => panic!("{other:?}"),
        }
    }
    assert!(parts > 5, "{parts}");
    let minute = at - Duration::from_secs(60)..=at;
    let expected: Vec<Sample> = all
        .into_iter()
        .filter(|one| minute.contains(&one.at))
        .collect();
    assert_eq!(shown, expected);
}

#[test]
fn a_newer_jump_takes_the_place_of_an_older_one_and_the_first_picture_is_not_starved() {
    let (file, _) = driven_for(Duration::from_secs(20));
    let mut replay = Replay::of(&file);
    replay.messages.clear();
    // The page seeks at each move of the pointer, faster than records are read.
    for n in 0..200_u64 {
        replay.handle(ToReplay::Seek {
            after_us: 10_000_000 + n * 40_000,
        });
        replay.step();
    }
    let seen = updates(&replay.messages).count();
    assert!((3..100).contains(&seen), "{seen}");
    replay.settle();
    assert_eq!(replay.last().0.after_us, 10_000_000 + 199 * 40_000);
    // Of the places on the way, no minute was read.
    let last_jump = replay
        .messages
        .iter()
        .rposition(|message| *message == FromReplay::Jumped);
    let past = replay
        .messages
        .iter()
        .position(|message| matches!(message, FromReplay::Past(_)));
    assert!(past > last_jump, "{past:?} {last_jump:?}");
}

#[test]
fn a_jump_while_it_plays_goes_on_playing() {
    let (file, _) = driven_for(Duration::from_secs(20));
    let mut replay = Replay::of(&file);
    replay.play(1_000);
    replay.run(ms(500));
    replay.ask(ToReplay::Seek {
        after_us: 9_000_000,
    });
    assert!(replay.last().0.plays);
    replay.run(ms(1_000));
    let after_us = replay.last().0.after_us;
    assert!((9_900_000..=10_000_000).contains(&after_us), "{after_us}");
    assert_eq!(replay.last().1.motors.len(), 2);
    assert_eq!(replay.last().1.motors[0].id, id(1));
}

#[test]
fn the_place_limits_are_the_first_and_the_last_record() {
    let (file, _) = driven_for(Duration::from_secs(5));
    let mut replay = Replay::of(&file);
    let (first, duration_us) = replay.begun();
    assert_eq!(first, Instant::from_millis(1_000));
    assert_eq!(replay.last().0.after_us, 0);
    replay.ask(ToReplay::Seek { after_us: u64::MAX });
    assert_eq!(replay.last().0.after_us, duration_us);
    replay.ask(ToReplay::Seek { after_us: 0 });
    assert_eq!((replay.last().0.after_us, replay.last().1.now), (0, first));
}

/// The graph draws targets, and aligns runs by them.
#[test]
fn a_jump_tells_what_the_motors_did_before_it() {
    let mut live = Live::of(Model::Ddsm115);
    live.run(ms(500));
    live.drive(1, rpm(50));
    live.run(ms(6_000));
    live.drive(1, rpm(-20));
    live.run(ms(2_000));
    live.command(Command::StopAll(StopReason::Operator))
        .unwrap();
    live.run(ms(4_000));
    let (file, _) = live.end_with_samples();
    let mut replay = Replay::of(&file);
    let (first, _) = replay.begun();
    let messages = replay.ask(ToReplay::Seek { after_us: u64::MAX });
    let changes: Vec<ActivityChange> = messages
        .iter()
        .find_map(|message| match message {
            FromReplay::PastActivities(changes) => Some(changes.clone()),
            _ => None,
        })
        .unwrap();
    let of_first = || changes.iter().filter(|change| change.id == id(1));
    let when = |what: fn(Activity) -> bool| {
        let change = of_first().find(|change| what(change.activity)).unwrap();
        change.at.since(first)
    };
    let driven_at = |speed| Activity::Driven {
        setpoint: rpm(speed),
    };
    assert!(of_first().any(|change| change.activity == driven_at(50)));
    let turned = of_first().find(|change| change.activity == driven_at(-20));
    let turned = turned.unwrap().at.since(first);
    let stopping = when(|activity| matches!(activity, Activity::Stopping { .. }));
    // The frame that shows a change comes up to 100 ms after the command.
    let wanted = turned + ms(2_000);
    assert!(stopping.abs_diff(wanted) < ms(200), "{changes:?}");
    assert_eq!(of_first().next_back().unwrap().activity, Activity::Idle);
}
