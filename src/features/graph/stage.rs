//! The canvases and their animation loop: drawn with the screen, at most 60 times a second, and only if something
//! visible has changed: see `pace`.

use std::{cell::RefCell, rc::Rc};

use leptos::prelude::*;
use wasm_bindgen::JsCast;
use web_sys::{HtmlCanvasElement, HtmlElement};

use crate::{
    features::graph::{
        axes::{Axes, Picture},
        description::{Content, Description},
        kept::state::{Aligned, aligned},
        legend::Legend,
        overlay::Overlay,
        pace::{DRAWN_EVERY_MS, Pace, SETTLED_AFTER_US, after},
        plot::{
            columns::Grid,
            comparison::{Comparison, Subject},
            layout::Layout,
            marks::{Events, Mark},
            palette::{Palette, parse_colour},
            scale::{Fitting, Scales},
            view::View,
        },
        state::Chart,
        traces::{TraceCanvas, Tracing},
        watchers::{self, Watchers},
    },
    model::history::History,
    ui::{
        animation::{Frames, Next},
        clock::page_now_ms,
    },
};

/// Everything except the colours that the lines depend on. They are drawn again only if it differs.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Scene {
    /// `None` while the view is empty.
    grid: Option<Grid>,
    subject: Subject,
    view: View,
    /// Whether every reply of these columns has arrived.
    settled: bool,
    /// Number of recalled older replies.
    recalled: u32,
    /// The kept run and its place.
    kept: Option<(u32, i64)>,
    fitting: Fitting,
    /// Number of events.
    events: usize,
}

/// The mounted graph.
pub(crate) struct Stage {
    plot: HtmlElement,
    pub(crate) axes: Axes,
    pub(crate) lines: TraceCanvas,
    pub(crate) scales: Scales,
    pub(crate) overlay: Overlay,
    legend: Legend,
    description: Description,
    /// The marks of the last drawing.
    marks: Rc<[Mark]>,
    pub(crate) palette: Palette,
    pub(crate) layout: Layout,
    scene: Option<Scene>,
    /// The comparison in the legend.
    named: Option<Comparison>,
    drawn_ms: f64,
    pace: Pace,
    /// When the newest values were written.
    pub(crate) read_ms: f64,
    stopwatch: watchers::Stopwatch,
    _watchers: Watchers,
}

/// The graph while it is mounted. Frames and the picture borrow it, never both at once.
pub(crate) type StageCell = StoredValue<Rc<RefCell<Option<Stage>>>, LocalStorage>;

/// Mounts the graph in this element until its owner is dropped.
pub(crate) fn mount(chart: Chart, mounted: StageCell, place: &HtmlElement) {
    let cell = mounted.get_value();
    let Some(stage) = Stage::of(chart, place) else {
        return;
    };
    *cell.borrow_mut() = Some(stage);
    let frames = Frames::new(move |frame_ms| step(chart, &cell, frame_ms));
    let waker = Rc::new(frames.waker());
    chart.on_change({
        let waker = Rc::clone(&waker);
        move || waker()
    });
    chart.page.history.update_value(|history| {
        history.on_new_data(Rc::new(move |update| {
            let mut events = chart.events.borrow_mut();
            let before = events.count();
            let has_news = if let Some(update) = update {
                events.take(update);
                !update.samples.is_empty() || events.count() != before
            } else {
                // Other motors may have these IDs now: those of a recording, or of another line.
                *events = Events::default();
                true
            };
            if has_news && chart.asleep.get() {
                waker();
            }
        }));
    });
    // Redraw for another motor, theme or name.
    Effect::new(move |_| {
        let _ = (chart.page.selected.get(), chart.page.preferences.get());
        chart.page.motors.names.track();
        chart.looks_stale.set(true);
        chart.wake();
    });
    let frames = StoredValue::new_local(Some(frames));
    on_cleanup(move || {
        let _ = frames.try_update_value(Option::take);
        // Otherwise the history would wake a graph that no longer exists.
        let forget = |history: &mut History| history.on_new_data(Rc::new(|_| ()));
        let _ = chart.page.history.try_update_value(forget);
        // This drops the observers too.
        let _ = mounted.try_get_value().and_then(|cell| cell.take());
    });
}

fn step(chart: Chart, cell: &RefCell<Option<Stage>>, frame_ms: f64) -> Next {
    chart.asleep.set(false);
    if !chart.in_sight.get() || document().hidden() {
        return Next::Woken;
    }
    let Ok(mut stage) = cell.try_borrow_mut() else {
        return Next::Woken;
    };
    let next = stage.as_mut().map(|stage| stage.step(chart, frame_ms));
    next.unwrap_or(Next::Woken)
}

impl Stage {
    /// `None` if the element does not contain the elements of the view.
    fn of(chart: Chart, place: &HtmlElement) -> Option<Self> {
        let find = |selector: &str| place.query_selector(selector).ok().flatten();
        let canvas = |selector: &str| {
            let canvas = find(selector)?.dyn_into::<HtmlCanvasElement>().ok()?;
            // It has the size of the plot. Within the flow it would make the plot larger in turn.
            let style = HtmlElement::style(&canvas);
            style.set_property("position", "absolute").ok()?;
            Some(canvas)
        };
        let plot: HtmlElement = find(".graph-plot")?.dyn_into().ok()?;
        Some(Self {
            axes: Axes::of(canvas(".graph-axes")?)?,
            lines: TraceCanvas::of(canvas(".graph-lines")?)?,
            scales: Scales::default(),
            overlay: Overlay::of(place)?,
            legend: Legend::of(&place.parent_element()?)?,
            description: Description::of(find("#graph-words")?),
            marks: Rc::default(),
            palette: Palette::default(),
            layout: Layout::default(),
            scene: None,
            named: None,
            drawn_ms: f64::NEG_INFINITY,
            pace: Pace::default(),
            read_ms: f64::NEG_INFINITY,
            stopwatch: watchers::Stopwatch::new(),
            _watchers: Watchers::of(chart, &plot),
            plot,
        })
    }

    /// Draws a graph that was never visible.
    pub(crate) fn draw_first(&mut self, chart: Chart) {
        if self.layout.is_empty() {
            let _ = self.step(chart, page_now_ms());
        }
    }

    fn step(&mut self, chart: Chart, frame_ms: f64) -> Next {
        if frame_ms < self.drawn_ms + DRAWN_EVERY_MS {
            return Next::Frame;
        }
        if chart.size_stale.take() && self.resize(chart) {
            self.scene = None;
        }
        let looks_stale = chart.looks_stale.take();
        if looks_stale && self.read_palette() {
            self.scene = None;
        }
        if self.layout.is_empty() {
            return Next::Woken;
        }
        let now_us = chart.at_us(frame_ms);
        let view = chart.view.get_untracked();
        let grid = Grid::new(view.span_us, view.right_us(now_us), self.layout.columns());
        chart.grid.set(grid);
        chart.page.history.with_value(|history| {
            let subject = chart.subject(history);
            self.name(chart, &subject, looks_stale);
            let selected = chart.page.selected.get_untracked();
            let kept = aligned(history, selected, grid.right_us());
            let scene = Scene {
                grid: Some(grid).filter(|grid| subject.is_seen(history, *grid)),
                subject,
                view,
                settled: now_us >= grid.right_us() + SETTLED_AFTER_US,
                recalled: history.recalled(),
                kept: kept.as_ref().map(Aligned::drawn_as),
                fitting: chart.fitting.get_untracked(),
                events: chart.events.borrow().count(),
            };
            if self.scene != Some(scene) {
                self.scene = Some(scene);
                self.drawn_ms = frame_ms;
                self.stopwatch.start();
                self.draw_lines(history, scene, kept.clone(), grid, now_us);
                self.marks = chart.marks(history, &subject, grid).into();
                self.draw_axes(chart, view, grid);
                self.stopwatch.stop();
                chart.scales.set(self.scales);
            }
            let marks = Rc::clone(&self.marks);
            let shown = Content {
                history,
                subject: &subject,
                kept: kept.as_ref(),
                marks: &marks,
            };
            self.overlay.show_box(chart.zoom_box.get());
            self.show_crosshair(chart, view, grid, shown, now_us, frame_ms);
            let next = self
                .description
                .update(chart, view, shown, now_us, frame_ms);
            chart.asleep.set(view.is_live() && scene.grid.is_none());
            match scene.grid {
                Some(grid) if view.is_live() => {
                    self.pace.next_column(chart, grid, now_us, frame_ms)
                }
                Some(grid) if !scene.settled => after(grid.right_us() + SETTLED_AFTER_US, now_us),
                _ => next,
            }
        })
    }

    /// Adopts the size of its element. Returns whether it has changed.
    fn resize(&mut self, chart: Chart) -> bool {
        let place = self.plot.get_bounding_client_rect();
        let layout = Layout::new(place.width(), place.height(), window().device_pixel_ratio());
        if layout == self.layout {
            return false;
        }
        self.adopt(chart, layout);
        true
    }

    fn adopt(&mut self, chart: Chart, layout: Layout) {
        self.layout = layout;
        chart.layout.set(layout);
        self.axes.resize(layout);
        self.lines.resize(layout);
    }

    /// Draws the graph in another size: that of a picture, and then that of the screen again. The browser shows
    /// nothing in between.
    pub(crate) fn draw_at(&mut self, chart: Chart, layout: Layout) {
        let resized = chart.size_stale.take();
        self.adopt(chart, layout);
        self.scene = None;
        self.drawn_ms = f64::NEG_INFINITY;
        let _ = self.step(chart, page_now_ms());
        chart.size_stale.set(resized);
    }

    /// Reads the palette from the custom properties of the theme, which the style sheet registers as colours.
    /// Returns whether it has changed.
    fn read_palette(&mut self) -> bool {
        let Ok(Some(style)) = window().get_computed_style(&self.plot) else {
            return false;
        };
        let of = |name: &str| parse_colour(&style.get_property_value(name).unwrap_or_default());
        let palette = Palette {
            surface: of("--surface"),
            line: of("--line"),
            text: of("--text-quiet"),
            speed: of("--speed"),
            current: of("--current"),
            temperature: of("--heat"),
            position: of("--position"),
            motors: self.legend.motor_colours(),
        };
        self.axes
            .set_font(&style.get_property_value("font-family").unwrap_or_default());
        let changed = palette != self.palette;
        self.palette = palette;
        changed
    }

    /// Names the compared motors if they or their names have changed.
    fn name(&mut self, chart: Chart, subject: &Subject, renamed: bool) {
        let comparison = subject.comparison();
        if !renamed && self.named.as_ref() == comparison {
            return;
        }
        self.named = comparison.copied();
        let motors = comparison.into_iter().flat_map(Comparison::motors);
        let names: Vec<(usize, String)> = motors
            .map(|(place, id, _)| (place, chart.motor_name(id)))
            .collect();
        for (place, name) in &names {
            self.overlay.name(*place, name);
        }
        self.legend.show(comparison, &names);
    }

    fn draw_lines(
        &mut self,
        history: &History,
        scene: Scene,
        kept: Option<Aligned>,
        grid: Grid,
        now_us: u64,
    ) {
        self.lines.clear(self.axes.font(self.layout.ratio));
        let mut tracing = Tracing {
            surface: &mut self.lines,
            scales: &mut self.scales,
            fitting: scene.fitting,
            layout: self.layout,
            palette: self.palette,
            kept,
        };
        tracing.draw(history, &scene.subject, grid, now_us);
    }

    fn draw_axes(&mut self, chart: Chart, view: View, grid: Grid) {
        let picture = Picture::of(
            chart,
            view,
            (grid, &self.marks),
            self.layout,
            self.palette,
            self.scales,
        );
        self.axes.draw(picture);
    }
}
