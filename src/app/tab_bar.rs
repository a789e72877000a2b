//! The tab bar of a phone: which part of the page is on the screen. Wide screens show every part and no tab bar.

use leptos::prelude::*;
use motorlink_i18n::tr;

use crate::{
    model::page::{Page, use_page},
    ui::{
        drawer::Drawer,
        reactive::{dynamic, effect, handler},
    },
};

/// The attribute of the root element with the chosen screen, which the style sheet reads. Without it, and on a wide
/// screen, the page is laid out as for [`Screen::Drive`].
const ATTRIBUTE: &str = "data-screen";

/// What a phone shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Screen {
    /// State, wheel, figures and controls.
    Drive,
    Graph,
    /// The packet log and the recording.
    Log,
    /// All motors, and the panel that drives them together.
    Motors,
    /// Everything else.
    More,
}

impl Screen {
    const ALL: [Self; 5] = [
        Self::Drive,
        Self::Graph,
        Self::Log,
        Self::Motors,
        Self::More,
    ];

    const fn key(self) -> &'static str {
        match self {
            Self::Drive => "drive",
            Self::Graph => "graph",
            Self::Log => "log",
            Self::Motors => "motors",
            Self::More => "more",
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Drive => tr!("Drive" as "screen"),
            Self::Graph => tr!("Graph"),
            Self::Log => tr!("Log"),
            Self::Motors => tr!("Motors"),
            Self::More => tr!("More"),
        }
    }

    /// The screen that is chosen already: a change of language mounts the tab bar a second time.
    fn present() -> Self {
        let root = document().document_element();
        let key = root.and_then(|root| root.get_attribute(ATTRIBUTE));
        let known = |screen: &Self| key.as_deref() == Some(screen.key());
        Self::ALL.into_iter().find(known).unwrap_or(Self::Drive)
    }
}

/// Navigation `Screens`.
#[component]
pub(crate) fn TabBar() -> impl IntoView {
    let page = use_page();
    let screen = RwSignal::new(Screen::present());
    follow(page, screen);
    let choose = move |chosen: Screen| {
        screen.set(chosen);
        let together = Some(Drawer::Together);
        page.drawer
            .set(together.filter(|_| chosen == Screen::Motors));
        window().scroll_to_with_x_and_y(0.0, 0.0);
    };
    let buttons = Screen::ALL.map(|one| {
        let current = move || if screen.get() == one { "page" } else { "false" };
        view! {
            <button
                type="button"
                class="tab-bar-button"
                aria-current=dynamic(current)
                on:click=handler(move |_| choose(one))
            >
                {one.name()}
            </button>
        }
    });
    view! {
        <nav
            class="tab-bar"
            aria-label=tr!("Screens")
            inert=dynamic(move || page.is_behind_dialog())
        >
            {buttons.collect_view()}
        </nav>
    }
}

/// Shows the controls again where an action opened one of their tabs, or where the panel of the motors was closed.
fn follow(page: Page, screen: RwSignal<Screen>) {
    let mut open = None;
    effect(move || {
        let tab = page.loops.tab.get();
        if open.replace(tab).is_some_and(|before| before != tab) {
            screen.set(Screen::Drive);
        }
    });
    effect(move || {
        let is_open = page.drawer.get() == Some(Drawer::Together);
        if !is_open && screen.get_untracked() == Screen::Motors {
            screen.set(Screen::Drive);
        }
    });
    effect(move || {
        if let Some(root) = document().document_element() {
            // It fails for names that are none.
            let _ = root.set_attribute(ATTRIBUTE, screen.get().key());
        }
    });
}
