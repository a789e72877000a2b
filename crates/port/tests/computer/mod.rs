//! A computer with adapters that are alike, in virtual time.

use std::time::Duration;

use motorlink_bus::{
    Bus, BusSettings, Command, Consent, Event, LeftDriven, Output, StopOutcome, StopReason,
};
use motorlink_messages::{LeftBehind, ModelChoice};
use motorlink_port::{IfNoReply, Opening, Others, Step};
use motorlink_protocol::{
    Frame, Instant, MotorId, Setpoint, SpeedTarget,
    family::{Model, Request},
};
use motorlink_simulator::{LineCondition, World, WorldConfig};

/// How long a port takes to open, and to close.
const OPENS_IN: Duration = Duration::from_millis(5);
/// An opening ends within this for each of its ports: three models, a stop for each, and the wait for the wanted motor.
pub const ENDS_WITHIN: Duration = Duration::from_secs(6);

pub fn id(address: u8) -> MotorId {
    MotorId::new(address).unwrap()
}

/// An adapter with its motors.
pub struct Adapter {
    pub world: World,
    /// Whether another program has it.
    pub is_taken: bool,
    /// What was sent to its motors since the opening began, with the model of the bus.
    pub sent: Vec<(Model, Frame)>,
}

impl Adapter {
    /// Motors of this model, all at rest.
    pub fn new(model: Model, motors: &[u8]) -> Self {
        let motors = motors.iter().map(|address| id(*address));
        Self {
            world: World::new(WorldConfig::of(model, motors)),
            is_taken: false,
            sent: Vec::new(),
        }
    }

    /// What it has got beside queries.
    pub fn acts(&self) -> Vec<&Frame> {
        let acts = self.sent.iter().filter(|(model, frame)| {
            let request = Request::parse(*model, frame);
            !matches!(
                request,
                Ok(Request::Query { .. } | Request::IdQuery | Request::ModeQuery { .. })
            )
        });
        acts.map(|(_, frame)| frame).collect()
    }

    pub fn rpm(&self, address: u8) -> f32 {
        self.world.motor(id(address)).unwrap().speed_rpm().abs()
    }
}

/// The computer, and what its open port does.
pub struct Computer {
    pub now: Instant,
    pub adapters: Vec<Adapter>,
    pub left: LeftBehind,
    open: Option<(usize, Bus)>,
    /// Stops of motors that were left driven: each motor, and whether its standstill was confirmed.
    pub stops: Vec<Vec<(MotorId, bool)>>,
    settings: BusSettings,
    /// Whether the motors that were left driven can be on one of the adapters only.
    pub are_unlike: bool,
    /// So many of the adapters are tried.
    pub candidates: usize,
    /// A person presses STOP then.
    pub stop_at: Option<Instant>,
    /// The line of this adapter is good again then.
    pub good_again: Option<(usize, Instant)>,
    /// The computer sleeps so long as soon as this port is on trial.
    pub sleeps: Option<(usize, Duration)>,
}

impl Computer {
    pub fn new(adapters: Vec<Adapter>) -> Self {
        Self {
            now: Instant::from_millis(1_000),
            candidates: adapters.len(),
            adapters,
            left: LeftBehind::default(),
            open: None,
            stops: Vec::new(),
            settings: BusSettings::default(),
            are_unlike: false,
            stop_at: None,
            good_again: None,
            sleeps: None,
        }
    }

    /// From now on nothing crosses the line of this adapter, for so long.
    pub fn cut(&mut self, place: usize, time: Duration) {
        let adapter = &mut self.adapters[place];
        adapter
            .world
            .set_line_condition(self.now, LineCondition::Dead);
        self.good_again = Some((place, self.now + time));
    }

    /// A program drives these motors over an adapter, and is killed.
    pub fn leave_driven(&mut self, place: usize, model: Model, motors: &[u8], rpm: i32) {
        let bus = Bus::with_model(self.now, model);
        let watched = motors.iter().map(|address| id(*address));
        let bus = bus.prepared(self.now, self.settings, false, watched);
        self.open = Some((place, bus));
        self.run(Duration::from_millis(700));
        for address in motors {
            let start = Command::Start {
                id: id(*address),
                setpoint: Setpoint::velocity(SpeedTarget::new(rpm).unwrap()),
                consent: Consent::None,
            };
            let now = self.now;
            self.bus().command(now, start).unwrap();
            self.run(Duration::from_millis(400));
        }
        self.run(Duration::from_secs(1));
        let motors = self.bus().left_driven().collect::<Vec<LeftDriven>>();
        self.left = LeftBehind { model, motors };
        self.open = None;
        for adapter in &mut self.adapters {
            adapter.sent.clear();
            adapter.world.advance(self.now);
        }
    }

    fn bus(&mut self) -> &mut Bus {
        &mut self.open.as_mut().unwrap().1
    }

    /// Time passes.
    pub fn run(&mut self, time: Duration) {
        let end = self.now + time;
        loop {
            let good = self.good_again.map(|(_, at)| at);
            let wake = good.into_iter().chain([self.turn(), end]);
            let wake = wake.min().unwrap();
            let worlds = self
                .adapters
                .iter()
                .filter_map(|one| one.world.next_event());
            self.now = worlds.fold(wake, Instant::min).max(self.now);
            for (place, adapter) in self.adapters.iter_mut().enumerate() {
                adapter.world.advance(self.now);
                if self.good_again == Some((place, self.now)) {
                    self.good_again = None;
                    let world = &mut adapter.world;
                    world.set_line_condition(self.now, LineCondition::Good);
                }
                while let Some(chunk) = adapter.world.receive(self.now) {
                    if let Some((open, bus)) = &mut self.open
                        && *open == place
                    {
                        bus.receive(self.now, &chunk.bytes);
                    }
                }
            }
            if self.now >= end {
                self.turn();
                return;
            }
        }
    }

    fn turn(&mut self) -> Instant {
        let now = self.now;
        let Some((place, bus)) = &mut self.open else {
            return now + Duration::from_secs(1);
        };
        loop {
            match bus.poll(now) {
                Output::Transmit(frame) => {
                    let adapter = &mut self.adapters[*place];
                    adapter.world.transmit(now, frame.bytes());
                    adapter.sent.push((bus.model(), frame));
                }
                Output::Event(Event::PingPage) => bus.page_answered(now),
                Output::Event(Event::StopEnded(report))
                    if report.reason == StopReason::LeftDriven =>
                {
                    let stopped = report.motors.iter();
                    let stopped = stopped.map(|one: &StopOutcome| (one.id, one.confirmed));
                    self.stops.push(stopped.collect());
                }
                Output::Event(_) => {}
                Output::Wait(at) => return at,
            }
        }
    }

    /// Opens one of the ports. Returns its place, and the model that it is open for.
    pub fn open(
        &mut self,
        wanted: u8,
        choice: ModelChoice,
        if_no_reply: IfNoReply,
    ) -> Option<(usize, Model)> {
        let (all, ports) = (self.adapters.len(), self.candidates);
        let asleep = self.sleeps.map(|(_, time)| time).unwrap_or_default();
        let ends = self.now + ENDS_WITHIN * u32::try_from(ports + 1).unwrap() + asleep;
        let mut opening = Opening::new(ports, id(wanted), choice, if_no_reply);
        loop {
            assert!(self.now < ends, "it is still opening: {opening:?}");
            if self.stop_at.is_some_and(|at| at <= self.now)
                && let Some((_, bus)) = &mut self.open
            {
                self.stop_at = None;
                let stop = Command::StopAll(StopReason::Operator);
                bus.command(self.now, stop).unwrap();
            }
            let bus = self.open.as_mut().map(|(_, bus)| bus);
            match opening.step(self.now, bus, &mut self.left) {
                Step::Claim(place) => {
                    assert!(self.open.is_none());
                    if self.adapters[place].is_taken {
                        opening.refused(&self.left);
                    }
                }
                Step::Open(place, model) => {
                    assert!(self.open.is_none(), "a port is open");
                    self.run(OPENS_IN);
                    let baud = model.spec().baud;
                    self.adapters[place].world.set_baud(self.now, baud);
                    let bus = Bus::with_model(self.now, model).after_another(self.now);
                    let bus = bus.on_trial();
                    let mut bus = bus.prepared(self.now, self.settings, true, [id(wanted)]);
                    let others = Others {
                        count: if self.are_unlike { 0 } else { all - 1 },
                        tried: ports - 1,
                    };
                    opening.opened(self.now, &mut bus, &mut self.left, others);
                    self.open = Some((place, bus));
                }
                Step::Close => {
                    assert!(!self.bus().is_stopping(), "a stop is cut off");
                    let model = self.bus().model();
                    let motors = self.bus().left_driven().collect();
                    self.left.carry(LeftBehind { model, motors });
                    self.open = None;
                    self.run(OPENS_IN);
                }
                Step::Wait
                    if self
                        .sleeps
                        .is_some_and(|(place, _)| place == opening.port()) =>
                {
                    let (_, time) = self.sleeps.take().unwrap();
                    self.now = self.now + time;
                }
                Step::Wait => self.run(Opening::STEP),
                Step::Done => {
                    let now = self.now;
                    let bus = self.bus();
                    bus.end_trial(now);
                    if bus.model_known() {
                        assert_eq!(bus.model(), opening.choice().model);
                    }
                    return Some((opening.port(), bus.model()));
                }
                Step::Failed => {
                    assert!(self.open.is_none(), "a port stays open");
                    return None;
                }
            }
        }
    }
}
