//! `motorlink control`: drives motors by keys, full screen.

mod keys;
mod screen;

use std::time::{Duration, Instant};

use motorlink_bus::{Activity, Command, Consent, GroupError, StopReason};
use motorlink_driver::{Ender, Next, Status};
use motorlink_protocol::{Acceleration, Setpoint, SpeedTarget};
use ratatui::{
    DefaultTerminal,
    crossterm::event::{self, Event, KeyEventKind},
};

use crate::{
    arguments::Global,
    connection::{Connection, on_line},
    failure::Failure,
    signed_id::SignedId,
    starting,
    watching::watch_found,
    words,
};
use keys::{Asked, Held};
use screen::Screen;

/// How often the screen is drawn.
const DRAW: Duration = Duration::from_millis(100);
/// How long a key is waited for before the entries of the driver are taken: it must hear from this program twice a second.
const KEY_WAIT: Duration = Duration::from_millis(15);

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
            let screen = Screen::new(connection.motors.clone(), model, how.latches);
            // It also restores the terminal before a panic is printed.
            let terminal = ratatui::try_init().map_err(|error| {
                Failure::Usage(format!(
                    "control needs a terminal ({error}); use drive in scripts"
                ))
            })?;
            let mut control = Control {
                connection,
                screen,
                how,
                held: Held::default(),
            };
            let done = control.run(terminal);
            ratatui::restore();
            done
        },
    )
}

struct Control<'a> {
    connection: &'a Connection,
    screen: Screen,
    how: How,
    held: Held,
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
                self.screen.record(&status);
                terminal
                    .draw(|frame| self.screen.draw(frame, &status))
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
                self.screen.selected = (self.screen.selected + step) % count;
            }
            Asked::Group => {
                self.stop();
                self.screen.is_group = !self.screen.is_group && self.screen.motors.len() > 1;
            }
            Asked::Quit => {}
        }
    }

    fn selected(&self) -> impl Iterator<Item = SignedId> + '_ {
        let is_chosen = |place: usize| self.screen.is_group || place == self.screen.selected;
        let motors = self.screen.motors.iter().enumerate();
        motors
            .filter(move |(place, _)| is_chosen(*place))
            .map(|(_, motor)| *motor)
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
