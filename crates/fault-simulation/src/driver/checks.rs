//! The checks of the rules.

use std::time::Duration;

use motorlink_driver::Ending;
use motorlink_protocol::{Instant, Mode};
use motorlink_simulator::{VirtualMotor, World};

use super::{
    rule::{DriverRule, Outcome, STANDS_WITHIN},
    rules::{Disk, LineState, Rules, is_driven, is_moved, is_named, must_be_named},
};
use crate::rule::broken;

/// A motor that was silent during its stop is asked at least so often.
const LOOKED_FOR_WITHIN: Duration = Duration::from_secs(1);
/// An opening ends within this: three models and a stop for each, then the opening itself.
const OPENS_WITHIN: Duration = Duration::from_secs(10);
/// A driver ends within this, whatever its port does.
const ENDS_WITHIN: Duration = Duration::from_secs(6);
/// A loss is told within this.
const LOSS_TOLD_WITHIN: Duration = Duration::from_millis(700);
/// A port that is back, and on which no stop runs, is open within this: a pause, and a search for the model.
const BACK_WITHIN: Duration = Duration::from_secs(4);
/// A status is answered within this.
const STATUS_WITHIN: Duration = Duration::from_secs(1);
/// A frame that was on its way, or in the memory of the adapter.
const ON_ITS_WAY: Duration = Duration::from_millis(20);

impl Rules {
    /// Time has passed.
    pub(super) fn check(
        &mut self,
        now: Instant,
        world: &World,
        port_is_well: bool,
        file: &[u8],
    ) -> Outcome {
        let is_well = port_is_well && now > self.last_frozen;
        self.well_since = is_well.then(|| self.well_since.unwrap_or(now));
        for motor in world.motors() {
            self.check_motor(now, motor, file)?;
        }
        self.check_driver(now)
    }

    fn check_motor(&mut self, now: Instant, motor: &VirtualMotor, file: &[u8]) -> Outcome {
        let id = motor.id();
        if !is_moved(motor) {
            self.forgotten.remove(&id);
            if let Some((rule, since)) = self.must_stand.get(&id).copied()
                && now > since
            {
                self.must_stand.remove(&id);
                self.judge(rule);
            }
            return Ok(());
        }
        if is_driven(motor) && motor.obeyed().is_some_and(|(at, _)| at > self.started) {
            // This process knows it.
            self.forgotten.remove(&id);
        }
        if let Some(well) = self.well_since
            && let Some((rule, since)) = self.must_stand.get(&id).copied()
            && now > since.max(well) + stands_within(since, well)
        {
            let what = format!(
                "{id} turns at {} rpm by {:?}, since {since:?}, and the port is well since {well:?}",
                motor.speed_rpm(),
                motor.obeyed()
            );
            return broken(rule, now, what);
        }
        if must_be_named(motor) && !self.forgotten.contains(&id) {
            self.judge(DriverRule::IsRemembered);
            if self.disk != Disk::FullAndTold && !is_named(file, id) {
                let what = format!(
                    "{id} turns at {} rpm by {:?}",
                    motor.speed_rpm(),
                    motor.obeyed()
                );
                return broken(DriverRule::IsRemembered, now, what);
            }
        }
        if let Some((received, drive)) = motor.obeyed()
            && motor.mode() != Mode::Position
            && drive.signed() != 0
        {
            let let_go = self.let_go.get(&id).copied().unwrap_or(self.started);
            if self.asked.contains(&id) {
                self.judge(DriverRule::DrivenByProgramOnly);
            } else if received > let_go + ON_ITS_WAY {
                let what = format!("{id} obeys {drive:?} of {received:?}, let go since {let_go:?}");
                return broken(DriverRule::DrivenByProgramOnly, now, what);
            }
        }
        Ok(())
    }

    fn check_driver(&mut self, now: Instant) -> Outcome {
        let late = |since: Instant, within| now > since.max(self.last_frozen) + within;
        if self.line == LineState::Opening && late(self.started, OPENS_WITHIN) {
            return broken(DriverRule::OpensInTime, now, "it is still opening");
        }
        if self.ends.is_some_and(|since| late(since, ENDS_WITHIN)) {
            return broken(DriverRule::EndsInTime, now, "it still runs");
        }
        if self.ends.is_none() && self.lost.is_some_and(|since| late(since, LOSS_TOLD_WITHIN)) {
            return broken(DriverRule::LossIsTold, now, "the loss is not told");
        }
        let is_lost = self.line == LineState::Lost && self.ends.is_none();
        let is_well_since = self.well_since.map(|since| since.max(self.last_stop));
        if is_lost && is_well_since.is_some_and(|since| late(since, BACK_WITHIN)) {
            return broken(DriverRule::ComesBack, now, "the port is not open again");
        }
        if let Some((asked, answer)) = &self.status {
            if answer.try_recv().is_ok() {
                self.status = None;
                self.judge(DriverRule::StatusIsAnswered);
            } else if late(*asked, STATUS_WITHIN) {
                return broken(DriverRule::StatusIsAnswered, now, "no status");
            }
        }
        Ok(())
    }

    /// The process has ended by itself.
    pub(super) fn ended(
        &mut self,
        now: Instant,
        ending: &Ending,
        world: &World,
        was_open: bool,
    ) -> Outcome {
        if ending.has_failed && self.failures == 0 {
            return broken(DriverRule::EndingIsTrue, now, "it failed by itself");
        }
        if !was_open {
            return Ok(());
        }
        let Some(ends) = self.ends.take() else {
            return broken(DriverRule::EndingIsTrue, now, "nobody has ended it");
        };
        self.judge(DriverRule::EndsInTime);
        for motor in world.motors() {
            let id = motor.id();
            if must_be_named(motor) && !self.forgotten.contains(&id) {
                self.judge(DriverRule::EndingIsTrue);
                if !ending.may_turn.contains(&id) {
                    let what = format!("{id} turns at {} rpm: {ending:?}", motor.speed_rpm());
                    return broken(DriverRule::EndingIsTrue, now, what);
                }
            }
        }
        let is_well = self.well_since.is_some_and(|since| since <= ends);
        if is_well && self.failures == 1 {
            let turns = |motor: &&VirtualMotor| {
                is_moved(motor) && self.must_stand.contains_key(&motor.id())
            };
            if let Some(motor) = world.motors().find(turns) {
                let what = format!("{} turns at {} rpm", motor.id(), motor.speed_rpm());
                return broken(DriverRule::FailureStops, now, what);
            }
        }
        // Nothing can be stopped on a port that is lost, or was opened for another model while it was stalled.
        if is_well && self.line == LineState::Open && !self.was_of_other_model && self.failures == 0
        {
            self.judge(DriverRule::EndsAtRest);
            if !ending.may_turn.is_empty() {
                return broken(DriverRule::EndsAtRest, now, format!("{ending:?}"));
            }
        }
        Ok(())
    }
}

/// How long a motor may turn that must stand.
fn stands_within(since: Instant, well: Instant) -> Duration {
    if well > since {
        // It has not answered the first stop.
        LOOKED_FOR_WITHIN + STANDS_WITHIN
    } else {
        STANDS_WITHIN
    }
}
