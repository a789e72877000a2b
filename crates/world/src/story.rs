//! From a seed to a list of acts.

use std::time::Duration;

use fastrand::Rng;
use motorlink_bus::{
    Command, CommandRate, Consent, Limits, Ramp, RawInterval, Repeat, StopReason, Together,
};
use motorlink_protocol::{
    AssignableId, CurrentTarget, Mode, MotorId, PositionTarget, Request, Setpoint, SpeedTarget,
};

use crate::act::{Act, LineFault};

/// Acts of one story.
const ACTS: usize = 60;
/// Time passes behind an act, in milliseconds: from within an exchange to the end of any stop.
const PAUSES_MS: [u64; 8] = [0, 1, 3, 10, 30, 150, 700, 2_500];

/// What happens, from the beginning to the end.
#[derive(Clone, Debug, PartialEq)]
pub struct Story {
    /// Where it comes from.
    pub seed: u64,
    /// The addresses on the line.
    pub motors: Vec<MotorId>,
    /// In this order.
    pub acts: Vec<Act>,
}

impl Story {
    /// The story of this seed.
    #[must_use]
    pub fn of(seed: u64) -> Self {
        let mut teller = Teller {
            rng: Rng::with_seed(seed),
            motors: Vec::new(),
        };
        let count = teller.rng.u8(1..=4);
        teller.motors = (1..=count).filter_map(|id| MotorId::new(id).ok()).collect();
        let mut acts = Vec::new();
        // An ID is changed only behind a whole scan, which chance alone would hardly wait for.
        if let (1, Some(from), Some(to)) = (count, teller.motors.first(), another_id()) {
            acts.push(Act::Command(Command::FullScan));
            acts.push(Act::Pause(Duration::from_secs(5)));
            acts.push(Act::Command(Command::SetId { from: *from, to }));
        }
        for _ in 0..ACTS {
            acts.push(teller.act());
            let pause = PAUSES_MS.get(teller.rng.usize(..PAUSES_MS.len()));
            acts.push(Act::Pause(Duration::from_millis(
                pause.copied().unwrap_or_default(),
            )));
        }
        Self {
            seed,
            motors: teller.motors,
            acts,
        }
    }
}

fn another_id() -> Option<AssignableId> {
    AssignableId::new(MotorId::new(9).ok()?).ok()
}

struct Teller {
    rng: Rng,
    motors: Vec<MotorId>,
}

impl Teller {
    /// Mostly the operator, so that there is something to go wrong.
    fn act(&mut self) -> Act {
        let id = self.motor();
        match self.rng.u8(..30) {
            0..=17 => Act::Command(self.command(id)),
            18..=20 => Act::Line(self.line()),
            21 => Act::Power { id, on: false },
            22 => Act::Power { id, on: true },
            23 => Act::Load {
                id,
                tenths_nm: self.rng.u8(..=25),
            },
            24 => Act::Heat {
                id,
                celsius: if self.rng.bool() { 90 } else { 30 },
            },
            25 => Act::PageHangs(true),
            26 => Act::PageHangs(false),
            27 => Act::PageGoes,
            28 => Act::Unplug,
            _ => Act::Replug,
        }
    }

    fn motor(&mut self) -> MotorId {
        let place = self.rng.usize(..self.motors.len().max(1));
        self.motors.get(place).copied().unwrap_or(MotorId::FIRST)
    }

    fn line(&mut self) -> LineFault {
        match self.rng.u8(..15) {
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
            _ => LineFault::None,
        }
    }

    fn command(&mut self, id: MotorId) -> Command {
        let consent = Consent::None;
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
                Some(parts) => Command::DriveTogether { parts, consent },
                None => Command::Stop(id),
            },
            15 => match self.together() {
                Some(parts) => Command::AdjustTogether { parts, consent },
                None => Command::Stop(id),
            },
            16..=18 => Command::SwitchMode {
                id,
                mode: Mode::ALL
                    .get(self.rng.usize(..3))
                    .copied()
                    .unwrap_or(Mode::Velocity),
            },
            19 => Command::Hold(id),
            20..=21 => Command::Stop(id),
            22 => Command::StopAll(StopReason::Operator),
            23..=24 => Command::Release,
            25 => Command::IdQuery,
            26 => Command::FullScan,
            27 => Command::CancelSurvey,
            28 => match MotorId::new(self.rng.u8(5..9))
                .ok()
                .and_then(|id| AssignableId::new(id).ok())
            {
                Some(to) => Command::SetId { from: id, to },
                None => Command::CancelSurvey,
            },
            29 => Command::Watch(id),
            30 => Command::SetRamp(Ramp::new(self.rng.u16(50..2_000)).ok()),
            33..=34 => self.raw(id),
            35 => Command::StopRaw,
            31 | 36..=37 => Command::SetLimits(self.limits()),
            _ => Command::SetRate(CommandRate::new(self.rng.u16(1..=500)).unwrap_or_default()),
        }
    }

    /// Frames that a person wrote: to drive, to switch, to ask.
    fn raw(&mut self, id: MotorId) -> Command {
        let request = match self.rng.u8(..4) {
            0 => Request::Query { id },
            1 => Request::SwitchMode {
                id,
                mode: Mode::Current,
            },
            _ => Request::drive(id, self.setpoint()),
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
            frame: request.frame(),
            repeat,
            consent: Consent::None,
        }
    }

    /// Mostly such that something crosses them.
    fn limits(&mut self) -> Limits {
        let speed = self.rng.u16(10..=90);
        let current = self.rng.u16(100..=500);
        let temperature = self.rng.u16(30..=80);
        Limits::new(speed, current, temperature).unwrap_or_default()
    }

    fn setpoint(&mut self) -> Setpoint {
        match self.rng.u8(..6) {
            0 => Setpoint::Current(CurrentTarget::from_amps(self.rng.f32() * 2.0 - 1.0)),
            1 => Setpoint::Position(PositionTarget::from_degrees(self.rng.f32() * 360.0)),
            2 => Setpoint::velocity(SpeedTarget::ZERO),
            _ => Setpoint::velocity(SpeedTarget::clamped(self.rng.i32(-200..=200))),
        }
    }

    fn together(&mut self) -> Option<Together> {
        let speed = self.rng.i32(-100..=100);
        let turn = |(place, id): (usize, &MotorId)| {
            let speed = if place % 2 == 0 { speed } else { -speed };
            (*id, Setpoint::velocity(SpeedTarget::clamped(speed)))
        };
        let parts: Vec<_> = self.motors.iter().enumerate().map(turn).collect();
        Together::new(&parts).ok()
    }
}
