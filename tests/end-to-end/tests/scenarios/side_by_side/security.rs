//! The page's policy: nothing of the page breaks it, and it stands.

use std::{fs, path::Path};

use crate::fixture::{Scenario, assert_quiet_console, spin};
use anyhow::Result;
use end_to_end::{Line, Page, WAIT_MAX, wait_until};
use serde_json::Value;

/// Keeps what breaks the policy, from before the first line of the page.
const LISTEN: &str = "globalThis.broken = [];
    addEventListener('securitypolicyviolation', (event) => {
        broken.push(event.effectiveDirective + ' ' + event.blockedURI);
    });";

fn broken(page: &Page) -> Result<Vec<String>> {
    let Value::Array(broken) = page.evaluate("broken")? else {
        return Ok(Vec::new());
    };
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    Ok(broken.iter().map(text).collect())
}

/// A page that listens, loaded again.
fn listening(line: Line) -> Result<Scenario> {
    let scenario = Scenario::connected(line)?;
    scenario.page.before_load(LISTEN)?;
    scenario.page.reload()?;
    crate::fixture::connect(&scenario.page)?;
    Ok(scenario)
}

#[test]
fn nothing_that_a_person_does_breaks_the_policy_or_asks_another_host() -> Result<()> {
    let scenario = listening(Line::with_motors(&[1, 2]))?;
    let page = &scenario.page;
    for tab in ["Current", "Position", "Velocity"] {
        page.click("tab", tab)?;
    }
    for panel in ["Session file", "Experiments", "Settings", "Link health"] {
        page.open_panel(panel)?;
    }
    spin(page, "+100", 97..=103)?;
    page.press("Escape")?;
    page.wait_for_text("alertdialog", "Stopped", |text| text.contains("onfirmed"))?;
    page.click("button", "Release")?;
    page.click("button", "Help")?;
    // Fetched, and put in as markup.
    wait_until("the help", WAIT_MAX, || {
        let drawing = page.evaluate("document.querySelector('.wiring-drawing svg') !== null")?;
        Ok(if drawing == Value::Bool(true) {
            Ok(())
        } else {
            Err("it is not there".to_owned())
        })
    })?;
    page.press("Escape")?;
    page.download("Export CSV")?;
    page.open_panel("Recording")?;
    page.download("Export telemetry CSV")?;
    page.download("Plot CSV")?;
    assert_eq!(broken(page)?, [""; 0]);
    let foreign = "performance.getEntriesByType('resource').map((entry) => entry.name)
        .filter((name) => !name.startsWith(location.origin) && !name.startsWith('blob:' + location.origin))";
    assert_eq!(page.evaluate(foreign)?, Value::Array(Vec::new()));
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn what_would_run_or_load_something_foreign_is_refused() -> Result<()> {
    let scenario = listening(Line::default())?;
    let page = &scenario.page;
    for (act, directive) in [
        (
            "const it = document.createElement('div'); it.innerHTML = '<img src=x onerror=\"ran = 1\">'; document.body.append(it)",
            "script-src-attr",
        ),
        (
            "fetch('https://example.org/').catch(() => {})",
            "connect-src",
        ),
        (
            "document.body.append(Object.assign(new Image(), { src: 'https://example.org/a.png' }))",
            "img-src",
        ),
        (
            "try { document.body.insertAdjacentHTML('beforeend', '<iframe src=https://example.org>') } catch {}",
            "require-trusted-types-for",
        ),
        (
            "try { new Worker('https://example.org/w.js') } catch {}",
            "require-trusted-types-for",
        ),
        (
            "try { trustedTypes.createPolicy('other', {}) } catch {}",
            "trusted-types",
        ),
    ] {
        page.evaluate("broken.length = 0")?;
        page.evaluate(&format!("(() => {{ {act} }})()"))?;
        wait_until(
            &format!("{directive} to be told of {act}"),
            WAIT_MAX,
            || {
                let broken = broken(page)?;
                let told = broken.iter().any(|one| one.starts_with(directive));
                Ok(if told {
                    Ok(())
                } else {
                    Err(format!("{broken:?}"))
                })
            },
        )?;
    }
    assert_eq!(page.evaluate("typeof ran")?, Value::from("undefined"));
    Ok(())
}

#[test]
fn a_name_is_text_wherever_it_stands() -> Result<()> {
    let scenario = listening(Line::default())?;
    let page = &scenario.page;
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("hostile-name.json");
    fs::write(
        &file,
        r#"{"motorlink_setup": 1, "motors": [{"id": 1, "name": "<img src=x>\"&lt;"}]}"#,
    )?;
    page.open_panel("Settings")?;
    page.upload("Import setup", &file)?;
    page.wait_for_text("list", "Motors", |text| text.contains("<img src=x>\"&lt;"))?;
    assert_eq!(page.evaluate("document.images.length")?, Value::from(0));
    assert_eq!(broken(page)?, [""; 0]);
    assert_quiet_console(page);
    Ok(())
}
