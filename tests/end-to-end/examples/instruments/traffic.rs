//! Generates traffic for the packet log: exchanges of numbered frames.

use anyhow::{Result, ensure};
use motorlink_messages::{
    bus::{LineEvent, LineEventKind},
    protocol::{Frame, Instant, Layout, Mode},
    recorder::push_traffic,
};

use crate::tap::Message;

/// Time between two messages: a screen of 60 Hz.
const MESSAGE_US: u64 = 16_667;

/// Position of a frame's number in a reply: the bytes of current and speed.
const NUMBER: std::ops::Range<usize> = 2..6;

/// Frames number `from` to `until`, in buffers of this size, for delivery as soon as possible. They are `spacing_us`
/// apart, with the last one at `last_us`.
pub fn at_once(
    from: u32,
    until: u32,
    a_buffer: u32,
    spacing_us: u64,
    last_us: u64,
) -> Vec<Message> {
    let step = usize::try_from(a_buffer).unwrap_or(usize::MAX);
    let at_us = |number: u32| last_us.saturating_sub(u64::from(until - 1 - number) * spacing_us);
    (from..until)
        .step_by(step)
        .map(|first| {
            let behind = until.min(first + a_buffer);
            Message {
                due_us: 0,
                bytes: buffer((first..behind).map(|number| (number, at_us(number)))),
            }
        })
        .collect()
}

/// Frames number `from` to `until`, `spacing_us` apart from `from_us` on, in buffers that come 60 times a second.
pub fn in_time(from: u32, until: u32, spacing_us: u64, from_us: u64) -> Vec<Message> {
    let at_us = |number: u32| from_us + u64::from(number - from) * spacing_us;
    let mut messages = Vec::new();
    let (mut next, mut due_us) = (from, from_us + MESSAGE_US);
    while next < until {
        let behind = (next..until).find(|&number| at_us(number) >= due_us);
        let behind = behind.unwrap_or(until);
        messages.push(Message {
            due_us,
            bytes: buffer((next..behind).map(|number| (number, at_us(number)))),
        });
        next = behind;
        due_us += MESSAGE_US;
    }
    messages
}

fn buffer(frames: impl Iterator<Item = (u32, u64)>) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (number, at_us) in frames {
        let at = Instant::from_micros(at_us);
        let passed = passed(number);
        push_traffic(&mut bytes, &LineEvent { at, kind: passed });
    }
    bytes
}

/// The event of a number: even numbers are drive frames, odd ones replies that contain their number.
fn passed(number: u32) -> LineEventKind {
    if number.is_multiple_of(2) {
        return LineEventKind::Sent {
            frame: Frame::with_crc([1, 0x64, 0, 100, 0, 0, 0, 0, 0]),
            mode: Some(Mode::Velocity),
        };
    }
    let [b3, b2, b1, b0] = number.to_be_bytes();
    LineEventKind::Received {
        frame: Frame::with_crc([1, 2, b3, b2, b1, b0, 0x17, 0xCF, 0]),
        asked: Some(Layout::Drive),
    }
}

/// The number of the newest reply in the rows of an exported log, if none is missing.
///
/// # Errors
///
/// When one is missing: the error names the replies around it.
pub fn newest_without_gap<'a>(rows: impl Iterator<Item = (&'a str, &'a str)>) -> Result<u32> {
    let mut newest = None;
    let mut sent = false;
    for (direction, hex) in rows {
        match direction {
            "TX" => {
                ensure!(!sent, "a reply is missing behind {newest:?}");
                sent = true;
            }
            "RX" => {
                let number = number_of(hex)?;
                if let Some(before) = newest {
                    ensure!(number == before + 2, "{number} comes behind {before}");
                    ensure!(sent, "a frame of ours is missing before {number}");
                }
                newest = Some(number);
                sent = false;
            }
            _ => {}
        }
    }
    ensure!(!sent, "a reply is missing behind {newest:?}");
    newest.ok_or_else(|| anyhow::anyhow!("no reply at all"))
}

fn number_of(hex: &str) -> Result<u32> {
    let bytes: Vec<u8> = hex
        .split(' ')
        .map(|byte| u8::from_str_radix(byte, 16))
        .collect::<Result<_, _>>()?;
    let number = bytes.get(NUMBER).unwrap_or_default();
    Ok(u32::from_be_bytes(number.try_into()?))
}
