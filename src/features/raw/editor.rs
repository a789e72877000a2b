//! Parses a frame that a user types or pastes, in any usual form, without guessing.
//!
//! | form | example |
//! |---|---|
//! | bytes apart | `01 74 00`, `01,74;00`, `01-74:00`, `[0x01, 0x74, 0x0]`, over several lines |
//! | digits without separators | `017400000000000000`, `0x017400000000000000` |
//! | a line of the packet log | `13:15:36.962 TX 0x01 01 64 00 64 00 00 00 00 00 4F drive +100 rpm` |
//!
//! Anything but two hex digits is an error at its byte and is never skipped. Bytes are counted from 0.

use motorlink_messages::protocol::{FRAME_LEN, Frame, family::Model};

/// The content of the textbox, byte by byte: at most one more than a frame has.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Entered {
    pieces: Vec<Piece>,
    /// The model that the frame is meant for. It decides the last byte.
    model: Model,
}

/// The text of one byte.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Piece {
    /// A byte.
    Byte(u8),
    /// One digit at the end of the text: the second one is still missing.
    Half(char),
    /// An invalid byte.
    Wrong {
        /// Its text.
        text: String,
        /// Why it is invalid.
        why: Why,
    },
}

/// Why a byte is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Why {
    /// Characters other than 0-9 and A-F.
    NotHex,
    /// A single digit between bytes: it can be either half.
    OneDigit,
    /// 0x without digits.
    NoDigits,
    /// More than two digits after 0x, and not a whole frame of them.
    ManyDigits,
    /// The direction of a log line in a text that is not exactly one log line.
    NotOneLogLine,
    /// An eleventh byte.
    Surplus,
}

/// The result of all pieces.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Nothing is typed.
    Nothing,
    /// This number of valid bytes, which is too few.
    TooFew(usize),
    /// Nine bytes of a mode switch, which has its loop where other frames have the CRC.
    LoopMissing,
    /// This piece, counted from 0, is invalid.
    Wrong(usize),
    /// A frame.
    Frame {
        /// Its ten bytes.
        frame: Frame,
        /// The origin of the tenth byte.
        tenth: Tenth,
    },
}

/// The origin of the last byte of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tenth {
    /// The CRC, computed here.
    CrcAdded,
    /// 00, added to a set-ID frame as the maker sends it.
    ZeroAdded,
    /// Typed, and the right CRC.
    Crc,
    /// Typed, but a wrong CRC.
    WrongCrc {
        /// The right CRC.
        expected: u8,
    },
    /// Typed, in a frame that carries no CRC: the loop of a mode switch.
    Loop,
    /// Typed, in a set-ID frame that carries none.
    NoCrc,
}

/// Number of digits of a frame without and with its last byte.
const WHOLE_FRAMES: [usize; 2] = [2 * FRAME_LEN - 2, 2 * FRAME_LEN];

/// First bytes of a set-ID frame.
pub const SET_ID: [u8; 3] = [0xAA, 0x55, 0x53];

/// Second byte of a mode switch.
pub const SWITCH_MODE: u8 = 0xA0;

impl Entered {
    /// Parses the content of the textbox.
    #[must_use]
    pub fn read(text: &str) -> Self {
        let mut entered = Self::default();
        match columns_of_log(text) {
            Some(Ok(words)) => words.for_each(|word| entered.take_word(word, false)),
            Some(Err(direction)) => entered.wrong(direction, Why::NotOneLogLine),
            None => {
                let mut words = text.split(is_separator).peekable();
                while let Some(word) = words.next() {
                    // The user may still be typing the last word.
                    let at_end = words.peek().is_none();
                    if !word.is_empty() {
                        entered.take_word(word, at_end);
                    }
                }
            }
        }
        entered
    }

    /// The same bytes, for motors of this model.
    #[must_use]
    pub fn for_model(self, model: Model) -> Self {
        Self { model, ..self }
    }

    /// The model that the frame is meant for.
    #[must_use]
    pub fn model(&self) -> Model {
        self.model
    }

    /// The pieces, one per byte.
    #[must_use]
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// The result of all pieces.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        if self.pieces.is_empty() {
            return Outcome::Nothing;
        }
        let wrong = |piece: &Piece| matches!(piece, Piece::Wrong { .. });
        if let Some(place) = self.pieces.iter().position(wrong) {
            return Outcome::Wrong(place);
        }
        let bytes: Vec<u8> = self.bytes().collect();
        if bytes.len() < self.pieces.len() {
            // The last piece is a half.
            return Outcome::TooFew(bytes.len());
        }
        if let Ok(bytes) = <[u8; FRAME_LEN]>::try_from(bytes.as_slice()) {
            let frame = Frame::new(bytes);
            return Outcome::Frame {
                frame,
                tenth: typed_tenth(&frame, self.model),
            };
        }
        match <[u8; FRAME_LEN - 1]>::try_from(bytes.as_slice()) {
            Ok(body) if self.model.has_separate_frames() => Outcome::Frame {
                frame: Frame::with_crc(body),
                tenth: Tenth::CrcAdded,
            },
            Ok(body) => without_tenth(body),
            Err(_) => Outcome::TooFew(bytes.len()),
        }
    }

    /// The frame that can be sent.
    #[must_use]
    pub fn frame(&self) -> Option<Frame> {
        match self.outcome() {
            Outcome::Frame { frame, .. } => Some(frame),
            _ => None,
        }
    }

    fn bytes(&self) -> impl Iterator<Item = u8> {
        self.pieces.iter().filter_map(|piece| match piece {
            Piece::Byte(byte) => Some(*byte),
            _ => None,
        })
    }

    fn take_word(&mut self, word: &str, at_end: bool) {
        let prefixed = word.strip_prefix("0x").or_else(|| word.strip_prefix("0X"));
        let Some(digits) = prefixed else {
            self.take_digits(word, at_end);
            return;
        };
        let is_hex = digits.bytes().all(|digit| digit.is_ascii_hexdigit());
        match digits.len() {
            0 if at_end => self.push(Piece::Half('0')),
            0 => self.wrong(word, Why::NoDigits),
            _ if !is_hex => self.wrong(word, Why::NotHex),
            1 | 2 => self.push_byte(digits),
            whole if WHOLE_FRAMES.contains(&whole) => self.take_digits(digits, at_end),
            _ => self.wrong(word, Why::ManyDigits),
        }
    }

    /// Takes two digits per byte, up to the first invalid byte.
    fn take_digits(&mut self, word: &str, at_end: bool) {
        let mut rest = word;
        while let Some(first) = rest.chars().next() {
            let hex = rest
                .bytes()
                .take_while(u8::is_ascii_hexdigit)
                .take(2)
                .count();
            match (hex, rest.get(..2)) {
                (2, Some(digits)) => {
                    self.push_byte(digits);
                    rest = rest.get(2..).unwrap_or_default();
                }
                (1, _) if rest.len() == 1 && at_end => {
                    self.push(Piece::Half(first));
                    return;
                }
                (1, _) if rest.len() == 1 => {
                    self.wrong(rest, Why::OneDigit);
                    return;
                }
                _ => {
                    self.wrong(rest, Why::NotHex);
                    return;
                }
            }
        }
    }

    fn push_byte(&mut self, digits: &str) {
        match u8::from_str_radix(digits, 16) {
            Ok(byte) if self.pieces.len() < FRAME_LEN => self.push(Piece::Byte(byte)),
            Ok(_) => self.wrong(digits, Why::Surplus),
            Err(_) => self.wrong(digits, Why::NotHex),
        }
    }

    fn wrong(&mut self, text: &str, why: Why) {
        self.push(Piece::Wrong {
            text: text.to_owned(),
            why,
        });
    }

    fn push(&mut self, piece: Piece) {
        // The rest is ignored: the eleventh byte is an error already.
        if self.pieces.len() <= FRAME_LEN {
            self.pieces.push(piece);
        }
    }
}

fn without_tenth(body: [u8; FRAME_LEN - 1]) -> Outcome {
    if body.starts_with(&SET_ID) {
        let [b0, b1, b2, b3, b4, b5, b6, b7, b8] = body;
        let frame = Frame::new([b0, b1, b2, b3, b4, b5, b6, b7, b8, 0]);
        let tenth = Tenth::ZeroAdded;
        return Outcome::Frame { frame, tenth };
    }
    if body.get(1) == Some(&SWITCH_MODE) {
        return Outcome::LoopMissing;
    }
    Outcome::Frame {
        frame: Frame::with_crc(body),
        tenth: Tenth::CrcAdded,
    }
}

fn typed_tenth(frame: &Frame, model: Model) -> Tenth {
    let bytes = frame.bytes();
    // Every separate frame has a CRC.
    let has_crc = model.has_separate_frames();
    if bytes.starts_with(&SET_ID) && !has_crc {
        Tenth::NoCrc
    } else if bytes.get(1) == Some(&SWITCH_MODE) && !has_crc {
        Tenth::Loop
    } else if frame.crc_holds() {
        Tenth::Crc
    } else {
        let expected = frame.crc_expected();
        Tenth::WrongCrc { expected }
    }
}

/// Whether a character separates bytes.
fn is_separator(character: char) -> bool {
    character.is_ascii_whitespace()
        || matches!(
            character,
            ',' | ';'
                | ':'
                | '-'
                | '–'
                | '_'
                | '|'
                | '/'
                | '['
                | ']'
                | '{'
                | '}'
                | '('
                | ')'
                | '<'
                | '>'
                | '"'
                | '\''
                | '\u{A0}'
        )
}

/// The words with the bytes of a packet log line. `None` if the text has no direction, and `Err` with the direction
/// if it has one but is not exactly one log line.
///
/// A log line has a time, the direction and the ID as `0x01` before the bytes, and a description after them. The
/// direction identifies it, because it cannot be a byte: only times precede it, and the ID after it has a prefix that
/// the bytes of the log do not have.
fn columns_of_log(text: &str) -> Option<Result<impl Iterator<Item = &str>, &str>> {
    let columns = |character: char| character.is_whitespace() || matches!(character, ',' | '"');
    let mut words = text.split(columns).filter(|word| !word.is_empty());
    let is_direction = |word: &&str| matches!(*word, "TX" | "RX");
    let mut before = words.clone().take_while(|word| !is_direction(word));
    let direction = words.find(is_direction)?;
    let is_time = |word: &str| word.contains([':', '.']);
    if !before.all(is_time) || words.clone().any(|word| is_direction(&word)) {
        return Some(Err(direction));
    }
    let is_byte =
        |word: &&str| word.len() == 2 && word.bytes().all(|digit| digit.is_ascii_hexdigit());
    let mut behind_id = words.clone();
    let id = behind_id.next();
    if id.is_some_and(|id| id.starts_with("0x") || matches!(id, "-" | "–")) {
        words = behind_id;
    }
    if !words.clone().next().is_some_and(|word| is_byte(&word)) {
        return Some(Err(direction));
    }
    Some(Ok(words.take_while(is_byte)))
}

#[cfg(test)]
#[path = "editor_tests.rs"]
mod tests;
