//! The animation loop: calls back once a frame while something moves, and never while nothing moves.

use std::cell::{Cell, RefCell};
use std::rc::{Rc, Weak};
use std::time::Duration;

use leptos::prelude::{TimeoutHandle, set_timeout_with_handle, window};
use leptos::wasm_bindgen::{JsCast, closure::Closure};

#[cfg(doc)]
use crate::ui::frame_rate::FrameRate;
use crate::ui::{clock::page_now_ms, frame_rate::frame_rate};

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
    pub fn in_step(period_ms: f64, now_ms: f64) -> Self {
        Self::After(to_step(period_ms, now_ms))
    }

    /// The same request, but not before the next multiple of [`FrameRate::step_ms`].
    pub fn put_off_to_step(self, now_ms: f64) -> Self {
        match self {
            Self::After(ms) => Self::After(ms + to_step(frame_rate().step_ms(), now_ms + ms)),
            other => other,
        }
    }
}

fn to_step(period_ms: f64, now_ms: f64) -> f64 {
    period_ms - now_ms.rem_euclid(period_ms)
}

/// Calls a step function with the time of the frame, as often as it requests. Dropping it stops the loop.
pub struct Frames(Rc<Inner>);

/// A closure that the browser calls with the time of the frame.
type OnFrame = Closure<dyn FnMut(f64)>;

struct Inner {
    step: RefCell<Box<dyn FnMut(f64) -> Next>>,
    on_frame: RefCell<Option<OnFrame>>,
    frame: Cell<Option<i32>>,
    timeout: Cell<Option<TimeoutHandle>>,
}

impl Frames {
    /// Starts the loop with the next frame.
    pub fn new(step: impl FnMut(f64) -> Next + 'static) -> Self {
        let inner = Rc::new(Inner {
            step: RefCell::new(Box::new(step)),
            on_frame: RefCell::new(None),
            frame: Cell::new(None),
            timeout: Cell::new(None),
        });
        let weak = Rc::downgrade(&inner);
        *inner.on_frame.borrow_mut() = Some(Closure::new(move |now_ms| {
            if let Some(inner) = weak.upgrade() {
                inner.step(now_ms);
            }
        }));
        inner.request_frame();
        Self(inner)
    }

    /// A function that wakes the step. After the loop is dropped it does nothing.
    pub fn waker(&self) -> impl Fn() + 'static {
        let weak: Weak<Inner> = Rc::downgrade(&self.0);
        move || {
            if let Some(inner) = weak.upgrade() {
                inner.request_frame();
            }
        }
    }

    /// A function that wakes the step at the next multiple of [`FrameRate::step_ms`].
    pub fn waker_in_step(&self) -> impl Fn() + 'static {
        let weak: Weak<Inner> = Rc::downgrade(&self.0);
        move || {
            if let Some(inner) = weak.upgrade()
                && inner.frame.get().is_none()
            {
                inner.request_later(to_step(frame_rate().step_ms(), page_now_ms()));
            }
        }
    }
}

impl Inner {
    fn step(self: &Rc<Self>, now_ms: f64) {
        self.frame.set(None);
        // A running step cannot be entered again; it is called in the next frame.
        let next = self
            .step
            .try_borrow_mut()
            .map_or(Next::Frame, |mut step| step(now_ms));
        match next {
            Next::Frame => self.request_frame(),
            Next::After(ms) => self.request_later(ms),
            Next::Woken => {}
        }
    }

    /// Requests a frame. The browser calls none while the page is hidden.
    fn request_frame(&self) {
        self.cancel_timeout();
        if self.frame.get().is_some() {
            return;
        }
        if let Some(on_frame) = self.on_frame.borrow().as_ref() {
            let handle = window().request_animation_frame(on_frame.as_ref().unchecked_ref());
            self.frame.set(handle.ok());
        }
    }

    fn request_later(self: &Rc<Self>, ms: f64) {
        self.cancel_timeout();
        let weak = Rc::downgrade(self);
        let wake = move || {
            if let Some(inner) = weak.upgrade() {
                inner.timeout.set(None);
                inner.request_frame();
            }
        };
        let after = Duration::try_from_secs_f64(ms / 1_000.0).unwrap_or_default();
        self.timeout.set(set_timeout_with_handle(wake, after).ok());
    }

    fn cancel_timeout(&self) {
        if let Some(timeout) = self.timeout.take() {
            timeout.clear();
        }
    }
}

impl Drop for Inner {
    fn drop(&mut self) {
        self.cancel_timeout();
        if let Some(frame) = self.frame.get() {
            // It fails for expired handles only.
            let _ = window().cancel_animation_frame(frame);
        }
    }
}
