//! A run that the graph keeps, under the next one.

use gloo_timers::future::TimeoutFuture;
use motorlink_messages::{
    bus::Activity,
    protocol::{Setpoint, SpeedTarget},
};
use wasm_bindgen::JsCast;
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{Event, HtmlSelectElement};

use super::{Page, bench, canvas, colour_of, now_ms, report_activity, rows_of, sample, steady};

/// Drives for half a second, and reports this speed.
async fn drive(bench: &Page, rpm: i16) {
    let target = SpeedTarget::new(rpm.into()).unwrap();
    let activity = Activity::Driven {
        setpoint: Setpoint::velocity(target),
    };
    for _ in 0..10 {
        report_activity(bench, activity, vec![sample(now_ms(), rpm)]);
        TimeoutFuture::new(50).await;
    }
}

/// 35 % of the colour on the background: what `kept/drawing.rs` draws.
fn pale(bench: &Page) -> [u8; 3] {
    let (speed, surface) = (colour_of(bench, "--speed"), colour_of(bench, "--surface"));
    let mixed = |place: usize| {
        let sum = u16::from(speed[place]) * 35 + u16::from(surface[place]) * 65;
        u8::try_from(sum / 100).unwrap()
    };
    [mixed(0), mixed(1), mixed(2)]
}

#[wasm_bindgen_test]
async fn a_kept_run_is_under_the_next_one_from_its_start() {
    let bench = bench("graph-kept").await;
    let canvas = canvas(&bench);
    let kept = pale(&bench);
    let kept_rows = || rows_of(&canvas, kept, 3);
    let text = || bench.text("group", "Reference");
    assert!(bench.find_all("group", "Reference").is_empty());
    report_activity(&bench, Activity::Idle, steady(5_000, 0));
    drive(&bench, 200).await;
    bench.click("Pin as reference");
    bench
        .until("the row", || {
            !bench.find_all("group", "Reference").is_empty()
        })
        .await;
    assert!(text().contains("0x01, live, "), "{}", text());

    report_activity(&bench, Activity::Idle, vec![sample(now_ms(), 0)]);
    drive(&bench, 60).await;
    bench
        .until("the kept run", || !kept_rows().is_empty())
        .await;
    // The line of the first run is still in sight, farther left: both are at 200 rpm.
    let speed = colour_of(&bench, "--speed");
    let top = |rows: Vec<usize>| rows.into_iter().min().unwrap();
    let (kept_top, first_top) = (top(kept_rows()), top(rows_of(&canvas, speed, 3)));
    assert!(kept_top.abs_diff(first_top) < 8, "{kept_top} {first_top}");

    // It was kept before it ended.
    let align = bench.find("combobox", "Align at");
    let align: HtmlSelectElement = align.dyn_into().unwrap();
    align.set_value("stop");
    align
        .dispatch_event(&Event::new("change").unwrap())
        .unwrap();
    let missing = || text().contains("One of the runs has no such event here.");
    bench.until("the reason", missing).await;
    bench.until("no kept run", || kept_rows().is_empty()).await;
    align.set_value("target");
    align
        .dispatch_event(&Event::new("change").unwrap())
        .unwrap();
    bench
        .until("the kept run again", || !kept_rows().is_empty())
        .await;
    assert!(!missing());

    bench.click("Remove the reference");
    bench
        .until("no row", || bench.find_all("group", "Reference").is_empty())
        .await;
    bench.until("no line", || kept_rows().is_empty()).await;
}
