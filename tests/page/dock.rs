//! The dock with graph and packet log: its edge by keys, its title, its tabs, and what is remembered of them.

use motorlink_messages::protocol::Mode;
use wasm_bindgen::JsCast;
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{Element, HtmlElement, Storage};

use crate::bench::{Bench, document, press};

const EDGE: (&str, &str) = ("separator", "Height of graph and packet log");
const TITLE: (&str, &str) = ("button", "Graph and packet log");

/// The style sheet as far as the dock needs it: a height with bounds.
const STYLE: &str = ".dock { height: clamp(200px, var(--graph-height, 300px), 500px); }";

/// A page whose browser remembers nothing of another page's dock. Dropping it forgets its own.
struct Page {
    bench: Bench,
    style: Element,
}

impl Page {
    async fn open(name: &str, remembered: &[(&str, &str)]) -> Self {
        forget();
        for (key, value) in remembered {
            storage().set_item(key, value).unwrap();
        }
        let style = document().create_element("style").unwrap();
        style.set_text_content(Some(STYLE));
        document().head().unwrap().append_child(&style).unwrap();
        let bench = Bench::with_motor(name, Mode::Velocity).await;
        Self { bench, style }
    }

    fn attribute(&self, of: (&str, &str), name: &str) -> String {
        let element = self.bench.find(of.0, of.1);
        element.get_attribute(name).unwrap_or_default()
    }

    async fn until(&self, of: (&str, &str), name: &str, value: &str) {
        let is = || self.attribute(of, name) == value;
        self.bench.until(&format!("{name} {value}"), is).await;
    }

    async fn until_height(&self, px: &str) {
        self.until(EDGE, "aria-valuenow", px).await;
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        self.style.remove();
        forget();
    }
}

fn forget() {
    for key in ["motorlink.graph-height", "motorlink.dock"] {
        storage().remove_item(key).unwrap();
    }
    let root: HtmlElement = document().document_element().unwrap().unchecked_into();
    root.style().remove_property("--graph-height").unwrap();
    root.remove_attribute("data-dock").unwrap();
}

fn storage() -> Storage {
    web_sys::window().unwrap().local_storage().unwrap().unwrap()
}

fn stored(key: &str) -> String {
    storage().get_item(key).unwrap().unwrap_or_default()
}

#[wasm_bindgen_test]
async fn keys_move_the_edge_within_its_bounds_and_the_height_is_stored() {
    let page = Page::open("dock-keys", &[]).await;
    page.until_height("300").await;
    page.bench.find(EDGE.0, EDGE.1).focus().unwrap();
    page.until(EDGE, "aria-valuemin", "200").await;
    page.until(EDGE, "aria-valuemax", "500").await;
    assert_eq!(page.attribute(EDGE, "aria-orientation"), "horizontal");
    page.until_height("300").await;
    for (key, height) in [
        ("ArrowUp", "320"),
        ("ArrowDown", "300"),
        ("End", "500"),
        ("ArrowUp", "500"),
        ("Home", "200"),
        ("ArrowDown", "200"),
        ("ArrowUp", "220"),
    ] {
        press(key);
        page.until_height(height).await;
        assert_eq!(stored("motorlink.graph-height"), height, "{key}");
    }
}

#[wasm_bindgen_test]
async fn a_remembered_height_is_shown_within_the_bounds_of_this_window() {
    for (remembered, shown) in [("350", "350"), ("9999", "500"), ("1", "200"), ("x", "300")] {
        let page = Page::open("dock-height", &[("motorlink.graph-height", remembered)]).await;
        page.until_height(shown).await;
    }
}

#[wasm_bindgen_test]
async fn the_title_folds_and_unfolds_and_that_is_remembered() {
    let page = Page::open("dock-fold", &[]).await;
    page.until(TITLE, "aria-expanded", "true").await;
    page.bench.click(TITLE.1);
    page.until(TITLE, "aria-expanded", "false").await;
    assert_eq!(stored("motorlink.dock"), "folded");
    page.bench.click(TITLE.1);
    page.until(TITLE, "aria-expanded", "true").await;
    assert_eq!(stored("motorlink.dock"), "");
    drop(page);
    let page = Page::open("dock-folded", &[("motorlink.dock", "folded log")]).await;
    page.until(TITLE, "aria-expanded", "false").await;
    page.until(("tab", "Packet log"), "aria-selected", "true")
        .await;
}

#[wasm_bindgen_test]
async fn keys_choose_a_tab_and_take_the_focus_there() {
    let page = Page::open("dock-tabs", &[]).await;
    let (graph, log) = (("tab", "Graph"), ("tab", "Packet log"));
    page.until(graph, "aria-selected", "true").await;
    page.bench.find(graph.0, graph.1).focus().unwrap();
    for (key, to) in [("ArrowRight", log), ("ArrowRight", graph), ("End", log)] {
        press(key);
        page.until(to, "aria-selected", "true").await;
        let focused = document().active_element().unwrap();
        assert_eq!(focused.text_content().unwrap(), to.1);
    }
    assert_eq!(stored("motorlink.dock"), "log");
}
