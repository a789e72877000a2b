//! Opens the line for the model of its motors, stops first what was left driven on it, and opens it again after a loss.

use std::time::Duration;

use motorlink_bus::Bus;
use motorlink_port::{BusEnd, Host, IfNoReply, Opening, Others, Step};
use motorlink_protocol::{Instant, MotorId, family::Model};
use motorlink_runs::Input;
use motorlink_simulator::World;

use crate::{
    computer::Computer,
    driven_file::NoFile,
    entry::Entry,
    open_failure::OpenFailure,
    options::Options,
    owner::{Owner, Stage},
    ports::Place,
};

/// How long motors may take to report their speed before the port counts as open: three queries at 10 Hz.
const FIRST_SPEED_MAX: Duration = Duration::from_millis(300);
/// The same with separate frames: two replies with an angle give a speed, and others come between them.
const FIRST_SPEED_SEPARATE_MAX: Duration = Duration::from_millis(700);
/// How long the opening may take once the port is open: a little more than a stop.
const OPENING_MAX: Duration = Duration::from_secs(4);
/// Pause between two tries to open a lost port. Linux sets its permissions a moment after it is there.
const REOPEN_PAUSE: Duration = Duration::from_millis(100);

impl<C: Computer> Owner<C> {
    pub(crate) fn open(&mut self, options: &Options) -> Result<Model, OpenFailure> {
        match &options.place {
            Place::Virtual(virtual_line) => {
                let now = self.computer.now();
                let motors = &virtual_line.world.motors;
                self.watched.extend(motors.iter().map(|motor| motor.id));
                let bus = self.new_bus(now, virtual_line.model());
                self.has_queried = !self.asks_for_id();
                let line = Box::new(World::new(virtual_line.world.clone()));
                self.host = Some(Host { bus, line });
            }
            Place::OnlyAdapter => self.open_port(None)?,
            Place::Port(path) => self.open_port(Some(path))?,
        }
        self.end_trial();
        self.finish_opening();
        self.settle();
        let model = self.host.as_ref().map(|host| host.bus.model());
        model.ok_or(OpenFailure::Lost)
    }

    /// Waits until the ID query has ended, and the stop of what was left driven: the bus refuses other commands meanwhile.
    /// Then it waits a little for the speed of each motor: before it, the bus starts none in the position loop.
    fn finish_opening(&mut self) {
        let begun = self.computer.now();
        let mut free_since = None;
        while !self.stage.is_ending() {
            let wake = self.turn();
            let now = self.computer.now();
            let Some(host) = &self.host else { return };
            if self.has_queried && !host.bus.is_stopping() {
                let waited = now.since(*free_since.get_or_insert(now));
                let answered = host.bus.motors(now).all(|motor| motor.speed.is_some());
                let limit = if host.bus.model().has_separate_frames() {
                    FIRST_SPEED_SEPARATE_MAX
                } else {
                    FIRST_SPEED_MAX
                };
                if (answered && host.bus.model_known()) || waited >= limit {
                    return;
                }
            }
            if now.since(begun) >= OPENING_MAX {
                return;
            }
            self.take_inputs(wake);
        }
    }

    fn open_port(&mut self, path: Option<&str>) -> Result<(), OpenFailure> {
        let port = self.computer.find_port(path)?;
        let path = port.path.clone();
        match self.computer.open_file(&port.identity()) {
            Ok(file) => self.file = file,
            Err(NoFile::InUse) => return Err(OpenFailure::Busy { path, holder: None }),
            Err(NoFile::Refused) => {
                let now = self.computer.now();
                self.tell(now, Entry::NotRemembered);
            }
        }
        self.port = Some(port);
        self.open_serial(&path)
    }

    /// Opens the serial port at `path` for the model of its motors: the one that was left driven, the one that was asked
    /// for, or the one that answers.
    fn open_serial(&mut self, path: &str) -> Result<(), OpenFailure> {
        if self.choice.detect
            && let Some(left) = self.file.left.model_of_motors()
        {
            self.choice.model = left;
        }
        let mut opening = Opening::new(1, MotorId::FIRST, self.choice, IfNoReply::TakeFirst);
        loop {
            let now = self.computer.now();
            let bus = self.host.as_mut().map(|host| &mut host.bus);
            let step = opening.step(now, bus, &mut self.file.left);
            self.choice = opening.choice();
            match step {
                // The file of this adapter is open, and no other program has it.
                Step::Claim(_) => {}
                Step::Open(_, model) => {
                    self.number += 1;
                    let line = self.computer.open_line(path, model, self.number)?;
                    let now = self.computer.now();
                    let mut bus = self.new_bus(now, model).after_another(now).on_trial();
                    opening.opened(now, &mut bus, &mut self.file.left, Others::NONE);
                    self.has_queried = !self.asks_for_id();
                    self.host = Some(Host { bus, line });
                }
                Step::Close => self.close_line(),
                Step::Wait => self.run_on_trial()?,
                Step::Done => return Ok(()),
                Step::Failed => return Err(OpenFailure::Lost),
            }
        }
    }

    /// Runs the port on trial for a moment.
    fn run_on_trial(&mut self) -> Result<(), OpenFailure> {
        let wake = self.turn();
        let now = self.computer.now();
        if self.host.is_some() {
            self.take_inputs(wake.min(now + Opening::STEP));
        }
        let now = self.computer.now();
        match &self.host {
            None => Err(OpenFailure::Lost),
            Some(host) if self.stage.is_ending() && !host.bus.is_active(now) => {
                Err(OpenFailure::Ended)
            }
            Some(_) => Ok(()),
        }
    }

    /// Whether the ID query is sent. Several motors would reply to it at once.
    fn asks_for_id(&self) -> bool {
        self.watched.len() < 2
    }

    /// A bus on which nothing drives, with what the program has set.
    pub(crate) fn new_bus(&self, now: Instant, model: Model) -> Bus {
        let watched = self.watched.iter().copied();
        let asks_for_id = self.asks_for_id();
        self.control.new_bus(now, model, asks_for_id, watched)
    }

    /// The port is the right one: the bus may enable its motors.
    pub(crate) fn end_trial(&mut self) {
        let now = self.computer.now();
        if let Some(host) = &mut self.host {
            host.bus.end_trial(now);
        }
    }

    /// The program may drive from now on.
    pub(crate) fn settle(&mut self) {
        if self.stage == Stage::OnTrial {
            self.stage = Stage::Settled;
        }
    }

    /// Closes the line, and remembers what is left driven on it.
    pub(crate) fn close_line(&mut self) {
        let now = self.computer.now();
        if let Some(mut host) = self.host.take() {
            let BusEnd { last, left } = host.close(now);
            self.file.left.carry(left);
            for event in last {
                self.tell(now, Entry::Event(event));
            }
        }
    }

    pub(crate) fn lose_port(&mut self) {
        let now = self.computer.now();
        let driven = self.host.as_ref().map_or_else(Vec::new, |host| {
            host.bus.left_driven().map(|motor| motor.id).collect()
        });
        self.control.closed(now, Input::Unplugged);
        self.close_line();
        self.look_at = now;
        if self.stage != Stage::OnTrial {
            self.tell(now, Entry::PortLost { driven });
        }
    }

    /// Opens a lost port again if it is back.
    pub(crate) fn look_for_port(&mut self, now: Instant) -> Instant {
        if now < self.look_at || self.stage != Stage::Settled {
            return self.look_at.max(now);
        }
        self.look_at = now + REOPEN_PAUSE;
        let port = self.port.as_ref();
        let Some(path) = port.and_then(|port| self.computer.port_again(port)) else {
            return self.look_at;
        };
        // The program may not drive on a port that is tried.
        self.stage = Stage::OnTrial;
        let is_open = self.open_serial(&path).is_ok();
        if is_open {
            self.end_trial();
        }
        self.settle();
        if is_open {
            self.tell(now, Entry::PortBack);
            return now;
        }
        self.look_at
    }
}
