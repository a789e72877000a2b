//! Switches the motors of a group before they are started: the bus starts a group in the loop in which its motors are.

use std::time::{Duration, Instant};

use motorlink_bus::{Activity, Command, Event};
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

/// The switch of the motors of a group, which stops what is driven in another loop. It drives nothing.
pub struct GroupSwitch {
    motors: Vec<MotorId>,
    to: Mode,
    is_asked: bool,
    /// Stops of its own that have not begun yet. Any other one ends it.
    own_stops: u32,
    until: Instant,
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
            is_asked: false,
            own_stops: 0,
            until: Instant::now() + SWITCHED_MAX,
        })
    }

    /// Goes on, and takes an entry within this time. Returns whether all motors are in the loop.
    ///
    /// # Errors
    /// A motor does not stop or switch in time, or a person's stop has ended it.
    pub fn step(&mut self, connection: &Connection, within: Duration) -> Result<bool, Failure> {
        let status = connection.status()?;
        let mut all_stand = true;
        let mut is_underway = false;
        let mut to_switch = Vec::new();
        // One stop stops all of a group.
        let mut to_stop = None;
        for id in &self.motors {
            let motor = status.motor(*id);
            let is_in_it = motor
                .and_then(|motor| motor.last)
                .is_some_and(|last| last.reply.mode == self.to);
            match motor.map(|motor| motor.activity) {
                Some(Activity::Idle) if is_in_it => {}
                Some(Activity::Idle) => to_switch.push(*id),
                Some(Activity::Driven { setpoint }) if setpoint.mode() == self.to => {}
                Some(Activity::Driven { .. } | Activity::DrivenRaw) => {
                    all_stand = false;
                    to_stop.get_or_insert(*id);
                }
                Some(Activity::Switching { .. } | Activity::Stopping { .. }) | None => {
                    all_stand = false;
                    is_underway = true;
                }
            }
        }
        if to_switch.is_empty() && all_stand {
            return Ok(true);
        }
        if let Some(id) = to_stop.filter(|_| !is_underway && self.own_stops == 0) {
            self.own_stops += 1;
            connection.driver.command(Command::Stop(id));
        }
        if all_stand && !self.is_asked {
            self.is_asked = true;
            let mode = self.to;
            for id in to_switch {
                connection.driver.command(Command::SwitchMode { id, mode });
            }
        }
        if Instant::now() > self.until {
            let text = format!("the motors did not switch to the {} in time", self.to);
            return Err(Failure::NotDone(text));
        }
        match connection.next_within(within)? {
            Happened::Entry(_, entry) if self.ends(&entry) => {
                let text = words::of_entry(&entry);
                let text = text.unwrap_or_else(|| "a stop has ended the start".to_owned());
                Err(Failure::NotDone(text))
            }
            Happened::Entry(..) | Happened::Nothing => Ok(false),
        }
    }

    fn ends(&mut self, entry: &Entry) -> bool {
        match entry {
            Entry::Event(Event::StopBegan(_)) if self.own_stops > 0 => {
                self.own_stops -= 1;
                false
            }
            Entry::Event(Event::StopBegan(_) | Event::ModeSwitchFailed { .. })
            | Entry::PortLost { .. } => true,
            entry => is_not_done(entry),
        }
    }
}
