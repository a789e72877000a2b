//! From commands to the motors: when they are armed, moved and stopped.
//!
//! A command that moves the robot arms the motors. What ends a drive, other than commands that cease, ends it for as long as somebody
//! goes on asking: **before the next drive, no command that moves the robot may come for 2 s.** A program that publishes for ever, or a
//! stick that is held, drives nothing after a STOP, a fault, a takeover, an emergency stop, or a restart of this program.

use std::time::{Duration, Instant};

use motorlink_controller_messages::{
    DriveState, EndReason, FromClient, NotArmed, Setpoints, State,
};
use motorlink_protocol::MotorId;

use crate::{cmd_vel::CmdVel, rover::Rover};

/// Motors that turn are stopped first, and switched to another loop. After so long, it has failed.
const START_MAX: Duration = Duration::from_secs(5);

/// A program that was late by so much was frozen: what has come meanwhile is not known yet.
const FROZEN: Duration = Duration::from_millis(100);

/// Decides what motorlink is told.
#[derive(Debug)]
pub struct Drive {
    phase: Phase,
    /// The number of the newest ARM.
    number: u32,
    /// Since when nobody may ask, before the next drive.
    must_rest: Option<Instant>,
    /// When it was ended, if nothing was driven since.
    ended: Option<Instant>,
    stepped: Instant,
    is_e_stopped: bool,
    why: Why,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Idle,
    Starting { since: Instant },
    Driving,
    Stopping,
}

/// Why nothing is driven.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Why {
    /// Nobody asks.
    NotAsked,
    /// motorlink has not started the motors.
    Refused(NotArmed),
    /// motorlink has ended the drive.
    Ended(EndReason),
    /// The motors were not started in time.
    NotInTime,
    /// There is no connection to motorlink.
    NoConnection,
    /// An emergency stop, and no reset since.
    EStop,
    /// A value of a command was no speed.
    NoSpeed,
    /// The clock of a sender was set.
    ClockSet,
    /// This program or the computer was frozen or slept.
    Frozen,
}

impl std::fmt::Display for Why {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotAsked => f.write_str("nobody asks it to move"),
            Self::Refused(why) => why.fmt(f),
            Self::Ended(why) => why.fmt(f),
            Self::NotInTime => f.write_str("the motors were not started in time"),
            Self::NoConnection => f.write_str("no connection to motorlink"),
            Self::EStop => f.write_str("emergency stop"),
            Self::NoSpeed => f.write_str("a command had a value that is no speed"),
            Self::ClockSet => f.write_str("the clock of a sender was set, or the network is slow"),
            Self::Frozen => f.write_str("the program or the computer was frozen"),
        }
    }
}

impl Drive {
    /// At the start of the program.
    #[must_use]
    pub const fn new(now: Instant) -> Self {
        Self {
            phase: Phase::Idle,
            number: 0,
            must_rest: Some(now),
            ended: Some(now),
            stepped: now,
            is_e_stopped: false,
            why: Why::NotAsked,
        }
    }

    /// Whether the motors are driven, and if not, why.
    ///
    /// # Errors
    ///
    /// Why they are not.
    pub const fn is_driving(&self) -> Result<(), Why> {
        match self.phase {
            Phase::Driving => Ok(()),
            _ if self.is_e_stopped => Err(Why::EStop),
            _ => Err(self.why),
        }
    }

    /// Whether nothing is driven, started or stopped.
    #[must_use]
    pub const fn is_idle(&self) -> bool {
        matches!(self.phase, Phase::Idle)
    }

    /// Whether the robot waits for the end of commands before it drives.
    #[must_use]
    pub const fn must_rest(&self) -> bool {
        self.must_rest.is_some()
    }

    /// Emergency stop: nothing is driven before a reset.
    pub const fn e_stop(&mut self) {
        self.is_e_stopped = true;
    }

    /// Ends an emergency stop. Starts nothing.
    pub const fn reset(&mut self, now: Instant) {
        self.is_e_stopped = false;
        self.end(now, Why::NotAsked);
    }

    /// The connection is gone, and with it the drive.
    pub const fn disconnected(&mut self, now: Instant) {
        self.phase = Phase::Idle;
        self.end(now, Why::NoConnection);
    }

    /// Ends the drive. The next step stops it.
    pub const fn end(&mut self, now: Instant, why: Why) {
        self.why = why;
        self.must_rest = Some(now);
        self.ended = Some(now);
    }

    /// What motorlink is told now, by its newest state, if there is one. Call it every 10 ms.
    pub fn step(
        &mut self,
        now: Instant,
        state: Option<&State>,
        cmd_vel: &CmdVel,
        rover: &Rover,
    ) -> Option<FromClient> {
        if now.duration_since(self.stepped) > FROZEN {
            self.end(now, Why::Frozen);
        }
        self.stepped = now;
        let state = state?;
        if self
            .must_rest
            .is_some_and(|since| cmd_vel.rests(now, since))
        {
            self.must_rest = None;
        }
        let may_drive = !self.is_e_stopped && self.must_rest.is_none();
        let wanted = cmd_vel.wanted(now).filter(|_| may_drive);
        match self.phase {
            Phase::Idle => {
                let is_moved = wanted.is_some_and(|twist| {
                    let speeds = rover.speeds(&twist);
                    speeds.iter().any(|(_, speed)| *speed != 0.0)
                });
                if !is_moved {
                    return None;
                }
                if self.ended.is_some_and(|at| !cmd_vel.has_begun_since(at)) {
                    // It may have asked all the time, and nothing has come through.
                    self.must_rest = Some(now);
                    return None;
                }
                self.ended = None;
                self.number = self.number.wrapping_add(1);
                self.phase = Phase::Starting { since: now };
                Some(FromClient::Arm(self.setpoints(state, rover.at_rest())))
            }
            Phase::Starting { since } => {
                if state.arm.0 == self.number {
                    if let Some(why) = state.arm.1 {
                        self.phase = Phase::Idle;
                        self.end(now, Why::Refused(why));
                        return None;
                    }
                    if state.ended != EndReason::None {
                        return Some(self.give_up(now, Why::Ended(state.ended)));
                    }
                    if state.drive == DriveState::Driven {
                        self.phase = Phase::Driving;
                    }
                }
                if now.duration_since(since) > START_MAX {
                    return Some(self.give_up(now, Why::NotInTime));
                }
                if wanted.is_none() {
                    return Some(self.stop());
                }
                Some(FromClient::Setpoints(
                    self.setpoints(state, rover.at_rest()),
                ))
            }
            Phase::Driving => {
                if state.ended != EndReason::None {
                    return Some(self.give_up(now, Why::Ended(state.ended)));
                }
                let Some(twist) = wanted else {
                    return Some(self.stop());
                };
                let speeds = rover.speeds(&twist);
                Some(FromClient::Setpoints(self.setpoints(state, speeds)))
            }
            Phase::Stopping => {
                if !matches!(state.ended, EndReason::None | EndReason::Disarmed) {
                    self.end(now, Why::Ended(state.ended));
                }
                let is_stopping = matches!(
                    state.drive,
                    DriveState::Driven | DriveState::Starting | DriveState::Stopping
                );
                if !is_stopping {
                    self.phase = Phase::Idle;
                }
                None
            }
        }
    }

    /// Commands have ceased, or the drive was ended.
    const fn stop(&mut self) -> FromClient {
        self.phase = Phase::Stopping;
        if self.must_rest.is_none() {
            self.why = Why::NotAsked;
        }
        FromClient::Disarm
    }

    const fn give_up(&mut self, now: Instant, why: Why) -> FromClient {
        self.phase = Phase::Stopping;
        self.end(now, why);
        FromClient::Disarm
    }

    fn setpoints(&self, state: &State, speeds: Vec<(MotorId, f32)>) -> Setpoints {
        Setpoints {
            number: self.number,
            challenge: state.challenge,
            speeds,
        }
    }
}

#[cfg(test)]
#[path = "drive_tests.rs"]
mod tests;
