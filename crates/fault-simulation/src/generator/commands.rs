//! Draws random commands of the operator and their values.

use motorlink_bus::{
    Command, CommandRate, Consent, GroupSetpoints, Limits, Ramp, RawInterval, Repeat, SetIdFrames,
    StopReason,
};
use motorlink_protocol::{
    AssignableId, CurrentTarget, Frame, Mode, MotorId, PositionTarget, Request, Setpoint,
    SpeedTarget,
};

use super::Generator;

/// The address of the ID query, for all motors.
const ALL: u8 = 0xC8;

impl Generator {
    pub(crate) fn command(&mut self, id: MotorId) -> Command {
        let consent = self.consent();
        let setpoint = self.setpoint();
        match self.rng.u8(..38) {
            0..=5 => Command::Drive {
                id,
                setpoint,
                consent,
            },
            6..=8 => Command::Start {
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
                Some(setpoints) if self.rng.bool() => Command::StartGroup { setpoints, consent },
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
    pub(super) fn raw(&mut self, id: MotorId) -> Command {
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

    pub(super) fn mode(&mut self) -> Mode {
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

    pub(super) fn setpoint(&mut self) -> Setpoint {
        match self.rng.u8(..24) {
            // One in four may need consent.
            0 => Setpoint::Current(CurrentTarget::from_amps(self.rng.f32() * 16.0 - 8.0)),
            1..=3 => Setpoint::Current(CurrentTarget::from_amps(self.rng.f32() * 2.0 - 1.0)),
            4..=7 => self.angle(),
            8..=11 => Setpoint::velocity(SpeedTarget::ZERO),
            _ => self.speed(),
        }
    }

    pub(crate) fn speed(&mut self) -> Setpoint {
        Setpoint::velocity(SpeedTarget::clamped(self.rng.i32(-200..=200)))
    }

    pub(super) fn angle(&mut self) -> Setpoint {
        Setpoint::Position(PositionTarget::from_degrees(self.rng.f32() * 360.0))
    }

    pub(super) fn together(&mut self) -> Option<GroupSetpoints> {
        let speed = self.rng.i32(-100..=100);
        let turn = |(place, id): (usize, &MotorId)| {
            let speed = if place % 2 == 0 { speed } else { -speed };
            (*id, Setpoint::velocity(SpeedTarget::clamped(speed)))
        };
        let parts: Vec<_> = self.motors.iter().enumerate().map(turn).collect();
        GroupSetpoints::new(&parts).ok()
    }
}
