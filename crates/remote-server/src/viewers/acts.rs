//! Checks what pages ask for against the lease, and gives it to the driver.

use motorlink_bus::{COMMAND_AGE_MAX, Command, CommandKind, StopReason};
use motorlink_messages::{Notice, runs::ToRun};
use motorlink_protocol::Instant;
use motorlink_remote::{NotDone, ViewerId};

use super::State;
use crate::messages::{Act, stops_in};

impl State {
    /// Gives a command of a page to the driver, while the lease is locked: a lease that ends afterwards stops it.
    pub(super) fn command(&mut self, now: Instant, viewer: ViewerId, act: Act, command: Command) {
        let holds = self.control.holds(now, viewer, act.stamp.epoch);
        let is_operator = self
            .control
            .operator()
            .is_some_and(|(holder, _)| holder == viewer);
        match command {
            // Everybody may stop, and a late stop is one too.
            Command::Stop(_) | Command::StopAll(StopReason::Operator) | Command::StopRaw => {
                self.stop(now, viewer, is_operator, [command]);
            }
            // The operator's page was closed or hidden. That of a watcher stops nothing.
            Command::StopAll(_) => {
                if is_operator {
                    self.commander.command(command);
                }
            }
            // They move nothing, and the page sends its settings only once.
            Command::CancelJob if holds => self.commander.command(command),
            Command::Configure(settings) if holds => {
                self.controllers.limited_by(settings.limits);
                self.commander.command(command);
            }
            command => {
                let starts = command.may_move() || command.releases();
                let done = self.control.act(now, viewer, act.stamp, starts);
                match done {
                    Ok(()) if !command.is_too_old(act.age) => {
                        self.is_stopped_by_person &= !command.releases();
                        self.commander.command(command);
                    }
                    done => {
                        let stops = stops_in(command);
                        if stops.is_empty() {
                            self.not_done(viewer, command.into(), done.err());
                        }
                        self.stop(now, viewer, is_operator, stops);
                    }
                }
            }
        }
    }

    /// Gives stops of any page to the driver.
    fn stop(
        &mut self,
        now: Instant,
        viewer: ViewerId,
        is_operator: bool,
        stops: impl IntoIterator<Item = Command>,
    ) {
        for stop in stops {
            self.commander.command(stop);
            self.is_stopped_by_person |= matches!(stop, Command::StopAll(_));
            if !is_operator {
                self.control.stopped_by_other(now);
                self.stopped.insert(viewer, now);
                self.controllers.stopped_by(stop);
            }
        }
    }

    /// Gives a message to the run of an experiment.
    pub(super) fn run(&mut self, now: Instant, viewer: ViewerId, act: Act, message: ToRun) {
        let holds = self.control.holds(now, viewer, act.stamp.epoch);
        let is_given = match message {
            // It stops motors: everybody may, however late.
            ToRun::Abort => true,
            ToRun::Pause | ToRun::FocusLost => holds,
            ToRun::Arm { .. } | ToRun::Start { .. } | ToRun::Resume => {
                let done = self.control.act(now, viewer, act.stamp, true);
                let is_old = act.age > COMMAND_AGE_MAX;
                done.is_ok() && !is_old
            }
        };
        if is_given {
            self.commander.run(message);
        } else {
            self.tell_control_to(viewer);
        }
    }

    fn not_done(&mut self, viewer: ViewerId, command: CommandKind, why: Option<NotDone>) {
        if why == Some(NotDone::NotOperator) {
            // The page sees who drives.
            self.tell_control_to(viewer);
        } else {
            self.notice(viewer, Notice::TooLate(command));
        }
    }
}
