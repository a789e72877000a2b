//! Draws random actions: single ones, and sequences that single draws rarely produce.

use std::time::Duration;

use fastrand::Rng;
use motorlink_bus::{BusSettings, Command, Consent, StopReason};
use motorlink_protocol::{CurrentTarget, Mode, MotorId, Setpoint};

use crate::action::{Absence, Action, LineFault, PendingInput};

mod commands;

/// Draws random actions and commands.
pub(crate) struct Generator {
    pub(crate) rng: Rng,
    pub(crate) motors: Vec<MotorId>,
    /// As configured last.
    pub(crate) settings: BusSettings,
}

impl Generator {
    /// One action, mostly of the operator, so that motors are driven.
    pub(crate) fn action(&mut self) -> Action {
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
    pub(crate) fn sequence(&mut self) -> Vec<Action> {
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
        match self.rng.u8(..10) {
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
            8 => self.group_from_other_loops(&mut actions),
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

    /// The start of a group of which some motors are driven in other loops, and what may come meanwhile.
    fn group_from_other_loops(&mut self, actions: &mut Vec<Action>) {
        for id in self.some_motors() {
            actions.push(Action::Power { id, on: true });
            actions.push(start(id, self.setpoint()));
        }
        actions.push(pause_ms(self.rng.u64(50..1_500)));
        let start = |setpoints| {
            let consent = Consent::None;
            Action::Command(Command::StartGroup { setpoints, consent })
        };
        actions.extend(self.together().map(start));
        actions.push(pause_ms(self.rng.u64(1..800)));
        match self.rng.u8(..6) {
            0 => {
                let id = self.motor();
                actions.push(Action::Command(self.stop(id)));
            }
            1 => actions.push(self.disturbance()),
            2 => actions.extend(self.together().map(|setpoints| {
                let consent = Consent::None;
                Action::Command(Command::AdjustGroup { setpoints, consent })
            })),
            3 => actions.extend(self.together().map(start)),
            _ => {}
        }
        actions.push(pause_ms(self.rng.u64(500..2_500)));
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

    pub(crate) fn some_motors(&mut self) -> Vec<MotorId> {
        let motors = self.motors.clone();
        motors
            .into_iter()
            .filter(|_| self.rng.u8(..4) == 0)
            .collect()
    }

    pub(crate) fn motor(&mut self) -> MotorId {
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
}

fn switch(id: MotorId, mode: Mode) -> Action {
    Action::Command(Command::SwitchMode { id, mode })
}

fn start(id: MotorId, setpoint: Setpoint) -> Action {
    let consent = Consent::None;
    Action::Command(Command::Start {
        id,
        setpoint,
        consent,
    })
}

pub(crate) fn drive(id: MotorId, setpoint: Setpoint) -> Action {
    Action::Command(Command::Drive {
        id,
        setpoint,
        consent: Consent::None,
    })
}

pub(crate) fn pause_ms(ms: u64) -> Action {
    Action::Pause(Duration::from_millis(ms))
}
