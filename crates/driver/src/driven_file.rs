//! Remembers what is driven over an adapter beyond the end of the process.
//!
//! A motor may keep its last command for ever when frames cease. So what is driven is written to a file before the frame
//! that drives it is given to the port, and again when a reply has confirmed standstill. The driver that opens the
//! adapter next stops these motors first.

use std::{
    fs::{self, File, OpenOptions, TryLockError},
    io::{self, Read, Seek, SeekFrom, Write},
    path::{Path, PathBuf},
    sync::mpsc::{Sender, channel},
    thread,
};

use motorlink_bus::LeftDriven;
use motorlink_messages::LeftBehind;
use motorlink_protocol::family::Model;

/// The folder of the files for this user: `$XDG_STATE_HOME/motorlink/driven` on Linux, or what the system has in its
/// place. `None` if the user has no such folder.
#[must_use]
pub fn default_folder() -> Option<PathBuf> {
    let state = dirs::state_dir().or_else(dirs::data_local_dir)?;
    Some(state.join("motorlink").join("driven"))
}

/// The file of an adapter. It is locked while it is open, so that only one driver uses the adapter.
#[derive(Debug)]
pub(crate) struct DrivenFile {
    file: Option<File>,
    /// What the file has.
    written: Option<LeftBehind>,
    /// What was left driven and is on no bus now.
    carried: Option<LeftBehind>,
    /// Asks a thread to bring what is written from the memory of the system to the disk. A disk may take a tenth of a
    /// second, and no frame waits for it: only a computer that loses its power in that moment forgets.
    to_disk: Option<Sender<()>>,
}

/// Why there is no file.
#[derive(Debug)]
pub(crate) enum NoFile {
    /// Another driver uses the adapter.
    InUse,
    /// The system refuses it.
    Refused,
}

impl DrivenFile {
    /// Nothing is remembered, as for virtual motors.
    #[must_use]
    pub(crate) const fn none() -> Self {
        Self {
            file: None,
            written: None,
            carried: None,
            to_disk: None,
        }
    }

    /// Opens the file of this adapter, and reads what was left driven.
    pub(crate) fn open(folder: &Path, adapter: &str) -> Result<Self, NoFile> {
        let harmless = |letter: char| {
            if letter.is_ascii_alphanumeric() {
                letter
            } else {
                '-'
            }
        };
        let name: String = adapter.chars().map(harmless).collect();
        fs::create_dir_all(folder).map_err(refused)?;
        let path = folder.join(name.trim_matches('-'));
        let options = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path);
        let mut file = options.map_err(refused)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(NoFile::InUse),
            Err(TryLockError::Error(error)) => return Err(refused(error)),
        }
        let mut content = Vec::new();
        file.read_to_end(&mut content).map_err(refused)?;
        // What cannot be read is left out: its motors are asked like all others, and what turns is reported.
        let left = LeftBehind::of_file(&content).ok().flatten();
        let to_disk = file.try_clone().ok().and_then(disk_writer);
        Ok(Self {
            file: Some(file),
            written: None,
            carried: left.filter(|left| !left.motors.is_empty()),
            to_disk,
        })
    }

    /// The model of the motors that were left driven and are on no bus now.
    pub(crate) fn left_model(&self) -> Option<Model> {
        self.carried.as_ref().map(|left| left.model)
    }

    /// Takes the motors that were left driven: from now on a bus has them.
    pub(crate) fn take_left(&mut self) -> Vec<LeftDriven> {
        self.carried
            .take()
            .map_or_else(Vec::new, |left| left.motors)
    }

    /// A bus has ended and left these motors driven.
    pub(crate) fn carry(&mut self, left: LeftBehind) {
        match &mut self.carried {
            _ if left.motors.is_empty() => {}
            Some(carried) => {
                // The newer bus knows the line better.
                carried.model = left.model;
                carried.add(left.motors);
            }
            None => self.carried = Some(left),
        }
    }

    /// The motors that may turn, as far as the file knows.
    pub(crate) fn written(&self) -> Option<LeftBehind> {
        self.written.clone()
    }

    /// Writes what is driven, if it has changed. Returns false if it cannot be written.
    pub(crate) fn remember<I: Iterator<Item = LeftDriven>>(
        &mut self,
        model: Model,
        driven: impl Fn() -> I,
    ) -> bool {
        // Asked with every frame: it allocates nothing while nothing changes.
        let carried = || {
            self.carried
                .iter()
                .flat_map(|left| left.motors.iter().copied())
        };
        let model = match &self.carried {
            Some(left) if driven().next().is_none() => left.model,
            _ => model,
        };
        let is_as_written = |written: &LeftBehind| {
            let now = driven().chain(carried());
            written.model == model && written.motors.iter().copied().eq(now)
        };
        if self.written.as_ref().is_some_and(is_as_written) {
            return true;
        }
        let motors = driven().chain(carried()).collect();
        let left = LeftBehind { model, motors };
        let is_written = match &mut self.file {
            None => true,
            Some(file) => write(file, &left.to_file()).is_ok(),
        };
        // Not tried again before it changes.
        self.written = Some(left);
        if let Some(to_disk) = &self.to_disk {
            // Its thread ends with this file only.
            let _ = to_disk.send(());
        }
        is_written
    }
}

impl Drop for DrivenFile {
    /// The thread for the disk may still have the file open.
    fn drop(&mut self) {
        if let Some(file) = &self.file {
            // What cannot be unlocked is unlocked when that thread ends.
            let _ = file.unlock();
        }
    }
}

/// For `map_err`: whatever the cause is, the program is told that nothing is remembered.
fn refused(_cause: io::Error) -> NoFile {
    NoFile::Refused
}

/// The file always has the same length, so that a full disk does not matter after the first time.
fn write(file: &mut File, content: &[u8]) -> io::Result<()> {
    file.seek(SeekFrom::Start(0))?;
    file.write_all(content)
}

fn disk_writer(file: File) -> Option<Sender<()>> {
    let (to_disk, asked) = channel();
    let bring = move || {
        while asked.recv().is_ok() {
            // Several changes go together.
            while asked.try_recv().is_ok() {}
            // A disk that fails is noticed by the next write.
            let _ = file.sync_data();
        }
    };
    let name = "motorlink disk".to_owned();
    thread::Builder::new().name(name).spawn(bring).ok()?;
    Some(to_disk)
}

#[cfg(test)]
mod tests {
    use motorlink_protocol::{Mode, MotorId};

    use super::*;

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
        let open = || DrivenFile::open(folder.path(), "/dev/ttyUSB0").unwrap();
        let mut file = open();
        assert_eq!(file.left_model(), None);
        assert!(file.remember(Model::Ddsm210, || driven.iter().copied()));
        drop(file);

        // A bus for another model does not overwrite it.
        let mut file = open();
        assert!(file.remember(Model::Ddsm115, || [].into_iter()));
        drop(file);

        let mut file = open();
        assert_eq!(file.left_model(), Some(Model::Ddsm210));
        assert_eq!(file.take_left(), driven);
        assert!(file.remember(Model::Ddsm210, || [].into_iter()));
        drop(file);
        assert_eq!(open().left_model(), None);
    }

    #[test]
    fn an_adapter_has_one_driver_and_every_adapter_its_own_file() {
        let folder = tempfile::tempdir().unwrap();
        let _file = DrivenFile::open(folder.path(), "/dev/ttyUSB0").unwrap();
        let second = DrivenFile::open(folder.path(), "/dev/ttyUSB0");
        assert!(matches!(second, Err(NoFile::InUse)));
        assert!(DrivenFile::open(folder.path(), "/dev/ttyUSB1").is_ok());
    }
}
