//! The tab Sequence: name, template, limits and files on the left; the table of steps beside them.

use leptos::{
    html::{Div, Input},
    prelude::*,
    task::spawn_local,
};
use motorlink_i18n::tr;
use motorlink_messages::experiments::sequence::{STEPS_MAX, Sequence, Template, from_csv};
use wasm_bindgen::JsCast;
use wasm_bindgen_futures::JsFuture;
use web_sys::{Blob, Element, Event, File, HtmlElement, HtmlInputElement};

use crate::{
    features::experiments::{
        state::{Draft, Experiments},
        steps_grid::{self, ROW_PX, Shown},
        table::{self, Column, Kind, Row},
        texts,
    },
    model::snapshot::Session,
    ui::{
        button::PressButton,
        download::save_blob,
        format,
        list::replace_keeping_focus,
        reactive::{dynamic, effect, handler},
    },
};

/// Largest file that is read: 10,000 steps with every field are less.
const FILE_BYTES_MAX: f64 = 8e6;
/// Rows that are drawn above and below the visible ones.
const MARGIN: usize = 6;

impl Experiments {
    fn edit(self, change: impl FnOnce(&mut Draft)) {
        self.draft.update(change);
        self.redrawn.update(|drawn| *drawn = drawn.wrapping_add(1));
    }

    /// Replaces the table.
    fn load(self, sequence: &Sequence) {
        self.edit(|draft| *draft = Draft::of(sequence));
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

    /// Reads a file; a wrong one changes nothing.
    fn open(self, name: &str, text: &str) {
        let is_csv = name.to_ascii_lowercase().ends_with(".csv");
        let read = if is_csv {
            from_csv(text)
        } else {
            Sequence::from_json(text)
        };
        match read {
            Ok(sequence) => {
                self.load(&sequence);
                self.said.set(tr!("Opened {name}", name = name.to_owned()));
            }
            Err(error) => self.said.set(tr!(
                "{name} was not opened: {reason}. Nothing was changed.",
                name = name.to_owned(),
                reason = texts::refused(&error, None)
            )),
        }
    }

    fn open_file(self, file: File) {
        let name = file.name();
        if file.size() > FILE_BYTES_MAX {
            self.said.set(tr!(
                "{name} was not opened: {reason}. Nothing was changed.",
                name,
                reason = tr!("the file is too large for a sequence").to_owned()
            ));
            return;
        }
        spawn_local(async move {
            let text = JsFuture::from(file.text()).await;
            match text.ok().and_then(|text| text.as_string()) {
                Some(text) => self.open(&name, &text),
                None => self
                    .said
                    .set(tr!("The file cannot be read. Select it again.").to_owned()),
            }
        });
    }

    fn save(self) {
        let Ok(sequence) = self.draft.with_untracked(Draft::sequence) else {
            return;
        };
        let name = file_name(&sequence.name);
        let bytes = js_sys::Uint8Array::from(sequence.to_json().as_bytes());
        let parts = js_sys::Array::of1(&bytes);
        if let Ok(blob) = Blob::new_with_u8_slice_sequence(&parts) {
            save_blob(&blob, &name);
            self.said.set(tr!("Saved {name}", name));
        }
    }
}

/// `up-and-down.json`
fn file_name(name: &str) -> String {
    let plain = |letter: char| {
        if letter.is_alphanumeric() {
            letter
        } else {
            '-'
        }
    };
    let name: String = name.trim().to_lowercase().chars().map(plain).collect();
    if name.is_empty() {
        "sequence.json".to_owned()
    } else {
        format!("{name}.json")
    }
}

/// Name, template, limits and files.
#[component]
pub(super) fn SequenceFields(of: Experiments) -> impl IntoView {
    let chooser = NodeRef::<Input>::new();
    let templates = Template::ALL.iter().enumerate().map(|(place, template)| {
        view! { <option value=place.to_string()>{texts::template(*template)}</option> }
    });
    let choose = move |event: Event| {
        let place = event_target_value(&event).parse::<usize>().ok();
        if let Some(template) = place.and_then(|place| Template::ALL.get(place)) {
            let mut sequence = template.sequence();
            texts::template(*template).clone_into(&mut sequence.name);
            of.load(&sequence);
        }
    };
    let chosen = move |event: Event| {
        let input = event
            .target()
            .and_then(|at| at.dyn_into::<HtmlInputElement>().ok());
        let Some(input) = input else { return };
        if let Some(file) = input.files().and_then(|files| files.get(0)) {
            of.open_file(file);
        }
        // Choosing the same file again is a change too.
        input.set_value("");
    };
    let open_blocked_by = move || {
        let drives = of.page.shown.with(Session::is_anything_driven);
        drives.then(|| {
            tr!("Stop the motors first: the browser's dialog would cover STOP.").to_owned()
        })
    };
    let save_blocked_by = move || {
        of.draft.with(|draft| {
            let error = draft.sequence().err()?;
            let row = table::find(&draft.rows, &error.place);
            Some(texts::refused(&error, row.map(|(row, _)| row)))
        })
    };
    let limits = [
        (tr!("Speed limit of the run"), format::rpm()),
        (tr!("Current limit of the run"), "A"),
        (tr!("Temperature limit of the run"), "°C"),
    ];
    let limit = move |(place, (label, unit)): (usize, (&'static str, &'static str))| {
        let text = move || {
            of.draft
                .with(|draft| draft.limits.get(place).cloned().unwrap_or_default())
        };
        let typed = move |event| {
            let text = event_target_value(&event);
            of.draft.update(|draft| {
                if let Some(limit) = draft.limits.get_mut(place) {
                    *limit = text;
                }
            });
        };
        let field = ["limits.rpm", "limits.amps", "limits.celsius"];
        let objection = move || {
            of.checked.with(|checked| match checked {
                Some(Err(error)) if field.get(place) == Some(&error.place.as_str()) => {
                    texts::problem(&error.problem)
                }
                _ => String::new(),
            })
        };
        view! {
            <label class="ask-field" class:wrong=dynamic(move || !objection().is_empty())>
                <span class="field-name">{label}</span>
                <span class="number">
                    <input
                        type="text"
                        autocomplete="off"
                        placeholder=tr!("none")
                        prop:value=dynamic(text)
                        on:input=handler(typed)
                    />
                    <span class="number-unit" aria-hidden="true">{unit}</span>
                </span>
                <span class="ask-words" aria-live="polite">{dynamic(objection)}</span>
            </label>
        }
    };
    view! {
        <label class="ask-field">
            <span class="field-name">{tr!("Template")}</span>
            <select on:change=handler(choose)>
                <option value="">{tr!("Choose a template")}</option>
                {templates.collect_view()}
            </select>
        </label>
        <label class="ask-field">
            <span class="field-name">{tr!("Name of the sequence")}</span>
            <input
                type="text"
                maxlength="64"
                autocomplete="off"
                prop:value=dynamic(move || of.draft.with(|draft| draft.name.clone()))
                on:input=handler(move |event| {
                    let name = event_target_value(&event);
                    of.draft.update(|draft| draft.name = name);
                })
            />
        </label>
        <div class="ask-pairs">
            {limits.into_iter().enumerate().map(limit).collect_view()}
        </div>
        <div class="run-buttons">
            <PressButton
                label=tr!("Open sequence")
                class="button small"
                hint=tr!("A sequence (.json), or setpoints by time (.csv)")
                disabled_reason=Signal::derive(open_blocked_by)
                on_press=move || {
                    if let Some(chooser) = chooser.get_untracked() {
                        chooser.click();
                    }
                }
            />
            <PressButton
                label=tr!("Save sequence")
                class="button small"
                disabled_reason=Signal::derive(save_blocked_by)
                on_press=move || of.save()
            />
            <input
                type="file"
                accept=".json,.csv"
                hidden=true
                node_ref=chooser
                on:change=handler(chosen)
            />
        </div>
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
    let draw = move || {
        of.redrawn.track();
        let first = scrolled.get();
        let wrong = wrong.get();
        let (Some(scroll), Some(list)) = (scroll.get(), list.get()) else {
            return;
        };
        let motors = of.fleet.with(|fleet| fleet.motors.clone());
        let motors: Vec<_> = of.page.motors.names.with(|names| {
            let name = |id| names.member(id).map(|member| member.name().to_owned());
            let named = motors.iter().map(|id| (*id, name(*id).unwrap_or_default()));
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
            replace_keeping_focus(&list, &html, "data-cell");
            let element: &HtmlElement = &list;
            let style = element.style();
            let rest = draft.rows.len().saturating_sub(from + count);
            // Rows that are not drawn keep their place. A refused style leaves the scroll bar short.
            let _ = style.set_property("padding-top", &format!("{}px", from * ROW_PX));
            let _ = style.set_property("padding-bottom", &format!("{}px", rest * ROW_PX));
        });
    };
    effect(draw);
    let on_scroll = move |_: Event| {
        let top = scroll
            .get_untracked()
            .map_or(0.0, |scroll| scroll.scroll_top());
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a float cast saturates"
        )]
        let first = top as usize / ROW_PX;
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
    let full = move || {
        let full = of.draft.with(|draft| draft.rows.len() >= STEPS_MAX);
        full.then(|| tr!("more than {max} steps", max = STEPS_MAX))
    };
    let no_block = move || {
        of.is_end_selected()
            .then(|| tr!("Select a step or a repeat in the table.").to_owned())
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
        <p class="steps-words" class:wrong=dynamic(move || wrong.get().is_some()) role="status" aria-label=tr!("Check of the steps")>
            {dynamic(words)}
        </p>
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
fn mark_selected(list: Option<web_sys::HtmlDivElement>, row: usize) {
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
