//! Every feature of the page, and what one of them has to do when another acts.

use derive_more::Deref;
use leptos::prelude::*;

use crate::{
    features::{
        connect::actions::Connect,
        drive::actions::Drive,
        graph::state::Chart,
        groups::actions::Groups,
        help::{tour::Tour, tour_view::remembered_tour},
        ids::actions::Ids,
        install::Install,
        packet_log::actions::Log,
        raw::actions::Raw,
        saved_session::actions::SavedSession,
        settings::actions::Settings,
        telemetry::readings::Readings,
    },
    model::{
        page::{Change, Listener, Page},
        preferences::Preferences,
    },
};

/// A pointer, as the page is one.
#[derive(Clone, Copy, Deref)]
pub(crate) struct Features(#[deref(forward)] &'static Parts);

/// The features that have a state of their own.
pub(crate) struct Parts {
    pub(crate) page: Page,
    pub(crate) connect: Connect,
    pub(crate) drive: Drive,
    pub(crate) groups: Groups,
    pub(crate) ids: Ids,
    pub(crate) raw: Raw,
    pub(crate) readings: Readings,
    pub(crate) chart: Chart,
    pub(crate) log: Log,
    pub(crate) saved_session: SavedSession,
    pub(crate) settings: Settings,
    pub(crate) install: Install,
    /// The tour of the first minutes.
    pub(crate) tour: RwSignal<Tour>,
    /// Which virtual line was chosen, by its place.
    pub(crate) virtual_wire: StoredValue<usize>,
}

impl Features {
    pub(crate) fn new(preferences: Preferences) -> Self {
        let page = Page::new(preferences);
        let features = Self(Box::leak(Box::new(Parts {
            page,
            connect: Connect { page },
            drive: Drive::new(page),
            groups: Groups::new(page),
            ids: Ids::new(page),
            raw: Raw::new(page),
            readings: Readings::new(page),
            chart: Chart::new(page),
            log: Log::new(page),
            saved_session: SavedSession::new(page),
            settings: Settings::new(page),
            install: Install::new(page),
            tour: RwSignal::new(remembered_tour()),
            virtual_wire: StoredValue::new(0),
        })));
        let deliver = move |change: Change<'_>| match change {
            Change::Motor => features.readings.forget(),
            Change::Model => features.connect.reconnect(),
            _ => {}
        };
        page.listen(Listener::App, Box::new(deliver));
        features
    }
}
