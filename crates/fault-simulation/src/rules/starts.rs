//! What must become of a start: the loop first, then the drive, in time; or a word why not.

use std::{
    collections::{BTreeMap, BTreeSet},
    time::Duration,
};

use motorlink_bus::{Activity, Bus, Event};
use motorlink_protocol::{Instant, MotorId, Setpoint};
use motorlink_simulator::{VirtualMotor, World};

use crate::rule::{Rule, Violation, broken};

/// On a good line a start has ended this long after its stop began: the stop, five mode switches and their confirmation.
const ENDS_WITHIN: Duration = Duration::from_millis(2_500);

/// The starts that wait for a stop or a mode switch.
#[derive(Debug, Default)]
pub(super) struct Starts {
    /// With the time of the command, or of the stop that was joined last.
    waiting: BTreeMap<MotorId, Instant>,
    /// Motors whose first drive frame is still to come.
    first: BTreeMap<MotorId, Setpoint>,
    /// The motors of each group that was started last, with their setpoints.
    groups: Vec<Vec<(MotorId, Setpoint)>>,
    /// Motors of which an event of this moment has said that they are not driven.
    said: BTreeSet<MotorId>,
}

impl Starts {
    /// A person started these motors, as a group if there are several.
    pub(super) fn asked(&mut self, now: Instant, parts: &[(MotorId, Setpoint)]) {
        self.asked_otherwise(|id| parts.iter().any(|(part, _)| part == id));
        self.waiting.extend(parts.iter().map(|(id, _)| (*id, now)));
        self.first.extend(parts.iter().copied());
        self.groups.push(parts.to_vec());
    }

    pub(super) fn waits(&self, id: MotorId) -> bool {
        self.waiting.contains_key(&id)
    }

    /// A person asked for something else of these motors.
    pub(super) fn asked_otherwise(&mut self, is_asked: impl Fn(&MotorId) -> bool) {
        self.first.retain(|id, _| !is_asked(id));
        self.waiting.retain(|id, _| !is_asked(id));
        self.groups
            .retain(|parts| !parts.iter().any(|(id, _)| is_asked(id)));
    }

    /// The motors that are started with this one, and it.
    fn group_of(&self, id: MotorId) -> &[(MotorId, Setpoint)] {
        let mut groups = self.groups.iter();
        let group = groups.find(|parts| parts.iter().any(|(part, _)| *part == id));
        group.map_or(&[], Vec::as_slice)
    }

    pub(super) fn on_event(&mut self, now: Instant, event: &Event) {
        match event {
            Event::StopBegan(_) => {
                self.said.extend(self.waiting.keys());
                for since in self.waiting.values_mut() {
                    *since = now;
                }
            }
            Event::NotStarted { id, .. }
            | Event::Withdrawn { id, .. }
            | Event::ModeSwitchFailed { id, .. } => {
                let ended: Vec<_> = self.group_of(*id).iter().map(|(id, _)| *id).collect();
                self.said.extend(ended);
            }
            _ => {}
        }
    }

    /// A frame drives this motor. Returns whether it was the first of a start.
    pub(super) fn drives(
        &mut self,
        now: Instant,
        id: MotorId,
        is_healthy: bool,
        bus: &Bus,
        world: &World,
    ) -> Result<bool, Violation> {
        if self.first.remove(&id).is_none() {
            return Ok(false);
        }
        for (part, setpoint) in self.group_of(id) {
            let mut motors = bus.motors(now).filter(|status| status.id == *part);
            let activity = motors.next().map(|status| status.activity);
            if !matches!(activity, Some(Activity::Driven { .. })) {
                let what = format!("{id} is driven, and {part} is not: {activity:?}");
                return broken(Rule::StartEnds, now, what);
            }
            // On a bad line the motor may have lost power since it reported the loop.
            let mode = world.motor(*part).and_then(VirtualMotor::active_mode);
            if is_healthy && mode.is_some_and(|mode| mode != setpoint.mode()) {
                let what = format!("{id} is driven, and {part} to {setpoint:?} in {mode:?}");
                return broken(Rule::StartEnds, now, what);
            }
        }
        Ok(true)
    }

    /// All events of this moment are out. Returns how many starts have ended.
    pub(super) fn settled(
        &mut self,
        now: Instant,
        healthy_since: Option<Instant>,
        bus: &Bus,
    ) -> Result<u64, Violation> {
        let said = std::mem::take(&mut self.said);
        let mut ended = Vec::new();
        for status in bus.motors(now) {
            let id = status.id;
            let Some(since) = self.waiting.get(&id) else {
                continue;
            };
            if status.waiting.is_some() {
                let is_late = |healthy: Instant| now > (*since).max(healthy) + ENDS_WITHIN;
                if healthy_since.is_some_and(is_late) {
                    let what = format!("{id} waits since {since:?} on a good line");
                    return broken(Rule::StartEnds, now, what);
                }
                continue;
            }
            let is_driven = matches!(status.activity, Activity::Driven { .. });
            if !is_driven && !said.contains(&id) {
                let what = format!("{id} is not driven, and no event says why");
                return broken(Rule::StartEnds, now, what);
            }
            ended.push(id);
        }
        for id in &ended {
            self.waiting.remove(id);
        }
        Ok(u64::try_from(ended.len()).unwrap_or_default())
    }
}
