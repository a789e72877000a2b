//! The list `Packets`: hears the scroll bar, and paints once a frame while anything changes.

use std::rc::Rc;

use leptos::{html::Div, prelude::*};
use motorlink_i18n::tr;
use wasm_bindgen::{JsCast, prelude::Closure};
use web_sys::{HtmlElement, ResizeObserver};

use crate::{
    features::{
        packet_log::{
            feed::LogFeed,
            painter::{Painter, scroll_px},
        },
        recording::texts as words,
    },
    link::clock::page_now_ms,
    model::desk::{Desk, use_desk},
    ui::{
        animation::{Frames, Next},
        button::PressButton,
        format::grouped,
        reactive::{follow, heard, live, memo},
    },
};

/// A person who has not moved the scroll bar for so long, in milliseconds, has it in hand no more.
const IN_HAND_MS: f64 = 250.0;

/// Log `Packets` and button `Back to the newest`.
#[component]
pub(crate) fn PacketList() -> impl IntoView {
    let desk = use_desk();
    let recorder = desk.recorder;
    let scroller = NodeRef::<Div>::new();
    let extent = NodeRef::<Div>::new();
    let rows = NodeRef::<Div>::new();
    let touched_ms = StoredValue::new(f64::NEG_INFINITY);
    // Dropped with the component, and with them every frame and call that is still to come.
    let frames = StoredValue::new_local(None::<Frames>);
    let size = StoredValue::new_local(None::<SizeWatch>);

    follow(move || {
        let (Some(scroller), Some(extent), Some(rows)) = (scroller.get(), extent.get(), rows.get())
        else {
            return;
        };
        let scroller: HtmlElement = scroller.into();
        // The view may be that of a list that was here before.
        recorder.feed.update_value(|feed| feed.view.mounted());
        size.set_value(SizeWatch::of(&scroller, desk));
        let mut painter = Painter::new(scroller, extent.into(), rows.into());
        let running = Frames::new(move |_| {
            let idle_ms = page_now_ms() - touched_ms.try_get_value().unwrap_or_default();
            let paint = |feed: &mut LogFeed| painter.paint(feed, idle_ms < IN_HAND_MS);
            let Some(behind) = recorder.feed.try_update_value(paint) else {
                return Next::Woken;
            };
            desk.show_log();
            desk.look();
            if behind {
                Next::After(IN_HAND_MS - idle_ms)
            } else {
                Next::Woken
            }
        });
        let (waker, in_step) = (running.waker(), running.waker_in_step());
        recorder
            .feed
            .update_value(|feed| feed.on_news(Rc::new(waker), Rc::new(in_step)));
        frames.set_value(Some(running));
    });

    let touch = move || touched_ms.set_value(page_now_ms());
    let scroll = move |_| {
        if let Some(scroller) = scroller.get_untracked()
            && desk.log_scrolled(&scroller)
        {
            touch();
        }
    };
    let nothing = move || {
        let alive = recorder.alive.get();
        recorder.log.with(|log| words::of_no_rows(log, alive))
    };
    let back = memo(move || recorder.log.with(|log| (log.following, log.new_rows)));
    let back_reads = move || match back.get() {
        (_, 0) => tr!("Back to the newest").to_owned(),
        (_, new) => tr!("Back to the newest · {count} new", count = grouped(new)),
    };
    view! {
        <div class="packet-list">
            <div
                class="packet-scroller"
                role="log"
                aria-label=tr!("Packets")
                aria-live="off"
                tabindex="0"
                node_ref=scroller
                on:scroll=heard(scroll)
                // Before the list begins to move, and be it by a key that is only now pressed.
                on:keydown=heard(move |_| touch())
                on:wheel=heard(move |_| touch())
                on:pointerdown=heard(move |_| touch())
            >
                <div class="packet-extent" node_ref=extent>
                    <div class="packet-window">
                        <div class="packet-rows" node_ref=rows></div>
                    </div>
                </div>
            </div>
            <p class="packet-none quiet" hidden=live(move || nothing().is_empty())>
                {live(nothing)}
            </p>
            <span class="packet-back" hidden=live(move || back.get().0)>
                <PressButton
                    label=Signal::derive(back_reads)
                    name=tr!("Back to the newest")
                    class="button small"
                    on_press=move || desk.follow_log(true)
                />
            </span>
        </div>
    }
}

impl Desk {
    /// Stays with the newest rows, or where it is.
    pub(crate) fn follow_log(self, follow: bool) {
        self.recorder.feed.update_value(|feed| {
            if follow {
                feed.view.follow();
            } else {
                feed.view.let_go();
            }
            feed.wake();
        });
    }

    /// The scroll bar was moved, or the list was given another size, which moves it too. Whether a
    /// person did it.
    fn log_scrolled(self, scroller: &HtmlElement) -> bool {
        let hear = |feed: &mut LogFeed| {
            let place_px = scroll_px(scroller);
            let by_person = if feed.view.resize(width_of(scroller), height_of(scroller)) {
                feed.view.stands_at(place_px);
                false
            } else {
                feed.view.scrolled(place_px)
            };
            feed.wake();
            by_person
        };
        self.recorder.feed.try_update_value(hear).unwrap_or(false)
    }

    /// Says of the log what it is now.
    fn show_log(self) {
        let state = self.recorder.feed.with_value(LogFeed::state);
        if self.recorder.log.get_untracked() != state {
            self.recorder.log.set(state);
        }
    }
}

fn width_of(element: &HtmlElement) -> u32 {
    u32::try_from(element.client_width()).unwrap_or(0)
}

fn height_of(element: &HtmlElement) -> u32 {
    u32::try_from(element.client_height()).unwrap_or(0)
}

/// Tells the desk of every size of the list, from the first on.
struct SizeWatch {
    observer: ResizeObserver,
    _on_size: Closure<dyn FnMut()>,
}

impl SizeWatch {
    fn of(scroller: &HtmlElement, desk: Desk) -> Option<Self> {
        let watched = scroller.clone();
        let on_size = Closure::<dyn FnMut()>::new(move || {
            desk.log_scrolled(&watched);
        });
        let observer = ResizeObserver::new(on_size.as_ref().unchecked_ref()).ok()?;
        observer.observe(scroller);
        Some(Self {
            observer,
            _on_size: on_size,
        })
    }
}

impl Drop for SizeWatch {
    fn drop(&mut self) {
        self.observer.disconnect();
    }
}
