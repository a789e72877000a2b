//! Who may drive by this server, and what becomes of what a controller drives: a state machine without I/O.
//! [`Viewers::operate`](super::Viewers::operate) tells it the time and what happens, and carries out its outputs.
//!
//! | module | what it holds |
//! |---|---|
//! | `drive` | the drive of one controller |
//! | `persons` | what pages ask for, and the stops of all persons |

mod drive;
mod persons;
#[cfg(test)]
mod tests;

use std::{collections::BTreeMap, f64::consts::TAU, time::Duration};

use motorlink_bus::{Command, Consent, GroupSetpoints, Limits, StopReason};
use motorlink_controller_messages::{
    DriveState, EndReason, FromClient, Holder, NotArmed, Setpoints,
};
use motorlink_driver::Status;
use motorlink_messages::{Notice, runs::ToRun};
use motorlink_protocol::{Instant, MotorId, Setpoint, SpeedTarget, family::Model};
use motorlink_remote::{Control, Ended, Participant, Stamp, Taken, ViewerId};

use self::drive::Drive;

/// The lease, the drives of controllers, and the stops of persons. Every command of this server for the driver comes from here.
#[derive(Debug, Default)]
pub(crate) struct Operation {
    control: Control,
    controllers: BTreeMap<ViewerId, Controller>,
    /// The pages without the lease that have stopped something lately, and when.
    stopped: BTreeMap<ViewerId, Instant>,
    /// Whether a person has stopped all motors, and nobody has released them since. A program does not.
    is_stopped_by_person: bool,
    limits: Limits,
    /// The greatest speed of the model; none is known before the first state of the driver.
    rpm_max: u16,
    /// How many drives have begun or ended.
    changes: u32,
    /// What `Viewers` does next, in this order. It takes them after each call, so they stay few.
    pub(super) outputs: Vec<Output>,
}

/// What `Viewers` does next.
#[derive(Debug, PartialEq)]
pub(super) enum Output {
    /// For the driver.
    Command(Command),
    /// For the run of an experiment.
    Run(ToRun),
    /// For this page, to be answered.
    Challenge(ViewerId, u64),
    /// This page is told who drives.
    TellControl(ViewerId),
    /// For this page.
    Notice(ViewerId, Notice),
}

/// A controller on the socket.
#[derive(Debug, Default)]
struct Controller {
    challenge: u64,
    drive: Drive,
    /// The number of its newest ARM, and what became of it.
    arm: (u32, Option<NotArmed>),
    /// The number of its newest setpoints.
    sequence: u32,
}

/// What one controller is told beside the state of the motors.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct DriveReport {
    pub(crate) challenge: u64,
    /// The number of its newest ARM, and what became of it.
    pub(crate) arm: (u32, Option<NotArmed>),
    pub(crate) drive: DriveState,
    pub(crate) ended: EndReason,
    /// The motors of its newest ARM that was done.
    pub(crate) motors: Vec<MotorId>,
    /// Who has control.
    pub(crate) holder: (Holder, u32),
}

impl Operation {
    /// A page or a controller has connected. Returns nothing if there are too many of its kind.
    pub(super) fn join(&mut self, now: Instant, kind: Participant) -> Option<ViewerId> {
        let viewer = self.control.join(now, kind)?;
        if kind == Participant::Controller {
            self.controllers.insert(viewer, Controller::default());
        }
        Some(viewer)
    }

    /// A page or a controller has gone. Returns what a controller is told last.
    pub(super) fn leave(&mut self, viewer: ViewerId) -> Option<DriveReport> {
        let ended = self.control.leave(viewer);
        self.stop_after(ended);
        self.stopped.remove(&viewer);
        let report = self.report(viewer);
        self.controllers.remove(&viewer);
        report
    }

    /// Ends a lease that was not renewed, and makes the challenges that are due. Returns how long to wait for the next call.
    pub(super) fn turn(&mut self, now: Instant, random: impl FnMut() -> Option<u64>) -> Duration {
        let ended = self.control.expire(now);
        self.stop_after(ended);
        for (viewer, challenge) in self.control.challenge(now, random) {
            match self.controllers.get_mut(&viewer) {
                Some(controller) => controller.challenge = challenge,
                None => self.outputs.push(Output::Challenge(viewer, challenge)),
            }
        }
        let next = self.control.next_turn();
        next.map_or(Duration::MAX, |at| at.since(now))
    }

    /// The lease, for those who are told of it.
    pub(super) const fn control(&self) -> &Control {
        &self.control
    }

    /// How many drives have begun or ended: to be read before a status is asked for.
    pub(crate) const fn changes(&self) -> u32 {
        self.changes
    }

    /// Follows what the bus does. A status that was asked for before the newest of the `changes` shows nothing of it.
    pub(crate) fn follow(&mut self, changes: u32, status: &Status, model: Model) {
        self.rpm_max = model.spec().speed_rpm_max;
        if self.changes != changes {
            return;
        }
        for controller in self.controllers.values_mut() {
            let may_drive = controller.drive.follow(status).into_iter();
            // The bus stops the group. Each motor is stopped too, because no setpoints follow.
            let stops = may_drive.map(|id| Output::Command(Command::Stop(id)));
            self.outputs.extend(stops);
        }
    }

    /// A drive may have ended for this reason: the next status shows it. `of`: only one with this motor.
    pub(crate) fn may_end(&mut self, of: Option<MotorId>, why: EndReason) {
        for controller in self.controllers.values_mut() {
            controller.drive.may_end(of, why);
        }
    }

    /// A message of a controller. It answers a challenge, too.
    pub(crate) fn controller_asks(&mut self, now: Instant, viewer: ViewerId, asks: &FromClient) {
        match asks {
            FromClient::Arm(order) => {
                self.control.answer(now, viewer, order.challenge);
                let armed = self.arm(now, viewer, order);
                if let Some(controller) = self.controllers.get_mut(&viewer) {
                    controller.arm = (order.number, armed.err());
                }
            }
            FromClient::Setpoints(order) => {
                self.control.answer(now, viewer, order.challenge);
                self.setpoints(now, viewer, order);
            }
            FromClient::Disarm => self.give_up(viewer),
        }
    }

    /// Takes control and starts these motors at 0 rpm.
    fn arm(&mut self, now: Instant, viewer: ViewerId, order: &Setpoints) -> Result<(), NotArmed> {
        if order.speeds.iter().any(|(_, speed)| *speed != 0.0) {
            return Err(NotArmed::NotZero);
        }
        let operator = self.control.operator();
        let holds = operator.is_some_and(|(_, epoch)| self.control.holds(now, viewer, epoch));
        let is_live = |controller: &Controller| controller.drive.is_live();
        if holds && self.controllers.get(&viewer).is_some_and(is_live) {
            return Err(NotArmed::StillDriven);
        }
        if self.is_stopped_by_person {
            return Err(NotArmed::StoppedByPerson);
        }
        let zero = Setpoint::velocity(SpeedTarget::ZERO);
        let given: Vec<_> = order.speeds.iter().map(|(id, _)| (*id, zero)).collect();
        let setpoints = GroupSetpoints::new(&given).map_err(|_| NotArmed::Late)?;
        let taken = self.control.arm(now, viewer, order.challenge);
        match taken.map_err(|_| NotArmed::Late)? {
            Taken::Granted(ended) => self.stop_after(ended),
            Taken::Held => {}
            Taken::Asked => {
                return Err(match self.holder(viewer) {
                    (Holder::OtherClient, _) => NotArmed::OtherHasControl,
                    _ => NotArmed::PageHasControl,
                });
            }
        }
        // It releases the stop of an earlier lease.
        self.command(Command::Release);
        self.command(Command::StartGroup {
            setpoints,
            consent: Consent::None,
        });
        self.changes += 1;
        if let Some(controller) = self.controllers.get_mut(&viewer) {
            controller.drive = Drive::start(given);
        }
        Ok(())
    }

    /// Gives new setpoints to the bus, if this controller drives.
    fn setpoints(&mut self, now: Instant, viewer: ViewerId, order: &Setpoints) {
        let operator = self.control.operator();
        let Some((_, epoch)) = operator.filter(|(holder, _)| *holder == viewer) else {
            return;
        };
        let Some(controller) = self.controllers.get_mut(&viewer) else {
            return;
        };
        if let Some(why) = controller.drive.check(&order.speeds) {
            self.end_drives(None, why);
            return self.give_up(viewer);
        }
        // After weeks. The next ARM would need a new connection, so this one ends what it drives.
        let Some(sequence) = controller.sequence.checked_add(1) else {
            return self.give_up(viewer);
        };
        controller.sequence = sequence;
        let stamp = Stamp {
            epoch,
            sequence,
            challenge: order.challenge,
        };
        if self.control.act(now, viewer, stamp, true).is_err() {
            return;
        }
        let max = f64::from(self.limits.speed_rpm().min(self.rpm_max));
        let targets = order.speeds.iter().map(|(id, rad_per_s)| {
            let rpm = (f64::from(*rad_per_s) * 60.0 / TAU)
                .clamp(-max, max)
                .round();
            #[expect(clippy::cast_possible_truncation, reason = "a speed within the limits")]
            let speed = SpeedTarget::clamped(rpm as i32);
            (*id, Setpoint::velocity(speed))
        });
        if let Some(setpoints) = controller.drive.adjust(targets.collect()) {
            self.command(Command::AdjustGroup {
                setpoints,
                consent: Consent::None,
            });
        }
    }

    /// What a controller is told; `None` for a page.
    pub(crate) fn report(&self, viewer: ViewerId) -> Option<DriveReport> {
        let controller = self.controllers.get(&viewer)?;
        let (drive, ended) = controller.drive.told();
        Some(DriveReport {
            challenge: controller.challenge,
            arm: controller.arm,
            drive,
            ended,
            motors: controller.drive.motors.clone(),
            holder: self.holder(viewer),
        })
    }

    /// Who has control, for this controller.
    fn holder(&self, viewer: ViewerId) -> (Holder, u32) {
        let Some((holder, _)) = self.control.operator() else {
            return (Holder::Nobody, 0);
        };
        let is = match self.controllers.contains_key(&holder) {
            _ if holder == viewer => Holder::You,
            true => Holder::OtherClient,
            false => Holder::Page,
        };
        (is, holder.0)
    }

    fn command(&mut self, command: Command) {
        self.outputs.push(Output::Command(command));
    }

    /// Stops what a lease drove that has ended.
    fn stop_after(&mut self, ended: Option<Ended>) {
        if let Some(ended) = ended {
            self.command(Command::StopAll(StopReason::OperatorLost));
            let why = match ended {
                Ended::Silent | Ended::Gone => EndReason::LeaseEnded,
                Ended::GivenUp => EndReason::Disarmed,
                Ended::Taken => EndReason::Taken,
            };
            self.end_drives(None, why);
        }
    }

    /// What controllers drive is being stopped. `of`: only a drive with this motor. Only the next ARM starts it again. One
    /// drive at most is live, because its controller holds the lease.
    fn end_drives(&mut self, of: Option<MotorId>, why: EndReason) {
        for controller in self.controllers.values_mut() {
            self.changes += u32::from(controller.drive.end(of, why));
        }
    }

    /// Stops what this one drives, and gives up its control.
    fn give_up(&mut self, viewer: ViewerId) {
        let ended = self.control.give_up(viewer);
        self.stop_after(ended);
    }

    /// Whether this one has the newest lease. It may have run out.
    fn is_operator(&self, viewer: ViewerId) -> bool {
        let operator = self.control.operator();
        operator.is_some_and(|(holder, _)| holder == viewer)
    }
}
