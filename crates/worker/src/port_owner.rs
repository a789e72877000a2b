//! The one owner of the port: what is done with messages, bytes and the passing of time.

use std::{cell::RefCell, rc::Rc};

use motorlink_bus::{Activity, Bus, Event, MotorStatus};
use motorlink_messages::{ModelChoice, Notice, Outbox, ToPage, Update, VirtualLine};
use motorlink_port::{BusEnd, PortControl, Turned};
use motorlink_protocol::{Instant, MotorId, family::Model};
use motorlink_runs::Input;
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
    pub(crate) control: PortControl<Loading>,
    /// The model of the motors on the serial port.
    pub(crate) model: ModelChoice,
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
            control: PortControl::default(),
            model: ModelChoice::default(),
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

    /// A new bus for this model, on which nothing drives; `line` is the virtual one.
    pub(crate) fn new_bus(&self, model: Model, line: Option<VirtualLine>) -> Bus {
        // The motors of a virtual line are known, and several would reply to the ID query at once.
        let known = line.filter(|line| line.count() > 1);
        let asks_for_id = known.is_none();
        let watched = known.into_iter().flat_map(VirtualLine::ids);
        let watched = watched.chain([self.selected]);
        let now = self.now();
        self.control.new_bus(now, model, asks_for_id, watched)
    }

    /// Sets the state of the port; returns the old one and the number of the new one.
    pub(crate) fn set_port(&mut self, port: PortState) -> (PortState, u32) {
        self.generation += 1;
        self.outbox.touch();
        let now = self.now();
        self.control.closed(now, Input::Closed);
        let mut before = std::mem::replace(&mut self.port, port);
        if let PortState::Open(open) = &mut before {
            // A scan or an ID change that ends with its port is reported as cancelled.
            let BusEnd { last, left } = open.host.close(now);
            for event in last {
                match event {
                    Event::Line(traffic) => self.traffic.push(traffic),
                    event => forward(&mut self.outbox, &mut open.stage, &open.host.bus, event),
                }
            }
            self.traffic.send_soon();
            if let Line::Serial(line) = &open.host.line {
                self.left.of(line.usb()).carry(left);
            }
        }
        (before, self.generation)
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
        let adapter = open.host.line.adapter();
        let driven = open.host.bus.left_driven().map(|motor| motor.id).collect();
        if let Line::Serial(line) = &mut open.host.line {
            if matches!(open.stage, Stage::OnTrial { .. }) {
                self.left.lost_on_trial += 1;
            } else {
                self.left.foreign = std::mem::take(&mut line.others_of_make);
            }
        }
        self.outbox.notice(Notice::AdapterLost { driven });
        self.control.closed(now, Input::Unplugged);
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
        let mut leaving = None;
        if let PortState::Open(open) = &mut self.port {
            let OpenPort {
                host,
                stage,
                asks_again,
                driven_file,
                next_wire,
                ..
            } = &mut **open;
            if let Some(wire) = *next_wire
                && host.bus.motors(now).all(|motor| is_at_rest(&motor))
            {
                *next_wire = None;
                host.line.set_wire(now, wire);
            }
            let asks_again_at = asks_again.turn(now, &mut host.bus);
            // Virtual motors need no file.
            let left = match &host.line {
                Line::Serial(serial) => Some(self.left.of(serial.usb())),
                Line::Virtual(..) => None,
            };
            let mut is_remembered = true;
            let turned = self.control.turn(
                now,
                || self.clock.now(),
                host,
                |bus| {
                    if let Some(left) = &left {
                        is_remembered &=
                            driven_file.remember(bus.model(), || bus.left_driven(), left);
                    }
                },
                |bus, event| match event {
                    Event::PingPage => {
                        post(&ToPage::Ping);
                        self.outbox.pinged(now);
                    }
                    // Events of a port on trial too: the log shows all traffic.
                    Event::Line(traffic) => self.traffic.push(traffic),
                    // The page knows that nothing answers.
                    Event::IdQueryEnded(outcome) if !asks_again.ended(now, outcome) => {}
                    event => {
                        if let Event::StopEnded(_) = event
                            && let Stage::Closing(then) = stage
                        {
                            leaving = Some(std::mem::take(then));
                        }
                        forward(&mut self.outbox, stage, bus, event);
                    }
                },
            );
            if !is_remembered && !std::mem::replace(&mut self.told_not_remembered, true) {
                self.outbox.notice(Notice::NotRemembered);
            }
            wake = match turned {
                Turned::Wait(at) => asks_again_at.into_iter().chain([at]).min(),
                // The reader of the port notices the loss, and calls `adapter_lost`.
                Turned::Gone => None,
            };
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
        leaving
    }

    fn current_state(&self, now: Instant) -> Update {
        let mut update = Update::without_motors(now, self.port.connection());
        update.halted = self.control.is_halted;
        if let PortState::Open(open) = &self.port
            && !matches!(open.stage, Stage::OnTrial { .. })
        {
            update.motors = open.host.bus.motors(now).collect();
            update.job = open.host.bus.job();
            update.raw = open.host.bus.raw();
            update.line = Some(open.host.bus.line_status(now));
        }
        update
    }
}

/// Whether nothing is asked of this motor, now or after a stop.
fn is_at_rest(motor: &MotorStatus) -> bool {
    motor.activity == Activity::Idle && motor.waiting.is_none()
}
