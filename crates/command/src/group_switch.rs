//! Switches the motors of a group before they are started: the bus starts a group in the loop in which its motors are.

use std::time::{Duration, Instant};

use motorlink_bus::{Activity, Command, Event, MotorStatus};
use motorlink_driver::Entry;
use motorlink_protocol::{Mode, MotorId, Setpoint};

use crate::{
    connection::{Connection, Happened, is_not_done},
    failure::Failure,
    signed_id::SignedId,
    words,
};

/// How long it may take: a stop, and five switches with a reply to each.
const SWITCHED_MAX: Duration = Duration::from_secs(7);

/// The switch of the motors of a group: what is driven in another loop, or turns, is stopped first. It drives nothing.
pub struct GroupSwitch {
    motors: Vec<MotorId>,
    to: Mode,
    /// How far it is.
    stage: Stage,
    /// Stops that have begun so far, with its own. One more is that of a person, or of a motor: it ends the start.
    stops: Option<u64>,
    until: Instant,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Nothing was asked for yet.
    First,
    /// The motors are being stopped.
    Stops,
    /// They are being switched.
    Switches,
}

impl GroupSwitch {
    /// For these motors and this setpoint. `None` where none is needed: a motor alone is switched by its start, and a group
    /// is in the velocity loop after its stop.
    #[must_use]
    pub fn of(motors: &[SignedId], setpoint: Setpoint) -> Option<Self> {
        let to = setpoint.mode();
        (motors.len() > 1 && to != Mode::Velocity).then(|| Self {
            motors: motors.iter().map(|motor| motor.id).collect(),
            to,
            stage: Stage::First,
            stops: None,
            until: Instant::now() + SWITCHED_MAX,
        })
    }

    /// Goes on, and takes an entry within this time. Returns whether all motors are in the loop.
    ///
    /// # Errors
    /// A motor does not stop or switch in time, another stop has ended it, or the program ends.
    pub fn step(&mut self, connection: &Connection, within: Duration) -> Result<bool, Failure> {
        let status = connection.status()?;
        // Another thread may have taken the entry of a stop. The status counts every stop.
        let stops = *self.stops.get_or_insert(status.stops_begun);
        if status.stops_begun > stops {
            connection.check_not_ended()?;
            return Err(not_done("a stop has ended the start"));
        }
        let motors = self.motors.iter().filter_map(|id| status.motor(*id));
        let is_in_it = |motor: &MotorStatus| motor.last.is_some_and(|it| it.reply.mode == self.to);
        let is_driven_in_it = |motor: &MotorStatus| matches!(motor.activity, Activity::Driven { setpoint } if setpoint.mode() == self.to);
        let is_underway = |motor: &MotorStatus| {
            matches!(
                motor.activity,
                Activity::Stopping { .. } | Activity::Switching { .. }
            )
        };
        // Its stop may have begun a moment after the status.
        let waits = self.stage == Stage::Stops && status.stops_begun < stops;
        if waits || motors.clone().any(is_underway) {
            return self.wait(connection, within);
        }
        let may_turn = |motor: &&MotorStatus| {
            let turns = motor.may_turn || motor.turns_unasked || motor.activity != Activity::Idle;
            turns && !is_driven_in_it(motor)
        };
        if let Some(motor) = motors.clone().find(may_turn) {
            if self.stage != Stage::First {
                let text = format!("motor {} did not confirm that it stands", motor.id);
                return Err(Failure::NotDone(text));
            }
            self.stage = Stage::Stops;
            for motor in motors.filter(may_turn) {
                self.stops = self.stops.map(|stops| stops + 1);
                connection.driver.command(Command::Stop(motor.id));
            }
            return self.wait(connection, within);
        }
        let mode = self.to;
        let mut others = motors.filter(|motor| !is_in_it(motor) && !is_driven_in_it(motor));
        let to_switch: Vec<MotorId> = others.by_ref().map(|motor| motor.id).collect();
        if to_switch.is_empty() {
            return Ok(true);
        }
        if self.stage != Stage::Switches {
            self.stage = Stage::Switches;
            for id in to_switch {
                connection.driver.command(Command::SwitchMode { id, mode });
            }
        }
        self.wait(connection, within)
    }

    fn wait(&self, connection: &Connection, within: Duration) -> Result<bool, Failure> {
        if Instant::now() > self.until {
            let text = format!("the motors did not switch to the {} in time", self.to);
            return Err(Failure::NotDone(text));
        }
        match connection.next_within(within)? {
            Happened::Entry(_, entry) if ends(&entry) => {
                // Where no program listens, it is printed already.
                let text = words::of_entry(&entry).filter(|_| !connection.shows_progress());
                Err(not_done(
                    text.as_deref().unwrap_or("the motors were not switched"),
                ))
            }
            Happened::Entry(..) | Happened::Nothing => Ok(false),
        }
    }
}

fn ends(entry: &Entry) -> bool {
    matches!(
        entry,
        Entry::Event(Event::ModeSwitchFailed { .. }) | Entry::PortLost { .. }
    ) || is_not_done(entry)
}

fn not_done(text: &str) -> Failure {
    Failure::NotDone(text.to_owned())
}
