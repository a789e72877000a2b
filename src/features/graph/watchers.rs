//! Observers of the graph's size, visibility and theme, and a stopwatch for the browser's measurements.

use js_sys::Function;
use leptos::prelude::*;
use wasm_bindgen::{JsCast, prelude::Closure};
use web_sys::{
    Element, EventTarget, IntersectionObserver, IntersectionObserverEntry, MediaQueryList,
    Performance, ResizeObserver, ResizeObserverBoxOptions, ResizeObserverOptions,
};

use crate::{features::graph::state::Chart, ui::listener::on_window};

/// The observers. Dropping it disconnects them.
pub(crate) struct Watchers {
    resize: Option<ResizeObserver>,
    sight: Option<IntersectionObserver>,
    /// What decides the colours of the page.
    looks: [Option<MediaQueryList>; 2],
    _on_resize: Closure<dyn FnMut()>,
    _on_sight: Closure<dyn FnMut(js_sys::Array)>,
    on_looks: Closure<dyn FnMut()>,
}

impl Watchers {
    /// Starts the observers.
    pub(crate) fn of(chart: Chart, plot: &Element) -> Self {
        let resized = move || {
            chart.size_stale.set(true);
            chart.wake();
        };
        // The pixel density changes with the browser's zoom and between screens.
        on_window("resize", move |_| resized());
        on_window("visibilitychange", move |_| chart.wake());
        let on_resize = Closure::<dyn FnMut()>::new(resized);
        let resize = ResizeObserver::new(on_resize.as_ref().unchecked_ref()).ok();
        if let Some(resize) = &resize {
            let options = ResizeObserverOptions::new();
            // This size changes with the density too. If the browser does not support it, only this call fails.
            options.set_box(ResizeObserverBoxOptions::DevicePixelContentBox);
            resize.observe_with_options(plot, &options);
        }
        let on_sight = Closure::<dyn FnMut(js_sys::Array)>::new(move |entries: js_sys::Array| {
            let last = entries.pop().dyn_into::<IntersectionObserverEntry>();
            if let Ok(last) = last {
                chart.in_sight.set(last.is_intersecting());
                chart.wake();
            }
        });
        let sight = IntersectionObserver::new(on_sight.as_ref().unchecked_ref()).ok();
        // Nothing is drawn before the first report, which comes at once: on a phone the graph is below the visible
        // part, and its first drawing is the longest task of the page's start.
        match &sight {
            Some(sight) => sight.observe(plot),
            None => chart.in_sight.set(true),
        }
        let on_looks = Closure::<dyn FnMut()>::new(move || {
            chart.looks_stale.set(true);
            chart.wake();
        });
        let looks = ["(prefers-color-scheme: dark)", "(prefers-contrast: more)"];
        let looks = looks.map(|query| window().match_media(query).ok().flatten());
        for list in looks.iter().flatten() {
            let target: &EventTarget = list;
            let callback = on_looks.as_ref().unchecked_ref();
            // Without it the graph keeps its colours until the next drawing for another reason.
            let _ = target.add_event_listener_with_callback("change", callback);
        }
        Self {
            resize,
            sight,
            looks,
            _on_resize: on_resize,
            _on_sight: on_sight,
            on_looks,
        }
    }
}

impl Drop for Watchers {
    fn drop(&mut self) {
        if let Some(resize) = &self.resize {
            resize.disconnect();
        }
        if let Some(sight) = &self.sight {
            sight.disconnect();
        }
        for list in self.looks.iter().flatten() {
            let target: &EventTarget = list;
            let callback = self.on_looks.as_ref().unchecked_ref();
            // A listener that cannot be removed was never added.
            let _ = target.remove_event_listener_with_callback("change", callback);
        }
    }
}

/// The name of the measurement of a drawing.
const MEASURE: &str = "graph-draw";
/// The mark of its start.
const MARK: &str = "graph-draw-begin";

/// With `?measure` in the address, the browser records how long each drawing took. It is off by default because the
/// browser keeps these records until the page closes.
pub(crate) struct Stopwatch(Option<Performance>);

impl Stopwatch {
    pub(crate) fn new() -> Self {
        let wanted = window().location().search().is_ok_and(|query| {
            web_sys::UrlSearchParams::new_with_str(&query)
                .is_ok_and(|parameters| parameters.has("measure"))
        });
        Self(window().performance().filter(|_| wanted))
    }

    pub(crate) fn start(&self) {
        if let Some(performance) = &self.0 {
            // It fails for reserved names only.
            let _ = performance.mark(MARK);
        }
    }

    pub(crate) fn stop(&self) {
        if let Some(performance) = &self.0 {
            // web-sys has this overload only with its unstable interfaces, which native builds do not enable.
            let measure = js_sys::Reflect::get(performance, &"measure".into());
            if let Ok(measure) = measure.and_then(JsCast::dyn_into::<Function>) {
                let _ = measure.call2(performance, &MEASURE.into(), &MARK.into());
            }
            performance.clear_marks_with_mark_name(MARK);
        }
    }
}
