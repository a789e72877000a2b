//! The list `Packets`: handles the scroll bar, and draws once per frame of the screen while anything changes.

use std::rc::Rc;

use leptos::{html::Div, prelude::*};
use motorlink_i18n::tr;
use wasm_bindgen::JsCast;
use web_sys::{Element, FocusEvent, HtmlButtonElement, HtmlElement, KeyboardEvent};

use crate::{
    features::packet_log::{actions::Log, feed::LogFeed, painter::Painter, texts},
    model::replay::{self, Crossing},
    ui::{
        animation::{Frames, Next},
        button::PressButton,
        clock::page_now_ms,
        format::grouped,
        reactive::{dynamic, effect, handler, memo},
        size_watch::SizeWatch,
    },
};

/// The user has released the scroll bar if it has not moved for this time, in milliseconds.
const IN_HAND_MS: f64 = 250.0;

/// Log `Packets` and button `Jump to newest`.
#[component]
pub(crate) fn PacketList(log: Log) -> impl IntoView {
    let scroller = NodeRef::<Div>::new();
    let extent = NodeRef::<Div>::new();
    let rows = NodeRef::<Div>::new();
    let touched_ms = StoredValue::new(f64::NEG_INFINITY);
    // Dropped with the component, which cancels pending frames and calls.
    let frames = StoredValue::new_local(None::<Frames>);
    let size = StoredValue::new_local(None::<SizeWatch>);

    effect(move || {
        let (Some(scroller), Some(extent), Some(rows)) = (scroller.get(), extent.get(), rows.get())
        else {
            return;
        };
        let scroller: HtmlElement = scroller.into();
        // The view may be from an earlier list.
        log.feed.update_value(|feed| feed.view.mounted());
        // The log is told of the size, now and after changes.
        let watched = scroller.clone();
        size.set_value(SizeWatch::of(&scroller, move || {
            log.scrolled(&watched);
        }));
        let mut painter = Painter::new(scroller, extent.into(), rows.into());
        let running = Frames::new(move |_| {
            let idle_ms = page_now_ms() - touched_ms.try_get_value().unwrap_or_default();
            let paint = |feed: &mut LogFeed| painter.paint(feed, idle_ms < IN_HAND_MS);
            let Some(behind) = log.feed.try_update_value(paint) else {
                return Next::Woken;
            };
            log.show();
            log.request_rows();
            if behind {
                Next::After(IN_HAND_MS - idle_ms)
            } else {
                Next::Woken
            }
        });
        let (waker, in_step) = (running.waker(), running.waker_in_step());
        log.feed
            .update_value(|feed| feed.on_new_data(Rc::new(waker), Rc::new(in_step)));
        frames.set_value(Some(running));
    });

    let passed_by_tab = StoredValue::new(false);
    // Who scrolls or presses in the list reads it.
    let touch = move |passes: bool| {
        touched_ms.set_value(page_now_ms());
        passed_by_tab.update_value(|passed| *passed &= passes);
    };
    let scroll = move |_| {
        if let Some(scroller) = scroller.get_untracked()
            && log.scrolled(&scroller)
        {
            touch(true);
        }
    };
    let (row_entered, list_left) = on_focus(log, passed_by_tab);
    let nothing = move || {
        let alive = log.page.recorder.alive.get();
        log.state.with(|state| texts::of_no_rows(state, alive))
    };
    view! {
        <div
            class="packet-list"
            // Tab goes through the list to the next control. The list then follows the newest rows as before.
            on:focusout=handler(list_left)
        >
            <div
                class="packet-scroller"
                role="log"
                aria-label=tr!("Packets")
                aria-live="off"
                tabindex="0"
                node_ref=scroller
                on:scroll=handler(scroll)
                // Before the list starts to move, for example by a key.
                on:keydown=handler(move |event: KeyboardEvent| {
                    let key = event.key();
                    let moves = ["Arrow", "Page", "Home", "End", " ", "Enter"];
                    touch(!moves.iter().any(|name| key.starts_with(name)));
                })
                on:wheel=handler(move |_| touch(false))
                on:pointerdown=handler(move |_| touch(false))
            >
                <div class="packet-extent" node_ref=extent>
                    <div class="packet-window">
                        <div
                            class="packet-rows"
                            node_ref=rows
                            on:click=handler(move |event| {
                                if let Some(row) = toggled_row(&event) {
                                    passed_by_tab.set_value(false);
                                    log.toggle(row);
                                } else if let Some(row) = pressed_row(&event) {
                                    replay::keeps(Crossing::Row(row));
                                }
                            })
                            // A row that moves under the pointer, or takes the focus along, presses nothing.
                            on:focusin=handler(row_entered)
                        ></div>
                    </div>
                </div>
            </div>
            <p class="packet-none quiet" hidden=dynamic(move || nothing().is_empty())>
                {dynamic(nothing)}
            </p>
            <BackToNewest log />
        </div>
    }
}

/// Button `Jump to newest`, while the list does not follow.
#[component]
fn BackToNewest(log: Log) -> impl IntoView {
    let back = memo(move || log.state.with(|state| (state.following, state.new_rows)));
    let back_reads = move || match back.get() {
        (_, 0) => tr!("Jump to newest").to_owned(),
        (_, new) => tr!("Jump to newest · {count} new", count = grouped(new)),
    };
    view! {
        <span class="packet-back" hidden=dynamic(move || back.get().0)>
            <PressButton
                label=Signal::derive(back_reads)
                name=tr!("Jump to newest")
                class="button small"
                on_press=move || log.follow(true)
            />
        </span>
    }
}

/// What the focus does on a row, and when it leaves the list.
fn on_focus(
    log: Log,
    passed_by_tab: StoredValue<bool>,
) -> (impl Fn(FocusEvent) + Copy, impl Fn(FocusEvent) + Copy) {
    let row_entered = move |event: FocusEvent| {
        if is_reached_by_key(&event) && log.state.with_untracked(|state| state.following) {
            passed_by_tab.set_value(true);
        }
        log.follow(false);
    };
    let list_left = move |event: FocusEvent| {
        if !stays_in_list(&event) && passed_by_tab.try_update_value(std::mem::take) == Some(true) {
            log.follow(true);
        }
    };
    (row_entered, list_left)
}

fn is_reached_by_key(event: &FocusEvent) -> bool {
    let target = event.target().and_then(|at| at.dyn_into::<Element>().ok());
    target.is_some_and(|target| target.matches(":focus-visible") == Ok(true))
}

/// Whether the focus goes to another row, or to the button back to the newest: it is hidden when the list follows.
fn stays_in_list(event: &FocusEvent) -> bool {
    let next = event.related_target();
    let next = next.and_then(|at| at.dyn_into::<Element>().ok());
    next.is_none_or(|next| matches!(next.closest(".packet-list"), Ok(Some(_))))
}

/// The pressed row: its button has its number.
fn pressed_row(event: &web_sys::MouseEvent) -> Option<u64> {
    let pressed = event.target()?.dyn_into::<Element>().ok()?;
    let row = pressed.closest(".packet").ok()??;
    row.last_element_child()?
        .get_attribute("value")?
        .parse()
        .ok()
}

/// The row of the pressed button.
fn toggled_row(event: &web_sys::MouseEvent) -> Option<u64> {
    let button = event.target()?.dyn_into::<HtmlButtonElement>().ok()?;
    button.value().parse().ok()
}
