//! Generates a list of actions from a seed.

use std::time::Duration;

use fastrand::Rng;
use motorlink_bus::{
    BusSettings, Command, CommandRate, Consent, GroupSetpoints, Limits, Ramp, RawInterval, Repeat,
    SetIdFrames, StopReason,
};
use motorlink_protocol::{
    AssignableId, CurrentTarget, Frame, Mode, MotorId, PositionTarget, Request, Setpoint,
    SpeedTarget, family::Model,
};

use crate::{
    action::{Absence, Action, LineFault, PendingInput},
    of_model::in_terms_of,
};

/// Random draws per scenario: single actions, and sometimes a sequence of several.
const DRAWS: usize = 30;
/// One draw in this many is a sequence.
const SEQUENCE_EVERY: u8 = 6;
/// One action in this many is preceded by a sequence that is run.
const RUN_EVERY: usize = 12;
/// Sequences have random numbers of their own, so that the other actions of a seed stay as they are.
const SEQUENCES: u64 = 0x5E90_E4CE;
/// The address of the ID query, for all motors.
const ALL: u8 = 0xC8;
/// Pauses after an action in milliseconds: from within an exchange to the end of any stop.
const PAUSES_MS: [u64; 8] = [0, 1, 3, 10, 30, 150, 700, 2_500];

/// A scenario: motors and actions.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// The seed that generates it.
    pub seed: u64,
    /// The model of the motors.
    pub model: Model,
    /// The addresses on the line.
    pub motors: Vec<MotorId>,
    /// Motors that switch only after five mode switch frames.
    pub need_five_switches: Vec<MotorId>,
    /// Whether the motors obey drive frames to 0xC8.
    pub obey_all: bool,
    /// The actions in order.
    pub actions: Vec<Action>,
}

impl Scenario {
    /// The scenario of this seed for motors of this model.
    #[must_use]
    pub fn of(model: Model, seed: u64) -> Self {
        Self::from_seed(seed).for_model(model)
    }

    /// The same for another model.
    #[must_use]
    pub fn for_model(self, model: Model) -> Self {
        Self {
            actions: in_terms_of(model, self.actions),
            model,
            ..self
        }
    }

    /// The scenario of this seed for DDSM115 motors.
    #[must_use]
    pub fn from_seed(seed: u64) -> Self {
        let mut generator = Generator {
            rng: Rng::with_seed(seed),
            motors: Vec::new(),
            settings: BusSettings::default(),
        };
        let count = generator.rng.u8(1..=4);
        generator.motors = (1..=count).filter_map(|id| MotorId::new(id).ok()).collect();
        let obey_all = generator.rng.u8(..4) == 0;
        let need_five_switches = generator.some_motors();
        let mut actions = Vec::new();
        // An ID change needs a complete scan before it, which random pauses would rarely wait for.
        if let (1, Some(from), Some(to)) = (count, generator.motors.first(), another_id()) {
            actions.push(Action::Command(Command::FullScan));
            actions.push(Action::Pause(Duration::from_secs(5)));
            actions.push(Action::Command(Command::SetId {
                from: *from,
                to,
                frames: SetIdFrames::Five,
            }));
        }
        for _ in 0..DRAWS {
            if generator.rng.u8(..SEQUENCE_EVERY) == 0 {
                actions.extend(generator.sequence());
            } else {
                actions.push(generator.action());
            }
            let pause = PAUSES_MS.get(generator.rng.usize(..PAUSES_MS.len()));
            actions.push(pause_ms(pause.copied().unwrap_or_default()));
        }
        Self {
            seed,
            model: Model::Ddsm115,
            motors: generator.motors,
            need_five_switches,
            obey_all,
            actions,
        }
    }

    /// The scenario of this seed, in which random sequences are run as well. The motors are there and
    /// the line is good when one is armed; what happens then is as random as before.
    #[must_use]
    pub fn with_sequences(seed: u64) -> Self {
        let scenario = Self::from_seed(seed);
        let mut rng = Rng::with_seed(seed ^ SEQUENCES);
        let mut actions = Vec::new();
        for (place, action) in scenario.actions.into_iter().enumerate() {
            if place % RUN_EVERY == 0 {
                actions.extend([
                    Action::Replug,
                    Action::PageHangs(false),
                    Action::Line(LineFault::None),
                    Action::Command(Command::CancelJob),
                    Action::Command(Command::StopRaw),
                ]);
                let on = |id: &MotorId| Action::Power { id: *id, on: true };
                actions.extend(scenario.motors.iter().map(on));
                actions.push(Action::Command(Command::StopAll(StopReason::Operator)));
                actions.push(pause_ms(900));
                actions.push(Action::Command(Command::Release));
                actions.push(Action::RunSequence { seed: rng.u64(..) });
                actions.push(pause_ms(rng.u64(200..6_000)));
            }
            actions.push(action);
        }
        Self {
            actions,
            ..scenario
        }
    }
}

fn pause_ms(ms: u64) -> Action {
    Action::Pause(Duration::from_millis(ms))
}

fn another_id() -> Option<AssignableId> {
    AssignableId::new(MotorId::new(9).ok()?).ok()
}

struct Generator {
    rng: Rng,
    motors: Vec<MotorId>,
    /// As configured last.
    settings: BusSettings,
}

impl Generator {
    /// One action, mostly of the operator, so that motors are driven.
    fn action(&mut self) -> Action {
        let id = self.motor();
        match self.rng.u8(..33) {
            0..=17 => Action::Command(self.command(id)),
            18..=20 => Action::Line(self.line()),
            21 => Action::Power { id, on: false },
            22 => Action::Power { id, on: true },
            23 => Action::Load {
                id,
                tenths_nm: self.rng.u8(..=25),
            },
            24 => Action::Heat {
                id,
                celsius: if self.rng.bool() { 90 } else { 30 },
            },
            25 => Action::PageHangs(true),
            26 => Action::PageHangs(false),
            27 => Action::PageClosed,
            28 => Action::Unplug,
            29 => Action::Replug,
            30 => self.away(),
            31 => self.refuses(),
            _ => self.cuts(),
        }
    }

    /// A sequence of actions that single draws rarely produce.
    fn sequence(&mut self) -> Vec<Action> {
        let id = self.motor();
        // Start from rest on a healthy line.
        let mut actions = vec![
            Action::Replug,
            Action::PageHangs(false),
            Action::Line(LineFault::None),
            Action::Power { id, on: true },
            Action::Command(Command::Release),
            Action::Command(Command::Stop(id)),
            pause_ms(600),
        ];
        match self.rng.u8(..9) {
            0 => self.hold(id, &mut actions),
            1 => self.reverse(id, &mut actions),
            2 => self.stop_at_an_angle(id, &mut actions),
            3 => {
                actions.push(drive(id, self.speed()));
                actions.push(pause_ms(self.rng.u64(50..900)));
                actions.push(self.away());
            }
            4 => {
                actions.push(Action::Line(LineFault::Mixes));
                actions.push(Action::Command(Command::IdQuery));
                actions.push(pause_ms(self.rng.u64(60..300)));
            }
            5 => {
                actions.push(Action::Command(self.raw(id)));
                actions.push(pause_ms(self.rng.u64(10..400)));
                actions.push(Action::Command(Command::StopRaw));
            }
            6 => {
                actions.push(drive(id, self.speed()));
                actions.push(pause_ms(self.rng.u64(50..900)));
                actions.push(self.refuses());
                actions.push(Action::Command(self.stop(id)));
            }
            7 => self.switch_on_a_late_line(id, &mut actions),
            _ => {
                actions.extend(self.together().map(|parts| {
                    let consent = Consent::None;
                    Action::Command(Command::DriveGroup {
                        setpoints: parts,
                        consent,
                    })
                }));
                actions.push(Action::Line(LineFault::Gathers(self.rng.u8(20..=70))));
            }
        }
        actions
    }

    /// Hold, in the position loop mostly, on the way to an angle.
    fn hold(&mut self, id: MotorId, actions: &mut Vec<Action>) {
        let setpoint = if self.rng.u8(..4) > 0 {
            self.angle()
        } else {
            self.setpoint()
        };
        actions.push(switch(id, setpoint.mode()));
        actions.push(pause_ms(450));
        actions.push(drive(id, setpoint));
        actions.push(pause_ms(self.rng.u64(10..500)));
        actions.push(self.disturbance());
        actions.push(Action::Command(Command::Hold(id)));
        actions.push(pause_ms(1_000));
    }

    /// Mode switches on a line that begins to hold replies; some switches may be lost.
    fn switch_on_a_late_line(&mut self, id: MotorId, actions: &mut Vec<Action>) {
        let setpoint = self.setpoint();
        actions.push(switch(id, setpoint.mode()));
        actions.push(pause_ms(450));
        actions.push(drive(id, setpoint));
        actions.push(pause_ms(self.rng.u64(10..500)));
        actions.push(Action::Command(Command::Stop(id)));
        actions.push(pause_ms(600));
        actions.push(Action::Line(if self.rng.bool() {
            LineFault::Stalls
        } else {
            LineFault::Gathers(self.rng.u8(20..=70))
        }));
        for _ in 0..self.rng.u8(1..4) {
            actions.push(pause_ms(self.rng.u64(1..150)));
            actions.push(switch(id, self.mode()));
            if self.rng.u8(..3) == 0 {
                actions.push(self.cuts());
            }
        }
        if self.rng.bool() {
            actions.push(drive(id, self.setpoint()));
        } else {
            actions.push(pause_ms(self.rng.u64(50..200)));
            actions.push(Action::Command(self.stop(id)));
        }
        actions.push(pause_ms(700));
        actions.push(Action::Line(LineFault::None));
    }

    /// Torque in one direction, then in the other.
    fn reverse(&mut self, id: MotorId, actions: &mut Vec<Action>) {
        let amps = self.rng.f32() * 2.0 - 1.0;
        // One in five is so high that it needs consent.
        let amps = if amps.abs() > 0.8 { amps * 8.0 } else { amps };
        let current = |amps| Setpoint::Current(CurrentTarget::from_amps(amps));
        actions.push(switch(id, Mode::Current));
        actions.push(pause_ms(450));
        for turn in 0..self.rng.u8(2..6) {
            let amps = if turn % 2 == 0 { amps } else { -amps };
            actions.push(drive(id, current(amps)));
            actions.push(pause_ms(self.rng.u64(1..150)));
            actions.push(self.disturbance());
        }
    }

    /// A stop in the position loop.
    fn stop_at_an_angle(&mut self, id: MotorId, actions: &mut Vec<Action>) {
        actions.push(switch(id, Mode::Position));
        actions.push(pause_ms(450));
        actions.push(drive(id, self.angle()));
        actions.push(pause_ms(self.rng.u64(10..1_500)));
        actions.push(self.disturbance());
        actions.push(Action::Command(self.stop(id)));
        actions.push(pause_ms(self.rng.u64(100..900)));
    }

    fn stop(&mut self, id: MotorId) -> Command {
        if self.rng.bool() {
            Command::Stop(id)
        } else {
            Command::StopAll(StopReason::Operator)
        }
    }

    /// A fault that keeps frames from their motor, or none.
    fn disturbance(&mut self) -> Action {
        match self.rng.u8(..6) {
            0 => self.refuses(),
            1 => self.cuts(),
            2 => Action::Line(LineFault::LosesMuch),
            3 => Action::Line(self.line()),
            _ => Action::Line(LineFault::None),
        }
    }

    /// One frame, a few, or as many as a stop sends at first.
    fn refuses(&mut self) -> Action {
        let most = if self.rng.bool() { 6 } else { 40 };
        Action::PortRefuses {
            frames: self.rng.u8(1..=most),
        }
    }

    fn cuts(&mut self) -> Action {
        Action::PortTruncates {
            frames: self.rng.u8(1..=6),
            bytes: self.rng.u8(1..=9),
            reported: self.rng.bool(),
        }
    }

    /// The worker does not run for a while and then finds its inputs in any order.
    fn away(&mut self) -> Action {
        let (cause, lasts_ms) = if self.rng.bool() {
            (Absence::Sleep, self.rng.u64(2_000..=180_000))
        } else {
            (Absence::Delay, self.rng.u64(600..=30_000))
        };
        let mut pending = vec![PendingInput::Pong, PendingInput::Bytes, PendingInput::Poll];
        for _ in 0..self.rng.u8(..3) {
            let id = self.motor();
            pending.push(PendingInput::Command {
                command: self.command(id),
                age: Duration::from_millis(
                    [0, 100, 480, 590]
                        .get(self.rng.usize(..4))
                        .copied()
                        .unwrap_or(0),
                ),
            });
        }
        self.rng.shuffle(&mut pending);
        Action::WorkerAbsent {
            cause,
            duration: Duration::from_millis(lasts_ms),
            pending,
        }
    }

    fn some_motors(&mut self) -> Vec<MotorId> {
        let motors = self.motors.clone();
        motors
            .into_iter()
            .filter(|_| self.rng.u8(..4) == 0)
            .collect()
    }

    fn motor(&mut self) -> MotorId {
        let place = self.rng.usize(..self.motors.len().max(1));
        self.motors.get(place).copied().unwrap_or(MotorId::FIRST)
    }

    fn line(&mut self) -> LineFault {
        match self.rng.u8(..18) {
            0 => LineFault::LosesReplies,
            1 => LineFault::LosesRequests,
            2 => LineFault::CorruptsReplies,
            3 => LineFault::CorruptsRequests,
            4 => LineFault::Echoes,
            5 => LineFault::CutsEchoes(self.rng.u8(1..10)),
            6 => LineFault::Splits,
            7 => LineFault::Holds,
            8 => LineFault::Strays,
            9 => LineFault::Stranger,
            10 => LineFault::Stalls,
            11 => LineFault::LosesMuch,
            12 => LineFault::Mixes,
            13 => LineFault::Gathers(self.rng.u8(20..=70)),
            _ => LineFault::None,
        }
    }

    fn command(&mut self, id: MotorId) -> Command {
        let consent = self.consent();
        let setpoint = self.setpoint();
        match self.rng.u8(..38) {
            0..=8 => Command::Drive {
                id,
                setpoint,
                consent,
            },
            9..=11 => Command::Adjust {
                id,
                setpoint,
                consent,
            },
            12..=14 => match self.together() {
                Some(parts) => Command::DriveGroup {
                    setpoints: parts,
                    consent,
                },
                None => Command::Stop(id),
            },
            15 => match self.together() {
                Some(parts) => Command::AdjustGroup {
                    setpoints: parts,
                    consent,
                },
                None => Command::Stop(id),
            },
            16..=18 => Command::SwitchMode {
                id,
                mode: self.mode(),
            },
            19 => Command::Hold(id),
            20..=21 => Command::Stop(id),
            22 => Command::StopAll(StopReason::Operator),
            23..=24 => Command::Release,
            25 => Command::IdQuery,
            26 => Command::FullScan,
            27 => Command::CancelJob,
            28 => match MotorId::new(self.rng.u8(5..9))
                .ok()
                .and_then(|id| AssignableId::new(id).ok())
            {
                Some(to) => Command::SetId {
                    from: id,
                    to,
                    frames: SetIdFrames::Five,
                },
                None => Command::CancelJob,
            },
            29 => Command::Watch(id),
            30 => {
                self.settings.ramp = Ramp::new(self.rng.u16(50..2_000)).ok();
                Command::Configure(self.settings)
            }
            33..=34 => self.raw(id),
            35 => Command::StopRaw,
            31 | 36..=37 => {
                self.settings.limits = self.limits();
                Command::Configure(self.settings)
            }
            _ => {
                self.settings.rate = CommandRate::new(self.rng.u16(1..=500)).unwrap_or_default();
                Command::Configure(self.settings)
            }
        }
    }

    fn consent(&mut self) -> Consent {
        if self.rng.u8(..4) == 0 {
            Consent::HighCurrent
        } else {
            Consent::None
        }
    }

    /// A raw frame: drive, switch or query, within and beyond the limits, to one motor or all, well
    /// formed or not.
    fn raw(&mut self, id: MotorId) -> Command {
        let to = if self.rng.u8(..8) == 0 { ALL } else { id.get() };
        let [high, low] = self.value().to_be_bytes();
        let frame = match self.rng.u8(..12) {
            0 => Request::Query { id }.frame(),
            1..=2 => {
                let mode = self.mode();
                Frame::new([to, 0xA0, 0, 0, 0, 0, 0, 0, 0, mode.byte()])
            }
            3 => Request::drive(id, self.setpoint()).frame(),
            4 => Frame::with_crc([to, 0x64, high, low, 0, 0, 0, self.rng.u8(..), 0]),
            5 => Frame::with_crc([to, 0x64, high, low, 0, self.rng.u8(..), 0, 0, 1]),
            6 => Frame::new([to, 0x64, high, low, 0, 0, 0, 0, 0, self.rng.u8(..)]),
            7 => Frame::with_crc([to, self.rng.u8(..), high, low, 0, 0, 0, 0, 0]),
            _ => Frame::with_crc([to, 0x64, high, low, 0, 0, 0, 0, 0]),
        };
        let interval = RawInterval::new(self.rng.u16(2..=60));
        let repeat = match interval {
            Ok(interval) if self.rng.bool() => Repeat::Times {
                count: self.rng.u32(..60),
                interval,
            },
            _ => Repeat::Once,
        };
        Command::SendRaw {
            frame,
            repeat,
            consent: self.consent(),
        }
    }

    /// Bytes 2 and 3 of a drive frame: a speed, more than any speed, or any value.
    fn value(&mut self) -> i16 {
        match self.rng.u8(..4) {
            0 => self.rng.i16(-100..=100),
            1 => self.rng.i16(-330..=330),
            2 => self.rng.i16(-2_000..=2_000),
            _ => self.rng.i16(..),
        }
    }

    fn mode(&mut self) -> Mode {
        let mode = Mode::ALL.get(self.rng.usize(..3));
        mode.copied().unwrap_or(Mode::Velocity)
    }

    /// Limits that are mostly exceeded.
    fn limits(&mut self) -> Limits {
        let speed = self.rng.u16(10..=90);
        let current = self.rng.u16(100..=500);
        let temperature = self.rng.u16(30..=80);
        Limits::new(speed, current, temperature).unwrap_or_default()
    }

    fn setpoint(&mut self) -> Setpoint {
        match self.rng.u8(..24) {
            // One in four may need consent.
            0 => Setpoint::Current(CurrentTarget::from_amps(self.rng.f32() * 16.0 - 8.0)),
            1..=3 => Setpoint::Current(CurrentTarget::from_amps(self.rng.f32() * 2.0 - 1.0)),
            4..=7 => self.angle(),
            8..=11 => Setpoint::velocity(SpeedTarget::ZERO),
            _ => self.speed(),
        }
    }

    fn speed(&mut self) -> Setpoint {
        Setpoint::velocity(SpeedTarget::clamped(self.rng.i32(-200..=200)))
    }

    fn angle(&mut self) -> Setpoint {
        Setpoint::Position(PositionTarget::from_degrees(self.rng.f32() * 360.0))
    }

    fn together(&mut self) -> Option<GroupSetpoints> {
        let speed = self.rng.i32(-100..=100);
        let turn = |(place, id): (usize, &MotorId)| {
            let speed = if place % 2 == 0 { speed } else { -speed };
            (*id, Setpoint::velocity(SpeedTarget::clamped(speed)))
        };
        let parts: Vec<_> = self.motors.iter().enumerate().map(turn).collect();
        GroupSetpoints::new(&parts).ok()
    }
}

fn switch(id: MotorId, mode: Mode) -> Action {
    Action::Command(Command::SwitchMode { id, mode })
}

fn drive(id: MotorId, setpoint: Setpoint) -> Action {
    Action::Command(Command::Drive {
        id,
        setpoint,
        consent: Consent::None,
    })
}
