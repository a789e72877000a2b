//! The replay on the full screen.

use std::time::{Duration, Instant as Moment};

use motorlink_driver::{Ender, Status};
use motorlink_messages::{
    Update,
    sessions::{FromReplay, PlaySpeed, ToReplay},
};
use motorlink_protocol::{Instant, family::Model};
use motorlink_session::Mark;
use ratatui::{DefaultTerminal, crossterm::event::Event, style::Color};

use crate::{
    failure::Failure,
    key_input::KeyInput,
    screen::{Around, Screen, on_full_screen},
    session::one_line,
};

use super::{
    Recorded,
    keys::{self, Asked},
    micros,
    playback::Playback,
};

/// How long a key is waited for at most, and so how often the screen is drawn at least.
const KEY_WAIT: Duration = Duration::from_millis(50);
/// Columns of the bar that shows the place.
const BAR: u64 = 20;

/// Plays the session until Q.
pub fn show(
    recorded: Recorded,
    model: Option<Model>,
    speed: PlaySpeed,
    ender: &Ender,
) -> Result<(), Failure> {
    let mut view = View {
        screen: Screen::new(recorded.motors, model.unwrap_or_default()),
        model,
        name: one_line(&recorded.opened.name),
        marks: recorded.overview.marks().to_vec(),
        playback: Playback::new(recorded.opened, &recorded.overview),
        from_us: micros(recorded.from),
        to_us: micros(recorded.to),
        speed,
        wanted_us: None,
        is_unreadable: false,
        status: None,
        begun: Moment::now(),
    };
    on_full_screen("use --csv or --json", |terminal, input| {
        view.run(terminal, input, ender)
    })
}

struct View {
    screen: Screen,
    /// The model that the person has named.
    model: Option<Model>,
    name: String,
    /// What happened besides the frames.
    marks: Vec<Mark>,
    playback: Playback,
    /// The part that is shown.
    from_us: u64,
    to_us: u64,
    speed: PlaySpeed,
    /// A place that was asked for, until it is shown.
    wanted_us: Option<u64>,
    /// Whether the replay has paused because the file could not be read.
    is_unreadable: bool,
    /// What is shown.
    status: Option<Status>,
    begun: Moment,
}

impl View {
    fn run(
        &mut self,
        terminal: &mut DefaultTerminal,
        input: &KeyInput,
        ender: &Ender,
    ) -> Result<(), Failure> {
        self.seek(self.from_us);
        self.ask(ToReplay::Play(self.speed));
        loop {
            if ender.is_asked() {
                return Err(Failure::Interrupted);
            }
            let next = self.turn();
            if let Some(status) = &self.status {
                let around = self.around();
                terminal
                    .draw(|frame| self.screen.draw(frame, status, &around))
                    .map_err(Failure::output)?;
            }
            let wait = next.map_or(KEY_WAIT, |next| next.since(self.now()).min(KEY_WAIT));
            if self.take_keys(input, wait)? {
                return Ok(());
            }
        }
    }

    /// The clock of the player.
    fn now(&self) -> Instant {
        Instant::from_micros(micros(self.begun.elapsed()))
    }

    fn ask(&mut self, message: ToReplay) {
        let now = self.now();
        self.playback.ask(message, now);
    }

    fn seek(&mut self, to_us: u64) {
        let after_us = to_us.clamp(self.from_us, self.to_us);
        self.wanted_us = Some(after_us);
        self.ask(ToReplay::Seek { after_us });
    }

    /// Takes what the player has to show. Returns when it has more.
    fn turn(&mut self) -> Option<Instant> {
        let mut messages = Vec::new();
        let now = self.now();
        let next = self.playback.turn(now, |message| messages.push(message));
        for message in messages {
            match message {
                FromReplay::Jumped => {
                    self.screen.clear_speeds();
                    self.wanted_us = None;
                }
                FromReplay::Update { update, .. } => self.update(*update),
                FromReplay::Past(samples) => {
                    for sample in samples {
                        self.note_speed(&sample);
                    }
                }
                FromReplay::Unreadable => self.is_unreadable = true,
                FromReplay::Begun { .. }
                | FromReplay::PastActivities(_)
                | FromReplay::Faults(_)
                | FromReplay::Log { .. } => {}
            }
        }
        let place = self.playback.place;
        if place.plays && self.wanted_us.is_none() && place.after_us >= self.to_us {
            self.ask(ToReplay::Pause);
            self.seek(self.to_us);
            return Some(now);
        }
        next
    }

    fn update(&mut self, update: Update) {
        for sample in &update.samples {
            self.note_speed(sample);
        }
        if let (None, Some(line)) = (self.model, update.line) {
            self.screen.model = line.model;
        }
        self.screen.clear_notices();
        let after_us = self.playback.place.after_us;
        let until = self
            .marks
            .partition_point(|mark| micros(mark.after) <= after_us);
        for mark in self.marks.iter().take(until) {
            let text = format!("{}  {}", clock(micros(mark.after)), one_line(&mark.text));
            self.screen.notice(text);
        }
        self.status = Some(Status {
            now: update.now,
            is_open: true,
            stops_begun: 0,
            is_halted: update.halted,
            motors: update.motors,
            job: update.job,
            raw: update.raw,
            line: update.line,
        });
    }

    fn note_speed(&mut self, sample: &motorlink_bus::Sample) {
        if let Some(speed) = sample.reply.speed {
            self.screen.speed(sample.reply.id, sample.at, speed);
        }
    }

    /// Obeys the keys that were pressed. Returns whether to leave.
    fn take_keys(&mut self, input: &KeyInput, mut wait: Duration) -> Result<bool, Failure> {
        while let Some(event) = input.next(wait)? {
            wait = Duration::ZERO;
            let Event::Key(key) = event else {
                continue;
            };
            let Some(asked) = keys::asked(key) else {
                continue;
            };
            self.is_unreadable = false;
            match asked {
                Asked::Quit => return Ok(true),
                Asked::PlayOrPause => self.play_or_pause(),
                Asked::Jump(by_us) => self.seek(self.place_us().saturating_add_signed(by_us)),
                Asked::Start => self.seek(self.from_us),
                Asked::End => self.seek(self.to_us),
                Asked::Faster => self.set_speed(keys::faster(self.speed)),
                Asked::Slower => self.set_speed(keys::slower(self.speed)),
            }
        }
        Ok(false)
    }

    /// The place that is shown, or is about to be.
    fn place_us(&self) -> u64 {
        self.wanted_us.unwrap_or(self.playback.place.after_us)
    }

    fn play_or_pause(&mut self) {
        if self.playback.place.plays {
            self.ask(ToReplay::Pause);
            return;
        }
        // From the start, where it is at the end.
        if self.place_us() >= self.to_us {
            self.seek(self.from_us);
        }
        self.ask(ToReplay::Play(self.speed));
    }

    fn set_speed(&mut self, speed: PlaySpeed) {
        self.speed = speed;
        if self.playback.place.plays {
            self.ask(ToReplay::Play(speed));
        }
    }

    fn around(&self) -> Around {
        let place_us = self.place_us();
        let (does, colour) = if self.is_unreadable {
            ("unreadable here", Color::Red)
        } else if self.playback.place.plays {
            ("playing", Color::Green)
        } else if place_us >= self.to_us {
            ("at the end", Color::Yellow)
        } else {
            ("paused", Color::Yellow)
        };
        let part_us = (self.to_us - self.from_us).max(1);
        let filled = place_us.saturating_sub(self.from_us) * BAR / part_us;
        let bar: String = (0..BAR)
            .map(|column| if column < filled { '█' } else { '░' })
            .collect();
        let (place, to) = (clock(place_us), clock(self.to_us));
        let speed = f64::from(self.speed.per_mille()) / 1_000.0;
        let (name, model) = (&self.name, self.screen.model);
        Around {
            head: format!("{bar}  {place} / {to}  {speed}×  {does}  {name}  {model}"),
            colour,
            title: " Recorded motors ".to_owned(),
            marked: 0..0,
            keys: keys::HELP.to_owned(),
        }
    }
}

/// Minutes, seconds and tenths: `1:02.5`.
fn clock(us: u64) -> String {
    let tenths = us / 100_000;
    let (minutes, seconds, tenths) = (tenths / 600, tenths / 10 % 60, tenths % 10);
    format!("{minutes}:{seconds:02}.{tenths}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_has_minutes_and_tenths() {
        let texts = [0, 62_599_999, 3_600_000_000].map(clock);
        assert_eq!(texts, ["0:00.0", "1:02.5", "60:00.0"]);
    }
}
