//! The file of an adapter on the disk. It is locked while it is open, so that only one driver uses the adapter.

use std::{
    fs::{self, File, OpenOptions, TryLockError},
    io::{self, Read, Seek, SeekFrom, Write},
    path::{Path, PathBuf},
    sync::mpsc::{Sender, channel},
    thread,
};

use crate::driven_file::{NoFile, Store};

/// The folder of the files for this user: `$XDG_STATE_HOME/motorlink/driven` on Linux, or what the system has in its
/// place. `None` if the user has no such folder.
#[must_use]
pub fn default_folder() -> Option<PathBuf> {
    let state = dirs::state_dir().or_else(dirs::data_local_dir)?;
    Some(state.join("motorlink").join("driven"))
}

/// The file of this adapter.
pub(crate) fn path_of(folder: &Path, adapter: &str) -> PathBuf {
    let harmless = |letter: char| {
        if letter.is_ascii_alphanumeric() {
            letter
        } else {
            '-'
        }
    };
    let name: String = adapter.chars().map(harmless).collect();
    folder.join(name.trim_matches('-'))
}

/// A file that is open and locked.
#[derive(Debug)]
pub(crate) struct LockedFile {
    file: File,
    /// Asks a thread to bring what is written from the memory of the system to the disk. A disk may take a tenth of a
    /// second, and no frame waits for it: only a computer that loses its power in that moment forgets.
    to_disk: Option<Sender<()>>,
}

impl LockedFile {
    /// Opens the file of this adapter. Returns its content too.
    pub(crate) fn open(folder: &Path, adapter: &str) -> Result<(Self, Vec<u8>), NoFile> {
        fs::create_dir_all(folder).map_err(refused)?;
        let options = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path_of(folder, adapter));
        let mut file = options.map_err(refused)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(NoFile::InUse),
            Err(TryLockError::Error(error)) => return Err(refused(error)),
        }
        let mut content = Vec::new();
        file.read_to_end(&mut content).map_err(refused)?;
        let to_disk = file.try_clone().ok().and_then(disk_writer);
        Ok((Self { file, to_disk }, content))
    }
}

impl Store for LockedFile {
    fn write(&mut self, content: &[u8]) -> io::Result<()> {
        self.file.seek(SeekFrom::Start(0))?;
        self.file.write_all(content)?;
        if let Some(to_disk) = &self.to_disk {
            // Its thread ends with this file only.
            let _ = to_disk.send(());
        }
        Ok(())
    }
}

impl Drop for LockedFile {
    /// The thread for the disk may still have the file open.
    fn drop(&mut self) {
        // What cannot be unlocked is unlocked when that thread ends.
        let _ = self.file.unlock();
    }
}

/// For `map_err`: whatever the cause is, the program is told that nothing is remembered.
fn refused(_cause: io::Error) -> NoFile {
    NoFile::Refused
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
