//! What must happen on a healthy line: a stop brakes in time and ends confirmed, also of what was left driven when the
//! port was lost or the line died.

use std::{
    collections::{BTreeMap, BTreeSet},
    time::Duration,
};

use motorlink_bus::{Activity, Bus, FIRST_BRAKE_MAX, StopReport};
use motorlink_protocol::{Instant, Mode, MotorId};
use motorlink_simulator::{VirtualMotor, World};

use crate::rule::{Outcome, Rule, Violation, broken};

/// A stop ends within this, and every motor of it has confirmed.
const CONFIRMS_WITHIN: Duration = Duration::from_millis(1_500);
/// A silent motor that may turn is asked at least so often: its line may have died.
const LOOKED_FOR_WITHIN: Duration = Duration::from_secs(1);
/// After a faulty line becomes healthy, held bytes have arrived within this time.
const LINE_CLEARS: Duration = Duration::from_millis(250);
/// Below this speed a wheel stands.
const STANDS_RPM: f32 = 1.0;

/// Stops and losses, and since when nothing prevents them from ending.
#[derive(Debug, Default)]
pub(super) struct Liveness {
    line_is_good: bool,
    healthy_since: Option<Instant>,
    /// Motors that were driven when a stop began, with that time.
    unbraked: BTreeMap<MotorId, Instant>,
    /// When the last motor joined the stop that runs.
    stop_began: Option<Instant>,
    /// Motors that turned or were driven when the port was opened, and that no ended stop has named yet.
    left_driven: BTreeSet<MotorId>,
    opened: Instant,
    /// Motors that turned when a page came that knows of nothing, until they are driven or stopped here.
    unknown: BTreeSet<MotorId>,
    /// Motors that turned or were driven when a dead line passed frames again, with that time, until an ended stop names
    /// them.
    back: BTreeMap<MotorId, Instant>,
    /// Motors that a person has moved by a raw frame, and nobody has stopped since.
    moved_by_hand: BTreeSet<MotorId>,
}

impl Liveness {
    /// The line was set healthy or faulty.
    pub(super) fn line(&mut self, is_good: bool) {
        self.line_is_good = is_good;
        self.disturbed();
    }

    /// A frame, a reply or a call was lost or late.
    pub(super) fn disturbed(&mut self) {
        self.healthy_since = None;
    }

    /// The port is closed, and every stop with it.
    pub(super) fn port_lost(&mut self) {
        self.disturbed();
        self.unbraked.clear();
        self.left_driven.clear();
        self.back.clear();
        self.moved_by_hand.clear();
        self.stop_began = None;
    }

    /// The page knows of nothing that was driven.
    pub(super) fn knows_nothing(&mut self) {
        self.unknown.append(&mut self.left_driven);
    }

    /// A motor gets a new ID. If an unknown motor turns, it may be this one.
    pub(super) fn gets_address(&mut self, id: MotorId) {
        if !self.unknown.is_empty() {
            self.unknown.insert(id);
        }
    }

    /// A line that was dead passes frames again. What turns, and was driven here, has missed its stop. A wheel that rests
    /// at its goal has missed none.
    pub(super) fn line_back(&mut self, now: Instant, bus: &Bus, world: &World) {
        for status in bus.motors(now) {
            let is_at_rest = |motor: &VirtualMotor| motor.mode() == Mode::Position && !turns(motor);
            let is_moved = world
                .motor(status.id)
                .is_some_and(|motor| is_moved(motor) && !is_at_rest(motor));
            let is_let_go = matches!(status.activity, Activity::Idle | Activity::Stopping { .. });
            let has_missed_a_stop = status.may_turn && !self.moved_by_hand.contains(&status.id);
            if is_moved && is_let_go && has_missed_a_stop {
                self.back.insert(status.id, now);
            }
        }
    }

    /// The port is open. What turns was left driven.
    pub(super) fn port_opened(&mut self, now: Instant, world: &World) {
        let left = world.motors().filter(|motor| is_moved(motor));
        let left = left.map(VirtualMotor::id);
        self.left_driven = left.filter(|id| !self.unknown.contains(id)).collect();
        self.opened = now;
    }

    /// Since when nothing prevents a stop from ending.
    pub(super) const fn healthy_since(&self) -> Option<Instant> {
        self.healthy_since
    }

    /// A stop of these motors began, or they joined one.
    pub(super) fn stop_begins(&mut self, now: Instant, driven: &[MotorId]) {
        self.stop_began = Some(now);
        for id in driven {
            self.unbraked.entry(*id).or_insert(now);
        }
    }

    /// A person asked for something else of these motors, which ends the wait for a brake. What turned before is unknown
    /// here until a frame goes out: the page may crash before.
    pub(super) fn asked(&mut self, is_asked: impl Fn(&MotorId) -> bool) {
        self.unbraked.retain(|id, _| !is_asked(id));
        self.moved_by_hand.retain(|id| !is_asked(id));
    }

    /// A person sends a raw frame that may move these motors.
    pub(super) fn sent_by_hand(&mut self, may_move: impl Iterator<Item = MotorId>) {
        self.moved_by_hand.extend(may_move);
    }

    /// A stop has ended. Returns the rules that were applied.
    pub(super) fn stop_ended(
        &mut self,
        now: Instant,
        report: &StopReport,
    ) -> Result<Vec<Rule>, Violation> {
        let began = self.stop_began.take();
        let mut judged = Vec::new();
        let is_healthy = self.healthy_since.is_some_and(|since| {
            began.is_some_and(|began| since <= began) || now.since(since) > CONFIRMS_WITHIN
        });
        for outcome in &report.motors {
            self.unbraked.remove(&outcome.id);
            self.unknown.remove(&outcome.id);
            self.moved_by_hand.remove(&outcome.id);
            if self.left_driven.remove(&outcome.id) {
                judged.push(Rule::StoppedAfterALoss);
            }
            if self.back.remove(&outcome.id).is_some() {
                judged.push(Rule::StoppedAfterADeadLine);
            }
            if is_healthy {
                judged.push(Rule::StopsConfirm);
            }
            if is_healthy && !outcome.confirmed {
                let what = format!("{} is unconfirmed on a good line", outcome.id);
                return broken(Rule::StopsConfirm, now, what);
            }
        }
        Ok(judged)
    }

    /// A frame goes out to this motor that may move its wheel; `by_hand` if a person has written it.
    pub(super) fn drives(&mut self, now: Instant, id: MotorId, by_hand: bool) -> Outcome {
        self.unknown.remove(&id);
        if !by_hand && self.back.contains_key(&id) {
            let what = format!("{id} is driven before it has been stopped");
            return broken(Rule::StoppedAfterADeadLine, now, what);
        }
        match self.left_driven.first() {
            Some(id) => {
                let what = format!("a motor is driven before {id} has been stopped");
                broken(Rule::StoppedAfterALoss, now, what)
            }
            None => Ok(()),
        }
    }

    /// All events of this moment are out.
    pub(super) fn settled(
        &mut self,
        now: Instant,
        bus: &Bus,
        world: &World,
    ) -> Result<Vec<Rule>, Violation> {
        // A motor that is not enabled obeys no brake, and has no loop to confirm.
        let is_well =
            |motor: &VirtualMotor| motor.active_mode().is_some() && motor.fault_byte() == 0;
        // A motor that answers to another address now never answers to the one that the bus asks.
        let is_there = |id: MotorId| world.motor(id).is_some();
        let is_healthy = self.line_is_good
            && world.motors().all(is_well)
            && bus.motors(now).all(|status| is_there(status.id));
        if !is_healthy {
            self.disturbed();
            return Ok(Vec::new());
        }
        let healthy = *self.healthy_since.get_or_insert(now + LINE_CLEARS);
        let judged = self.brakes(now, healthy, world)?;
        let is_over = |began: Instant| now > began.max(healthy) + CONFIRMS_WITHIN;
        if let Some(began) = self.stop_began.filter(|began| is_over(*began)) {
            let what = format!("the stop of {began:?} has not ended on a good line");
            return broken(Rule::StopsConfirm, now, what);
        }
        if let Some(id) = self.left_driven.first().filter(|_| is_over(self.opened)) {
            let rpm = world.motor(*id).map(VirtualMotor::speed_rpm);
            let what = format!("{id} was left driven, is in no report, and turns at {rpm:?} rpm");
            return broken(Rule::StoppedAfterALoss, now, what);
        }
        // A scan asks the motor in its turn.
        if bus.job().is_some() {
            for since in self.back.values_mut() {
                *since = now;
            }
        }
        let is_late = |since: Instant| is_over(since + LOOKED_FOR_WITHIN);
        if let Some((id, since)) = self.back.iter().find(|(_, since)| is_late(**since)) {
            let rpm = world.motor(*id).map(VirtualMotor::speed_rpm);
            let what =
                format!("{id} is back since {since:?}, not stopped, and turns at {rpm:?} rpm");
            return broken(Rule::StoppedAfterADeadLine, now, what);
        }
        Ok(judged)
    }

    fn brakes(
        &mut self,
        now: Instant,
        healthy: Instant,
        world: &World,
    ) -> Result<Vec<Rule>, Violation> {
        let mut judged = Vec::new();
        self.unbraked.retain(|id, began| {
            let motor = world.motor(*id).filter(|it| it.mode() == Mode::Velocity);
            let is_braked = motor
                .and_then(VirtualMotor::obeyed)
                .is_some_and(|(received, drive)| received >= *began && drive.brakes());
            if is_braked {
                judged.push(Rule::FirstBrakeInTime);
            }
            !is_braked
        });
        let is_late = |began: &Instant| now > (*began).max(healthy) + FIRST_BRAKE_MAX;
        match self.unbraked.iter().find(|(_, began)| is_late(began)) {
            Some((id, began)) => {
                let mode = world.motor(*id).map(VirtualMotor::mode);
                let what = format!("{id} has no brake of the stop of {began:?}, in {mode:?}");
                broken(Rule::FirstBrakeInTime, now, what)
            }
            None => Ok(judged),
        }
    }
}

/// Whether a motor turns, or does what a frame asks that is no rest.
fn is_moved(motor: &VirtualMotor) -> bool {
    let is_asked = motor.is_driven()
        && (motor.mode() == Mode::Position
            || motor.obeyed().is_some_and(|(_, drive)| drive.signed() != 0));
    is_asked || turns(motor)
}

fn turns(motor: &VirtualMotor) -> bool {
    motor.speed_rpm().abs() >= STANDS_RPM
}
