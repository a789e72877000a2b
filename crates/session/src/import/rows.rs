//! Parses the lines of each kind of file.

use std::collections::BTreeMap;

use motorlink_bus::{JunkBytes, LineEvent, LineEventKind};
use motorlink_protocol::{
    FRAME_LEN, Frame, Instant, Layout, Mode, MotorId, Reply, Request, explain_received,
    explain_sent,
    family::{Model, Reading},
};
use motorlink_recorder::{REPLY, mode_cell, spelled_out, unmarked};

use super::times::Time;
use crate::{
    reader::Problem,
    record::{Event, EventKind},
    writer::Writer,
};

/// The columns of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Columns {
    Log,
    Telemetry,
    /// The log of the original page.
    Original,
}

impl Columns {
    /// The columns by the first line.
    pub(super) fn of_head(head: &[&str]) -> Option<Self> {
        let (first, rest) = head.split_first()?;
        Some(match (*first, rest) {
            ("time", ["elapsed_s", "direction", "id", "hex", "meaning"]) => Self::Log,
            ("timestamp", ["motor_id", .., "raw_hex"]) if rest.len() == 9 => Self::Telemetry,
            ("Timestamp", ["Type", "Content"]) => Self::Original,
            _ => return None,
        })
    }
}

/// One line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Line<'a> {
    pub(super) time: Time,
    content: Content<'a>,
}

/// The content of a line.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Content<'a> {
    /// A frame and its description, if the line has one.
    Sent(Frame, &'a str),
    Received(Frame, &'a str),
    /// A reply with its layout, its model, and the loop of its motor.
    Telemetry {
        id: MotorId,
        frame: Frame,
        asked: Option<Layout>,
        model: Model,
        mode: Option<Mode>,
    },
    Line(LineEventKind),
    Text {
        error: bool,
        text: &'a str,
    },
}

/// Parses lines. It remembers the request before a reply, which determines the reply's layout.
#[derive(Debug)]
pub(super) struct Rows {
    columns: Columns,
    asked: Option<(MotorId, Layout)>,
    model: Model,
    modes: BTreeMap<MotorId, Mode>,
}

impl Rows {
    pub(super) const fn new(columns: Columns) -> Self {
        Self {
            columns,
            asked: None,
            model: Model::Ddsm115,
            modes: BTreeMap::new(),
        }
    }

    /// Parses the cells of a line.
    pub(super) fn read<'a>(&self, cells: &[&'a str]) -> Result<Line<'a>, Problem> {
        let content = self.content(cells).ok_or(Problem::LineDamaged)?;
        let time = cells.first().and_then(|time| Time::read(time));
        let time = time.ok_or(Problem::TimeLost)?;
        Ok(Line { time, content })
    }

    fn content<'a>(&self, cells: &[&'a str]) -> Option<Content<'a>> {
        Some(match (self.columns, cells) {
            (Columns::Log, [_, _, direction, id, hex, meaning]) => {
                log_line(direction, id, hex, meaning)?
            }
            (Columns::Telemetry, [_, _, mode, _, _, temperature, position, _, _, hex]) => {
                let frame: Frame = hex.parse().ok()?;
                let model = model_of(&frame);
                // Both layouts have a position, but only one has a temperature. The article's script only sends
                // queries.
                let asked = match (temperature.is_empty(), position.is_empty()) {
                    _ if model.has_separate_frames() => None,
                    (false, false) => Some(Layout::Query),
                    (true, false) => Some(Layout::Drive),
                    (_, true) => None,
                };
                let reading = Reading::decode(model, &frame, asked.map(Into::into)).ok()?;
                Content::Telemetry {
                    id: reading.id(),
                    frame,
                    asked,
                    model,
                    mode: model
                        .modes()
                        .iter()
                        .copied()
                        .find(|of| mode_cell(*of) == *mode),
                }
            }
            (Columns::Original, [_, kind, content]) => original_line(kind, content)?,
            _ => return None,
        })
    }

    /// Writes a line to the session.
    pub(super) fn write(&mut self, at: Instant, line: &Line<'_>, writer: &mut Writer) {
        let kind = match line.content {
            Content::Sent(frame, meaning) => self.sent(frame, meaning),
            Content::Received(frame, meaning) => self.received(frame, meaning),
            Content::Telemetry {
                id,
                frame,
                asked,
                model,
                mode,
            } => {
                if std::mem::replace(&mut self.model, model) != model {
                    self.modes.clear();
                    let kind = LineEventKind::ModelSelected(model);
                    writer.line(&LineEvent { at, kind });
                }
                if let Some(mode) = mode.filter(|_| model.has_separate_frames())
                    && self.modes.insert(id, mode) != Some(mode)
                {
                    let value = None;
                    let kind = LineEventKind::Known { id, mode, value };
                    writer.line(&LineEvent { at, kind });
                }
                LineEventKind::Received { frame, asked }
            }
            Content::Line(kind) => kind,
            Content::Text { error, text } => {
                let event = Event::new(EventKind::Notice, text);
                return writer.event(at, &Event { error, ..event });
            }
        };
        writer.line(&LineEvent { at, kind });
    }

    /// A sent frame. The description names the loop in which the motor reads it. Without one it is the last reported
    /// loop.
    fn sent(&mut self, frame: Frame, meaning: &str) -> LineEventKind {
        let request = Request::parse(&frame).ok();
        let id = request.and_then(|request| request.addressee());
        let layout = request.and_then(|request| request.reply_layout());
        self.asked = id.zip(layout);
        let modes = [
            None,
            Some(Mode::Velocity),
            Some(Mode::Current),
            Some(Mode::Position),
        ];
        let meaning = spelled_out(meaning.to_owned());
        let matches =
            |mode: &Option<Mode>| spelled_out(explain_sent(&frame, *mode).to_string()) == meaning;
        let reported = id.and_then(|id| self.modes.get(&id).copied());
        let mode = modes.into_iter().find(matches).unwrap_or(reported);
        LineEventKind::Sent { frame, mode }
    }

    /// A received frame. The description tells its layout. Without one the request before it does.
    fn received(&mut self, frame: Frame, meaning: &str) -> LineEventKind {
        let Ok(reply) = Reply::decode(&frame, None) else {
            return LineEventKind::Junk(JunkBytes::new(frame.bytes()));
        };
        self.modes.insert(reply.id, reply.mode);
        let asked = self.asked.take().filter(|(id, _)| *id == reply.id);
        let layouts = [None, Some(Layout::Drive), Some(Layout::Query)];
        let meaning = meaning
            .strip_prefix(REPLY)
            .unwrap_or_else(|| unmarked(meaning));
        let meaning = spelled_out(meaning.to_owned());
        let matches = |layout: &Option<Layout>| {
            spelled_out(explain_received(&frame, *layout).to_string()) == meaning
        };
        let followed = asked.map(|(_, layout)| layout);
        let asked = layouts.into_iter().find(matches).unwrap_or(followed);
        LineEventKind::Received { frame, asked }
    }
}

/// The model of a reply in a file of telemetry, which has none that only names a loop. Frames of a DDSM315 are those of a
/// DDSM115.
const fn model_of(frame: &Frame) -> Model {
    let [_, byte_1, ..] = *frame.bytes();
    match byte_1 {
        0x64 | 0x74 => Model::Ddsm210,
        0x65 | 0x75 => Model::Ddsm400,
        _ => Model::Ddsm115,
    }
}

fn log_line<'a>(direction: &str, id: &str, hex: &str, meaning: &'a str) -> Option<Content<'a>> {
    let error = direction == "ERR";
    Some(match direction {
        "TX" => Content::Sent(hex.parse().ok()?, meaning),
        "RX" => Content::Received(hex.parse().ok()?, meaning),
        "ERR" if !hex.is_empty() && meaning.starts_with("not sent") => {
            let frame = hex.parse().ok()?;
            Content::Line(LineEventKind::NotSent { frame })
        }
        "ERR" if !hex.is_empty() => Content::Line(LineEventKind::Junk(junk(hex)?)),
        "ERR" if !id.is_empty() => {
            let id = u8::from_str_radix(id.strip_prefix("0x")?, 16).ok()?;
            let waited = meaning
                .strip_prefix("no reply within ")?
                .strip_suffix(" ms")?;
            Content::Line(LineEventKind::Silence {
                id: MotorId::new(id).ok()?,
                waited_us: tenths(waited)?.checked_mul(100)?,
            })
        }
        "SYS" | "ERR" => Content::Text {
            error,
            text: unmarked(meaning),
        },
        _ => return None,
    })
}

/// `→ TX [ID 0x01]: 01 64 00 64 00 00 00 00 00 4F`, and texts.
fn original_line<'a>(kind: &str, content: &'a str) -> Option<Content<'a>> {
    let frame = || content.split_once("]: ")?.1.trim().parse().ok();
    Some(match kind {
        "TX" => Content::Sent(frame()?, ""),
        "RX" => Content::Received(frame()?, ""),
        _ => Content::Text {
            error: kind == "Error",
            text: content,
        },
    })
}

/// Parses one to ten bytes. Our log has a single byte as `0x01`; earlier versions wrote `01`.
fn junk(hex: &str) -> Option<JunkBytes> {
    let hex = hex.strip_prefix("0x").unwrap_or(hex);
    let bytes = hex.split(' ').map(|byte| {
        let is_hex = byte.len() == 2 && byte.bytes().all(|digit| digit.is_ascii_hexdigit());
        u8::from_str_radix(byte, 16).ok().filter(|_| is_hex)
    });
    let bytes: Vec<u8> = bytes.take(FRAME_LEN + 1).collect::<Option<_>>()?;
    (bytes.len() <= FRAME_LEN).then(|| JunkBytes::new(&bytes))
}

/// `8.0` as tenths.
fn tenths(text: &str) -> Option<u32> {
    let (whole, tenth) = text.split_once('.')?;
    let tenth: u32 = tenth.parse().ok().filter(|tenth| *tenth < 10)?;
    whole
        .parse::<u32>()
        .ok()?
        .checked_mul(10)?
        .checked_add(tenth)
}
