//! Of a session with states, a replay shows at every moment what the page showed, field by field.

use std::{collections::BTreeMap, env, time::Duration};

use motorlink_bus::{
    BusSettings, Command, Consent, Limits, LineEvent, LineEventKind, Repeat, Sample,
};
use motorlink_messages::{
    Adapter, Connection, Update,
    sessions::{FaultChange, FromReplay, ToReplay},
    stored_state,
};
use motorlink_protocol::{Faults, Instant, MotorId, Request, family::Model};
use motorlink_session::Writer;

use super::{
    driver::{Replay, updates},
    live::{Live, ZERO_US, id, ms},
    random::Dice,
};

/// `STRETCHES=1000 cargo test -p motorlink-session --test session states` tries more.
const STRETCHES: u64 = 40;

/// Moments of each stretch to which the replay jumps.
const JUMPS: u64 = 12;

fn command(dice: &mut Dice, model: Model) -> Command {
    match dice.below(12) {
        0 => Command::FullScan,
        1 => Command::CancelJob,
        2 => Command::SendRaw {
            frame: Request::Query { id: id(1) }.frame(),
            repeat: Repeat::Once,
            consent: Consent::None,
        },
        3 => {
            let hottest = 40 + u16::try_from(dice.below(40)).unwrap();
            Command::Configure(BusSettings {
                limits: Limits::new(100, 2_000, hottest).unwrap(),
                ..BusSettings::default()
            })
        }
        _ => dice.command(model),
    }
}

/// Some seconds of a line with random commands and faults: its file, and what the page showed.
fn stretch(model: Model, seed: u64) -> (Vec<u8>, Vec<Update>) {
    let mut dice = Dice::new(seed);
    let mut live = Live::of(model);
    for _ in 0..3 + dice.below(12) {
        if dice.below(8) == 0 {
            live.world.set_faults(dice.faults());
        }
        // An overheated motor reports a fault until it has cooled down.
        let celsius = [25.0, 95.0].get(usize::try_from(dice.below(6)).unwrap());
        if let Some(celsius) = celsius {
            live.world
                .motor_mut(id(1))
                .unwrap()
                .set_temperature_c(*celsius);
        }
        let power = dice.below(12);
        if power < 2 {
            live.world.motor_mut(id(1)).unwrap().power(power == 0);
        }
        // Many are refused in the state of the moment.
        let _: Result<(), _> = live.command(command(&mut dice, model));
        live.run(ms(dice.below(900)));
    }
    live.end()
}

/// What the replay has to show at this time.
fn shown(live: &[Update], at: Instant) -> Update {
    let before = live.iter().rev().find(|update| update.now <= at);
    Update {
        now: at,
        connection: Connection::Connected(Adapter::Recording),
        samples: Vec::new(),
        ..before.expect("an update").clone()
    }
}

fn for_each_stretch(mut each: impl FnMut(&mut Dice, &[u8], &[Update], &str)) {
    let stretches = env::var("STRETCHES").map_or(STRETCHES, |number| number.parse().unwrap());
    for seed in 1..=stretches {
        let model = Model::ALL[usize::try_from(seed).unwrap() % Model::ALL.len()];
        let (file, live) = stretch(model, seed);
        let dice = &mut Dice::new(seed ^ 0x55);
        each(dice, &file, &live, &format!("{model}, seed {seed}"));
    }
    println!("{stretches} stretches");
}

/// The replies that the page gets for its graph: those of the last seconds, then parts of the time before, newest first.
fn graph_after_jump(messages: &[FromReplay]) -> Vec<Sample> {
    let mut samples: Vec<Sample> = Vec::new();
    for message in messages {
        match message {
            FromReplay::Jumped => samples.clear(),
            FromReplay::Update { update, .. } => samples.extend(&update.samples),
            FromReplay::Past(part) => _ = samples.splice(0..0, part.iter().copied()),
            _ => {}
        }
    }
    samples
}

/// The changes of faults that the page saw up to this time. A reply at the very time of an update may be in the next one.
fn faults_until(live: &[Update], at: Instant) -> Vec<FaultChange> {
    let mut changes = Vec::new();
    let mut last: BTreeMap<MotorId, Faults> = BTreeMap::new();
    let seen = live.partition_point(|update| update.now <= at);
    let shown_at = seen.checked_sub(1).map(|last| live[last].now);
    for update in live.iter().take(seen + 1) {
        let replies = update.samples.iter();
        let mut told: Vec<_> = replies
            .map(|sample| (sample.at, sample.reply.id, Some(sample.reply.faults)))
            .collect();
        let silent = update.motors.iter().filter(|motor| motor.is_silent());
        told.extend(silent.map(|motor| (update.now, motor.id, None)));
        for (at, id, faults) in told {
            let last = last.entry(id).or_insert(Faults::NONE);
            let before = std::mem::replace(last, faults.unwrap_or(Faults::NONE));
            if before.byte() != last.byte() && Some(at) <= shown_at {
                changes.push(FaultChange { at, id, faults });
            }
        }
    }
    changes
}

#[test]
fn a_jump_shows_what_the_page_showed() {
    let (mut began, mut unknown) = (0, 0);
    for_each_stretch(|dice, file, live, context| {
        let mut replay = Replay::of(file);
        let (first, last) = (live.first().unwrap().now, live.last().unwrap().now);
        let length = u64::try_from(last.since(first).as_micros()).unwrap();
        for _ in 0..JUMPS {
            let at = Instant::from_micros(first.as_micros() + dice.below(length));
            let before = replay.messages.len();
            let replayed = Update {
                samples: Vec::new(),
                ..replay.seek(at)
            };
            assert_eq!(replayed, shown(live, at), "{context}");
            let messages = &replay.messages[before..];
            let faults = messages.iter().find_map(|message| match message {
                FromReplay::Faults(changes) => Some(changes),
                _ => None,
            });
            let shown = faults_until(live, at);
            assert_eq!(faults, Some(&shown), "{context}, {at:?}");
            began += shown.len();
            unknown += shown
                .iter()
                .filter(|change| change.faults.is_none())
                .count();
            let samples = graph_after_jump(messages);
            let past = live.iter().filter(|update| update.now <= at);
            let past: Vec<_> = past.flat_map(|update| &update.samples).copied().collect();
            let times = |samples: &[Sample]| {
                let times = samples.iter().map(|sample| (sample.at, sample.reply.id));
                times.collect::<Vec<_>>()
            };
            assert_eq!(times(&samples), times(&past), "{context}, {at:?}");
            assert_eq!(samples, past, "{context}, {at:?}");
        }
    });
    assert!(began > 200 && unknown > 10, "{began} {unknown}");
}

#[test]
fn playing_shows_every_reply_once_and_every_state() {
    for_each_stretch(|_, file, live, context| {
        let mut replay = Replay::of(file);
        replay.play(1_000);
        let last = live.last().unwrap().now;
        let begun = replay.begun().0;
        replay.run(last.since(begun) + ms(100));
        let mut samples: Vec<Sample> = Vec::new();
        for (_, update) in updates(&replay.messages) {
            samples.extend(&update.samples);
            if update.now >= live[0].now {
                let update = Update {
                    samples: Vec::new(),
                    ..update.clone()
                };
                assert_eq!(update, shown(live, update.now), "{context}");
            }
        }
        let live: Vec<_> = live
            .iter()
            .flat_map(|update| &update.samples)
            .copied()
            .collect();
        assert_eq!(samples, live, "{context}");
        let jumped = |message: &FromReplay| matches!(message, FromReplay::Jumped);
        assert!(!replay.messages.iter().any(jumped));
    });
}

/// A line whose last update is at 1 s, and which has a query at these times in milliseconds.
fn silent_page(queries: impl IntoIterator<Item = u64>) -> Vec<u8> {
    let live = Live::of(Model::Ddsm115).end().1;
    let last = live.last().unwrap();
    let update = Update {
        now: Instant::from_millis(1_000),
        ..last.clone()
    };
    let mut writer = Writer::new(ZERO_US, &[]);
    writer.state(update.now, &stored_state::store(update));
    let frame = Request::Query { id: id(1) }.frame();
    let kind = LineEventKind::Sent { frame, mode: None };
    for millis in queries {
        let at = Instant::from_millis(millis);
        writer.line(&LineEvent { at, kind });
    }
    writer.finish()
}

/// Behind a gap nothing is known of a motor, nor of its faults.
#[test]
fn a_fault_is_unknown_behind_a_gap() {
    let mut live = Live::of(Model::Ddsm115);
    live.world.motor_mut(id(1)).unwrap().set_temperature_c(95.0);
    live.run(ms(1_000));
    let last = live.end().1.into_iter().rev();
    let hot = |sample: &Sample| !sample.reply.faults.is_none();
    let mut with_fault = last.filter(|update| update.samples.iter().any(hot));
    let update = with_fault.next().expect("a fault");
    let at = update.now;
    let mut writer = Writer::new(ZERO_US, &[]);
    writer.state(at, &stored_state::store(update));
    let frame = Request::Query { id: id(1) }.frame();
    let kind = LineEventKind::Sent { frame, mode: None };
    writer.line(&LineEvent {
        at: at + ms(60_000),
        kind,
    });
    let file = writer.finish();
    let mut replay = Replay::of(&file);
    let mut faults_at = |after: Duration| {
        let before = replay.messages.len();
        replay.seek(at + after);
        let all = replay.messages[before..].iter();
        let mut changes = all.filter_map(|message| match message {
            FromReplay::Faults(changes) => changes.last().copied(),
            _ => None,
        });
        changes.next_back().expect("a change").faults
    };
    assert!(faults_at(ms(2_000)).is_some_and(|faults| !faults.is_none()));
    assert_eq!(faults_at(ms(30_000)), None);
}

/// A page that hangs gets no updates: its readings grow old.
#[test]
fn a_state_that_is_written_again_keeps_its_times() {
    let file = silent_page((1_000..21_000).step_by(200));
    let mut replay = Replay::of(&file);
    let speed = |update: Update| update.motors[0].speed.unwrap().0;
    let first = speed(replay.seek(Instant::from_millis(1_100)));
    for millis in [2_950, 3_050, 20_900] {
        let shown = replay.seek(Instant::from_millis(millis));
        assert_eq!(speed(shown), first, "{millis}");
    }
}

#[test]
fn a_state_ends_where_records_cease() {
    let file = silent_page([1_200, 1_400, 3_600_000, 3_600_200]);
    let mut replay = Replay::of(&file);
    for (millis, motors) in [(6_300, 2), (6_500, 0), (3_599_000, 0), (3_600_100, 0)] {
        let shown = replay.seek(Instant::from_millis(millis));
        assert_eq!(shown.motors.len(), motors, "{millis}");
    }
    replay.ask(ToReplay::Seek { after_us: 0 });
    replay.play(100_000);
    replay.run(ms(2_000));
    let (place, update) = replay.last();
    assert!(place.after_us > 100_000_000 && update.motors.is_empty());
}
