//! Random sessions, as users and bad lines make them.

use motorlink_bus::{Command, Consent, StopReason};
use motorlink_messages::Update;
use motorlink_protocol::family::Model;
use motorlink_simulator::{Echo, WireFaults};

use super::live::{Live, amps, degrees, id, ms, rpm};

/// Marsaglia's xorshift: the same seed gives the same session.
pub struct Dice(u64);

impl Dice {
    pub const fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15))
    }

    pub const fn below(&mut self, end: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) % end
    }

    fn small(&mut self, end: u16) -> u16 {
        u16::try_from(self.below(end.into())).unwrap()
    }

    pub fn faults(&mut self) -> WireFaults {
        match self.below(4) {
            0 => WireFaults {
                lose_reply: 0.1,
                stray: 0.1,
                ..WireFaults::default()
            },
            1 => WireFaults {
                echo: Echo::Whole,
                ..WireFaults::default()
            },
            2 => WireFaults {
                corrupt_reply: 0.1,
                corrupt_request: 0.05,
                ..WireFaults::default()
            },
            _ => WireFaults::default(),
        }
    }

    pub fn command(&mut self, model: Model) -> Command {
        let id = id(1 + u8::try_from(self.below(2)).unwrap());
        let loops = model.modes();
        let mode = loops[usize::from(self.small(4)) % loops.len()];
        let setpoint = match self.below(4) {
            0 => amps(f32::from(self.small(8)) / 4.0 - 1.0),
            1 => degrees(f32::from(self.small(180)) * 2.0),
            2 => rpm(0),
            _ => rpm(i32::from(self.small(200)) - 100),
        };
        let consent = Consent::None;
        match self.below(10) {
            0 => Command::StopAll(StopReason::Operator),
            1 | 2 => Command::Release,
            3 => Command::Stop(id),
            4 | 5 => Command::SwitchMode { id, mode },
            6 => Command::Hold(id),
            _ => Command::Drive {
                id,
                setpoint,
                consent,
            },
        }
    }
}

/// A session file of some seconds, and what the page has shown.
pub fn session(model: Model, seed: u64, commands: u32) -> (Vec<u8>, Vec<Update>) {
    let mut dice = Dice::new(seed);
    let mut live = Live::of(model);
    for _ in 0..commands {
        if dice.below(10) == 0 {
            live.world.set_faults(dice.faults());
        }
        let command = dice.command(model);
        // Many are refused in the state of the moment.
        let _: Result<(), _> = live.command(command);
        live.run(ms(dice.below(900)));
    }
    live.end()
}
