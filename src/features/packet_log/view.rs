//! Computes the visible rows of the list `Packets`, for a log of any length.
//!
//! Only the visible rows are elements. The position is stored in pixels from row 0 of the log, and the scroll bar
//! follows it. So the rows on screen stay in place when old rows are dropped, and the mouse wheel moves by rows
//! even if the scroll bar is too coarse for that. Only the distance of a scroll counts, and the bar may lag behind
//! the log while the user drags it.

use motorlink_messages::recorder::Window;

/// Height of a row in pixels: what the style sheet gives `.packet`. A button in each row can be hit (WCAG 2.5.8).
pub(crate) const ROW_PX: u32 = 24;

/// The same for rows of two lines.
pub(crate) const TWO_LINE_ROW_PX: u32 = 44;

/// Below this width of the list, in pixels, a row has two lines.
const TWO_LINES_BELOW_PX: u32 = 480;

/// The maximal height of an element: Firefox allows 17.9 million pixels, Chromium 33.5. At 24 pixels per row,
/// 330,000 rows reach it.
const EXTENT_MAX_PX: u64 = 8_000_000;

/// A move by more list heights than this is a drag or a jump to an end; a smaller one is scrolling.
const DRAGGED_BEYOND_HEIGHTS: u64 = 4;

/// Rows requested before the list has a height.
const ROWS_MIN: u64 = 8;

/// The visible part of the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    /// The newest rows; it follows new ones.
    Newest,
    /// A fixed position.
    Reading {
        /// The upper edge, in pixels from row 0.
        top_px: u64,
        /// Number after the newest row when following stopped.
        newest_then: u64,
    },
}

/// The list and its position in the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LogView {
    row_px: u32,
    height_px: u32,
    oldest: u64,
    end: u64,
    place: Place,
    /// Height of the scrolled element, in pixels.
    extent_px: u64,
    /// The known position of the scroll bar: if it is there, the user has not moved it.
    scroll_px: i32,
}

impl Default for LogView {
    fn default() -> Self {
        Self {
            row_px: ROW_PX,
            height_px: 0,
            oldest: 0,
            end: 0,
            place: Place::Newest,
            extent_px: 0,
            scroll_px: 0,
        }
    }
}

impl LogView {
    /// The list was created again; it has no size yet.
    pub(crate) fn mounted(&mut self) {
        self.extent_px = 0;
        self.scroll_px = 0;
    }

    /// Sets the size; the row at the upper edge stays. Returns whether the size changed.
    pub(crate) fn resize(&mut self, width_px: u32, height_px: u32) -> bool {
        let row_px = if width_px < TWO_LINES_BELOW_PX {
            TWO_LINE_ROW_PX
        } else {
            ROW_PX
        };
        let row = self.top_px() / u64::from(self.row_px);
        if let Place::Reading { top_px, .. } = &mut self.place
            && row_px != self.row_px
        {
            *top_px = row * u64::from(row_px);
        }
        let differs = (row_px, height_px) != (self.row_px, self.height_px);
        self.row_px = row_px;
        self.height_px = height_px;
        differs
    }

    /// Sets the rows of the log: the oldest, and the number after the newest.
    pub(crate) fn set_rows(&mut self, oldest: u64, end: u64) {
        self.oldest = oldest;
        self.end = end.max(oldest);
    }

    /// Goes to the newest rows and follows them.
    pub(crate) fn follow(&mut self) {
        self.place = Place::Newest;
    }

    /// Stops following.
    pub(crate) fn stop_following(&mut self) {
        if self.is_following() {
            self.read_at(self.top_px());
        }
    }

    /// Rows were opened or closed below its upper edge: it stays, and they count as no new ones.
    pub(crate) fn toggled(&mut self, opened: u64, closed: u64) {
        self.stop_following();
        if let Place::Reading { newest_then, .. } = &mut self.place {
            *newest_then = (*newest_then + opened).saturating_sub(closed);
        }
    }

    /// Handles a position of the scroll bar. Returns whether the user moved it there.
    pub(crate) fn scrolled(&mut self, scroll_px: i32) -> bool {
        let moved = i64::from(scroll_px) - i64::from(self.scroll_px);
        // With fractional pixel ratios, the position is rounded by up to one pixel.
        if moved == 0 || (self.is_following() && moved.abs() <= 1) {
            return false;
        }
        self.scroll_px = scroll_px;
        if moved > 0 && (self.is_following() || u64_of(scroll_px) + 1 >= self.range_px()) {
            self.follow();
            return true;
        }
        let dragged = DRAGGED_BEYOND_HEIGHTS * u64::from(self.height_px);
        let top_px = if scroll_px <= 0 || moved.unsigned_abs() > dragged {
            self.place_at(scroll_px)
        } else {
            self.top_px().saturating_add_signed(moved)
        };
        if moved > 0 && top_px >= self.newest_top_px() {
            self.follow();
        } else {
            self.read_at(top_px);
        }
        true
    }

    /// The scroll bar was moved to this position by the page, or by the browser because the list changed.
    pub(crate) fn stands_at(&mut self, scroll_px: i32) {
        self.scroll_px = scroll_px;
    }

    /// The position to set, if the scroll bar is elsewhere.
    pub(crate) fn scroll_to(&self) -> Option<i32> {
        let content_range_px = self.content_px().saturating_sub(u64::from(self.height_px));
        let offset_px = self.top_px().saturating_sub(self.oldest_px());
        let scroll_px = match self.place {
            Place::Newest => self.range_px(),
            Place::Reading { .. } => (offset_px * self.range_px())
                .checked_div(content_range_px)
                .unwrap_or(0),
        };
        let scroll_px = i32::try_from(scroll_px).unwrap_or(i32::MAX);
        (scroll_px != self.scroll_px).then_some(scroll_px)
    }

    /// The height to set, if it has changed.
    pub(crate) fn extent_to(&self) -> Option<u64> {
        let extent_px = self.content_px().min(EXTENT_MAX_PX);
        (extent_px != self.extent_px).then_some(extent_px)
    }

    /// The height was set.
    pub(crate) fn extends_over(&mut self, extent_px: u64) {
        self.extent_px = extent_px;
    }

    /// Whether it follows the newest rows.
    pub(crate) fn is_following(&self) -> bool {
        self.place == Place::Newest
    }

    /// Rows added since following stopped.
    pub(crate) fn new_rows(&self) -> u64 {
        match self.place {
            Place::Newest => 0,
            Place::Reading { newest_then, .. } => self.end.saturating_sub(newest_then),
        }
    }

    /// Whether rows have two lines.
    pub(crate) fn has_two_lines(&self) -> bool {
        self.row_px == TWO_LINE_ROW_PX
    }

    /// Number of the first row that is at least partly visible.
    pub(crate) fn first_row(&self) -> u64 {
        self.top_px() / u64::from(self.row_px)
    }

    /// How much of that row is above the upper edge, in pixels.
    pub(crate) fn hidden_px(&self) -> u64 {
        self.top_px() % u64::from(self.row_px)
    }

    /// Number after the last visible row.
    pub(crate) fn row_behind(&self) -> u64 {
        let bottom_px = self.top_px() + u64::from(self.height_px);
        bottom_px.div_ceil(u64::from(self.row_px)).min(self.end)
    }

    /// The rows to request, if the last request no longer covers the visible ones: those, and as many above and
    /// below, for short scrolls.
    pub(crate) fn window_to_request(&self, asked: Option<Window>) -> Option<Window> {
        let seen = (u64::from(self.height_px / self.row_px) + 2).max(ROWS_MIN);
        let window = match self.place {
            Place::Newest => Window {
                first: None,
                rows: rows(2 * seen),
            },
            Place::Reading { .. } => {
                let first = self.first_row();
                if asked.is_some_and(|asked| self.covers(asked, first, seen)) {
                    return None;
                }
                Window {
                    first: Some(first.saturating_sub(seen).max(self.oldest)),
                    rows: rows(3 * seen),
                }
            }
        };
        (asked != Some(window)).then_some(window)
    }

    /// Whether these rows cover the visible ones and half as many on both sides.
    fn covers(&self, asked: Window, first: u64, seen: u64) -> bool {
        let Some(from) = asked.first else {
            return false;
        };
        let above = first.saturating_sub(seen / 2).max(self.oldest);
        let below = (first + seen + seen / 2).min(self.end);
        from <= above && below <= from + u64::from(asked.rows)
    }

    fn read_at(&mut self, top_px: u64) {
        let newest_then = match self.place {
            Place::Newest => self.end,
            Place::Reading { newest_then, .. } => newest_then,
        };
        let top_px = top_px.clamp(self.oldest_px(), self.newest_top_px());
        self.place = Place::Reading {
            top_px,
            newest_then,
        };
    }

    /// The upper edge, in pixels from row 0, not before the oldest row.
    fn top_px(&self) -> u64 {
        match self.place {
            Place::Newest => self.newest_top_px(),
            Place::Reading { top_px, .. } => top_px.clamp(self.oldest_px(), self.newest_top_px()),
        }
    }

    fn oldest_px(&self) -> u64 {
        self.oldest * u64::from(self.row_px)
    }

    /// The upper edge when the newest row is at the lower one.
    fn newest_top_px(&self) -> u64 {
        let end_px = self.end * u64::from(self.row_px);
        end_px
            .saturating_sub(u64::from(self.height_px))
            .max(self.oldest_px())
    }

    /// The position in the log for this position of the scroll bar.
    fn place_at(&self, scroll_px: i32) -> u64 {
        let content_range_px = self.content_px().saturating_sub(u64::from(self.height_px));
        let offset_px = (u64_of(scroll_px) * content_range_px)
            .checked_div(self.range_px())
            .unwrap_or(0);
        self.oldest_px() + offset_px
    }

    fn content_px(&self) -> u64 {
        (self.end - self.oldest) * u64::from(self.row_px)
    }

    /// The range of the scroll bar.
    fn range_px(&self) -> u64 {
        self.extent_px.saturating_sub(u64::from(self.height_px))
    }
}

fn rows(rows: u64) -> u16 {
    u16::try_from(rows).map_or(Window::ROWS_MAX, |rows| rows.min(Window::ROWS_MAX))
}

/// A position beyond the upper end, as on a bouncing touch screen, counts as the end.
fn u64_of(scroll_px: i32) -> u64 {
    u64::try_from(scroll_px).unwrap_or(0)
}

#[cfg(test)]
#[path = "view_tests.rs"]
mod tests;
