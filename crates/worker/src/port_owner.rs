//! The one owner of the port: what is done with messages, bytes and the passing of time.

use std::{cell::RefCell, rc::Rc};

use motorlink_bus::{Bus, BusSettings, Event, Output};
use motorlink_messages::{LeftBehind, ModelChoice, Notice, Outbox, ToPage, Update, VirtualLine};
use motorlink_protocol::{Instant, MotorId, family::Model};
use motorlink_runs::{Input, Runs};
use web_sys::MessagePort;

use crate::{
    alarm::Alarm,
    claim::release_claim,
    forwarding::forward,
    left::Left,
    line::Line,
    page_clock::PageClock,
    port_state::{AfterClosing, OpenPort, PortState, Stage},
    runs::host::Loading,
    scope::{Clock, post, posted},
    traffic::TrafficQueue,
};

mod requests;

/// The state of the port worker: the port with its bus, and the queues to the page and the
/// recorder. Each callback of the browser borrows it once, briefly.
pub(crate) struct PortOwner {
    clock: Clock,
    alarm: Alarm,
    pub(crate) outbox: Outbox,
    traffic: TrafficQueue,
    pub(crate) port: PortState,
    /// The number of the port state: a task of an older one must not touch a newer one.
    pub(crate) generation: u32,
    pub(crate) selected: MotorId,
    settings: BusSettings,
    /// The model of the motors on the serial port.
    pub(crate) model: ModelChoice,
    /// Whether "Stop all motors" is in effect. It stays so after the port is closed.
    halted: bool,
    pub(crate) runs: Runs<Loading>,
    /// What was left driven on adapters that are not open.
    pub(crate) left: Left,
    /// Whether the page was told that what is driven cannot be remembered.
    told_not_remembered: bool,
    page_clock: PageClock,
}

/// The handle that the browser's callbacks share.
pub(crate) type Shared = Rc<RefCell<PortOwner>>;

impl PortOwner {
    pub(crate) fn new(clock: Clock, alarm: Alarm) -> Self {
        Self {
            clock,
            alarm,
            outbox: Outbox::default(),
            traffic: TrafficQueue::default(),
            port: PortState::Closed,
            generation: 0,
            selected: MotorId::FIRST,
            settings: BusSettings::default(),
            model: ModelChoice::default(),
            halted: false,
            runs: Runs::default(),
            left: Left::default(),
            told_not_remembered: false,
            page_clock: PageClock::default(),
        }
    }

    /// Sets the port on which line events are posted to the recorder.
    pub(crate) fn connect_recorder(&mut self, port: MessagePort) {
        self.traffic.connect(port);
        // It begins with the state of this moment.
        self.outbox.touch();
    }

    pub(crate) fn now(&self) -> Instant {
        self.clock.now()
    }

    /// A new bus for this model, on which nothing drives; `line` is the virtual one. It is halted if "Stop all
    /// motors" is in effect.
    pub(crate) fn new_bus(&self, model: Model, line: Option<VirtualLine>) -> Bus {
        let now = self.now();
        let mut bus = Bus::with_model(now, model);
        if line.is_none() {
            bus = bus.after_another(now);
        }
        if self.halted {
            bus = bus.into_halted();
        }
        // The motors of a virtual line are known, and several would reply to the ID query at once.
        let known = line.filter(|line| line.count() > 1);
        let asks_for_id = known.is_none();
        let watched = known.into_iter().flat_map(VirtualLine::ids);
        let watched = watched.chain([self.selected]);
        bus.prepared(now, self.settings, asks_for_id, watched)
    }

    /// Sets the state of the port; returns the old one and the number of the new one.
    pub(crate) fn set_port(&mut self, port: PortState) -> (PortState, u32) {
        self.generation += 1;
        self.outbox.touch();
        let now = self.now();
        self.runs.closed(now, Input::Closed, self.settings);
        let mut left = std::mem::replace(&mut self.port, port);
        if let PortState::Open(open) = &mut left {
            // A scan or an ID change that ends with its port is reported as cancelled.
            let last_events: Vec<Event> = open.bus.close(now).collect();
            for event in last_events {
                match event {
                    Event::Line(traffic) => self.traffic.push(traffic),
                    event => forward(&mut self.outbox, open, event),
                }
            }
            self.traffic.send_soon();
            if let Line::Serial(line) = &open.line {
                let motors: Vec<_> = open.bus.left_driven().collect();
                let model = open.bus.model();
                self.left.of(line.usb()).carry(LeftBehind { model, motors });
            }
        }
        (left, self.generation)
    }

    /// Handles the loss of the adapter: the driven motors may turn on, and the worker waits for the adapter to stop them.
    ///
    /// If the port was being closed, returns what to do after closing.
    pub(crate) fn adapter_lost(&mut self) -> Option<AfterClosing> {
        let now = self.now();
        let PortState::Open(open) = &mut self.port else {
            return None;
        };
        let leaving = match &mut open.stage {
            Stage::Closing(then) => Some(std::mem::take(then)),
            Stage::OnTrial { .. } | Stage::Settled => None,
        };
        let adapter = open.line.adapter();
        let driven = open.bus.left_driven().map(|motor| motor.id).collect();
        if let Line::Serial(line) = &mut open.line {
            if matches!(open.stage, Stage::OnTrial { .. }) {
                self.left.lost_on_trial += 1;
            } else {
                self.left.foreign = std::mem::take(&mut line.others_of_make);
            }
        }
        self.outbox.notice(Notice::AdapterLost { driven });
        self.runs.closed(now, Input::Unplugged, self.settings);
        let waiting = if leaving.is_some() {
            PortState::Closed
        } else {
            PortState::Lost(adapter)
        };
        self.set_port(waiting);
        // It is claimed again when it is back.
        release_claim();
        leaving
    }

    /// Does everything that is due. Returns what to do after closing, once the motors have stopped and
    /// the port can be closed.
    pub(crate) fn turn(&mut self) -> Option<AfterClosing> {
        let now = self.now();
        let mut wake = None;
        let mut left = None;
        if let PortState::Open(open) = &mut self.port {
            let settings = self.settings;
            self.runs.tick(now, &mut open.bus, settings);
            let asks_again = open.asks_again.turn(now, &mut open.bus);
            let at = loop {
                let OpenPort { bus, line, .. } = &mut **open;
                let received = || line.take_received(now);
                let output = self.runs.poll(now, bus, settings, received);
                // Before the frame: a process that is killed behind it leaves a file that names the motor.
                if !open.remember(&mut self.left) && !self.told_not_remembered {
                    self.told_not_remembered = true;
                    self.outbox.notice(Notice::NotRemembered);
                }
                match output {
                    Output::Transmit(frame) if open.line.write(now, frame) => {
                        self.runs.frame_taken(self.clock.now());
                    }
                    Output::Transmit(_) => open.bus.transmit_failed(),
                    Output::Event(Event::PingPage) => {
                        post(&ToPage::Ping);
                        self.outbox.pinged(now);
                    }
                    // Events of a port on trial too: the log shows all traffic.
                    Output::Event(Event::Line(traffic)) => self.traffic.push(traffic),
                    // The page knows that nothing answers.
                    Output::Event(Event::IdQueryEnded(outcome))
                        if !open.asks_again.ended(now, outcome) => {}
                    Output::Event(event) => {
                        if let Event::StopEnded(_) = event
                            && let Stage::Closing(then) = &mut open.stage
                        {
                            left = Some(std::mem::take(then));
                        }
                        forward(&mut self.outbox, open, event);
                    }
                    Output::Wait(at) => break at,
                }
            };
            // The bus stops all motors by itself after a silence of the page or a sleep of the computer.
            self.halted |= open.bus.is_halted();
            let others = [open.line.next_event(), self.runs.wake(), asks_again];
            wake = others.into_iter().flatten().chain([at]).min();
        }
        // The recorder gets all traffic of a port before the page learns that the port is closed.
        if self.traffic.due().is_some_and(|due| due <= now) {
            self.traffic.send(now);
        }
        if self.outbox.due(now).is_some_and(|due| due <= now) {
            let mut update = self.current_state(now);
            self.outbox.fill(&mut update);
            self.traffic.send_state(&posted(&ToPage::Update(update)));
        }
        let outbox_due = self.outbox.due(now);
        let traffic_due = self.traffic.due();
        // The recorder can wait for the next update: one wake-up for both.
        let traffic_due = traffic_due.map(|due| outbox_due.map_or(due, |frame| frame.max(due)));
        if let Some(at) = wake.into_iter().chain(outbox_due).chain(traffic_due).min() {
            self.alarm.arm(now, at);
        }
        left
    }

    fn current_state(&self, now: Instant) -> Update {
        let mut update = Update::without_motors(now, self.port.connection());
        update.halted = self.halted;
        if let PortState::Open(open) = &self.port
            && !matches!(open.stage, Stage::OnTrial { .. })
        {
            update.motors = open.bus.motors(now).collect();
            update.job = open.bus.job();
            update.raw = open.bus.raw();
            update.line = Some(open.bus.line_status(now));
        }
        update
    }
}
