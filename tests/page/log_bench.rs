//! A page whose recorder keeps rows, and the rows that it shows.

use motorlink_messages::protocol::Mode;
use wasm_bindgen::JsCast;
use web_sys::Element;

use crate::{
    bench::{Bench, document},
    fake_recorder::FakeRecorder,
};

/// A page with a recorder that keeps so many entries, and a list of ten rows.
pub async fn page(name: &str, entries: usize) -> (FakeRecorder, Bench, Style) {
    let style = Style::new();
    let recorder = FakeRecorder::new(name);
    let bench = Bench::with_motor(name, Mode::Velocity).await;
    recorder.log(entries);
    bench
        .until("the newest row", || {
            entries == 0
                || rows(&bench)
                    .last()
                    .is_some_and(|row| row.number() + 1 == entries)
        })
        .await;
    recorder.received().await;
    (recorder, bench, style)
}

/// The looks of the list, without which nothing scrolls.
pub struct Style(Element);

impl Style {
    pub fn new() -> Self {
        let style = document().create_element("style").unwrap();
        let sheet = include_str!("../../style/later/65-log.css");
        let sheet = format!(
            "{sheet} .packet-list {{ flex: none; box-sizing: border-box; width: 600px; height: 240px; }}"
        );
        style.set_text_content(Some(&sheet));
        document().head().unwrap().append_child(&style).unwrap();
        Self(style)
    }
}

impl Drop for Style {
    fn drop(&mut self) {
        self.0.remove();
    }
}

pub struct Shown(pub Element);

impl Shown {
    pub fn text(&self, part: &str) -> String {
        let part = self.0.query_selector(&format!(".packet-{part}")).unwrap();
        part.unwrap().text_content().unwrap()
    }

    pub fn number(&self) -> usize {
        let meaning = self.text("meaning");
        let number = meaning.strip_prefix("frame ").unwrap_or("0");
        number.parse().unwrap()
    }

    pub fn top(&self) -> f64 {
        self.0.get_bounding_client_rect().top()
    }
}

/// The rows in the list, in their order.
pub fn rows(bench: &Bench) -> Vec<Shown> {
    let found = bench
        .find("log", "Packets")
        .query_selector_all(".packet")
        .unwrap();
    let rows = (0..found.length()).filter_map(|place| found.get(place)?.dyn_into().ok());
    rows.map(Shown).collect()
}

pub fn numbers(bench: &Bench) -> Vec<usize> {
    rows(bench).iter().map(Shown::number).collect()
}
