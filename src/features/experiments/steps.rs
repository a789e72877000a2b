//! The table of steps in the tab Sequence.

use leptos::{html::Div, prelude::*};
use motorlink_i18n::tr;
use motorlink_messages::experiments::sequence::{STEPS_MAX, Sequence};
use wasm_bindgen::JsCast;
use web_sys::{Element, Event, HtmlDivElement, HtmlElement};

use crate::{
    features::experiments::{
        state::{Draft, Experiments},
        steps_grid::{self, ROW_PX, Shown},
        table::{self, Column, Kind, Row},
        texts,
    },
    ui::{
        button::PressButton,
        list::{replace_keeping_focus, scroll_px},
        reactive::{dynamic, effect, handler},
    },
};

/// Rows that are drawn above and below the visible ones.
const MARGIN: usize = 6;

/// Tables that are kept for `Undo`.
const UNDO_MAX: usize = 20;

impl Experiments {
    /// Changes the table. [`Self::undo`] brings the one before back.
    fn edit(self, change: impl FnOnce(&mut Draft)) {
        self.keep_for_undo();
        self.draw(change);
    }

    fn draw(self, change: impl FnOnce(&mut Draft)) {
        self.draft.update(change);
        self.redrawn.update(|drawn| *drawn = drawn.wrapping_add(1));
    }

    /// Replaces the table.
    pub(super) fn load(self, sequence: &Sequence) {
        self.edit(|draft| *draft = Draft::of(sequence));
    }

    fn keep_for_undo(self) {
        let before = self.draft.get_untracked();
        self.before.update(|kept| {
            if kept.len() == UNDO_MAX {
                kept.remove(0);
            }
            kept.push(before);
        });
    }

    /// Brings back the table before the last change.
    pub(super) fn undo(self) {
        if let Some(before) = self.before.try_update(Vec::pop).flatten() {
            self.draw(|draft| *draft = before);
        }
    }

    /// Adds rows behind the selected block.
    fn insert(self, rows: &[Row]) {
        self.edit(|draft| {
            let end = table::block_end(&draft.rows, draft.selected);
            // Behind the head of an empty or open repeat, into it.
            let at = (end + 1).min(draft.rows.len());
            draft.rows.splice(at..at, rows.iter().cloned());
            draft.selected = at;
        });
    }

    /// Removes the selected block, which can be the whole table.
    fn remove(self) {
        self.edit(|draft| {
            let first = draft.selected;
            let end = table::block_end(&draft.rows, first);
            if first < draft.rows.len() {
                draft.rows.drain(first..=end);
            }
            draft.selected = first.min(draft.rows.len().saturating_sub(1));
        });
    }

    fn duplicate(self) {
        let block = self.draft.with_untracked(|draft| {
            let end = table::block_end(&draft.rows, draft.selected);
            draft.rows.get(draft.selected..=end).map(<[Row]>::to_vec)
        });
        if let Some(block) = block {
            self.insert(&block);
        }
    }

    /// Moves the selected block by one row: into and out of a repeat too.
    fn shift(self, down: bool) {
        self.edit(|draft| {
            let first = draft.selected;
            let end = table::block_end(&draft.rows, first);
            if down && end + 1 < draft.rows.len() {
                let below = draft.rows.remove(end + 1);
                draft.rows.insert(first, below);
                draft.selected = first + 1;
            } else if !down && first > 0 && end < draft.rows.len() {
                let above = draft.rows.remove(first - 1);
                draft.rows.insert(end, above);
                draft.selected = first - 1;
            }
        });
    }

    fn is_end_selected(self) -> bool {
        self.draft.with(|draft| {
            let row = draft.rows.get(draft.selected);
            row.is_none_or(|row| row.kind == Kind::EndRepeat)
        })
    }
}

/// The table, with the buttons that change its rows.
#[component]
pub(super) fn StepsTable(of: Experiments) -> impl IntoView {
    let scroll = NodeRef::<Div>::new();
    let list = NodeRef::<Div>::new();
    let scrolled = RwSignal::new(0_usize);
    let wrong = Memo::new(move |_| {
        of.checked.with(|checked| match checked {
            Some(Err(error)) => of
                .draft
                .with(|draft| table::find(&draft.rows, &error.place)),
            _ => None,
        })
    });
    effect(move || {
        let (first, wrong) = (scrolled.get(), wrong.get());
        if let (Some(scroll), Some(list)) = (scroll.get(), list.get()) {
            draw(of, &scroll, &list, first, wrong);
        }
    });
    let on_scroll = move |_: Event| {
        let top = scroll
            .get_untracked()
            .map_or(0, |scroll| scroll_px(&scroll));
        let first = usize::try_from(top).unwrap_or(0) / ROW_PX;
        if scrolled.get_untracked() != first {
            scrolled.set(first);
        }
    };
    let select = move |event: Event| {
        let Some(row) = row_of(&event) else { return };
        if of.draft.with_untracked(|draft| draft.selected != row) {
            of.draft.update(|draft| draft.selected = row);
            mark_selected(list.get_untracked(), row);
        }
    };
    let words = move || {
        let (count, _) = of.draft.with(|draft| (draft.rows.len(), draft.selected));
        of.checked.with(|checked| match checked {
            Some(Err(error)) => texts::refused(error, wrong.get().map(|(row, _)| row)),
            Some(Ok((_, plan))) => tr!(
                "{count} rows, {time}",
                count,
                time = texts::duration(plan.longest_s())
            ),
            None => String::new(),
        })
    };
    view! {
        {tools(of)}
        <div class="steps-scroll" node_ref=scroll on:scroll=handler(on_scroll)>
            <div
                role="grid"
                class="steps"
                aria-label=tr!("Steps")
                aria-rowcount=dynamic(move || of.draft.with(|draft| draft.rows.len() + 1).to_string())
            >
                <div role="row" class="steps-head" inner_html=steps_grid::head()></div>
                <div
                    role="rowgroup"
                    class="steps-rows"
                    node_ref=list
                    on:change=handler(move |event| change_cell(of, &event))
                    on:focusin=handler(move |event: web_sys::FocusEvent| select(event.into()))
                    on:click=handler(move |event: web_sys::MouseEvent| select(event.into()))
                ></div>
            </div>
        </div>
        <p class="steps-words" class:wrong=dynamic(move || wrong.get().is_some()) role="status" aria-label=tr!("Sequence check")>
            {dynamic(words)}
        </p>
    }
}

/// Draws the rows from `first` on that are in sight.
fn draw(
    of: Experiments,
    scroll: &HtmlDivElement,
    list: &HtmlDivElement,
    first: usize,
    wrong: Option<(usize, Column)>,
) {
    of.redrawn.track();
    let motors = of.fleet.with(|fleet| fleet.motors.clone());
    let motors: Vec<_> = of.page.motors.names.with(|names| {
        let named = motors.iter().map(|id| (*id, names.named(*id)));
        named.collect()
    });
    of.draft.with_untracked(|draft| {
        let shown = Shown {
            motors: &motors,
            selected: draft.selected,
            wrong,
        };
        let height = usize::try_from(scroll.client_height()).unwrap_or_default();
        let count = height.max(400) / ROW_PX + 2 * MARGIN;
        let from = first.saturating_sub(MARGIN);
        let html = steps_grid::html(&draft.rows, from, count, &shown);
        replace_keeping_focus(list, &html, "data-cell");
        let element: &HtmlElement = list;
        let style = element.style();
        let rest = draft.rows.len().saturating_sub(from + count);
        // Rows that are not drawn keep their place. A refused style leaves the scroll bar short.
        let _ = style.set_property("padding-top", &format!("{}px", from * ROW_PX));
        let _ = style.set_property("padding-bottom", &format!("{}px", rest * ROW_PX));
    });
}

/// The buttons that change rows.
fn tools(of: Experiments) -> impl IntoView {
    let full = move || {
        let full = of.draft.with(|draft| draft.rows.len() >= STEPS_MAX);
        full.then(|| tr!("more than {max} steps", max = STEPS_MAX))
    };
    let no_block = move || {
        of.is_end_selected()
            .then(|| tr!("Select a step or a repeat in the table.").to_owned())
    };
    view! {
        <div class="steps-tools">
            <PressButton
                label=tr!("Add step")
                class="button small"
                disabled_reason=Signal::derive(full)
                on_press=move || of.insert(&[Row::new_step()])
            />
            <PressButton
                label=tr!("Add repeat")
                class="button small"
                disabled_reason=Signal::derive(full)
                on_press=move || of.insert(&Row::new_repeat())
            />
            <PressButton
                label=tr!("Duplicate")
                class="button small"
                disabled_reason=Signal::derive(no_block)
                on_press=move || of.duplicate()
            />
            <PressButton
                label=tr!("Move up")
                class="button small"
                disabled_reason=Signal::derive(no_block)
                on_press=move || of.shift(false)
            />
            <PressButton
                label=tr!("Move down")
                class="button small"
                disabled_reason=Signal::derive(no_block)
                on_press=move || of.shift(true)
            />
            <PressButton
                label=tr!("Remove")
                class="button small"
                disabled_reason=Signal::derive(no_block)
                on_press=move || of.remove()
            />
        </div>
    }
}

fn element_of(event: &Event) -> Option<Element> {
    event.target()?.dyn_into::<Element>().ok()
}

/// The row in which the event is.
fn row_of(event: &Event) -> Option<usize> {
    let row = element_of(event)?.closest("[data-row]").ok()??;
    row.get_attribute("data-row")?.parse().ok()
}

/// Takes a changed cell. Other cells are drawn again only if a choice shows or hides them: drawing takes the focus from
/// where Tab goes.
fn change_cell(of: Experiments, event: &Event) {
    let Some(element) = element_of(event) else {
        return;
    };
    let cell = element.get_attribute("data-cell");
    let Some((row, column)) = cell.as_deref().and_then(|cell| cell.split_once(':')) else {
        return;
    };
    let (Ok(row), Some(column)) = (row.parse::<usize>(), Column::from_key(column)) else {
        return;
    };
    let text = event_target_value(event);
    of.keep_for_undo();
    of.draft.update(|draft| {
        if let Some(row) = draft.rows.get_mut(row) {
            row.set(column, &text);
            row.fill();
        }
    });
    if column.is_choice() {
        of.redrawn.update(|drawn| *drawn = drawn.wrapping_add(1));
    }
}

/// Marks the selected row without drawing the table.
fn mark_selected(list: Option<HtmlDivElement>, row: usize) {
    let Some(list) = list else { return };
    let rows = list.children();
    for row_element in (0..rows.length()).filter_map(|place| rows.item(place)) {
        let own = row_element.get_attribute("data-row");
        let is_selected = own.as_deref() == Some(row.to_string().as_str());
        // It fails for names that are none.
        let _ = row_element
            .class_list()
            .toggle_with_force("selected", is_selected);
        let _ = row_element.set_attribute("aria-selected", &is_selected.to_string());
    }
}
