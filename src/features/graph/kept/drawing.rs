//! The lines and the values of the kept run.

use motorlink_messages::protocol::{Instant, family::Model};

use crate::{
    features::graph::{
        kept::state::Aligned,
        plot::{
            columns::{Dot, Grid},
            crosshair::{self, Values},
            lines::trace_lines,
            palette::Colour,
            surface::Pen,
            trace::Trace,
        },
    },
    model::history::Track,
};

/// Line width, in CSS pixels: a broad pale line under the thin dark one, which differs not by its colour alone.
const WIDTH: f64 = 5.0;
/// How much of the colour is left, in per cent; the rest is the background.
const STRENGTH: u16 = 35;

impl Aligned {
    fn track(&self) -> Option<&Track> {
        self.run.history.track(self.run.id)
    }

    /// The lines of a trace in these columns of the shown run.
    pub(crate) fn lines(&self, trace: Trace, grid: Grid) -> Vec<Vec<Dot>> {
        let lines = |track| {
            let grid = grid.earlier(self.shift_us);
            trace_lines(&self.run.history, track, trace, self.run.mirror, grid)
        };
        self.track().map(lines).unwrap_or_default()
    }

    /// The values under a moment of the shown run.
    pub(crate) fn values(&self, model: Model, at: Instant) -> Option<Values> {
        let at_us = at.as_micros().saturating_add_signed(-self.shift_us);
        let at = Instant::from_micros(at_us);
        let values = |track| crosshair::values(track, self.run.mirror, model, at);
        self.track().map(values)
    }
}

/// The pen for a trace of this colour.
pub(crate) fn pen(colour: Colour, background: Colour) -> Pen {
    Pen {
        colour: pale(colour, background),
        width: WIDTH,
        dashed: false,
    }
}

/// The colour of the kept run in a legend too.
pub(crate) fn pale(colour: Colour, background: Colour) -> Colour {
    let mixed = |of: u8, with: u8| {
        let sum = u16::from(of) * STRENGTH + u16::from(with) * (100 - STRENGTH);
        u8::try_from(sum / 100).unwrap_or(u8::MAX)
    };
    let ((red, green, blue), (in_red, in_green, in_blue)) = (colour, background);
    (
        mixed(red, in_red),
        mixed(green, in_green),
        mixed(blue, in_blue),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kept_line_is_pale_on_each_background() {
        assert_eq!(pale((0, 100, 200), (255, 255, 255)), (165, 200, 235));
        assert_eq!(pale((200, 200, 200), (0, 0, 0)), (70, 70, 70));
    }
}
