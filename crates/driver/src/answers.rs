//! Which motors answered last on an adapter, for a person who looks for them. Nothing is decided by it.

use std::{
    collections::BTreeMap,
    fs, io,
    path::{Path, PathBuf},
    time::{Duration, SystemTime, UNIX_EPOCH},
};

use motorlink_bus::{Bus, Event, IdChangeOutcome, IdQueryOutcome};
use motorlink_protocol::{Instant, MotorId, family::Model};

use crate::{
    clock::zero_unix_us,
    entry::Entry,
    locked_file::{default_folder, path_of},
    ports::{ChosenPort, FoundPort},
};

/// What the motors of an open line have answered.
#[derive(Debug, Default)]
pub struct Answers(BTreeMap<MotorId, (Instant, Option<Model>)>);

impl Answers {
    /// Notes the replies that an entry tells of.
    pub(crate) fn hear(&mut self, now: Instant, entry: &Entry, bus: Option<&Bus>) {
        let Entry::Event(event) = entry else { return };
        let known = bus.filter(|bus| bus.model_known()).map(Bus::model);
        let mut add = |id, at| self.0.insert(id, (at, known));
        match event {
            Event::Telemetry(sample) => _ = add(sample.reply.id, sample.at),
            Event::IdQueryEnded(IdQueryOutcome::One(id)) => _ = add(*id, now),
            Event::ScanEnded(report) => {
                for id in &report.found {
                    add(*id, now);
                }
            }
            Event::IdChangeEnded {
                from,
                to,
                outcome: IdChangeOutcome::Changed,
            } => {
                add(to.id(), now);
                self.0.remove(from);
            }
            _ => {}
        }
    }

    /// Writes them beside the file of what is driven, each as `id model seconds` on a line of its own. Without a reply, the
    /// file stays as it is.
    pub(crate) fn keep(&self, now: Instant, folder: &Path, adapter: &str) -> io::Result<()> {
        if self.0.is_empty() {
            return Ok(());
        }
        let zero_us = u64::try_from(zero_unix_us(now)).unwrap_or_default();
        let line = |(id, (at, model)): (&MotorId, &(Instant, Option<Model>))| {
            let model = model.map_or("-", |model| model.spec().key);
            let unix_s = (zero_us + at.as_micros()) / 1_000_000;
            format!("{} {model} {unix_s}\n", id.get())
        };
        let path = file_of(folder, adapter);
        // A disk that is full in the middle of it leaves the file of before.
        let new = path.with_extension("new");
        fs::write(&new, self.0.iter().map(line).collect::<String>())?;
        fs::rename(new, path)
    }
}

fn file_of(folder: &Path, adapter: &str) -> PathBuf {
    // No name of an adapter has a point.
    path_of(folder, adapter).with_extension("answered")
}

/// A motor that has answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Answered {
    /// The motor.
    pub id: MotorId,
    /// Its model; `None` if its replies left it open.
    pub model: Option<Model>,
    /// How long ago its last reply came, in whole seconds; `None` if that is later than now by the clock of this computer.
    pub ago: Option<Duration>,
}

impl Answered {
    fn of_line(line: &str, now: Duration) -> Option<Self> {
        let mut words = line.split(' ');
        let id = words.next()?.parse().ok()?;
        let model = words.next()?.parse().ok();
        let at = Duration::from_secs(words.next()?.parse().ok()?);
        let ago = now.checked_sub(at);
        Some(Self { id, model, ago })
    }
}

impl FoundPort {
    /// The motors that answered when a driver had this adapter last, and any did; empty if that is not known. The port
    /// is not opened.
    #[must_use]
    pub fn answered_last(&self) -> Vec<Answered> {
        let port = ChosenPort {
            path: self.path.clone(),
            usb: self.usb.clone(),
        };
        default_folder().map_or_else(Vec::new, |folder| read(&folder, &port.identity()))
    }
}

fn read(folder: &Path, adapter: &str) -> Vec<Answered> {
    let text = fs::read_to_string(file_of(folder, adapter)).unwrap_or_default();
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    let now = Duration::from_secs(now.unwrap_or_default().as_secs());
    let of_line = |line| Answered::of_line(line, now);
    text.lines().filter_map(of_line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const ADAPTER: &str = "usb 0403 6001 A50285BI";

    fn found(now: Instant, ids: &[u8]) -> Answers {
        let mut answers = Answers::default();
        for id in ids {
            let id = MotorId::new(*id).unwrap();
            let outcome = IdQueryOutcome::One(id);
            answers.hear(now, &Entry::Event(Event::IdQueryEnded(outcome)), None);
        }
        answers
    }

    fn ids(folder: &Path) -> Vec<u8> {
        let answered = read(folder, ADAPTER).into_iter();
        answered.map(|motor| motor.id.get()).collect()
    }

    #[test]
    fn the_answers_of_the_last_driver_replace_those_before_if_there_are_any() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        assert!(ids(folder).is_empty());
        let now = Instant::ZERO + Duration::from_secs(9);
        found(now, &[1, 7]).keep(now, folder, ADAPTER).unwrap();
        assert_eq!(ids(folder), [1, 7]);
        found(now, &[3]).keep(now, folder, ADAPTER).unwrap();
        found(now, &[]).keep(now, folder, ADAPTER).unwrap();
        assert_eq!(ids(folder), [3]);
        let first = read(folder, ADAPTER).remove(0);
        assert_eq!(first.model, None, "no bus has known it");
        assert!(first.ago.unwrap() <= Duration::from_secs(3), "{first:?}");
    }

    #[test]
    fn what_is_damaged_or_to_come_is_left_out() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let text = "1 ddsm210 4000000000\nnoise\n2 ddsm115\n0 ddsm115 5\n\n4 ddsm400 5";
        fs::write(file_of(folder, ADAPTER), text).unwrap();
        assert_eq!(ids(folder), [1, 4]);
        let first = read(folder, ADAPTER).remove(0);
        assert_eq!((first.model, first.ago), (Some(Model::Ddsm210), None));
    }
}
