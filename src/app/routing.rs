//! What the worker says, taken in.

use leptos::prelude::{Update as _, *};
use motorlink_messages::{
    Adapter, Connection, Notice, ToPage, ToWorker, Update,
    bus::{Activity, IdQueryOutcome, Sample, StopReason},
    protocol::{Detail, Instant, Mode, MotorId},
};

use crate::{
    features::{
        raw::actions::belongs_to_raw_editor, telemetry::recent::Report, twin::AngleQuality,
    },
    link::{
        clock::{Clock, page_origin_ms},
        worker_link::WorkerLink,
    },
    model::{
        desk::{Desk, WorkerState},
        log_lines,
        notice_board::{NoticeBoard, Topic},
        notice_lifetime::{self as alerts, review},
        notice_texts as words,
        scan_texts::belongs_to_id_manager,
        snapshot::{Reading, Session},
        tab::Tab,
    },
};

impl Desk {
    pub(crate) fn hear(self, message: ToPage) {
        match message {
            ToPage::Hello { time_origin_ms } => {
                self.clock
                    .set_value(Clock::new(page_origin_ms(), time_origin_ms));
                self.set_epoch(time_origin_ms);
                self.worker.set(WorkerState::Running);
                self.post(&ToWorker::Select(self.selected.get_untracked()));
                self.send_limits();
            }
            ToPage::Died => self.worker_lost(),
            // Answered where it arrives.
            ToPage::Ping => {}
            ToPage::Update(update) => self.update(&update),
        }
    }

    fn update(self, update: &Update) {
        let before = self.latest.with_value(|session| session.connection);
        let lines = self
            .latest
            .with_value(|session| log_lines::of_update(session, update));
        for line in lines {
            self.log(update.now, line);
        }
        self.latest.update_value(|session| session.apply(update));
        self.notices
            .maybe_update(|board| board.review(|until| review(until, update)));
        // Before a lost connection has them forgotten.
        self.keep_samples(update);
        self.feed_twin(update);
        if update.connection != before {
            self.connection_changed(before, update.connection);
        }
        for notice in &update.notices {
            self.notice(update.now, notice);
        }
        self.look_after_ids();
        self.look_after_group();
        self.history.update_value(|history| history.take(update));
        self.follow_loop();
        // Readings wait for the next tenth of a second; a state does not.
        let changed = self.latest.with_value(|latest| {
            self.shown
                .with_untracked(|shown| latest.differs_in_state(shown))
        });
        if changed {
            self.show();
        }
    }

    fn connection_changed(self, before: Connection, after: Connection) {
        self.withdraw_question();
        match after {
            Connection::Connected(adapter) => {
                self.notices.update(|board| {
                    board.withdraw_all(|topic| {
                        matches!(
                            topic,
                            Topic::Port | Topic::Answer | Topic::Command | Topic::Setpoint(_)
                        )
                    });
                });
                self.tab_to_follow.set_value(true);
                self.send_rate();
                self.send_ramp();
                if let Adapter::Serial(Some(usb)) = adapter {
                    self.prefer(|preferences| preferences.adapter = Some(usb));
                }
            }
            Connection::Failed(error) => self.say(words::of_connect_error(error)),
            Connection::Disconnected | Connection::Connecting | Connection::Reconnecting(_) => {}
        }
        if matches!(before, Connection::Connected(_)) {
            self.asked.set(None);
            self.forget_motor();
            self.faults_unheard(None);
            self.forget_scans();
            self.raw.forget();
            self.notices.update(NoticeBoard::close_line);
        }
    }

    fn notice(self, at: Instant, notice: &Notice) {
        let selected = self.selected.get_untracked();
        if let Some(topic) = words::settled_by(notice) {
            self.notices.update(|board| board.withdraw(topic));
        }
        match notice {
            Notice::IdQueryEnded(IdQueryOutcome::One(id)) if *id != selected => {
                let answered = |session: &Session| session.mode(selected).is_some();
                if !self.latest.with_value(answered) {
                    self.select(*id);
                }
            }
            Notice::ModeSwitched { id, mode } if *id == selected => self.follow(*mode),
            Notice::MotorSilent(id) => self.faults_unheard(Some(*id)),
            // It may be back before the page was told that it was gone.
            Notice::AdapterLost { .. } => self.withdraw_question(),
            // The bus ends a stop in the velocity loop, whatever was asked for before.
            Notice::StopBegan(reason) if *reason != StopReason::OneMotor => self.asked.set(None),
            _ => {}
        }
        self.hear_of_ids(notice);
        self.hear_of_raw(notice);
        self.hear_of_group(notice);
        // What the open tab says itself is not said twice.
        let said_by_tab = match self.tab.get_untracked() {
            Tab::IdManager => belongs_to_id_manager(notice),
            Tab::RawHex => belongs_to_raw_editor(notice),
            Tab::Loop(_) => false,
        };
        let words = self.latest.with_value(|session| {
            let words = words::of_notice_in(notice, session)?;
            Some((words, alerts::until(notice, session)))
        });
        if let Some((words, until)) = words {
            if said_by_tab {
                self.log(at, log_lines::of_words(&words));
            } else {
                self.say_until(at, words, until);
            }
        } else if let Some(line) = log_lines::of_quiet_notice(notice) {
            self.log(at, line);
        }
    }

    fn feed_twin(self, update: &Update) {
        let id = self.selected.get_untracked();
        let clock = self.clock.get_value();
        let activity = self
            .latest
            .with_value(|session| session.motor(id).map(|motor| motor.activity));
        let goal = match activity {
            Some(Activity::Driven { setpoint }) => Some(setpoint),
            _ => None,
        };
        self.feed.update_value(|feed| {
            for sample in update.samples.iter().filter(|sample| sample.reply.id == id) {
                let (angle, quality) = match sample.reply.detail {
                    Detail::Drive { position } => (Some(position.degrees()), AngleQuality::Fine),
                    Detail::Query { position, .. } => {
                        (Some(position.degrees()), AngleQuality::Coarse)
                    }
                    Detail::Undetermined(_) => (None, AngleQuality::Coarse),
                };
                let at_ms = clock.page_ms(sample.at);
                feed.sample(
                    at_ms,
                    angle.map(f64::from),
                    quality,
                    sample.reply.speed.rpm(),
                );
            }
            feed.set_goal(goal);
            feed.set_activity(activity);
        });
    }

    /// Every sample counts here, also those between two frames of the screen.
    fn keep_samples(self, update: &Update) {
        let id = self.selected.get_untracked();
        let clock = self.clock.get_value();
        let origin_ms = page_origin_ms();
        self.recent.update_value(|recent| {
            for sample in update.samples.iter().filter(|sample| sample.reply.id == id) {
                recent.push(Report {
                    at_ms: clock.page_ms(sample.at),
                    speed: sample.reply.speed,
                    current: sample.reply.current,
                });
            }
        });
        self.fault_history.maybe_update(|history| {
            let mut changed = false;
            for Sample { at, reply } in &update.samples {
                let at_ms = origin_ms + clock.page_ms(*at);
                changed |= history.hear(reply.id, reply.faults, at_ms);
            }
            changed
        });
    }

    fn faults_unheard(self, id: Option<MotorId>) {
        self.fault_history
            .maybe_update(|history| history.unheard(id));
    }

    /// Once after connecting, the tab is that of the motor's loop.
    fn follow_loop(self) {
        if !self.tab_to_follow.get_value() {
            return;
        }
        let id = self.selected.get_untracked();
        let mode: Option<Reading<Mode>> = self.latest.with_value(|session| session.mode(id));
        if let Some(mode) = mode.filter(Reading::is_fresh) {
            self.follow(mode.value);
            self.tab_to_follow.set_value(false);
        }
    }

    /// Looks whether the worker lives. Called once a second.
    pub(crate) fn look_after_worker(self) {
        let pings = self.worker.get_untracked() == WorkerState::Running
            && self
                .latest
                .with_value(|session| matches!(session.connection, Connection::Connected(_)));
        let died =
            |link: &Option<WorkerLink>| link.as_ref().is_some_and(|link| link.has_died(pings));
        if self.link.with_value(died) {
            self.worker_lost();
        }
    }

    /// The worker has failed: nothing more comes from it, and no frame leaves.
    pub(crate) fn worker_lost(self) {
        // First of all: a worker that reports an error may live and drive on, and what is said here must be true.
        self.link.with_value(|link| {
            if let Some(link) = link {
                link.end();
            }
        });
        if self.worker.get_untracked() == WorkerState::Starting {
            // It has told no epoch, and the page's moments are on its own clock.
            self.set_epoch(page_origin_ms());
        }
        let mut driven = false;
        let lost_at = self.latest.with_value(|session| session.now);
        self.history.update_value(|history| history.end(lost_at));
        self.latest.update_value(|session| {
            driven = session.in_hand().next().is_some();
            *session = Session {
                now: session.now,
                ..Session::default()
            };
        });
        self.worker.set(WorkerState::Dead);
        self.forget_motor();
        self.faults_unheard(None);
        self.forget_scans();
        self.notices.update(|board| {
            board.close_line();
            // Nobody tells any more how the stop ends.
            board.withdraw_all(|topic| matches!(topic, Topic::Setpoint(_)));
        });
        self.say(words::of_dead_worker(driven));
        self.show();
    }
}
