//! The animation loops: each calls back once a frame while something moves, and never while nothing moves.
//!
//! All loops share one request to the browser. Those that are due at nearly the same time run in the same frame: each
//! frame that the browser draws costs more than what changes in it.

use std::cell::{Cell, RefCell};
use std::rc::{Rc, Weak};

use leptos::prelude::window;
use leptos::wasm_bindgen::{JsCast, closure::Closure};

#[cfg(doc)]
use crate::ui::frame_rate::FrameRate;
use crate::ui::{
    clock::{page_now_ms, with_time_asleep},
    frame_rate::frame_rate,
    mathematics::modulo,
};

/// A loop that is due so soon after a frame runs in that frame.
const TOGETHER_MS: f64 = 8.0;
/// The time of a frame is up to one period of a screen with 60 Hz before the request for it.
const FRAME_EARLY_MS: f64 = 17.0;

/// The next call that a step requests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Next {
    /// In the next frame.
    Frame,
    /// After this number of milliseconds, or when woken.
    After(f64),
    /// When woken.
    Woken,
}

impl Next {
    /// At the next multiple of `period_ms`, which is itself a multiple of [`FrameRate::step_ms`].
    pub fn in_step(period_ms: f64, frame_ms: f64) -> Self {
        Self::After(FRAME_EARLY_MS).put_off(period_ms, frame_ms)
    }

    /// The same request, but not before the next multiple of [`FrameRate::step_ms`].
    pub fn put_off_to_step(self, frame_ms: f64) -> Self {
        self.put_off(frame_rate().step_ms(), frame_ms)
    }

    /// Puts it off to a multiple of `period_ms`. One within [`FRAME_EARLY_MS`] of this frame's time may have passed by now.
    fn put_off(self, period_ms: f64, frame_ms: f64) -> Self {
        match self {
            Self::After(ms) => {
                let ms = ms.max(FRAME_EARLY_MS);
                Self::After(ms + to_step(period_ms, frame_ms + ms))
            }
            other => other,
        }
    }

    /// When it is due, on the page's clock.
    fn due_ms(self, frame_ms: f64) -> f64 {
        match self {
            Self::Frame => f64::NEG_INFINITY,
            Self::After(ms) => frame_ms + ms,
            Self::Woken => f64::INFINITY,
        }
    }
}

fn to_step(period_ms: f64, at_ms: f64) -> f64 {
    period_ms - modulo(at_ms, period_ms)
}

/// Calls a step function with the time of the frame, as often as it requests. Dropping it stops the loop.
pub struct Frames(Rc<Loop>);

struct Loop {
    step: RefCell<Box<dyn FnMut(f64) -> Next>>,
    /// When the next step is due, on the page's clock. `-inf`: in the next frame; `inf`: when woken.
    due_ms: Cell<f64>,
}

impl Frames {
    /// Starts the loop with the next frame.
    pub fn new(step: impl FnMut(f64) -> Next + 'static) -> Self {
        Self::boxed(Box::new(step))
    }

    fn boxed(step: Box<dyn FnMut(f64) -> Next>) -> Self {
        let new = Rc::new(Loop {
            step: RefCell::new(step),
            due_ms: Cell::new(f64::NEG_INFINITY),
        });
        SCHEDULE.with(|schedule| {
            schedule.loops.borrow_mut().push(Rc::downgrade(&new));
            schedule.request();
        });
        Self(new)
    }

    /// A function that wakes the step. After the loop is dropped it does nothing.
    pub fn waker(&self) -> impl Fn() + 'static {
        let weak = Rc::downgrade(&self.0);
        move || wake(&weak, f64::NEG_INFINITY)
    }

    /// A function that wakes the step at the next multiple of [`FrameRate::step_ms`].
    pub fn waker_in_step(&self) -> impl Fn() + 'static {
        let weak = Rc::downgrade(&self.0);
        move || {
            let now_ms = page_now_ms();
            wake(&weak, now_ms + to_step(frame_rate().step_ms(), now_ms));
        }
    }
}

fn wake(weak: &Weak<Loop>, due_ms: f64) {
    let Some(woken) = weak.upgrade() else { return };
    if due_ms < woken.due_ms.get() {
        woken.due_ms.set(due_ms);
        SCHEDULE.with(Schedule::request);
    }
}

/// What all loops have requested of the browser.
struct Schedule {
    loops: RefCell<Vec<Weak<Loop>>>,
    on_frame: Closure<dyn FnMut(f64)>,
    on_timeout: Closure<dyn FnMut()>,
    frame_requested: Cell<bool>,
    /// The handle of a timeout that requests a frame, and when it does.
    timeout: Cell<Option<(i32, f64)>>,
}

thread_local! {
    static SCHEDULE: Schedule = Schedule {
        loops: RefCell::default(),
        on_frame: Closure::new(|browser_ms| SCHEDULE.with(|schedule| schedule.run(browser_ms))),
        on_timeout: Closure::new(|| SCHEDULE.with(|schedule| {
            schedule.timeout.set(None);
            schedule.request_frame();
        })),
        frame_requested: Cell::new(false),
        timeout: Cell::new(None),
    };
}

impl Schedule {
    /// Runs every loop that is due. The time is that of the frame by the browser's clock.
    fn run(&self, browser_ms: f64) {
        self.frame_requested.set(false);
        // Reading the clock first notices a sleep.
        let due_until_ms = page_now_ms() + TOGETHER_MS;
        let frame_ms = with_time_asleep(browser_ms);
        let mut loops = Vec::new();
        self.loops.borrow_mut().retain(|each| {
            let alive = each.upgrade();
            let is_alive = alive.is_some();
            loops.extend(alive);
            is_alive
        });
        for each in loops {
            if each.due_ms.get() > due_until_ms {
                continue;
            }
            each.due_ms.set(f64::INFINITY);
            // A running step cannot be entered again; it is called in the next frame.
            let next = each
                .step
                .try_borrow_mut()
                .map_or(Next::Frame, |mut step| step(frame_ms));
            // It may have been woken meanwhile.
            each.due_ms
                .set(next.due_ms(frame_ms).min(each.due_ms.get()));
        }
        self.request();
    }

    /// Requests a frame for the loop that is due first, or a timeout if it is due later.
    fn request(&self) {
        if self.frame_requested.get() {
            return;
        }
        let mut due_ms = f64::INFINITY;
        for each in self.loops.borrow().iter().filter_map(Weak::upgrade) {
            due_ms = due_ms.min(each.due_ms.get());
        }
        let timeout = self.timeout.take();
        if let Some((handle, at_ms)) = timeout {
            if at_ms <= due_ms && due_ms.is_finite() {
                // When it ends, the loops are asked again.
                self.timeout.set(timeout);
                return;
            }
            window().clear_timeout_with_handle(handle);
        }
        let wait_ms = due_ms - page_now_ms();
        if wait_ms <= 0.0 {
            self.request_frame();
        } else if wait_ms.is_finite() {
            self.request_timeout(wait_ms, due_ms);
        }
    }

    #[allow(
        clippy::cast_possible_truncation,
        reason = "it saturates: no loop waits for 24 days"
    )]
    fn request_timeout(&self, wait_ms: f64, due_ms: f64) {
        let on_timeout = self.on_timeout.as_ref().unchecked_ref();
        let handle = window().set_timeout_with_callback_and_timeout_and_arguments_0(
            on_timeout,
            wait_ms.ceil() as i32,
        );
        self.timeout.set(handle.ok().map(|handle| (handle, due_ms)));
    }

    /// Requests a frame. The browser calls none while the page is hidden.
    fn request_frame(&self) {
        let on_frame = self.on_frame.as_ref().unchecked_ref();
        let requested = window().request_animation_frame(on_frame).is_ok();
        self.frame_requested.set(requested);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_that_a_late_frame_has_missed_is_not_asked_for_again() {
        for (ms, frame_ms, due_ms) in [
            (5.0, 90.0, 150.0),
            (5.0, 120.0, 150.0),
            (40.0, 90.0, 150.0),
            (80.0, 90.0, 200.0),
        ] {
            let next = Next::After(ms).put_off_to_step(frame_ms);
            assert_eq!(next, Next::After(due_ms - frame_ms), "{ms} from {frame_ms}");
        }
        assert_eq!(Next::in_step(100.0, 90.0), Next::After(110.0));
    }
}
