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
        drive::{ControlPanel, velocity::VelocityTab},
        stop::dialog::StoppedDialog,
        telemetry::{Telemetry, twin::panel::WheelPanel},
    },
    model::tab::Tab,
    ui::drawer::Drawer,
};
use web_sys::HtmlElement;

/// The places of sections, in the order of the page.
#[derive(Clone, Copy)]
pub(crate) enum Place {
    Top,
    AboveDesk,
    /// Beside the desk on a wide screen, over it on a narrow one.
    Dock,
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
    /// A panel of the main view, by its class.
    Panel(&'static str),
    /// A panel of the tabs.
    Tab(Tab),
    /// A panel of the drawer.
    Drawer(Drawer),
    /// The help.
    Help,
    /// None: the section appears when it has something to show.
    Nothing,
}

/// All sections.
pub(crate) const SECTIONS: [(Place, Section); 24] = [
    (
        Place::Top,
        Section::Now(|place, features| {
            mount(&place, move || {
                let behind_dialog = Signal::derive(move || features.page.is_behind_dialog());
                view! { <Header features behind_dialog /> }
            })
        }),
    ),
    (
        Place::Desk,
        Section::Now(|place, _| mount(&place, ControlPanel)),
    ),
    (
        Place::TabPanels,
        Section::Now(|place, features| {
            mount(
                &place,
                move || view! { <VelocityTab drive=features.drive /> },
            )
        }),
    ),
    (
        Place::TabPanels,
        Section::Later(Part::Desk, Frame::Tab(Tab::Loop(Mode::Current))),
    ),
    (
        Place::TabPanels,
        Section::Later(Part::Desk, Frame::Tab(Tab::Loop(Mode::Position))),
    ),
    (
        Place::TabPanels,
        Section::Later(Part::Desk, Frame::Tab(Tab::Loop(Mode::OpenLoop))),
    ),
    (
        Place::TabPanels,
        Section::Later(Part::Tools, Frame::Tab(Tab::IdManager)),
    ),
    (
        Place::TabPanels,
        Section::Later(Part::Tools, Frame::Tab(Tab::RawHex)),
    ),
    (
        Place::Desk,
        Section::Now(|place, features| {
            mount(
                &place,
                move || view! { <WheelPanel readings=features.readings /> },
            )
        }),
    ),
    (
        Place::Desk,
        Section::Now(|place, features| {
            mount(
                &place,
                move || view! { <Telemetry readings=features.readings /> },
            )
        }),
    ),
    // In the place of the wheel.
    (Place::Desk, Section::Later(Part::Desk, Frame::Nothing)),
    (
        Place::Desk,
        Section::Later(Part::Desk, Frame::Panel("panel notices")),
    ),
    (
        Place::Desk,
        Section::Later(Part::Desk, Frame::Panel("panel packet-log")),
    ),
    (
        Place::Desk,
        Section::Later(Part::Desk, Frame::Panel("panel graph-panel")),
    ),
    (
        Place::Desk,
        Section::Later(Part::Desk, Frame::Panel("panel recording")),
    ),
    (
        Place::Desk,
        Section::Now(|place, _| mount(&place, StoppedDialog)),
    ),
    (Place::AboveDesk, Section::Later(Part::Desk, Frame::Nothing)),
    // Right behind the header with the button that opens it.
    (
        Place::AboveDesk,
        Section::Later(Part::Tools, Frame::Drawer(Drawer::VirtualMotors)),
    ),
    (
        Place::Dock,
        Section::Later(Part::Tools, Frame::Drawer(Drawer::Link)),
    ),
    (
        Place::Dock,
        Section::Later(Part::Tools, Frame::Drawer(Drawer::Together)),
    ),
    (
        Place::Dock,
        Section::Later(Part::Tools, Frame::Drawer(Drawer::Settings)),
    ),
    (Place::Dialogs, Section::Later(Part::Desk, Frame::Nothing)),
    (Place::Dialogs, Section::Later(Part::Help, Frame::Help)),
    // Only sections of parts ask questions. The alert of wheels that turn unasked is with them.
    (Place::Dialogs, Section::Later(Part::Desk, Frame::Nothing)),
];
