//! What was driven when a connection ended, as a file keeps it.

use motorlink_bus::LeftDriven;
use motorlink_protocol::family::Model;
use serde::{Deserialize, Serialize};

use crate::{decode, encode};

/// The motors that were driven over an adapter, and whose standstill no reply has confirmed since.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LeftBehind {
    /// Their model.
    pub model: Model,
    /// The motors.
    pub motors: Vec<LeftDriven>,
}

/// The content of a file is not what [`LeftBehind::to_file`] has written: something may turn, and the motors have to be
/// asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Damaged;

/// The first byte of a file.
const VERSION: u8 = 1;

/// Bytes in front of the encoded motors: the version, the checksum and the length.
const HEAD: usize = 7;

impl LeftBehind {
    /// Length of every file: as much as 254 motors take. A file that never grows is written without asking for room.
    pub const FILE_BYTES: usize = 1024;

    /// Nothing is driven.
    #[must_use]
    pub const fn nothing(model: Model) -> Self {
        Self {
            model,
            motors: Vec::new(),
        }
    }

    /// The model of its motors; `None` if there are none.
    #[must_use]
    pub fn model_of_motors(&self) -> Option<Model> {
        (!self.motors.is_empty()).then_some(self.model)
    }

    /// Takes the motors: from now on a bus has them.
    pub fn take(&mut self) -> Vec<LeftDriven> {
        std::mem::take(&mut self.motors)
    }

    /// Adds what a bus has left driven that has just ended. It knows the model of the line best.
    pub fn carry(&mut self, newer: Self) {
        if let Some(model) = newer.model_of_motors() {
            self.model = model;
            self.add(newer.motors);
        }
    }

    /// Adds what a file names. It may be of another adapter, so the model stays if there is one.
    pub fn learn(&mut self, mut of_file: Self) {
        of_file.carry(std::mem::take(self));
        *self = of_file;
    }

    /// The content of its file.
    ///
    /// | bytes | content |
    /// |---|---|
    /// | 0 | version |
    /// | 1-4 | checksum of the motors, little endian |
    /// | 5-6 | length of the motors, little endian |
    /// | 7.. | the motors, then zeros |
    #[must_use]
    pub fn to_file(&self) -> Vec<u8> {
        // A value of ours always encodes.
        let motors = encode(self).unwrap_or_default();
        let length = u16::try_from(motors.len()).unwrap_or_default();
        let mut file = Vec::with_capacity(Self::FILE_BYTES);
        file.push(VERSION);
        file.extend(checksum(&motors).to_le_bytes());
        file.extend(length.to_le_bytes());
        file.extend(motors);
        file.resize(Self::FILE_BYTES, 0);
        file
    }

    /// Reads a file; `None` if it is new.
    ///
    /// # Errors
    /// [`Damaged`] for everything that [`LeftBehind::to_file`] does not write.
    pub fn of_file(file: &[u8]) -> Result<Option<Self>, Damaged> {
        if file.is_empty() {
            return Ok(None);
        }
        let (head, rest) = file.split_at_checked(HEAD).ok_or(Damaged)?;
        let [VERSION, a, b, c, d, low, high] = *head else {
            return Err(Damaged);
        };
        let length = usize::from(u16::from_le_bytes([low, high]));
        let motors = rest.get(..length).ok_or(Damaged)?;
        if checksum(motors) != u32::from_le_bytes([a, b, c, d]) {
            return Err(Damaged);
        }
        decode(motors).map(Some).map_err(|_| Damaged)
    }

    /// Adds motors that are not among these.
    fn add(&mut self, others: impl IntoIterator<Item = LeftDriven>) {
        for other in others {
            match self.motors.iter_mut().find(|motor| motor.id == other.id) {
                // In one of several loops: not known.
                Some(motor) if motor.mode != other.mode => motor.mode = None,
                Some(_) => {}
                None => self.motors.push(other),
            }
        }
    }
}

/// The motors that a file names.
#[derive(Debug, Default)]
pub struct NamedInFile(Option<LeftBehind>);

impl NamedInFile {
    /// The motors of the last [`NamedInFile::update`], also if the file does not take them.
    #[must_use]
    pub const fn written(&self) -> Option<&LeftBehind> {
        self.0.as_ref()
    }

    /// Writes the motors that are driven now and those that were `left` driven, if they have changed. Returns false if the
    /// file does not take them; that is tried again when they change.
    pub fn update<I: Iterator<Item = LeftDriven>>(
        &mut self,
        model: Model,
        driven: impl Fn() -> I,
        left: &LeftBehind,
        write: impl FnOnce(&LeftBehind) -> bool,
    ) -> bool {
        let is_driven = |left: &LeftDriven| driven().any(|motor| motor.id == left.id);
        let others = || left.motors.iter().copied().filter(|left| !is_driven(left));
        let all = || driven().chain(others());
        let of_left = left.model_of_motors().filter(|_| driven().next().is_none());
        let model = of_left.unwrap_or(model);
        // Asked with every frame: it allocates nothing while nothing changes.
        let is_written = |written: &LeftBehind| {
            written.model == model && written.motors.iter().copied().eq(all())
        };
        if self.0.as_ref().is_some_and(is_written) {
            return true;
        }
        let motors = all().collect();
        write(self.0.insert(LeftBehind { model, motors }))
    }
}

/// FNV-1a of 32 bits.
fn checksum(bytes: &[u8]) -> u32 {
    bytes.iter().fold(0x811C_9DC5, |sum, byte| {
        (sum ^ u32::from(*byte)).wrapping_mul(0x0100_0193)
    })
}

#[cfg(test)]
mod tests {
    use motorlink_protocol::{Mode, MotorId};

    use super::*;

    fn left(ids: std::ops::RangeInclusive<u8>) -> LeftBehind {
        let motors = ids.map(|id| LeftDriven {
            id: MotorId::new(id).unwrap(),
            mode: [None, Some(Mode::Velocity), Some(Mode::Position)][usize::from(id) % 3],
        });
        LeftBehind {
            model: Model::Ddsm400,
            motors: motors.collect(),
        }
    }

    #[test]
    fn what_is_remembered_is_read_as_it_was_written_and_every_file_is_as_long() {
        for motors in [
            left(1..=1),
            left(1..=254),
            LeftBehind::nothing(Model::Ddsm210),
        ] {
            let file = motors.to_file();
            assert_eq!(file.len(), LeftBehind::FILE_BYTES);
            assert_eq!(LeftBehind::of_file(&file), Ok(Some(motors)));
        }
        assert_eq!(LeftBehind::of_file(&[]), Ok(None));
    }

    #[test]
    fn a_damaged_file_is_never_read_as_motors() {
        let file = left(1..=3).to_file();
        let used = HEAD + usize::from(file[5]);
        for place in 0..used {
            for bit in 0..8 {
                let mut damaged = file.clone();
                damaged[place] ^= 1 << bit;
                assert_eq!(LeftBehind::of_file(&damaged), Err(Damaged), "{place} {bit}");
            }
        }
        for length in 1..used {
            assert_eq!(
                LeftBehind::of_file(&file[..length]),
                Err(Damaged),
                "{length}"
            );
        }
        assert_eq!(LeftBehind::of_file(&[0; 1024]), Err(Damaged));
        assert_eq!(LeftBehind::of_file(&[0xFF; 1024]), Err(Damaged));
    }

    #[test]
    fn a_motor_that_was_left_in_two_loops_is_in_an_unknown_one() {
        let mut all = left(1..=2);
        let other = LeftDriven {
            mode: Some(Mode::Current),
            ..all.motors[0]
        };
        all.add([other, left(3..=3).motors[0]]);
        assert_eq!(all.motors.len(), 3);
        assert_eq!(all.motors[0].mode, None);
        assert_eq!(all.motors[1].mode, Some(Mode::Position));
    }

    #[test]
    fn a_bus_decides_the_model_and_a_file_only_if_none_is_known() {
        let of = |model, ids| LeftBehind { model, ..left(ids) };
        let mut known = of(Model::Ddsm115, 1..=1);
        known.learn(of(Model::Ddsm400, 5..=5));
        assert_eq!(known.model, Model::Ddsm115);
        assert_eq!(known.motors.len(), 2);
        known.carry(of(Model::Ddsm210, 1..=1));
        assert_eq!(known.model, Model::Ddsm210);
        assert_eq!(known.motors.len(), 2);
        let mut none = LeftBehind::default();
        none.learn(of(Model::Ddsm400, 5..=5));
        assert_eq!(none, of(Model::Ddsm400, 5..=5));
    }

    #[test]
    fn a_motor_that_is_driven_and_was_left_driven_is_named_once() {
        let mut written = Vec::new();
        let driven = left(1..=2).motors;
        let mut file = NamedInFile::default();
        file.update(
            Model::Ddsm115,
            || driven.iter().copied(),
            &left(2..=3),
            |all| {
                written = all.motors.iter().map(|motor| motor.id.get()).collect();
                true
            },
        );
        assert_eq!(written, [1, 2, 3]);
    }
}
