//! The scale of the design: sizes of text, heights of controls, radii of corners.

use anyhow::Result;
use end_to_end::{Bench, View};
use serde_json::json;

use crate::fixture::places::look;

/// What is seen in a size that the design does not have, each once with an element that has it.
const OFF_THE_SCALE: &str = "(() => {
    const seen = (element) => element.getClientRects().length && getComputedStyle(element).visibility === 'visible';
    const off = new Map();
    const judge = (what, value, scale, element) => {
        if (!scale.includes(value)) off.set(`${what} ${value}`, `${element.tagName} ${element.className}`);
    };
    const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    while (texts.nextNode()) {
        const element = texts.currentNode.parentElement;
        if (!texts.currentNode.data.trim() || !seen(element) || element.closest('svg, script, noscript, option')) continue;
        judge('text of', getComputedStyle(element).fontSize, ['11px', '12px', '13px', '14px', '18px', '28px'], element);
    }
    for (const element of document.querySelectorAll('body *')) {
        const { borderTopLeftRadius, borderTopWidth, backgroundColor } = getComputedStyle(element);
        const has_edge = borderTopWidth !== '0px' || backgroundColor !== 'rgba(0, 0, 0, 0)';
        if (!has_edge || !seen(element) || element.closest('svg')) continue;
        // 4 px are those of marks: keys and boxes to tick.
        judge('radius of', borderTopLeftRadius, ['0px', '4px', '8px', '14px', '50%', '99px'], element);
    }
    // The buttons of a motor grow with the window. The first button is the largest.
    for (const element of document.querySelectorAll('.button:not(.button-row .button, .first-buttons .connect)')) {
        const height = Math.round(element.getBoundingClientRect().height);
        if (seen(element)) judge('button of', height, [32, 40, 44], element);
    }
    return [...off].map(([size, element]) => `${size}: ${element}`);
})()";

#[test]
fn texts_corners_and_buttons_have_the_sizes_of_the_design() -> Result<()> {
    let bench = Bench::reuse()?;
    let page = bench.open("/")?;
    page.find("button", "Connect motor")?;
    assert_eq!(page.evaluate(OFF_THE_SCALE)?, json!([]), "first screen");
    let page = bench.open("/?port=virtual&motors=2")?;
    page.wait_for_text("status", "Mode", |text| text.contains("loop"))?;
    page.find_like("img", "Speed and current")?;
    for view in [View::DESKTOP, View::PHONE] {
        look(&page, view)?;
        for panel in [
            "Control",
            "Recording",
            "Experiments",
            "Settings",
            "Link health",
        ] {
            page.open_panel(panel)?;
            let off = page.evaluate(OFF_THE_SCALE)?;
            assert_eq!(off, json!([]), "{panel} in {view:?}");
        }
    }
    Ok(())
}
