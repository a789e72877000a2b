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
        scale::Fitting,
        trace::Traces,
        view::{Reach, View},
    },
    model::{
        history::{History, ZERO_US},
        page::Page,
    },
    ui::{clock::page_now_ms, mathematics::limited},
};

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
    pub(crate) from_x: f64,
    pub(crate) view: View,
    /// Whether the pointer has moved too far for a click.
    pub(crate) begun: bool,
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
            GraphAction::Oldest => self.show(view.at_oldest(reach)),
            GraphAction::Newest => self.show(view.at_now(reach)),
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
