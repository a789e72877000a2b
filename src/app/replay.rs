//! Shows a recording on the instruments of the page, and the live line again after it.
//!
//! It loads with the panel `Session file`. What concerns the live line is set aside meanwhile: the newest state, the
//! graph, readings, faults, notices and the packet log. Nothing that a recording reports reaches the tools that send:
//! a scan in it proves nothing about the line.

use std::cell::RefCell;

use leptos::prelude::{Update as _, *};
use motorlink_messages::{Adapter, Connection, Notice, Update, protocol::MotorId};

use crate::{
    app::features::Features,
    features::{
        packet_log::feed::LogFeed,
        rover::state::Rover,
        session::player::{Instruments, Show},
        telemetry::fault_history::FaultHistory,
    },
    model::{
        history::History,
        notice_board::NoticeBoard,
        notice_lifetime::{self, review},
        notice_texts,
        snapshot::Session,
        tab::Tab,
    },
};

/// The live line while a recording is shown.
struct Live {
    latest: Session,
    history: History,
    faults: FaultHistory,
    notices: NoticeBoard,
    log: LogFeed,
    selected: MotorId,
    tab: Tab,
}

/// The instruments of the page, for a recording.
pub(crate) fn instruments(features: Features, rover: Rover) -> Instruments {
    let live = RefCell::new(None);
    Box::new(move |what| {
        let Ok(mut live) = live.try_borrow_mut() else {
            return;
        };
        match what {
            Show::Begin => *live = Some(features.set_live_aside()),
            Show::Nothing => {
                features.show_nothing();
                features.log.renumbered();
                features.log.request_rows();
            }
            Show::Recorded(update) => features.show_recorded(update, rover),
            Show::Past(samples) => {
                let history = features.page.history;
                history.update_value(|history| history.recall(0, samples));
            }
            Show::Rows(rows) => features.log.take(rows.clone()),
            Show::Live(update) => {
                if let Some(live) = live.as_mut() {
                    live.latest.apply(update);
                }
            }
            Show::End => {
                if let Some(live) = live.take() {
                    features.show_live(live, rover);
                }
            }
        }
    })
}

impl Features {
    fn set_live_aside(self) -> Live {
        let page = self.page;
        page.withdraw_question();
        let notices = page.notices.try_update(std::mem::take).unwrap_or_default();
        let faults = self.readings.faults.try_update(std::mem::take);
        let live = Live {
            latest: page.latest.get_value(),
            history: self.exchange_history(History::with_past()),
            faults: faults.unwrap_or_default(),
            notices,
            log: self.log.exchange(LogFeed::default()),
            selected: page.selected.get_untracked(),
            tab: page.loops.tab.get_untracked(),
        };
        self.show_nothing();
        live
    }

    fn exchange_history(self, other: History) -> History {
        let exchanged = self
            .page
            .history
            .try_update_value(|history| history.exchange(other));
        exchanged.unwrap_or_default()
    }

    /// Shows a recording of which nothing is known yet.
    fn show_nothing(self) {
        let page = self.page;
        page.latest.set_value(Session {
            now: page.now(),
            connection: Connection::Connected(Adapter::Recording),
            ..Session::default()
        });
        self.exchange_history(History::with_past());
        page.notices.update(NoticeBoard::close_line);
        self.readings.faults.set(FaultHistory::default());
        self.readings.forget();
        page.loops.asked.set(None);
        page.loops.tab_to_follow.set_value(true);
        page.show();
    }

    /// As [`Features::update`](crate::app::features::Features) does for the live line, without what would reach it: the
    /// log of the page, the frame rate, the tools.
    fn show_recorded(self, update: &Update, rover: Rover) {
        let page = self.page;
        let is_first = page.latest.with_value(|session| session.motors.is_empty());
        page.latest.update_value(|session| session.apply(update));
        page.notices
            .maybe_update(|board| board.review(|until| review(until, update)));
        if is_first {
            self.show_a_recorded_motor(update);
            rover.reset_path();
        }
        self.readings.keep_samples(update);
        self.readings.feed_twin(update);
        for notice in &update.notices {
            self.show_recorded_notice(notice);
        }
        page.history.update_value(|history| history.take(update));
        self.follow_loop();
        let is_paused = page.worker.clock.get_value().is_paused();
        if is_paused {
            // Without this the graph draws the next column when it is due, and that is never.
            page.history.update_value(|history| history.recall(0, &[]));
            self.chart.wake();
        }
        let shows_more = page.latest.with_value(|latest| {
            let shown = page.shown;
            shown.with_untracked(|shown| latest.differs_in_state(shown))
        });
        if is_paused || shows_more {
            page.show();
        }
    }

    /// Shows a motor of the recording, if the selected one is not in it.
    fn show_a_recorded_motor(self, update: &Update) {
        let selected = self.page.selected.get_untracked();
        let answers = |id| {
            let mut motors = update.motors.iter();
            motors.any(|motor| motor.id == id && motor.last.is_some())
        };
        let first = update.motors.iter().find(|motor| motor.last.is_some());
        if let Some(first) = first.filter(|_| !answers(selected)) {
            self.page.select(first.id);
        }
    }

    fn show_recorded_notice(self, notice: &Notice) {
        let page = self.page;
        if let Some(topic) = notice_texts::settled_by(notice) {
            page.notices.update(|board| board.withdraw(topic));
        }
        match notice {
            Notice::ModeSwitched { id, mode } if *id == page.selected.get_untracked() => {
                page.follow(*mode);
            }
            Notice::MotorSilent(id) => self.readings.end_faults_of_silent(Some(*id)),
            _ => {}
        }
        let words = page.latest.with_value(|session| {
            let mut text = notice_texts::of_notice_in(notice, session)?;
            // What it advises was for the one who drove then.
            text.remedy = None;
            Some((text, notice_lifetime::until(notice, session)))
        });
        if let Some((text, until)) = words {
            page.show_notice(text, until);
        }
    }

    fn show_live(self, live: Live, rover: Rover) {
        let page = self.page;
        page.withdraw_question();
        page.latest.set_value(live.latest);
        self.exchange_history(live.history);
        page.notices.set(live.notices);
        self.readings.forget();
        self.readings.faults.set(live.faults);
        page.loops.asked.set(None);
        page.loops.tab_to_follow.set_value(false);
        page.loops.tab.set(live.tab);
        self.log.exchange(live.log);
        rover.reset_path();
        // The worker has got none of it meanwhile.
        page.select(live.selected);
        page.send_settings();
        self.chart.wake();
        page.show();
    }
}
