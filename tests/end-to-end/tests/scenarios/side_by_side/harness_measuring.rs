//! The harness itself, where it measures a page: its files, its work, its memory, its pictures.

use std::path::Path;
use std::time::Duration;

use anyhow::Result;
use end_to_end::{Bench, Line, Usb, WAIT_MAX, wait_until};

fn bench() -> Result<Bench> {
    Bench::serving(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures")))
}

#[test]
fn a_file_is_complete_and_the_next_may_have_its_name() -> Result<()> {
    let bench = bench()?;
    let page = bench.open("/")?;
    let first = page.download("Save")?;
    let second = page.download("Save")?;
    assert_eq!([first.name.as_str(), &second.name], ["thing.csv"; 2]);
    assert_ne!(first.path, second.path);
    for file in [first, second] {
        assert_eq!(file.bytes()?, b"saved\r\n");
    }
    Ok(())
}

#[test]
fn a_long_task_and_what_a_page_measures_are_noted_once() -> Result<()> {
    let bench = bench()?;
    let page = bench.open("/")?;
    page.work()?;
    page.click("button", "Toil")?;
    let work = page.work()?;
    assert!(work.longest_task() >= Duration::from_millis(80), "{work:?}");
    let toil = work.durations_of("toil");
    assert_eq!(toil.len(), 1, "{work:?}");
    assert!(toil[0] >= Duration::from_millis(79), "{work:?}");
    assert!(page.work()?.measures.is_empty());
    Ok(())
}

#[test]
fn the_memory_of_a_worker_is_known_with_that_of_its_program() -> Result<()> {
    let bench = bench()?;
    let page = bench.open("/")?;
    // The worker is there before its script has run, and frees later what it needed only to start.
    let mut before = None;
    let small = wait_until("the worker to have started", WAIT_MAX, || {
        let memory = page.memory_of_worker("port")?;
        let is_at_rest = memory.wasm > 0 && before == Some(memory);
        before = Some(memory);
        Ok(if is_at_rest {
            Ok(memory)
        } else {
            Err(format!("{memory:?}"))
        })
    })?;
    assert_eq!(small.wasm, 3 * 65_536);
    page.evaluate("worker.postMessage({ hoard: 5_000_000 })")?;
    wait_until("the worker to hold 5 MB more", WAIT_MAX, || {
        let large = page.memory_of_worker("port")?;
        Ok(if large.script >= small.script + 5_000_000 {
            Ok(())
        } else {
            Err(format!("{small:?} {large:?}"))
        })
    })?;
    assert_eq!(page.memory()?.wasm, 0);
    let error = page.memory_of_worker("nobody").unwrap_err();
    assert!(error.to_string().contains("nobody"), "{error:#}");
    Ok(())
}

#[test]
fn lists_and_pictures_are_read() -> Result<()> {
    let bench = bench()?;
    let page = bench.open("/")?;
    assert_eq!(
        page.find("list", "Things")?.items()?,
        ["first thing", "second"]
    );
    assert_eq!(page.find_like("button", "Toi")?.name, "Toil");
    assert!(page.find_like("button", "o").is_err(), "several");
    assert_eq!(page.find("img", "Picture")?.coloured_pixels()?, 100);
    Ok(())
}

#[test]
fn a_hand_acts_on_a_motor() -> Result<()> {
    let bench = bench()?;
    let mut adapter = bench.plug(Line::default(), Usb::default())?;
    assert_eq!(adapter.act("temperature 1 77")?, "ok 1 temperature 77");
    assert!(adapter.act("state 1")?.contains("temperature=77"));
    let error = adapter.act("dance 1").unwrap_err();
    assert!(error.to_string().contains("dance"), "{error:#}");
    Ok(())
}

#[test]
fn a_script_runs_before_those_of_the_page() -> Result<()> {
    let bench = bench()?;
    let page = bench.open("/")?;
    page.before_load("globalThis.early = document.readyState + typeof $")?;
    page.reload()?;
    assert_eq!(page.evaluate("early")?, "loadingundefined");
    Ok(())
}
