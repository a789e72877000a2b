//! Panel `Link`: how well the line works, and what is wrong with it.
//!
//! Its elements are one text of HTML and stay; what they read is text too, written where it changes.

use leptos::{html, prelude::*};
use motorlink_diagnosis::{Line, Record, texts::judged as words_of};
use motorlink_i18n::tr;
use motorlink_messages::{Adapter, Connection, LineCondition, ToWorker};
use web_sys::{Element, HtmlSelectElement, wasm_bindgen::JsCast};

use crate::{
    features::link_doctor::{figures, markup, texts::no_virtual_wire},
    model::{page::Page, place::Place},
    ui::{
        frame_rate::frame_rate,
        list::replace_keeping_focus,
        panel::panel,
        reactive::{effect, handler},
    },
};

/// Panel `Link`.
#[component]
pub(crate) fn LinkPanel(
    page: Page,
    /// Which virtual line was chosen, by its place.
    virtual_wire: StoredValue<usize>,
) -> impl IntoView {
    let place = NodeRef::<html::Div>::new();
    // What the doctor has seen says nothing of another wire.
    let rewired = StoredValue::new(false);
    let mut record = Record::default();
    let mut elements = None;
    effect(move || {
        let Some(panel) = place.get() else { return };
        let elements = elements.get_or_insert_with(|| Elements::of(&panel));
        if rewired.get_value() {
            rewired.set_value(false);
            record.clear();
        }
        elements.show(page, virtual_wire, &mut record);
    });
    let rewire = move |event| {
        let place: Option<usize> = event_target_value(&event).parse().ok();
        if let Some(wire) = place.and_then(|place| LineCondition::ALL.get(place)) {
            rewired.set_value(true);
            virtual_wire.set_value(place.unwrap_or_default());
            page.post(&ToWorker::VirtualWire(*wire));
        }
    };
    panel(
        "panel place first",
        tr!("Link health"),
        move || page.place() == Place::Diagnose,
        None,
        view! {
            <div
                class="link-panel"
                node_ref=place
                on:change=handler(rewire)
                inner_html=markup::panel()
            ></div>
        },
    )
}

/// What changes in the panel.
struct Elements {
    /// Of the line that the doctor looks at.
    connection: Connection,
    doctor: Option<Text>,
    /// The figures that it judged by.
    judged: Option<Text>,
    /// In the order of [`figures::of`].
    figures: [Option<Text>; 7],
    wire: Option<HtmlSelectElement>,
}

impl Elements {
    fn of(panel: &Element) -> Self {
        let find = |selector: &str| panel.query_selector(selector).ok().flatten();
        Self {
            connection: Connection::Disconnected,
            doctor: find(".link-doctor").map(Text::new),
            judged: find(".link-judged").map(Text::new),
            figures: markup::FIGURES.map(|selector| find(selector).map(Text::new)),
            wire: find("select").map(JsCast::unchecked_into),
        }
    }

    /// Shows the line as it is. The doctor looks while the panel is closed too, so that the panel shows at
    /// once what has happened.
    fn show(&mut self, page: Page, virtual_wire: StoredValue<usize>, record: &mut Record) {
        let is_open = page.place() == Place::Diagnose;
        page.shown.with(|session| {
            if self.connection != session.connection {
                self.connection = session.connection;
                record.clear();
            }
            let line = session.line.as_ref().map(|status| Line {
                now: session.now,
                status,
                motors: &session.motors,
            });
            if record.look(line)
                && let Some(doctor) = &mut self.doctor
            {
                doctor.write_with_links(markup::verdict(record.verdict()));
                if let Some(judged) = &mut self.judged {
                    judged.write(words_of(record.judged()));
                }
            }
            let asked_hz = page.preferences.with(|chosen| chosen.rate.hertz());
            if is_open {
                let figures = figures::of(session, asked_hz, frame_rate());
                for (element, html) in self.figures.iter_mut().flatten().zip(figures) {
                    element.write(html);
                }
            }
            let is_virtual = matches!(
                session.connection,
                Connection::Connected(Adapter::Virtual(_))
            );
            if !is_virtual {
                // A virtual line begins good.
                virtual_wire.set_value(0);
            }
            if let Some(wire) = &self.wire
                && wire.disabled() == is_virtual
            {
                wire.set_disabled(!is_virtual);
                wire.set_title(if is_virtual { "" } else { no_virtual_wire() });
                wire.set_value(&virtual_wire.get_value().to_string());
            }
        });
    }
}

/// What an element reads, written only when it changes.
struct Text {
    element: Element,
    written: String,
}

impl Text {
    const fn new(element: Element) -> Self {
        Self {
            element,
            written: String::new(),
        }
    }

    fn write(&mut self, html: String) {
        if self.written != html {
            self.element.set_inner_html(&html);
            self.written = html;
        }
    }

    /// The link to the same part of the help keeps the focus.
    fn write_with_links(&mut self, html: String) {
        if self.written != html {
            replace_keeping_focus(&self.element, &html, "data-help");
            self.written = html;
        }
    }
}
