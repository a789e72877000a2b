//! Shows a recording on the instruments of the page, and the live line again after it.
//!
//! It loads with the panel `Session file`. For the page a recording is a line that opens, reports and closes: see
//! `routing`. What would be lost of the live line is set aside meanwhile.

use std::cell::RefCell;

use leptos::prelude::{Update as _, *};
use motorlink_messages::{
    Adapter, Connection, Update,
    protocol::{Mode, MotorId},
};

use crate::{
    app::features::Features,
    features::{
        packet_log::feed::LogFeed,
        rover::state::Rover,
        session_file::player::{Instruments, Show},
        telemetry::fault_history::FaultHistory,
    },
    model::{history::History, names_and_sides::NamesAndSides, page::Page, snapshot::Session},
};

/// The live line while a recording is shown.
struct Live {
    latest: Session,
    history: History,
    faults: FaultHistory,
    log: LogFeed,
    names: NamesAndSides,
    selected: MotorId,
    tab: Mode,
}

/// The instruments of the page, for a recording.
pub(crate) fn instruments(features: Features, rover: Rover) -> Instruments {
    let live = RefCell::new(None);
    Box::new(move |what| {
        let Ok(mut live) = live.try_borrow_mut() else {
            return;
        };
        match what {
            Show::Begin(names) => {
                *live = Some(features.set_live_aside());
                show_names(features.page, names.clone());
            }
            Show::Nothing => features.show_nothing(),
            Show::Recorded(update) => features.show_recorded(update, rover),
            Show::Past(samples) => {
                let history = features.page.history;
                history.update_value(|history| history.recall(0, samples));
                rover.begin_path_with_history();
            }
            Show::PastActivities(changes) => {
                let history = features.page.history;
                history.update_value(|history| history.recall_goals(changes));
            }
            Show::Faults(changes) => {
                let clock = features.page.worker.clock.get_value();
                let mut faults = FaultHistory::default();
                for change in changes {
                    faults.on_change(change, clock.wall_ms(change.at));
                }
                features.exchange_faults(faults);
            }
            Show::Rows(rows) => features.log.take(rows.clone()),
            Show::Close => features.update(&Update::without_motors(
                features.page.now(),
                Connection::Disconnected,
            )),
            Show::End => {
                if let Some(live) = live.take() {
                    features.show_live(live, rover);
                }
            }
        }
    })
}

/// Here rather than in the first program, which changes them otherwise.
fn show_names(page: Page, names: NamesAndSides) {
    page.motors.names.set(names);
    page.motors.replaced.update(|times| *times += 1);
    page.show();
}

impl Features {
    fn set_live_aside(self) -> Live {
        let page = self.page;
        let live = Live {
            latest: page.latest.with_value(Clone::clone),
            history: self.exchange_history(History::with_past()),
            faults: self.exchange_faults(FaultHistory::default()),
            log: self.log.exchange(LogFeed::default()),
            names: page.motors.names.get_untracked(),
            selected: page.selected.get_untracked(),
            tab: page.loops.tab.get_untracked(),
        };
        let recording = Connection::Connected(Adapter::Recording);
        self.update(&Update::without_motors(page.now(), recording));
        live
    }

    fn exchange_history(self, other: History) -> History {
        let history = self.page.history;
        let before = history.try_update_value(|history| history.exchange(other));
        before.unwrap_or_default()
    }

    fn exchange_faults(self, other: FaultHistory) -> FaultHistory {
        let faults = self.readings.faults;
        let before = faults.try_update(|faults| std::mem::replace(faults, other));
        before.unwrap_or_default()
    }

    /// The recording jumps to another place: nothing of the one before is shown.
    fn show_nothing(self) {
        self.exchange_history(History::with_past());
        self.exchange_faults(FaultHistory::default());
        self.readings.forget();
        self.page
            .latest
            .update_value(|session| session.motors.clear());
        self.log.renumbered();
        self.log.request_rows();
    }

    fn show_recorded(self, update: &Update, rover: Rover) {
        let page = self.page;
        let is_first = page.latest.with_value(|session| session.motors.is_empty());
        if is_first {
            rover.begin_path_with_history();
            self.show_a_recorded_motor(update);
        }
        self.update(update);
        if page.worker.clock.with_value(|clock| clock.is_paused()) {
            // Without this the graph draws the next column when it is due, and that is never.
            page.history.update_value(|history| history.recall(0, &[]));
            self.chart.wake();
            page.show();
        }
    }

    /// Shows a motor of the recording, if the selected one is not in it.
    fn show_a_recorded_motor(self, update: &Update) {
        let selected = self.page.selected.get_untracked();
        let mut answer = update.motors.iter().filter(|motor| motor.last.is_some());
        let is_there = answer.clone().any(|motor| motor.id == selected);
        if let Some(first) = answer.next().filter(|_| !is_there) {
            self.page.select(first.id);
        }
    }

    fn show_live(self, live: Live, rover: Rover) {
        let page = self.page;
        page.latest.update_value(|latest| *latest = live.latest);
        show_names(page, live.names);
        self.exchange_history(live.history);
        self.exchange_faults(live.faults);
        self.log.exchange(live.log);
        page.loops.tab.set(live.tab);
        rover.reset_path();
        // The worker has got none of it meanwhile.
        page.select(live.selected);
        page.loops.tab_to_follow.set_value(false);
        page.send_settings();
        self.chart.wake();
    }
}
