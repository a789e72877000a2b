//! The sections of the page: panels, tabs and dialogs, in the order in which they stand.
//!
//! What a person needs to connect, drive, watch and stop is in the program. Every other section is in a part of
//! the program that is fetched behind the first paint.

use leptos::prelude::*;
use motorlink_messages::protocol::Mode;

use crate::{
    app::{
        features::Features,
        header::Header,
        mount::{Mounted, mount},
        parts::Part,
        question_dialog::QuestionDialog,
    },
    features::{
        drive::{ControlPanel, velocity::VelocityTab},
        stop::dialog::StoppedDialog,
        telemetry::{Telemetry, twin::panel::WheelPanel},
    },
    model::{page::Page, tab::Tab},
    ui::drawer::Drawer,
};
use web_sys::HtmlElement;

/// Where sections are mounted, in the order in which they stand on the page.
#[derive(Clone, Copy)]
pub(crate) enum Place {
    Top,
    AboveDesk,
    Desk,
    TabPanels,
    Dialogs,
}

/// The code of a section.
#[derive(Clone, Copy)]
pub(crate) enum Section {
    /// In the program itself.
    Now(fn(HtmlElement, Features) -> Mounted),
    /// In a part that is fetched. The frame stands in its place until it is there.
    Later(Part, Frame),
}

/// What stands in the place of a section until its part is there.
#[derive(Clone, Copy)]
pub(crate) enum Frame {
    /// A panel of the desk, by its class.
    Panel(&'static str),
    /// A panel of the tabs.
    Tab(Tab),
    /// A panel of the drawer.
    Drawer(Drawer),
    /// The help.
    Help,
    /// Nothing: it appears when there is something to show.
    Nothing,
}

/// All sections.
pub(crate) const SECTIONS: [(Place, Section); 20] = [
    (
        Place::Top,
        Section::Now(|place, features| {
            mount(&place, move || {
                let behind_dialog = Signal::derive(move || is_behind_dialog(features.page));
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
    (
        Place::AboveDesk,
        Section::Later(Part::Tools, Frame::Drawer(Drawer::Link)),
    ),
    (
        Place::AboveDesk,
        Section::Later(Part::Tools, Frame::Drawer(Drawer::Together)),
    ),
    (
        Place::AboveDesk,
        Section::Later(Part::Tools, Frame::Drawer(Drawer::Settings)),
    ),
    (Place::Dialogs, Section::Later(Part::Help, Frame::Help)),
    (
        Place::Dialogs,
        Section::Now(|place, features| {
            mount(&place, move || view! { <QuestionDialog features /> })
        }),
    ),
];

pub(crate) fn is_behind_dialog(page: Page) -> bool {
    page.dialog.with(Option::is_some)
}
