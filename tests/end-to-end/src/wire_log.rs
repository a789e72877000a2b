//! The log of a wire, as `motorlink virtual` writes it.

use std::path::Path;
use std::{fmt, fs};

use anyhow::{Context, Result};

use crate::figures::percentile;

/// Who sent a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The browser.
    Host,
    /// A motor.
    Motor,
}

/// One frame, or other bytes that came in one piece.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frame {
    /// `CLOCK_MONOTONIC`, microseconds.
    pub at_us: u64,
    /// Who sent it.
    pub side: Side,
    /// All its bytes.
    pub bytes: Vec<u8>,
}

impl Frame {
    /// The motor that it is for or from: byte 0.
    #[must_use]
    pub fn id(&self) -> Option<u8> {
        self.bytes.first().copied()
    }

    /// A drive frame of the host, `ID 64 hi lo 00 00 accel brake 00 CRC`: its setpoint.
    #[must_use]
    pub fn drive_setpoint(&self) -> Option<i16> {
        match *self.bytes.as_slice() {
            [_, 0x64, high, low, _, _, _, _, _, _] if self.is_drive() => {
                Some(i16::from_be_bytes([high, low]))
            }
            _ => None,
        }
    }

    /// Whether it is a drive frame of the host. The ID query has the same second byte.
    #[must_use]
    pub fn is_drive(&self) -> bool {
        matches!(*self.bytes.as_slice(), [id, 0x64, ..] if id != 0xc8)
            && self.side == Side::Host
            && self.bytes.len() == 10
    }

    /// Whether it is a drive frame that brakes.
    #[must_use]
    pub fn brakes(&self) -> bool {
        self.is_drive() && self.bytes.get(7) == Some(&0xff)
    }

    /// Whether it is a stop frame: a drive frame of setpoint zero.
    #[must_use]
    pub fn is_stop(&self) -> bool {
        self.drive_setpoint() == Some(0)
    }

    fn parse(line: &str) -> Option<Self> {
        let mut fields = line.split('\t');
        let at_us = fields.next()?.parse().ok()?;
        let side = match fields.next()? {
            "HOST" => Side::Host,
            "MOTOR" => Side::Motor,
            _ => return None,
        };
        let hex = fields.next()?.split_ascii_whitespace();
        let bytes = hex
            .map(|byte| u8::from_str_radix(byte, 16).ok())
            .collect::<Option<_>>()?;
        Some(Self { at_us, side, bytes })
    }
}

/// The times between frames, in microseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Gaps {
    /// Number of gaps: one less than frames.
    pub count: usize,
    /// The shortest.
    pub min_us: u64,
    /// The median.
    pub median_us: u64,
    /// The 99th percentile.
    pub p99_us: u64,
    /// The longest.
    pub max_us: u64,
}

/// Frames in the order of the wire.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct WireLog {
    /// The frames.
    pub frames: Vec<Frame>,
}

impl WireLog {
    /// This log followed by the log in a file, without an incomplete last line.
    ///
    /// # Errors
    ///
    /// When there is none, or it is not one.
    pub fn followed_by(mut self, path: &Path) -> Result<Self> {
        let text = fs::read_to_string(path)
            .with_context(|| format!("no wire log at {}", path.display()))?;
        self.extend(&text)
            .with_context(|| format!("in {}", path.display()))?;
        Ok(self)
    }

    fn extend(&mut self, text: &str) -> Result<()> {
        for line in text.split_inclusive('\n') {
            let Some(line) = line.strip_suffix('\n') else {
                break;
            };
            let frame = Frame::parse(line)
                .with_context(|| format!("not a line of a wire log: {line:?}"))?;
            self.frames.push(frame);
        }
        Ok(())
    }

    fn only(&self, wanted: impl Fn(&Frame) -> bool) -> Self {
        Self {
            frames: self
                .frames
                .iter()
                .filter(|frame| wanted(frame))
                .cloned()
                .collect(),
        }
    }

    /// The frames of the host.
    #[must_use]
    pub fn from_host(&self) -> Self {
        self.only(|frame| frame.side == Side::Host)
    }

    /// The frames of the motors.
    #[must_use]
    pub fn from_motors(&self) -> Self {
        self.only(|frame| frame.side == Side::Motor)
    }

    /// The frames for or from one motor.
    #[must_use]
    pub fn of_motor(&self, id: u8) -> Self {
        self.only(|frame| frame.id() == Some(id))
    }

    /// The drive frames of the host.
    #[must_use]
    pub fn drives(&self) -> Self {
        self.only(Frame::is_drive)
    }

    /// The frames at or after a time of [`crate::now_us`].
    #[must_use]
    pub fn since(&self, at_us: u64) -> Self {
        self.only(|frame| frame.at_us >= at_us)
    }

    /// The frames before a time.
    #[must_use]
    pub fn until(&self, at_us: u64) -> Self {
        self.only(|frame| frame.at_us < at_us)
    }

    /// Number of frames.
    #[must_use]
    pub fn len(&self) -> usize {
        self.frames.len()
    }

    /// Whether there is no frame.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }

    /// The first frame.
    #[must_use]
    pub fn first(&self) -> Option<&Frame> {
        self.frames.first()
    }

    /// The last frame.
    #[must_use]
    pub fn last(&self) -> Option<&Frame> {
        self.frames.last()
    }

    /// The times between successive frames of this log; `None` for fewer than two.
    #[must_use]
    pub fn gaps(&self) -> Option<Gaps> {
        let pairs = self.frames.iter().zip(self.frames.iter().skip(1));
        let mut gaps: Vec<u64> = pairs
            .map(|(before, after)| after.at_us.saturating_sub(before.at_us))
            .collect();
        gaps.sort_unstable();
        Some(Gaps {
            count: gaps.len(),
            min_us: *gaps.first()?,
            median_us: percentile(&gaps, 50)?,
            p99_us: percentile(&gaps, 99)?,
            max_us: *gaps.last()?,
        })
    }
}

impl fmt::Display for WireLog {
    /// One frame per line, with the time since the first, for the output of a failed test.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let start_us = self.first().map_or(0, |frame| frame.at_us);
        for Frame { at_us, side, bytes } in &self.frames {
            let since_us = at_us.saturating_sub(start_us);
            write!(
                out,
                "{:6}.{:03} ms {side:?}",
                since_us / 1000,
                since_us % 1000
            )?;
            bytes
                .iter()
                .try_for_each(|byte| write!(out, " {byte:02X}"))?;
            writeln!(out)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOG: &str = "\
        1000\tHOST\tC8 64 00 00 00 00 00 00 00 DE\n\
        2000\tMOTOR\t01 02 00 00 00 00 00 00 00 00\n\
        20000\tHOST\t01 64 03 E8 00 00 00 00 00 AA\n\
        40100\tHOST\t01 64 ff 9c 00 00 00 00 00 AA\n\
        60000\tHOST\t01 64 00 00 00 00 00 FF 00 D1\n\
        80000\tHOST\t01 64 00";

    fn log() -> WireLog {
        let mut log = WireLog::default();
        log.extend(LOG).unwrap();
        log
    }

    #[test]
    fn a_line_still_being_written_is_left_out() {
        assert_eq!(log().len(), 5);
        assert_eq!(log().last().unwrap().at_us, 60000);
    }

    #[test]
    fn drive_frames_say_what_they_ask() {
        let setpoints: Vec<_> = log()
            .drives()
            .frames
            .iter()
            .map(|frame| frame.drive_setpoint().unwrap())
            .collect();
        assert_eq!(setpoints, [1000, -100, 0]);
        assert!(log().last().unwrap().brakes());
        assert!(log().last().unwrap().is_stop());
        assert_eq!(log().from_motors().len(), 1);
        assert_eq!(log().of_motor(0xc8).len(), 1);
    }

    #[test]
    fn gaps_are_counted_from_frame_to_frame() {
        let gaps = log().drives().gaps().unwrap();
        let expected = Gaps {
            count: 2,
            min_us: 19900,
            median_us: 19900,
            p99_us: 20100,
            max_us: 20100,
        };
        assert_eq!(gaps, expected);
        assert_eq!(log().since(60000).gaps(), None);
        assert_eq!(log().until(2000).len(), 1);
    }

    #[test]
    fn a_log_can_be_shown() {
        let shown = log().since(40100).to_string();
        let expected = "     0.000 ms Host 01 64 FF 9C 00 00 00 00 00 AA\n    19.900 ms Host 01 64 \
                        00 00 00 00 00 FF 00 D1\n";
        assert_eq!(shown, expected);
    }

    #[test]
    fn a_foreign_line_is_an_error_that_shows_it() {
        let error = WireLog::default().extend("1000\tNOBODY\t00\n").unwrap_err();
        assert!(error.to_string().contains("NOBODY"));
    }
}
