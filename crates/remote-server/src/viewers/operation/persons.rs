//! What pages ask for, checked against the lease, and the stops of all persons.

use std::time::Duration;

use motorlink_bus::{COMMAND_AGE_MAX, Command, StopReason};
use motorlink_controller_messages::EndReason;
use motorlink_messages::{Notice, runs::ToRun};
use motorlink_protocol::Instant;
use motorlink_remote::{NotDone, Taken, ViewerId};

use super::{Operation, Output};
use crate::messages::{Act, PageRequest, stops_in};

/// The driver refuses a command at once, and a busy computer needs longer.
const ANSWERED_WITHIN: Duration = Duration::from_secs(1);

impl Operation {
    /// A message of a page.
    pub(crate) fn page_asks(&mut self, now: Instant, viewer: ViewerId, asks: PageRequest) {
        match asks {
            PageRequest::Answer { challenge } => self.control.answer(now, viewer, challenge),
            PageRequest::Take { by_force } => {
                if let Taken::Granted(ended) = self.control.take(now, viewer, by_force) {
                    self.stop_after(ended);
                }
                // It may have missed that it holds the lease.
                self.outputs.push(Output::TellControl(viewer));
            }
            PageRequest::GiveUp => self.give_up(viewer),
            PageRequest::Command(act, command) => self.page_commands(now, viewer, act, command),
            PageRequest::Select(act, id) => {
                if self.control.act(now, viewer, act.stamp, false).is_ok() {
                    self.command(Command::Watch(id));
                }
            }
            PageRequest::Run(act, message) => self.run(now, viewer, act, message),
            PageRequest::ForOwnComputer => {}
        }
    }

    /// Gives a command of a page to the driver. A lease that ends afterwards stops it.
    fn page_commands(&mut self, now: Instant, viewer: ViewerId, act: Act, command: Command) {
        let holds = self.control.holds(now, viewer, act.stamp.epoch);
        match command {
            Command::Stop(_) | Command::StopAll(StopReason::Operator) | Command::StopRaw => {
                self.stop(now, Some(viewer), [command]);
            }
            // The operator's page was closed or hidden. That of a watcher stops nothing.
            Command::StopAll(_) => {
                if self.is_operator(viewer) {
                    self.command(command);
                }
            }
            // They move nothing, and the page sends its settings only once.
            Command::CancelJob if holds => self.command(command),
            Command::Configure(settings) if holds => {
                self.limits = settings.limits;
                self.command(command);
            }
            command => {
                let starts = command.may_move() || command.releases();
                let done = self.control.act(now, viewer, act.stamp, starts);
                if done.is_ok() && !command.is_too_old(act.age) {
                    self.is_stopped_by_person &= !command.releases();
                    return self.command(command);
                }
                let stops = stops_in(command);
                if stops.is_empty() {
                    self.outputs.push(match done {
                        // The page sees who drives.
                        Err(NotDone::NotOperator) => Output::TellControl(viewer),
                        _ => Output::Notice(viewer, Notice::TooLate(command.into())),
                    });
                }
                self.stop(now, Some(viewer), stops);
            }
        }
    }

    /// A person stops motors, on a page or by the text form. Everybody may, and a late stop is one too.
    pub(crate) fn stop(
        &mut self,
        now: Instant,
        page: Option<ViewerId>,
        stops: impl IntoIterator<Item = Command>,
    ) {
        let is_operator = page.is_some_and(|page| self.is_operator(page));
        for stop in stops {
            self.command(stop);
            self.is_stopped_by_person |= matches!(stop, Command::StopAll(_));
            if is_operator {
                continue;
            }
            self.control.stopped_by_other(now);
            self.stopped.extend(page.map(|page| (page, now)));
            match stop {
                Command::StopAll(_) => self.end_drives(None, EndReason::Stopped),
                Command::Stop(id) => self.end_drives(Some(id), EndReason::Stopped),
                _ => {}
            }
        }
    }

    /// A person at the text form lets controllers start motors again. It starts none.
    pub(crate) const fn release(&mut self) {
        self.is_stopped_by_person = false;
    }

    /// The pages that may have given a command that was not carried out: the operator, and who has stopped something
    /// within a second.
    pub(crate) fn may_have_commanded(&mut self, now: Instant) -> Vec<ViewerId> {
        self.stopped.retain(|_, at| *at + ANSWERED_WITHIN > now);
        let operator = self.control.operator().map(|(holder, _)| holder);
        operator
            .into_iter()
            .chain(self.stopped.keys().copied())
            .collect()
    }

    /// Gives a message to the run of an experiment.
    fn run(&mut self, now: Instant, viewer: ViewerId, act: Act, message: ToRun) {
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
        self.outputs.push(if is_given {
            Output::Run(message)
        } else {
            Output::TellControl(viewer)
        });
    }
}
