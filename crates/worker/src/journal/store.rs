//! The files of this session, and what is done with them: one thing after the other.

use std::collections::VecDeque;

use motorlink_journal::kept::{Act, Segment, Stream};

use super::{
    disk::{Dir, OpenFile, Result},
    found::{ALIVE, Found, new_name},
};

/// Things that wait to be done: ten minutes of writes. A browser that takes none for so long has failed.
const WAITING_MAX: usize = 2_400;

/// Where the session is kept.
#[derive(Debug)]
pub(super) struct Store {
    sessions: Dir,
    /// The name of this session, which has files with its first write.
    name: String,
    files: Option<Files>,
    /// The session that is restored, until its directory is that of this one.
    restored: Option<Found>,
}

/// Something to be done.
#[derive(Debug)]
pub(super) enum Job {
    /// Of the session that lives.
    Act(Act),
    /// This session is to be adopted.
    Restore(Found),
    /// This session is to be removed.
    Forget(Found),
}

/// What is to be done, in order.
#[derive(Debug, Default)]
pub(super) struct Jobs(VecDeque<Job>);

impl Jobs {
    pub(super) fn push(&mut self, job: Job) {
        self.0.push_back(job);
    }

    pub(super) fn are_too_many(&self) -> bool {
        self.0.len() > WAITING_MAX
    }

    pub(super) fn pop(&mut self) -> Option<Job> {
        self.0.pop_front()
    }
}

/// A directory, and those of its files that are open.
#[derive(Debug)]
struct Files {
    dir: Dir,
    alive: OpenFile,
    /// The file of each stream that is written to.
    open: Vec<(Segment, OpenFile)>,
}

impl Store {
    pub(super) fn new(sessions: Dir, name: String) -> Self {
        Self {
            sessions,
            name,
            files: None,
            restored: None,
        }
    }

    /// Does it.
    pub(super) async fn work(&mut self, job: Job) -> Result<()> {
        match job {
            Job::Act(act) => self.act(act).await,
            Job::Restore(found) => {
                self.restored = Some(found);
                Ok(())
            }
            Job::Forget(Found { name, alive, .. }) => {
                drop(alive);
                self.sessions.remove(&name).await
            }
        }
    }

    /// Lets go of the files of this session, which stay as they are.
    pub(super) fn let_go(&mut self) {
        self.files = None;
    }

    async fn act(&mut self, act: Act) -> Result<()> {
        match act {
            Act::Append(segment, bytes) => self.append(segment, &bytes).await,
            Act::Remove(segment) => match &mut self.files {
                Some(files) => files.remove(segment).await,
                None => Ok(()),
            },
            Act::Flush => {
                let open = self.files.iter().flat_map(|files| &files.open);
                open.map(|(_, file)| file).try_for_each(OpenFile::flush)
            }
            Act::Adopt { packets, recorded } => self.adopt([packets, recorded]).await,
            Act::Erase => self.erase().await,
        }
    }

    async fn append(&mut self, segment: Segment, bytes: &[u8]) -> Result<()> {
        if self.files.is_none() {
            let dir = self.sessions.dir(&self.name).await?;
            self.files = Some(Files::of(dir).await?);
        }
        match &mut self.files {
            Some(files) => files.file(segment).await?.append(bytes),
            None => Ok(()),
        }
    }

    /// Moves the files of this session behind those of the one that was found.
    async fn adopt(&mut self, shift: [u32; 2]) -> Result<()> {
        let Some(found) = self.restored.take() else {
            return Ok(());
        };
        let own = std::mem::replace(&mut self.name, found.name);
        let before = self.files.replace(Files {
            dir: found.dir.clone(),
            alive: found.alive,
            open: Vec::new(),
        });
        let Some(Files { dir, alive, open }) = before else {
            return Ok(());
        };
        drop(open);
        for name in dir.names().await? {
            let Some(mut segment) = Segment::from_name(&name) else {
                continue;
            };
            let [packets, recorded] = shift;
            segment.number += match segment.stream {
                Stream::Packets => packets,
                Stream::Recorded => recorded,
            };
            let bytes = dir.read(&name).await?;
            found.dir.open(&segment.name()).await?.append(&bytes)?;
            // One at a time: a crash in between keeps no more than one file twice.
            dir.remove(&name).await?;
        }
        drop(alive);
        self.sessions.remove(&own).await
    }

    async fn erase(&mut self) -> Result<()> {
        self.files = None;
        self.restored = None;
        for name in self.sessions.names().await? {
            // Those of another living tab are open, and stay.
            let _ = self.sessions.remove(&name).await;
        }
        self.name = new_name(js_sys::Date::now());
        Ok(())
    }
}

impl Files {
    async fn of(dir: Dir) -> Result<Self> {
        let alive = dir.open(ALIVE).await?;
        let open = Vec::new();
        Ok(Self { dir, alive, open })
    }

    /// The file of a segment, open. The one of its stream that was written to before is done.
    async fn file(&mut self, segment: Segment) -> Result<&OpenFile> {
        let is_it = |(other, _): &(Segment, OpenFile)| *other == segment;
        let place = if let Some(place) = self.open.iter().position(is_it) {
            place
        } else {
            let done = |(other, _): &(Segment, OpenFile)| other.stream == segment.stream;
            for (_, file) in self.open.extract_if(.., |one| done(one)) {
                file.flush()?;
            }
            let file = self.dir.open(&segment.name()).await?;
            self.open.push((segment, file));
            self.open.len() - 1
        };
        let open = self.open.get(place).map(|(_, file)| file);
        open.ok_or_else(|| "a file that is open is not there".into())
    }

    async fn remove(&mut self, segment: Segment) -> Result<()> {
        self.open.retain(|(other, _)| *other != segment);
        self.dir.remove(&segment.name()).await
    }
}
