//! What a person sets, and the way of the vehicle. It lasts as long as the page, also when the language changes.

use leptos::prelude::*;
use motorlink_messages::{
    experiments::vehicle::{Geometry, Vehicle},
    protocol::Instant,
};

use crate::{
    features::rover::trip::Trip,
    model::{
        history::ZERO_US,
        local_storage::{remember, remembered},
        page::Page,
        vehicle::{geometry_of_page, save, vehicle_of},
    },
    ui::{reactive::effect, target::Target},
};

/// The storage key of the shown drawing.
const VIEW_STORED_AS: &str = "rover-view";
/// Its value while the single wheel is shown.
const SINGLE: &str = "wheel";

/// The rover view.
#[derive(Clone, Copy)]
pub(crate) struct Rover {
    pub(crate) page: Page,
    /// The entered measures, in mm.
    pub(crate) radius: Target,
    pub(crate) track: Target,
    /// The measures in use, since the last was entered completely.
    pub(crate) geometry: RwSignal<Geometry>,
    /// Whether the single wheel is shown though a group is selected.
    pub(crate) is_single: RwSignal<bool>,
    pub(crate) trip: StoredValue<Trip, LocalStorage>,
}

impl Rover {
    /// The rover view of this page: made at the first call, for the owner of the page.
    pub(crate) fn of_page(owner: &Owner, page: Page) -> Self {
        owner.with(|| {
            use_context().unwrap_or_else(|| {
                let new = Self::new(page, geometry_of_page(owner, page));
                provide_context(new);
                new
            })
        })
    }

    fn new(page: Page, geometry: RwSignal<Geometry>) -> Self {
        let [radius, track] = geometry.get_untracked().entered().map(Target::new);
        // An imported setup has other ones.
        effect(move || {
            for (entered, used) in [radius, track].into_iter().zip(geometry.get().entered()) {
                if entered.get_untracked() != used {
                    entered.set(used);
                }
            }
        });
        Self {
            page,
            radius,
            track,
            geometry,
            is_single: RwSignal::new(remembered(VIEW_STORED_AS).as_deref() == Some(SINGLE)),
            trip: StoredValue::new_local(Trip::default()),
        }
    }

    /// Uses and stores the entered measures.
    pub(crate) fn measure(self) {
        let entered = (self.radius.get_untracked(), self.track.get_untracked());
        if let Some(geometry) = Geometry::new(entered.0, entered.1) {
            save(geometry);
            self.geometry.set(geometry);
        }
    }

    /// Shows the single wheel in place of the rover, or the rover again.
    pub(crate) fn switch(self) {
        self.is_single.update(|single| *single = !*single);
        let single = self.is_single.get_untracked();
        remember(VIEW_STORED_AS, if single { SINGLE } else { "rover" });
    }

    /// Begins the path where the vehicle is now.
    pub(crate) fn reset_path(self) {
        self.begin_path(self.now());
    }

    /// Begins the path with the oldest replies of the history: those before a place of a recording.
    pub(crate) fn begin_path_with_history(self) {
        self.begin_path(Instant::ZERO);
    }

    fn begin_path(self, from: Instant) {
        if let Some(vehicle) = self.vehicle() {
            let geometry = self.geometry.get_untracked();
            self.trip
                .update_value(|trip| trip.begin(&vehicle, geometry, from));
        }
    }

    pub(crate) fn vehicle(self) -> Option<Vehicle> {
        self.page.motors.names.with_untracked(vehicle_of)
    }

    /// Counts the new replies.
    pub(crate) fn follow(self, vehicle: &Vehicle) {
        let (geometry, now) = (self.geometry.get_untracked(), self.now());
        self.page.history.with_value(|history| {
            self.trip
                .update_value(|trip| trip.follow(vehicle, geometry, history, now));
        });
    }

    /// The present time on the clock of the history.
    fn now(self) -> Instant {
        Instant::from_micros(ZERO_US.saturating_add(self.page.now().as_micros()))
    }
}
