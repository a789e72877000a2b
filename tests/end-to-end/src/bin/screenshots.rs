//! Takes pictures of the page with a virtual motor, in every theme and width, and the README's.
//!
//! `cargo xtask screenshots` builds everything and runs this. The pictures go into `screenshots/`, or the given
//! directory. The pictures of the manifest go into `public/screenshots/`; with `public` only these are taken. The
//! animated picture of the README goes into `docs/`; with `docs` only this one is taken.

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::ExitCode,
    thread,
    time::Duration,
};

use anyhow::{Context, Result};
use end_to_end::{Bench, Line, Page, Scheme, Usb, View, WAIT_MAX, wait_until};
use motorlink_i18n::{Language, set_language, translated};

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
    if dir == Path::new("docs") {
        return spinning(&dir.join("spinning.webp"));
    }
    for_installer(Path::new("public/screenshots"))?;
    if dir == Path::new("public") {
        return Ok(());
    }
    spinning(Path::new("docs/spinning.webp"))?;
    fs::create_dir_all(dir).with_context(|| format!("cannot make {}", dir.display()))?;
    for (language, schemes) in PICTURES {
        set_language(*language);
        for (name, view) in VIEWS {
            for scheme in *schemes {
                let prefix = match language {
                    Language::English => String::new(),
                    other => format!("{}-", other.key()),
                };
                let album = Album {
                    prefix: dir.join(format!("{prefix}{name}-{}", scheme.name())),
                    language: *language,
                };
                let view = view.with(*scheme);
                the_desk(&album, view)?;
                the_panels(&album, view)?;
                the_tools(&album, view)?;
            }
        }
    }
    Ok(())
}

const VIEWS: [(&str, View); 8] = [
    ("desk", View::DESKTOP),
    ("laptop", View::window(1366, 657)),
    ("wide", View::window(1920, 1080)),
    ("widest", View::window(2560, 1440)),
    ("tablet", View::TABLET),
    ("upright", View::window(768, 1024)),
    ("phone", View::PHONE),
    ("sideways", View::window(844, 390)),
];

/// Shows a screen of a phone; a wide window shows every part at once.
fn show_screen(page: &Page, view: View, screen: &str) -> Result<()> {
    if view.is_phone() {
        page.click("button", translated(screen))?;
    }
    Ok(())
}

/// Every colour scheme in one language, and every language in one scheme: texts and colours are independent.
const PICTURES: &[(Language, &[Scheme])] = &[
    (
        Language::English,
        &[Scheme::Light, Scheme::Dark, Scheme::Contrast],
    ),
    (Language::Chinese, &[Scheme::Light]),
    (Language::German, &[Scheme::Dark]),
];

/// The two pictures that a browser shows when it offers to install the page.
fn for_installer(dir: &Path) -> Result<()> {
    fs::create_dir_all(dir).with_context(|| format!("cannot make {}", dir.display()))?;
    for (name, view) in [("wide", View::DESKTOP), ("narrow", View::PHONE)] {
        let bench = Bench::start()?;
        let page = bench.open("/?port=virtual")?;
        page.look(view)?;
        page.wait_for_text("output", "Mode", |text| text.contains("elocity"))?;
        for (button, speed) in [("-50", "50"), ("+100", "100")] {
            page.click("button", button)?;
            page.wait_for_text("output", "Speed", |text| text.contains(speed))?;
            pause(2_000);
        }
        // The click has scrolled the phone's page down.
        page.evaluate("scrollTo(0, 0)")?;
        let file = dir.join(format!("{name}.webp"));
        println!("{}", file.display());
        page.screenshot_webp(&file)?;
    }
    Ok(())
}

/// The picture of the README. The wheel makes one turn, so that the loop has no jump. It turns slowly, because a
/// machine without a GPU takes two pictures a second.
fn spinning(file: &Path) -> Result<()> {
    let turn = Duration::from_secs(12);
    let bench = Bench::start()?;
    let page = bench.open("/?port=virtual")?;
    page.look(View::DESKTOP)?;
    page.wait_for_text("output", "Mode", |text| text.contains("elocity"))?;
    // Something for the graph to show.
    for (button, speed) in [("-50", "50"), ("+100", "100"), ("+50", "50")] {
        page.click("button", button)?;
        page.wait_for_text("output", "Speed", |text| text.contains(speed))?;
        pause(2_000);
    }
    page.fill("spinbutton", "Target speed", "5")?;
    pause(2_000);
    println!("{}", file.display());
    page.record_webp(View::DESKTOP, 960, 24, turn, file)
}

/// Pictures of one view.
struct Album {
    prefix: PathBuf,
    language: Language,
}

impl Album {
    fn address(&self) -> String {
        format!("/?lang={}", self.language.key())
    }

    fn file(&self, what: &str) -> PathBuf {
        let file = PathBuf::from(format!("{}-{what}.png", self.prefix.display()));
        println!("{}", file.display());
        file
    }

    fn shot(&self, page: &Page, what: &str) -> Result<()> {
        page.screenshot(&self.file(what))
    }

    fn whole(&self, page: &Page, what: &str) -> Result<()> {
        page.screenshot_whole(&self.file(what))
    }
}

/// The desk with the built-in virtual motor: empty, driving, stopped, and in its dialogs.
fn the_desk(album: &Album, view: View) -> Result<()> {
    let bench = Bench::start()?;
    let page = bench.open(&album.address())?;
    page.look(view)?;
    pause(500);
    album.shot(&page, "empty")?;
    page.click("button", translated("Virtual motor"))?;
    page.wait_for_text("status", translated("Connection"), |text| {
        text.contains(translated("Connected"))
    })?;
    // Something for the graph to show.
    for (button, speed) in [
        ("-50", "50"),
        ("+50", "50"),
        ("-100", "100"),
        ("+100", "100"),
    ] {
        page.click("button", button)?;
        page.wait_for_text("output", translated("Speed"), |text| text.contains(speed))?;
        pause(2_000);
    }
    album.shot(&page, "spinning")?;
    album.whole(&page, "spinning-whole")?;
    page.press("Escape")?;
    pause(800);
    album.shot(&page, "stopped")?;
    page.click("button", translated("Release"))?;
    for tab in ["Current", "Position"] {
        page.click("tab", translated(tab))?;
        pause(300);
        album.shot(&page, &tab.to_lowercase())?;
    }
    if view.is_phone() {
        for screen in ["Graph", "Log", "Motors", "More"] {
            show_screen(&page, view, screen)?;
            pause(500);
            album.shot(&page, &screen.to_lowercase())?;
        }
    } else {
        page.click("button", translated("Expand"))?;
        pause(500);
        album.shot(&page, "expanded")?;
        page.click("button", translated("Shrink"))?;
    }
    page.click("button", translated("Help"))?;
    pause(300);
    album.shot(&page, "help")
}

/// The panels of the drawer, with the virtual motor.
fn the_panels(album: &Album, view: View) -> Result<()> {
    let bench = Bench::start()?;
    let page = bench.open(&album.address())?;
    page.look(view)?;
    page.click("button", translated("Virtual motor"))?;
    page.wait_for_text("status", translated("Connection"), |text| {
        text.contains(translated("Connected"))
    })?;
    for panel in ["Drive together", "Link", "Settings"] {
        show_screen(&page, view, "More")?;
        page.click("button", translated(panel))?;
        pause(500);
        album.shot(&page, &panel.to_lowercase().replace(' ', "-"))?;
        page.click("button", translated("Close the panel"))?;
    }
    Ok(())
}

/// The tools with three motors on the bus.
fn the_tools(album: &Album, view: View) -> Result<()> {
    let bench = Bench::start()?;
    let _adapter = bench.plug(Line::with_motors(&[1, 2, 7]), Usb::default())?;
    let page = bench.open(&album.address())?;
    page.look(view)?;
    page.click("button", translated("Connect"))?;
    page.wait_for_text("status", translated("Connection"), |text| {
        text.contains(translated("Connected"))
    })?;
    page.click("tab", translated("ID Manager"))?;
    page.click("button", translated("Full scan"))?;
    page.wait_for_text("list", translated("Motors found"), |text| {
        text.contains("0x07")
    })?;
    album.shot(&page, "scanning")?;
    wait_until("the end of the scan", WAIT_MAX, || {
        let cancel = page.find("button", translated("Cancel"))?;
        Ok(if cancel.disabled {
            Ok(())
        } else {
            Err("it goes on".to_owned())
        })
    })?;
    pause(300);
    album.shot(&page, "id-manager")?;
    page.click("tab", translated("Raw Hex"))?;
    page.find("textbox", translated("Frame bytes"))?
        .type_over("01 74 00 00 00 00 00 00 00")?;
    // On a busy machine a reply can be late and is then shown as missing.
    wait_until("an answer", WAIT_MAX, || {
        page.click("button", translated("Send"))?;
        pause(300);
        let answer = page.text("output", translated("Reply"))?;
        Ok(if answer.contains("0x01") {
            Ok(())
        } else {
            Err(answer)
        })
    })?;
    album.shot(&page, "raw-hex")
}

/// Waits until animations have ended.
fn pause(ms: u64) {
    thread::sleep(Duration::from_millis(ms));
}
