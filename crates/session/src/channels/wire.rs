//! `/wire`: events of the bus, several per message.
//!
//! A separate message per frame would cost 31 bytes in the chunk and 16 in its index, more than the frame itself.
//! Times are stored as differences, because these repeat and compress well: one hour takes 34 MB instead of 44 MB.

use std::time::Duration;

use motorlink_bus::{JunkBytes, LineEvent, LineEventKind};
use motorlink_protocol::{Frame, Instant, Layout, Mode, MotorId, family::Model};
use motorlink_recorder::digits::{push_decimal, push_hex_digits};
use nojson::{RawJson, RawJsonValue};

use super::integer;

/// Maximal events per message.
const EVENTS_MAX: usize = 256;
/// Maximal time per message: a reader that seeks to a moment reads no more than this before it.
const SPAN: Duration = Duration::from_millis(100);

/// The message that is being filled.
#[derive(Debug, Default)]
pub(crate) struct Batch {
    json: String,
    events: usize,
    first: Instant,
    last: Instant,
    model: Model,
}

impl Batch {
    /// Sets the model of the motors for the following messages. The present message has to be ended before.
    pub(crate) const fn set_model(&mut self, model: Model) {
        self.model = model;
    }

    /// Whether an event at this time has to go into the next message.
    pub(crate) fn is_full_for(&self, at: Instant) -> bool {
        let fits = self.events < EVENTS_MAX && at >= self.last && at.since(self.first) < SPAN;
        self.events > 0 && !fits
    }

    pub(crate) fn push(&mut self, event: &LineEvent) {
        if let LineEventKind::ModelSelected(_) = event.kind {
            return;
        }
        let out = &mut self.json;
        if self.events == 0 {
            (self.first, self.last) = (event.at, event.at);
            out.clear();
            out.push_str("{\"mono_us\":");
            push_decimal(out, event.at.as_micros());
            if self.model != Model::default() {
                out.push_str(",\"model\":\"");
                out.push_str(self.model.spec().key);
                out.push('"');
            }
            out.push_str(",\"frames\":[");
        } else {
            out.push(',');
        }
        let after = event.at.as_micros() - self.last.as_micros();
        out.push_str("{\"after_us\":");
        push_decimal(out, after);
        push_kind(out, &event.kind);
        self.last = event.at;
        self.events += 1;
    }

    /// Ends the message and starts the next one. Returns its time and text, if there is one.
    pub(crate) fn end(&mut self) -> Option<(Instant, &str)> {
        if self.events == 0 {
            return None;
        }
        self.events = 0;
        self.json.push_str("]}");
        Some((self.first, &self.json))
    }
}

fn push_kind(out: &mut String, kind: &LineEventKind) {
    let mut hex: &[u8] = &[];
    match kind {
        LineEventKind::Sent { frame, mode }
        | LineEventKind::SentByHand { frame, mode }
        | LineEventKind::RepeatedByHand { frame, mode } => {
            out.push_str(",\"direction\":\"tx\",\"sent\":true");
            push_id(out, frame);
            push_mode(out, *mode);
            hex = frame.bytes();
        }
        LineEventKind::Known { id, mode, value } => {
            out.push_str(",\"direction\":\"tx\",\"known\":true,\"id\":");
            push_decimal(out, id.get().into());
            push_mode(out, Some(*mode));
            hex = value.as_ref().map_or(&[], |value| &value[..]);
        }
        // It is a member of the message.
        LineEventKind::ModelSelected(_) => {}
        LineEventKind::NotSent { frame } => {
            out.push_str(",\"direction\":\"tx\",\"sent\":false");
            push_id(out, frame);
            hex = frame.bytes();
        }
        LineEventKind::Received { frame, asked } => {
            out.push_str(",\"direction\":\"rx\"");
            push_id(out, frame);
            push_layout(out, *asked);
            hex = frame.bytes();
        }
        LineEventKind::Junk(junk) => {
            out.push_str(",\"direction\":\"rx\",\"junk\":true");
            out.push_str(",\"hex\":\"");
            push_hex_digits(out, junk.bytes());
            out.push_str("\"}");
            return;
        }
        LineEventKind::Silence { id, waited_us } => {
            out.push_str(",\"direction\":\"rx\",\"id\":");
            push_decimal(out, id.get().into());
            out.push_str(",\"silent_us\":");
            push_decimal(out, (*waited_us).into());
        }
    }
    out.push_str(",\"hex\":\"");
    push_hex_digits(out, hex);
    out.push_str("\"}");
}

/// Adds the first byte, which is the motor's address in most frames.
fn push_id(out: &mut String, frame: &Frame) {
    let [first, ..] = *frame.bytes();
    out.push_str(",\"id\":");
    push_decimal(out, first.into());
}

fn push_mode(out: &mut String, mode: Option<Mode>) {
    if let Some(mode) = mode {
        out.push_str(",\"mode\":\"");
        out.push_str(mode_name(mode));
        out.push('"');
    }
}

fn push_layout(out: &mut String, asked: Option<Layout>) {
    out.push_str(match asked {
        Some(Layout::Drive) => ",\"layout\":\"drive\"",
        Some(Layout::Query) => ",\"layout\":\"query\"",
        None => "",
    });
}

pub(crate) const fn mode_name(mode: Mode) -> &'static str {
    match mode {
        Mode::OpenLoop => "open_loop",
        Mode::Current => "current",
        Mode::Velocity => "velocity",
        Mode::Position => "position",
    }
}

fn mode_of(name: &str) -> Option<Mode> {
    let modes = [
        Mode::OpenLoop,
        Mode::Current,
        Mode::Velocity,
        Mode::Position,
    ];
    // Earlier versions wrote a space.
    let name = if name == "open loop" {
        "open_loop"
    } else {
        name
    };
    modes.into_iter().find(|mode| mode_name(*mode) == name)
}

/// The content of a message.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Content {
    /// The model of the motors.
    pub(crate) model: Model,
    pub(crate) events: Vec<LineEvent>,
    /// Whether all frames could be parsed.
    pub(crate) is_complete: bool,
}

/// Parses a message.
pub(crate) fn read(data: &[u8]) -> Option<Content> {
    let json = RawJson::parse(std::str::from_utf8(data).ok()?).ok()?;
    let message = json.value();
    let mut at = Instant::from_micros(integer(message, "mono_us")?);
    let model = message.to_member("model").ok()?.optional();
    let model = model.and_then(|model| model.as_raw_str().trim_matches('"').parse().ok());
    let frames = message.to_member("frames").ok()?.optional()?;
    let mut content = Content {
        // Files from before there were several models have none.
        model: model.unwrap_or_default(),
        events: Vec::new(),
        is_complete: true,
    };
    for frame in frames.to_array().ok()? {
        let Some(members) = read_members(frame) else {
            content.is_complete = false;
            continue;
        };
        let event = members.kind(content.model);
        // A frame that cannot be read has no time.
        if !matches!(event, Event::Unreadable) {
            at = at + Duration::from_micros(members.after_us);
        }
        match event {
            Event::Of(kind) => content.events.push(LineEvent { at, kind }),
            Event::SaidBefore => {}
            Event::Unreadable => content.is_complete = false,
        }
    }
    Some(content)
}

/// The members of one frame, collected in a single pass: an hour has millions of them.
#[derive(Default)]
struct Members<'a> {
    after_us: u64,
    tx: Option<bool>,
    not_sent: bool,
    what: What,
    id: Option<u8>,
    silent_us: Option<u32>,
    mode: Option<Mode>,
    layout: Option<Layout>,
    hex: &'a str,
}

/// What the bytes are.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
enum What {
    #[default]
    Frame,
    Junk,
    /// What a motor was told, of a time of which only replies are left.
    Known,
    /// Of an earlier version: a frame that was on no wire.
    Derived,
}

/// What a member of `frames` is.
enum Event {
    Of(LineEventKind),
    /// Of an earlier version: the frame before it as a DDSM115 would send it.
    SaidBefore,
    Unreadable,
}

fn read_members<'a>(frame: RawJsonValue<'a, '_>) -> Option<Members<'a>> {
    let mut members = Members::default();
    for (name, value) in frame.to_object().ok()? {
        let raw = value.as_raw_str();
        let text = raw.trim_matches('"');
        match name.as_raw_str() {
            "\"after_us\"" => members.after_us = raw.parse().ok()?,
            "\"direction\"" => {
                members.tx = match text {
                    "tx" => Some(true),
                    "rx" => Some(false),
                    _ => None,
                }
            }
            "\"sent\"" => members.not_sent = raw == "false",
            "\"known\"" if raw == "true" => members.what = What::Known,
            "\"derived\"" if raw == "true" => members.what = What::Derived,
            "\"junk\"" if raw == "true" => members.what = What::Junk,
            "\"id\"" => members.id = raw.parse().ok(),
            "\"silent_us\"" => members.silent_us = raw.parse().ok(),
            "\"mode\"" => members.mode = mode_of(text),
            "\"layout\"" => {
                members.layout = match text {
                    "drive" => Some(Layout::Drive),
                    "query" => Some(Layout::Query),
                    _ => None,
                }
            }
            "\"hex\"" => members.hex = text,
            _ => {}
        }
    }
    Some(members)
}

impl Members<'_> {
    fn kind(&self, model: Model) -> Event {
        let separate = model.has_separate_frames();
        let kind = match self.what {
            // Of a time of which only the recording was left, there is no frame before it.
            What::Derived if separate && self.after_us == 0 => return Event::SaidBefore,
            What::Derived if separate => None,
            What::Derived => self.derived(),
            What::Frame | What::Junk | What::Known => self.of_the_line(),
        };
        kind.map_or(Event::Unreadable, Event::Of)
    }

    /// An earlier version, combined frames: a reply of which only the recording was left, or the drive frame before it.
    fn derived(&self) -> Option<LineEventKind> {
        let (frame, asked) = (self.frame()?, self.layout);
        if !self.tx? {
            return Some(LineEventKind::Received { frame, asked });
        }
        let [id, _, high, low, ..] = *frame.bytes();
        let id = MotorId::new(id).ok()?;
        let value = self.mode.map(|_| [high, low]);
        let mode = self.mode.unwrap_or(Mode::Velocity);
        Some(LineEventKind::Known { id, mode, value })
    }

    fn frame(&self) -> Option<Frame> {
        let (bytes, length) = bytes_of(self.hex)?;
        (length == bytes.len()).then_some(Frame::new(bytes))
    }

    fn of_the_line(&self) -> Option<LineEventKind> {
        if let (Some(waited_us), Some(id)) = (self.silent_us, self.id) {
            let id = MotorId::new(id).ok()?;
            return Some(LineEventKind::Silence { id, waited_us });
        }
        let (bytes, length) = bytes_of(self.hex)?;
        if self.what == What::Junk {
            return Some(LineEventKind::Junk(JunkBytes::new(bytes.get(..length)?)));
        }
        if self.what == What::Known {
            let [high, low, ..] = bytes;
            let value = match length {
                0 => None,
                2 => Some([high, low]),
                _ => return None,
            };
            let (id, mode) = (MotorId::new(self.id?).ok()?, self.mode?);
            return Some(LineEventKind::Known { id, mode, value });
        }
        let frame = self.frame()?;
        let (mode, asked) = (self.mode, self.layout);
        Some(match self.tx? {
            true if self.not_sent => LineEventKind::NotSent { frame },
            true => LineEventKind::Sent { frame, mode },
            false => LineEventKind::Received { frame, asked },
        })
    }
}

/// Parses at most ten bytes in hex, without spaces.
fn bytes_of(hex: &str) -> Option<([u8; 10], usize)> {
    let digits = hex.as_bytes();
    let mut bytes = [0; 10];
    if !digits.len().is_multiple_of(2) || digits.len() > 2 * bytes.len() {
        return None;
    }
    for (slot, pair) in bytes.iter_mut().zip(digits.chunks_exact(2)) {
        let [high, low] = *pair else { return None };
        let (high, low) = (
            char::from(high).to_digit(16)?,
            char::from(low).to_digit(16)?,
        );
        *slot = u8::try_from(high * 16 + low).ok()?;
    }
    Some((bytes, digits.len() / 2))
}

#[cfg(test)]
#[path = "wire_tests.rs"]
mod tests;
