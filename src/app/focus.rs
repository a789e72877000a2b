//! Keeps the focus of a keyboard user on the page.
//!
//! A browser drops the focus when the focused control is hidden, disabled or removed: the next Tab begins anywhere, and
//! a screen reader loses its place. Then the focus goes to the control that opened the panel or dialog, to another
//! button of a run, or to the panel around the control. After Release it goes to no button: another Enter would press it.

use std::{cell::RefCell, rc::Rc};

use leptos::prelude::*;
use motorlink_messages::Connection;
use wasm_bindgen::JsCast;
use web_sys::{Element, FocusOptions, HtmlElement, KeyboardEvent};

use crate::{
    app::keyboard::{has_focus, last_target},
    model::page::Page,
    ui::{
        listener::on_window,
        reactive::{effect, memo},
    },
};

/// What is opened and entered.
const OPENED: &str = ".opened, [role=dialog], [role=alertdialog]";

/// What takes the focus of a control in it. The header does not: from there the focus goes to the controls.
const AROUND: &str = "section, [role=tabpanel], .tour, [role=dialog]";

/// The buttons of a run. The first of them that can be pressed takes a dropped focus: from Run it goes to Pause. Run itself
/// does not take it, so that another Enter on Arm starts nothing.
const RUN_BUTTONS: &str = ".run-bar > .run-buttons";
const NOT_RUN: &str = "button:enabled:not(.primary)";

/// The desk, for everything else.
const CONTROLS: &str = "#control";

/// What had the focus.
#[derive(Default)]
struct Held {
    /// The focused element and those around it, from the inside out. A removed element does not know them any more.
    path: Vec<Element>,
    /// What had the focus before a panel or dialog was entered, as `path`.
    opener: Vec<Element>,
    /// Whether `opener` is that of the panel that is entered next. The panel may hide the button that opened it.
    knows_opener: bool,
    /// Whether the pointer was used last. What it presses gives the focus away on purpose.
    by_pointer: bool,
}

/// Keeps the focus from now on.
pub(crate) fn keep(page: Page) {
    let held = Rc::new(RefCell::new(Held::before()));
    let on = |name, note: fn(&mut Held, Element)| {
        let held = Rc::clone(&held);
        on_window(name, move |event| {
            let target = event.target().and_then(|at| at.dyn_into::<Element>().ok());
            if let Some(target) = target {
                note(&mut held.borrow_mut(), target);
            }
            check_soon(&held);
        });
    };
    on("focusin", Held::entered);
    on("focusout", |_, _| ());
    on("pointerdown", |held, _| held.by_pointer = true);
    on("keydown", |held, _| held.by_pointer = false);
    on("keyup", |_, _| ());
    on_window("keydown", |event| {
        let Ok(key) = event.dyn_into::<KeyboardEvent>() else {
            return;
        };
        if key.alt_key() && key.code().starts_with("Digit") {
            in_two_frames(move || enter_place(&key));
        } else if key.key() == "Enter" && !key.repeat() {
            tick_box();
        }
    });
    check_soon(&held);
    // Most controls are hidden or disabled by a report of the worker.
    let shown = Rc::clone(&held);
    effect(move || {
        page.shown.track();
        pass_on_if_dropped(&shown);
    });
    // The first screen gives way, perhaps scrolled down to what connects.
    let is_open = memo(move || {
        page.shown.with(|session| {
            matches!(
                session.connection,
                Connection::Connected(_) | Connection::Reconnecting(_)
            )
        })
    });
    let was_open = StoredValue::new(is_open.get_untracked());
    effect(move || {
        let opens = is_open.get();
        if opens && !was_open.get_value() {
            window().scroll_to_with_x_and_y(0.0, 0.0);
        }
        was_open.set_value(opens);
    });
    effect(move || {
        if page.panel().is_some() {
            held.borrow_mut().keep_opener();
            in_two_frames(|| {
                let panel = document().query_selector(".opened:not([hidden])");
                if let Some(panel) = panel.ok().flatten() {
                    enter(&panel);
                }
            });
        }
    });
}

impl Held {
    /// The page is used before this part of it is there: a key may have dropped the focus already.
    fn before() -> Self {
        let mut held = Self::default();
        let is_on_page = |target: &Element| target.is_connected() && target.tag_name() != "BODY";
        // A Tab may have led to a control, and nothing was pressed there yet.
        let target = last_target().or_else(|| document().active_element());
        if let Some(target) = target.filter(is_on_page) {
            held.entered(target);
        }
        held
    }

    /// A button opens a panel.
    fn keep_opener(&mut self) {
        self.opener.clone_from(&self.path);
        self.knows_opener = true;
    }

    fn entered(&mut self, target: Element) {
        has_focus(target.clone());
        let opened = target.closest(OPENED).ok().flatten();
        let before = self.path.first();
        if let Some(opened) = &opened
            && let Some(before) = before
            && !opened.contains(Some(before))
            && !std::mem::take(&mut self.knows_opener)
        {
            self.opener.clone_from(&self.path);
        }
        let around = |element: &Element| element.parent_element();
        self.path = std::iter::successors(Some(target), around).collect();
    }

    /// The elements that may take a dropped focus, best first.
    fn next(&self) -> impl Iterator<Item = Element> {
        let was_in = |what| {
            let matches = |element: &&Element| element.matches(what).unwrap_or(false);
            self.path.iter().find(matches)
        };
        // After Release, the same key pressed again must not drive.
        let opener = match was_in(OPENED) {
            Some(opened) if !opened.matches(".stopped").unwrap_or(false) => present(&self.opener),
            _ => None,
        };
        let buttons = was_in(RUN_BUTTONS);
        let beside = buttons.and_then(|buttons| buttons.query_selector(NOT_RUN).ok().flatten());
        let around = self.path.iter().skip(1);
        let around = around.filter(|element| element.matches(AROUND).unwrap_or(false));
        let controls = document().query_selector(CONTROLS).ok().flatten();
        opener
            .into_iter()
            .chain(beside)
            .chain(around.cloned())
            .chain(controls)
    }
}

/// The control with this path, or the one that has replaced it: in a list that is made again, the button with the same
/// value.
fn present(path: &[Element]) -> Option<Element> {
    let control = path.first()?;
    if control.is_connected() {
        return Some(control.clone());
    }
    let value = control.get_attribute("value")?;
    let list = path.iter().find(|element| element.is_connected())?;
    let same = list.query_selector(&format!("[value='{value}']"));
    same.ok().flatten()
}

fn check_soon(held: &Rc<RefCell<Held>>) {
    let held = Rc::clone(held);
    in_two_frames(move || pass_on_if_dropped(&held));
}

fn pass_on_if_dropped(held: &RefCell<Held>) {
    if !is_focus_dropped() {
        return;
    }
    // Tab behind the last control leaves the page.
    if held.borrow().by_pointer || last_target().is_none() {
        // It stays given away when a key is pressed next.
        held.borrow_mut().path.clear();
    }
    if held.borrow().path.is_empty() {
        return;
    }
    let next: Vec<Element> = held.borrow().next().collect();
    // No longer borrowed: moving the focus is noted.
    let _ = next.iter().find(|element| focus_on(element, Scroll::None));
}

/// Space stops while anything is driven, so that Enter ticks the box that has the focus.
fn tick_box() {
    let focused = document().query_selector("[type=checkbox]:focus");
    if let Some(Ok(input)) = focused.ok().flatten().map(Element::dyn_into::<HtmlElement>) {
        input.click();
    }
}

/// A browser drops the focus after the frame in which the control is hidden.
fn in_two_frames(act: impl FnOnce() + 'static) {
    request_animation_frame(move || request_animation_frame(act));
}

fn is_focus_dropped() -> bool {
    let focused = document().active_element();
    focused.is_none_or(|element| {
        element.tag_name() == "BODY" || element.matches(":disabled").unwrap_or(false)
    })
}

/// Gives the focus to a panel, unless it or a dialog has it already. Where the pad is pressed at once, losing the focus
/// would end the hold.
fn enter(panel: &Element) {
    let opened = document()
        .active_element()
        .map(|focused| focused.closest(OPENED));
    if !matches!(opened, Some(Ok(Some(_)))) {
        focus_on(panel, Scroll::IntoView);
    }
}

/// Gives the focus to the place that this key has opened.
fn enter_place(key: &KeyboardEvent) {
    // The rail prevents the default of the keys that it takes.
    let opened = key.default_prevented();
    let controls = || document().query_selector(CONTROLS).ok().flatten();
    if let Some(controls) = opened.then(controls).flatten() {
        focus_on(&controls, Scroll::None);
        window().scroll_to_with_x_and_y(0.0, 0.0);
    }
}

/// What the focus does to the page.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Scroll {
    /// What takes the focus comes into view.
    IntoView,
    /// Nothing moves.
    None,
}

/// Returns whether the element took the focus. A hidden or disabled one does not.
fn focus_on(element: &Element, scroll: Scroll) -> bool {
    let Some(control) = element.dyn_ref::<HtmlElement>() else {
        return false;
    };
    if control.tab_index() < 0 && !control.has_attribute("tabindex") {
        let _ = control.set_attribute("tabindex", "-1");
    }
    let options = FocusOptions::new();
    options.set_prevent_scroll(scroll == Scroll::None);
    let _ = control.focus_with_options(&options);
    document().active_element().as_ref() == Some(element)
}
