//! The parts of the program that load after the first paint, or when their panel is first opened.
//!
//! Each is a separate file (`cargo xtask build`).
#![cfg_attr(
    feature = "parts",
    allow(unsafe_code, reason = "the call into a part, made by wasm_split")
)]

use leptos::{prelude::*, wasm_split::SplitLoaderError};
use motorlink_i18n::load_later_texts;
use wasm_bindgen::JsCast;

use crate::{
    app::{
        features::Features,
        focus,
        later_panel::{LaterPanel, Load, later_panel},
        mount::{Hosts, Mounted, mount},
        question_dialog::QuestionDialog,
        rail::Rail,
        replay, rescue,
    },
    features::{
        connect::{panel::VirtualMotorsPanel, to_try::ToTry},
        dock::Dock,
        drive::{current::CurrentTab, open_loop::OpenLoopTab, position::PositionTab},
        experiments::{panel::ExperimentsPanel, state::Experiments},
        graph::Graph,
        groups::panel::TogetherPanel,
        help::{
            HelpDialog,
            tour::Shown,
            tour_view::{TourNotice, shown},
        },
        ids::{state::IdManager, view::IdManagerPanel},
        install::texts,
        link_doctor::panel::LinkPanel,
        motors::{name_dialog::NameDialog, strip::MotorStrip},
        notices::Notices,
        packet_log::PacketLog,
        raw::view::RawHexPanel,
        recording::Recording,
        remote::view::RemoteGroup,
        rover::{geometry_fields::GeometryFields, group, panel::RoverPanel, state::Rover},
        saved_session::view::{SavedSessionNotice, is_hidden},
        session_file::{actions::SessionFiles, incoming::Incoming, panel::SessionPanel},
        settings::panel::{InstallButton, SettingsPanel},
        setup_link::{
            self,
            panel::{LinkedGraph, SetupLink, SetupLinkPanel},
        },
        stop::alert::TurningAlert,
        wheel_setup::{
            actions::{IdManagerActions, WheelSetup},
            panel::WheelSetupSteps,
        },
    },
    model::{later_notices, page::Page},
};

/// A part. More and smaller parts would be larger in total: code that several parts use is a file per set of parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// The rest of the main view: the rover, notices, rail, motor strip, the other loops' tabs, packet log, graph,
    /// questions.
    Desk,
    /// The panels of the places, and the choice of virtual motors.
    Tools,
    /// The help.
    Help,
}

/// The sections of a part, mounted.
pub(crate) type Sections = Vec<Option<Mounted>>;

impl Part {
    /// All, in the order in which they are fetched.
    pub(crate) const ALL: [Self; 3] = [Self::Desk, Self::Tools, Self::Help];

    /// Fetches the part unless it is loaded, and mounts its sections.
    ///
    /// # Errors
    ///
    /// If its file cannot be fetched. The next call tries again.
    pub(crate) async fn mount(
        self,
        hosts: Hosts,
        features: Features,
    ) -> Result<Sections, SplitLoaderError> {
        match self {
            Self::Desk => mount_desk(hosts, features).await,
            Self::Tools => mount_tools(hosts, features).await,
            Self::Help => mount_help(hosts, features).await,
        }
    }
}

/// Moves the code of a function, and all code that only it uses, into a part. Without the feature `parts`, as in
/// tests, all code is in one program.
macro_rules! in_part {
    ($part:ident: fn $name:ident($hosts:ident, $features:ident $(, $which:ident)?) $sections:expr) => {
        #[cfg(feature = "parts")]
        #[::leptos::wasm_split::wasm_split(
            $part,
            wasm_split_path = ::leptos::wasm_split,
            fallible
        )]
        fn $name(
            hosts: Hosts,
            $features: Features
            $(, $which: LaterPanel)?
        ) -> Result<Sections, SplitLoaderError> {
            let mut $hosts = hosts;
            Ok($sections.into())
        }

        #[cfg(not(feature = "parts"))]
        async fn $name(
            mut $hosts: Hosts,
            $features: Features
            $(, $which: LaterPanel)?
        ) -> Result<Sections, SplitLoaderError> {
            Ok($sections.into())
        }
    };
}

// In the order of `SECTIONS`.
in_part!(desk: fn mount_desk(hosts, features) [
    {
        load_later_texts();
        let incoming = Incoming::of_page(&hosts.owner);
        hosts.mount(move || {
            let page = features.page;
            view! {
                <ToTry
                    connect=features.connect
                    virtual_wire=features.virtual_wire
                    on_recording=move |file| incoming.take(page, file)
                />
            }
        })
    },
    hosts.mount(move || view! { <CurrentTab drive=features.drive /> }),
    hosts.mount(move || view! { <PositionTab drive=features.drive /> }),
    hosts.mount(move || view! { <OpenLoopTab drive=features.drive /> }),
    hosts.mount(move || notices(features)),
    {
        let rover = Rover::of_page(&hosts.owner, features.page);
        hosts.mount(move || view! { <RoverPanel rover /> })
    },
    hosts.mount(move || {
        view! {
            <Dock />
            <Graph chart=features.chart />
        }
    }),
    hosts.mount(move || view! { <PacketLog log=features.log /> }),
    {
        let incoming = Incoming::of_page(&hosts.owner);
        hosts.mount(move || {
            incoming.listen(features.page);
            Rail()
        })
    },
    hosts.mount(MotorStrip),
    hosts.mount(move || {
        view! {
            <QuestionDialog features />
            <NameDialog />
            <TurningAlert />
        }
    }),
    remote_group(&hosts.owner, features.page),
]);

in_part!(tools: fn mount_tools(hosts, features) [
    {
        load_later_texts();
        let rover = Rover::of_page(&hosts.owner, features.page);
        hosts.mount(move || {
            group::show(rover);
            let measures = view! { <GeometryFields rover /> };
            view! { <TogetherPanel groups=features.groups measures /> }
        })
    },
    {
        features.ids.listen();
        hosts.mount(move || view! { <IdManagerPanel ids=features.ids /> })
    },
    hosts.mount(move || settings_panel(features)),
    hosts.mount(move || {
        view! { <LinkPanel page=features.page virtual_wire=features.virtual_wire /> }
    }),
    hosts.mount(move || view! { <RawHexPanel raw=features.raw /> }),
    hosts.mount(Recording),
    {
        let owner = hosts.owner.downgrade();
        hosts.mount(move || {
            let owner = StoredValue::new(owner);
            let load: Load = |hosts, features, which| match which {
                LaterPanel::Experiments => Box::pin(mount_experiments(hosts, features)),
                _ => Box::pin(mount_seldom(hosts, features, which)),
            };
            setup_link::address::watch(features.page);
            let panel = |which| later_panel(which, features, owner, load);
            view! {
                {panel(LaterPanel::Session)}
                {panel(LaterPanel::Experiments)}
                {panel(LaterPanel::WheelSetup)}
                {panel(LaterPanel::SetupLink)}
            }
        })
    },
    hosts.mount(move || view! { <VirtualMotorsPanel connect=features.connect /> }),
]);

// One function for all panels: each function, and each part, adds to the first program.
in_part!(seldom: fn mount_seldom(hosts, features, which) [{
    load_later_texts();
    if which == LaterPanel::Session {
        let incoming = Incoming::of_page(&hosts.owner);
        let rover = Rover::of_page(&hosts.owner, features.page);
        let instruments = move || replay::instruments(features, rover);
        let files = SessionFiles::of_page(&hosts.owner, features.page, instruments);
        hosts.mount(move || view! { <SessionPanel files incoming /> })
    } else if which == LaterPanel::SetupLink {
        let chart = features.chart;
        let graph = move || LinkedGraph {
            shown: Box::new(move || chart.graph_view()),
            show: Box::new(move |view| chart.show_graph_view(view)),
        };
        let of = SetupLink::of_page(&hosts.owner, features.page, graph);
        hosts.mount(move || view! { <SetupLinkPanel of /> })
    } else {
        let ids = features.ids;
        let actions = move || IdManagerActions {
            progress: Box::new(move || ids.manager.with(IdManager::progress)),
            set_id: Box::new(move |to| ids.request(to)),
            set_with_more: Box::new(move || ids.set_id_with_more()),
            full_scan: Box::new(move || ids.full_scan()),
            cancel: Box::new(move || ids.cancel_scan()),
        };
        let setup = WheelSetup::of_page(&hosts.owner, features.page, actions);
        hosts.mount(move || view! { <WheelSetupSteps setup /> })
    }
}]);

in_part!(experiments: fn mount_experiments(hosts, features) [{
    load_later_texts();
    let of = Experiments::of_page(&hosts.owner, features.page);
    hosts.mount(move || view! { <ExperimentsPanel of /> })
}]);

in_part!(help: fn mount_help(hosts, features) [
    hosts.mount(move || view! { <HelpDialog tour=features.tour /> }),
]);

/// The group `Remote` in the header of a page that comes from a server.
fn remote_group(owner: &Owner, page: Page) -> Option<Mounted> {
    let header = document().query_selector(":root[data-remote] .header-rest");
    let header = header.ok()??.dyn_into().ok()?;
    Some(owner.with(|| mount(&header, move || view! { <RemoteGroup page /> })))
}

fn settings_panel(features: Features) -> impl IntoView {
    let install = Box::leak(Box::new(InstallButton {
        disabled_reason: Box::new(move || features.install.install_blocked_by()),
        hint: texts::hint(),
        on_press: Box::new(move || features.install.install()),
    }));
    view! { <SettingsPanel settings=features.settings install /> }
}

/// The notices, with the saved session and the tour among them.
fn notices(features: Features) -> impl IntoView {
    rescue::be_ready(features);
    later_notices::load();
    let shown = move || shown(features.page, features.tour);
    let is_alone = move || is_hidden(features.saved_session) && shown() == Shown::No;
    focus::keep(features.page);
    let on_action = Box::leak(Box::new(move |action| features.run_tour_action(action)));
    let on_remedy = Box::leak(Box::new(move |remedy| features.remedy(remedy)));
    view! {
        <Notices
            is_alone=Signal::derive(is_alone)
            is_tour_shown=Signal::derive(move || shown() != Shown::No)
            on_remedy
            saved_session=view! { <SavedSessionNotice saved=features.saved_session /> }
            tour=view! { <TourNotice page=features.page tour=features.tour on_action /> }
        />
    }
}
