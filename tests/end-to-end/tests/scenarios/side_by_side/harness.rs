//! The harness itself, against a page of its own that does little more than talk to serial ports.

use std::path::Path;
use std::thread;
use std::time::Duration;

use anyhow::Result;
use end_to_end::{Adapter, Bench, Line, Page, Usb, View, WAIT_MAX, now_us, wait_until};

fn bench() -> Result<Bench> {
    Bench::serving(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures")))
}

/// A reply to a feedback query: ten bytes, the first the motor's ID.
fn is_reply(text: &str) -> bool {
    text.split(' ').count() == 10 && text.starts_with("01 ")
}

/// A page whose worker has opened the only port.
fn page_with_open_port(bench: &Bench) -> Result<Page> {
    let page = bench.open("/")?;
    page.wait_for_text("output", "Ports", |text| text.starts_with('1'))?;
    page.click("button", "Open in the worker")?;
    page.wait_for_text("output", "Port of the worker", |text| text == "open")?;
    Ok(page)
}

#[test]
fn a_page_talks_to_motors_through_ports_that_come_and_go() -> Result<()> {
    let bench = bench()?;
    let page = bench.open("/")?;
    page.wait_for_text("output", "Ports", |text| text == "0")?;

    let mut adapter = bench.plug(Line::default(), Usb::default())?;
    page.wait_for_text("output", "Ports", |text| text == "1 1a86:7523")?;
    page.wait_for_text("output", "Events of the window", |text| text == "connect")?;
    page.wait_for_text("output", "Events of the worker", |text| text == "connect")?;

    let before_us = now_us();
    page.click("button", "Ask from the window")?;
    page.wait_for_text("output", "Reply in the window", is_reply)?;
    page.click("button", "Open in the worker")?;
    page.wait_for_text("output", "Port of the worker", |text| text == "open")?;
    page.click("button", "Ask from the worker")?;
    page.wait_for_text("output", "Reply in the worker", is_reply)?;
    let wire = adapter.wire()?;
    assert_eq!(wire.from_host().since(before_us).len(), 2, "{wire}");
    assert_eq!(wire.from_motors().until(now_us()).len(), 2, "{wire}");

    adapter.unplug()?;
    let lost = |text: &str| text.contains("NetworkError");
    page.wait_for_text("output", "Port of the worker", lost)?;
    let pulled = |text: &str| text == "connect disconnect";
    page.wait_for_text("output", "Events of the window", pulled)?;
    page.wait_for_text("output", "Events of the worker", pulled)?;
    page.wait_for_text("output", "Ports", |text| text == "0")?;

    adapter.plug()?;
    let back = |text: &str| text == "connect disconnect connect";
    page.wait_for_text("output", "Events of the window", back)?;
    page.wait_for_text("output", "Ports", |text| text == "1 1a86:7523")?;
    page.click("button", "Ask from the window")?;
    wait_until("the third question", WAIT_MAX, || {
        let count = adapter.wire()?.from_host().len();
        Ok(if count == 3 {
            Ok(())
        } else {
            Err(format!("{count} frames"))
        })
    })?;
    assert_eq!(page.console_errors(), [""; 0]);
    bench.close(page)
}

#[test]
fn identical_adapters_are_both_there_and_unpermitted_ones_are_not() -> Result<()> {
    let bench = bench()?;
    let _first = bench.plug(Line::default(), Usb::default())?;
    let _second = bench.plug(Line::with_motors(&[2]), Usb::default())?;
    let _third = bench.plug(Line::default(), Usb::default().unpermitted())?;
    let _other = bench.plug(Line::default(), Usb::of(Usb::FTDI))?;
    let page = bench.open("/")?;
    let ports = page.wait_for_text("output", "Ports", |text| text.starts_with('3'))?;
    assert_eq!(ports.matches("1a86:7523").count(), 2, "{ports}");
    assert_eq!(ports.matches("403:6001").count(), 1, "{ports}");
    Ok(())
}

#[test]
fn a_key_is_timed_on_the_clock_of_the_wire() -> Result<()> {
    let bench = bench()?;
    let adapter = bench.plug(Line::default(), Usb::default())?;
    let page = page_with_open_port(&bench)?;
    for _ in 0..5 {
        let before_us = now_us();
        let press = page.press_timed("Escape")?;
        assert!(before_us < press.sent_us, "{press:?} {before_us}");
        assert!(press.sent_us <= press.received_us, "{press:?}");
        let frame = wait_until("the frame", WAIT_MAX, || {
            let wire = adapter.wire()?.from_host().since(before_us);
            Ok(wire.first().cloned().ok_or_else(|| "nothing".to_owned()))
        })?;
        assert!(frame.at_us > press.received_us, "{press:?} {frame:?}");
        println!(
            "key heard to frame on the wire: {} us",
            frame.at_us - press.received_us
        );
    }
    Ok(())
}

#[test]
fn controls_are_used_as_a_person_uses_them() -> Result<()> {
    let bench = bench()?;
    let page = bench.open("/")?;
    page.fill("spinbutton", "Speed", "-120")?;
    page.wait_for_text("output", "Values", |text| text == "-120 0 First")?;
    page.slide("Level", 70.0)?;
    page.choose("Model", "Second")?;
    page.wait_for_text("output", "Values", |text| text == "-120 70 Second")?;
    page.find("slider", "Level")?.focus()?;
    page.press("ArrowRight")?;
    page.wait_for_text("output", "Values", |text| text == "-120 71 Second")?;
    let error = page.choose("Model", "Third").unwrap_err();
    assert!(
        error.to_string().contains(r#"["First","Second"]"#),
        "{error:#}"
    );

    let never = page.find("button", "Never")?;
    assert!(never.disabled);
    assert_eq!(never.description, "Not before it is open");
    assert!(never.click().is_err());

    let holder = page.find("button", "Hold me")?;
    holder.hold()?;
    assert_eq!(page.text("output", "Held")?, "yes");
    holder.release()?;
    assert_eq!(page.text("output", "Held")?, "no");

    let soon = Duration::from_millis(50);
    let error = page
        .wait_for_text_within(soon, "output", "Held", |text| text == "maybe")
        .unwrap_err();
    assert!(error.to_string().ends_with(r#"instead: "no""#), "{error:#}");
    Ok(())
}

#[test]
fn a_page_that_complains_is_heard() -> Result<()> {
    let bench = bench()?;
    let page = bench.open("/")?;
    assert_eq!(page.console_errors(), [""; 0]);
    page.click("button", "Fail")?;
    for error in [
        "said by the console",
        "thrown by the page",
        "said by the worker",
        "thrown by the worker",
        "missing.json",
    ] {
        wait_until(error, WAIT_MAX, || {
            let errors = page.console_errors();
            let heard = errors.iter().any(|error| error.contains(error));
            Ok(if heard {
                Ok(())
            } else {
                Err(format!("{errors:?}"))
            })
        })?;
    }
    Ok(())
}

#[test]
fn a_hidden_page_is_really_hidden() -> Result<()> {
    let bench = bench()?;
    let page = bench.open("/")?;
    assert_eq!(page.visibility()?, "visible");
    bench.hide(&page)?;
    assert_eq!(page.visibility()?, "hidden");
    let frames = "new Promise((resolve) => {
        let count = 0;
        const next = () => { count += 1; requestAnimationFrame(next); };
        requestAnimationFrame(next);
        setTimeout(() => resolve(count), 500);
    })";
    assert_eq!(page.evaluate(frames)?, 0);
    page.show()?;
    let shown = page.evaluate(frames)?;
    assert!(shown.as_u64() > Some(1), "{shown} frames in half a second");
    println!("{shown} animation frames in half a second, shown");
    Ok(())
}

/// Waits until the host's last frame ends in this reason.
fn wait_for_last_frame(adapter: &Adapter, reason: u8) -> Result<()> {
    wait_until("the page's last frame", WAIT_MAX, || {
        let host = adapter.wire()?.from_host();
        let said = host
            .last()
            .is_some_and(|frame| frame.bytes.last() == Some(&reason));
        Ok(if said { Ok(()) } else { Err(host.to_string()) })
    })
}

#[test]
fn a_page_that_goes_has_its_last_word() -> Result<()> {
    let bench = bench()?;
    let adapter = bench.plug(Line::default(), Usb::default())?;

    bench.close(page_with_open_port(&bench)?)?;
    wait_for_last_frame(&adapter, 0xaa)?;

    let page = page_with_open_port(&bench)?;
    bench.hide(&page)?;
    page.freeze()?;
    wait_for_last_frame(&adapter, 0xbb)?;
    bench.close(page)?;

    let page = page_with_open_port(&bench)?;
    let before = adapter.wire()?.len();
    page.crash();
    thread::sleep(Duration::from_millis(100));
    assert_eq!(
        adapter.wire()?.len(),
        before,
        "a crash leaves no time for words"
    );
    Ok(())
}

#[test]
fn pages_are_photographed_in_any_window_and_colour() -> Result<()> {
    let bench = bench()?;
    let page = bench.open("/")?;
    let dir = tempfile::tempdir()?;
    for (view, background) in [
        (View::DESKTOP, "rgb(255, 255, 255)"),
        (View::TABLET.dark(), "rgb(0, 0, 0)"),
        (View::PHONE, "rgb(255, 255, 255)"),
    ] {
        page.look(view)?;
        let file = dir.path().join("page.png");
        page.screenshot(&file)?;
        let image = std::fs::read(&file)?;
        // A PNG file's header says its width in bytes 16 to 19.
        assert_eq!(image[16..20], view.width.to_be_bytes());
        let colour = page.evaluate("getComputedStyle(document.body).backgroundColor")?;
        assert_eq!(colour, background);
    }
    Ok(())
}

#[test]
fn a_picker_can_be_opened_and_dismissed() -> Result<()> {
    let bench = bench()?;
    let _adapter = bench.plug(Line::default(), Usb::default().unpermitted())?;
    let page = bench.open("/")?;
    page.click("button", "Pick a port")?;
    page.wait_for_text("output", "Picked", |text| text == "picking")?;
    page.dismiss_picker(|| Ok(page.text("output", "Picked")?.contains("NotFoundError")))?;
    page.wait_for_text("output", "Ports", |text| text == "0")?;
    Ok(())
}
