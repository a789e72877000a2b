//! `motorlink control`: drives motors by keys, full screen.

pub mod arguments;
mod keys;
mod targets;

use std::{
    ops::Range,
    time::{Duration, Instant},
};

use motorlink_bus::{Activity, Command, Consent, GroupError, StopReason, needs_consent};
use motorlink_driver::{Ender, Next, Status};
use motorlink_protocol::Setpoint;
use ratatui::{
    DefaultTerminal,
    crossterm::event::{Event, KeyEventKind},
    style::Color,
};

use crate::{
    arguments::Global,
    connection::{Connection, on_line},
    drive::{amps_setpoint, consent_for},
    failure::Failure,
    key_input::KeyInput,
    screen::{Around, Screen, on_full_screen},
    signed_id::SignedId,
    starting,
    values::present_angle,
    watching::watch_found,
    words,
};
use arguments::{Control as Arguments, Loop};
use keys::{Asked, Drive, Held};
use targets::Targets;

/// How often the screen is drawn.
const DRAW: Duration = Duration::from_millis(100);
/// How long a key is waited for before the entries of the driver are taken: it must hear from this program twice a second.
const KEY_WAIT: Duration = Duration::from_millis(15);

/// What the keys do in every loop.
const KEYS: &str =
    "S stop  K brake  Space stop all  R release  V/C/P loop  ↑/↓ motor  G group  Q quit";

/// Drives by keys until Q or Ctrl-C.
pub fn run(global: &Global, how: &Arguments, ender: &Ender) -> Result<(), Failure> {
    // The keys ask for the same current.
    consent_for(amps_setpoint(how.amps)?, how.high_current)?;
    on_line(
        global,
        ender,
        |_| (),
        |connection| {
            watch_found(connection)?;
            let model = connection.driver.model();
            let mut control = Control {
                screen: Screen::new(connection.motors.clone(), model),
                connection,
                targets: Targets::new(how),
                allows_high_current: how.high_current,
                latches: how.latch,
                held: Held::default(),
                selected: 0,
                is_group: false,
            };
            on_full_screen("use drive in scripts", |terminal, input| {
                control.run(terminal, input)
            })
        },
    )
}

struct Control<'a> {
    connection: &'a Connection,
    screen: Screen,
    targets: Targets,
    allows_high_current: bool,
    /// Whether a key drives until another one, not only while it is held.
    latches: bool,
    held: Held,
    /// The place of the selected motor.
    selected: usize,
    /// Whether all motors are driven together.
    is_group: bool,
}

impl Control<'_> {
    fn run(&mut self, terminal: &mut DefaultTerminal, input: &KeyInput) -> Result<(), Failure> {
        let mut draw_at = Instant::now();
        loop {
            if !self.take_entries() || self.take_keys(input)? {
                return Ok(());
            }
            let now = Instant::now();
            if self.held.is_let_go(now) && !self.latches {
                self.stop();
            }
            if now >= draw_at {
                draw_at = now + DRAW;
                let Ok(status) = self.connection.status() else {
                    return Ok(());
                };
                for motor in &status.motors {
                    if let Some((at, speed)) = motor.speed {
                        self.screen.speed(motor.id, at, speed);
                    }
                }
                let around = self.around(&status);
                terminal
                    .draw(|frame| self.screen.draw(frame, &status, &around))
                    .map_err(Failure::output)?;
            }
        }
    }

    /// Takes what has happened. Returns whether the driver still runs.
    fn take_entries(&mut self) -> bool {
        loop {
            match self.connection.driver.next(Duration::ZERO) {
                Next::Entry(_, entry) => {
                    if let Some(text) = words::of_entry(&entry) {
                        self.screen.notice(text);
                    } else if let motorlink_driver::Entry::Event(motorlink_bus::Event::StopEnded(
                        report,
                    )) = &entry
                    {
                        self.screen.notice(words::of_stop(report));
                    }
                }
                Next::Nothing => return true,
                Next::Ended => return false,
            }
        }
    }

    /// Obeys the keys that were pressed. Returns whether to leave.
    fn take_keys(&mut self, input: &KeyInput) -> Result<bool, Failure> {
        let mut wait = KEY_WAIT;
        while let Some(event) = input.next(wait)? {
            wait = Duration::ZERO;
            let Event::Key(key) = event else {
                continue;
            };
            let now = Instant::now();
            if key.kind == KeyEventKind::Release {
                self.held.release(key.code, now);
                continue;
            }
            let Some(asked) = keys::asked(key) else {
                continue;
            };
            if asked == Asked::Quit {
                return Ok(true);
            }
            match asked {
                // A key without a setpoint in this loop holds nothing.
                Asked::Drive(drive) if !self.targets.have(drive) => {}
                Asked::Drive(_) => {
                    if self.held.press(key.code, now) {
                        self.obey(asked);
                    }
                }
                // It stops nothing: a key that is held goes on to hold.
                Asked::Release => self.obey(asked),
                Asked::Nudge(by) => {
                    // It holds what another key has started.
                    if self.nudge(by) {
                        self.held.press(key.code, now);
                    }
                }
                _ => {
                    self.held.clear();
                    self.obey(asked);
                }
            }
        }
        Ok(false)
    }

    fn obey(&mut self, asked: Asked) {
        let driver = &self.connection.driver;
        match asked {
            Asked::Drive(key) => match self.targets.setpoint(key, self.angle()) {
                Some(setpoint) => self.start(setpoint),
                None if key == Drive::Forward => {
                    let text = "not done: the angle is not known yet. Choose one by 1-4.";
                    self.screen.notice(text.to_owned());
                }
                None => {}
            },
            Asked::Choose(chosen) => {
                // What is driven in another loop would not be what the screen shows.
                self.stop();
                self.targets.chosen = chosen;
                self.targets.forget_angle();
                self.set_group(self.is_group);
            }
            Asked::Brake => self.start(Setpoint::Brake),
            Asked::Stop => self.stop(),
            Asked::StopAll => driver.command(Command::StopAll(StopReason::Operator)),
            Asked::Release => driver.command(Command::Release),
            Asked::Select(by) => {
                // Nothing stays driven that is not selected any more.
                self.stop();
                let count = self.screen.motors.len().max(1);
                let step = if by < 0 { count - 1 } else { 1 };
                self.selected = (self.selected + step) % count;
                self.targets.forget_angle();
            }
            Asked::Group => {
                self.stop();
                self.set_group(!self.is_group);
            }
            // They are handled where the held key is known.
            Asked::Nudge(_) | Asked::Quit => {}
        }
    }

    /// Drives all motors together from now on, or the selected one.
    fn set_group(&mut self, is_group: bool) {
        let is_allowed = self.targets.chosen == Loop::Velocity;
        if is_group && !is_allowed {
            // The bus starts a group in another loop only if each motor is in it already.
            let text = "motors drive together in the velocity loop only: V chooses it.";
            self.screen.notice(text.to_owned());
        }
        self.is_group = is_group && is_allowed && self.screen.motors.len() > 1;
    }

    /// Moves the setpoint of what is driven, or the next target. Returns whether it has moved what is driven.
    fn nudge(&mut self, by: i8) -> bool {
        let Some(driven) = self.driven_to() else {
            self.targets.prepare(by, self.angle());
            return false;
        };
        let further = self.targets.further(driven, by);
        if let Some(setpoint) = further {
            let command = starting::adjust(self.selected(), setpoint, self.consent(setpoint));
            self.give(command);
        }
        further.is_some()
    }

    /// The places of the motors that the keys drive.
    fn chosen(&self) -> Range<usize> {
        if self.is_group {
            0..self.screen.motors.len()
        } else {
            self.selected..self.selected + 1
        }
    }

    fn selected(&self) -> impl Iterator<Item = SignedId> + '_ {
        let chosen = self.screen.motors.get(self.chosen());
        chosen.unwrap_or_default().iter().copied()
    }

    fn around(&self, status: &Status) -> Around {
        let (head, colour) = if !status.is_open {
            ("The port is gone. Waiting for it.".to_owned(), Color::Red)
        } else if status.is_halted {
            ("STOPPED: all motors. R releases.".to_owned(), Color::Red)
        } else {
            let hertz = status.line.map_or(0, |line| line.exchanges_hz);
            let keys = if self.latches {
                "keys latch"
            } else {
                "hold a key to run"
            };
            let model = self.screen.model;
            let text = format!("MotorLink  {model}  {hertz} exchanges a second  {keys}");
            (text, Color::Green)
        };
        let together = if self.is_group {
            ", driven together"
        } else {
            ""
        };
        Around {
            head,
            colour,
            title: format!(" Motors{together}: {} ", self.targets.describe()),
            marked: self.chosen(),
            keys: format!("{}  {KEYS}", self.targets.help()),
        }
    }

    /// What the first selected motor is driven to, or will be once it stands in the loop. It has the sign of its side.
    fn driven_to(&self) -> Option<Setpoint> {
        let signed = self.selected().next()?;
        let status: Status = self.connection.status().ok()?;
        let motor = status.motor(signed.id)?;
        let setpoint = match motor.activity {
            Activity::Driven { setpoint } => Some(setpoint),
            _ => motor.waiting,
        };
        setpoint.map(|setpoint| signed.mirror.setpoint(setpoint))
    }

    /// The present angle of the first selected motor, as a target of the position loop.
    fn angle(&self) -> Option<f32> {
        // Others count the target from where the loop was entered.
        if self.screen.model.has_separate_frames() {
            return Some(0.0);
        }
        let signed = self.selected().next()?;
        let status = self.connection.status().ok()?;
        present_angle(status.motor(signed.id)?, status.now)
    }

    fn consent(&self, setpoint: Setpoint) -> Consent {
        if self.allows_high_current {
            needs_consent(setpoint)
        } else {
            Consent::None
        }
    }

    fn start(&mut self, setpoint: Setpoint) {
        let command = starting::start(self.selected(), setpoint, self.consent(setpoint));
        self.give(command);
    }

    fn give(&mut self, command: Result<Command, GroupError>) {
        match command {
            Ok(command) => self.connection.driver.command(command),
            Err(error) => self.screen.notice(format!("not done: {error}")),
        }
    }

    fn stop(&self) {
        for motor in self.selected() {
            self.connection.driver.command(Command::Stop(motor.id));
        }
    }
}
