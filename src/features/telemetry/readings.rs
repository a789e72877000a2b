//! The data for the cards and the twin.

use leptos::prelude::{Update as _, *};
use motorlink_messages::{
    Update,
    bus::{Activity, Sample},
    protocol::{Angle, Rpm},
};

use crate::{
    features::telemetry::{
        fault_history::FaultHistory,
        recent::{Recent, Report},
        twin::{AngleQuality, TwinFeed},
    },
    model::page::Page,
};

/// The readings of the selected motor for the cards and the twin.
#[derive(Clone, Copy)]
pub(crate) struct Readings {
    pub(crate) page: Page,
    /// The data of the twin.
    pub(crate) twin: StoredValue<TwinFeed, LocalStorage>,
    /// The data of the sparklines.
    pub(crate) recent: StoredValue<Recent>,
    /// Changes only when a fault begins, ends or is marked as seen.
    pub(crate) faults: RwSignal<FaultHistory>,
}

impl Readings {
    pub(crate) fn new(page: Page) -> Self {
        Self {
            page,
            twin: StoredValue::new_local(TwinFeed::default()),
            recent: StoredValue::new(Recent::default()),
            faults: RwSignal::new(FaultHistory::default()),
        }
    }

    /// Clears the readings of the previous motor after a change of the selection.
    pub(crate) fn forget(self) {
        self.twin.update_value(TwinFeed::clear);
        self.recent.update_value(Recent::clear);
    }

    /// Every sample counts here, also those between two frames of the screen.
    pub(crate) fn keep_samples(self, update: &Update) {
        let id = self.page.selected.get_untracked();
        let clock = self.page.worker.clock.get_value();
        self.recent.update_value(|recent| {
            for sample in update.samples.iter().filter(|sample| sample.reply.id == id) {
                recent.push(Report {
                    at_ms: clock.shown_ms_of(sample.at),
                    speed: sample.reply.speed,
                    current: sample.reply.current,
                });
            }
        });
        self.faults.maybe_update(|history| {
            let mut changed = false;
            for Sample { at, reply } in &update.samples {
                changed |= history.on_report(reply.id, reply.faults, clock.wall_ms(*at));
            }
            for motor in update.motors.iter().filter(|motor| motor.is_silent()) {
                changed |= history.end_unknown(Some(motor.id));
            }
            if update.motors.is_empty() {
                changed |= history.end_unknown(None);
            }
            changed
        });
    }

    pub(crate) fn feed_twin(self, update: &Update) {
        let id = self.page.selected.get_untracked();
        let clock = self.page.worker.clock.get_value();
        let motor = self
            .page
            .latest
            .with_value(|session| session.motor(id).copied());
        let activity = motor.map(|motor| motor.activity);
        let goal = match activity {
            Some(Activity::Driven { setpoint }) => Some(setpoint),
            _ => None,
        };
        self.twin.update_value(|feed| {
            for sample in update.samples.iter().filter(|sample| sample.reply.id == id) {
                let angle = sample.reply.detail.angle();
                let quality = match angle {
                    Some(Angle::Fine(_)) => AngleQuality::Fine,
                    Some(Angle::Coarse(_)) | None => AngleQuality::Coarse,
                };
                let angle = angle.map(Angle::degrees);
                let at_ms = clock.shown_ms_of(sample.at);
                feed.sample(
                    at_ms,
                    angle.map(f64::from),
                    quality,
                    sample.reply.speed.map(Rpm::rpm),
                );
            }
            feed.set_goal(goal);
            feed.set_activity(activity);
            feed.set_turns(motor.and_then(|motor| motor.turns));
        });
    }

    /// No motor tells its faults any more.
    pub(crate) fn end_faults(self) {
        self.faults
            .maybe_update(|history| history.end_unknown(None));
    }
}
