//! Replays the hour: jumps, and plays at a hundred times real time.

use std::{
    io,
    time::{Duration, Instant},
};

use motorlink_messages::{
    protocol,
    recorder::Window,
    sessions::{FromReplay, PlaySpeed, ToReplay},
};
use motorlink_recorder::LocalTime;
use motorlink_session::{Overview, Player, Session, Source, Todo};

use crate::{OnDisk, millis, row, seconds};

const JUMPS: u64 = 100;

/// A replay, and how long its steps take.
struct Replay<'a> {
    source: &'a mut OnDisk,
    session: &'a Session,
    player: Player,
    now: protocol::Instant,
    /// Every poll, with its reading.
    turns: Vec<Duration>,
    working: Duration,
}

impl Replay<'_> {
    /// Polls until a message like this, or until there is nothing to do. Returns the time that it took.
    fn until(&mut self, wanted: impl Fn(&FromReplay) -> bool) -> io::Result<Duration> {
        let began = Instant::now();
        loop {
            let step = Instant::now();
            let todo = self.player.poll(self.session, self.now);
            let is_it = match &todo {
                Todo::Read(range) => {
                    let bytes = self.source.read(range.clone())?;
                    self.player.supply(range, &bytes);
                    false
                }
                Todo::Post(message) => wanted(message),
                Todo::Work => false,
                Todo::Wait(due) => due.is_none_or(|due| due > self.now),
            };
            self.turns.push(step.elapsed());
            if is_it {
                self.working += began.elapsed();
                return Ok(began.elapsed());
            }
        }
    }
}

/// Prints the figures of a replay.
pub fn measure(source: &mut OnDisk, session: &Session, overview: &Overview) -> io::Result<()> {
    let began = Instant::now();
    let mut replay = Replay {
        source,
        session,
        player: Player::new(session, overview, LocalTime::fixed(0)),
        now: protocol::Instant::ZERO,
        turns: Vec::new(),
        working: Duration::ZERO,
    };
    let is_picture = |message: &FromReplay| matches!(message, FromReplay::Update { .. });
    replay.until(is_picture)?;
    let first = began.elapsed();
    row(
        "replay: from its beginning to the first state",
        "at most 50 ms",
        &millis(first),
        first < Duration::from_millis(50),
    );

    let window = Window {
        first: None,
        rows: 60,
    };
    let show = ToReplay::ShowRows(window);
    replay.player.handle(session, show, replay.now);
    let (mut pictures, mut minutes) = (Vec::new(), Vec::new());
    for n in 0..JUMPS {
        let after_us = 36_000_000 * (n * 37 % JUMPS) + 1_234_567;
        let seek = ToReplay::Seek { after_us };
        replay.player.handle(session, seek, replay.now);
        let picture = replay.until(is_picture)?;
        pictures.push(picture);
        minutes.push(picture + replay.until(|_| false)?);
        replay.now = replay.now + Duration::from_secs(1);
    }
    let ends = |times: &mut Vec<Duration>| {
        times.sort();
        let at = |place: usize| times.get(place).copied().unwrap_or_default();
        (at(times.len() / 2), at(times.len() - 1))
    };
    let (median, worst) = ends(&mut pictures);
    let measured = format!(
        "median {}, worst {} of {JUMPS}",
        millis(median),
        millis(worst)
    );
    row(
        "replay: a jump anywhere, to the state there",
        "at most 50 ms",
        &measured,
        worst < Duration::from_millis(50),
    );
    let (median, worst) = ends(&mut minutes);
    let measured = format!("median {}, worst {}", millis(median), millis(worst));
    let name = "replay: to all of the minute before it, with the packet log";
    row(name, "", &measured, true);

    let seek = ToReplay::Seek { after_us: 0 };
    replay.player.handle(session, seek, replay.now);
    replay.until(|_| false)?;
    replay.working = Duration::ZERO;
    let fast = ToReplay::Play(PlaySpeed::from_per_mille(100_000));
    replay.player.handle(session, fast, replay.now);
    for _ in 0..1_000 {
        replay.until(|_| false)?;
        replay.now = replay.now + Duration::from_millis(10);
    }
    let measured = format!("{} of 10 s", seconds(replay.working));
    row(
        "replay at a hundred times real time: computing time, native",
        "under a half",
        &measured,
        replay.working < Duration::from_secs(5),
    );
    replay.turns.sort();
    // The machine may run something else for the rest of them.
    let place = replay.turns.len() * 999 / 1_000;
    let longest = replay.turns.get(place).copied().unwrap_or_default();
    row(
        "replay: the longest of 99.9 % of its turns, native",
        "at most 8 ms",
        &millis(longest),
        longest < Duration::from_millis(8),
    );
    Ok(())
}
