//! Motors, wire and time, put together.

use std::{collections::VecDeque, time::Duration};

use motorlink_protocol::{Instant, Layout, MotorId};

use crate::{
    Chunk, LineCase, MotorConfig, Speaker, Traffic, VirtualMotor, WireFaults, WorldConfig,
    firmware::understood,
    random::Random,
    traffic::TrafficLog,
    wire::{Adapter, Air, HostEar, MotorEar, Passed, Talker},
};

/// Answers that wait for their turnaround. A motor takes frames every 868 us at best and answers
/// after 600 us, so a few a motor are always enough.
const ANSWERS_MAX: usize = 1024;

/// Streams of chance: garbage, faults, then one a motor.
const GARBAGE_STREAM: u64 = 1;
const FAULT_STREAM: u64 = 2;
const MOTOR_STREAM: u64 = 16;

/// A motor with its number, which it keeps when its address changes.
#[derive(Clone, Debug)]
struct Slot {
    number: u32,
    motor: VirtualMotor,
    /// When it was put on the wire: it hears no frame that had begun before.
    since: Instant,
}

/// A motor's answer before its turnaround is over.
#[derive(Clone, Copy, Debug)]
struct Answer {
    at: Instant,
    number: u32,
    layout: Layout,
}

/// Virtual motors on a half-duplex wire, with faults round the wire.
///
/// Time only goes forward: a moment before the latest one counts as the latest. The first moment
/// given starts the world, so its epoch may lie anywhere.
#[derive(Clone, Debug)]
pub struct World {
    slots: Vec<Slot>,
    next_number: u32,
    seed: u64,
    turnaround: Duration,
    air: Air,
    motor_ear: MotorEar,
    host_ear: HostEar,
    adapter: Adapter,
    /// In order of time.
    answers: VecDeque<Answer>,
    traffic: TrafficLog,
    now: Option<Instant>,
    /// The motor that is there only while two share an address.
    twin: Option<u32>,
}

impl World {
    /// A world that starts at the first moment it is given.
    #[must_use]
    pub fn new(config: WorldConfig) -> Self {
        let mut world = Self {
            slots: Vec::new(),
            next_number: 0,
            seed: config.seed,
            turnaround: config.turnaround,
            air: Air::new(Random::new(config.seed, GARBAGE_STREAM)),
            motor_ear: MotorEar::default(),
            host_ear: HostEar::default(),
            adapter: Adapter::new(config.faults, Random::new(config.seed, FAULT_STREAM)),
            answers: VecDeque::new(),
            traffic: TrafficLog::default(),
            now: None,
            twin: None,
        };
        for motor in config.motors {
            world.add_motor(motor);
        }
        world
    }

    /// The host writes bytes. They follow on the wire what it wrote before.
    pub fn transmit(&mut self, now: Instant, bytes: &[u8]) {
        let now = self.run_to(now);
        self.air.host_sends(now, bytes, self.adapter.echo());
    }

    /// What has reached the host by `now`: one delivery, in the order of time, or nothing.
    pub fn receive(&mut self, now: Instant) -> Option<Chunk> {
        let now = self.run_to(now);
        self.adapter.receive(now)
    }

    /// When [`receive`](Self::receive) or the traffic log may next have something. Nothing as long as
    /// the wire is silent and no answer is due.
    #[must_use]
    pub fn next_event(&self) -> Option<Instant> {
        let answer = self.answers.front().map(|answer| answer.at);
        [
            self.adapter.next_arrival(),
            self.air.next_frame_end(),
            answer,
        ]
        .into_iter()
        .flatten()
        .min()
    }

    /// Lets physics, firmware and wire run to `now`.
    pub fn advance(&mut self, now: Instant) {
        self.run_to(now);
    }

    /// The motor with this address; the first of several that share it.
    #[must_use]
    pub fn motor(&self, id: MotorId) -> Option<&VirtualMotor> {
        self.motors().find(|motor| motor.id() == id)
    }

    /// The same, to lay hands on.
    pub fn motor_mut(&mut self, id: MotorId) -> Option<&mut VirtualMotor> {
        self.motors_mut().find(|motor| motor.id() == id)
    }

    /// All motors in the order in which they were added.
    pub fn motors(&self) -> impl Iterator<Item = &VirtualMotor> {
        self.slots.iter().map(|slot| &slot.motor)
    }

    /// The same, to lay hands on.
    pub fn motors_mut(&mut self) -> impl Iterator<Item = &mut VirtualMotor> {
        self.slots.iter_mut().map(|slot| &mut slot.motor)
    }

    /// Puts one more motor on the wire, with power. Its address may be taken already.
    pub fn add_motor(&mut self, config: MotorConfig) {
        let number = self.next_number;
        self.next_number = number.wrapping_add(1);
        let noise = Random::new(self.seed, MOTOR_STREAM + u64::from(number));
        let now = self.now.unwrap_or_default();
        let motor = VirtualMotor::new(config, noise, now);
        self.slots.push(Slot {
            number,
            motor,
            since: now,
        });
    }

    /// Takes the motor with this address off the wire, the first of several.
    pub fn remove_motor(&mut self, id: MotorId) -> Option<VirtualMotor> {
        let place = self.slots.iter().position(|slot| slot.motor.id() == id)?;
        Some(self.slots.remove(place).motor)
    }

    /// Changes what is wrong with the wire; what is on its way stays as it was.
    pub fn set_faults(&mut self, faults: WireFaults) {
        self.adapter.set_faults(faults);
    }

    /// Makes the line ill in one way, or well. In place of the faults so far; a motor that was there
    /// for the last case goes. Nothing is driven by it: a second motor obeys the frames that come.
    pub fn set_case(&mut self, now: Instant, case: LineCase) {
        self.run_to(now);
        self.set_faults(case.faults());
        if let Some(twin) = self.twin.take() {
            self.slots.retain(|slot| slot.number != twin);
        }
        if case == LineCase::SharedId {
            self.twin = Some(self.next_number);
            self.add_motor(LineCase::twin());
        }
    }

    /// Every frame that went over the wire since the last call, in the order in which they became
    /// known: a host's frame when its last byte had passed, a motor's when its first byte started.
    pub fn drain_traffic(&mut self) -> impl Iterator<Item = Traffic> + '_ {
        self.traffic.drain()
    }

    /// How many frames were dropped from the traffic log because nobody drained it.
    #[must_use]
    pub const fn traffic_lost(&self) -> u64 {
        self.traffic.lost()
    }

    /// Everything up to `now` in the order of time. Gives the present.
    fn run_to(&mut self, now: Instant) -> Instant {
        let now = match self.now {
            None => {
                for slot in &mut self.slots {
                    slot.motor.start_at(now);
                }
                now
            }
            Some(latest) => latest.max(now),
        };
        while let Some(at) = self.step_within(now) {
            self.now = Some(at);
        }
        for slot in &mut self.slots {
            slot.motor.advance(now);
        }
        self.now = Some(now);
        now
    }

    /// One answer that starts or one byte that has passed, if it is due. An answer that starts with
    /// the end of a byte goes first, so that the byte knows it is followed.
    fn step_within(&mut self, now: Instant) -> Option<Instant> {
        let answer = self.answers.front().map(|answer| answer.at);
        let byte = self.air.next_end();
        let due = |at: Option<Instant>| at.filter(|at| *at <= now);
        match (due(answer), due(byte)) {
            (Some(at), other) if other.is_none_or(|byte| at <= byte) => {
                self.start_answer();
                Some(at)
            }
            (_, Some(at)) => {
                self.pass_byte();
                Some(at)
            }
            _ => None,
        }
    }

    fn start_answer(&mut self) {
        let Some(Answer { at, number, layout }) = self.answers.pop_front() else {
            return;
        };
        let Some(slot) = self.slots.iter_mut().find(|slot| slot.number == number) else {
            return;
        };
        slot.motor.advance(at);
        let Some(frame) = slot.motor.report(layout) else {
            return;
        };
        self.traffic.push(Traffic {
            at,
            from: Speaker::Motor(slot.motor.id()),
            frame,
        });
        self.air.motor_sends(at, number, frame.bytes());
    }

    fn pass_byte(&mut self) {
        let Some(byte) = self.air.pass() else {
            return;
        };
        if byte.talker == Talker::Host {
            self.hear_host(byte);
        }
        if byte.audible {
            let more = self.air.is_audible_at(byte.end);
            if let Some(run) = self.host_ear.hear(byte, more) {
                let fastest_rpm = self.fastest_rpm(byte.end);
                self.adapter.deliver(run, fastest_rpm);
            }
        }
    }

    /// The speed of the fastest wheel without its direction.
    fn fastest_rpm(&mut self, now: Instant) -> f32 {
        let mut fastest_rpm = 0.0_f32;
        for Slot { motor, .. } in &mut self.slots {
            // To this moment, however often the world is looked at.
            motor.advance(now);
            fastest_rpm = fastest_rpm.max(motor.speed_rpm().abs());
        }
        fastest_rpm
    }

    /// A byte of the host passed every motor.
    fn hear_host(&mut self, byte: Passed) {
        let Some(frame) = self.motor_ear.hear(byte) else {
            return;
        };
        self.traffic.push(Traffic {
            at: frame.start,
            from: Speaker::Host,
            frame: frame.sent,
        });
        let Some(heard) = self.adapter.request(frame.heard) else {
            return;
        };
        let request = understood(&heard);
        let at = byte.end + self.turnaround;
        let there = self
            .slots
            .iter_mut()
            .filter(|slot| slot.since <= frame.start);
        for Slot { number, motor, .. } in there {
            let layout = motor.hear(request, byte.end);
            if let Some(layout) = layout.filter(|_| self.answers.len() < ANSWERS_MAX) {
                self.answers.push_back(Answer {
                    at,
                    number: *number,
                    layout,
                });
            }
        }
    }
}
