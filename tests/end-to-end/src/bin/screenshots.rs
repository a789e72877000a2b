//! Takes pictures of the page with a virtual motor, in every theme and width, and the README's.
//!
//! `cargo xtask screenshots` builds what is needed and runs this. They go into `screenshots/`, or the
//! directory that is given.

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::ExitCode,
    thread,
    time::Duration,
};

use anyhow::{Context, Result};
use end_to_end::{Bench, Page, View};

fn main() -> ExitCode {
    let dir = env::args()
        .nth(1)
        .map_or_else(|| PathBuf::from("screenshots"), PathBuf::from);
    match take(&dir) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("screenshots: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn take(dir: &Path) -> Result<()> {
    fs::create_dir_all(dir).with_context(|| format!("cannot make {}", dir.display()))?;
    let views = [
        ("desk", View::DESKTOP),
        ("tablet", View::TABLET),
        ("phone", View::PHONE),
    ];
    for (name, view) in views {
        for (theme, view) in [("light", view), ("dark", view.dark())] {
            let bench = Bench::start()?;
            let page = bench.open("/")?;
            page.look(view)?;
            let shot = |page: &Page, what: &str| {
                let file = dir.join(format!("{name}-{theme}-{what}.png"));
                println!("{}", file.display());
                page.screenshot(&file)
            };
            thread::sleep(Duration::from_millis(500));
            shot(&page, "empty")?;
            page.click("button", "Virtual motor")?;
            page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
            page.click("button", "+100")?;
            page.wait_for_text("output", "Speed", |text| text.contains("100"))?;
            thread::sleep(Duration::from_millis(1_500));
            shot(&page, "spinning")?;
            page.press("Escape")?;
            thread::sleep(Duration::from_millis(800));
            shot(&page, "stopped")?;
            page.click("button", "Release")?;
            for tab in ["Current", "Position"] {
                page.click("tab", tab)?;
                thread::sleep(Duration::from_millis(300));
                shot(&page, &tab.to_lowercase())?;
            }
            page.click("button", "Help")?;
            thread::sleep(Duration::from_millis(300));
            shot(&page, "help")?;
        }
    }
    Ok(())
}
