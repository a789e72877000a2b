//! Draws the visible rows.
//!
//! There are as many elements as rows fit into the list, in order. When the log moves by three rows, three
//! elements move to the other end and get new texts. The others do not change, which is cheap and keeps the
//! user's text selection.

use std::collections::VecDeque;

use web_sys::HtmlElement;

use crate::{
    features::packet_log::{feed::LogFeed, slot::Slot, view::LogView},
    ui::list::scroll_px,
};

/// The list's elements.
pub(crate) struct Painter {
    /// The scrolling element.
    scroller: HtmlElement,
    /// The scrolled element: as tall as the log.
    extent: HtmlElement,
    /// The element of the rows; it stays in view.
    rows: HtmlElement,
    slots: VecDeque<Slot>,
    /// Number of the row in the first slot.
    first: u64,
    hidden_px: u64,
    two_lines: bool,
}

impl Painter {
    pub(crate) fn new(scroller: HtmlElement, extent: HtmlElement, rows: HtmlElement) -> Self {
        Self {
            scroller,
            extent,
            rows,
            slots: VecDeque::new(),
            first: 0,
            hidden_px: 0,
            two_lines: false,
        }
    }

    /// Draws the feed. Returns whether the scroll bar still has to be updated: while the user drags it, the bar and
    /// its range stay as they are, because a change would interrupt smooth scrolling.
    pub(crate) fn paint(&mut self, feed: &mut LogFeed, is_dragged: bool) -> bool {
        let view = &mut feed.view;
        if self.two_lines != view.has_two_lines() {
            self.two_lines = !self.two_lines;
            // Setting a class does not fail.
            let rows = self.rows.class_list();
            let _ = rows.toggle_with_force("two-lines", self.two_lines);
        }
        if !is_dragged {
            self.follow(view);
        }
        let first = view.first_row();
        let count = view.row_behind().saturating_sub(first);
        let hidden_px = view.hidden_px();
        let behind = view.extent_to().is_some() || view.scroll_to().is_some();
        self.fit(usize::try_from(count).unwrap_or(0));
        self.turn_to(first);
        for (number, slot) in (first..).zip(&mut self.slots) {
            slot.show(feed.row(number));
        }
        self.set_hidden_part(hidden_px);
        is_dragged && behind
    }

    /// Sets the scroll bar and its range from the view.
    fn follow(&self, view: &mut LogView) {
        if let Some(extent_px) = view.extent_to() {
            view.extends_over(extent_px);
            set_style(&self.extent, "height", &format!("{extent_px}px"));
            // The browser moves a scroll bar that is beyond the new end.
            view.stands_at(scroll_px(&self.scroller));
        }
        if let Some(place_px) = view.scroll_to() {
            set_scroll_px(&self.scroller, place_px);
            view.stands_at(scroll_px(&self.scroller));
        }
    }

    /// Creates or removes slots to match the number of visible rows.
    fn fit(&mut self, count: usize) {
        while self.slots.len() > count {
            if let Some(slot) = self.slots.pop_back() {
                slot.element().remove();
            }
        }
        while self.slots.len() < count {
            let Some(slot) = Slot::append_to(&self.rows) else {
                return;
            };
            self.slots.push_back(slot);
        }
    }

    /// Moves the slots that get new rows to the end where these belong.
    fn turn_to(&mut self, first: u64) {
        let slots = u64::try_from(self.slots.len()).unwrap_or(0);
        if first.abs_diff(self.first) < slots {
            for _ in self.first..first {
                if let Some(slot) = self.slots.pop_front() {
                    // It fails only for elements that cannot be inserted.
                    let _ = self.rows.append_child(slot.element());
                    self.slots.push_back(slot);
                }
            }
            for _ in first..self.first {
                if let Some(slot) = self.slots.pop_back() {
                    let _ = self.rows.prepend_with_node_1(slot.element());
                    self.slots.push_front(slot);
                }
            }
        }
        self.first = first;
    }

    fn set_hidden_part(&mut self, hidden_px: u64) {
        if hidden_px != self.hidden_px {
            self.hidden_px = hidden_px;
            set_style(
                &self.rows,
                "transform",
                &format!("translateY(-{hidden_px}px)"),
            );
        }
    }
}

#[allow(
    clippy::useless_conversion,
    reason = "a float, but without the flag for Web Serial a whole number"
)]
fn set_scroll_px(scroller: &HtmlElement, place_px: i32) {
    scroller.set_scroll_top(place_px.into());
}

fn set_style(element: &HtmlElement, name: &str, value: &str) {
    // It fails only for invalid values.
    let _ = element.style().set_property(name, value);
}

pub(crate) fn width_of(element: &HtmlElement) -> u32 {
    u32::try_from(element.client_width()).unwrap_or(0)
}

pub(crate) fn height_of(element: &HtmlElement) -> u32 {
    u32::try_from(element.client_height()).unwrap_or(0)
}
