//! The session in the browser's files: begins it, finds an earlier one, handles the page's requests.
//! `motorlink_recorder::saved` decides what is written, and when.

use std::rc::Rc;

use motorlink_messages::recorder::{FromRecorder, NotSaved, ToRecorder};
use motorlink_recorder::saved::StoreAction;
use wasm_bindgen_futures::spawn_local;

use super::{
    disk::{Dir, why},
    found,
    state::{RecorderWorker, Saving, Shared, post},
    store::{Done, Job, Jobs, Store},
};
use crate::local_time::local_time;

impl Saving {
    /// Queues a job.
    pub(super) fn add(&mut self, shared: &Shared, job: Job) {
        self.jobs.push(job);
        let shared = Rc::clone(shared);
        spawn_local(async move { run_jobs(&shared).await });
    }

    /// Reads the next file of the restored session.
    pub(super) fn read_next(&mut self, shared: &Shared) {
        let next = self.to_read.as_mut();
        let next = next.and_then(|(dir, files)| Some((dir.clone(), files.pop_front()?)));
        let shared = Rc::clone(shared);
        spawn_local(async move {
            let file = match next {
                // An unreadable file counts as empty.
                Some((dir, segment)) => {
                    let bytes = dir.read(&segment.name()).await.unwrap_or_default();
                    Some((segment.stream, bytes))
                }
                None => None,
            };
            shared.borrow_mut().recorder.next_file(file);
            let turn = shared.borrow().turn;
            turn(&shared);
        });
    }
}

/// Opens the browser's file system, and searches for a session that has ended.
pub(super) fn begin(shared: &Shared) {
    let shared = Rc::clone(shared);
    spawn_local(async move {
        let Some(sessions) = Dir::of_sessions().await else {
            // No file system: the recorder works in memory only.
            let worker = &mut *shared.borrow_mut();
            worker.recorder.stop_saving();
            worker.saving.jobs = Jobs::default();
            worker.saving.is_in_memory_only = true;
            return;
        };
        let now_ms = js_sys::Date::now();
        let name = found::new_name(now_ms);
        let store = Store::new(sessions.clone(), name.clone());
        shared.borrow_mut().saving.store = Some(store);
        run_jobs(&shared).await;
        let erased = shared.borrow().saving.erased;
        if let Ok(Some(found)) = found::newest(&sessions, &name, now_ms).await {
            let saving = &mut shared.borrow_mut().saving;
            if saving.erased != erased {
                saving.add(&shared, Job::Forget(found));
                return;
            }
            post(&FromRecorder::SavedSessionFound(found.session));
            saving.found = Some(found);
        }
    });
}

/// Handles a message of the page as far as it concerns files; the recorder handles the rest.
pub(super) fn handle(shared: &Shared, message: &ToRecorder) {
    let mut worker = shared.borrow_mut();
    let RecorderWorker {
        recorder, saving, ..
    } = &mut *worker;
    match message {
        ToRecorder::Restore => {
            if let Some(found) = saving.found.take() {
                let files = found.files.iter().map(|(segment, _)| *segment).collect();
                saving.to_read = Some((found.dir.clone(), files));
                // The offset to UTC may have changed since.
                recorder.set_local_time(local_time(found.summary.first_epoch_us() / 1_000));
                recorder.restore(&found.summary, &found.files);
                saving.add(shared, Job::Restore(found));
            }
        }
        ToRecorder::Forget => {
            if let Some(found) = saving.found.take() {
                saving.add(shared, Job::Forget(found));
            }
        }
        ToRecorder::Erase => {
            // Without a database there are no runs.
            let _ = motorlink_kept_runs::erase();
            saving.erased += 1;
            saving.found = None;
            saving.to_read = None;
            if saving.is_in_memory_only {
                post(&FromRecorder::Erased { all: true });
            } else if !recorder.is_saving() {
                saving.add(shared, Job::Action(StoreAction::Erase));
            }
        }
        _ => {}
    }
}

/// Runs the queued jobs.
async fn run_jobs(shared: &Shared) {
    loop {
        let (mut store, job) = {
            let saving = &mut shared.borrow_mut().saving;
            if saving.jobs.are_too_many() {
                saving.jobs = Jobs::default();
                break;
            }
            // Another task runs a job, or there is no store.
            let Some(store) = saving.store.take() else {
                return;
            };
            let Some(job) = saving.jobs.pop() else {
                saving.store = Some(store);
                return;
            };
            (store, job)
        };
        let erases = matches!(job, Job::Action(StoreAction::Erase));
        // Only a failed write loses data: what was not removed or flushed is still there.
        let writes = matches!(
            job,
            Job::Action(StoreAction::Append(..) | StoreAction::Adopt { .. })
        );
        let done = store.run(job).await;
        if erases {
            let all = matches!(done, Ok(Done::All));
            post(&FromRecorder::Erased { all });
        }
        if let Err(error) = &done
            && writes
        {
            store.close_files();
            stop_saving(shared, why(error));
        }
        shared.borrow_mut().saving.store = Some(store);
    }
    stop_saving(shared, NotSaved::Failed);
}

/// From now on the recorder works in memory only. Existing files stay.
fn stop_saving(shared: &Shared, why: NotSaved) {
    let RecorderWorker {
        recorder, saving, ..
    } = &mut *shared.borrow_mut();
    saving.jobs = Jobs::default();
    if recorder.is_saving() {
        recorder.stop_saving();
        post(&FromRecorder::NotSaved(why));
    }
}
