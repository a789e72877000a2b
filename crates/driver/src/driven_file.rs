//! Remembers what is driven over an adapter beyond the end of the process.
//!
//! A motor may keep its last command for ever when frames cease. So what is driven is written to a file before the frame
//! that drives it is given to the port, and again when a reply has confirmed standstill. The driver that opens the
//! adapter next stops these motors first.

use std::io;

use motorlink_bus::LeftDriven;
use motorlink_messages::{LeftBehind, NamedInFile};
use motorlink_protocol::family::Model;

/// Where the file is kept.
pub trait Store: std::fmt::Debug {
    /// Writes the file. It always has the same length, so that a full disk does not matter after the first time.
    ///
    /// # Errors
    /// The system refuses it.
    fn write(&mut self, content: &[u8]) -> io::Result<()>;
}

/// The file of an adapter.
#[derive(Debug)]
pub struct DrivenFile {
    store: Option<Box<dyn Store>>,
    written: NamedInFile,
    /// What was left driven and is on no bus now.
    pub(crate) left: LeftBehind,
}

/// Why there is no file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoFile {
    /// Another driver uses the adapter.
    InUse,
    /// The system refuses it.
    Refused,
}

impl DrivenFile {
    /// Nothing is remembered, as for virtual motors.
    #[must_use]
    pub(crate) fn none() -> Self {
        Self {
            store: None,
            written: NamedInFile::default(),
            left: LeftBehind::default(),
        }
    }

    /// The file that is kept here, and says by its content what was left driven.
    #[must_use]
    pub fn new(store: Box<dyn Store>, content: &[u8]) -> Self {
        // What cannot be read is left out: its motors are asked like all others, and what turns is reported.
        let left = LeftBehind::of_file(content).ok().flatten();
        Self {
            store: Some(store),
            written: NamedInFile::default(),
            left: left.unwrap_or_default(),
        }
    }

    /// The motors that may turn, as far as the file knows.
    pub(crate) fn written(&self) -> Option<LeftBehind> {
        self.written.written().cloned()
    }

    /// Writes what is driven, if it has changed. Returns false if it cannot be written.
    pub(crate) fn remember<I: Iterator<Item = LeftDriven>>(
        &mut self,
        model: Model,
        driven: impl Fn() -> I,
    ) -> bool {
        let Self {
            store,
            written,
            left,
        } = self;
        written.update(model, driven, left, |left| match store {
            None => true,
            Some(store) => store.write(&left.to_file()).is_ok(),
        })
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use motorlink_protocol::{Mode, MotorId};

    use super::*;
    use crate::locked_file::LockedFile;

    fn open(folder: &Path, adapter: &str) -> Result<DrivenFile, NoFile> {
        let (file, content) = LockedFile::open(folder, adapter)?;
        Ok(DrivenFile::new(Box::new(file), &content))
    }

    fn left(ids: &[u8]) -> Vec<LeftDriven> {
        let of = |id: &u8| LeftDriven {
            id: MotorId::new(*id).unwrap(),
            mode: Some(Mode::Velocity),
        };
        ids.iter().map(of).collect()
    }

    #[test]
    fn what_is_driven_outlives_the_driver_until_it_stands() {
        let folder = tempfile::tempdir().unwrap();
        let driven = left(&[1, 7]);
        let open = || open(folder.path(), "/dev/ttyUSB0").unwrap();
        let mut file = open();
        assert_eq!(file.left.model_of_motors(), None);
        assert!(file.remember(Model::Ddsm210, || driven.iter().copied()));
        drop(file);

        // A bus for another model does not overwrite it.
        let mut file = open();
        assert!(file.remember(Model::Ddsm115, || [].into_iter()));
        drop(file);

        let mut file = open();
        assert_eq!(file.left.model_of_motors(), Some(Model::Ddsm210));
        assert_eq!(file.left.take(), driven);
        assert!(file.remember(Model::Ddsm210, || [].into_iter()));
        drop(file);
        assert_eq!(open().left.model_of_motors(), None);
    }

    #[test]
    fn an_adapter_has_one_driver_and_every_adapter_its_own_file() {
        let folder = tempfile::tempdir().unwrap();
        let _file = open(folder.path(), "/dev/ttyUSB0").unwrap();
        let second = open(folder.path(), "/dev/ttyUSB0");
        assert!(matches!(second, Err(NoFile::InUse)));
        assert!(open(folder.path(), "/dev/ttyUSB1").is_ok());
    }
}
