//! What a machine can judge of the page's accessibility: axe on every screen, in every theme, language and
//! width.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test fails by panicking, in its helpers too"
)]

mod story;

use std::collections::BTreeMap;
use std::fs;

use anyhow::{Context, Result};
use end_to_end::{Bench, Page, View, artefacts};
use story::{open_panel, wait_for_speed, wait_until_enabled};

/// As they stand in the address.
const LANGUAGES: [&str; 1] = ["en"];

/// Runs axe; gives a line for each element that breaks a rule.
const JUDGE: &str = "(async () => {
    const tags = ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa', 'best-practice'];
    const { violations } = await axe.run(document, { runOnly: tags, resultTypes: ['violations'] });
    return violations.flatMap(({ id, nodes }) => nodes.map((node) => {
        const all = [...node.any, ...node.all, ...node.none].map(({ message }) => message);
        return `${id}: ${node.target.join(' ')}: ${all.join('; ')}`;
    }));
})()";

/// A page under axe, and what it found: each fault with the screens that have it.
struct Judge {
    page: Page,
    language: &'static str,
    faults: BTreeMap<String, Vec<String>>,
    judged: usize,
}

impl Judge {
    fn open(bench: &Bench, language: &'static str) -> Result<Self> {
        let axe = fs::read_to_string(artefacts::axe()?)?;
        let page = bench.open(&format!("/?lang={language}"))?;
        // `void`: what it gives cannot cross.
        page.evaluate(&format!("{axe}; void 0"))?;
        page.find("button", "Connect")?;
        Ok(Self {
            page,
            language,
            faults: BTreeMap::new(),
            judged: 0,
        })
    }

    /// Judges what is on the screen in every theme and width.
    fn screen(&mut self, name: &str) -> Result<()> {
        for (width, view) in [("desktop", View::DESKTOP), ("phone", View::PHONE)] {
            for (theme, view) in [("light", view), ("dark", view.dark())] {
                self.page.look(view)?;
                let found = self.page.evaluate(JUDGE)?;
                self.judged += 1;
                for fault in found.as_array().context("no list from axe")? {
                    let fault = fault.as_str().unwrap_or_default().to_owned();
                    let screen = format!("{name} {width} {theme} {}", self.language);
                    self.faults.entry(fault).or_default().push(screen);
                }
            }
        }
        self.page.look(View::DESKTOP)
    }

    fn panels(&mut self, when: &str) -> Result<()> {
        for panel in ["Link", "Drive together", "Settings"] {
            open_panel(&self.page, panel)?;
            self.screen(&format!("{panel} {when}"))?;
            self.page.click("button", "Close the panel")?;
        }
        Ok(())
    }

    fn unconnected(&mut self) -> Result<()> {
        self.screen("desk unconnected")?;
        self.page.click("button", "Help")?;
        self.screen("Help")?;
        self.page.click("button", "Close")
    }

    fn connected(&mut self) -> Result<()> {
        self.page.click("button", "Virtual motor")?;
        self.page
            .wait_for_text("output", "Mode", |text| text.contains("elocity"))?;
        self.page.click("button", "+100")?;
        wait_for_speed(&self.page, 97..=103)?;
        // Before axe: it holds a page up for so long that its motors are stopped, as they should be.
        self.page.click("button", "Stop")?;
        wait_for_speed(&self.page, 0..=0)?;
        self.screen("Velocity, graph and log")?;
        for tab in ["Current", "Position", "ID Manager", "Raw Hex"] {
            self.page.click("tab", tab)?;
            self.screen(tab)?;
        }
        self.page.click("tab", "Velocity")?;
        self.panels("connected")?;
        self.page.press("Escape")?;
        self.page
            .wait_for_text("alertdialog", "Stopped", |text| text.contains("0x01"))?;
        self.screen("Stopped")?;
        self.page.click("button", "Release")?;
        self.page.click("button", "Disconnect")?;
        self.question()
    }

    fn question(&mut self) -> Result<()> {
        open_panel(&self.page, "Settings")?;
        wait_until_enabled(&self.page, "button", "Erase kept data", true)?;
        self.page.click("button", "Erase kept data")?;
        self.screen("question")
    }
}

#[test]
fn axe_finds_nothing_on_any_screen() -> Result<()> {
    let bench = Bench::start()?;
    for language in LANGUAGES {
        let mut judge = Judge::open(&bench, language)?;
        judge.unconnected()?;
        judge.connected()?;
        assert!(judge.judged > 40, "only {} screens", judge.judged);
        let faults: Vec<String> = judge
            .faults
            .iter()
            .map(|(fault, screens)| format!("{fault}\n    {}", screens.join(", ")))
            .collect();
        assert!(faults.is_empty(), "\n{}", faults.join("\n"));
        assert_eq!(judge.page.console_errors(), Vec::<String>::new());
    }
    Ok(())
}

#[test]
fn axe_finds_what_is_wrong() -> Result<()> {
    let bench = Bench::start()?;
    let mut judge = Judge::open(&bench, "en")?;
    judge
        .page
        .evaluate("document.querySelector('main').append(document.createElement('button')), 1")?;
    judge.screen("with a button that has no name")?;
    let named: Vec<&String> = judge.faults.keys().collect();
    assert!(
        named.iter().any(|fault| fault.starts_with("button-name")),
        "{named:?}"
    );
    Ok(())
}
