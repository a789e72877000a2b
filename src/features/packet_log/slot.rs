//! One row of the list: an element with changing texts.

use motorlink_i18n::tr;
use motorlink_messages::recorder::{Kind, Row};
use web_sys::Element;

use crate::ui::{attribute::Attribute, format::grouped, text::Text};

/// The parts have spaces between them, so that a copied row is readable.
const PARTS: &str = "<div class=\"packet\"><span class=\"packet-time\"></span> \
    <span class=\"packet-kind\"></span> <span class=\"packet-id\"></span> \
    <span class=\"packet-hex\"></span> <span class=\"packet-meaning\"></span> \
    <button type=\"button\" class=\"packet-before\" hidden></button></div>";

/// An element that shows different rows over time.
pub(crate) struct Slot {
    element: Element,
    time: Text,
    kind: Text,
    id: Text,
    hex: Text,
    meaning: Text,
    /// The tooltip with the whole meaning, for a row that is too narrow.
    title: Attribute,
    toggle: Element,
    shown: Option<Row>,
}

impl Slot {
    /// Adds an empty row at the end.
    pub(crate) fn append_to(list: &Element) -> Option<Self> {
        list.insert_adjacent_html("beforeend", PARTS).ok()?;
        let element = list.last_element_child()?;
        let time = element.first_element_child()?;
        let kind = time.next_element_sibling()?;
        let id = kind.next_element_sibling()?;
        let hex = id.next_element_sibling()?;
        let meaning = hex.next_element_sibling()?;
        let toggle = meaning.next_element_sibling()?;
        Some(Self {
            element,
            time: Text::of(time),
            kind: Text::of(kind),
            id: Text::of(id),
            hex: Text::of(hex),
            title: Attribute::of(meaning.clone(), "title"),
            meaning: Text::of(meaning),
            toggle,
            shown: None,
        })
    }

    pub(crate) fn element(&self) -> &Element {
        &self.element
    }

    /// Shows a row, or nothing if it was not received yet. Changes only what differs.
    pub(crate) fn show(&mut self, row: Option<&Row>) {
        if self.shown.as_ref() == row {
            return;
        }
        self.shown = row.cloned();
        let Some(row) = row else {
            self.element.set_class_name("packet");
            for part in [
                &mut self.time,
                &mut self.kind,
                &mut self.id,
                &mut self.hex,
                &mut self.meaning,
            ] {
                part.set("");
            }
            self.show_toggle(None);
            return;
        };
        let (class, kind) = looks(row);
        self.element.set_class_name(class);
        self.time.set(&row.time);
        self.kind.set(kind);
        self.id.set(&row.id);
        self.hex.set(&row.hex);
        self.meaning.set(&row.meaning);
        self.title.set(row.meaning.clone());
        self.show_toggle(toggle(row));
        // A press of the button is handled by the list, for all rows.
        let _ = self.toggle.set_attribute("value", &row.number.to_string());
    }

    /// Shows the button of collapsed or opened frames.
    fn show_toggle(&self, toggle: Option<Toggle>) {
        let button = &self.toggle;
        let _ = button.toggle_attribute_with_force("hidden", toggle.is_none());
        let Some(Toggle { text, name, opened }) = toggle else {
            return;
        };
        button.set_text_content(Some(&text));
        let expanded = if opened { "true" } else { "false" };
        for (attribute, value) in [
            ("aria-label", &*name),
            ("title", &*name),
            ("aria-expanded", expanded),
        ] {
            let _ = button.set_attribute(attribute, value);
        }
    }
}

/// Class and label of a kind, so that kinds differ by more than colour. A row without bytes has more room for
/// text.
fn looks(row: &Row) -> (&'static str, &'static str) {
    match (row.kind, row.hex.is_empty()) {
        (Kind::Tx, _) => ("packet tx", "TX"),
        (Kind::Rx, _) => ("packet rx", "RX"),
        (Kind::System, _) => ("packet system wordy", tr!("SYS")),
        (Kind::Error, true) => ("packet error wordy", tr!("ERR")),
        (Kind::Error, false) => ("packet error", tr!("ERR")),
    }
}

/// The button of a row with collapsed frames before it, or with the first of opened ones.
#[derive(Debug, PartialEq, Eq)]
struct Toggle {
    text: String,
    name: String,
    opened: bool,
}

fn toggle(row: &Row) -> Option<Toggle> {
    let (sign, count, opened) = match (row.opened, row.collapsed_before) {
        (0, 0) => return None,
        (0, collapsed) => ('+', collapsed, false),
        (opened, _) => ('\u{2212}', opened, true),
    };
    let text = format!("{sign}{}", grouped(count.into()));
    let name = match (opened, count) {
        (false, 1) => tr!("+1 collapsed frame before this").to_owned(),
        (false, _) => tr!("{text} collapsed frames before this", text = &text),
        (true, 1) => tr!("\u{2212}1 opened frame: collapse").to_owned(),
        (true, _) => tr!("{text} opened frames: collapse", text = &text),
    };
    Some(Toggle { text, name, opened })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(kind: Kind, hex: &str) -> Row {
        Row {
            number: 0,
            kind,
            time: String::new(),
            id: String::new(),
            hex: hex.to_owned(),
            meaning: String::new(),
            collapsed_before: 0,
            opened: 0,
        }
    }

    #[test]
    fn a_row_says_how_many_routine_frames_are_before_it_or_opened() {
        let of = |collapsed_before, opened| {
            let toggle = toggle(&Row {
                collapsed_before,
                opened,
                ..row(Kind::Tx, "01")
            });
            toggle.map(|toggle| (toggle.name, toggle.opened))
        };
        let name = |name: &str, opened| Some((name.to_owned(), opened));
        assert_eq!(of(0, 0), None);
        assert_eq!(of(1, 0), name("+1 collapsed frame before this", false));
        assert_eq!(of(48, 0), name("+48 collapsed frames before this", false));
        assert_eq!(of(0, 1), name("\u{2212}1 opened frame: collapse", true));
        assert_eq!(of(2, 48), name("\u{2212}48 opened frames: collapse", true));
    }

    #[test]
    fn kinds_are_told_apart_by_words() {
        let labels =
            [Kind::Tx, Kind::Rx, Kind::System, Kind::Error].map(|kind| looks(&row(kind, "01")).1);
        assert_eq!(labels, ["TX", "RX", "SYS", "ERR"]);
        assert_eq!(looks(&row(Kind::Error, "")).0, "packet error wordy");
    }
}
