//! What the rules know of a process and its motors.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::mpsc::Receiver,
    time::Duration,
};

use motorlink_bus::{Command, Event, StopReason};
use motorlink_driver::{Entry, Status};
use motorlink_messages::LeftBehind;
use motorlink_protocol::{Instant, Mode, MotorId};
use motorlink_simulator::{VirtualMotor, World};

use super::rule::{DriverRule, Outcome, STANDS_WITHIN};
use crate::rule::broken;

/// A program that answers nothing for a second counts as silent.
const SILENT_AFTER: Duration = Duration::from_millis(1_100);
/// Below this speed a wheel stands.
const STANDS_RPM: f32 = 1.0;
/// A wheel that turns as fast as this has not been reported to stand.
const TURNS_RPM: f32 = 5.0;

/// What the driver has told of its line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum LineState {
    /// There is no driver, or it could not open the port.
    #[default]
    None,
    Opening,
    Open,
    Lost,
}

/// Whether the last write was taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Disk {
    #[default]
    Takes,
    Full,
    /// The program was told.
    FullAndTold,
}

/// What the rules know of the process and its motors.
#[derive(Debug, Default)]
pub(super) struct Rules {
    pub(super) judged: BTreeMap<DriverRule, u64>,
    /// Motors that the program has asked to drive, and nothing has ended it since.
    pub(super) asked: BTreeSet<MotorId>,
    /// When that ended for the others; at the start of the process for those that are not here.
    pub(super) let_go: BTreeMap<MotorId, Instant>,
    pub(super) started: Instant,
    /// Whether the program has stopped all motors and not released them since: nothing that it asks for is driven.
    pub(super) is_halted: bool,
    /// Motors that must stand: the rule, and since when.
    pub(super) must_stand: BTreeMap<MotorId, (DriverRule, Instant)>,
    /// Those of them that the program may drive before they stand: it was told that they were not seen to stand.
    pub(super) may_be_driven: BTreeSet<MotorId>,
    /// Since when the port is good, and the process not frozen.
    pub(super) well_since: Option<Instant>,
    pub(super) last_frozen: Instant,
    /// When the program last asked for a stop. A port on trial stays open for it.
    pub(super) last_stop: Instant,
    /// Motors that turn and are in no file, as the disk was full.
    pub(super) forgotten: BTreeSet<MotorId>,
    pub(super) disk: Disk,
    pub(super) line: LineState,
    pub(super) lost: Option<Instant>,
    pub(super) ends: Option<Instant>,
    /// Whether a port was ever open for another model than that of the motors: what was driven then stays in the file.
    pub(super) was_of_other_model: bool,
    /// How often the driver has failed.
    pub(super) failures: u32,
    pub(super) status: Option<(Instant, Receiver<Status>)>,
}

impl Rules {
    pub(super) fn judge(&mut self, rule: DriverRule) {
        *self.judged.entry(rule).or_default() += 1;
    }

    /// A process starts.
    pub(super) fn starts(&mut self, now: Instant, world: &World, file: &[u8]) -> Outcome {
        self.is_gone(now);
        self.let_go.clear();
        self.is_halted = false;
        self.started = now;
        self.line = LineState::Opening;
        for motor in world.motors() {
            if !is_moved(motor) {
                self.forgotten.remove(&motor.id());
            } else if is_named(file, motor.id()) {
                self.must_stand
                    .insert(motor.id(), (DriverRule::LeftIsStopped, now));
            } else if self.disk != Disk::Takes {
                self.forgotten.insert(motor.id());
            } else if must_be_named(motor) && !self.forgotten.contains(&motor.id()) {
                let what = format!("{} is in no file after its process", motor.id());
                return broken(DriverRule::IsRemembered, now, what);
            }
        }
        self.disk = Disk::Takes;
        Ok(())
    }

    /// The process is gone, and with it what it had promised.
    pub(super) fn is_gone(&mut self, now: Instant) {
        self.let_go_of_asked(now);
        self.must_stand.clear();
        self.may_be_driven.clear();
        self.line = LineState::None;
        self.lost = None;
        self.ends = None;
        self.failures = 0;
        self.status = None;
    }

    /// The opening has ended. `fits` says whether the driver has found the model of the motors, if it is open.
    pub(super) fn opened(&mut self, now: Instant, fits: Option<bool>) -> Outcome {
        self.judge(DriverRule::OpensInTime);
        let is_open = fits.is_some();
        self.was_of_other_model |= fits == Some(false);
        if is_open && self.well_since.is_some_and(|since| since <= self.started) {
            self.judge(DriverRule::FindsModel);
            if fits == Some(false) {
                return broken(DriverRule::FindsModel, now, "it is open for another model");
            }
        }
        if is_open {
            self.line = LineState::Open;
        } else {
            self.line = LineState::None;
            self.must_stand.clear();
        }
        Ok(())
    }

    /// The program gives a command.
    pub(super) fn command(&mut self, now: Instant, command: Command, world: &World) {
        match command {
            Command::Start { id, .. } | Command::Drive { id, .. } => self.asks(id),
            Command::StartGroup { setpoints, .. } | Command::DriveGroup { setpoints, .. } => {
                for (id, _) in setpoints.entries() {
                    self.asks(id);
                }
            }
            Command::Stop(id) => {
                self.last_stop = now;
                self.lets_go(now, id, DriverRule::StopsInTime);
            }
            Command::Release => self.is_halted = false,
            Command::StopAll(_) => {
                self.is_halted = true;
                self.last_stop = now;
                self.lets_all_go(now, world, DriverRule::StopsInTime);
            }
            _ => {}
        }
    }

    fn asks(&mut self, id: MotorId) {
        if self.is_halted {
            return;
        }
        self.asked.insert(id);
        let is_stop = matches!(self.must_stand.get(&id), Some((DriverRule::StopsInTime, _)));
        if is_stop || self.may_be_driven.remove(&id) {
            self.must_stand.remove(&id);
        }
    }

    fn lets_go(&mut self, now: Instant, id: MotorId, rule: DriverRule) {
        if self.asked.remove(&id) && !self.forgotten.contains(&id) {
            self.let_go.insert(id, now);
            self.must_stand.entry(id).or_insert((rule, now));
        }
    }

    fn let_go_of_asked(&mut self, now: Instant) {
        let asked = std::mem::take(&mut self.asked).into_iter();
        self.let_go.extend(asked.map(|id| (id, now)));
    }

    fn lets_all_go(&mut self, now: Instant, world: &World, rule: DriverRule) {
        for motor in world.motors() {
            self.lets_go(now, motor.id(), rule);
        }
    }

    /// The program answers nothing for so long.
    pub(super) fn silent(&mut self, now: Instant, time: Duration, world: &World) {
        if time > SILENT_AFTER + STANDS_WITHIN {
            let silent = now + SILENT_AFTER;
            let rule = DriverRule::SilentProgramIsStopped;
            let known = world.motors().map(VirtualMotor::id);
            for id in known.filter(|id| !self.forgotten.contains(id)) {
                self.must_stand.entry(id).or_insert((rule, silent));
            }
        }
    }

    /// The program asks for the state.
    pub(super) fn asks_status(&mut self, now: Instant, answer: Receiver<Status>) {
        self.status = Some((now, answer));
    }

    /// The program ends the driver.
    pub(super) fn ends(&mut self, now: Instant, world: &World) {
        self.ends.get_or_insert(now);
        self.lets_all_go(now, world, DriverRule::StopsInTime);
    }

    /// The driver fails.
    pub(super) fn fails(&mut self, now: Instant, world: &World) {
        self.ends = Some(now);
        self.lets_all_go(now, world, DriverRule::FailureStops);
        self.failures += 1;
        if self.failures > 1 {
            self.must_stand.clear();
        }
    }

    /// The port is not good now.
    pub(super) const fn disturbed(&mut self) {
        self.well_since = None;
    }

    /// The process gets no processor time until then.
    pub(super) const fn freezes(&mut self, until: Instant) {
        self.last_frozen = until;
        self.disturbed();
    }

    /// The adapter is unplugged.
    pub(super) fn unplugged(&mut self, now: Instant) {
        self.disturbed();
        self.let_go_of_asked(now);
        self.must_stand.clear();
        if self.line == LineState::Open && self.ends.is_none() {
            self.lost.get_or_insert(now);
        }
    }

    /// The driver writes the file.
    pub(super) fn writes(&mut self, is_written: bool) {
        self.disk = match self.disk {
            _ if is_written => Disk::Takes,
            Disk::Takes => Disk::Full,
            full => full,
        };
    }

    /// The driver tells the program something.
    pub(super) fn told(
        &mut self,
        now: Instant,
        entry: &Entry,
        world: &World,
        port_is_there: bool,
    ) -> Outcome {
        match entry {
            Entry::NotRemembered => self.disk = Disk::FullAndTold,
            Entry::PortLost { driven } => {
                self.line = LineState::Lost;
                if self.lost.take().is_some() {
                    self.judge(DriverRule::LossIsTold);
                }
                let is_left = |motor: &&VirtualMotor| {
                    let id = motor.id();
                    must_be_named(motor)
                        && self.let_go.contains_key(&id)
                        && !self.forgotten.contains(&id)
                        && !driven.contains(&id)
                };
                if let Some(motor) = world.motors().find(is_left) {
                    let what = format!("{} is driven, and the loss names {driven:?}", motor.id());
                    return broken(DriverRule::LossIsTold, now, what);
                }
                self.may_be_driven.clear();
                for motor in world.motors().filter(|motor| is_moved(motor)) {
                    if !self.forgotten.contains(&motor.id()) {
                        self.must_stand
                            .insert(motor.id(), (DriverRule::LeftIsStopped, now));
                    }
                }
            }
            Entry::PortBack => {
                self.line = LineState::Open;
                self.judge(DriverRule::ComesBack);
                if !port_is_there {
                    self.lost.get_or_insert(now);
                }
            }
            Entry::Event(Event::StopEnded(report)) => {
                let motors = report.motors.iter().filter(|motor| !motor.confirmed);
                self.may_be_driven.extend(motors.map(|motor| motor.id));
            }
            Entry::Event(Event::StopBegan(StopReason::PageSilent | StopReason::Disconnect)) => {
                self.let_go_of_asked(now);
            }
            _ => {}
        }
        Ok(())
    }
}

/// Whether a motor turns, or is asked to.
pub(super) fn is_moved(motor: &VirtualMotor) -> bool {
    is_driven(motor) || motor.speed_rpm().abs() >= STANDS_RPM
}

pub(super) fn is_driven(motor: &VirtualMotor) -> bool {
    let asks = motor.obeyed().is_some_and(|(_, drive)| drive.signed() != 0);
    motor.is_driven() && motor.mode() != Mode::Position && asks
}

pub(super) fn must_be_named(motor: &VirtualMotor) -> bool {
    is_driven(motor) || motor.speed_rpm().abs() >= TURNS_RPM
}

pub(super) fn is_named(file: &[u8], id: MotorId) -> bool {
    let left = LeftBehind::of_file(file).ok().flatten();
    left.is_some_and(|left| left.motors.iter().any(|motor| motor.id == id))
}
