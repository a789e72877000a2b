//! The component: the picture, and below it the motion as text and figures.

use std::{cell::Cell, rc::Rc};

use leptos::prelude::*;
use leptos::svg::Svg;
use leptos::web_sys::Element;
use motorlink_i18n::tr;
use motorlink_messages::protocol::family::Model;

use crate::{
    features::telemetry::twin::{
        TwinFeed,
        feed::View,
        look::Look,
        painter::Painter,
        picture::{VIEW_BOX, picture},
        texts::{Figures, Motion},
    },
    link::clock::Clock,
    ui::{
        animation::{Frames, Next},
        frame_rate::frame_rate,
    },
};

/// Figures change at most ten times a second, so that they can be read.
const FIGURES_PERIOD_MS: f64 = 100.0;
/// How often an invisible picture checks whether it is visible.
const UNSEEN_PERIOD_MS: f64 = 250.0;
/// How often a visible picture checks whether it still is.
const SIGHT_PERIOD_MS: f64 = 250.0;

/// The wheel as the motor reports it: angle, speed, direction, state and goal.
///
/// `feed` is written by the page and read here once a frame.
#[component]
pub(crate) fn DigitalTwin(
    /// The data of the motor.
    feed: StoredValue<TwinFeed, LocalStorage>,
    /// Whose wheel it is.
    model: Memo<Model>,
    /// When the wheel is shown.
    clock: StoredValue<Clock>,
) -> impl IntoView {
    let svg = NodeRef::<Svg>::new();
    let motion = RwSignal::new(Motion::NoData);
    let figures = RwSignal::new(None::<Figures>);
    // Dropped with the component; this cancels the next frame.
    let frames = StoredValue::new_local(None::<Frames>);

    // The picture is drawn when it is mounted and for another model; its motion needs no reactivity.
    Effect::new(move |_| {
        let Some(svg) = svg.get() else { return };
        let wheel = Look::of(model.get());
        svg.set_inner_html(&picture(wheel));
        let Some(mut painter) = Painter::of(&svg, wheel) else {
            return;
        };
        let mut sight = Sight::default();
        let mut written_ms = f64::NEG_INFINITY;
        // While the wheel turns, the clock triggers the updates, and new data does not.
        let asleep = Rc::new(Cell::new(false));
        let sleeps = Rc::clone(&asleep);
        let running = Frames::new(move |now_ms| {
            let clock = clock.try_get_value().unwrap_or_default();
            let Some(view) = feed.try_update_value(|feed| feed.view_at(clock, now_ms)) else {
                return Next::Woken;
            };
            painter.paint(&view, now_ms);
            set_if_changed(motion, view.motion);
            let due_ms = written_ms + FIGURES_PERIOD_MS - now_ms;
            if due_ms <= 0.0 {
                written_ms = now_ms;
                set_if_changed(figures, view.figures);
            }
            if !sight.of(&svg, now_ms) {
                return Next::After(UNSEEN_PERIOD_MS);
            }
            sleeps.set(view.pose.settled);
            next(&view, figures.get_untracked() == view.figures, now_ms)
        });
        let waker = running.waker();
        // Wakes with new data in the frame after it, so that many replies make one frame.
        let on_new_data = move || {
            if asleep.replace(false) {
                waker();
            }
        };
        feed.update_value(|feed| feed.on_new_data(Rc::new(on_new_data)));
        frames.set_value(Some(running));
    });

    let figure = move |text: fn(Figures) -> String| {
        move || figures.get().map_or_else(|| "\u{2013}".to_owned(), text)
    };
    view! {
        <figure class="twin" class:twin-stale=move || motion.get() == Motion::NoData>
            <svg
                class="twin-dial"
                role="img"
                aria-label=tr!("Digital twin")
                viewBox=VIEW_BOX
                node_ref=svg
            ></svg>
            <figcaption class="twin-caption">
                // No live region: a wheel that creeps about zero would be announced without end.
                <output class="twin-motion" aria-label=tr!("Motion") aria-live="off">
                    {move || motion.get().text()}
                </output>
                <span class="twin-figures">
                    <span class="twin-figure-speed">{figure(Figures::speed_text)}</span>
                    <span class="twin-figure-angle">{figure(Figures::angle_text)}</span>
                    <span class="twin-figure-turns">{figure(Figures::turns_text)}</span>
                </span>
            </figcaption>
        </figure>
    }
}

/// Writes a signal only when it changes.
fn set_if_changed<T: PartialEq + Clone + Send + Sync + 'static>(signal: RwSignal<T>, value: T) {
    if signal.get_untracked() != value {
        signal.set(value);
    }
}

/// When this view changes without new data.
fn next(view: &View, figures_written: bool, now_ms: f64) -> Next {
    if !view.pose.settled {
        return Next::in_step(frame_rate().step_ms(), now_ms);
    }
    if !figures_written {
        return Next::in_step(FIGURES_PERIOD_MS, now_ms);
    }
    match view.fresh_until_ms {
        // The data is stale one millisecond later.
        Some(until_ms) if until_ms >= now_ms => Next::After(until_ms - now_ms + 1.0),
        _ => Next::Woken,
    }
}

/// Whether the picture is in the visible part of the page.
#[derive(Default)]
struct Sight {
    seen: bool,
    looked_ms: f64,
}

impl Sight {
    /// The query forces a layout, so it is made a few times a second.
    fn of(&mut self, element: &Element, now_ms: f64) -> bool {
        if !self.seen || now_ms - self.looked_ms >= SIGHT_PERIOD_MS {
            self.looked_ms = now_ms;
            let place = element.get_bounding_client_rect();
            let height = window().inner_height().ok().and_then(|it| it.as_f64());
            self.seen = place.width() > 0.0
                && place.bottom() > 0.0
                && height.is_none_or(|height| place.top() < height);
        }
        self.seen
    }
}
