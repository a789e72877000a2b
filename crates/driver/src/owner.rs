//! The thread that owns the port.

use std::{
    collections::BTreeSet,
    panic::{AssertUnwindSafe, catch_unwind},
    sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, TrySendError},
    time::Duration,
};

use motorlink_bus::{BusSettings, Command, Event, Refusal, StopReason, StopReport};
use motorlink_messages::LeftBehind;
use motorlink_protocol::{Instant, MotorId, family::Model};

use crate::{
    clock::Clock,
    driven_file::DrivenFile,
    entry::{Entry, Status},
    host::{Host, Turned},
    inputs::{Input, Told},
    latency::run_on_time,
    open_failure::OpenFailure,
    options::{Ending, Options},
    ports::ChosenPort,
};

/// How long the thread sleeps at most: it has nothing to do while the port is lost but to look for it.
const SLEEP_MAX: Duration = Duration::from_millis(500);

/// What the thread is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stage {
    /// It looks for the motors. The program may not drive.
    OnTrial,
    /// The program may drive.
    Settled,
    /// The motors are being stopped; then the port is closed.
    Ending {
        /// Whether that stop has ended.
        has_stopped: bool,
    },
}

impl Stage {
    pub(crate) const fn is_ending(self) -> bool {
        matches!(self, Self::Ending { .. })
    }
}

/// The state of the thread.
pub(crate) struct Owner {
    pub(crate) clock: Clock,
    inputs: Receiver<Input>,
    pub(crate) to_self: Sender<Input>,
    told: SyncSender<Told>,
    /// The model that the program asks for; `None` is to find out.
    pub(crate) asked_model: Option<Model>,
    pub(crate) settings: BusSettings,
    pub(crate) watched: BTreeSet<MotorId>,
    tells_traffic: bool,
    pub(crate) is_halted: bool,
    pub(crate) file: DrivenFile,
    /// The open line; `None` while the port is lost.
    pub(crate) host: Option<Host>,
    /// The serial port; `None` for virtual motors.
    pub(crate) port: Option<ChosenPort>,
    pub(crate) stage: Stage,
    /// The number of the open port. Bytes of an earlier one are not for this bus.
    pub(crate) number: u32,
    /// When a lost port is looked for next.
    pub(crate) look_at: Instant,
    /// The stop that was the last to end.
    last_stop: Option<StopReport>,
    #[cfg(test)]
    fails_next: bool,
}

impl Owner {
    pub(crate) fn new(
        options: &Options,
        inputs: Receiver<Input>,
        to_self: Sender<Input>,
        told: SyncSender<Told>,
    ) -> Self {
        Self {
            clock: Clock::new(),
            inputs,
            to_self,
            told,
            asked_model: options.model,
            settings: options.settings,
            watched: options.watch.iter().copied().collect(),
            tells_traffic: options.tells_traffic,
            is_halted: false,
            file: DrivenFile::none(),
            host: None,
            port: None,
            stage: Stage::OnTrial,
            number: 0,
            look_at: Instant::ZERO,
            last_stop: None,
            #[cfg(test)]
            fails_next: false,
        }
    }

    /// Opens the port, tells whether it is open, and runs it until the end.
    pub(crate) fn run(
        mut self,
        options: &Options,
        opened: &SyncSender<Result<Model, OpenFailure>>,
    ) -> Ending {
        run_on_time();
        let result = catch_unwind(AssertUnwindSafe(|| {
            let model = self.open(options);
            let is_open = model.is_ok();
            // The program waits for it.
            let _ = opened.send(model);
            if is_open {
                self.run_open();
            }
        }));
        let has_failed = result.is_err();
        if has_failed {
            self.stop_after_failure();
        }
        let now = self.clock.now();
        if let Some(host) = self.host.take() {
            let (last, left) = host.close(now);
            for event in last {
                self.tell(now, Entry::Event(event));
            }
            self.file.carry(left);
        }
        Ending {
            last_stop: self.last_stop,
            may_turn: self
                .file
                .take_left()
                .into_iter()
                .map(|motor| motor.id)
                .collect(),
            has_failed,
        }
    }

    /// Runs the open port until the program ends it.
    fn run_open(&mut self) {
        loop {
            let wake = self.turn();
            if let Stage::Ending { has_stopped } = self.stage
                && (has_stopped || !self.is_active())
            {
                return;
            }
            self.take_inputs(wake);
        }
    }

    /// Whether a motor is driven or turns. Nothing can be stopped while the port is lost: the next driver does it.
    fn is_active(&mut self) -> bool {
        let now = self.clock.now();
        self.host
            .as_ref()
            .is_some_and(|host| host.bus.is_active(now))
    }

    /// Does everything that is due. Returns when the next turn is.
    pub(crate) fn turn(&mut self) -> Instant {
        let now = self.clock.now();
        // The host stays in its place: after a failure in its bus, another bus stops the motors on its line.
        let Some(host) = self.host.as_mut() else {
            return self.look_for_port(now);
        };
        let mut entries = Vec::new();
        let turned = host.turn(now, &mut self.file, |entry| entries.push(entry));
        #[cfg(test)]
        assert!(!std::mem::take(&mut self.fails_next), "asked for by a test");
        // The bus stops all motors by itself after a silence of the program or a sleep of the computer.
        self.is_halted |= host.bus.is_halted();
        for entry in entries {
            if let Entry::Event(Event::StopEnded(report)) = &entry {
                if let Stage::Ending { has_stopped } = &mut self.stage {
                    // Whatever stop it was: one that begins meanwhile joins that of the end.
                    *has_stopped = true;
                }
                self.last_stop = Some(report.clone());
            }
            // The program waits until the port is open, and answers nothing meanwhile.
            if entry == Entry::Event(Event::PingPage)
                && self.stage == Stage::OnTrial
                && let Some(host) = &mut self.host
            {
                host.bus.page_answered(now);
            }
            self.tell(now, entry);
        }
        match turned {
            Turned::Wait(at) => at,
            Turned::Gone => {
                self.lose_port();
                now
            }
        }
    }

    pub(crate) fn tell(&mut self, now: Instant, entry: Entry) {
        let told = match entry {
            Entry::Event(Event::PingPage) => Told::Ping,
            Entry::Event(Event::Line(_) | Event::Telemetry(_)) if !self.tells_traffic => return,
            entry => Told::Entry(now, entry),
        };
        match self.told.try_send(told) {
            // A program that takes nothing is stopped by the watchdog of the bus, as its pings are lost too.
            Ok(()) | Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) => {}
        }
    }

    /// Waits until this moment or the next input, and handles all that is there.
    pub(crate) fn take_inputs(&mut self, until: Instant) {
        let wait = until.since(self.clock.now()).min(SLEEP_MAX);
        match self.inputs.recv_timeout(wait) {
            Ok(input) => self.handle(input),
            Err(RecvTimeoutError::Timeout) => return,
            // This thread has a sender too.
            Err(RecvTimeoutError::Disconnected) => {}
        }
        while let Ok(input) = self.inputs.try_recv() {
            self.handle(input);
        }
    }

    fn handle(&mut self, input: Input) {
        let now = self.clock.now();
        match (input, &mut self.host) {
            (Input::Bytes(number, bytes), Some(host)) if number == self.number => {
                host.receive(now, &bytes);
            }
            (Input::PortGone(number), Some(_)) if number == self.number => self.lose_port(),
            (Input::Bytes(..) | Input::PortGone(_), _) | (Input::Alive, None) => {}
            (Input::Alive, Some(host)) => host.bus.page_answered(now),
            (Input::Command(command, given), _) => {
                if command.is_too_old(given.elapsed()) {
                    self.tell(now, Entry::TooLate(command.into()));
                } else {
                    self.command(now, command);
                }
            }
            (Input::Status(answer), _) => {
                // Who asked waits for it.
                let _ = answer.try_send(self.status(now));
            }
            (Input::End, _) => self.begin_end(now),
            #[cfg(test)]
            (Input::Fail, _) => self.fails_next = true,
        }
    }

    fn command(&mut self, now: Instant, command: Command) {
        match command {
            Command::Configure(settings) => self.settings = settings,
            Command::Watch(id) => _ = self.watched.insert(id),
            Command::Forget(id) => _ = self.watched.remove(&id),
            Command::StopAll(_) => self.is_halted = true,
            Command::Release => self.is_halted = false,
            _ => {}
        }
        match &mut self.host {
            Some(host) if self.stage == Stage::Settled || !command.may_move() => {
                if let Err(refusal) = host.bus.command(now, command) {
                    let command = command.into();
                    self.tell(now, Entry::Refused { command, refusal });
                }
            }
            // They are done: they hold for the next port.
            None if matches!(
                command,
                Command::Configure(_)
                    | Command::Watch(_)
                    | Command::Forget(_)
                    | Command::StopAll(_)
                    | Command::Release
            ) => {}
            _ => self.tell(now, Entry::NotConnected(command.into())),
        }
    }

    fn begin_end(&mut self, now: Instant) {
        if self.stage.is_ending() {
            return;
        }
        self.stage = Stage::Ending { has_stopped: false };
        let Some(host) = &mut self.host else { return };
        if !host.bus.is_stopping() {
            // What an earlier stop has shown is not the result of this end.
            self.last_stop = None;
        }
        if host.bus.is_active(now) {
            let stop = Command::StopAll(StopReason::Disconnect);
            // A stop is never refused.
            let _: Result<(), Refusal> = host.bus.command(now, stop);
        }
    }

    fn status(&self, now: Instant) -> Status {
        let bus = self.host.as_ref().map(|host| &host.bus);
        Status {
            now,
            is_open: bus.is_some(),
            is_halted: self.is_halted,
            motors: bus.map_or_else(Vec::new, |bus| bus.motors(now).collect()),
            job: bus.and_then(motorlink_bus::Bus::job),
            raw: bus.and_then(motorlink_bus::Bus::raw),
            line: bus.map(|bus| bus.line_status(now)),
        }
    }

    /// The bus has failed, and its state is not to be trusted. The line is: another bus stops what the file names.
    fn stop_after_failure(&mut self) {
        self.stage = Stage::Ending { has_stopped: false };
        self.is_halted = true;
        let now = self.clock.now();
        let Some(mut host) = self.host.take() else {
            // No line is left. The next driver stops what the file names.
            if let Some(left) = self.file.written() {
                self.file.carry(left);
            }
            return;
        };
        let nothing = LeftBehind::nothing(host.bus.model());
        let left = self.file.written().unwrap_or(nothing);
        host.bus = self.new_bus(now, left.model).after_another(now);
        host.bus.stop_first(now, left.motors);
        self.host = Some(host);
        // If this one fails too, the motors are in the file.
        let _ = catch_unwind(AssertUnwindSafe(|| self.run_open()));
    }
}
