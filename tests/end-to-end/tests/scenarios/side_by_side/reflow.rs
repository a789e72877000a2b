//! Reflow (WCAG 1.4.10): in a window as wide as one of 1280 pixels at 400 % nothing is lost, and nothing has to be
//! scrolled in two directions. The log, the graph and tables may scroll by themselves. No bar covers what has the focus.

use anyhow::Result;
use end_to_end::{Bench, Line, Page, View};
use serde_json::json;

use crate::fixture::{
    Scenario,
    places::{LANDSCAPE, look},
    spin,
};

/// A narrow phone, and 1280 x 1024 at 400 %.
const VIEWS: [View; 2] = [View::window(320, 640), View::window(320, 256)];

/// What is lost: a page, panel or dialog that is wider than its place, a control that cannot be scrolled to or lies
/// under another element, a text that is cut.
const LOST: &str = "(() => {
    const lost = [];
    const name = (element) => element.getAttribute('aria-label') || element.innerText?.trim() || element.id || element.className;
    const is_shown = (element) => element.getClientRects().length && element.checkVisibility({ visibilityProperty: true })
        && !element.closest('[inert], .skip, .brand');
    const root = document.documentElement;
    if (root.scrollWidth > innerWidth) lost.push(`the page is ${root.scrollWidth} wide`);
    for (const element of document.querySelectorAll('body *')) {
        if (!is_shown(element) || element.closest('.packet-log, .graph-panel, table, .motor-chips, svg')) continue;
        const style = getComputedStyle(element);
        const scrolls = ['auto', 'scroll'].includes(style.overflowX);
        const hides = ['hidden', 'clip'].includes(style.overflowX);
        if (!scrolls && !hides || element.clientWidth <= 1 || element.scrollWidth <= element.clientWidth + 1) continue;
        const { right } = element.getBoundingClientRect();
        const over = [...element.querySelectorAll('*')].filter((child) =>
            !child.closest('svg') && is_shown(child) && child.getBoundingClientRect().right > right + 1);
        if (scrolls || over.length || !element.childElementCount)
            lost.push(`${scrolls ? 'scrolls' : 'cut'}: ${name(element)}: ${over.map(name)}`);
    }
    const dialog = document.querySelector('.scrim:not([hidden]) :is([role=dialog], [role=alertdialog]), .opened:not([hidden])');
    for (const place of [dialog, document.querySelector('.stopped')])
        if (place && is_shown(place) && place.getBoundingClientRect().top < 0) lost.push(`begins above the window: ${name(place)}`);
    // What lies under the dialog Stopped drives nothing until Release.
    const stopped = document.querySelector('.stopped');
    const open = stopped && is_shown(stopped) ? stopped : dialog ?? document;
    const controls = 'button, input:not([type=file]), select, textarea, a[href], summary, [tabindex=\"0\"]';
    for (const control of open.querySelectorAll(controls)) {
        if (!is_shown(control) || control.disabled && control.tagName === 'OPTION') continue;
        const target = control.matches('.edit-name') ? control : control.closest('label, .language, .motor-chip') ?? control;
        target.scrollIntoView({ block: 'center', inline: 'center' });
        // The rows of the log do not move when it scrolls, which scrollIntoView expects: so the page scrolls to them once more.
        const log = control.closest('.packet-scroller');
        if (log) {
            const { top, bottom } = target.getBoundingClientRect();
            scrollBy(0, (top + bottom - innerHeight) / 2);
        }
        const { left, top, right, bottom } = target.getBoundingClientRect();
        const [x, y] = [(left + right) / 2, (Math.max(top, 0) + Math.min(bottom, innerHeight)) / 2];
        // The rows are drawn again with the next frame: the last one is cut.
        const rows = log?.getBoundingClientRect();
        if (rows && (y < rows.top || y > rows.bottom)) continue;
        const over = document.elementFromPoint(x, y);
        if (left < -0.5 || right > innerWidth + 0.5) lost.push(`beside the window: ${name(control)}`);
        else if (!over || !(target.contains(over) || over.contains(target)))
            lost.push(`${name(control)} is under ${over?.outerHTML.slice(0, 80)}`);
    }
    scrollTo(0, 0);
    return lost;
})()";

fn nothing_is_lost(page: &Page, view: View, what: &str) -> Result<Vec<String>> {
    let lost = page.evaluate(LOST)?;
    Ok(lost
        .as_array()
        .into_iter()
        .flatten()
        .map(|one| format!("{}x{} {what}: {one}", view.width, view.height))
        .collect())
}

#[test]
fn at_400_percent_nothing_is_lost() -> Result<()> {
    let scenario = Scenario::connected(Line::with_motors(&[1, 2]))?;
    let page = &scenario.page;
    let mut lost = Vec::new();
    for view in VIEWS {
        look(page, view)?;
        lost.extend(nothing_is_lost(page, view, "tour")?);
    }
    page.click("button", "Skip the tour")?;
    for view in VIEWS {
        look(page, view)?;
        for tab in ["Velocity", "Current", "Position"] {
            page.click("tab", tab)?;
            lost.extend(nothing_is_lost(page, view, tab)?);
        }
        page.click("tab", "Velocity")?;
        for place in ["Record", "Diagnose", "Setup", "Drive"] {
            page.click("button", place)?;
            lost.extend(nothing_is_lost(page, view, place)?);
            if place == "Setup" {
                page.click("button", "Help")?;
                lost.extend(nothing_is_lost(page, view, "Help")?);
                page.click("button", "Close")?;
            }
        }
    }
    for view in VIEWS {
        look(page, view)?;
        spin(page, "+50", 47..=53)?;
        page.click("button", "STOP all motors")?;
        // The longest words come with the confirmation.
        page.wait_for_text("alertdialog", "Stopped", |text| text.contains("confirmed"))?;
        lost.extend(nothing_is_lost(page, view, "Stopped")?);
        page.click("button", "Release")?;
    }
    assert_eq!(json!(lost), json!([]), "\n{}", lost.join("\n"));
    Ok(())
}

/// A phone, the same held sideways, and 1440 x 900 at 200 %: there the bars take the most of the window.
const LOW_OR_NARROW: [View; 3] = [View::PHONE, LANDSCAPE, View::window(720, 450)];

/// What lies over the middle of the focused control, and over the corners of a large one; `null` if nothing has the focus.
const OVER_FOCUS: &str = "new Promise(requestAnimationFrame).then(() => {
    const it = document.activeElement;
    if (!it || it === document.body) return null;
    const { left, top, right, bottom } = it.getBoundingClientRect();
    const [x, width] = [Math.max(left, 0), Math.min(right, innerWidth) - Math.max(left, 0)];
    const [y, height] = [Math.max(top, 0), Math.min(bottom, innerHeight) - Math.max(top, 0)];
    const own = [it, ...(it.labels ?? [])];
    const corners = height > 60 ? [[0.1, 0.1], [0.9, 0.1], [0.1, 0.9], [0.9, 0.9]] : [];
    const over = [[0.5, 0.5], ...corners].map(([right, down]) =>
        document.elementFromPoint(x + right * width, y + down * height));
    if (over.some((one) => one && (one.contains(it) || own.some((element) => element.contains(one))))) return '';
    const name = (it.getAttribute('aria-label') || it.innerText || it.className).slice(0, 40).replace(/\\s+/g, ' ');
    return `${name} at ${Math.round(x)}, ${Math.round(y)} under ${over[0] ? over[0].outerHTML.slice(0, 80) : 'the edge'}`;
})";

/// Focus not obscured (WCAG 2.4.11).
#[test]
fn what_has_the_focus_is_under_no_bar() -> Result<()> {
    let bench = Bench::reuse()?;
    let page = bench.open("/?port=virtual&motors=2")?;
    page.click("button", "Skip the tour")?;
    let mut covered = Vec::new();
    for view in LOW_OR_NARROW {
        look(&page, view)?;
        // Each place, and one of its controls: before it is loaded, it moves the others.
        for (place, control) in [
            (1, "Start"),
            (2, "Save session"),
            (3, "Arm"),
            (4, "Set ID"),
            (5, "Send"),
        ] {
            page.press(&format!("Alt+{place}"))?;
            page.find("button", control)?;
            let mut seen = 0;
            for _ in 0..40 {
                page.press("Tab")?;
                let over = page.evaluate(OVER_FOCUS)?;
                let Some(over) = over.as_str() else { break };
                seen += 1;
                if !over.is_empty() {
                    covered.push(format!("{view:?}, Alt+{place}: {over}"));
                }
            }
            assert!(seen > 5, "{view:?}, Alt+{place}: {seen} controls");
        }
    }
    assert!(covered.is_empty(), "{}", covered.join("\n"));
    Ok(())
}
