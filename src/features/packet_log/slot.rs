//! One row of the list: an element with changing texts.

use motorlink_i18n::tr;
use motorlink_messages::recorder::{Kind, Row};
use web_sys::Element;

use crate::ui::format::grouped;

/// The parts have spaces between them, so that a copied row is readable.
const PARTS: &str = "<div class=\"packet\"><span class=\"packet-time\"></span> \
    <span class=\"packet-kind\"></span> <span class=\"packet-id\"></span> \
    <span class=\"packet-hex\"></span> <span class=\"packet-meaning\"></span> \
    <span class=\"packet-before\"></span></div>";

/// An element that shows different rows over time.
pub(crate) struct Slot {
    element: Element,
    time: Element,
    kind: Element,
    id: Element,
    hex: Element,
    meaning: Element,
    before: Element,
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
        let before = meaning.next_element_sibling()?;
        Some(Self {
            element,
            time,
            kind,
            id,
            hex,
            meaning,
            before,
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
                &self.time,
                &self.kind,
                &self.id,
                &self.hex,
                &self.meaning,
                &self.before,
            ] {
                part.set_text_content(None);
            }
            return;
        };
        let (class, kind) = looks(row);
        self.element.set_class_name(class);
        self.time.set_text_content(Some(&row.time));
        self.kind.set_text_content(Some(kind));
        self.id.set_text_content(Some(&row.id));
        self.hex.set_text_content(Some(&row.hex));
        self.meaning.set_text_content(Some(&row.meaning));
        // Setting an attribute does not fail. It has the whole text, for a row that is too narrow.
        let _ = self.meaning.set_attribute("title", &row.meaning);
        let (before, title) = before(row.collapsed_before);
        self.before.set_text_content(Some(&before));
        let _ = self.before.set_attribute("title", &title);
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

/// `+48` and its explanation; empty for zero.
fn before(collapsed: u32) -> (String, String) {
    match collapsed {
        0 => (String::new(), String::new()),
        1 => (
            "+1".to_owned(),
            tr!("1 collapsed frame before this").to_owned(),
        ),
        many => {
            let many = grouped(many.into());
            (
                format!("+{many}"),
                tr!("{count} collapsed frames before this", count = many),
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_says_how_many_routine_frames_came_before_it() {
        assert_eq!(before(0), (String::new(), String::new()));
        assert_eq!(before(1).1, "1 collapsed frame before this");
        let (chip, title) = before(48);
        assert_eq!(
            (chip.as_str(), title.as_str()),
            ("+48", "48 collapsed frames before this")
        );
    }

    #[test]
    fn kinds_are_told_apart_by_words() {
        let row = |kind, hex: &str| Row {
            number: 0,
            kind,
            time: String::new(),
            id: String::new(),
            hex: hex.to_owned(),
            meaning: String::new(),
            collapsed_before: 0,
        };
        let labels =
            [Kind::Tx, Kind::Rx, Kind::System, Kind::Error].map(|kind| looks(&row(kind, "01")).1);
        assert_eq!(labels, ["TX", "RX", "SYS", "ERR"]);
        assert_eq!(looks(&row(Kind::Error, "")).0, "packet error wordy");
    }
}
