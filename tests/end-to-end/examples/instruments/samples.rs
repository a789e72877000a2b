//! Simulates the worker's messages about a motor that reports 500 times a second.

use anyhow::Result;
use motorlink_messages::{
    Adapter, Connection, ToPage, Update,
    bus::{Activity, Answer, Counters, LinkQuality, MotorStatus, Sample},
    encode,
    protocol::{
        Celsius, CoarsePosition, Current, Detail, Faults, Instant, Mode, MotorId, Position, Reply,
        Rpm, Setpoint, SpeedTarget,
    },
};

use crate::tap::Message;

/// Time between two replies: 500 Hz.
const SAMPLE_US: u64 = 2_000;
/// Time between two messages: a screen of 60 Hz.
const UPDATE_US: u64 = 16_667;
/// Ten queries a second are among the drive frames.
const QUERIED_EVERY: u64 = 50;

/// The messages of a period, in microseconds of the worker's clock.
pub fn updates(from_us: u64, until_us: u64) -> Result<Vec<Message>> {
    let mut messages = Vec::new();
    let mut told_us = from_us;
    while told_us < until_us {
        let now_us = told_us + UPDATE_US;
        let samples: Vec<Sample> = (told_us.div_ceil(SAMPLE_US)..now_us.div_ceil(SAMPLE_US))
            .map(sample)
            .collect();
        let update = Update {
            now: Instant::from_micros(now_us),
            connection: Connection::Connected(Adapter::VIRTUAL),
            halted: false,
            motors: vec![status(samples.last().copied())],
            job: None,
            raw: None,
            line: None,
            samples,
            notices: Vec::new(),
        };
        messages.push(Message {
            due_us: now_us,
            bytes: encode(&ToPage::Update(update))?,
        });
        told_us = now_us;
    }
    Ok(messages)
}

/// A driven motor with this last reply.
fn status(last: Option<Sample>) -> MotorStatus {
    let setpoint = SpeedTarget::new(100).map(Setpoint::velocity);
    MotorStatus {
        waiting: None,
        id: MotorId::FIRST,
        activity: setpoint.map_or(Activity::Idle, |setpoint| Activity::Driven { setpoint }),
        last,
        speed: last.and_then(|Sample { at, reply }| Some((at, reply.speed?))),
        current: last.and_then(|Sample { at, reply }| Some((at, reply.current?))),
        position: None,
        temperature: None,
        turns: None,
        answer: Answer::Comes,
        may_turn: false,
        turns_unasked: false,
        link: LinkQuality::default(),
        counters: Counters::default(),
    }
}

/// The reply at a step of 2 ms: slow waves with noise, so that all columns of a graph differ.
fn sample(step: u64) -> Sample {
    let detail = if step.is_multiple_of(QUERIED_EVERY) {
        Detail::Query {
            temperature: Celsius::new(40),
            position: CoarsePosition::from_raw(step.to_le_bytes()[0]),
        }
    } else {
        let raw = u16::try_from(step * 37 % 32_768).unwrap_or_default();
        Detail::Drive {
            position: Position::from_raw(raw),
        }
    };
    Sample {
        at: Instant::from_micros(step * SAMPLE_US),
        reply: Reply {
            id: MotorId::FIRST,
            mode: Mode::Velocity,
            current: Some(Current::from_raw(wave(step, 1_500, 3_000, 400))),
            speed: Some(Rpm::new(wave(step, 3_500, 100, 12))),
            detail,
            faults: Faults::NONE,
        },
    }
}

/// A triangle with this period in steps, this height, and noise of this height.
fn wave(step: u64, period: u64, height: u64, noise: u64) -> i16 {
    let phase = step % period;
    let rising = phase.min(period - phase) * 4 * height / period;
    // Knuth's multiplier gives the same noise in every run, and different noise at each step.
    let shaken = (step.wrapping_mul(2_654_435_761) >> 16) % (2 * noise + 1);
    let value = (rising + shaken).cast_signed() - (height + noise).cast_signed();
    i16::try_from(value).unwrap_or_default()
}
