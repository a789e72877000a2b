//! The files of this session, and the jobs on them, one after the other. `motorlink_recorder::saved` decides which.

use std::collections::VecDeque;

use motorlink_recorder::saved::{Segment, StoreAction, Stream};

use super::{
    disk::{Dir, OpenFile, Result},
    found::{ALIVE, Found, new_name},
};

/// Queued jobs: ten minutes of writes. A browser that completes none for so long has failed.
const WAITING_MAX: usize = 2_400;

/// The directory of the session.
#[derive(Debug)]
pub(super) struct Store {
    sessions: Dir,
    /// The name of this session. Its first write creates the directory.
    name: String,
    files: Option<Files>,
    /// The restored session, until this session continues in its directory.
    restored: Option<Found>,
}

/// A job on the files.
#[derive(Debug)]
pub(super) enum Job {
    /// An action of the current session.
    Action(StoreAction),
    /// Continue in the directory of this session.
    Restore(Found),
    /// Remove this session.
    Forget(Found),
}

/// The outcome of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Done {
    /// All of it is done.
    All,
    /// Files that another tab has open are still there.
    Partly,
}

/// The queued jobs, in order.
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

    /// Runs a job.
    pub(super) async fn run(&mut self, job: Job) -> Result<Done> {
        match job {
            Job::Action(StoreAction::Erase) => return self.erase().await,
            Job::Action(action) => self.perform(action).await?,
            Job::Restore(found) => self.restored = Some(found),
            Job::Forget(Found { name, alive, .. }) => {
                drop(alive);
                self.sessions.remove(&name).await?;
            }
        }
        Ok(Done::All)
    }

    /// Closes the files of this session, which stay on disk.
    pub(super) fn close_files(&mut self) {
        self.files = None;
    }

    async fn perform(&mut self, action: StoreAction) -> Result<()> {
        match action {
            StoreAction::Append(segment, bytes) => self.append(segment, &bytes).await,
            StoreAction::Remove(segment) => match &mut self.files {
                Some(files) => files.remove(segment).await,
                None => Ok(()),
            },
            StoreAction::Flush => {
                let open = self.files.iter().flat_map(|files| &files.open);
                open.map(|(_, file)| file).try_for_each(OpenFile::flush)
            }
            StoreAction::Adopt { packets, recorded } => self.adopt([packets, recorded]).await,
            StoreAction::Erase => self.erase().await.map(|_| ()),
        }
    }

    async fn append(&mut self, segment: Segment, bytes: &[u8]) -> Result<()> {
        if self.files.is_none() {
            let dir = self.sessions.dir(&self.name).await?;
            let files = if let Ok(files) = Files::of(dir).await {
                files
            } else {
                // Another tab that searches for ended sessions has it open: take another name.
                self.name = new_name(js_sys::Date::now());
                Files::of(self.sessions.dir(&self.name).await?).await?
            };
            self.files = Some(files);
        }
        match &mut self.files {
            Some(files) => files.file(segment).await?.append(bytes),
            None => Ok(()),
        }
    }

    /// Moves the files of this session behind those of the restored one.
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
            // One at a time: a crash in between leaves at most one file twice.
            dir.remove(&name).await?;
        }
        drop(alive);
        self.sessions.remove(&own).await
    }

    async fn erase(&mut self) -> Result<Done> {
        self.files = None;
        self.restored = None;
        let mut done = Done::All;
        for name in self.sessions.names().await? {
            // The files of another open tab cannot be removed.
            if self.sessions.remove(&name).await.is_err() {
                done = Done::Partly;
            }
        }
        self.name = new_name(js_sys::Date::now());
        Ok(done)
    }
}

impl Files {
    async fn of(dir: Dir) -> Result<Self> {
        let alive = dir.open(ALIVE).await?;
        let open = Vec::new();
        Ok(Self { dir, alive, open })
    }

    /// Opens the file of a segment, and closes the earlier file of the same stream.
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
        open.ok_or_else(|| "an open file is missing".into())
    }

    async fn remove(&mut self, segment: Segment) -> Result<()> {
        self.open.retain(|(other, _)| *other != segment);
        self.dir.remove(&segment.name()).await
    }
}

#[cfg(test)]
mod tests {
    use motorlink_bus::{JunkBytes, LineEvent, LineEventKind};
    use motorlink_protocol::Instant;
    use motorlink_recorder::saved::SessionWriter;
    use wasm_bindgen_test::wasm_bindgen_test;

    use super::*;
    use crate::recorder::found::newest;

    const NOW_MS: f64 = 1_795_266_900_000.0;

    fn traffic(n: u64) -> LineEvent {
        LineEvent {
            at: Instant::from_millis(n),
            kind: LineEventKind::Junk(JunkBytes::new(&[1, 2, 3])),
        }
    }

    /// The actions that write these entries.
    fn actions_for(entries: std::ops::Range<u64>) -> Vec<StoreAction> {
        let mut writer = SessionWriter::default();
        writer.set_epoch(1_795_266_900_000_000);
        for n in entries {
            writer.add_event(&traffic(n), n % 2 == 0);
        }
        let mut now = Instant::ZERO;
        let mut actions = Vec::new();
        for _ in 0..40 {
            actions.extend(writer.poll(now));
            now = now + std::time::Duration::from_millis(200);
        }
        actions
    }

    async fn sessions(name: &str) -> Dir {
        let sessions = Dir::of_sessions().await.unwrap().dir(name).await.unwrap();
        for name in sessions.names().await.unwrap() {
            sessions.remove(&name).await.unwrap();
        }
        sessions
    }

    async fn store(sessions: &Dir, begun_ms: f64, entries: std::ops::Range<u64>) -> Store {
        let mut store = Store::new(sessions.clone(), new_name(begun_ms));
        for action in actions_for(entries) {
            store.run(Job::Action(action)).await.unwrap();
        }
        store
    }

    #[wasm_bindgen_test]
    async fn a_session_is_found_when_it_has_ended_and_not_before() {
        let sessions = sessions("test-found").await;
        let older = store(&sessions, NOW_MS - 9_000.0, 0..5).await;
        let living = store(&sessions, NOW_MS - 1_000.0, 0..100).await;
        assert!(newest(&sessions, "", NOW_MS).await.unwrap().is_none());
        drop(older);
        let found = newest(&sessions, "", NOW_MS).await.unwrap().unwrap();
        assert_eq!(found.session.packets, 5);
        assert!(
            newest(&sessions, "", NOW_MS).await.unwrap().is_none(),
            "it is held"
        );
        drop(living);
        let found = newest(&sessions, "", NOW_MS).await.unwrap().unwrap();
        assert_eq!((found.session.packets, found.session.recorded), (100, 50));
    }

    #[wasm_bindgen_test]
    async fn a_session_that_is_restored_and_this_one_are_one_session() {
        let sessions = sessions("test-adopted").await;
        drop(store(&sessions, NOW_MS - 9_000.0, 0..20).await);
        let mut living = store(&sessions, NOW_MS, 0..7).await;
        let own = living.name.clone();
        let found = newest(&sessions, &own, NOW_MS).await.unwrap().unwrap();
        living.run(Job::Restore(found)).await.unwrap();
        let adopt = StoreAction::Adopt {
            packets: 1,
            recorded: 1,
        };
        living.run(Job::Action(adopt)).await.unwrap();
        assert_eq!(sessions.names().await.unwrap(), [living.name.clone()]);
        drop(living);
        let mut found = newest(&sessions, "", NOW_MS).await.unwrap().unwrap();
        assert_eq!((found.session.packets, found.session.recorded), (27, 14));
        let names: Vec<String> = found.files.drain(..).map(|(file, _)| file.name()).collect();
        assert_eq!(names, ["p1", "p2", "r1", "r2"]);
    }

    #[wasm_bindgen_test]
    async fn erased_sessions_are_gone_and_a_forgotten_one_alone() {
        let sessions = sessions("test-erased").await;
        drop(store(&sessions, NOW_MS - 9_000.0, 0..20).await);
        drop(store(&sessions, NOW_MS - 8_000.0, 0..30).await);
        let mut living = store(&sessions, NOW_MS, 0..7).await;
        let found = newest(&sessions, &living.name, NOW_MS).await.unwrap();
        living.run(Job::Forget(found.unwrap())).await.unwrap();
        assert_eq!(sessions.names().await.unwrap().len(), 2);
        let other_tab = store(&sessions, NOW_MS - 7_000.0, 0..3).await;
        let erased = living.run(Job::Action(StoreAction::Erase)).await;
        assert_eq!(erased.unwrap(), Done::Partly, "what is open stays");
        assert_eq!(sessions.names().await.unwrap().len(), 1);
        drop(other_tab);
        let erased = living.run(Job::Action(StoreAction::Erase)).await;
        assert_eq!(erased.unwrap(), Done::All);
        assert!(sessions.names().await.unwrap().is_empty());
    }

    #[wasm_bindgen_test]
    async fn sessions_that_are_too_many_go_the_oldest_first() {
        let sessions = sessions("test-bounded").await;
        for minute in 0..23 {
            drop(store(&sessions, NOW_MS + f64::from(minute) * 60_000.0, 0..3).await);
        }
        newest(&sessions, "", NOW_MS).await.unwrap().unwrap();
        let mut names = sessions.names().await.unwrap();
        names.sort_unstable();
        assert_eq!(names.len(), 20);
        let begun = |minute: u32| new_name(NOW_MS + f64::from(minute) * 60_000.0);
        assert_eq!(names[0][..15], begun(3)[..15]);
    }
}
