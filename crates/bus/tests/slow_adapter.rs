//! An adapter that becomes slower than the reply windows.

use crate::fixture::{Fixture, Sent, id, longest_gap, ms, rpm};
use motorlink_bus::{Activity, Command, Consent, Counters, MotorStatus};
use motorlink_protocol::{MotorId, family::Model};
use motorlink_simulator::{WireFaults, WorldConfig};

/// An adapter begins to hold bytes for so long, and some of the motors are driven, before or after that.
#[derive(Clone, Copy, Debug)]
struct Slowed {
    model: Model,
    motors: u8,
    driven: usize,
    hold_ms: u8,
    is_driven_before: bool,
}

impl Slowed {
    /// A second after the last change.
    fn fixture(self) -> Fixture {
        let motors: Vec<MotorId> = (1..=self.motors).map(id).collect();
        let config = WorldConfig::of(self.model, motors.iter().copied());
        let mut fixture = Fixture::watching(config, &motors);
        fixture.run(ms(1_000));
        for drives in [self.is_driven_before, !self.is_driven_before] {
            if drives {
                for id in motors.iter().copied().take(self.driven) {
                    let drive = Command::Drive {
                        id,
                        setpoint: rpm(50),
                        consent: Consent::None,
                    };
                    fixture.command(drive).unwrap();
                }
            } else {
                fixture.world.set_faults(WireFaults {
                    hold: ms(self.hold_ms.into()),
                    ..WireFaults::default()
                });
            }
            fixture.run(ms(1_000));
        }
        fixture
    }

    /// Whether nearly all replies come in their windows.
    fn assert_in_time(self) {
        let mut fixture = self.fixture();
        let late = sum(&fixture, |counters| counters.late);
        let asked = sum(&fixture, |counters| counters.requests);
        // Also when the late replies are forgotten.
        fixture.run(ms(5_000));
        let late = sum(&fixture, |counters| counters.late) - late;
        let asked = sum(&fixture, |counters| counters.requests) - asked;
        assert!(late * 50 <= asked, "{self:?}: {late} of {asked} late");
        // Ten times a second each, or as often as the line carries it.
        let carried = 5_000 / (u64::from(self.hold_ms) + 10);
        let expected = (u64::from(self.motors) * 40).min(carried);
        assert!(asked >= expected, "{self:?}: {asked} asked");
        if !self.is_driven_before {
            let is_driven =
                |status: &MotorStatus| matches!(status.activity, Activity::Driven { .. });
            let driven = fixture.bus.motors(fixture.now).filter(is_driven).count();
            assert_eq!(driven, self.driven, "{self:?}");
        }
    }
}

fn sum(fixture: &Fixture, count: impl Fn(&Counters) -> u64) -> u64 {
    let motors = fixture.bus.motors(fixture.now);
    motors.map(|motor| count(&motor.counters)).sum()
}

/// While replies are late, the round trips that would widen the windows are not measured. With several motors on the
/// line that lasted for ever.
#[test]
fn replies_come_in_time_within_a_second() {
    for model in [Model::Ddsm115, Model::Ddsm210] {
        for hold_ms in [4, 8, 16, 30] {
            let some = [(1, 0), (1, 1), (2, 0), (2, 2), (4, 0), (4, 1), (4, 4)];
            let many = [(8, 0), (8, 8)];
            let many = many.into_iter().filter(|_| hold_ms <= 16);
            for (motors, driven) in some.into_iter().chain(many) {
                for is_driven_before in [true, false] {
                    let slowed = Slowed {
                        model,
                        motors,
                        driven,
                        hold_ms,
                        is_driven_before,
                    };
                    slowed.assert_in_time();
                }
            }
        }
    }
}

/// Driven motors on an adapter that has become slow. The last frame went to the last of them, and has arrived.
fn all_driven(motors: u8, hold_ms: u8) -> Fixture {
    let slowed = Slowed {
        model: Model::Ddsm115,
        motors,
        driven: motors.into(),
        hold_ms,
        is_driven_before: false,
    };
    let mut fixture = slowed.fixture();
    let is_last = |sent: &Sent| sent.drive_of(id(motors)).is_some();
    fixture.run_until(ms(1_000), |fixture| {
        fixture.sent.last().is_some_and(is_last)
    });
    fixture.run(ms(1));
    fixture.forget_the_past();
    fixture
}

/// A wheel whose stop frame was lost keeps turning. On a slow adapter a driven motor always has a frame due; it must not delay
/// the next stop frame.
#[test]
fn lost_stop_frames_are_repeated_before_another_motor_is_driven() {
    for hold_ms in [8, 16, 25] {
        let mut fixture = all_driven(4, hold_ms);
        let faults = |lose_request| WireFaults {
            hold: ms(hold_ms.into()),
            lose_request,
            ..WireFaults::default()
        };
        fixture.world.set_faults(faults(1.0));
        for motor in 1..=3 {
            fixture.command(Command::Stop(id(motor))).unwrap();
        }
        fixture.run_until(ms(500), |fixture| fixture.sent.len() == 3);
        // The third one is lost too.
        fixture.run(ms(2));
        fixture.world.set_faults(faults(0.0));
        fixture.run(ms(500));
        let driven = |sent: &Sent| (1..=4).find(|motor| sent.drive_of(id(*motor)).is_some());
        let first: Vec<u8> = fixture.sent.iter().filter_map(driven).take(6).collect();
        assert_eq!(first, [1, 2, 3, 1, 2, 3], "{hold_ms} ms");
    }
}

#[test]
fn stops_that_are_lost_let_a_drive_frame_pass_within_300_ms() {
    for hold_ms in [1, 8, 16, 25] {
        for lost in [0.3, 0.6, 1.0] {
            let mut fixture = all_driven(4, hold_ms);
            fixture.world.set_faults(WireFaults {
                hold: ms(hold_ms.into()),
                lose_request: lost,
                ..WireFaults::default()
            });
            let mut times = vec![fixture.now];
            for motor in 1..=3 {
                fixture.command(Command::Stop(id(motor))).unwrap();
            }
            fixture.run(ms(1_000));
            times.extend(fixture.drive_times(id(4)));
            let gap = longest_gap(&times);
            assert!(
                times.len() > 4 && gap <= ms(300),
                "{hold_ms} ms, {lost} lost: {gap:?}"
            );
        }
    }
}

/// Behind the first answer the frames of a stop and of a driven motor take turns.
#[test]
fn an_answered_stop_does_not_take_the_line_from_a_driven_motor() {
    for hold_ms in [8, 16, 25] {
        let mut fixture = all_driven(2, hold_ms);
        fixture.command(Command::Stop(id(1))).unwrap();
        fixture.run(ms(300));
        let driven = |sent: &Sent| (1..=2).find(|motor| sent.drive_of(id(*motor)).is_some());
        let first: Vec<u8> = fixture.sent.iter().filter_map(driven).take(4).collect();
        assert_eq!(first, [1, 2, 1, 2], "{hold_ms} ms");
    }
}
