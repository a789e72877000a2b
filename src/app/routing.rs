//! The messages of the worker, passed on to the features.

use leptos::prelude::{Update as _, *};
use motorlink_i18n::untranslated;
use motorlink_messages::{
    Adapter, Connection, Notice, ToPage, ToWorker, Update,
    bus::IdQueryOutcome,
    protocol::{Instant, Mode},
};

use crate::{
    app::features::Features,
    features::raw::actions::belongs_to_raw_editor,
    link::{
        clock::Clock,
        worker_link::{SILENT_LOOKS_MAX, SILENT_LOOKS_MAX_TURNING, WorkerLink, WorkerState},
    },
    model::{
        connect_texts, log_lines,
        notice_board::{NoticeBoard, Topic},
        notice_lifetime::{self, review},
        notice_texts,
        page::Change,
        place::Place,
        replay::{self, Crossing},
        runs,
        scan_texts::belongs_to_id_manager,
        snapshot::{Reading, Session},
    },
    ui::{clock::page_origin_ms, frame_rate::set_frame_rate},
};

impl Features {
    pub(crate) fn on_message(self, message: ToPage) {
        match message {
            ToPage::Hello { time_origin_ms } => {
                self.page
                    .worker
                    .clock
                    .set_value(Clock::new(page_origin_ms(), time_origin_ms));
                self.page.set_epoch(time_origin_ms);
                self.page.worker.state.set(WorkerState::Running);
                self.page
                    .post(&ToWorker::Select(self.page.selected.get_untracked()));
                self.page.send_settings();
            }
            ToPage::Died => self.worker_lost(),
            // The link answers it.
            ToPage::Ping => {}
            ToPage::Update(update) => {
                if !replay::keeps(Crossing::FromWorker(&update)) {
                    self.update(&update);
                }
            }
            ToPage::Run(message) => runs::receive(&message),
        }
    }

    /// Shows a state of the line, or of the recording that is shown in its place.
    pub(crate) fn update(self, update: &Update) {
        let before = self.page.latest.with_value(|session| session.connection);
        if let Some(line) = untranslated(|| log_lines::of_connection(before, update.connection)) {
            self.page.log(update.now, line);
        }
        let begun = self.page.latest.with_value(|session| {
            let names = self.page.motors.names;
            names.with_untracked(|names| {
                untranslated(|| log_lines::of_beginnings(session, update, names))
            })
        });
        self.page
            .latest
            .update_value(|session| session.apply(update));
        let is_recording = self.page.latest.with_value(Session::is_recording);
        if !is_recording {
            // A recording settles nothing that is said of live motors.
            self.page
                .notices
                .maybe_update(|board| board.review(|until| review(until, update)));
            self.page.governor.update_value(|governor| {
                set_frame_rate(governor.look(
                    update.now,
                    update.line.as_ref(),
                    document().hidden(),
                ));
            });
        }
        // Before a lost connection clears them.
        self.readings.keep_samples(update);
        self.readings.feed_twin(update);
        if !update.connection.is_same_line(before) {
            self.connection_changed(before, update.connection);
        } else if update.connection != before {
            // It was asked of the operator that this page is no more, or not again.
            self.page.withdraw_question();
        }
        let is_silence = |notice: &Notice| matches!(notice, Notice::MotorSilent { .. });
        let last_silence = update.notices.iter().rposition(is_silence);
        for (place, notice) in update.notices.iter().enumerate() {
            // One sentence names all motors that are silent.
            if !is_silence(notice) || last_silence == Some(place) {
                self.notice(update.now, notice);
            }
        }
        // A start in another loop begins when the stop has ended.
        for line in begun {
            self.page.log(update.now, line);
        }
        if !is_recording {
            self.page.announce(Change::Updated);
        }
        self.groups.check_group();
        self.page
            .history
            .update_value(|history| history.take(update));
        self.page.follow_model();
        self.follow_loop();
        // Readings are shown every tenth of a second, changes of state at once.
        let changed = self.page.latest.with_value(|latest| {
            self.page
                .shown
                .with_untracked(|shown| latest.differs_in_state(shown))
        });
        if changed {
            self.page.show();
        }
    }

    fn connection_changed(self, before: Connection, after: Connection) {
        self.page.withdraw_question();
        self.page
            .change_line(before.virtual_line(), after.virtual_line());
        match after {
            Connection::Connected(Adapter::Recording) => {
                self.page.loops.tab_to_follow.set_value(true);
            }
            Connection::Connected(adapter) => {
                self.page.notices.update(|board| {
                    board.withdraw_all(|topic| {
                        matches!(
                            topic,
                            Topic::Port | Topic::Answer | Topic::Command | Topic::Setpoint(_)
                        )
                    });
                });
                self.page.loops.tab_to_follow.set_value(true);
                if let Adapter::Serial(Some(usb)) = adapter {
                    self.page
                        .prefer(|preferences| preferences.adapter = Some(usb));
                }
            }
            Connection::Failed(error) => {
                self.page.notify(&|| connect_texts::of_connect_error(error));
            }
            Connection::Disconnected | Connection::Connecting | Connection::Reconnecting(_) => {}
        }
        if matches!(before, Connection::Connected(_)) {
            self.readings.forget();
            self.page.announce(Change::Disconnected);
            self.raw.forget();
            self.page.notices.update(NoticeBoard::close_line);
        }
    }

    fn notice(self, at: Instant, notice: &Notice) {
        let selected = self.page.selected.get_untracked();
        if let Some(topic) = notice_texts::settled_by(notice) {
            self.page.notices.update(|board| board.withdraw(topic));
        }
        match notice {
            Notice::IdQueryEnded(IdQueryOutcome::One(id)) if *id != selected => {
                let answered = |session: &Session| session.mode(selected).is_some();
                if !self.page.latest.with_value(answered) {
                    self.page.select(*id);
                }
            }
            Notice::ModeSwitched { id, mode } if *id == selected => self.page.follow(*mode),
            // It may be back before the page learned of the loss.
            Notice::AdapterLost { .. } => self.page.withdraw_question(),
            _ => {}
        }
        // A scan in a recording proves nothing about the line.
        if !self.page.latest.with_value(Session::is_recording) {
            self.page.announce(Change::Notice(notice));
            self.raw.notice(notice);
            self.groups.notice(notice);
        }
        // The open place already shows it.
        let said_there = match self.page.open.get_untracked().place {
            Place::Setup => belongs_to_id_manager(notice),
            Place::Diagnose => belongs_to_raw_editor(notice),
            Place::Drive | Place::Record | Place::Test => false,
        };
        let words = self.page.latest.with_value(|session| {
            let words = || notice_texts::of_notice_in(notice, session);
            let line = untranslated(|| words().map(|words| log_lines::of_notice(&words)));
            Some((words()?, line?, notice_lifetime::until(notice, session)))
        });
        if let Some((words, line, until)) = words {
            self.page.log(at, line);
            if !said_there {
                self.page.show_notice(words, until);
            }
        } else if let Some(line) = untranslated(|| log_lines::of_quiet_notice(notice)) {
            self.page.log(at, line);
        }
    }

    /// Opens the tab of the motor's loop: once after connecting, and always in a recording.
    fn follow_loop(self) {
        let is_recording = self.page.latest.with_value(Session::is_recording);
        if !is_recording && !self.page.loops.tab_to_follow.get_value() {
            return;
        }
        let id = self.page.selected.get_untracked();
        let mode: Option<Reading<Mode>> = self.page.latest.with_value(|session| session.mode(id));
        if let Some(mode) = mode.filter(Reading::is_fresh) {
            if self.page.loops.tab.get_untracked() != mode.value {
                self.page.follow(mode.value);
            }
            self.page.loops.tab_to_follow.set_value(false);
        }
    }

    /// Checks whether the worker still runs. Called three times a second.
    pub(crate) fn check_worker(self) {
        let runs = self.page.worker.state.get_untracked() == WorkerState::Running;
        let looks_max = self.page.latest.with_value(|session| {
            let Connection::Connected(adapter) = session.connection else {
                return None;
            };
            let may_turn = session.motors.iter().any(|motor| motor.may_turn);
            // Virtual motors end with their worker.
            let is_urgent = may_turn && matches!(adapter, Adapter::Serial(_));
            let looks_max = if is_urgent {
                SILENT_LOOKS_MAX_TURNING
            } else {
                SILENT_LOOKS_MAX
            };
            (runs && !session.is_recording()).then_some(looks_max)
        });
        let died =
            |link: &Option<WorkerLink>| link.as_ref().is_some_and(|link| link.has_died(looks_max));
        if self.page.worker.link.with_value(died) {
            self.worker_lost();
        }
    }

    /// Handles a failed worker: it sends no more messages and no more frames.
    pub(crate) fn worker_lost(self) {
        replay::keeps(Crossing::WorkerLost);
        // First of all: a worker that reports an error may still run and drive, but the notice says that it does not.
        self.page.worker.link.with_value(|link| {
            if let Some(link) = link {
                link.end();
            }
        });
        if self.page.worker.state.get_untracked() == WorkerState::Starting {
            // It has sent no epoch, so times are on the page's clock.
            self.page.set_epoch(page_origin_ms());
        }
        let mut lost = Session::default();
        let lost_at = self.page.latest.with_value(|session| session.now);
        self.page
            .history
            .update_value(|history| history.end(lost_at));
        self.page.latest.update_value(|session| {
            let now = session.now;
            lost = std::mem::replace(
                session,
                Session {
                    now,
                    ..Session::default()
                },
            );
        });
        self.page.worker.state.set(WorkerState::Dead);
        self.readings.forget();
        self.readings.end_faults();
        self.page.announce(Change::Disconnected);
        self.page.notices.update(|board| {
            board.close_line();
            // The end of the stop will not be reported.
            board.withdraw_all(|topic| matches!(topic, Topic::Setpoint(_)));
        });
        let driven = lost.active_motors().next().is_some();
        self.page.notify(&|| notice_texts::of_dead_worker(driven));
        self.page.show();
        self.page.worker.rescue.with_value(|rescue| {
            if let Some(rescue) = rescue {
                rescue(&lost);
            }
        });
    }
}
