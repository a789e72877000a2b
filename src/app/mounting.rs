//! The page put together, part by part.
//!
//! A browser compiles the code of a part when it first runs, and on a phone all of them at once would hold
//! it up for a second in which nothing is heard and nothing painted. So each part is mounted by itself, and
//! the browser gets its turn in between. The header comes first and can be used at once. The frame in index.html
//! lies over the rest until all of it is there: what comes into view comes once, and nothing shifts.

use std::{any::Any, time::Duration};

use leptos::{
    html::{Div, Main},
    prelude::*,
    tachys::view::Mountable,
};
use wasm_bindgen::JsCast;
use web_sys::HtmlElement;

use crate::{
    app::{features::Features, header::Header, question_dialog::QuestionDialog},
    features::{
        drive::{ControlPanel, current::CurrentTab, position::PositionTab, velocity::VelocityTab},
        graph::Graph,
        groups::panel::TogetherPanel,
        help::{HelpDialog, tour::Wanted, tour_view::TourNotice},
        ids::view::IdManagerTab,
        install::texts,
        link_doctor::panel::LinkPanel,
        motors::strip::MotorStrip,
        notices::Notices,
        packet_log::PacketLog,
        raw::view::RawHexTab,
        recording::Recording,
        saved_session::view::{SavedSessionNotice, is_hidden},
        settings::panel::{InstallButton, SettingsPanel},
        stop::dialog::StoppedDialog,
        telemetry::{Telemetry, twin::panel::WheelPanel},
    },
    model::page::Page,
    ui::reactive::{dynamic, effect},
};

/// Where parts are mounted, in the order in which they stand on the page.
#[derive(Clone, Copy)]
enum Place {
    Top,
    AboveDesk,
    Desk,
    TabPanels,
    Dialogs,
}

/// A part, and where it is mounted: behind those that are there already.
type Part = (Place, fn(HtmlElement, Features) -> Mounted);

/// Keeps a part alive.
type Mounted = (Owner, Box<dyn Any>);

/// In the order in which they come: what is looked at first comes first.
const PARTS: [Part; 20] = [
    (Place::Top, |place, features| {
        mount(place, move || {
            let behind_dialog = Signal::derive(move || is_behind_dialog(features.page));
            view! { <Header features behind_dialog /> }
        })
    }),
    (Place::Desk, |place, _| mount(place, ControlPanel)),
    (Place::TabPanels, |place, features| {
        mount(
            place,
            move || view! { <VelocityTab drive=features.drive /> },
        )
    }),
    (Place::TabPanels, |place, features| {
        mount(place, move || view! { <CurrentTab drive=features.drive /> })
    }),
    (Place::TabPanels, |place, features| {
        mount(
            place,
            move || view! { <PositionTab drive=features.drive /> },
        )
    }),
    (Place::TabPanels, |place, features| {
        mount(place, move || view! { <IdManagerTab ids=features.ids /> })
    }),
    (Place::TabPanels, |place, features| {
        mount(place, move || view! { <RawHexTab raw=features.raw /> })
    }),
    (Place::Desk, |place, features| {
        mount(
            place,
            move || view! { <WheelPanel readings=features.readings /> },
        )
    }),
    (Place::Desk, |place, features| {
        mount(
            place,
            move || view! { <Telemetry readings=features.readings /> },
        )
    }),
    (Place::Desk, |place, features| {
        mount(place, move || notices(features))
    }),
    (Place::Desk, |place, features| {
        mount(place, move || view! { <PacketLog log=features.log /> })
    }),
    (Place::Desk, |place, features| {
        mount(place, move || view! { <Graph chart=features.chart /> })
    }),
    (Place::Desk, |place, _| mount(place, Recording)),
    (Place::Desk, |place, _| mount(place, StoppedDialog)),
    (Place::AboveDesk, |place, _| mount(place, MotorStrip)),
    (Place::AboveDesk, |place, features| {
        mount(place, move || {
            view! { <LinkPanel page=features.page virtual_wire=features.virtual_wire /> }
        })
    }),
    (Place::AboveDesk, |place, features| {
        mount(
            place,
            move || view! { <TogetherPanel groups=features.groups /> },
        )
    }),
    (Place::AboveDesk, |place, features| {
        mount(place, move || settings_panel(features))
    }),
    (Place::Dialogs, |place, features| {
        mount(place, move || view! { <HelpDialog tour=features.tour /> })
    }),
    (Place::Dialogs, |place, features| {
        mount(place, move || view! { <QuestionDialog features /> })
    }),
];

/// The notices, with the saved session and the tour among them.
fn notices(features: Features) -> impl IntoView {
    let wanted = move || features.tour.with(|tour| tour.wanted);
    let is_alone = move || is_hidden(features.saved_session) && wanted() != Wanted::Asked;
    let on_action = Box::leak(Box::new(move |action| features.run_tour_action(action)));
    let on_remedy = Box::leak(Box::new(move |remedy| features.remedy(remedy)));
    view! {
        <Notices
            is_alone=Signal::derive(is_alone)
            is_tour_shown=Signal::derive(move || wanted() != Wanted::No)
            on_remedy
            saved_session=view! { <SavedSessionNotice saved=features.saved_session /> }
            tour=view! { <TourNotice page=features.page tour=features.tour on_action /> }
        />
    }
}

fn settings_panel(features: Features) -> impl IntoView {
    let install = Box::leak(Box::new(InstallButton {
        disabled_reason: Box::new(move || features.install.install_blocked_by()),
        hint: texts::hint(),
        on_press: Box::new(move || features.install.install()),
    }));
    view! { <SettingsPanel settings=features.settings install /> }
}

fn mount<V: IntoView + 'static>(place: HtmlElement, part: impl FnOnce() -> V + 'static) -> Mounted {
    let build = move || -> Box<dyn Any> {
        let mut view = part().into_view().build();
        view.mount(&place, None);
        Box::new(view)
    };
    mount_boxed(Box::new(build))
}

/// All parts share the code of this.
fn mount_boxed(build: Box<dyn FnOnce() -> Box<dyn Any>>) -> Mounted {
    let owner = Owner::new();
    let view = owner.with(build);
    (owner, view)
}

fn is_behind_dialog(page: Page) -> bool {
    page.dialog.with(Option::is_some)
}

/// Where the parts are mounted.
#[derive(Clone, Copy, Default)]
struct Places {
    top: NodeRef<Div>,
    above_desk: NodeRef<Div>,
    desk: NodeRef<Main>,
    dialogs: NodeRef<Div>,
}

impl Places {
    fn clear(self) {
        for place in [Place::Top, Place::AboveDesk, Place::Desk, Place::Dialogs] {
            if let Some(element) = self.element(place) {
                element.set_text_content(None);
            }
        }
    }

    /// `None` once the page is gone, or before the part that has the place.
    fn element(self, place: Place) -> Option<HtmlElement> {
        Some(match place {
            Place::Top => self.top.get_untracked()?.into(),
            Place::AboveDesk => self.above_desk.get_untracked()?.into(),
            Place::Desk => self.desk.get_untracked()?,
            Place::TabPanels => {
                let panels = self.desk.get_untracked()?.query_selector(".tab-panels");
                panels.ok()??.dyn_into().ok()?
            }
            Place::Dialogs => self.dialogs.get_untracked()?.into(),
        })
    }
}

/// What the page is put together with.
#[derive(Clone, Copy)]
struct Assembly {
    features: Features,
    places: Places,
    parts: StoredValue<Vec<Mounted>, LocalStorage>,
    /// Which language this is, counted: what was begun in another is not gone on with.
    round: StoredValue<u32>,
    complete: RwSignal<bool>,
}

impl Assembly {
    /// Adds the part that is next. `None` when the page is gone or in another language, and when all are there.
    fn add_next(self, round: u32) -> Option<()> {
        if self.round.try_get_value() != Some(round) {
            return None;
        }
        let (place, mount) = PARTS.get(self.parts.with_value(Vec::len))?;
        let part = mount(self.places.element(*place)?, self.features);
        self.parts.update_value(|parts| parts.push(part));
        Some(())
    }

    /// Adds the others, each in a turn of its own, and then shows the page.
    fn add_others(self, round: u32) {
        if self.add_next(round).is_some() {
            in_the_next_turn(move || self.add_others(round));
        } else if self.parts.try_with_value(Vec::len) == Some(PARTS.len()) {
            if let Some(frame) = document().get_element_by_id("starting") {
                frame.remove();
            }
            self.complete.set(true);
        }
    }
}

/// The page without its parts, which come one by one until it is `complete`, and anew in another language. As
/// a view that changes they would bring along, for every element, the code that changes it: a fifth of the
/// whole program.
pub(crate) fn assembled(features: Features, complete: RwSignal<bool>) -> impl IntoView {
    let places = Places::default();
    let assembly = Assembly {
        features,
        places,
        parts: StoredValue::new_local(Vec::new()),
        round: StoredValue::new(0),
        complete,
    };
    let begin = move || {
        let round = assembly.round.get_value() + 1;
        assembly.round.set_value(round);
        // First the old ones, with all that listens for them.
        assembly.parts.set_value(Vec::new());
        places.clear();
        if assembly.complete.get_untracked() {
            // STOP is out of reach until it stands again.
            while assembly.add_next(round).is_some() {}
        } else {
            if round > 1 {
                // The header, which the language was chosen in, is back before anybody misses its STOP.
                let _ = assembly.add_next(round);
            }
            in_the_next_turn(move || assembly.add_others(round));
        }
    };
    effect(move || {
        features.page.language.track();
        untrack(begin);
    });
    let behind_dialog = move || is_behind_dialog(features.page);
    view! {
        <div class="page" class:incomplete=dynamic(move || !assembly.complete.get())>
            <div class="top" node_ref=places.top></div>
            <div class="above-desk" inert=behind_dialog node_ref=places.above_desk></div>
            <main class="desk" inert=behind_dialog node_ref=places.desk></main>
            <div class="dialogs" node_ref=places.dialogs></div>
        </div>
    }
}

/// Does this in the next turn of the page's own, for the same owner if there is one; at once where nobody sees
/// the page, since timers come once a second then.
pub(crate) fn in_the_next_turn(act: impl FnOnce() + 'static) {
    if document().hidden() {
        act();
        return;
    }
    let owner = Owner::current();
    let turn = move || match owner {
        Some(owner) => owner.with(act),
        None => act(),
    };
    set_timeout(turn, Duration::ZERO);
}
