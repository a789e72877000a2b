//! Takes pictures of the page with a virtual motor in every window, theme and language, and the README's.
//!
//! `cargo xtask screenshots` builds everything and runs this. The pictures go into `target/screenshots/`, or the
//! given directory; of these, further words choose the pictures with all of them in their names, such as
//! `target/screenshots phone de`. It fails if a text in a picture is cut or over another one. The pictures of the manifest
//! go into `public/screenshots/`, and the animated picture of the README goes into `docs/`; with `public` or `docs` only these are taken.

use std::{
    cell::RefCell,
    env, fs,
    path::{Path, PathBuf},
    process::ExitCode,
    thread,
    time::Duration,
};

use anyhow::{Context, Result, ensure};
use end_to_end::{Bench, Line, Page, Scheme, Usb, View, WAIT_MAX, wait_until};
use motorlink_i18n::{Language, set_language, translated};

fn main() -> ExitCode {
    let mut args = env::args().skip(1);
    let dir = args.next().unwrap_or_else(|| "target/screenshots".into());
    let words: Vec<String> = args.collect();
    match take(Path::new(&dir), &words) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("screenshots: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn take(dir: &Path, words: &[String]) -> Result<()> {
    match dir.to_str() {
        Some("docs") => return spinning(&dir.join("spinning.webp")),
        Some("public") => return for_installer(&dir.join("screenshots")),
        _ => {}
    }
    fs::create_dir_all(dir).with_context(|| format!("cannot make {}", dir.display()))?;
    let mut unreadable = Vec::new();
    for language in Language::ALL {
        set_language(language);
        let album = Album {
            dir: dir.to_owned(),
            language,
            words: words.to_vec(),
            unreadable: RefCell::default(),
        };
        if album.is_empty() {
            continue;
        }
        the_desk(&album)?;
        the_places(&album)?;
        the_tools(&album)?;
        unreadable.extend(album.unreadable.take());
    }
    ensure!(unreadable.is_empty(), "{}", unreadable.join("\n"));
    Ok(())
}

const VIEWS: [(&str, View); 10] = [
    ("phone", View::PHONE),
    ("sideways", View::window(844, 390)),
    ("upright", View::window(768, 1024)),
    ("tablet", View::TABLET),
    ("laptop", View::window(1366, 657)),
    ("desk", View::DESKTOP),
    ("wide", View::window(1920, 1080)),
    ("widest", View::window(2560, 1440)),
    // A window of 1440 x 900 at 200 %, and one of 1280 x 1024 at 400 %.
    ("twice", View::window(720, 450)),
    ("fourfold", View::window(320, 256)),
];

/// The two pictures that a browser shows when it offers to install the page.
fn for_installer(dir: &Path) -> Result<()> {
    fs::create_dir_all(dir).with_context(|| format!("cannot make {}", dir.display()))?;
    for (name, view) in [("wide", View::DESKTOP), ("narrow", View::PHONE)] {
        let bench = Bench::start()?;
        let page = bench.open("/?port=virtual")?;
        look(&page, view)?;
        page.wait_for_text("output", "Mode", |text| text.contains("elocity"))?;
        page.click("button", "Skip the tour")?;
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
    page.click("button", "Skip the tour")?;
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

/// The pictures in one language: `desk-dark-de-spinning.png`.
struct Album {
    dir: PathBuf,
    language: Language,
    /// What the name of a picture has to contain.
    words: Vec<String>,
    /// Texts that nobody can read, with the names of their pictures.
    unreadable: RefCell<Vec<String>>,
}

impl Album {
    fn address(&self) -> String {
        format!("/?lang={}", self.language.key())
    }

    /// Whether another language is asked for.
    fn is_empty(&self) -> bool {
        let other = |key: &str| key != self.language.key();
        let is_key = |key: &str| Language::ALL.iter().any(|one| one.key() == key);
        self.words.iter().any(|word| is_key(word) && other(word))
    }

    fn file(&self, view: &str, scheme: Scheme, what: &str) -> Option<PathBuf> {
        let language = self.language.key();
        let name = format!("{view}-{}-{language}-{what}", scheme.name());
        let is_of = |word: &String| name.split('-').any(|part| part == word);
        let file = self.dir.join(format!("{name}.png"));
        self.words.iter().all(is_of).then_some(file)
    }

    /// What a phone has on one of its screens, and a wide window anyway.
    fn shot(&self, page: &Page, what: &str) -> Result<()> {
        self.shot_in(page, what, |_| true)
    }

    /// The same, in these windows.
    fn shot_in(&self, page: &Page, what: &str, has_it: impl Fn(View) -> bool) -> Result<()> {
        for (name, view) in VIEWS.into_iter().filter(|(_, view)| has_it(*view)) {
            for scheme in [Scheme::Light, Scheme::Dark, Scheme::Contrast] {
                // What high contrast changes does not depend on the language.
                if scheme == Scheme::Contrast && self.language != Language::English {
                    continue;
                }
                let Some(file) = self.file(name, scheme, what) else {
                    continue;
                };
                look(page, view.with(scheme))?;
                page.evaluate("scrollTo(0, 0)")?;
                pause(250);
                println!("{}", file.display());
                page.screenshot(&file)?;
                let texts = page.unreadable()?.into_iter();
                let texts = texts.map(|text| format!("{}: {text}", file.display()));
                self.unreadable.borrow_mut().extend(texts);
            }
        }
        look(page, View::DESKTOP)
    }
}

/// Shows the page in a window, and on a phone under fingers.
fn look(page: &Page, view: View) -> Result<()> {
    if view.is_phone() {
        page.touch()?;
    } else {
        page.untouch()?;
    }
    page.look(view)
}

fn connected(page: &Page) -> Result<()> {
    page.wait_for_text("status", translated("Connection"), |text| {
        text.contains(translated("Connected"))
    })?;
    page.wait_for_text("output", translated("Mode"), |text| {
        text.chars().any(char::is_alphabetic)
    })
    .map(drop)
}

/// The desk with the built-in virtual motor: empty, driving, stopped, and in its dialogs.
fn the_desk(album: &Album) -> Result<()> {
    let bench = Bench::start()?;
    let page = bench.open(&album.address())?;
    page.look(View::DESKTOP)?;
    pause(500);
    album.shot(&page, "empty")?;
    page.click("button", translated("Virtual motor"))?;
    connected(&page)?;
    album.shot(&page, "tour")?;
    page.click("button", translated("Skip the tour"))?;
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
    page.click("button", translated("Expand"))?;
    album.shot_in(&page, "expanded", |view| !view.is_phone())?;
    page.click("button", translated("Shrink"))?;
    page.press("Escape")?;
    pause(800);
    album.shot(&page, "stopped")?;
    page.click("button", translated("Release"))?;
    for tab in ["Current", "Position"] {
        page.click("tab", translated(tab))?;
        album.shot(&page, &tab.to_lowercase())?;
    }
    page.click("button", translated("Help"))?;
    album.shot(&page, "help")
}

/// The places, with the virtual motor.
fn the_places(album: &Album) -> Result<()> {
    let bench = Bench::start()?;
    let page = bench.open(&album.address())?;
    page.look(View::DESKTOP)?;
    page.click("button", translated("Virtual motor"))?;
    connected(&page)?;
    page.click("button", translated("Skip the tour"))?;
    page.click("button", "+100")?;
    for (panel, place) in [
        ("Session file", "record"),
        ("Experiments", "test"),
        ("Settings", "setup"),
        ("Link health", "diagnose"),
    ] {
        page.open_panel(panel)?;
        pause(500);
        album.shot(&page, place)?;
    }
    Ok(())
}

/// The tools with four motors on the bus.
fn the_tools(album: &Album) -> Result<()> {
    let bench = Bench::start()?;
    let _adapter = bench.plug(Line::with_motors(&[1, 2, 3, 7]), Usb::default())?;
    let page = bench.open(&album.address())?;
    page.look(View::DESKTOP)?;
    page.click("button", translated("Connect motor"))?;
    connected(&page)?;
    page.open_panel("ID Manager")?;
    page.click("button", translated("Full scan"))?;
    page.wait_for_text("list", translated("Motors found"), |text| {
        text.contains("0x07")
    })?;
    wait_until("the end of the scan", WAIT_MAX, || {
        let cancel = page.find("button", translated("Cancel"))?;
        Ok(if cancel.disabled {
            Ok(())
        } else {
            Err("it goes on".to_owned())
        })
    })?;
    album.shot(&page, "id_manager")?;
    page.open_panel("Raw Hex")?;
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
    album.shot(&page, "raw_hex")?;
    page.open_panel("Drive together")?;
    pause(500);
    album.shot(&page, "four_motors")
}

/// Waits until animations have ended.
fn pause(ms: u64) {
    thread::sleep(Duration::from_millis(ms));
}
