//! Mounts the page, section by section.
//!
//! A browser compiles the code of a section when it first runs. On a phone all sections at once would block the page
//! for a second. So each section is mounted in its own turn of the event loop. The header comes first and can be used
//! at once. The frame in index.html covers the rest until it is complete, so nothing shifts. The sections of the other
//! parts follow after the first paint, each in the place that its placeholder reserves.

use std::{
    pin::Pin,
    task::{Context, Waker},
    time::Duration,
};

use gloo_timers::future::sleep;
use leptos::{
    html::{Div, Main},
    prelude::*,
    task::spawn_local,
};
use wasm_bindgen::JsCast;
use web_sys::HtmlElement;

use crate::{
    app::{
        absent::Absent,
        features::Features,
        frame::frame,
        mount::{Hosts, Mounted, mount},
        parts::Part,
        sections::{Area, Frame, SECTIONS, Section},
    },
    ui::reactive::{dynamic, effect},
};

/// Where the sections are mounted.
#[derive(Clone, Copy, Default)]
struct Areas {
    top: NodeRef<Div>,
    above_desk: NodeRef<Div>,
    desk: NodeRef<Main>,
    dialogs: NodeRef<Div>,
}

impl Areas {
    fn clear(self) {
        for area in [Area::Top, Area::AboveDesk, Area::Desk, Area::Dialogs] {
            if let Some(element) = self.element(area) {
                element.set_text_content(None);
            }
        }
    }

    /// `None` after the page is closed, or before the section with that area is mounted.
    fn element(self, area: Area) -> Option<HtmlElement> {
        Some(match area {
            Area::Top => self.top.get_untracked()?.into(),
            Area::AboveDesk => self.above_desk.get_untracked()?.into(),
            Area::Desk => self.desk.get_untracked()?,
            Area::TabPanels => {
                let panels = self.desk.get_untracked()?.query_selector(".tab-panels");
                panels.ok()??.dyn_into().ok()?
            }
            Area::Dialogs => self.dialogs.get_untracked()?.into(),
        })
    }
}

/// A section whose part is not loaded yet.
struct Waiting {
    part: Part,
    host: HtmlElement,
    state: RwSignal<Absent>,
    _frame: Mounted,
}

/// The state of mounting.
#[derive(Clone, Copy)]
struct Assembly {
    features: Features,
    areas: Areas,
    /// The owner of the page; weak, because it owns this value.
    owner: StoredValue<WeakOwner>,
    /// Number of mounted sections and placeholders, in the order of `SECTIONS`.
    added: StoredValue<usize>,
    sections: StoredValue<Vec<Mounted>, LocalStorage>,
    waiting: StoredValue<Vec<Waiting>, LocalStorage>,
    /// Number of the current round: a change of language begins another round.
    round: StoredValue<u32>,
    complete: RwSignal<bool>,
    /// Whether sections wait for their parts.
    partial: RwSignal<bool>,
}

impl Assembly {
    fn is_over(self, round: u32) -> bool {
        self.round.try_get_value() != Some(round)
    }

    /// Adds the next section or its placeholder. `None` if the page is closed or in another language, or if all are
    /// mounted.
    fn add_next(self, round: u32) -> Option<()> {
        if self.is_over(round) {
            return None;
        }
        let (place, section) = SECTIONS.get(self.added.get_value())?;
        let place = self.areas.element(*place)?;
        match section {
            Section::Now(mount) => {
                let section = mount(place, self.features);
                self.sections.update_value(|all| all.push(section));
            }
            Section::Later(part, frame) => self.add_frame(&place, *part, *frame, round)?,
        }
        self.added.update_value(|added| *added += 1);
        Some(())
    }

    fn add_frame(self, place: &HtmlElement, part: Part, shape: Frame, round: u32) -> Option<()> {
        let host: HtmlElement = document().create_element("div").ok()?.dyn_into().ok()?;
        host.set_class_name("late");
        place.append_child(&host).ok()?;
        let state = RwSignal::new(Absent::Loading);
        let retry = move || self.retry(part, round);
        let features = self.features;
        let frame = mount(&host, move || frame(shape, features, state, retry));
        self.waiting.update_value(|all| {
            all.push(Waiting {
                part,
                host,
                state,
                _frame: frame,
            });
        });
        Some(())
    }

    /// Adds the others, each in its own turn, and then shows the page.
    fn add_others(self, round: u32) {
        if self.add_next(round).is_some() {
            in_the_next_turn(move || self.add_others(round));
        } else if self.added.try_get_value() == Some(SECTIONS.len()) {
            if let Some(frame) = document().get_element_by_id("starting") {
                frame.remove();
            }
            self.complete.set(true);
            self.fetch_parts(round);
        }
    }

    /// Mounts the sections of loaded parts at once, and fetches the other parts.
    fn mount_parts(self, round: u32) {
        for part in Part::ALL {
            let mut fetch: Pin<Box<dyn Future<Output = ()>>> = Box::pin(self.fetch(part, round));
            let mut context = Context::from_waker(Waker::noop());
            if fetch.as_mut().poll(&mut context).is_pending() {
                spawn_local(fetch);
            }
        }
    }

    /// Fetches the parts one after the other, each when the page is idle.
    fn fetch_parts(self, round: u32) {
        spawn_local(async move {
            for part in Part::ALL {
                // A hidden page is idle, and its timers run once a second.
                if !document().hidden() {
                    sleep(Duration::ZERO).await;
                }
                if self.is_over(round) {
                    return;
                }
                self.fetch(part, round).await;
            }
        });
    }

    fn retry(self, part: Part, round: u32) {
        spawn_local(async move { self.fetch(part, round).await });
    }

    /// Fetches a part, and mounts its sections in place of their placeholders.
    async fn fetch(self, part: Part, round: u32) {
        let states = self.of_part(part, |waiting| waiting.state);
        for state in &states {
            state.set(Absent::Loading);
        }
        let hosts = self.of_part(part, |waiting| waiting.host.clone());
        let focused = hosts.iter().find(|host| has_focus(host)).cloned();
        let Some(owner) = self.owner.try_get_value().and_then(|weak| weak.upgrade()) else {
            return;
        };
        let mounted = part
            .mount(
                Hosts {
                    owner,
                    elements: hosts,
                },
                self.features,
            )
            .await;
        if self.is_over(round) {
            return;
        }
        match mounted {
            Ok(sections) => {
                self.sections
                    .update_value(|all| all.extend(sections.into_iter().flatten()));
                self.waiting
                    .update_value(|all| all.retain(|waiting| waiting.part != part));
                self.partial
                    .set(self.waiting.with_value(|all| !all.is_empty()));
                if let Some(host) = focused {
                    focus_first(&host);
                }
            }
            Err(_) => {
                for state in states {
                    state.set(Absent::Missing);
                }
            }
        }
    }

    fn of_part<T>(self, part: Part, read: impl Fn(&Waiting) -> T) -> Vec<T> {
        self.waiting.with_value(|all| {
            let of_part = all.iter().filter(|waiting| waiting.part == part);
            of_part.map(read).collect()
        })
    }
}

fn has_focus(host: &HtmlElement) -> bool {
    let focused = document().active_element();
    focused.is_some_and(|element| host.contains(Some(&element)))
}

/// Restores the focus after a placeholder that had it was removed.
fn focus_first(host: &HtmlElement) {
    let first = host.query_selector("button, input, select, [tabindex]");
    if let Some(first) = first.ok().flatten()
        && let Ok(first) = first.dyn_into::<HtmlElement>()
    {
        // If the element cannot be focused, the browser decides.
        let _ = first.focus();
    }
}

/// The page without its sections, which are mounted one by one until it is `complete`, and again in another
/// language. As a reactive view, every element would need update code: a fifth of the whole program.
pub(crate) fn assembled(features: Features, complete: RwSignal<bool>) -> impl IntoView {
    let areas = Areas::default();
    let assembly = Assembly {
        features,
        areas,
        owner: StoredValue::new(Owner::current().unwrap_or_default().downgrade()),
        added: StoredValue::new(0),
        sections: StoredValue::new_local(Vec::new()),
        waiting: StoredValue::new_local(Vec::new()),
        round: StoredValue::new(0),
        complete,
        partial: RwSignal::new(true),
    };
    let begin = move || {
        let round = assembly.round.get_value() + 1;
        assembly.round.set_value(round);
        // First remove the old ones with their listeners.
        assembly.sections.set_value(Vec::new());
        assembly.waiting.set_value(Vec::new());
        assembly.added.set_value(0);
        assembly.partial.set(true);
        areas.clear();
        if assembly.complete.get_untracked() {
            // STOP cannot be pressed until it is mounted again.
            while assembly.add_next(round).is_some() {}
            assembly.mount_parts(round);
        } else {
            if round > 1 {
                // The language was chosen in the header, which is mounted first.
                let _ = assembly.add_next(round);
            }
            in_the_next_turn(move || assembly.add_others(round));
        }
    };
    effect(move || {
        features.page.language.track();
        untrack(begin);
    });
    let behind_dialog = move || features.page.is_behind_dialog();
    view! {
        <div
            class="page"
            class:incomplete=dynamic(move || !assembly.complete.get())
            class:partial=dynamic(move || assembly.partial.get())
            class:unconnected=dynamic(move || features.page.shows_first_screen())
        >
            <div class="top" node_ref=areas.top></div>
            <div class="above-desk" inert=behind_dialog node_ref=areas.above_desk></div>
            <div class="desk-place" inert=behind_dialog>
                // The skip link leads here.
                <main class="desk" id="control" tabindex="-1" node_ref=areas.desk></main>
            </div>
            <div class="dialogs" node_ref=areas.dialogs></div>
        </div>
    }
}

/// Runs a function in the next turn of the event loop, for the same owner if there is one. On a hidden page it
/// runs at once, because timers run once a second then.
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
