//! A server and the bus that it follows, over virtual time.

use std::{mem, time::Duration};

use motorlink_bus::{Activity, Command, MotorStatus, StopReason};
use motorlink_controller_messages::{DriveState, EndReason, FromClient, NotArmed, Setpoints};
use motorlink_driver::Status;
use motorlink_protocol::{Instant, MotorId, Setpoint, SpeedTarget, family::Model};
use motorlink_remote::{Participant, Stamp, ViewerId};

use super::super::{DriveReport, Operation, Output};
use crate::messages::{Act, PageRequest};

pub(super) const ONE: MotorId = MotorId::FIRST;
pub(super) const TWO: MotorId = match MotorId::new(2) {
    Ok(id) => id,
    Err(_) => MotorId::FIRST,
};
pub(super) const LOST: Command = Command::StopAll(StopReason::OperatorLost);

/// What the bus does with a motor.
#[derive(Clone, Copy)]
pub(super) enum Does {
    Drives(i32),
    Waits,
    Stops,
    Stands,
    MayTurn,
}

/// A server, and the time.
pub(super) struct World {
    pub(super) operation: Operation,
    pub(super) now: Instant,
    challenges: u64,
    sequence: u32,
}

impl World {
    pub(super) fn new() -> Self {
        Self {
            operation: Operation::default(),
            now: Instant::from_millis(5_000),
            challenges: 0,
            sequence: 0,
        }
    }

    pub(super) fn join(&mut self, kind: Participant) -> ViewerId {
        let viewer = self.operation.join(self.now, kind).unwrap();
        self.turn();
        viewer
    }

    /// A controller that drives these motors.
    pub(super) fn driving(&mut self, motors: &[MotorId]) -> ViewerId {
        let controller = self.join(Participant::Controller);
        assert_eq!(self.arm(controller, motors), None);
        let all: Vec<_> = motors.iter().map(|id| (*id, Does::Drives(0))).collect();
        self.bus(&all);
        assert_eq!(self.report(controller).drive, DriveState::Driven);
        self.given();
        controller
    }

    pub(super) fn turn(&mut self) {
        let challenges = &mut self.challenges;
        self.operation.turn(self.now, || {
            *challenges += 1;
            Some(*challenges)
        });
    }

    /// Time passes, and the lease is looked at.
    pub(super) fn pass(&mut self, ms: u64) {
        for _ in 0..ms {
            self.now = self.now + Duration::from_millis(1);
            self.turn();
        }
    }

    /// The commands for the driver since the last call.
    pub(super) fn given(&mut self) -> Vec<Command> {
        let outputs = mem::take(&mut self.operation.outputs).into_iter();
        let command = |output| match output {
            Output::Command(command) => Some(command),
            _ => None,
        };
        outputs.filter_map(command).collect()
    }

    pub(super) fn report(&self, controller: ViewerId) -> DriveReport {
        self.operation.report(controller).unwrap()
    }

    pub(super) fn ended(&self, controller: ViewerId) -> (DriveState, EndReason) {
        let report = self.report(controller);
        (report.drive, report.ended)
    }

    pub(super) fn order(&self, controller: ViewerId, speeds: &[(MotorId, f32)]) -> Setpoints {
        Setpoints {
            number: 7,
            challenge: self.report(controller).challenge,
            speeds: speeds.to_vec(),
        }
    }

    /// Returns why ARM was refused.
    pub(super) fn arm(&mut self, controller: ViewerId, motors: &[MotorId]) -> Option<NotArmed> {
        let speeds: Vec<_> = motors.iter().map(|id| (*id, 0.0)).collect();
        self.arm_by(controller, self.order(controller, &speeds))
    }

    pub(super) fn arm_by(&mut self, controller: ViewerId, order: Setpoints) -> Option<NotArmed> {
        let asks = FromClient::Arm(order);
        self.operation.controller_asks(self.now, controller, &asks);
        let (number, refused) = self.report(controller).arm;
        assert_eq!(number, 7);
        refused
    }

    pub(super) fn set(&mut self, controller: ViewerId, speeds: &[(MotorId, f32)]) {
        let asks = FromClient::Setpoints(self.order(controller, speeds));
        self.operation.controller_asks(self.now, controller, &asks);
    }

    pub(super) fn disarm(&mut self, controller: ViewerId) {
        let asks = FromClient::Disarm;
        self.operation.controller_asks(self.now, controller, &asks);
    }

    pub(super) fn page(&mut self, page: ViewerId, asks: PageRequest) {
        self.operation.page_asks(self.now, page, asks);
    }

    /// A command of a page, on its newest challenge. It was given so long ago.
    pub(super) fn page_commands(&mut self, page: ViewerId, age: Duration, command: Command) {
        let operator = self.operation.control().operator();
        self.sequence += 1;
        let stamp = Stamp {
            epoch: operator.map_or(0, |(_, epoch)| epoch),
            sequence: self.sequence,
            challenge: self.challenges,
        };
        self.page(page, PageRequest::Command(Act { stamp, age }, command));
    }

    /// The server follows this state of the bus.
    pub(super) fn bus(&mut self, motors: &[(MotorId, Does)]) {
        self.bus_since(self.operation.changes(), motors);
    }

    /// The same, by a status that was asked for after so many changes.
    pub(super) fn bus_since(&mut self, changes: u32, motors: &[(MotorId, Does)]) {
        let motors = motors.iter().map(|(id, does)| {
            let mut motor = MotorStatus::unknown(*id);
            motor.may_turn = matches!(does, Does::Drives(_) | Does::Stops | Does::MayTurn);
            motor.activity = match does {
                Does::Drives(rpm) => Activity::Driven {
                    setpoint: velocity(*rpm),
                },
                Does::Waits | Does::Stops => Activity::Stopping { confirmed: false },
                Does::Stands | Does::MayTurn => Activity::Idle,
            };
            motor.waiting = matches!(does, Does::Waits).then_some(velocity(0));
            motor
        });
        let status = Status {
            now: self.now,
            is_open: true,
            is_halted: false,
            stops_begun: 0,
            motors: motors.collect(),
            job: None,
            raw: None,
            line: None,
        };
        self.operation.follow(changes, &status, Model::Ddsm115);
    }
}

pub(super) fn velocity(rpm: i32) -> Setpoint {
    Setpoint::velocity(SpeedTarget::clamped(rpm))
}
