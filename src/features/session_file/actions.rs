//! What the buttons of the panel do, and the messages of the session worker.

use std::rc::Rc;

use js_sys::Reflect;
use leptos::{prelude::*, task::spawn_local};
use motorlink_i18n::tr;
use motorlink_messages::{
    experiments::vehicle::Geometry,
    sessions::{
        FromSessions, NotSaved, Progress, SaveRange, SessionExport, SessionInfo, ToSessions,
    },
};
use wasm_bindgen::JsValue;
use web_sys::{Blob, MessageChannel};

use crate::{
    features::session_file::{
        bookmarks::{Bookmarks, Closing},
        incoming::Incoming,
        player::{Instruments, Link, Player},
        readiness::not_kept,
        replay_bar::show_bar,
        save_picker::{Picked, name_of, pick, remove_if_empty},
        texts,
    },
    link::sessions_link::SessionsLink,
    model::{
        page::Page,
        replay,
        vehicle::{geometry_of_page, vehicle_of},
    },
    ui::{
        clock::{local_date, local_time, page_now_ms, page_origin_ms},
        download::save_blob,
        listener::on_window,
        reactive::effect,
    },
};

/// What the panel says: a text, and whether it is an error.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Said {
    pub(super) error: bool,
    pub(super) text: String,
}

/// Session files.
#[derive(Clone, Copy)]
pub(crate) struct SessionFiles {
    pub(super) page: Page,
    link: Link,
    /// Replays the open file.
    pub(super) player: Player,
    /// The progress of saving, in per mille.
    pub(super) saving: RwSignal<Option<u64>>,
    /// The progress of opening or exporting, in per mille.
    pub(super) reading: RwSignal<Option<u64>>,
    /// Whether the worker was told to save. Before that, cancelling does not concern it.
    is_posted: RwSignal<bool>,
    /// The content of the open file.
    pub(super) open: RwSignal<Option<Rc<SessionInfo>>, LocalStorage>,
    /// The name of the file whose bookmarks stay although its worker has ended; else empty.
    lost: StoredValue<String>,
    /// The measures of a rover, for its motion in the file.
    geometry: RwSignal<Geometry>,
    /// How much is saved.
    pub(super) save_range: RwSignal<SaveRange>,
    /// What the panel says about saving.
    pub(super) saved: RwSignal<Said>,
    /// What the panel says about the open file.
    pub(super) said: RwSignal<Said>,
    /// The name of the file that is being saved, or was saved last.
    pub(super) saved_as: StoredValue<String>,
    /// The handle of the file that is being saved, if the user has chosen one.
    chosen: RwSignal<Option<JsValue>, LocalStorage>,
}

impl SessionFiles {
    /// Of this page: made at the first call, for the owner of the page.
    pub(crate) fn of_page(
        owner: &Owner,
        page: Page,
        instruments: impl FnOnce() -> Instruments,
    ) -> Self {
        owner.with(|| {
            use_context().unwrap_or_else(|| {
                let link = StoredValue::new_local(None);
                let player = Player::new(page, link, instruments());
                // A page that is gone keeps no message of another.
                on_cleanup(replay::clear_gate);
                show_bar(owner, player);
                let new = Self {
                    page,
                    link,
                    player,
                    saving: RwSignal::new(None),
                    is_posted: RwSignal::new(false),
                    reading: RwSignal::new(None),
                    open: RwSignal::new_local(None),
                    lost: StoredValue::default(),
                    geometry: geometry_of_page(owner, page),
                    save_range: RwSignal::default(),
                    saved: RwSignal::default(),
                    said: RwSignal::default(),
                    saved_as: StoredValue::default(),
                    chosen: RwSignal::new_local(None),
                };
                provide_context(new);
                // The browser asks before it closes or reloads the page.
                on_window("beforeunload", move |event| {
                    if player.bookmarks.with_untracked(Bookmarks::are_changed) {
                        event.prevent_default();
                    }
                });
                new
            })
        })
    }

    /// Takes the files that are dropped onto the page, and cancels saving when the recorder fails.
    pub(super) fn follow(self, incoming: Incoming) {
        effect(move || {
            if let Some(file) = incoming.file.get() {
                incoming.file.set(None);
                self.open_file(&file);
            }
        });
        let alive = self.page.recorder().alive;
        effect(move || {
            if !alive.get() && self.saving.get_untracked().is_some() {
                self.post(&ToSessions::CancelSave, &[], &[]);
            }
        });
    }

    pub(super) fn say(self, error: bool, text: impl Into<String>) {
        let text = text.into();
        self.said.set(Said { error, text });
    }

    fn say_of_saving(self, error: bool, text: impl Into<String>) {
        let text = text.into();
        self.saved.set(Said { error, text });
    }

    /// Starts the worker, unless it runs. Returns whether it runs.
    fn start_worker(self) -> bool {
        if self.link.with_value(Option::is_some) {
            return true;
        }
        let started = SessionsLink::spawn(
            move |message, file| self.on_message(message, file.as_ref()),
            move || self.worker_lost(),
        );
        let link = started.ok();
        let runs = link.is_some();
        self.link.set_value(link);
        if !runs {
            self.say(true, tr!("Session files do not work in this browser."));
        }
        runs
    }

    fn post(self, message: &ToSessions, file: &[JsValue], channel: &[JsValue]) {
        self.link.with_value(|link| {
            if let Some(link) = link {
                link.post(message, file, channel);
            }
        });
    }

    /// Ends the worker. The next action starts another.
    fn worker_lost(self) {
        // The link is in use while it calls this.
        spawn_local(async move {
            let link = self.link.try_update_value(Option::take).flatten();
            if let Some(link) = link {
                self.player.end();
                link.end();
                self.saving.set(None);
                self.discard_chosen();
                self.saved.set(Said::default());
                self.reading.set(None);
                let open = self.open.try_update(Option::take).flatten();
                let mut said =
                    tr!("Reading and writing of session files has stopped. Try again.").to_owned();
                let bookmarks = self.player.bookmarks;
                if bookmarks.with_untracked(Bookmarks::are_changed) {
                    if let Some(open) = open {
                        self.lost.set_value(open.name.clone());
                    }
                    said += " ";
                    said += tr!("Open the file again to keep its bookmarks.");
                } else {
                    bookmarks.set(Bookmarks::default());
                }
                self.say(true, said);
            }
        });
    }

    /// Saves what the recorder keeps, or cancels that.
    pub(super) fn save_or_cancel(self) {
        if self.saving.get_untracked().is_some() {
            if self.is_posted.get_untracked() {
                return self.post(&ToSessions::CancelSave, &[], &[]);
            }
            return self.not_saved(NotSaved::Cancelled);
        }
        if !self.start_worker() {
            return;
        }
        self.saving.set(Some(0));
        self.is_posted.set(false);
        self.say_of_saving(false, "");
        let name = file_name();
        spawn_local(async move {
            let why_not = not_kept(self.page.recorder()).await;
            if self.saving.get_untracked().is_none() {
                return;
            }
            if let Some(why) = why_not {
                return self.not_saved(why);
            }
            // The dialog takes the keys, and on some systems covers the page: nobody could press STOP.
            let picked = if self.page.is_anything_driven() {
                Picked::NoDialog
            } else {
                pick(&name, tr!("Session")).await
            };
            let handle = match picked {
                Picked::File(handle) => Some(handle),
                Picked::NoDialog => None,
                Picked::Cancelled => return self.not_saved(NotSaved::Cancelled),
            };
            let name = handle.as_ref().and_then(name_of).unwrap_or(name);
            self.saved_as.set_value(name);
            self.chosen.set(handle.clone());
            if self.saving.get_untracked().is_none() {
                return self.discard_chosen();
            }
            self.is_posted.set(true);
            // It can fail while the dialog is open. Then it answers no request.
            let is_alive = self.page.recorder().alive.get_untracked();
            if !is_alive || !self.save_to(handle.as_slice()) {
                self.not_saved(NotSaved::NoRecorder);
            }
        });
    }

    /// Connects the worker to the recorder, and lets it save, to the file of this handle if there is one. Returns whether
    /// that was possible.
    fn save_to(self, handle: &[JsValue]) -> bool {
        let Ok(channel) = MessageChannel::new() else {
            return false;
        };
        let connected = self.page.recorder().link.with_value(|recorder| {
            let recorder = recorder.as_ref();
            recorder.map(|recorder| recorder.hand_over(&channel.port1()))
        });
        let vehicle = self.page.motors.names.with_untracked(vehicle_of);
        let message = ToSessions::Save {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            setup: self.page.setup().to_json(),
            rover: vehicle.map_or_else(String::new, |vehicle| {
                vehicle.to_json(self.geometry.get_untracked())
            }),
            range: self.save_range.get_untracked(),
        };
        self.post(&message, handle, &[channel.port2().into()]);
        connected.is_some()
    }

    fn not_saved(self, why: NotSaved) {
        self.saving.set(None);
        self.discard_chosen();
        let is_alive = self.page.recorder().alive.get_untracked();
        let why = if is_alive { why } else { NotSaved::NoRecorder };
        self.say_of_saving(why != NotSaved::Cancelled, texts::of_not_saved(why));
    }

    /// Removes the chosen file, which the dialog has emptied.
    fn discard_chosen(self) {
        if let Some(handle) = self.chosen.try_update(Option::take).flatten() {
            spawn_local(async move {
                // A file that cannot be removed stays, empty.
                let _ = remove_if_empty(&handle).await;
            });
        }
    }

    /// Whether the open file may close. Warns if its bookmarks would be lost.
    fn may_close(self, at: Closing) -> bool {
        let bookmarks = self.player.bookmarks;
        let may_close = bookmarks.try_update(|bookmarks| bookmarks.may_close(at));
        let may_close = may_close.unwrap_or(true);
        if !may_close {
            self.say(
                true,
                tr!(
                    "The bookmarks are not saved. Press Save copy, or repeat this to discard them."
                ),
            );
        }
        may_close
    }

    /// Writes a copy of the open file with the bookmarks.
    pub(super) fn save_copy(self) {
        let bookmarks = self.player.bookmarks.try_update(Bookmarks::post);
        self.reading.set(Some(0));
        self.say(false, "");
        self.post(
            &ToSessions::SaveCopy(bookmarks.unwrap_or_default()),
            &[],
            &[],
        );
    }

    /// Opens a file. The one before stays open until the worker has found that this is a session.
    pub(super) fn open_file(self, file: &JsValue) {
        let name = Reflect::get(file, &"name".into()).ok();
        let name = name.and_then(|name| name.as_string()).unwrap_or_default();
        if !self.is_lost(&name) && !self.may_close(Closing::AnotherFile) {
            return;
        }
        if !self.start_worker() {
            return;
        }
        self.reading.set(Some(0));
        self.say(false, tr!("Opening {name}", name = name.clone()));
        let message = ToSessions::Open { name };
        self.post(&message, std::slice::from_ref(file), &[]);
    }

    /// Whether the bookmarks are those of this file, whose worker has ended.
    fn is_lost(self, name: &str) -> bool {
        self.lost
            .with_value(|lost| !lost.is_empty() && lost == name)
    }

    /// Closes the open file. Its worker ends, which frees its memory, unless a session is being saved.
    pub(super) fn close(self) {
        if !self.may_close(Closing::CloseFile) {
            return;
        }
        self.player.end();
        self.player.bookmarks.set(Bookmarks::default());
        self.open.set(None);
        self.say(false, "");
        if self.saving.get_untracked().is_some() {
            return self.cancel_reading();
        }
        self.reading.set(None);
        let link = self.link.try_update_value(Option::take).flatten();
        if let Some(link) = link {
            link.end();
        }
    }

    /// Writes the open session as another file.
    pub(super) fn export(self, what: SessionExport) {
        self.reading.set(Some(0));
        self.say(false, "");
        self.post(&ToSessions::Export(what), &[], &[]);
    }

    /// Adds the runs of experiments in the open file to those of the browser.
    pub(super) fn keep_runs(self) {
        self.reading.set(Some(0));
        self.say(false, "");
        self.post(&ToSessions::KeepRuns, &[], &[]);
    }

    /// Cancels opening or exporting.
    pub(super) fn cancel_reading(self) {
        if self.reading.get_untracked().is_some() {
            self.post(&ToSessions::CancelReading, &[], &[]);
        }
    }

    fn on_message(self, message: FromSessions, file: Option<&Blob>) {
        match message {
            FromSessions::Saving(progress) => show(self.saving, progress),
            FromSessions::Saved {
                bytes,
                records,
                runs,
            } => {
                self.saving.set(None);
                self.chosen.set(None);
                let name = self.saved_as.get_value();
                if let Some(file) = file {
                    save_blob(file, &name);
                }
                let mut said = texts::of_saved(&name, bytes, records);
                for words in texts::of_runs_saved(runs) {
                    said = [&said, words.as_str()].join(". ");
                }
                self.say_of_saving(runs.is_incomplete, said);
            }
            FromSessions::NotSaved(why) => self.not_saved(why),
            FromSessions::Reading(progress) => show(self.reading, progress),
            FromSessions::Opened(info) => {
                self.reading.set(None);
                self.say(false, tr!("Opened {name}", name = info.name.clone()));
                self.player.end();
                let is_lost = self.is_lost(&info.name);
                self.lost.set_value(String::new());
                self.player.bookmarks.update(|bookmarks| {
                    if is_lost {
                        bookmarks.reopened(&info);
                    } else {
                        *bookmarks = Bookmarks::of(&info);
                    }
                });
                self.open.set(Some(Rc::new(*info)));
                // Unless a port is open.
                self.player.begin(true);
            }
            FromSessions::RunsKept(kept) => {
                self.reading.set(None);
                let (error, words) = texts::of_runs_kept(kept);
                self.say(error, words);
            }
            FromSessions::NotOpened(why) => {
                self.reading.set(None);
                self.say(true, texts::of_not_opened(why));
            }
            FromSessions::NoRoom => {
                self.reading.set(None);
                self.say(true, texts::no_room());
            }
            FromSessions::Exported { what, problems } => {
                self.reading.set(None);
                let name = self.open.with_untracked(|open| {
                    open.as_ref()
                        .map(|info| texts::export_name(what, &info.name))
                });
                let (Some(name), Some(file)) = (name, file) else {
                    return;
                };
                save_blob(file, &name);
                if what == SessionExport::Copy {
                    self.player.bookmarks.update(Bookmarks::copied);
                }
                let lines = problems
                    .iter()
                    .map(|(one, times)| texts::of_problem(*one, *times));
                let mut said = vec![tr!("Exported {name}", name)];
                said.extend(lines);
                self.say(!problems.is_empty(), said.join(" "));
            }
            FromSessions::Cancelled => {
                self.reading.set(None);
                self.say(false, tr!("Cancelled"));
            }
            FromSessions::Replay(message) => {
                if let Some(info) = self.open.get_untracked() {
                    self.player.on_message(&info, message);
                }
            }
            FromSessions::Died => self.worker_lost(),
        }
    }
}

/// Shows progress, unless it was cancelled meanwhile.
fn show(of: RwSignal<Option<u64>>, progress: Progress) {
    if of.get_untracked().is_some() {
        of.set(Some(progress.per_mille()));
    }
}

/// `motorlink-session-20261123-235959.mcap`, in local time as the names of other exports.
fn file_name() -> String {
    let now_ms = page_origin_ms() + page_now_ms();
    let digits = |text: String| text.replace(['-', ':'], "");
    let (date, time) = (digits(local_date(now_ms)), digits(local_time(now_ms)));
    ["motorlink-session-", &date, "-", &time, ".mcap"].concat()
}
