//! The newest state of each motor, from the entries of the driver.

use std::{
    collections::BTreeMap,
    f64::consts::TAU,
    sync::Arc,
    time::{Duration, Instant as Moment},
};

use motorlink_bus::{Event, MotorStatus, Sample, StopReason, TurnCounter, WithdrawReason};
use motorlink_controller_messages::EndReason;
use motorlink_driver::{Driver, Entry};
use motorlink_protocol::{Detail, Faults, Instant, MotorId, family::Model};

use crate::viewers::Viewers;

/// How often the driver is asked what it does with the motors, while a client is there. An event asks at once.
const ASK_EVERY: Duration = Duration::from_millis(10);

/// One revolution a minute, in rad/s.
const RAD_PER_S: f32 = std::f32::consts::TAU / 60.0;
/// One step of the angle in the reply to a query, in rad, with a fifth more for rounding.
const COARSE_RAD: f64 = 1.2 / 255.0 * TAU;
/// How long a fine angle counts more than a coarse one: ten drive frames.
const FINE_FOR: Duration = Duration::from_millis(200);

/// Without a reply for this long, speed and current are unknown, as everywhere.
const FRESH_FOR: Duration = Duration::from_millis(500);

/// A measured value, and when its reply came, by the driver's clock.
pub(crate) type Measured<T> = Option<(Instant, T)>;

/// The value, unless its reply is too old.
pub(super) fn fresh<T>(value: Measured<T>, now: Option<Instant>) -> Measured<T> {
    value.filter(|(at, _)| now.is_some_and(|now| now.since(*at) <= FRESH_FOR))
}

/// The newest state of the port and of every motor.
#[derive(Clone, Debug, Default)]
pub(crate) struct Snapshot {
    pub(crate) is_open: bool,
    pub(crate) is_halted: bool,
    /// The model of the motors, once their replies have shown it.
    pub(crate) model: Option<Model>,
    pub(crate) motors: BTreeMap<MotorId, Motor>,
    /// A time of the driver, and when it was read by our clock.
    clock: Option<(Instant, Moment)>,
}

/// The newest state of a motor.
#[derive(Clone, Debug)]
pub(crate) struct Motor {
    /// What the bus does with it.
    pub(crate) status: MotorStatus,
    pub(crate) replied: Option<Instant>,
    pub(crate) faults: Option<Faults>,
    /// In rad, positive in the direction of positive speed.
    pub(crate) position: Measured<f64>,
    /// In rad/s.
    pub(crate) velocity: Measured<f32>,
    /// In A.
    pub(crate) current: Measured<f32>,
    /// In degrees Celsius.
    pub(crate) temperature: Measured<f32>,
}

impl Snapshot {
    /// The present time of the driver; `None` before its first state.
    pub(crate) fn now(&self) -> Option<Instant> {
        let (at, seen) = self.clock?;
        Some(at + seen.elapsed())
    }

    fn motor(&mut self, id: MotorId) -> &mut Motor {
        let new = || Motor::unknown(id);
        self.motors.entry(id).or_insert_with(new)
    }
}

impl Motor {
    fn unknown(id: MotorId) -> Self {
        Self {
            status: MotorStatus::unknown(id),
            replied: None,
            faults: None,
            position: None,
            velocity: None,
            current: None,
            temperature: None,
        }
    }

    /// Takes a reply. A value that it does not have keeps its own time.
    fn take(&mut self, sample: &Sample, turns: &mut TurnCounter) {
        let Sample { at, reply } = sample;
        turns.record(*at, reply);
        self.replied = Some(*at);
        self.faults = Some(reply.faults);
        if let Some(speed) = reply.speed {
            self.velocity = Some((*at, f32::from(speed.rpm()) * RAD_PER_S));
        }
        if let Some(current) = reply.current {
            self.current = Some((*at, current.amps()));
        }
        let position = turns.unrounded().map(|turns| turns * TAU);
        match reply.detail {
            Detail::Drive { .. } | Detail::Odometry { .. } => {
                self.position = position.map(|position| (*at, position));
            }
            Detail::Query { temperature, .. } => {
                self.temperature = Some((*at, temperature.degrees().into()));
                // Its angle is coarse. It counts where nothing finer is new, and it shows that the wheel has moved.
                let counted = position.unwrap_or_default();
                let is_news = |(fine_at, fine): (Instant, f64)| {
                    at.since(fine_at) > FINE_FOR && (fine - counted).abs() > COARSE_RAD
                };
                if self.position.is_none_or(is_news) {
                    self.position = Some((*at, counted));
                }
            }
            Detail::Temperature(temperature) => {
                self.temperature = Some((*at, temperature.degrees().into()));
            }
            Detail::Undetermined(_) => {}
        }
    }
}

/// Follows the driver, and tells the clients.
#[derive(Debug)]
pub(crate) struct Feed {
    viewers: Viewers,
    snapshot: Snapshot,
    turns: BTreeMap<MotorId, TurnCounter>,
    asked: Moment,
    is_due: bool,
}

impl Feed {
    pub(crate) fn new(viewers: Viewers) -> Self {
        Self {
            viewers,
            snapshot: Snapshot::default(),
            turns: BTreeMap::new(),
            asked: Moment::now(),
            is_due: true,
        }
    }

    /// Takes an entry of the driver.
    pub(crate) fn take(&mut self, entry: &Entry) {
        match entry {
            Entry::Event(Event::Line(_)) => {}
            Entry::Event(Event::Telemetry(sample)) => {
                let id = sample.reply.id;
                let turns = self.turns.entry(id).or_default();
                self.snapshot.motor(id).take(sample, turns);
                self.tell();
            }
            entry => {
                self.is_due = true;
                if let Some((of, why)) = end_reason(entry) {
                    self.viewers
                        .operate(|operation, _| operation.may_end(of, why));
                }
            }
        }
    }

    /// Does what is due.
    pub(crate) fn turn(&mut self, driver: &Driver) {
        if !self.has_clients() {
            // The next client waits for a state of its time.
            if self.snapshot.clock.take().is_some() {
                self.viewers.snapshot().send_replace(Arc::default());
            }
            return;
        }
        let now = Moment::now();
        if !self.is_due && now < self.asked + ASK_EVERY && self.snapshot.clock.is_some() {
            return;
        }
        // The driver has ended, or stalls: the ages grow.
        let Some(status) = self.viewers.ask(driver) else {
            return;
        };
        (self.asked, self.is_due) = (now, false);
        self.snapshot.clock = Some((status.now, now));
        self.snapshot.is_open = status.is_open;
        self.snapshot.is_halted = status.is_halted;
        let is_known = status.line.is_some_and(|line| line.model_known);
        self.snapshot.model = is_known.then(|| driver.model());
        if status.is_open {
            // A motor that is not watched any more is not known.
            self.snapshot
                .motors
                .retain(|id, _| status.motor(*id).is_some());
        }
        for motor in &status.motors {
            self.snapshot.motor(motor.id).status = *motor;
        }
        self.tell();
    }

    fn tell(&self) {
        if self.has_clients() {
            let newest = Arc::new(self.snapshot.clone());
            self.viewers.snapshot().send_replace(newest);
        }
    }

    fn has_clients(&self) -> bool {
        self.viewers.snapshot().receiver_count() > 0
    }
}

/// Why the drive of a controller may have ended, by this entry, and whose motor shows it.
fn end_reason(entry: &Entry) -> Option<(Option<MotorId>, EndReason)> {
    Some(match entry {
        Entry::Event(Event::Withdrawn { id, reason }) => {
            let why = match reason {
                WithdrawReason::Silent => EndReason::Silent,
                WithdrawReason::Fault(_) => EndReason::Fault,
                WithdrawReason::Limit(_) => EndReason::Limit,
                WithdrawReason::OtherLoop { .. }
                | WithdrawReason::NotEnabled
                | WithdrawReason::TemperatureUnknown
                | WithdrawReason::AngleMisfits => EndReason::OtherWithdrawal,
            };
            (Some(*id), why)
        }
        Entry::Event(Event::NotStarted { id, .. }) => (Some(*id), EndReason::NotStarted),
        Entry::Refused {
            command: motorlink_bus::CommandKind::DriveGroup,
            ..
        }
        | Entry::TooLate(_)
        | Entry::NotConnected(_) => (None, EndReason::NotStarted),
        Entry::Event(Event::StopBegan(reason)) => match reason {
            StopReason::Operator => (None, EndReason::Stopped),
            // A start may begin with it, and the end of a lease has its own reason.
            StopReason::OneMotor | StopReason::OperatorLost => return None,
            _ => (None, EndReason::ServerStopped),
        },
        Entry::PortLost { .. } => (None, EndReason::PortLost),
        _ => return None,
    })
}
