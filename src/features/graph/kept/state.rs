//! The kept run, and what is chosen. It stays through a change of language and through another recording or connection,
//! so it belongs to no component.

use std::{cell::RefCell, rc::Rc};

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::protocol::{Instant, MotorId};

use crate::{
    features::graph::{
        kept::alignment::{Align, shift_us},
        plot::ticks,
        state::Chart,
    },
    model::{history::History, mirror::Mirror, snapshot::Session},
};

/// A run of one motor: what the graph knew of it when it was kept.
pub(crate) struct Run {
    pub(super) id: MotorId,
    pub(super) mirror: Mirror,
    pub(super) history: History,
    /// The right edge of the graph then: events after it are not meant.
    until: Instant,
    name: String,
}

/// The kept run at its place under the shown one.
#[derive(Clone)]
pub(crate) struct Aligned {
    pub(super) run: Rc<Run>,
    /// It is this much earlier than the shown run.
    pub(super) shift_us: i64,
    /// Another number for another run.
    number: u32,
}

impl Aligned {
    /// What the drawing depends on.
    pub(crate) const fn drawn_as(&self) -> (u32, i64) {
        (self.number, self.shift_us)
    }

    /// Its name in a legend.
    pub(crate) fn name(&self) -> String {
        tr!("Kept: {name}", name = &self.run.name)
    }
}

/// What the row of the kept run shows.
#[derive(Clone, Copy)]
pub(super) struct Shown {
    /// The name of the run; empty without one.
    pub(super) name: RwSignal<String>,
    /// Whether one of the two runs has no such event.
    pub(super) is_missing: RwSignal<bool>,
}

#[derive(Default)]
struct State {
    run: Option<Rc<Run>>,
    number: u32,
    align: Align,
    by_ms: i32,
    shown: Option<Shown>,
}

thread_local! {
    static STATE: RefCell<State> = RefCell::default();
}

/// Shows the state in these signals from now on.
pub(super) fn show_in(shown: Shown) {
    let name = STATE.with_borrow_mut(|state| {
        state.shown = Some(shown);
        state.run.as_ref().map(|run| run.name.clone())
    });
    shown.name.set(name.unwrap_or_default());
}

/// What is chosen: the event, and the shift by hand in milliseconds.
pub(super) fn chosen() -> (Align, i32) {
    STATE.with_borrow(|state| (state.align, state.by_ms))
}

pub(super) fn choose(chart: Chart, align: Align, by_ms: i32) {
    STATE.with_borrow_mut(|state| (state.align, state.by_ms) = (align, by_ms));
    chart.wake();
}

/// Keeps what the graph knows of the shown motor, instead of an earlier run.
pub(super) fn keep(chart: Chart) {
    let id = chart.page.selected.get_untracked();
    let Some(history) = chart.page.history.with_value(|history| history.copy_of(id)) else {
        return;
    };
    let until_us = chart.view.get_untracked().right_us(chart.now_us());
    let time = ticks::time_of_day(chart.day_us(until_us) / 1_000, 1_000);
    let motor = chart.motor_name(id);
    let name = if chart.page.latest.with_value(Session::is_recording) {
        tr!("{motor}, recording, {time}", motor, time)
    } else {
        tr!("{motor}, live, {time}", motor, time)
    };
    let mirror = chart
        .page
        .motors
        .names
        .with_untracked(|names| names.mirror(id));
    set(
        chart,
        Some(Run {
            id,
            mirror,
            history,
            until: Instant::from_micros(until_us),
            name,
        }),
    );
}

pub(super) fn remove(chart: Chart) {
    set(chart, None);
}

fn set(chart: Chart, run: Option<Run>) {
    let name = run.as_ref().map(|run| run.name.clone()).unwrap_or_default();
    let shown = STATE.with_borrow_mut(|state| {
        state.run = run.map(Rc::new);
        state.number = state.number.wrapping_add(1);
        state.by_ms = 0;
        state.shown
    });
    if let Some(shown) = shown {
        let _ = shown.is_missing.try_set(false);
        let _ = shown.name.try_set(name);
    }
    chart.wake();
}

/// The kept run under what is shown of this motor up to a time; `None` without one, or if an event is missing.
pub(crate) fn aligned(history: &History, id: MotorId, until_us: u64) -> Option<Aligned> {
    let (aligned, shown) = STATE.with_borrow(|state| {
        let run = state.run.as_ref()?;
        let until = Instant::from_micros(until_us);
        let moment = |history: &History, id, until| state.align.last(history.track(id)?, until);
        let of_both = moment(&run.history, run.id, run.until).zip(moment(history, id, until));
        let aligned = of_both.map(|(kept, now)| Aligned {
            run: Rc::clone(run),
            shift_us: shift_us(kept, now) + i64::from(state.by_ms) * 1_000,
            number: state.number,
        });
        Some((aligned, state.shown))
    })?;
    if let Some(shown) = shown {
        let is_missing = aligned.is_none();
        if shown.is_missing.try_get_untracked() == Some(!is_missing) {
            shown.is_missing.set(is_missing);
        }
    }
    aligned
}
