//! A panel whose part of the program is loaded when the panel is opened first: few people need it.

use std::pin::Pin;

use leptos::{html::Div, prelude::*, task::spawn_local, wasm_split::SplitLoaderError};
use motorlink_i18n::tr;

use crate::{
    app::{
        absent::{Absent, notice},
        features::Features,
        mount::{Hosts, Mounted},
    },
    model::{
        page::Page,
        place::{Panel, Place},
    },
    ui::{
        panel::{OnClose, panel},
        reactive::effect,
    },
};

/// A panel that loads when it is opened first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LaterPanel {
    /// Saves and opens session files.
    Session,
    /// What is asked of motors, and the runs that ask it.
    Experiments,
    /// The setup of the wheels of a rover.
    WheelSetup,
    /// The setup as a link.
    SetupLink,
}

impl LaterPanel {
    fn is_open(self, page: Page) -> bool {
        match self {
            Self::Session => page.place() == Place::Record,
            Self::Experiments => page.place() == Place::Test,
            Self::WheelSetup => page.panel() == Some(Panel::WheelSetup),
            Self::SetupLink => page.panel() == Some(Panel::SetupLink),
        }
    }

    /// The panel, with its name.
    fn framed(self, page: Page, content: impl IntoView + 'static) -> impl IntoView {
        let (class, title, is_closable) = match self {
            Self::Session => ("panel place second session", tr!("Session file"), false),
            Self::Experiments => ("panel place whole", tr!("Experiments"), false),
            Self::WheelSetup => {
                let title = tr!("Set up the wheels of a rover");
                ("panel opened place first", title, true)
            }
            Self::SetupLink => ("panel opened place second", tr!("Setup link"), true),
        };
        let close: OnClose = is_closable.then(|| page.closer());
        panel(class, title, move || self.is_open(page), close, content)
    }
}

/// Loads a part, and mounts this panel of it.
pub(crate) type Load =
    fn(
        Hosts,
        Features,
        LaterPanel,
    ) -> Pin<Box<dyn Future<Output = Result<Vec<Option<Mounted>>, SplitLoaderError>>>>;

/// The panel. `owner` is the owner of the page.
pub(crate) fn later_panel(
    which: LaterPanel,
    features: Features,
    owner: StoredValue<WeakOwner>,
    load: Load,
) -> impl IntoView {
    let page = features.page;
    let place = NodeRef::<Div>::new();
    let mounted: StoredValue<Vec<Option<Mounted>>, LocalStorage> =
        StoredValue::new_local(Vec::new());
    let state = RwSignal::new(Absent::Loading);
    let load = move || {
        let element = place.get_untracked();
        let owner = owner.get_value().upgrade();
        let (Some(element), Some(owner)) = (element, owner) else {
            return;
        };
        state.set(Absent::Loading);
        spawn_local(async move {
            let elements = vec![element.into()];
            match load(Hosts { owner, elements }, features, which).await {
                // In another language meanwhile, they are dropped.
                Ok(sections) => drop(mounted.try_set_value(sections)),
                Err(_) => drop(state.try_set(Absent::Missing)),
            }
        });
    };
    effect(move || {
        if which.is_open(page) && mounted.with_value(Vec::is_empty) {
            load();
        }
    });
    which.framed(
        page,
        view! { <div node_ref=place>{notice(state, load)}</div> },
    )
}
