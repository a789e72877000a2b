//! Days of random commands on bad lines: after a stop, only Release allows motion again.

use crate::fixture;
use crate::fixture::{Fixture, amps, degrees, id, ms, rpm};
use motorlink_bus::{Command, Consent, RawInterval, Repeat, SetIdFrames, StopReason};
use motorlink_protocol::{AssignableId, Frame, Mode, MotorId, Request};
use motorlink_simulator::{Echo, WireFaults, WorldConfig};

const DAYS: u64 = 40;
const ACTS: usize = 80;

/// Marsaglia's xorshift: the same seed gives the same day.
struct Dice(u64);

impl Dice {
    fn below(&mut self, end: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) % end
    }

    fn small(&mut self, end: u8) -> u8 {
        u8::try_from(self.below(end.into())).unwrap()
    }

    fn faults(&mut self) -> WireFaults {
        match self.below(4) {
            0 => WireFaults::default(),
            1 => WireFaults {
                lose_reply: 0.1,
                stray: 0.1,
                ..WireFaults::default()
            },
            2 => WireFaults {
                echo: Echo::Whole,
                hold: ms(16),
                ..WireFaults::default()
            },
            _ => WireFaults {
                echo: Echo::Cut(4),
                corrupt_reply: 0.1,
                corrupt_request: 0.05,
                ..WireFaults::default()
            },
        }
    }

    fn command(&mut self) -> Command {
        let id = id(1 + self.small(4));
        let consent = Consent::None;
        let setpoint = match self.below(4) {
            0 => rpm(i32::from(self.small(200)) - 100),
            1 => amps(f32::from(self.small(8)) / 4.0 - 1.0),
            2 => degrees(f32::from(self.small(180)) * 2.0),
            _ => rpm(0),
        };
        let mode = Mode::ALL[usize::from(self.small(3))];
        match self.below(16) {
            0 => Command::FullScan,
            1 => Command::IdQuery,
            2 => Command::CancelJob,
            3 => Command::StopAll(StopReason::Operator),
            4 => Command::Release,
            5 => Command::Stop(id),
            6 | 7 => {
                let frame = self.frame(id, mode, Request::drive(id, setpoint).frame());
                let repeat = self.repeat();
                Command::SendRaw {
                    frame,
                    repeat,
                    consent,
                }
            }
            8 => Command::StopRaw,
            9 => Command::SwitchMode { id, mode },
            10 | 11 => Command::Drive {
                id,
                setpoint,
                consent,
            },
            12 => Command::Adjust {
                id,
                setpoint,
                consent,
            },
            13 => Command::Hold(id),
            14 => Command::SetId {
                from: id,
                to: assignable(9),
                frames: SetIdFrames::Five,
            },
            _ => Command::Forget(id),
        }
    }

    fn frame(&mut self, id: MotorId, mode: Mode, drive: Frame) -> Frame {
        match self.below(6) {
            0 => drive,
            1 => Request::Query { id }.frame(),
            2 => Request::IdQuery.frame(),
            3 => Request::SwitchMode { id, mode }.frame(),
            4 => Request::SetId { id: assignable(9) }.frame(),
            _ => {
                let mut bytes = [0; 10];
                bytes.fill_with(|| u8::try_from(self.below(256)).unwrap());
                bytes[0] = id.get();
                Frame::new(bytes)
            }
        }
    }

    fn repeat(&mut self) -> Repeat {
        if self.below(2) == 0 {
            return Repeat::Once;
        }
        Repeat::Times {
            count: u32::from(self.small(5)),
            interval: RawInterval::new(2 + u16::from(self.small(50))).unwrap(),
        }
    }
}

fn assignable(address: u8) -> AssignableId {
    AssignableId::new(id(address)).unwrap()
}

/// While stopped, a motor is asked, called, braked or brought into the velocity loop, and no more.
fn assert_harmless(sent: &[fixture::Sent], context: &str) {
    for sent in sent {
        match Request::parse(&sent.frame) {
            Ok(Request::Drive { drive, .. }) => {
                assert!(drive.brakes() && drive.signed() == 0, "{context}: {sent:?}");
            }
            Ok(
                Request::Query { .. }
                | Request::IdQuery
                | Request::SwitchMode {
                    mode: Mode::Velocity,
                    ..
                },
            ) => {}
            other => panic!("{context}: {sent:?} is {other:?}"),
        }
    }
}

#[test]
fn a_stopped_bus_drives_nothing_after_any_press_but_release() {
    for seed in 1..=DAYS {
        let mut dice = Dice(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15));
        let faults = dice.faults();
        let motors = 1 + dice.small(3);
        let mut fixture = Fixture::new(WorldConfig {
            seed,
            faults,
            ..WorldConfig::with_ids((1..=motors).map(id))
        });
        for motor in 1..=motors {
            fixture.command(Command::Watch(id(motor))).unwrap();
        }
        fixture.run(ms(200));
        for act in 0..ACTS {
            let command = dice.command();
            // A refusal is as good an end of an act as any.
            let outcome = fixture.command(command);
            fixture.page_lives = dice.below(20) != 0;
            let stopped = fixture.bus.is_halted();
            let before = fixture.sent.len();
            fixture.run(ms([1, 5, 20, 100, 700, 3_000][usize::from(dice.small(6))]));
            if stopped {
                let context = format!("seed {seed}, act {act}, {command:?}: {outcome:?}");
                assert_harmless(&fixture.sent[before..], &context);
            }
            fixture.page_lives = true;
            fixture.bus.page_answered(fixture.now);
        }
        fixture
            .command(Command::StopAll(StopReason::Operator))
            .unwrap();
        fixture.run(ms(8_000));
        for motor in fixture.world.motors() {
            assert!(motor.speed_rpm().abs() < 1.0, "seed {seed}, {}", motor.id());
        }
        fixture.command(Command::Release).unwrap();
        assert!(fixture.bus.job().is_none());
        fixture.forget_the_past();
        fixture.run(ms(1_000));
        let asks = |sent: &fixture::Sent| sent.is_query();
        assert!(
            fixture.sent.iter().all(asks),
            "seed {seed}: released, and not asked"
        );
    }
}
