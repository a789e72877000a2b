//! What a machine can judge of the page's accessibility: axe on every screen, in each theme, language and width, though
//! not in every combination of them.

use std::collections::BTreeMap;
use std::fs;

use crate::fixture::wait_until_enabled;
use anyhow::{Context, Result};
use end_to_end::{Bench, Page, Scheme, View, artefacts};
use motorlink_i18n::{Language, set_language, translated};

/// What is read or said on a Chinese page and is English: words in small letters that follow each other.
const ENGLISH: &str = r#"(() => {
    const said = [];
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    while (walker.nextNode()) {
        const { parentElement: around, data } = walker.currentNode;
        if (!around.closest("code, pre, kbd, option, svg, script, noscript, [lang=en]")) said.push(data);
    }
    for (const name of ["aria-label", "title", "placeholder", "aria-description", "alt"]) {
        for (const element of document.querySelectorAll(`[${name}]`)) said.push(element.getAttribute(name));
    }
    return [...new Set(said)].filter((text) => /[A-Za-z]{2,} [a-z]{3,}/.test(text));
})()"#;

/// Rules of axe about colours.
const OF_COLOURS: &str = "runOnly: { type: 'rule', values: colours }";

/// All other rules.
const OF_THE_REST: &str =
    "runOnly: tags, rules: Object.fromEntries(colours.map((rule) => [rule, { enabled: false }]))";

/// Runs some rules of axe; gives a line for each element that breaks one. None of them needs `preload`, which fetches the
/// style sheets again.
fn judge(rules: &str) -> String {
    format!(
        "(async () => {{
            const colours = ['color-contrast', 'link-in-text-block'];
            const tags = ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa', 'best-practice'];
            const {{ violations }} = await axe.run(document, {{ {rules}, preload: false, resultTypes: ['violations'] }});
            {FAULTS}
        }})()"
    )
}

const FAULTS: &str = "
    return violations.flatMap(({ id, nodes }) => nodes.map((node) => {
        const all = [...node.any, ...node.all, ...node.none].map(({ message }) => message);
        return `${id}: ${node.target.join(' ')}: ${all.join('; ')}`;
    }));";

/// Screens that are judged in each language.
const SCREENS: usize = 15;

/// A page under axe, and what it found: each fault with the screens that have it.
struct Judge {
    page: Page,
    language: Language,
    faults: BTreeMap<String, Vec<String>>,
    judged: usize,
}

impl Judge {
    /// `more` follows the language in the address.
    fn open(bench: &Bench, language: Language, more: &str) -> Result<Self> {
        set_language(language);
        let axe = fs::read_to_string(artefacts::axe()?)?;
        let page = bench.open(&format!("/?lang={}{more}", language.key()))?;
        // `void`: what it gives cannot cross.
        page.evaluate(&format!("{axe}; void 0"))?;
        page.find("button", translated("Help"))?;
        Ok(Self {
            page,
            language,
            faults: BTreeMap::new(),
            judged: 0,
        })
    }

    /// Judges what is on the screen: in English in both widths, and in each theme in one width at least. In the other
    /// languages only the words differ.
    fn screen(&mut self, name: &str) -> Result<()> {
        use Scheme::{Contrast, Dark, Light};
        let phone = format!("{name} phone {}", self.language.key());
        let desktop = format!("{name} desktop {}", self.language.key());
        self.page.look(View::PHONE)?;
        self.note(&judge(OF_THE_REST), "", &phone)?;
        if self.language == Language::English {
            self.colours(&phone, View::PHONE, [Light, Dark])?;
            self.page.look(View::DESKTOP)?;
            self.note(&judge(OF_THE_REST), "", &desktop)?;
            self.colours(&desktop, View::DESKTOP, [Dark, Contrast])?;
        }
        if self.language == Language::Chinese {
            self.note(ENGLISH, "not translated: ", name)?;
        }
        self.judged += 1;
        self.page.look(View::DESKTOP)
    }

    fn colours(&mut self, screen: &str, view: View, schemes: [Scheme; 2]) -> Result<()> {
        for scheme in schemes {
            self.page.look(view.with(scheme))?;
            self.note(
                &judge(OF_COLOURS),
                "",
                &format!("{screen} {}", scheme.name()),
            )?;
        }
        Ok(())
    }

    /// Keeps what a script finds.
    fn note(&mut self, script: &str, what: &str, screen: &str) -> Result<()> {
        let found = self.page.evaluate(script)?;
        for fault in found.as_array().context("no list of faults")? {
            let fault = format!("{what}{}", fault.as_str().unwrap_or_default());
            self.faults
                .entry(fault)
                .or_default()
                .push(screen.to_owned());
        }
        Ok(())
    }

    fn click(&self, role: &str, name: &str) -> Result<()> {
        self.page.click(role, translated(name))
    }

    fn panels(&mut self, when: &str) -> Result<()> {
        for (panel, place) in [
            ("Session file", "Record"),
            ("Experiments", "Test"),
            ("Settings", "Setup"),
            ("Link health", "Diagnose"),
        ] {
            self.page.open_panel(panel)?;
            self.screen(&format!("{place} {when}"))?;
        }
        self.page.open_panel("Control")
    }

    fn unconnected(&mut self) -> Result<()> {
        self.screen("desk unconnected")?;
        self.click("button", "Help")?;
        self.screen("Help")?;
        self.click("button", "Close")
    }

    fn connected(&mut self) -> Result<()> {
        self.click("button", "Virtual motor")?;
        let reported = |text: &str| text.chars().any(char::is_alphabetic);
        self.page
            .wait_for_text("output", translated("Mode"), reported)?;
        self.click("button", "+100")?;
        self.wait_for_speed("100")?;
        // Before axe: it holds a page up for so long that its motors are stopped, as they should be.
        self.click("button", "Stop")?;
        self.wait_for_speed("0")?;
        self.screen("Velocity, graph and log")?;
        for tab in ["Current", "Position"] {
            self.click("tab", tab)?;
            self.screen(tab)?;
        }
        self.click("tab", "Velocity")?;
        self.panels("connected")?;
        self.dead_line()?;
        self.click("button", "STOP all motors")?;
        self.page
            .wait_for_text("alertdialog", translated("Stopped"), |text| {
                text.contains("0x01")
            })?;
        self.screen("Stopped")?;
        self.click("button", "Release")?;
        self.click("button", "Disconnect")?;
        self.wheel_setup()?;
        self.question()
    }

    /// The first step, which has all kinds of controls that the others have.
    fn wheel_setup(&mut self) -> Result<()> {
        self.page.open_panel("ID Manager")?;
        self.click("button", "ID wizard")?;
        self.page.find("button", translated("Set the IDs"))?;
        self.screen("ID wizard")?;
        self.click("button", "Close the panel")
    }

    /// The doctor has found something, and what is known of the motor is old.
    fn dead_line(&mut self) -> Result<()> {
        self.page.open_panel("Link health")?;
        self.page
            .choose(translated("Simulated fault"), translated("No replies"))?;
        self.page.open_panel("Telemetry")?;
        let old = |text: &str| text.contains(translated("No data"));
        self.page
            .wait_for_text("output", translated("Motion"), old)?;
        let known = self
            .page
            .evaluate("document.querySelector('.twin-figures').innerText")?;
        assert!(
            known
                .as_str()
                .is_some_and(|text| text.contains(translated("rpm"))),
            "{known}"
        );
        self.screen("desk, the line dead")?;
        self.page.open_panel("Link health")?;
        self.screen("Link, the line dead")?;
        self.page
            .choose(translated("Simulated fault"), translated("None"))?;
        self.page.open_panel("Telemetry")?;
        self.page
            .wait_for_text("output", translated("Motion"), |text| !old(text))?;
        Ok(())
    }

    fn wait_for_speed(&self, rpm: &str) -> Result<()> {
        let is_it = |text: &str| text.trim_start_matches(['+', ' ']).starts_with(rpm);
        self.page
            .wait_for_text("output", translated("Speed"), is_it)
            .map(drop)
    }

    fn question(&mut self) -> Result<()> {
        self.page.open_panel("Settings")?;
        wait_until_enabled(&self.page, "button", translated("Delete all data"), true)?;
        self.click("button", "Delete all data")?;
        self.screen("question")
    }
}

/// What depends on colours is judged in English alone.
fn axe_finds_nothing(language: Language) -> Result<()> {
    let bench = Bench::reuse()?;
    let mut one = Judge::open(&bench, language, "")?;
    one.unconnected()?;
    one.connected()?;
    let mut two = Judge::open(&bench, language, "&port=virtual&motors=2")?;
    two.click("radio", "Group")?;
    two.screen("Group")?;
    let judged = one.judged + two.judged;
    assert_eq!(judged, SCREENS);
    let faults = one.faults.iter().chain(&two.faults);
    let faults: Vec<String> = faults
        .map(|(fault, screens)| format!("{fault}\n    {}", screens.join(", ")))
        .collect();
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
    for page in [&one.page, &two.page] {
        assert_eq!(page.console_errors(), Vec::<String>::new());
    }
    Ok(())
}

#[test]
fn axe_finds_nothing_on_any_english_screen_in_any_colours() -> Result<()> {
    axe_finds_nothing(Language::English)
}

#[test]
fn axe_finds_nothing_on_any_chinese_screen() -> Result<()> {
    axe_finds_nothing(Language::Chinese)
}

#[test]
fn axe_finds_nothing_on_any_german_screen() -> Result<()> {
    axe_finds_nothing(Language::German)
}

const FAULTY: &str = "(() => {
    const words = document.createElement('p');
    words.textContent = 'grey';
    words.style.cssText = 'position: fixed; top: 100px; z-index: 99; color: #999; background: #aaa';
    document.querySelector('main').append(document.createElement('button'), words);
})()";

#[test]
fn axe_finds_what_is_wrong() -> Result<()> {
    let bench = Bench::reuse()?;
    let mut judge = Judge::open(&bench, Language::English, "")?;
    judge.page.evaluate(FAULTY)?;
    judge.screen("with a button that has no name and grey words on grey")?;
    let named: Vec<&String> = judge.faults.keys().collect();
    for rule in ["button-name", "color-contrast"] {
        assert!(named.iter().any(|it| it.starts_with(rule)), "{named:?}");
    }
    Ok(())
}
