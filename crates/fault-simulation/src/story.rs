//! From a seed to a list of acts.

use std::time::Duration;

use fastrand::Rng;
use motorlink_bus::{
    Command, CommandRate, Consent, GroupSetpoints, Limits, Ramp, RawInterval, Repeat, SetIdFrames,
    StopReason,
};
use motorlink_protocol::{
    AssignableId, CurrentTarget, Frame, Mode, MotorId, PositionTarget, Request, Setpoint,
    SpeedTarget,
};

use crate::act::{Absence, Act, LineFault, Turn};

/// Draws of one story: acts, or now and then a scene of several.
const DRAWS: usize = 30;
/// One draw in so many is a scene.
const SCENE_EVERY: u8 = 6;
/// The address of the ID query, which all motors hear.
const ALL: u8 = 0xC8;
/// Time passes behind an act, in milliseconds: from within an exchange to the end of any stop.
const PAUSES_MS: [u64; 8] = [0, 1, 3, 10, 30, 150, 700, 2_500];

/// What happens, from the beginning to the end.
#[derive(Clone, Debug, PartialEq)]
pub struct Story {
    /// Where it comes from.
    pub seed: u64,
    /// The addresses on the line.
    pub motors: Vec<MotorId>,
    /// Those of them that take a loop only after five mode switches.
    pub need_five_switches: Vec<MotorId>,
    /// Whether they obey drive frames to 0xC8.
    pub obey_all: bool,
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
        let obey_all = teller.rng.u8(..4) == 0;
        let need_five_switches = teller.some_motors();
        let mut acts = Vec::new();
        // An ID is changed only behind a whole scan, which chance alone would hardly wait for.
        if let (1, Some(from), Some(to)) = (count, teller.motors.first(), another_id()) {
            acts.push(Act::Command(Command::FullScan));
            acts.push(Act::Pause(Duration::from_secs(5)));
            acts.push(Act::Command(Command::SetId {
                from: *from,
                to,
                frames: SetIdFrames::Five,
            }));
        }
        for _ in 0..DRAWS {
            if teller.rng.u8(..SCENE_EVERY) == 0 {
                acts.extend(teller.scene());
            } else {
                acts.push(teller.act());
            }
            let pause = PAUSES_MS.get(teller.rng.usize(..PAUSES_MS.len()));
            acts.push(pause_ms(pause.copied().unwrap_or_default()));
        }
        Self {
            seed,
            motors: teller.motors,
            need_five_switches,
            obey_all,
            acts,
        }
    }
}

fn pause_ms(ms: u64) -> Act {
    Act::Pause(Duration::from_millis(ms))
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
        match self.rng.u8(..33) {
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
            29 => Act::Replug,
            30 => self.away(),
            31 => self.refuses(),
            _ => self.cuts(),
        }
    }

    /// What chance alone would hardly put in a row.
    fn scene(&mut self) -> Vec<Act> {
        let id = self.motor();
        // Nothing is driven, nothing is in the way.
        let mut acts = vec![
            Act::Replug,
            Act::PageHangs(false),
            Act::Line(LineFault::None),
            Act::Power { id, on: true },
            Act::Command(Command::Release),
            Act::Command(Command::Stop(id)),
            pause_ms(600),
        ];
        match self.rng.u8(..8) {
            0 => self.hold(id, &mut acts),
            1 => self.reverse(id, &mut acts),
            2 => self.stop_at_an_angle(id, &mut acts),
            3 => {
                acts.push(drive(id, self.speed()));
                acts.push(pause_ms(self.rng.u64(50..900)));
                acts.push(self.away());
            }
            4 => {
                acts.push(Act::Line(LineFault::Mixes));
                acts.push(Act::Command(Command::IdQuery));
                acts.push(pause_ms(self.rng.u64(60..300)));
            }
            5 => {
                acts.push(Act::Command(self.raw(id)));
                acts.push(pause_ms(self.rng.u64(10..400)));
                acts.push(Act::Command(Command::StopRaw));
            }
            6 => {
                acts.push(drive(id, self.speed()));
                acts.push(pause_ms(self.rng.u64(50..900)));
                acts.push(self.refuses());
                acts.push(Act::Command(self.stop(id)));
            }
            _ => {
                acts.extend(self.together().map(|parts| {
                    let consent = Consent::None;
                    Act::Command(Command::DriveGroup {
                        setpoints: parts,
                        consent,
                    })
                }));
                acts.push(Act::Line(LineFault::Gathers(self.rng.u8(20..=70))));
            }
        }
        acts
    }

    /// Hold, in the position loop mostly, on the way to an angle.
    fn hold(&mut self, id: MotorId, acts: &mut Vec<Act>) {
        let setpoint = if self.rng.u8(..4) > 0 {
            self.angle()
        } else {
            self.setpoint()
        };
        acts.push(switch(id, setpoint.mode()));
        acts.push(pause_ms(450));
        acts.push(drive(id, setpoint));
        acts.push(pause_ms(self.rng.u64(10..500)));
        acts.push(self.trouble());
        acts.push(Act::Command(Command::Hold(id)));
        acts.push(pause_ms(1_000));
    }

    /// Torque one way, then the other.
    fn reverse(&mut self, id: MotorId, acts: &mut Vec<Act>) {
        let amps = self.rng.f32() * 2.0 - 1.0;
        // One in five is so high that it would have to be asked for.
        let amps = if amps.abs() > 0.8 { amps * 8.0 } else { amps };
        let current = |amps| Setpoint::Current(CurrentTarget::from_amps(amps));
        acts.push(switch(id, Mode::Current));
        acts.push(pause_ms(450));
        for turn in 0..self.rng.u8(2..6) {
            let amps = if turn % 2 == 0 { amps } else { -amps };
            acts.push(drive(id, current(amps)));
            acts.push(pause_ms(self.rng.u64(1..150)));
            acts.push(self.trouble());
        }
    }

    /// A stop in the position loop.
    fn stop_at_an_angle(&mut self, id: MotorId, acts: &mut Vec<Act>) {
        acts.push(switch(id, Mode::Position));
        acts.push(pause_ms(450));
        acts.push(drive(id, self.angle()));
        acts.push(pause_ms(self.rng.u64(10..1_500)));
        acts.push(self.trouble());
        acts.push(Act::Command(self.stop(id)));
        acts.push(pause_ms(self.rng.u64(100..900)));
    }

    fn stop(&mut self, id: MotorId) -> Command {
        if self.rng.bool() {
            Command::Stop(id)
        } else {
            Command::StopAll(StopReason::Operator)
        }
    }

    /// Something that keeps frames from their motor, or nothing.
    fn trouble(&mut self) -> Act {
        match self.rng.u8(..6) {
            0 => self.refuses(),
            1 => self.cuts(),
            2 => Act::Line(LineFault::LosesMuch),
            3 => Act::Line(self.line()),
            _ => Act::Line(LineFault::None),
        }
    }

    /// One frame, a few, or as many as a stop has in its first moments.
    fn refuses(&mut self) -> Act {
        let most = if self.rng.bool() { 6 } else { 40 };
        Act::Refuses {
            frames: self.rng.u8(1..=most),
        }
    }

    fn cuts(&mut self) -> Act {
        Act::Cuts {
            frames: self.rng.u8(1..=6),
            bytes: self.rng.u8(1..=9),
            told: self.rng.bool(),
        }
    }

    /// The worker is away, and finds all there is to do in any order.
    fn away(&mut self) -> Act {
        let (because, lasts_ms) = if self.rng.bool() {
            (Absence::Sleep, self.rng.u64(2_000..=180_000))
        } else {
            (Absence::Delay, self.rng.u64(600..=30_000))
        };
        let mut then = vec![Turn::Pong, Turn::Bytes, Turn::Poll];
        for _ in 0..self.rng.u8(..3) {
            let id = self.motor();
            then.push(Turn::Command {
                command: self.command(id),
                age: Duration::from_millis(
                    [0, 100, 480, 590]
                        .get(self.rng.usize(..4))
                        .copied()
                        .unwrap_or(0),
                ),
            });
        }
        self.rng.shuffle(&mut then);
        Act::Away {
            because,
            lasts: Duration::from_millis(lasts_ms),
            then,
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
            30 => Command::SetRamp(Ramp::new(self.rng.u16(50..2_000)).ok()),
            33..=34 => self.raw(id),
            35 => Command::StopRaw,
            31 | 36..=37 => Command::SetLimits(self.limits()),
            _ => Command::SetRate(CommandRate::new(self.rng.u16(1..=500)).unwrap_or_default()),
        }
    }

    fn consent(&mut self) -> Consent {
        if self.rng.u8(..4) == 0 {
            Consent::HighCurrent
        } else {
            Consent::None
        }
    }

    /// Frames that a person wrote: to drive, to switch, to ask, within limits and beyond them, to one
    /// motor or to all, well formed or not.
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

    /// Bytes 2 and 3 of a drive frame: a speed, more than any speed, or anything.
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

    /// Mostly such that something crosses them.
    fn limits(&mut self) -> Limits {
        let speed = self.rng.u16(10..=90);
        let current = self.rng.u16(100..=500);
        let temperature = self.rng.u16(30..=80);
        Limits::new(speed, current, temperature).unwrap_or_default()
    }

    fn setpoint(&mut self) -> Setpoint {
        match self.rng.u8(..24) {
            // One in four may have to be asked for.
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

fn switch(id: MotorId, mode: Mode) -> Act {
    Act::Command(Command::SwitchMode { id, mode })
}

fn drive(id: MotorId, setpoint: Setpoint) -> Act {
    Act::Command(Command::Drive {
        id,
        setpoint,
        consent: Consent::None,
    })
}
