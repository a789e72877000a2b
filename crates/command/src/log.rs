//! `serve --log`: session files of all that happens on the line.
//!
//! A thread of its own writes them: a slow disk delays neither the wire nor a page.

use std::{
    fmt::Display,
    fs::{self, File},
    io::{self, Write},
    path::{Path, PathBuf},
    sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel},
    thread::{self, JoinHandle},
    time::{Duration, SystemTime},
};

use motorlink_bus::{Event, LineEvent, LineEventKind};
use motorlink_driver::{Entry, zero_unix_us};
use motorlink_protocol::{Instant, family::Model};
use motorlink_session::Writer;
use time::OffsetDateTime;

use crate::{
    failure::Failure,
    output::say,
    recording::{PIECE, write_entry},
};

/// Pieces that wait for the disk: 16 MB, which is several minutes of a busy line.
const QUEUE: usize = 256;
/// A file is not longer than this, and not larger. A later one follows.
const FILE_LASTS: Duration = Duration::from_secs(3600);
const FILE_MAX: usize = 64 << 20;
/// The files of a folder together. The oldest are removed.
const FOLDER_MAX: u64 = 2 << 30;

/// How the name of a file begins and ends. Its number is between, so that names sort by age though a clock is wrong.
/// An exported packet log begins so too, and ends in `.csv`.
const NAME: (&str, &str) = ("motorlink-log-", ".mcap");

/// Session files that are being written.
pub struct Log {
    /// `None` after the disk has failed.
    disk: Option<Disk>,
    writer: Writer,
    /// The model of the line, with which each file begins.
    model: Model,
    begun: Instant,
    bytes: usize,
}

/// The thread that writes.
struct Disk {
    to: SyncSender<ToDisk>,
    failed: Receiver<Failure>,
    thread: JoinHandle<()>,
}

enum ToDisk {
    Piece(Vec<u8>),
    NextFile,
}

impl Log {
    /// Begins a file in this folder, which is created if it does not exist. `now` is the time of the driver.
    ///
    /// # Errors
    /// The folder or the file cannot be written.
    pub fn begin(folder: &Path, now: Instant, model: Model) -> Result<Self, Failure> {
        fs::create_dir_all(folder).map_err(Failure::file(folder))?;
        let files = Files {
            folder: folder.to_owned(),
        };
        let (path, file) = files.next().map_err(Failure::file(folder))?;
        let (to, pieces) = sync_channel(QUEUE);
        let (fails, failed) = sync_channel(1);
        let write = move || {
            if let Err((path, error)) = files.write(path, file, &pieces) {
                // The server may have ended.
                let _ = fails.send(Failure::file(&path)(error));
            }
        };
        let thread = thread::Builder::new().name("motorlink log".to_owned());
        let thread = thread.spawn(write).map_err(Failure::file(folder))?;
        Ok(Self {
            disk: Some(Disk { to, failed, thread }),
            writer: new_writer(now, model),
            model,
            begun: now,
            bytes: 0,
        })
    }

    /// Adds an entry of the driver. A disk that fails is said once: the motors go on, and no more is written.
    pub fn add(&mut self, at: Instant, entry: &Entry) {
        if self.disk.is_none() {
            return;
        }
        if let Entry::Event(Event::Line(line)) = entry
            && let LineEventKind::ModelSelected(model) = line.kind
        {
            self.model = model;
        }
        write_entry(&mut self.writer, at, entry);
        if self.writer.written() >= PIECE {
            let piece = self.writer.take();
            self.bytes += piece.len();
            self.send(ToDisk::Piece(piece));
        }
        if self.bytes >= FILE_MAX || at > self.begun + FILE_LASTS {
            let last = std::mem::replace(&mut self.writer, new_writer(at, self.model)).finish();
            (self.begun, self.bytes) = (at, 0);
            self.send(ToDisk::Piece(last));
            self.send(ToDisk::NextFile);
        }
    }

    fn send(&mut self, piece: ToDisk) {
        let Some(disk) = &self.disk else { return };
        match disk.to.try_send(piece) {
            Ok(()) => {}
            Err(TrySendError::Full(_)) => {
                ended("the disk is too slow");
                self.disk = None;
            }
            Err(TrySendError::Disconnected(_)) => {
                if let Ok(failure) = disk.failed.recv() {
                    ended(failure);
                }
                self.disk = None;
            }
        }
    }

    /// Writes what is left, and the index.
    pub fn finish(mut self) {
        let last = std::mem::replace(&mut self.writer, new_writer(self.begun, self.model)).finish();
        self.send(ToDisk::Piece(last));
        if let Some(disk) = self.disk {
            drop(disk.to);
            let _ = disk.thread.join();
            if let Ok(failure) = disk.failed.try_recv() {
                ended(failure);
            }
        }
    }
}

fn ended(why: impl Display) {
    say(format_args!("--log has ended: {why}"));
}

fn new_writer(now: Instant, model: Model) -> Writer {
    let about = [(
        "program",
        concat!("motorlink serve ", env!("CARGO_PKG_VERSION")),
    )];
    let mut writer = Writer::new(zero_unix_us(now), &about);
    let kind = LineEventKind::ModelSelected(model);
    writer.line(&LineEvent { at: now, kind });
    writer
}

/// The files of a folder.
struct Files {
    folder: PathBuf,
}

impl Files {
    /// Writes pieces until no more come.
    fn write(
        &self,
        mut path: PathBuf,
        mut file: File,
        pieces: &Receiver<ToDisk>,
    ) -> Result<(), (PathBuf, io::Error)> {
        for piece in pieces {
            let written = match piece {
                ToDisk::Piece(bytes) => file.write_all(&bytes),
                ToDisk::NextFile => self.next().map(|next| (path, file) = next),
            };
            written.map_err(|error| (path.clone(), error))?;
        }
        file.sync_all().map_err(|error| (path, error))
    }

    /// Removes the oldest files where they are too many, and begins a new one.
    fn next(&self) -> io::Result<(PathBuf, File)> {
        let mut files = Vec::new();
        for entry in fs::read_dir(&self.folder)? {
            let entry = entry?;
            if let Some(number) = number(&entry.file_name().to_string_lossy()) {
                files.push((number, entry.path(), entry.metadata()?.len()));
            }
        }
        files.sort();
        let newest = files.last().map_or(0, |(number, ..)| *number);
        let mut sum: u64 = files.iter().map(|(.., bytes)| bytes).sum();
        for (_, path, bytes) in files {
            // There is room for the new one.
            if sum + FILE_MAX as u64 <= FOLDER_MAX {
                break;
            }
            // One that cannot be removed stays.
            if fs::remove_file(path).is_ok() {
                sum -= bytes;
            }
        }
        let path = self
            .folder
            .join(name(newest.saturating_add(1), SystemTime::now()));
        let file = File::create_new(&path)?;
        Ok((path, file))
    }
}

/// `motorlink-log-000012-20261127-193300.mcap`, in UTC.
fn name(number: u32, now: SystemTime) -> String {
    let now = OffsetDateTime::from(now);
    let (year, month, day) = now.to_calendar_date();
    let (hour, minute, second) = now.to_hms();
    let (begin, end) = NAME;
    let month = u8::from(month);
    format!("{begin}{number:06}-{year}{month:02}{day:02}-{hour:02}{minute:02}{second:02}{end}")
}

/// The number in the name of a file of ours.
fn number(name: &str) -> Option<u32> {
    let (begin, end) = NAME;
    let middle = name.strip_prefix(begin)?.strip_suffix(end)?;
    middle.split_once('-')?.0.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_number_is_in_the_name() {
        let at = SystemTime::UNIX_EPOCH + Duration::from_secs(1_795_266_936);
        let name = name(12, at);
        assert_eq!(name, "motorlink-log-000012-20261121-131536.mcap");
        assert_eq!(number(&name), Some(12));
        assert_eq!(number("motorlink-session-20261121-131536.mcap"), None);
        assert_eq!(number("notes.txt"), None);
    }

    #[test]
    fn each_file_begins_with_the_model() {
        let folder = tempfile::tempdir().unwrap();
        let mut log = Log::begin(folder.path(), Instant::ZERO, Model::Ddsm400).unwrap();
        let frame = "01 64 00 64 00 00 00 00 00 4F".parse().unwrap();
        let mode = None;
        let kind = LineEventKind::Sent { frame, mode };
        for hours in 1..=2 {
            let at = Instant::ZERO + FILE_LASTS * hours + Duration::from_secs(u64::from(hours));
            let event = LineEvent { at, kind };
            log.add(at, &Entry::Event(Event::Line(event)));
        }
        log.finish();
        let mut models = 0;
        for file in fs::read_dir(folder.path()).unwrap() {
            let bytes = fs::read(file.unwrap().path()).unwrap();
            let mut source = &bytes[..];
            let session = motorlink_session::open(&mut source).unwrap().unwrap();
            let mut kinds = Vec::new();
            motorlink_session::for_each_record(&mut source, &session, |record| {
                kinds.extend(record.line().map(|line| line.kind));
            })
            .unwrap();
            let model = LineEventKind::ModelSelected(Model::Ddsm400);
            models += kinds.iter().filter(|kind| **kind == model).count();
        }
        assert_eq!(models, 2, "in each file with a frame");
    }

    #[test]
    fn the_oldest_files_make_room() {
        let folder = tempfile::tempdir().unwrap();
        let files = Files {
            folder: folder.path().to_owned(),
        };
        for number in [3_u32, 1, 2] {
            let path = folder.path().join(name(number, SystemTime::now()));
            // Without content: only its length counts.
            File::create(path).unwrap().set_len(900 << 20).unwrap();
        }
        fs::write(folder.path().join("notes.txt"), "kept").unwrap();
        let (path, _) = files.next().unwrap();
        assert_eq!(
            number(&path.file_name().unwrap().to_string_lossy()),
            Some(4)
        );
        let mut left: Vec<_> = fs::read_dir(folder.path())
            .unwrap()
            .filter_map(|entry| number(&entry.unwrap().file_name().to_string_lossy()))
            .collect();
        left.sort_unstable();
        assert_eq!(left, [2, 3, 4]);
        assert!(folder.path().join("notes.txt").exists());
    }
}
