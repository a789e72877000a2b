//! The state of the graph and the actions on it.

use std::{
    cell::{Cell, RefCell},
    ops::Deref,
    time::Duration,
};

use leptos::prelude::*;
use motorlink_messages::protocol::{Instant, MotorId};

use crate::{
    features::graph::plot::{
        columns::Grid,
        comparison::{Subject, motor_name},
        keys::GraphAction,
        layout::Layout,
        marks::{Events, Mark},
        scale::{Fitting, Scale, Scales},
        trace::{Trace, Traces},
        view::{Reach, View},
    },
    model::{
        history::{History, ZERO_US},
        page::Page,
    },
    ui::{clock::page_now_ms, mathematics::limited},
};

/// The least height and width of a box that is zoomed to, in CSS pixels.
const BOX_MIN_PX: f64 = 10.0;

/// The position of the crosshair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Crosshair {
    None,
    /// Under the pointer, in CSS pixels from the left of the graph.
    Pointer(f64),
    /// Moved by keys, at this time of the history's clock.
    Moment(u64),
}

/// A drag: its start in CSS pixels, and the view at its start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Drag {
    pub(crate) from: (f64, f64),
    pub(crate) view: View,
    /// The pane at its start, with its scale.
    pub(crate) pane: Option<Pane>,
    /// Whether it chooses a part to zoom to, instead of moving the view.
    pub(crate) is_box: bool,
    /// Whether the pointer has moved too far for a click.
    pub(crate) begun: bool,
}

/// A pane, its trace and its scale as it is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pane {
    pub(crate) place: usize,
    pub(crate) trace: Trace,
    pub(crate) scale: Scale,
}

/// A handle of the graph. The page has one graph for its whole life, in every language. It stays on the thread of the
/// page, so the store is local.
#[derive(Clone, Copy)]
pub(crate) struct Chart(StoredValue<&'static Parts, LocalStorage>);

impl Deref for Chart {
    type Target = Parts;

    fn deref(&self) -> &Parts {
        self.0.get_value()
    }
}

/// The state of the graph. Values that change with the pointer or the time are not signals.
pub(crate) struct Parts {
    pub(crate) page: Page,
    pub(crate) view: RwSignal<View>,
    pub(crate) traces: RwSignal<Traces>,
    pub(crate) fitting: RwSignal<Fitting>,
    /// Whether it takes the place of the whole desk.
    pub(crate) expanded: RwSignal<bool>,
    pub(crate) crosshair: Cell<Crosshair>,
    pub(crate) drag: Cell<Option<Drag>>,
    /// What happened to motors without a command.
    pub(crate) events: RefCell<Events>,
    /// The second cursor, at this time of the history's clock: the read-out has the difference to it.
    pub(crate) reference: RwSignal<Option<u64>>,
    /// Whether a drag zooms to what it encloses. With Shift it always does.
    pub(crate) zooms_box: RwSignal<bool>,
    /// The opposite corners of the part that a drag encloses, in CSS pixels.
    pub(crate) zoom_box: Cell<Option<[(f64, f64); 2]>>,
    /// The scales of the last drawing.
    pub(crate) scales: Cell<Scales>,
    /// The layout of the last drawing.
    pub(crate) layout: Cell<Layout>,
    /// The columns of the last drawing.
    pub(crate) grid: Cell<Grid>,
    /// Whether any part of it is visible.
    pub(crate) in_sight: Cell<bool>,
    /// Whether its size may have changed.
    pub(crate) size_stale: Cell<bool>,
    /// Whether its colours or the names of motors may have changed.
    pub(crate) looks_stale: Cell<bool>,
    /// Whether only new data can change it.
    pub(crate) asleep: Cell<bool>,
    wake: RefCell<Option<Box<dyn Fn()>>>,
}

impl Chart {
    pub(crate) fn new(page: Page) -> Self {
        let parts: &'static Parts = Box::leak(Box::new(Parts {
            page,
            view: RwSignal::new(View::default()),
            traces: RwSignal::new(Traces::default()),
            fitting: RwSignal::new(Fitting::default()),
            expanded: RwSignal::new(false),
            crosshair: Cell::new(Crosshair::None),
            drag: Cell::new(None),
            events: RefCell::default(),
            reference: RwSignal::new(None),
            zooms_box: RwSignal::new(false),
            zoom_box: Cell::new(None),
            scales: Cell::new(Scales::default()),
            layout: Cell::new(Layout::default()),
            grid: Cell::new(Grid::default()),
            in_sight: Cell::new(false),
            size_stale: Cell::new(true),
            looks_stale: Cell::new(true),
            asleep: Cell::new(false),
            wake: RefCell::new(None),
        }));
        Self(StoredValue::new_local(parts))
    }

    /// Resets what depends on the canvases: it is drawn on new ones.
    pub(crate) fn reset_drawing(self) {
        self.drag.set(None);
        self.zoom_box.set(None);
        if let Crosshair::Pointer(_) = self.crosshair.get() {
            self.crosshair.set(Crosshair::None);
        }
        self.in_sight.set(false);
        self.size_stale.set(true);
        self.looks_stale.set(true);
        self.asleep.set(false);
    }

    /// Sets `wake` as the function that requests the next frame.
    pub(crate) fn on_change(self, wake: impl Fn() + 'static) {
        *self.wake.borrow_mut() = Some(Box::new(wake));
    }

    /// Something visible may have changed.
    pub(crate) fn wake(self) {
        if let Some(wake) = self.wake.borrow().as_ref() {
            wake();
        }
    }

    /// Now on the clock of the history, in microseconds.
    pub(crate) fn now_us(self) -> u64 {
        self.at_us(page_now_ms())
    }

    /// A moment of the page's `performance.now()` on the clock of the history, in microseconds.
    pub(crate) fn at_us(self, page_ms: f64) -> u64 {
        let clock = self.page.worker.clock.get_value();
        ZERO_US + clock.instant(page_ms).as_micros()
    }

    /// The local time of day of a moment of the history, in microseconds since midnight.
    pub(crate) fn day_us(self, at_us: u64) -> u64 {
        let clock = self.page.worker.clock.get_value();
        match at_us.checked_sub(ZERO_US) {
            Some(at_us) => clock.day_us(Instant::from_micros(at_us)),
            None => clock.day_us_before(Duration::from_micros(ZERO_US - at_us)),
        }
    }

    /// The content of the graph.
    pub(crate) fn subject(self, history: &History) -> Subject {
        let (id, traces) = (
            self.page.selected.get_untracked(),
            self.traces.get_untracked(),
        );
        let names = self.page.motors.names;
        names.with_untracked(|names| Subject::new(history, names, id, traces))
    }

    /// The marks in these columns. Compared motors have none: they would be of several.
    pub(crate) fn marks(self, history: &History, subject: &Subject, grid: Grid) -> Vec<Mark> {
        match subject {
            Subject::Motor { id, mirror, .. } => {
                let events = self.events.borrow();
                let marks = |track| events.marks(*id, track, *mirror, grid);
                history.track(*id).map(marks).unwrap_or_default()
            }
            Subject::Compared(_) => Vec::new(),
        }
    }

    /// The name of a motor.
    pub(crate) fn motor_name(self, id: MotorId) -> String {
        let names = self.page.motors.names;
        names.with_untracked(|names| motor_name(id, names))
    }

    /// The limits of panning for the drawn motors.
    pub(crate) fn reach(self) -> Reach {
        let now_us = self.now_us();
        let oldest_us = self.page.history.with_value(|history| {
            let oldest = self.subject(history).oldest(history);
            oldest.map_or(now_us, Instant::as_micros)
        });
        Reach { oldest_us, now_us }
    }

    pub(crate) fn show(self, view: View) {
        if self.view.get_untracked() != view {
            self.view.set(view);
            self.wake();
        }
    }

    /// Pauses, or follows the present.
    pub(crate) fn pause_or_resume(self) {
        let view = self.view.get_untracked();
        if view.is_paused() {
            self.follow();
        } else {
            self.show(view.paused(self.now_us()));
        }
    }

    /// Follows the present.
    pub(crate) fn follow(self) {
        if let Crosshair::Moment(_) = self.crosshair.get() {
            self.crosshair.set(Crosshair::None);
        }
        self.show(self.view.get_untracked().live());
    }

    pub(crate) fn run(self, action: GraphAction) {
        let view = self.view.get_untracked();
        let reach = self.reach();
        match action {
            GraphAction::ZoomIn => self.zoom(80, self.zoom_place()),
            GraphAction::ZoomOut => self.zoom(125, self.zoom_place()),
            GraphAction::Pan(percent) => {
                let by_us = view.part_us(f64::from(percent) / 100.0);
                self.show(view.panned(by_us, reach));
            }
            GraphAction::Cross(columns) => self.move_crosshair(columns),
            GraphAction::Mark(by) => self.go_to_mark(by),
            GraphAction::Oldest => self.show(view.at_oldest(reach)),
            GraphAction::Newest => self.show(view.at_now(reach)),
            GraphAction::Values(percent) => {
                for trace in self.traces.get_untracked().panes() {
                    self.zoom_values(trace, percent.into(), 0.5);
                }
            }
            GraphAction::Fit => self.fit(self.fitting.get_untracked().fitted()),
        }
    }

    /// Pauses, and moves the crosshair to the mark before it, or to the one behind it.
    fn go_to_mark(self, later: bool) {
        let reach = self.reach();
        let view = self.view.get_untracked().paused(reach.now_us);
        let from_us = match self.crosshair.get() {
            Crosshair::Moment(at_us) => at_us,
            _ => view.right_us(reach.now_us),
        };
        let span_us = reach.now_us.saturating_sub(reach.oldest_us);
        // Its columns are no periods of the view: many of them end near its edges.
        let all = Grid::new(span_us, reach.now_us, 1_000);
        let marks = self.page.history.with_value(|history| {
            let subject = self.subject(history);
            self.marks(history, &subject, all)
        });
        let mut times = marks.iter().map(|mark| mark.at.as_micros());
        let found = if later {
            times.find(|at_us| *at_us > from_us)
        } else {
            times.rfind(|at_us| *at_us < from_us)
        };
        if let Some(at_us) = found {
            self.crosshair.set(Crosshair::Moment(at_us));
            self.show(view.showing(at_us, reach));
            self.wake();
        }
    }

    /// Chooses the scales in this way.
    pub(crate) fn fit(self, fitting: Fitting) {
        self.fitting.set(fitting);
        self.wake();
    }

    /// Follows the present in the window that it begins with, with every scale fitted to its values.
    pub(crate) fn reset(self) {
        self.fit(self.fitting.get_untracked().fitted());
        self.follow();
    }

    /// The pane at a height in CSS pixels.
    pub(crate) fn pane_at(self, y: f64) -> Option<(Pane, f64)> {
        let panes = self.traces.get_untracked().panes();
        let (place, at) = self.layout.get().pane_at(panes.len(), y)?;
        let trace = *panes.get(place)?;
        let scale = self.scales.get().of(trace);
        Some((
            Pane {
                place,
                trace,
                scale,
            },
            at,
        ))
    }

    /// Shows a percentage of the values of a trace; the value at `place` keeps its position.
    pub(crate) fn zoom_values(self, trace: Trace, percent: f64, place: f64) {
        let part = |end: f64| place + (end - place) * percent / 100.0;
        let fitting = self.fitting.get_untracked();
        // Several of them may come before the next drawing.
        let scale = fitting
            .zoomed(trace)
            .unwrap_or_else(|| self.scales.get().of(trace));
        let scale = scale.part(trace, (part(0.0), part(1.0)));
        self.fit(fitting.with(trace, scale));
    }

    /// Zooms to what a drag in a pane encloses. A narrow box zooms the values alone, a low one the time alone.
    pub(crate) fn zoom_to(self, pane: Pane, corners: [(f64, f64); 2]) {
        let [(from_x, from_y), (to_x, to_y)] = corners;
        let layout = self.layout.get();
        if (to_y - from_y).abs() >= BOX_MIN_PX {
            let count = self.traces.get_untracked().panes().len();
            let place = |y| limited(layout.place_in(count, pane.place, y), 0.0, 1.0);
            // The axis may have been fitted since the press.
            let scale = self.scales.get().of(pane.trace);
            let scale = scale.part(pane.trace, (place(from_y), place(to_y)));
            self.fit(self.fitting.get_untracked().with(pane.trace, scale));
        }
        if (to_x - from_x).abs() >= BOX_MIN_PX {
            let view = self.view.get_untracked();
            self.show(view.part((layout.part(from_x), layout.part(to_x)), self.reach()));
        }
    }

    /// Zooms to a percentage of the length; `place` keeps its position, 0 at the left edge, 1 at the right.
    pub(crate) fn zoom(self, percent: u64, place: f64) {
        let view = self.view.get_untracked();
        self.show(view.zoomed(percent, place, self.reach()));
    }

    /// The centre of a zoom by keys: the crosshair, or the newest value without one.
    fn zoom_place(self) -> f64 {
        match self.crosshair.get() {
            Crosshair::Moment(at_us) => {
                let layout = self.layout.get();
                layout.part(layout.x(self.grid.get().place(at_us)))
            }
            Crosshair::None | Crosshair::Pointer(_) => 1.0,
        }
    }

    /// Places the second cursor at the crosshair, or in the middle of the view without one; or removes it.
    pub(crate) fn place_reference(self, on: bool) {
        let at_us = match self.crosshair.get() {
            Crosshair::Moment(at_us) => at_us,
            _ => self
                .grid
                .get()
                .moment_us(f64::from(self.layout.get().columns()) / 2.0),
        };
        self.move_reference(on.then_some(at_us));
    }

    pub(crate) fn move_reference(self, at_us: Option<u64>) {
        self.reference.set(at_us);
        self.wake();
    }

    /// Moves the crosshair. It starts in the middle, and moves the view at the edges.
    fn move_crosshair(self, columns: i8) {
        let (grid, layout) = (self.grid.get(), self.layout.get());
        let width = f64::from(layout.columns());
        let place = match self.crosshair.get() {
            Crosshair::None => width / 2.0,
            Crosshair::Pointer(x) => layout.column(x),
            Crosshair::Moment(at_us) => grid.place(at_us),
        };
        let reach = self.reach();
        let place = limited(place, 0.0, width) + f64::from(columns);
        let at_us = grid.moment_us(place);
        let at_us = at_us.clamp(reach.oldest_us.min(reach.now_us), reach.now_us);
        self.crosshair.set(Crosshair::Moment(at_us));
        let beyond = if place < 0.0 {
            place
        } else {
            (place - width).max(0.0)
        };
        let view = self.view.get_untracked();
        let by_us = view.part_us(beyond / width.max(1.0));
        self.show(view.panned(by_us, reach));
        self.wake();
    }
}
