//! Texts and windows that have the room that they need.

use anyhow::Result;
use end_to_end::{Bench, Page, View};
use motorlink_i18n::{Language, set_language, translated};
use serde_json::json;

use crate::fixture::places::{LANDSCAPE, LAPTOP, WIDE, in_sight, look};

/// In CSS pixels.
const WINDOWS: [(u32, u32); 11] = [
    (320, 256),
    (320, 640),
    (390, 844),
    (720, 450),
    (768, 1024),
    (844, 390),
    (1024, 768),
    (1366, 657),
    (1440, 900),
    (1920, 1080),
    (2560, 1440),
];

/// One of each layout.
const SOME_WINDOWS: [(u32, u32); 6] = [
    (320, 256),
    (390, 844),
    (844, 390),
    (1024, 768),
    (1366, 657),
    (1920, 1080),
];

/// Fields and buttons whose text is wider than they are, or that end beyond their row, and a title of the graph without
/// its motor.
const CUT: &str = "(() => {
    const pen = document.createElement('canvas').getContext('2d');
    const width = (element, text) => {
        pen.font = getComputedStyle(element).font;
        return pen.measureText(text).width;
    };
    const shown = (element) => element.getClientRects().length && getComputedStyle(element).visibility === 'visible';
    const cut = [];
    for (const element of document.querySelectorAll(':is(.control-panel, .place) :is(input, button), .graph-head select')) {
        if (!shown(element)) continue;
        const text = element.value && element.tagName === 'INPUT' && element.type === 'text' ? element.value
            : element.tagName === 'SELECT' ? element.selectedOptions[0].text
            : element.tagName === 'BUTTON' ? element.innerText : '';
        // The arrow of a list.
        const rest = element.tagName === 'SELECT' ? 18 : 0;
        // On a phone the tabs are swiped.
        const tabs = element.closest('.tabs');
        const swiped = tabs && getComputedStyle(tabs).overflowX === 'auto';
        const row = swiped ? null : element.closest('.loop-head') ?? element.closest('.control-panel, .place');
        const over = row && element.getBoundingClientRect().right > row.getBoundingClientRect().right + 0.5;
        if (over || width(element, text) + rest > element.clientWidth + 0.5) cut.push(text);
    }
    for (const title of document.querySelectorAll('.graph-head h2')) {
        if (title.clientWidth > 1 && title.scrollHeight > title.clientHeight + 1) cut.push(title.innerText);
    }
    return cut;
})()";

#[test]
fn no_text_of_the_controls_is_cut() -> Result<()> {
    for language in [Language::English, Language::German] {
        set_language(language);
        let bench = Bench::reuse()?;
        // Its motor has every tab.
        let page = bench.open(&format!(
            "/?port=virtual&model=ddsm400&lang={}",
            language.key()
        ))?;
        page.wait_for_text("output", translated("Mode"), |text| {
            text.chars().any(char::is_alphabetic)
        })?;
        page.find_like("img", translated("Speed and current"))?;
        page.open_panel("Recording")?;
        page.click("button", translated("Record telemetry"))?;
        for view in [View::PHONE, View::TABLET, LAPTOP, View::DESKTOP] {
            look(&page, view)?;
            if view == View::DESKTOP {
                assert_eq!(page.evaluate(CUT_COUNTS)?, json!([]), "{}", language.key());
            }
            for panel in ["Recording", "Link health", "Settings", "Control"] {
                page.open_panel(panel)?;
                let cut = page.evaluate(CUT)?;
                assert_eq!(cut, json!([]), "{panel} in {view:?}, {}", language.key());
            }
            for tab in ["Velocity", "Current", "Position", "Open loop"] {
                page.click("tab", translated(tab))?;
                if tab == "Position" {
                    page.fill("spinbutton", translated("Target angle"), "270")?;
                }
                let cut = page.evaluate(CUT)?;
                assert_eq!(cut, json!([]), "{tab} in {view:?}, {}", language.key());
            }
        }
    }
    set_language(Language::English);
    Ok(())
}

/// One text of each kind that nobody can read.
const UNREADABLE: &str = "(() => {
    document.body.replaceChildren();
    for (const [text, style] of [
        ['a text that is cut', 'top: 10px; width: 20px; overflow: hidden; white-space: nowrap'],
        ['beside', 'top: 60px; left: -20px'],
        ['below', 'top: 110px'],
        ['above', 'top: 112px; pointer-events: none'],
        ['a text over the edge', 'top: 160px; width: 30px; white-space: nowrap'],
    ]) {
        const words = document.createElement('p');
        words.textContent = text;
        words.className = text.endsWith('edge') ? 'panel' : '';
        words.style.cssText = `position: fixed; ${style}`;
        document.body.append(words);
    }
})()";

#[test]
fn what_nobody_can_read_is_found() -> Result<()> {
    let bench = Bench::reuse()?;
    let page = bench.open("/")?;
    page.find("button", "Rover")?;
    page.evaluate(UNREADABLE)?;
    let found = page.unreadable()?;
    for kind in [
        "cut: a text",
        "beside the window: ",
        "over each other: ",
        "over the edge: ",
    ] {
        let of_kind = found.iter().filter(|text| text.starts_with(kind));
        assert_eq!(of_kind.count(), 1, "{kind}: {found:?}");
    }
    Ok(())
}

/// Four motors of a rover, in the five places: in German, which has the longest words, in every window, in the other
/// languages in some. 720 x 450 and 320 x 256 are windows at 200 and 400 %.
#[test]
fn no_text_is_cut_or_over_another() -> Result<()> {
    let mut found = Vec::new();
    for language in Language::ALL {
        set_language(language);
        let bench = Bench::reuse()?;
        let key = language.key();
        let page = bench.open(&format!("/?lang={key}"))?;
        page.find("button", translated("Rover"))?;
        let mut check = |page: &Page, what: &str| -> Result<()> {
            let windows = if language == Language::German {
                &WINDOWS[..]
            } else {
                &SOME_WINDOWS
            };
            for &(width, height) in windows {
                look(page, View::window(width, height))?;
                let texts = page.unreadable()?;
                found.extend(
                    texts
                        .into_iter()
                        .map(|text| format!("{key} {what} {width}x{height}: {text}")),
                );
            }
            look(page, View::DESKTOP)
        };
        check(&page, "first screen")?;
        page.click("button", translated("Rover"))?;
        page.wait_for_text("output", translated("Forward"), |text| text.contains('0'))?;
        check(&page, "Drive together")?;
        // A group is offered no tour.
        page.open_panel("Control")?;
        check(&page, "tour")?;
        page.click("button", translated("Skip the tour"))?;
        for panel in [
            "Control",
            "Recording",
            "Experiments",
            "ID Manager",
            "Link health",
        ] {
            page.open_panel(panel)?;
            check(&page, panel)?;
        }
    }
    set_language(Language::English);
    assert!(found.is_empty(), "{}", found.join("\n"));
    Ok(())
}

/// Counts that are larger than their place, or touch the edge of their card.
const CUT_COUNTS: &str = "[...document.querySelectorAll('.recording-words, .entries span:not(.comma)')].filter((words) => words.getClientRects().length).filter((words) => {
    const [{ top, bottom }, card] = [words, words.closest('.panel')].map((place) => place.getBoundingClientRect());
    return words.scrollWidth > words.clientWidth + 1 || words.scrollHeight > words.clientHeight + 1
        || top < card.top + 3 || bottom > card.bottom - 3;
}).map((words) => words.textContent)";

/// Places of the desk that lie over each other, a wheel without room, and controls under the row of the command rate.
const COVERED: &str = "(() => {
    const shown = [...document.querySelectorAll('.desk .panel:not(.telemetry)')].filter((panel) => panel.getClientRects().length);
    const place = new Map(shown.map((panel) => [panel, panel.getBoundingClientRect()]));
    const covered = shown.flatMap((panel, at) => shown.slice(at + 1).filter((other) => {
        const [one, two] = [place.get(panel), place.get(other)];
        return one.left < two.right - 1 && two.left < one.right - 1 && one.top < two.bottom - 1 && two.top < one.bottom - 1;
    }).map((other) => `${panel.className} over ${other.className}`));
    const wheel = place.get(document.querySelector('.wheel-panel'));
    if (wheel && wheel.height < 150) covered.push(`a wheel of ${wheel.height}`);
    const controls = document.querySelector('.tab-panel:not(.closed)');
    const rate = document.querySelector('.command-rate').getBoundingClientRect();
    if (controls.getBoundingClientRect().bottom > rate.top + 1) covered.push('controls under the command rate');
    if (getComputedStyle(controls).overflowY === 'visible' && controls.scrollHeight > controls.clientHeight + 1) covered.push('cut controls');
    return covered;
})()";

/// Numbers of the dial that are too small to read.
const SMALL_NUMBERS: &str = "[...document.querySelectorAll('.twin-scale text')]
    .filter((text) => text.getClientRects().length)
    .map((text) => parseFloat(getComputedStyle(text).fontSize) * text.getScreenCTM().a)
    .filter((size) => size < 10.9)";

#[test]
fn in_a_group_no_count_is_cut_and_no_figure_covered() -> Result<()> {
    set_language(Language::German);
    let bench = Bench::reuse()?;
    let page = bench.open("/?port=virtual&motors=2&lang=de")?;
    page.find("button", translated("Skip the tour"))?;
    page.find_like("img", translated("Speed and current"))?;
    look(&page, View::DESKTOP)?;
    // The tour is shown too.
    assert_eq!(page.evaluate(COVERED)?, json!([]));
    page.open_panel("Drive together")?;
    for view in [View::window(1280, 900), View::DESKTOP] {
        look(&page, view)?;
        assert_eq!(page.evaluate(COVERED)?, json!([]), "{view:?}");
    }
    for name in ["Vorwärts", "Strom", "Richtung", "Temperatur"] {
        in_sight(&page, View::DESKTOP, "output", name)?;
    }
    assert_eq!(page.evaluate(CUT_COUNTS)?, json!([]));
    set_language(Language::English);
    Ok(())
}

/// How far STOP and the desk move when the figures of the header get their longest values.
const MOVES: &str = "(() => {
    const places = () => ['.stop', '.desk', '.header-end'].map((name) => {
        const { left, top } = document.querySelector(name).getBoundingClientRect();
        return [left, top];
    });
    const read = (...figures) => ['rate', 'time', 'loss'].forEach((name, at) => {
        document.querySelector(`.link-${name}`).textContent = figures[at];
    });
    read('0', '2.5', '0.0');
    const before = JSON.stringify(places());
    read('500', '40.0', '100.0');
    const after = JSON.stringify(places());
    return before === after ? '' : `${before} ${after}`;
})()";

/// WCAG 1.4.10: 320 pixels are a window of 1280 at 400 %.
#[test]
fn no_window_has_to_be_scrolled_sideways_and_no_figure_moves_the_page() -> Result<()> {
    for language in Language::ALL {
        set_language(language);
        let bench = Bench::reuse()?;
        let page = bench.open(&format!("/?port=virtual&lang={}", language.key()))?;
        page.find_like("img", translated("Speed and current"))?;
        for view in [
            View::window(320, 640),
            View::window(320, 256),
            View::PHONE,
            LANDSCAPE,
            View::window(860, 700),
            View::TABLET,
            View::window(1200, 800),
            View::window(1280, 720),
            View::window(1340, 800),
            LAPTOP,
            View::DESKTOP,
            WIDE,
        ] {
            look(&page, view)?;
            let wider = page.evaluate("document.documentElement.scrollWidth > innerWidth")?;
            assert_eq!(wider, json!(false), "{view:?}, {}", language.key());
            assert_eq!(page.evaluate(SMALL_NUMBERS)?, json!([]), "{view:?}");
            let moves = page.evaluate(MOVES)?;
            assert_eq!(moves, json!(""), "{view:?}, {}", language.key());
        }
    }
    set_language(Language::English);
    Ok(())
}
