//! The frame rate of everything that changes with the data. There is one rate for all parts: a frame costs more than
//! the drawing in it, so all parts are drawn in the same frames.

use std::cell::Cell;

/// Frames per second.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FrameRate {
    /// The wheel turns, and a graph of 10 s scrolls, in every frame of the screen; the rest changes 20 times a second at most.
    #[default]
    Full,
    /// The wheel turns in 30 frames a second, and the rest changes in every other of them.
    Hz30,
    /// Everything is drawn in the same 20 frames a second.
    Hz20,
    /// Everything is drawn in the same 10 frames a second.
    Hz10,
}

impl FrameRate {
    /// Frames per second; `None` for the rate of the screen.
    #[must_use]
    pub const fn hertz(self) -> Option<u32> {
        match self {
            Self::Full => None,
            Self::Hz30 => Some(30),
            Self::Hz20 => Some(20),
            Self::Hz10 => Some(10),
        }
    }

    /// The next lower rate; `None` for the lowest.
    #[must_use]
    pub const fn lower(self) -> Option<Self> {
        match self {
            Self::Full => Some(Self::Hz30),
            Self::Hz30 => Some(Self::Hz20),
            Self::Hz20 => Some(Self::Hz10),
            Self::Hz10 => None,
        }
    }

    /// The next higher rate; `None` for the highest.
    #[must_use]
    pub const fn higher(self) -> Option<Self> {
        match self {
            Self::Full => None,
            Self::Hz30 => Some(Self::Full),
            Self::Hz20 => Some(Self::Hz30),
            Self::Hz10 => Some(Self::Hz20),
        }
    }

    /// Whether the wheel turns only in the frames in which the rest changes.
    #[must_use]
    pub const fn draws_all_together(self) -> bool {
        matches!(self, Self::Hz20 | Self::Hz10)
    }

    /// Period of drawing, in milliseconds: data is drawn at multiples of it.
    #[must_use]
    pub const fn step_ms(self) -> f64 {
        match self {
            Self::Full | Self::Hz20 => 50.0,
            Self::Hz30 => 200.0 / 3.0,
            Self::Hz10 => 100.0,
        }
    }
}

thread_local! {
    static RATE: Cell<FrameRate> = const { Cell::new(FrameRate::Full) };
}

/// The current rate.
#[must_use]
pub fn frame_rate() -> FrameRate {
    RATE.get()
}

/// Changes the rate from the next frame on.
pub fn set_frame_rate(rate: FrameRate) {
    RATE.set(rate);
}
