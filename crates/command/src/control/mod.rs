//! `motorlink control`: drives motors by keys, full screen.

mod keys;

use std::{
    ops::Range,
    time::{Duration, Instant},
};

use motorlink_bus::{Activity, Command, Consent, GroupError, StopReason};
use motorlink_driver::{Ender, Next, Status};
use motorlink_protocol::{Acceleration, Setpoint, SpeedTarget};
use ratatui::{
    DefaultTerminal,
    crossterm::event::{self, Event, KeyEventKind},
    style::Color,
};

use crate::{
    arguments::Global,
    connection::{Connection, on_line},
    failure::Failure,
    screen::{Around, Screen, on_full_screen},
    signed_id::SignedId,
    starting,
    watching::watch_found,
    words,
};
use keys::{Asked, Held};

/// How often the screen is drawn.
const DRAW: Duration = Duration::from_millis(100);
/// How long a key is waited for before the entries of the driver are taken: it must hear from this program twice a second.
const KEY_WAIT: Duration = Duration::from_millis(15);

const KEYS: &str = "F/B forward, back  1-5 50-250 rpm  ←/→ ±10  S stop  K brake  Space stop all  R release  ↑/↓ motor  G group  Q quit";

/// What `control` is given.
#[derive(Clone, Copy, Debug)]
pub struct How {
    /// Speed of F and B in rpm.
    pub rpm: i32,
    /// How gently the motor speeds up.
    pub acceleration: Acceleration,
    /// Whether a key drives until another one, not only while it is held.
    pub latches: bool,
}

/// Drives by keys until Q or Ctrl-C.
pub fn run(global: &Global, how: How, ender: &Ender) -> Result<(), Failure> {
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
                how,
                held: Held::default(),
                selected: 0,
                is_group: false,
            };
            on_full_screen("use drive in scripts", |terminal| control.run(terminal))
        },
    )
}

struct Control<'a> {
    connection: &'a Connection,
    screen: Screen,
    how: How,
    held: Held,
    /// The place of the selected motor.
    selected: usize,
    /// Whether all motors are driven together.
    is_group: bool,
}

impl Control<'_> {
    fn run(&mut self, mut terminal: DefaultTerminal) -> Result<(), Failure> {
        let mut draw_at = Instant::now();
        loop {
            if !self.take_entries() || self.take_keys()? {
                return Ok(());
            }
            let now = Instant::now();
            if self.held.is_let_go(now) && !self.how.latches {
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
    fn take_keys(&mut self) -> Result<bool, Failure> {
        let mut wait = KEY_WAIT;
        while event::poll(wait).map_err(Failure::output)? {
            wait = Duration::ZERO;
            let Event::Key(key) = event::read().map_err(Failure::output)? else {
                continue;
            };
            let now = Instant::now();
            if key.kind == KeyEventKind::Release {
                self.held.release(key.code, now);
                continue;
            }
            let Some(asked) = keys::asked(key, self.how.rpm) else {
                continue;
            };
            if asked == Asked::Quit {
                return Ok(true);
            }
            match asked {
                Asked::Drive(_) => {
                    if self.held.press(key.code, now) {
                        self.obey(asked);
                    }
                }
                Asked::Nudge(_) => {
                    self.held.press(key.code, now);
                    self.obey(asked);
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
            Asked::Drive(rpm) => self.start(self.velocity(rpm)),
            Asked::Nudge(by) => {
                if let Some(rpm) = self.driven_at() {
                    self.adjust(self.velocity(rpm + by));
                }
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
            }
            Asked::Group => {
                self.stop();
                self.is_group = !self.is_group && self.screen.motors.len() > 1;
            }
            Asked::Quit => {}
        }
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

    fn around(&self, status: &Status) -> Around<'static> {
        let (head, colour) = if !status.is_open {
            ("The port is gone. Waiting for it.".to_owned(), Color::Red)
        } else if status.is_halted {
            ("STOPPED: all motors. R releases.".to_owned(), Color::Red)
        } else {
            let hertz = status.line.map_or(0, |line| line.exchanges_hz);
            let keys = if self.how.latches {
                "keys latch"
            } else {
                "hold a key to run"
            };
            let model = self.screen.model;
            let text = format!("MotorLink  {model}  {hertz} exchanges a second  {keys}");
            (text, Color::Green)
        };
        let title = if self.is_group {
            " Motors, driven together "
        } else {
            " Motors "
        };
        Around {
            head,
            colour,
            title,
            marked: self.chosen(),
            keys: KEYS,
        }
    }

    /// The speed at which the selected motor is driven, with the sign of its side.
    fn driven_at(&self) -> Option<i32> {
        let status: Status = self.connection.status().ok()?;
        let signed = self.selected().next()?;
        let motor = status.motor(signed.id)?;
        match signed.mirror.activity(motor.activity) {
            Activity::Driven {
                setpoint: Setpoint::Velocity { speed, .. },
            } => Some(speed.rpm().into()),
            _ => None,
        }
    }

    fn velocity(&self, rpm: i32) -> Setpoint {
        Setpoint::Velocity {
            speed: SpeedTarget::clamped(rpm),
            acceleration: self.how.acceleration,
        }
    }

    fn start(&mut self, setpoint: Setpoint) {
        let command = starting::start(self.selected(), setpoint, Consent::None);
        self.give(command);
    }

    fn adjust(&mut self, setpoint: Setpoint) {
        let command = starting::adjust(self.selected(), setpoint);
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
