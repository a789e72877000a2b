//! The sections of the page: panels, tabs and dialogs, in order.
//!
//! The main program has the sections to connect, drive, watch and stop. All others are in parts that are
//! fetched after the first paint.

use leptos::prelude::*;
use motorlink_messages::protocol::Mode;

use crate::{
    app::{
        features::Features,
        header::Header,
        mount::{Mounted, mount},
        parts::Part,
    },
    features::{
        connect::first_screen::FirstScreen,
        drive::{ControlPanel, velocity::VelocityTab},
        stop::dialog::StoppedDialog,
        telemetry::{Telemetry, twin::panel::WheelPanel},
    },
    model::{
        page::Page,
        place::{Panel, Place},
    },
};
use web_sys::HtmlElement;

/// Where sections are mounted, in the order of the page.
#[derive(Clone, Copy)]
pub(crate) enum Area {
    Top,
    AboveDesk,
    Desk,
    TabPanels,
    Dialogs,
}

/// Where the code of a section is.
#[derive(Clone, Copy)]
pub(crate) enum Section {
    /// In the main program.
    Now(fn(HtmlElement, Features) -> Mounted),
    /// In a part. The placeholder is shown until it is loaded.
    Later(Part, Frame),
}

/// The placeholder of a section until its part is loaded.
#[derive(Clone, Copy)]
pub(crate) enum Frame {
    /// A panel, by its class, and whether it is shown.
    Panel(&'static str, fn(Page) -> bool),
    /// A panel of the tabs.
    Tab(Mode),
    /// The help.
    Help,
    /// None: the section appears when it has something to show.
    Nothing,
}

/// A panel of a place other than Drive.
const fn in_place(class: &'static str, is_open: fn(Page) -> bool) -> (Area, Section) {
    let panel = Frame::Panel(class, is_open);
    (Area::Desk, Section::Later(Part::Tools, panel))
}

/// All sections.
pub(crate) const SECTIONS: [(Area, Section); 27] = [
    (
        Area::Top,
        Section::Now(|place, features| {
            mount(&place, move || {
                let behind_dialog = Signal::derive(move || features.page.is_behind_dialog());
                view! { <Header features behind_dialog /> }
            })
        }),
    ),
    // Right behind the header, because it can be used before the rest is there.
    (
        Area::Desk,
        Section::Now(|place, features| {
            mount(
                &place,
                move || view! { <FirstScreen connect=features.connect /> },
            )
        }),
    ),
    (Area::Desk, Section::Later(Part::Desk, Frame::Nothing)),
    (
        Area::Desk,
        Section::Now(|place, _| mount(&place, ControlPanel)),
    ),
    (
        Area::TabPanels,
        Section::Now(|place, features| {
            mount(
                &place,
                move || view! { <VelocityTab drive=features.drive /> },
            )
        }),
    ),
    (
        Area::TabPanels,
        Section::Later(Part::Desk, Frame::Tab(Mode::Current)),
    ),
    (
        Area::TabPanels,
        Section::Later(Part::Desk, Frame::Tab(Mode::Position)),
    ),
    (
        Area::TabPanels,
        Section::Later(Part::Desk, Frame::Tab(Mode::OpenLoop)),
    ),
    (Area::TabPanels, Section::Later(Part::Tools, Frame::Nothing)),
    // Above the places, with the tour.
    (
        Area::Desk,
        Section::Later(Part::Desk, Frame::Panel("panel notices", |_| true)),
    ),
    in_place("panel place first", |page| page.place() == Place::Setup),
    in_place("panel place second", |page| page.place() == Place::Setup),
    in_place("panel place first", |page| page.place() == Place::Diagnose),
    in_place("panel place second", |page| page.place() == Place::Diagnose),
    in_place("panel place first", |page| page.place() == Place::Record),
    // The panels that load when they are opened.
    (Area::Desk, Section::Later(Part::Tools, Frame::Nothing)),
    (
        Area::Desk,
        Section::Now(|place, features| {
            mount(
                &place,
                move || view! { <WheelPanel readings=features.readings /> },
            )
        }),
    ),
    (
        Area::Desk,
        Section::Now(|place, features| {
            mount(
                &place,
                move || view! { <Telemetry readings=features.readings /> },
            )
        }),
    ),
    // In the place of the wheel.
    (Area::Desk, Section::Later(Part::Desk, Frame::Nothing)),
    (
        Area::Desk,
        Section::Later(Part::Desk, Frame::Panel("panel graph-panel", |_| true)),
    ),
    (
        Area::Desk,
        Section::Later(Part::Desk, Frame::Panel("panel packet-log", |_| true)),
    ),
    (
        Area::Desk,
        Section::Now(|place, _| mount(&place, StoppedDialog)),
    ),
    (Area::AboveDesk, Section::Later(Part::Desk, Frame::Nothing)),
    (Area::AboveDesk, Section::Later(Part::Desk, Frame::Nothing)),
    // Right behind the header with the button that opens it.
    (
        Area::AboveDesk,
        Section::Later(
            Part::Tools,
            Frame::Panel("panel opened", |page| {
                page.panel() == Some(Panel::VirtualMotors)
            }),
        ),
    ),
    (Area::Dialogs, Section::Later(Part::Help, Frame::Help)),
    // Only sections of parts ask questions. The alert of wheels that turn unasked is with them.
    (Area::Dialogs, Section::Later(Part::Desk, Frame::Nothing)),
];
