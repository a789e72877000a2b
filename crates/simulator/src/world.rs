//! The world: motors, wire and time.

use std::{collections::VecDeque, time::Duration};

use motorlink_protocol::{
    Instant, MotorId,
    family::{Layout, Model},
};

use crate::{
    config::MotorConfig,
    config::WorldConfig,
    firmware::parse_request,
    line_condition::LineCondition,
    motor::VirtualMotor,
    random::Random,
    wire::Chunk,
    wire::WireFaults,
    wire::{Adapter, FloatingPair, HostReceiver, MotorReceiver, PassedByte, SharedWire, Source},
    wire_frame::Sender,
    wire_frame::WireFrame,
    wire_frame::WireFrameLog,
};

/// Most replies that wait for their turnaround. A motor takes frames every 868 us at best and
/// replies after 600 us, so a few per motor are enough.
const ANSWERS_MAX: usize = 1024;

/// Random streams: garbage, faults, parts of echoes, noise of a floating pair, then one per motor.
const GARBAGE_STREAM: u64 = 1;
const FAULT_STREAM: u64 = 2;
const ECHO_STREAM: u64 = 3;
const FLOATING_STREAM: u64 = 4;
const MOTOR_STREAM: u64 = 16;

/// A motor with its number, which stays when its address changes.
#[derive(Clone, Debug)]
struct Slot {
    number: u32,
    motor: VirtualMotor,
    /// When it was added: it receives no frame that began before.
    since: Instant,
}

/// A reply during its turnaround.
#[derive(Clone, Copy, Debug)]
struct Answer {
    at: Instant,
    number: u32,
    layout: Layout,
}

/// Virtual motors on a half-duplex wire, with injected faults.
///
/// Time only goes forward: an earlier time counts as the latest. The first time given starts the
/// world, so its epoch may lie anywhere.
#[derive(Clone, Debug)]
pub struct World {
    slots: Vec<Slot>,
    next_number: u32,
    seed: u64,
    turnaround: Duration,
    shared_wire: SharedWire,
    motor_receiver: MotorReceiver,
    host_receiver: HostReceiver,
    adapter: Adapter,
    floating: FloatingPair,
    /// In order of time.
    answers: VecDeque<Answer>,
    wire_frames: WireFrameLog,
    now: Option<Instant>,
    /// The second motor of [`LineCondition::SharedId`], while it is present.
    twin: Option<u32>,
}

impl World {
    /// A world that starts at the first time it is given.
    #[must_use]
    pub fn new(config: WorldConfig) -> Self {
        let mut world = Self {
            slots: Vec::new(),
            next_number: 0,
            seed: config.seed,
            turnaround: config.turnaround,
            shared_wire: SharedWire::new(
                config.baud,
                Random::new(config.seed, GARBAGE_STREAM),
                Random::new(config.seed, ECHO_STREAM),
            ),
            floating: FloatingPair::new(Random::new(config.seed, FLOATING_STREAM)),
            motor_receiver: MotorReceiver::default(),
            host_receiver: HostReceiver::default(),
            adapter: Adapter::new(config.faults, Random::new(config.seed, FAULT_STREAM)),
            answers: VecDeque::new(),
            wire_frames: WireFrameLog::default(),
            now: None,
            twin: None,
        };
        for motor in config.motors {
            world.add_motor(motor);
        }
        world
    }

    /// The host opens the port at another baud. Motors of another baud hear nothing.
    pub fn set_baud(&mut self, now: Instant, baud: u32) {
        self.run_to(now);
        self.shared_wire.set_baud(baud);
    }

    /// The model of the first motor.
    fn model(&self) -> Model {
        let first = self.slots.first().map(|slot| slot.motor.model());
        first.unwrap_or(Model::Ddsm115)
    }

    /// The host writes bytes. They follow its earlier bytes on the wire.
    pub fn transmit(&mut self, now: Instant, bytes: &[u8]) {
        let now = self.run_to(now);
        self.shared_wire.host_sends(now, bytes, self.adapter.echo());
    }

    /// The next chunk that has reached the host by `now`, in order of time.
    pub fn receive(&mut self, now: Instant) -> Option<Chunk> {
        let now = self.run_to(now);
        self.adapter.receive(now)
    }

    /// When [`receive`](Self::receive) or the frame log may next have something; `None` while the
    /// wire is silent and no reply is due.
    #[must_use]
    pub fn next_event(&self) -> Option<Instant> {
        let answer = self.answers.front().map(|answer| answer.at);
        [
            self.adapter.next_arrival(),
            self.shared_wire.next_frame_end(),
            answer,
            self.floating.next(),
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

    /// The same, mutable.
    pub fn motor_mut(&mut self, id: MotorId) -> Option<&mut VirtualMotor> {
        self.motors_mut().find(|motor| motor.id() == id)
    }

    /// All motors in the order in which they were added.
    pub fn motors(&self) -> impl Iterator<Item = &VirtualMotor> {
        self.slots.iter().map(|slot| &slot.motor)
    }

    /// The same, mutable.
    pub fn motors_mut(&mut self) -> impl Iterator<Item = &mut VirtualMotor> {
        self.slots.iter_mut().map(|slot| &mut slot.motor)
    }

    /// Adds a motor with power. Its address may be taken already.
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

    /// Removes the motor with this address, the first of several.
    pub fn remove_motor(&mut self, id: MotorId) -> Option<VirtualMotor> {
        let place = self.slots.iter().position(|slot| slot.motor.id() == id)?;
        Some(self.slots.remove(place).motor)
    }

    /// Changes the faults of the wire; bytes on their way are not affected.
    pub fn set_faults(&mut self, faults: WireFaults) {
        self.adapter.set_faults(faults);
    }

    /// Sets a healthy line or one injected fault, in place of the faults so far, and removes the
    /// second motor of an earlier condition. Stop driven motors first: a second motor obeys the
    /// frames that come.
    pub fn set_line_condition(&mut self, now: Instant, case: LineCondition) {
        self.run_to(now);
        self.set_faults(case.faults());
        if let Some(twin) = self.twin.take() {
            self.slots.retain(|slot| slot.number != twin);
        }
        if case == LineCondition::SharedId {
            self.twin = Some(self.next_number);
            self.add_motor(LineCondition::twin(self.model()));
        }
    }

    /// Every frame on the wire since the last call, in order: a frame of the host at its last byte,
    /// a frame of a motor at its first byte.
    pub fn drain_wire_frames(&mut self) -> impl Iterator<Item = WireFrame> + '_ {
        self.wire_frames.drain()
    }

    /// Runs everything up to `now` in order of time. Returns the present time.
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
        loop {
            let since = self.now.unwrap_or(now);
            let noise = self.floating.due(self.adapter.is_floating(), since, now);
            while let Some(at) = self.step_within(noise.unwrap_or(now)) {
                self.now = Some(at);
            }
            let Some(at) = noise else {
                break;
            };
            if !self.shared_wire.is_busy_at(at) {
                self.adapter.noise(at);
            }
            self.floating.passed(at);
        }
        for slot in &mut self.slots {
            slot.motor.advance(now);
        }
        self.now = Some(now);
        now
    }

    /// One reply that starts or one byte that has passed, if due. A reply that starts at the end of
    /// a byte goes first, so that the byte is known to be followed.
    fn step_within(&mut self, now: Instant) -> Option<Instant> {
        let answer = self.answers.front().map(|answer| answer.at);
        let byte = self.shared_wire.next_end();
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
        self.wire_frames.push(WireFrame {
            at,
            from: Sender::Motor(slot.motor.id()),
            frame,
        });
        self.shared_wire.motor_sends(at, number, frame.bytes());
    }

    fn pass_byte(&mut self) {
        let Some(byte) = self.shared_wire.pass() else {
            return;
        };
        if byte.source == Source::Host {
            self.host_byte_passed(byte);
        }
        if byte.audible {
            let more = self.shared_wire.is_audible_at(byte.end);
            if let Some(run) = self.host_receiver.receive(byte, more) {
                let fastest_rpm = self.fastest_rpm(byte.end);
                let model = self.model();
                self.adapter.deliver(byte.end, run, fastest_rpm, model);
            }
        }
    }

    /// The speed of the fastest wheel without its direction.
    fn fastest_rpm(&mut self, now: Instant) -> f32 {
        let mut fastest_rpm = 0.0_f32;
        for Slot { motor, .. } in &mut self.slots {
            // Up to this time, so that the result does not depend on how often the world is polled.
            motor.advance(now);
            fastest_rpm = fastest_rpm.max(motor.speed_rpm().abs());
        }
        fastest_rpm
    }

    /// Processes a byte of the host at the motors.
    fn host_byte_passed(&mut self, byte: PassedByte) {
        let Some(frame) = self.motor_receiver.receive(byte) else {
            return;
        };
        self.wire_frames.push(WireFrame {
            at: frame.start,
            from: Sender::Host,
            frame: frame.sent,
        });
        let Some(received) = self.adapter.request(frame.received) else {
            return;
        };
        let request = parse_request(&received);
        let at = byte.end + self.turnaround;
        let baud = self.shared_wire.baud();
        let hears =
            |slot: &&mut Slot| slot.since <= frame.start && slot.motor.model().spec().baud == baud;
        for Slot { number, motor, .. } in self.slots.iter_mut().filter(hears) {
            let layout = motor.handle(&received, request, byte.end);
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
