//! The list `Packets`: rows, and what becomes of them while one scrolls.

use motorlink_messages::recorder::Kind;
use wasm_bindgen::JsCast;
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::HtmlElement;

use crate::{
    bench::{Bench, pause, press, text_of},
    log_bench::{numbers, page, rows},
};

fn scroller(bench: &Bench) -> HtmlElement {
    bench.find("log", "Packets")
}

fn auto_scrolls(bench: &Bench) -> bool {
    let checkbox = bench.find("checkbox", "Auto-scroll");
    checkbox
        .unchecked_into::<web_sys::HtmlInputElement>()
        .checked()
}

async fn scroll_by(bench: &Bench, px: f64) {
    let scroller = scroller(bench);
    scroller.set_scroll_top(scroller.scroll_top() + px);
    pause(100).await;
    // A row that the recorder has not yet brought is number 0, as the first is.
    bench
        .until("the rows to be brought", || {
            numbers(bench).iter().skip(1).all(|number| *number > 0)
        })
        .await;
}

#[wasm_bindgen_test]
async fn rows_appear_in_words_and_are_told_apart() {
    let (recorder, bench, _style) = page("rows", 2).await;
    recorder.log_row(|row| {
        row.kind = Kind::Error;
        row.meaning = String::from("<b>CRC</b> is 5B");
        row.collapsed_before = 48;
    });
    recorder.log_row(|row| {
        row.kind = Kind::System;
        row.hex.clear();
        row.id.clear();
        row.meaning = String::from("Disconnected");
    });
    bench.until("four rows", || rows(&bench).len() == 4).await;
    let rows = rows(&bench);
    let kinds: Vec<String> = rows.iter().map(|row| row.text("kind")).collect();
    assert_eq!(kinds, ["TX", "TX", "ERR", "SYS"]);
    assert_eq!(rows[1].text("time"), "13:15:36.962");
    assert_eq!(rows[1].text("id"), "0x01");
    assert_eq!(rows[1].text("hex"), "01 64 00 64 00 00 01 00 00 A1");
    assert_eq!(rows[2].text("meaning"), "<b>CRC</b> is 5B");
    assert_eq!(rows[2].text("before"), "+48");
    assert_eq!(rows[2].0.class_name(), "packet error");
    assert_eq!(rows[3].0.class_name(), "packet system wordy");
    assert_eq!(bench.text("status", "Entries"), "4 entries");
}

#[wasm_bindgen_test]
async fn a_long_log_has_no_more_elements_than_rows_that_are_seen() {
    let (recorder, bench, _style) = page("virtual", 5_000).await;
    assert_eq!(numbers(&bench), (4_990..5_000).collect::<Vec<_>>());
    recorder.log(3);
    bench
        .until("the newest", || numbers(&bench).last() == Some(&5_002))
        .await;
    assert_eq!(numbers(&bench), (4_993..5_003).collect::<Vec<_>>());
    let scroller = scroller(&bench);
    assert_eq!(scroller.scroll_height(), 5_003 * 24);
    // Where it begins between two pixels, one goes to its neighbour.
    assert!((239..=240).contains(&scroller.client_height()));
    assert!((scroller.scroll_top() - f64::from(4_993 * 24)).abs() < 1.5);
}

/// A browser that translates the page puts each text into elements of its own.
#[wasm_bindgen_test]
async fn a_translated_page_shows_new_rows() {
    let (recorder, bench, _style) = page("translated", 5_000).await;
    for row in rows(&bench) {
        let meaning = row.0.query_selector(".packet-meaning").unwrap().unwrap();
        meaning.set_inner_html("<font><font>translated</font></font>");
    }
    recorder.log_row(|row| row.meaning = String::from("Disconnected"));
    bench
        .until("the new row", || {
            let rows = rows(&bench);
            let newest = rows.last().map(|row| row.text("meaning"));
            newest.as_deref() == Some("Disconnected")
        })
        .await;
}

/// Tab goes through the buttons of the rows to the next control.
#[wasm_bindgen_test]
async fn auto_scroll_goes_on_when_the_focus_has_passed_by() {
    let (recorder, bench, _style) = page("auto-scroll-focus", 50).await;
    recorder.log_row(|row| row.collapsed_before = 48);
    let button = || {
        let rows = rows(&bench);
        let button = rows.last()?.0.query_selector("button:not([hidden])");
        button.unwrap()?.dyn_into::<HtmlElement>().ok()
    };
    bench.until("a row to open", || button().is_some()).await;
    let filter = bench.find("searchbox", "Filter");
    button().unwrap().focus().unwrap();
    bench
        .until("a list at rest", || !auto_scrolls(&bench))
        .await;
    // Backwards too.
    press("Shift");
    press("Tab");
    filter.focus().unwrap();
    bench
        .until("the newest again", || auto_scrolls(&bench))
        .await;
    // What was opened stays in sight.
    button().unwrap().focus().unwrap();
    button().unwrap().click();
    filter.focus().unwrap();
    pause(100).await;
    assert!(!auto_scrolls(&bench));
}

#[wasm_bindgen_test]
async fn auto_scroll_lets_go_of_a_person_who_scrolls_up_and_offers_the_way_back() {
    let (recorder, bench, _style) = page("auto-scroll", 500).await;
    assert!(auto_scrolls(&bench));
    assert!(bench.find_all("button", "Jump to newest").is_empty());

    scroll_by(&bench, -72.0).await;
    assert!(!auto_scrolls(&bench));
    assert_eq!(numbers(&bench), (487..497).collect::<Vec<_>>());
    let top = rows(&bench)[0].top();
    recorder.log(12);
    let back = || {
        let button = bench.find_all("button", "Jump to newest");
        button.first().map(text_of).unwrap_or_default()
    };
    bench.until("the count", || back().contains("12 new")).await;
    assert_eq!(numbers(&bench), (487..497).collect::<Vec<_>>());
    assert!((rows(&bench)[0].top() - top).abs() < 0.5);

    bench.click("Jump to newest");
    bench
        .until("the newest", || numbers(&bench).last() == Some(&511))
        .await;
    assert!(auto_scrolls(&bench));

    // By the scroll bar.
    scroll_by(&bench, -300.0).await;
    assert!(!auto_scrolls(&bench));
    scroll_by(&bench, 10_000.0).await;
    assert!(auto_scrolls(&bench));

    // By the checkbox.
    bench.find("checkbox", "Auto-scroll").click();
    recorder.log(1);
    bench.until("one new", || back().contains("1 new")).await;
    assert_eq!(numbers(&bench).last(), Some(&511));
    bench.find("checkbox", "Auto-scroll").click();
    bench
        .until("the newest", || numbers(&bench).last() == Some(&512))
        .await;
}

#[wasm_bindgen_test]
async fn what_is_read_does_not_move_when_old_rows_give_way() {
    let (recorder, bench, _style) = page("give-way", 1_000).await;
    scroll_by(&bench, -5_000.0).await;
    let (before, top) = (numbers(&bench), rows(&bench)[0].top());
    for _ in 0..3 {
        recorder.drop_oldest(100);
        pause(400).await;
        assert_eq!(numbers(&bench), before);
        assert!((rows(&bench)[0].top() - top).abs() < 0.5);
    }
    let entries = bench.text("status", "Entries");
    assert_eq!(entries, "700 entries, 300 dropped");
    let scroll_height = scroller(&bench).scroll_height();
    assert_eq!(scroll_height, 700 * 24);
}
